//! Mails of a sculpture: asked for, and how far they have come.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::response::{IntoResponse, Redirect, Response};
use maud::{Markup, html};
use paros_booth_rules::records::{MailOrder, MailState, Sculpture};
use paros_booth_rules::{LoggedIn, Refusal};
use paros_core::outbox::messages::{AgeGroup, SculptureId, UploadFacts};

use super::admin_texts::AdminTexts;
use super::page::{StaffAnswer, StaffForm, form_token};
use super::sculptures::{parse_id, utc};
use super::texts::Texts;
use crate::app::App;
use crate::clock::booth_time;
use crate::random::random_number;

/// `POST /staff/sculptures/{id}/mail`.
pub(crate) async fn ask_mail(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
    StaffForm { login, texts, fields }: StaffForm,
) -> Result<Response, StaffAnswer> {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let id = parse_id(&id).map_err(fail)?;
    let Some(waker) = app.wakers.mails.clone() else {
        return Err(fail(Refusal::NotFound("no mail server was set")));
    };
    let order = random_number().map_err(|error| fail(error.into()))?;
    let asked = app.run(move |app| {
        let address = fields.get("address");
        let keeps_address = !fields.get("keep").is_empty();
        let asked = (address.as_str(), keeps_address);
        app.booth.ask_mail(&id, asked, order, &login.account, booth_time())
    });
    asked.await.map_err(fail)?;
    waker.wake();
    Ok(Redirect::to(&format!("/staff/sculptures/{id}")).into_response())
}

/// The mails of a sculpture; and a form for one more, where there is a server and it isn't withdrawn.
pub(crate) fn mails_of(
    texts: &Texts,
    login: &LoggedIn,
    sculpture: &Sculpture,
    mails: &[MailOrder],
    has_server: bool,
) -> Markup {
    let action = format!("/staff/sculptures/{}/mail", SculptureId(sculpture.id));
    let facts = UploadFacts::from_bytes(&sculpture.facts);
    let is_under_age = facts.is_ok_and(|facts| facts.age_group == AgeGroup::UnderAge);
    html! {
        @if has_server && sculpture.withdrawn_at.is_none() {
            form class="narrow" method="post" action=(action) {
                input type="hidden" name="form" value=(form_token(login));
                label {
                    (if is_under_age { texts.address_of_parent } else { texts.address })
                    input name="address" type="email" autocomplete="off" required maxlength="254";
                }
                p { (texts.address_is_deleted) }
                label class="check" { input name="keep" type="checkbox" value="yes"; " " (AdminTexts::of(texts).keep_address) }
                button { (texts.send_mail) }
            }
        }
        @if !mails.is_empty() {
            ul {
                @for mail in mails {
                    li {
                        (utc(mail.asked_at)) ": " (texts.mail_state(mail.state))
                        @if !mail.why.is_empty() { " (" (mail.why) ")" }
                        @if mail.state == MailState::Queued && mail.tries > 0 {
                            ", " (texts.next_try) " " (utc(mail.next_try_at))
                        }
                    }
                }
            }
        }
    }
}
