//! The shared parts of the staff's pages: frame, forms and refusals.

use std::collections::HashMap;

use axum::extract::{Extension, Form, FromRequest, FromRequestParts, Request};
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use maud::{DOCTYPE, Markup, html};
use paros_booth_rules::{LoggedIn, Refusal};
use serde::Deserialize;

use super::admin_texts::AdminTexts;
use super::done::{Done, forget_done};
use super::forms::Refused;
use super::list_texts::ListTexts;
use super::print_texts::PrintTexts;
use super::refusal_texts::tell_refusal;
use super::texts::Texts;

/// The fields of a form.
#[derive(Deserialize)]
#[serde(transparent)]
pub(crate) struct Fields(HashMap<String, String>);

impl Fields {
    /// Returns a field; an empty text if there is none.
    pub(crate) fn get(&self, name: &str) -> String {
        self.0.get(name).cloned().unwrap_or_default()
    }

    /// Checks that the form's token is that of the login.
    fn check(&self, login: &LoggedIn) -> Result<(), Refusal> {
        check_form(login, &self.get("form"))
    }
}

/// Checks that a form's token is that of a login.
pub(crate) fn check_form(login: &LoggedIn, token: &str) -> Result<(), Refusal> {
    // The form's token has the same format as an id.
    let token = paros_protocol::SculptureId::parse_hex(token);
    login.check_form(&token.map_or([0; 16], |token| token.0))
}

/// The context of a page: the login, the language, and the confirmation to show.
pub(crate) struct StaffView {
    pub(crate) login: LoggedIn,
    pub(crate) texts: &'static Texts,
    done: Option<Done>,
}

impl StaffView {
    /// Makes a page. Shows the confirmation once.
    pub(crate) fn page(&self, heading: &str, body: &Markup) -> Response {
        let page = frame_page(self.texts, Some(&self.login), self.done, heading, body);
        if self.done.is_some() { forget_done(page) } else { page }
    }
}

/// A form whose token was checked. Handlers never get an unchecked form.
pub(crate) struct StaffForm {
    pub(crate) login: LoggedIn,
    pub(crate) texts: &'static Texts,
    pub(crate) fields: Fields,
}

impl StaffForm {
    /// Returns the context and the refused form, to show the form's page again. `form` is the form's name on
    /// that page.
    pub(crate) fn refuse(self, form: &'static str, refusal: &Refusal) -> (StaffView, Refused) {
        let StaffForm { login, texts, fields } = self;
        let refused = Refused::new(texts, form, fields, refusal);
        (StaffView { login, texts, done: None }, refused)
    }
}

impl<S: Send + Sync> FromRequestParts<S> for StaffView {
    type Rejection = Response;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Response> {
        let login = Extension::from_request_parts(parts, state).await;
        let Extension(login) = login.map_err(IntoResponse::into_response)?;
        let (texts, done) = (Texts::of_request(&parts.headers), Done::of_request(&parts.headers));
        Ok(StaffView { login, texts, done })
    }
}

impl<S: Send + Sync> FromRequest<S> for StaffForm {
    type Rejection = Response;

    async fn from_request(request: Request, state: &S) -> Result<Self, Response> {
        let (mut parts, body) = request.into_parts();
        let StaffView { login, texts, .. } =
            StaffView::from_request_parts(&mut parts, state).await?;
        let form = Form::from_request(Request::from_parts(parts, body), state).await;
        let Form(fields): Form<Fields> = form.map_err(IntoResponse::into_response)?;
        match fields.check(&login) {
            Ok(()) => Ok(StaffForm { login, texts, fields }),
            Err(refusal) => Err(StaffAnswer(texts, refusal).into_response()),
        }
    }
}

/// The reason of a refusal, as an extension of the response. If somebody is logged in, the reason is rendered
/// with their menu.
#[derive(Clone)]
pub(crate) struct Told(pub(crate) String);

/// A refusal as a page.
pub(crate) struct StaffAnswer(pub(crate) &'static Texts, pub(crate) Refusal);

impl IntoResponse for StaffAnswer {
    fn into_response(self) -> Response {
        let StaffAnswer(texts, refusal) = self;
        let status = StatusCode::from_u16(refusal.status());
        let status = status.unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let why = tell_refusal(texts.language, &refusal);
        let body = html! {
            p class="note" role="alert" { (why) }
            p { a class="button" href="/staff" { (texts.back) } }
        };
        let mut answer = frame_page(texts, None, None, texts.not_done, &body);
        *answer.status_mut() = status;
        if let Some(seconds) = refusal.retry_after() {
            answer.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        answer.extensions_mut().insert(Told(why));
        answer
    }
}

/// Makes a page with its frame. With a login, the frame has the menu.
pub(crate) fn frame_page(
    texts: &Texts,
    login: Option<&LoggedIn>,
    done: Option<Done>,
    heading: &str,
    body: &Markup,
) -> Response {
    let markup = html! {
        (DOCTYPE)
        html lang=(texts.code) {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (heading) " – " (texts.title) }
                link rel="stylesheet" href="/staff/style.css";
                script src="/staff/page.js" defer {}
            }
            body {
                header {
                    @if let Some(login) = login {
                        nav aria-label=(texts.title) {
                            a href="/staff" { (ListTexts::of(texts.language).sculptures) } " "
                            a href="/staff/find" { (texts.find) } " "
                            a href="/staff/prints" { (PrintTexts::of(texts.language).prints) } " "
                            a href="/staff/headsets" { (texts.headsets) } " "
                            @if login.check_admin().is_ok() {
                                a href="/staff/admin" { (AdminTexts::of(texts).admin) } " "
                            }
                            a href="/staff/account" { (login.account) }
                        }
                        form method="post" action="/staff/logout" {
                            button { (texts.log_out) }
                        }
                    }
                    a href={ "/staff/language/" (texts.other_code) } lang=(texts.other_code) { (texts.other_language) }
                }
                main {
                    @if let Some(done) = done { (done.draw(texts.language)) }
                    h1 { (heading) }
                    (body)
                }
                footer { a href="/privacy" { (AdminTexts::of(texts).privacy_title) } }
            }
        }
    };
    Html(markup.into_string()).into_response()
}

/// Returns the token that each form of a login must send in a hidden field.
pub(crate) fn form_token(login: &LoggedIn) -> String {
    login.form_token.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Draws a button that posts to `action`, as a form of this login.
pub(crate) fn action_button(login: &LoggedIn, action: &str, text: &str, class: &str) -> Markup {
    html! {
        form method="post" action=(action) {
            input type="hidden" name="form" value=(form_token(login));
            button class=(class) { (text) }
        }
    }
}

/// Returns the value of a cookie by its name.
pub(crate) fn find_cookie<'a>(headers: &'a HeaderMap, name: &str) -> Option<&'a str> {
    let cookies = headers.get(header::COOKIE)?.to_str().ok()?;
    cookies.split("; ").find_map(|pair| pair.strip_prefix(name)?.strip_prefix('='))
}

/// Adds a cookie to a response.
pub(crate) fn with_cookie(mut answer: Response, cookie: &str) -> Response {
    if let Ok(value) = HeaderValue::from_str(cookie) {
        answer.headers_mut().append(header::SET_COOKIE, value);
    }
    answer
}
