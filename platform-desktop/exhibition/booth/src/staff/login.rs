//! Login, logout, and the creation of the first account.

use std::sync::Arc;

use axum::extract::{Extension, Form, Request, State};
use axum::http::HeaderMap;
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use maud::html;
use paros_booth_rules::{Reason, Refusal, SessionBits};
use paros_protocol::DeviceToken;

use super::done::Done;
use super::forms::{FormView, Refused};
use super::live::{CHANGES_PATH, LIVE};
use super::login_gate::{Asker, check_password};
use super::page::{Fields, StaffAnswer, find_cookie, frame_page, with_cookie};
use super::passwords::hash_password;
use super::texts::Texts;
use crate::clock::booth_time;
use crate::random::random_bytes;
use crate::server::app::BoothApp;
use crate::server::connections::{Connection, Holder};
use crate::server::routes::Peer;

/// The session cookie. It is sent only to this host, over TLS, and from its own pages; scripts can't read it.
pub(super) const COOKIE: &str = "__Host-paros";

/// The cookie of a browser in which somebody has logged in before. It grants no access: it gives the
/// browser's logins their own rate limit.
pub(super) const BROWSER_COOKIE: &str = "__Host-paros-browser";

/// The longest time for which browsers keep a cookie, 400 days, in seconds.
const BROWSER_COOKIE_LIFE: u32 = 400 * 86_400;

/// The names of the forms on their pages.
const LOGIN_FORM: &str = "login";
const FIRST_FORM: &str = "first";

/// Lets requests with a valid login through, and redirects others to the login page.
pub(crate) async fn require_login(
    State(app): State<Arc<BoothApp>>,
    Extension(connection): Extension<Arc<Connection>>,
    mut request: Request,
    next: Next,
) -> Result<Response, StaffAnswer> {
    let texts = Texts::of_request(request.headers());
    let is_live = request.headers().contains_key(LIVE) || request.uri().path() == CHANGES_PATH;
    let found = match read_token(request.headers(), COOKIE) {
        Some(cookie) => {
            let find = move |app: &BoothApp| match is_live {
                true => app.booth.peek_login(&cookie, booth_time()),
                false => app.booth.find_login(&cookie, booth_time()),
            };
            app.run(find).await
        }
        None => Err(Refusal::UnknownToken),
    };
    match found {
        Ok(login) => {
            connection.hold(Holder::Account(login.account.clone()));
            request.extensions_mut().insert(login);
            Ok(next.run(request).await)
        }
        Err(Refusal::UnknownToken) => {
            let has_accounts = app.run(|app| app.booth.has_accounts()).await;
            let has_accounts = has_accounts.map_err(|refusal| StaffAnswer(texts, refusal))?;
            let to = if has_accounts { "/staff/login" } else { "/staff/first" };
            Ok(Redirect::to(to).into_response())
        }
        Err(refusal) => Err(StaffAnswer(texts, refusal)),
    }
}

/// `GET /staff/login`.
pub(crate) async fn show_login(headers: HeaderMap) -> Response {
    login_page(Texts::of_request(&headers), None)
}

/// `POST /staff/login`.
pub(crate) async fn log_in(
    State(app): State<Arc<BoothApp>>,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
    Form(fields): Form<Fields>,
) -> Response {
    let texts = Texts::of_request(&headers);
    let asker = Asker::of_request(&app, &headers, peer);
    try_to_log_in(&app, &asker, &fields).await.unwrap_or_else(|refusal| {
        let refused = Refused::new(texts, LOGIN_FORM, fields, &refusal);
        refused.answer(login_page(texts, Some(&refused)))
    })
}

async fn try_to_log_in(
    app: &Arc<BoothApp>,
    asker: &Asker,
    fields: &Fields,
) -> Result<Response, Refusal> {
    let name = fields.get("name");
    if !check_password(app, asker, &name, fields.get("password")).await? {
        return Err(Refusal::Forbidden(Reason::WrongLogin));
    }
    begin_session(app, name).await
}

/// `GET /staff/first`.
pub(crate) async fn show_first(headers: HeaderMap) -> Response {
    first_page(Texts::of_request(&headers), None)
}

