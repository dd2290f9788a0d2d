//! Renews the lease of long work, so that no other process takes the work over.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

use paros_booth_rules::Booth;
use paros_booth_rules::limits::WORK_LIFE;
use paros_booth_rules::records::WorkKind;
use tracing::warn;

use crate::clock::booth_time;

/// The renewal interval: several renewals may fail before the lease expires.
const RENEW_EVERY: Duration = Duration::from_secs(WORK_LIFE.as_secs() / 5);

/// Runs work whose lease this process holds, and renews the lease meanwhile.
pub(crate) fn keep_work<T>(
    booth: &Booth,
    kind: WorkKind,
    subject: &[u8],
    work: impl FnOnce() -> T,
) -> T {
    renew_every(
        RENEW_EVERY,
        || {
            let renewed = booth.renew_work(kind, subject, booth_time());
            // After an error, keep trying. If another process took the work over meanwhile, for example while
            // this machine slept, the rules record only the first result.
            renewed.map_err(|error| warn!(%error, "a lease could not be renewed")).unwrap_or(true)
        },
        work,
    )
}

/// Runs work, and meanwhile calls `renew` at each interval until it returns `false`.
fn renew_every<T>(
    every: Duration,
    mut renew: impl FnMut() -> bool + Send,
    work: impl FnOnce() -> T,
) -> T {
    thread::scope(|scope| {
        let (end, ended) = channel::<()>();
        scope.spawn(move || {
            while ended.recv_timeout(every) == Err(RecvTimeoutError::Timeout) && renew() {}
        });
        let done = work();
        drop(end);
        done
    })
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    use super::renew_every;

    #[test]
    fn it_renews_while_the_work_goes_on_and_no_longer() {
        let count = AtomicU32::new(0);
        let renew = || count.fetch_add(1, Ordering::Relaxed) < 4;
        let done = renew_every(Duration::from_millis(20), renew, || {
            let start = Instant::now();
            while count.load(Ordering::Relaxed) < 5 && start.elapsed() < Duration::from_secs(20) {
                sleep(Duration::from_millis(5));
            }
            sleep(Duration::from_millis(60));
            7
        });
        assert_eq!((done, count.into_inner()), (7, 5), "one that is another's isn't renewed");
        let start = Instant::now();
        renew_every(Duration::from_secs(60), || true, || ());
        assert!(start.elapsed() < Duration::from_secs(30), "it waits for no renewal");
    }
}
