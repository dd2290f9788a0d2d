//! The page of the logged-in account, where its owner changes the password.

use std::sync::Arc;

use axum::extract::State;
use axum::response::Response;
use maud::html;
use paros_booth_rules::{Reason, Refusal};

use super::admin_texts::AdminTexts;
use super::done::Done;
use super::forms::{FormView, Refused};
use super::login::begin_session;
use super::login_gate::{Asker, check_password};
use super::page::{StaffForm, StaffView, form_token};
use super::passwords::hash_password;
use crate::clock::booth_time;
use crate::server::app::BoothApp;

/// The name of the form on the page.
const PASSWORD_FORM: &str = "password";

/// `GET /staff/account`.
pub(crate) async fn show_account(view: StaffView) -> Response {
    account_page(&view, None)
}

fn account_page(view: &StaffView, refused: Option<&Refused>) -> Response {
    let (login, words) = (&view.login, AdminTexts::of(view.texts));
    let form = FormView::of(refused, PASSWORD_FORM);
    let body = html! {
        p { (login.account) ", " (words.role_name(login.role)) }
        form class="narrow" method="post" action="/staff/account/password" {
            (form.why(""))
            input type="hidden" name="form" value=(form_token(login));
            input type="hidden" name="name" value=(login.account) autocomplete="username";
            label {
                (words.old_password)
                input name="old" type="password" autocomplete="current-password" required
                    aria-invalid=[form.invalid("old")] aria-describedby=[form.described("old")];
            }
            (form.why("old"))
            (form.new_password_field(words.new_password, "new"))
            p { (words.logins_end) }
            button { (words.change_password) }
        }
    };
    view.page(words.account, &body)
}

/// `POST /staff/account/password`: changes the password, ends all logins of the account, and begins a new
/// one.
pub(crate) async fn change_password(State(app): State<Arc<BoothApp>>, form: StaffForm) -> Response {
    match set_password(&app, &form).await {
        Ok(answer) => Done::PasswordChanged.tell_on_next_page(answer),
        Err(refusal) => {
            let (view, refused) = form.refuse(PASSWORD_FORM, &refusal);
            refused.answer(account_page(&view, Some(&refused)))
        }
    }
}

async fn set_password(
    app: &Arc<BoothApp>,
    StaffForm { login, fields, .. }: &StaffForm,
) -> Result<Response, Refusal> {
    let name = login.account.clone();
    // The same limits as for logins apply, for a person who finds a tablet that is logged in.
    let asker = Asker::Account(name.clone());
    if !check_password(app, &asker, &name, fields.get("old")).await? {
        return Err(Refusal::Forbidden(Reason::WrongPassword));
    }
    let hash = hash_password(app, asker, fields.get("new")).await?;
    let of_name = name.clone();
    app.run(move |app| app.booth.set_password(&of_name, &hash, booth_time())).await?;
    begin_session(app, name).await
}
