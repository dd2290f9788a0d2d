//! What comes of a request after its head: bounded in time from when the booth begins to read it, so that what
//! the booth itself takes is nobody's fault.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::{Body, Bytes};
use hyper::body::{Body as HttpBody, Frame, SizeHint};
use paros_booth_rules::limits::MAX_CHUNK_BYTES;
use tokio::time::{Sleep, sleep};

/// A body that has to be there within a time.
struct TimedBody {
    body: Body,
    longest: Duration,
    /// From when on it is too late, once somebody reads it.
    deadline: Option<Pin<Box<Sleep>>>,
    is_late: Arc<AtomicBool>,
}

/// A body that has so long from when it is first read; and whether it came too late.
pub(crate) fn bound_body(body: Body, longest: Duration) -> (Body, Arc<AtomicBool>) {
    let is_late = Arc::new(AtomicBool::new(false));
    let timed = TimedBody { body, longest, deadline: None, is_late: is_late.clone() };
    (Body::new(timed), is_late)
}

impl HttpBody for TimedBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let polled = Pin::new(&mut self.body).poll_frame(context);
        if polled.is_ready() {
            return polled;
        }
        let longest = self.longest;
        let deadline = self.deadline.get_or_insert_with(|| Box::pin(sleep(longest)));
        if deadline.as_mut().poll(context).is_pending() {
            return Poll::Pending;
        }
        self.is_late.store(true, Ordering::Relaxed);
        let late = io::Error::new(io::ErrorKind::TimedOut, "it took too long");
        Poll::Ready(Some(Err(axum::Error::new(late))))
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// Takes what comes of a body and forgets it: who is still sending when the connection is closed doesn't hear why.
pub(crate) async fn pass_over(mut body: Body) {
    let mut left = MAX_CHUNK_BYTES;
    let mut body = Pin::new(&mut body);
    while let Some(Ok(frame)) =
        std::future::poll_fn(|context| body.as_mut().poll_frame(context)).await
    {
        let more = frame.data_ref().map_or(0, Bytes::len);
        match left.checked_sub(more) {
            Some(rest) => left = rest,
            None => return,
        }
    }
}
