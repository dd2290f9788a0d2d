//! Error pages with the staff's frame: the menu of the logged-in account, and a link back.

use axum::extract::Request;
use axum::http::{Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use maud::html;
use paros_booth_rules::{Expected, LoggedIn, Reason, Refusal};

use super::page::{Told, frame_page};
use super::refusal_texts::tell_refusal;
use super::texts::Texts;
use crate::server::page_guard::add_headers;

/// Renders bare HTTP errors as pages in the browser's language. Redirects a GET of a form's address, such as
/// a reload after a refusal, to the form's page.
pub(crate) async fn keep_frame(request: Request, next: Next) -> Response {
    let path = request.uri().path().to_owned();
    if !is_for_people(&path) {
        return next.run(request).await;
    }
    let texts = Texts::of_request(request.headers());
    let login = request.extensions().get::<LoggedIn>().cloned();
    let is_get = request.method() == Method::GET;
    let answer = next.run(request).await;
    let status = answer.status();
    if is_get && status == StatusCode::METHOD_NOT_ALLOWED {
        return Redirect::to(page_of(&path)).into_response();
    }
    let why = match answer.extensions().get::<Told>() {
        Some(Told(why)) if login.is_some() => why.clone(),
        None if is_error(status) && !is_page(&answer) => {
            tell_refusal(texts.language, &refusal_of(status))
        }
        _ => return answer,
    };
    let body = html! {
        p class="note" role="alert" { (why) }
        p { a class="button" href=(page_of(&path)) { (texts.back) } }
    };
    let mut framed = frame_page(texts, login.as_ref(), None, texts.not_done, &body);
    *framed.status_mut() = status;
    add_headers(&mut framed);
    if let Some(seconds) = answer.headers().get(header::RETRY_AFTER) {
        framed.headers_mut().insert(header::RETRY_AFTER, seconds.clone());
    }
    framed
}

/// Returns the page that contains a form or a file; otherwise the list of sculptures.
fn page_of(path: &str) -> &str {
    let end_of = |count: usize| path.match_indices('/').nth(count).map(|(end, _)| &path[..end]);
    let (page, parts) = match path.split('/').nth(2) {
        Some("sculptures" | "badges") => (end_of(3), 4),
        Some("prints" | "headsets" | "admin" | "account" | "import") => (end_of(2), 3),
        Some("login") => (Some("/staff/login"), 2),
        Some("first") => (Some("/staff/first"), 2),
        _ => (None, 0),
    };
    page.filter(|_| path.split('/').count() > parts).unwrap_or("/staff")
}

/// Returns `true` if people visit this path, not headsets or monitoring.
fn is_for_people(path: &str) -> bool {
    !["/v1/", "/viewer/", "/healthz", "/metrics"].iter().any(|start| path.starts_with(start))
}

fn is_error(status: StatusCode) -> bool {
    status.is_client_error() || status.is_server_error()
}

fn is_page(answer: &Response) -> bool {
    let kind = answer.headers().get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    kind.is_some_and(|kind| kind.starts_with("text/html"))
}

/// Interprets the status of an error that didn't come from the pages.
const fn refusal_of(status: StatusCode) -> Refusal {
    match status {
        StatusCode::NOT_FOUND | StatusCode::METHOD_NOT_ALLOWED => Refusal::NotFound(Reason::NoPage),
        StatusCode::SERVICE_UNAVAILABLE | StatusCode::REQUEST_TIMEOUT => {
            Refusal::Overloaded { retry_after: 5 }
        }
        _ => Refusal::Unfit(Expected::Form),
    }
}

#[cfg(test)]
mod tests {
    use super::page_of;

    #[test]
    fn the_way_back_is_the_page_of_the_form() {
        for (path, page) in [
            ("/staff/sculptures/12/mail", "/staff/sculptures/12"),
            ("/staff/sculptures/12/model.stl", "/staff/sculptures/12"),
            ("/staff/sculptures/12", "/staff"),
            ("/staff/prints/5/slip", "/staff/prints"),
            ("/staff/prints/5/send/1", "/staff/prints"),
            ("/staff/headsets/1/2", "/staff/headsets"),
            ("/staff/admin/accounts/ana/disable", "/staff/admin"),
            ("/staff/admin", "/staff"),
            ("/staff/account/password", "/staff/account"),
            ("/staff/import/3/5.parcel", "/staff/import"),
            ("/staff/badges/7/delete", "/staff/badges/7"),
            ("/staff/badges/7", "/staff"),
            ("/staff/login", "/staff/login"),
            ("/staff/nothing", "/staff"),
            ("/", "/staff"),
            ("", "/staff"),
        ] {
            assert_eq!(page_of(path), page, "{path}");
        }
    }
}
