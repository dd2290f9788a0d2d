//! Protection against cross-site request forgery: changes that another site's page requests are refused,
//! whatever cookies the browser sends.

use axum::extract::Request;
use axum::http::{HeaderMap, header};
use axum::middleware::Next;
use axum::response::Response;
use paros_booth_rules::{Reason, Refusal};

use super::page::StaffAnswer;
use super::texts::Texts;

/// Refuses requests that change something unless the booth's own pages sent them. Uses the headers `Origin`
/// and `Sec-Fetch-Site`, which browsers add. A client without these headers isn't a browser, so another site
/// can't use its cookies.
pub(crate) async fn check_origin(request: Request, next: Next) -> Result<Response, StaffAnswer> {
    let headers = request.headers();
    if request.method().is_safe() || is_from_own_page(headers) {
        return Ok(next.run(request).await);
    }
    Err(StaffAnswer(Texts::of_request(headers), Refusal::Forbidden(Reason::ForeignPage)))
}

/// Returns `true` if `Origin` is the requested host and `Sec-Fetch-Site` is this site, each if present.
fn is_from_own_page(headers: &HeaderMap) -> bool {
    let host = headers.get(header::HOST).map_or(&b""[..], |host| host.as_bytes());
    // The staff's pages are served only over TLS.
    let is_own = |origin: &[u8]| {
        origin.strip_prefix(b"https://").is_some_and(|of| of.eq_ignore_ascii_case(host))
    };
    let mut origins = headers.get_all(header::ORIGIN).iter();
    let mut sites = headers.get_all("sec-fetch-site").iter();
    // "none" is an action of the user, such as the reload of a page after a form.
    origins.all(|origin| is_own(origin.as_bytes()))
        && sites.all(|site| matches!(site.as_bytes(), b"same-origin" | b"none"))
}
