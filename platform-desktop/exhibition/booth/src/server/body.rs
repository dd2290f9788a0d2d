//! Request bodies with timeouts. The times count from when the booth begins to read the body, so that the
//! booth's own delays don't count.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::{Body, Bytes};
use hyper::body::{Body as HttpBody, Frame, SizeHint};
use tokio::time::{Instant, Sleep, sleep};

/// The most bytes of a request's body, except for parcels.
pub(crate) const MAX_REQUEST_BYTES: usize = 256 << 10;

/// The timeouts of a request's body.
#[derive(Clone, Copy)]
pub(crate) struct BodyTimes {
    /// The time from the first read to the end.
    pub(crate) whole: Duration,
    /// The longest time without progress.
    pub(crate) idle: Duration,
}

/// A body with timeouts.
struct TimedBody {
    body: Body,
    times: BodyTimes,
    /// The deadlines, which are set at the first read.
    deadlines: Option<Deadlines>,
    is_late: Arc<AtomicBool>,
}

/// The deadlines of a body: of the whole, and of the next progress.
struct Deadlines {
    end: Pin<Box<Sleep>>,
    idle: Pin<Box<Sleep>>,
}

/// Adds timeouts to a body. Returns it with a flag that becomes `true` if it is late.
pub(crate) fn bound_body(body: Body, times: BodyTimes) -> (Body, Arc<AtomicBool>) {
    let is_late = Arc::new(AtomicBool::new(false));
    let timed = TimedBody { body, times, deadlines: None, is_late: is_late.clone() };
    (Body::new(timed), is_late)
}

impl HttpBody for TimedBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let BodyTimes { whole, idle: longest_idle } = self.times;
        let polled = Pin::new(&mut self.body).poll_frame(context);
        let Deadlines { end, idle } = self.deadlines.get_or_insert_with(|| Deadlines {
            end: Box::pin(sleep(whole)),
            idle: Box::pin(sleep(longest_idle)),
        });
        let is_over = end.as_mut().poll(context).is_ready();
        if polled.is_ready() && !is_over {
            idle.as_mut().reset(Instant::now() + longest_idle);
            return polled;
        }
        if !is_over && idle.as_mut().poll(context).is_pending() {
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

/// Reads and discards a body. Otherwise a client that is still sending when the connection closes may not get
/// the response.
pub(crate) async fn pass_over(mut body: Body) {
    let mut left = MAX_REQUEST_BYTES;
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

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use futures_util::{StreamExt as _, stream};

    use super::*;

    /// Returns `true` if a body of `pieces` pieces, each after `each_ms` milliseconds, is late.
    async fn is_late(pieces: usize, each_ms: u64, times: BodyTimes) -> bool {
        let pieces = stream::iter(0..pieces).then(move |_| async move {
            sleep(Duration::from_millis(each_ms)).await;
            Ok::<_, Infallible>(Bytes::from_static(b"x"))
        });
        let (body, is_late) = bound_body(Body::from_stream(pieces), times);
        let read = axum::body::to_bytes(body, 1000).await;
        assert_eq!(read.is_err(), is_late.load(Ordering::Relaxed));
        read.is_err()
    }

    #[test]
    fn a_body_has_so_long_in_all_and_without_progress() {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build();
        runtime.expect("a thread").block_on(async {
            let [long, short] = [60_000, 400].map(Duration::from_millis);
            let idle = BodyTimes { whole: long, idle: short };
            assert!(!is_late(20, 40, idle).await, "each piece is progress");
            assert!(is_late(2, 1500, idle).await, "there is none");
            let whole = BodyTimes { whole: short, idle: long };
            assert!(is_late(100, 40, whole).await, "progress buys no time");
        });
    }
}
