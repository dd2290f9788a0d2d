//! Who is logged in, and their password.

use std::sync::Arc;

use axum::extract::{Extension, State};
use axum::response::Response;
use maud::html;
use paros_booth_rules::Refusal;

use super::admin_texts::AdminTexts;
use super::login::{MIN_PASSWORD_CHARS, begin_session, hash_password, verify_password};
use super::page::{StaffAnswer, StaffForm, StaffView, form_token, page};
use crate::app::App;
use crate::clock::booth_time;
use crate::routes::Peer;

/// `GET /staff/account`.
pub(crate) async fn show_account(StaffView { login, texts }: StaffView) -> Response {
    let words = AdminTexts::of(texts);
    let body = html! {
        p { (login.account) ", " (words.role_name(login.role)) }
        form class="narrow" method="post" action="/staff/account/password" {
            input type="hidden" name="form" value=(form_token(&login));
            input type="hidden" name="name" value=(login.account) autocomplete="username";
            label { (words.old_password) input name="old" type="password" autocomplete="current-password" required; }
            label { (words.new_password) input name="new" type="password" autocomplete="new-password" required minlength=(MIN_PASSWORD_CHARS); }
            p { (words.logins_end) }
            button { (words.change_password) }
        }
    };
    page(texts, Some(&login), words.account, &body)
}

/// `POST /staff/account/password`: ends all logins of the account, and begins one anew.
pub(crate) async fn change_password(
    State(app): State<Arc<App>>,
    Extension(Peer(peer)): Extension<Peer>,
    StaffForm { login, texts, fields }: StaffForm,
) -> Result<Response, StaffAnswer> {
    let fail = |refusal| StaffAnswer(texts, refusal);
    let name = login.account;
    // Whoever found a tablet logged in guesses no faster than at the door.
    app.logins.take_turn(&name, peer).map_err(fail)?;
    let of_name = name.clone();
    let hash = app.run(move |app| app.booth.password_hash(&of_name)).await.map_err(fail)?;
    if !verify_password(&app, fields.get("old"), hash).await.map_err(fail)? {
        return Err(fail(Refusal::Forbidden("the password of now is another")));
    }
    let hash = hash_password(&app, fields.get("new")).await.map_err(fail)?;
    let of_name = name.clone();
    let set = app.run(move |app| app.booth.set_password(&of_name, &hash, booth_time())).await;
    set.map_err(fail)?;
    begin_session(&app, name).await.map_err(fail)
}
