//! Changes that another site's page asks for are refused, whatever cookies the browser sends with them.

use axum::extract::Request;
use axum::http::{HeaderMap, header};
use axum::middleware::Next;
use axum::response::Response;
use paros_booth_rules::{Reason, Refusal};

use super::page::StaffAnswer;
use super::texts::Texts;

/// Refuses requests that change something and that the booth's own pages didn't send, by the headers that browsers add to
/// each. A client that sends neither header is no browser, and other sites can't use its cookies.
pub(crate) async fn check_origin(request: Request, next: Next) -> Result<Response, StaffAnswer> {
    let headers = request.headers();
    if request.method().is_safe() || is_from_own_page(headers) {
        return Ok(next.run(request).await);
    }
    Err(StaffAnswer(Texts::of_request(headers), Refusal::Forbidden(Reason::ForeignPage)))
}

/// Returns `true` if `Origin` is the host that was asked and `Sec-Fetch-Site` is this site, each where it is present.
fn is_from_own_page(headers: &HeaderMap) -> bool {
    let host = headers.get(header::HOST).map_or(&b""[..], |host| host.as_bytes());
    // The staff's pages are served over TLS alone.
    let is_own = |origin: &[u8]| {
        origin.strip_prefix(b"https://").is_some_and(|of| of.eq_ignore_ascii_case(host))
    };
    let mut origins = headers.get_all(header::ORIGIN).iter();
    let mut sites = headers.get_all("sec-fetch-site").iter();
    // "none": a person's own doing, such as loading again a page that a form led to.
    origins.all(|origin| is_own(origin.as_bytes()))
        && sites.all(|site| matches!(site.as_bytes(), b"same-origin" | b"none"))
}