/// `POST /staff/first`.
pub(crate) async fn add_first(
    State(app): State<Arc<BoothApp>>,
    Extension(peer): Extension<Peer>,
    headers: HeaderMap,
    Form(fields): Form<Fields>,
) -> Response {
    let texts = Texts::of_request(&headers);
    let asker = Asker::of_request(&app, &headers, peer);
    match try_to_add_first(&app, asker, &fields).await {
        Ok(answer) => Done::AccountAdded.tell_on_next_page(answer),
        Err(refusal) => {
            let refused = Refused::new(texts, FIRST_FORM, fields, &refusal);
            refused.answer(first_page(texts, Some(&refused)))
        }
    }
}

async fn try_to_add_first(
    app: &Arc<BoothApp>,
    asker: Asker,
    fields: &Fields,
) -> Result<Response, Refusal> {
    if !app.logins.check_first_code(&asker, fields.get("code").trim()).await? {
        return Err(Refusal::Forbidden(Reason::WrongFirstCode));
    }
    let name = fields.get("name");
    let hash = hash_password(app, asker, fields.get("password")).await?;
    let of_name = name.clone();
    app.run(move |app| app.booth.add_first_admin(&of_name, &hash, booth_time())).await?;
    app.logins.forget_first_code();
    begin_session(app, name).await
}

/// `POST /staff/logout`.
pub(crate) async fn log_out(
    State(app): State<Arc<BoothApp>>,
    headers: HeaderMap,
) -> Result<Response, StaffAnswer> {
    if let Some(cookie) = read_token(&headers, COOKIE) {
        let texts = Texts::of_request(&headers);
        let done = app.run(move |app| app.booth.log_out(&cookie)).await;
        done.map_err(|refusal| StaffAnswer(texts, refusal))?;
    }
    let gone = format!("{COOKIE}=; Path=/; Secure; HttpOnly; SameSite=Strict; Max-Age=0");
    Ok(with_cookie(Redirect::to("/staff/login").into_response(), &gone))
}

/// Begins a session of an authenticated account. The response sets the cookies of the session and of the
/// browser.
pub(super) async fn begin_session(app: &Arc<BoothApp>, name: String) -> Result<Response, Refusal> {
    let bits = SessionBits { cookie: random_bytes()?, form_token: random_bytes()? };
    let browser = app.booth.make_browser_token(&name);
    app.run(move |app| app.booth.log_in(&name, &bits, booth_time())).await?;
    let attributes = "Path=/; Secure; HttpOnly; SameSite=Strict";
    let session = format!("{COOKIE}={}; {attributes}", write_token(bits.cookie));
    let browser = format!(
        "{BROWSER_COOKIE}={}; {attributes}; Max-Age={BROWSER_COOKIE_LIFE}",
        write_token(browser)
    );
    let answer = with_cookie(Redirect::to("/staff").into_response(), &session);
    Ok(with_cookie(answer, &browser))
}

/// Writes the 256 bits of a cookie in the format of [`read_token`].
fn write_token(token: [u8; 32]) -> String {
    DeviceToken(token).reveal().to_string()
}

/// Reads the 256 bits of a cookie, by its name.
pub(super) fn read_token(headers: &HeaderMap, name: &str) -> Option<[u8; 32]> {
    let value = find_cookie(headers, name)?;
    // All tokens of 256 bits have this format.
    DeviceToken::parse_hex(value).map(|token| token.0)
}

fn login_page(texts: &Texts, refused: Option<&Refused>) -> Response {
    let form = FormView::of(refused, LOGIN_FORM);
    let body = html! {
        form class="narrow" method="post" action="/staff/login" {
            (form.why(""))
            label {
                (texts.name)
                input name="name" autocomplete="username" required value=(form.value("name", ""));
            }
            label {
                (texts.password)
                input name="password" type="password" autocomplete="current-password" required;
            }
            button { (texts.log_in) }
        }
    };
    frame_page(texts, None, None, texts.log_in, &body)
}

fn first_page(texts: &Texts, refused: Option<&Refused>) -> Response {
    let form = FormView::of(refused, FIRST_FORM);
    let body = html! {
        form class="narrow" method="post" action="/staff/first" {
            (form.why(""))
            label {
                (texts.code_of_start)
                input name="code" autocomplete="off" required value=(form.value("code", ""))
                    aria-invalid=[form.invalid("code")] aria-describedby=[form.described("code")];
            }
            (form.why("code"))
            label {
                (texts.name)
                input name="name" autocomplete="username" required value=(form.value("name", ""))
                    aria-invalid=[form.invalid("name")] aria-describedby=[form.described("name")];
            }
            (form.why("name"))
            (form.new_password_field(texts.password, "password"))
            button { (texts.first_account) }
        }
    };
    frame_page(texts, None, None, texts.first_account, &body)
}
