//! Mails of a sculpture: the request form, and the state of each mail.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::response::Response;
use maud::{Markup, html};
use paros_booth_rules::records::{MailOrder, MailState, Sculpture};
use paros_booth_rules::{LoggedIn, Reason, Refusal};
use paros_protocol::{AgeGroup, SculptureId, UploadFacts};

use super::admin_texts::AdminTexts;
use super::done::Done;
use super::forms::FormView;
use super::live::live;
use super::page::{StaffAnswer, StaffForm, form_token};
use super::refusal_texts::tell_cause;
use super::sculptures::{parse_id, refuse_form};
use super::texts::Texts;
use crate::clock::{booth_time, write_time};
use crate::random::random_number;
use crate::server::app::BoothApp;

/// The name of the form on the sculpture's page.
pub(super) const MAIL_FORM: &str = "mail";

/// `POST /staff/sculptures/{id}/mail`.
pub(crate) async fn ask_mail(
    State(app): State<Arc<BoothApp>>,
    Path(id): Path<String>,
    form: StaffForm,
) -> Result<Response, StaffAnswer> {
    match order_mail(&app, &id, &form).await {
        Ok(()) => Ok(Done::MailAsked.lead_to(&format!("/staff/sculptures/{id}"))),
        Err(refusal) => refuse_form(&app, &id, form, (MAIL_FORM, refusal)).await,
    }
}

async fn order_mail(app: &Arc<BoothApp>, id: &str, form: &StaffForm) -> Result<(), Refusal> {
    let id = parse_id(id)?;
    let waker = app.wakers.mails.clone().ok_or(Refusal::NotFound(Reason::NoMailServer))?;
    let order = random_number()?;
    let (address, keeps_address) =
        (form.fields.get("address"), !form.fields.get("keep").is_empty());
    let account = form.login.account.clone();
    let asked = app.run(move |app| {
        let asked = (address.as_str(), keeps_address);
        app.booth.ask_mail(&id, asked, order, &account, booth_time())
    });
    asked.await?;
    waker.wake();
    Ok(())
}

/// Draws the mails of a sculpture. Adds a form for another one if there is a mail server and the sculpture
/// isn't withdrawn.
pub(crate) fn mails_of(
    texts: &Texts,
    login: &LoggedIn,
    sculpture: &Sculpture,
    mails: &[MailOrder],
    form: Option<FormView<'_>>,
) -> Markup {
    let action = format!("/staff/sculptures/{}/mail", SculptureId(sculpture.id));
    let facts = UploadFacts::from_json(&sculpture.facts);
    let is_under_age = facts.is_ok_and(|facts| facts.age_group == AgeGroup::UnderAge);
    html! {
        @if let Some(form) = form.filter(|_| sculpture.withdrawn_at.is_none()) {
            form class="narrow" method="post" action=(action) {
                (form.why(""))
                input type="hidden" name="form" value=(form_token(login));
                label {
                    (if is_under_age { texts.address_of_parent } else { texts.address })
                    input name="address" type="email" autocomplete="off" required maxlength="254"
                        value=(form.value("address", ""))
                        aria-invalid=[form.invalid("address")] aria-describedby=[form.described("address")];
                }
                (form.why("address"))
                p { (texts.address_is_deleted) }
                label class="check" { input name="keep" type="checkbox" value="yes" checked[!form.value("keep", "").is_empty()]; " " (AdminTexts::of(texts).keep_address) }
                button { (texts.send_mail) }
            }
        }
        (live("mails", &html! {
            @if !mails.is_empty() { ul { @for mail in mails { li { (mail_line(texts, mail)) } } } }
        }))
    }
}

fn mail_line(texts: &Texts, mail: &MailOrder) -> Markup {
    html! {
        (write_time(mail.asked_at)) ": " (texts.mail_state(mail.state))
        @if !mail.why.is_empty() { " (" (tell_cause(texts.language, &mail.why)) ")" }
        @if mail.state == MailState::Queued && mail.tries > 0 {
            ", " (texts.next_try) " " (write_time(mail.next_try_at))
        }
    }
}
