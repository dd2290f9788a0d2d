//! Live updates of open pages by server-sent events: at each event, a page loads its contents again.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::body::Body;
use axum::extract::State;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use maud::{Markup, html};
use paros_booth_rules::Refusal;
use tokio::time::{sleep, timeout};

use super::login::{COOKIE, read_token};
use crate::clock::booth_time;
use crate::server::app::BoothApp;
use crate::server::changes::ChangeWatch;

/// The header of requests that a page's script makes. They don't prolong the login.
pub(super) const LIVE: &str = "paros-live";

/// The address of the event stream.
pub(super) const CHANGES_PATH: &str = "/staff/changes";

/// The longest time between two events: changes by printers, and by other booths with the same records, are
/// not notified.
const LONGEST: Duration = Duration::from_secs(10);

/// The shortest time between two events, as a page takes some milliseconds.
const SHORTEST: Duration = Duration::from_secs(1);

/// Marks a part of a page that is updated live. `name` is unique on the page.
pub(super) fn live(name: &str, body: &Markup) -> Markup {
    html! { div id={ "live-" (name) } data-live { (body) } }
}

/// The state of an event stream.
struct LiveStream {
    app: Arc<BoothApp>,
    cookie: [u8; 32],
    changes: ChangeWatch,
    is_over: bool,
}

/// `GET /staff/changes`: a `text/event-stream` with an event after each change and every ten seconds, and an
/// event `ended` at the end of the login.
pub(crate) async fn stream_changes(
    State(app): State<Arc<BoothApp>>,
    headers: HeaderMap,
) -> Response {
    let changes = app.changes.watch();
    // The route requires a login.
    let cookie = read_token(&headers, COOKIE).unwrap_or_default();
    let first = LiveStream { app, cookie, changes, is_over: false };
    let events = stream::unfold(first, |stream| async move {
        let (event, stream) = stream.next_event().await?;
        Some((Ok::<_, Infallible>(event), stream))
    });
    ([(header::CONTENT_TYPE, "text/event-stream")], Body::from_stream(events)).into_response()
}

impl LiveStream {
    /// Waits for the next event. Returns `None` after the login or the program has ended.
    async fn next_event(mut self) -> Option<(&'static str, Self)> {
        if self.is_over {
            return None;
        }
        sleep(SHORTEST).await;
        if timeout(LONGEST, self.changes.changed()).await == Ok(false) {
            return None;
        }
        let cookie = self.cookie;
        let login = self.app.run_small(move |app| app.booth.peek_login(&cookie, booth_time()));
        if let Err(Refusal::UnknownToken) = login.await {
            self.is_over = true;
            return Some(("event: ended\ndata:\n\n", self));
        }
        Some(("data:\n\n", self))
    }
}
