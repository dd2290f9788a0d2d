//! Security headers of all pages, the staff's and the visitors'.

use axum::extract::Request;
use axum::http::{HeaderName, HeaderValue, header};
use axum::middleware::Next;
use axum::response::Response;

/// The headers: pages load only the booth's own content and scripts, can't be framed or cached, and send no
/// referrer to other sites. The policy isn't `no-referrer`: then browsers would send `Origin: null` with the
/// booth's own forms.
const HEADERS: [(HeaderName, &str); 5] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; img-src 'self'; style-src 'self'; script-src 'self'; connect-src 'self'; \
         form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "same-origin"),
    (header::CACHE_CONTROL, "no-store"),
    (header::X_FRAME_OPTIONS, "DENY"),
];

/// Adds the security headers to every response.
pub(crate) async fn guard(request: Request, next: Next) -> Response {
    let mut answer = next.run(request).await;
    add_headers(&mut answer);
    answer
}

/// Adds the security headers to a response.
pub(crate) fn add_headers(answer: &mut Response) {
    for (name, value) in HEADERS {
        answer.headers_mut().insert(name, HeaderValue::from_static(value));
    }
}
