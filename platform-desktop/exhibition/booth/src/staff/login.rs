//! Logging in and out, and the first account.

use std::net::IpAddr;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use axum::extract::{Extension, Form, Request, State};
use axum::http::HeaderMap;
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use maud::html;
use paros_booth_rules::{Reason, Refusal, SessionBits};
use std::sync::Arc;
use subtle::ConstantTimeEq as _;
use tokio::sync::Semaphore;

use super::done::Done;
use super::forms::{FormView, Refused};
use super::page::{Fields, StaffAnswer, find_cookie, frame_page, with_cookie};
use super::passwords::{hash_password, verify_password};
use super::texts::Texts;
use crate::clock::booth_time;
use crate::random::random_bytes;
use crate::server::app::BoothApp;
use crate::server::connections::{Connection, Holder};
use crate::server::rate::RateLimiter;
use crate::server::routes::Peer;

/// The cookie of a login: sent to this host alone, over TLS alone, unseen by scripts, from no other site's pages.
const COOKIE: &str = "__Host-paros";

/// The forms' names on their pages.
const LOGIN_FORM: &str = "login";
const FIRST_FORM: &str = "first";

/// Passwords that are hashed at once: each takes 19 MiB.
const MAX_HASHES: usize = 2;

/// What logging in needs to remember.
pub(crate) struct LoginGate {
    /// What the first account has to bring; `None` once there is one.
    first_code: Mutex<Option<String>>,
    of_account: RateLimiter<String>,
    of_address: RateLimiter<IpAddr>,
    pub(super) hashes: Semaphore,
}

impl LoginGate {
    /// With the code that the first account has to bring.
    pub(crate) fn new(first_code: Option<String>) -> Self {
        LoginGate {
            first_code: Mutex::new(first_code),
            of_account: RateLimiter::new(5, 1.0 / 30.0),
            of_address: RateLimiter::new(20, 1.0 / 10.0),
            hashes: Semaphore::new(MAX_HASHES),
        }
    }

    pub(super) fn take_turn(&self, account: &str, peer: IpAddr) -> Result<(), Refusal> {
        let now = Instant::now();
        let account = account.chars().take(64).collect();
        if self.of_address.take(peer, now) && self.of_account.take(account, now) {
            return Ok(());
        }
        Err(Refusal::Busy { what: "logins", retry_after: 30 })
    }

    fn is_first_code(&self, code: &str) -> bool {
        let first = self.first_code.lock().unwrap_or_else(PoisonError::into_inner);
        first.as_ref().is_some_and(|first| bool::from(first.as_bytes().ct_eq(code.as_bytes())))
    }
}

/// Lets those on who are logged in, and sends others to log in.
pub(crate) async fn require_login(
    State(app): State<Arc<BoothApp>>,
    Extension(connection): Extension<Arc<Connection>>,
    mut request: Request,
    next: Next,
) -> Result<Response, StaffAnswer> {
    let texts = Texts::of_request(request.headers());
    let found = match read_cookie(request.headers()) {
        Some(cookie) => app.run(move |app| app.booth.find_login(&cookie, booth_time())).await,
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
    Extension(Peer(peer)): Extension<Peer>,
    headers: HeaderMap,
    Form(fields): Form<Fields>,
) -> Response {
    let texts = Texts::of_request(&headers);
    try_to_log_in(&app, peer, &fields).await.unwrap_or_else(|refusal| {
        let refused = Refused::new(texts, LOGIN_FORM, fields, &refusal);
        refused.answer(login_page(texts, Some(&refused)))
    })
}

async fn try_to_log_in(
    app: &Arc<BoothApp>,
    peer: IpAddr,
    fields: &Fields,
) -> Result<Response, Refusal> {
    let (name, password) = (fields.get("name"), fields.get("password"));
    app.logins.take_turn(&name, peer)?;
    let of_name = name.clone();
    let hash = app.run(move |app| app.booth.password_hash(&of_name)).await?;
    if !verify_password(app, password, hash).await? {
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
    Extension(Peer(peer)): Extension<Peer>,
    headers: HeaderMap,
    Form(fields): Form<Fields>,
) -> Response {
    let texts = Texts::of_request(&headers);
    match try_to_add_first(&app, peer, &fields).await {
        Ok(answer) => Done::AccountAdded.tell_on_next_page(answer),
        Err(refusal) => {
            let refused = Refused::new(texts, FIRST_FORM, fields, &refusal);
            refused.answer(first_page(texts, Some(&refused)))
        }
    }
}

async fn try_to_add_first(
    app: &Arc<BoothApp>,
    peer: IpAddr,
    fields: &Fields,
) -> Result<Response, Refusal> {
    app.logins.take_turn("", peer)?;
    if !app.logins.is_first_code(fields.get("code").trim()) {
        return Err(Refusal::Forbidden(Reason::WrongFirstCode));
    }
    let name = fields.get("name");
    let hash = hash_password(app, fields.get("password")).await?;
    let of_name = name.clone();
    app.run(move |app| app.booth.add_first_admin(&of_name, &hash, booth_time())).await?;
    *app.logins.first_code.lock().unwrap_or_else(PoisonError::into_inner) = None;
    begin_session(app, name).await
}

/// `POST /staff/logout`.
pub(crate) async fn log_out(
    State(app): State<Arc<BoothApp>>,
    headers: HeaderMap,
) -> Result<Response, StaffAnswer> {
    if let Some(cookie) = read_cookie(&headers) {
        let texts = Texts::of_request(&headers);
        let done = app.run(move |app| app.booth.log_out(&cookie)).await;
        done.map_err(|refusal| StaffAnswer(texts, refusal))?;
    }
    let gone = format!("{COOKIE}=; Path=/; Secure; HttpOnly; SameSite=Strict; Max-Age=0");
    Ok(with_cookie(Redirect::to("/staff/login").into_response(), &gone))
}

pub(super) async fn begin_session(app: &Arc<BoothApp>, name: String) -> Result<Response, Refusal> {
    let bits = SessionBits { cookie: random_bytes()?, form_token: random_bytes()? };
    app.run(move |app| app.booth.log_in(&name, &bits, booth_time())).await?;
    let value: String = bits.cookie.iter().map(|byte| format!("{byte:02x}")).collect();
    let cookie = format!("{COOKIE}={value}; Path=/; Secure; HttpOnly; SameSite=Strict");
    Ok(with_cookie(Redirect::to("/staff").into_response(), &cookie))
}

fn read_cookie(headers: &HeaderMap) -> Option<[u8; 32]> {
    let value = find_cookie(headers, COOKIE)?;
    // Its form is that of all tokens of 256 bits.
    paros_protocol::DeviceToken::parse_hex(value).map(|token| token.0)
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
