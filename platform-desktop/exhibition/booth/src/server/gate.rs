//! A semaphore with a waiting line of limited length and time. If the line is full, a request is rejected at
//! once with a time to retry, instead of a timeout later.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use paros_booth_rules::Refusal;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

/// The seconds after which a rejected request may be retried.
const RETRY_AFTER: u32 = 3;

/// A limited number of places, and a waiting line.
pub(crate) struct Gate {
    places: Arc<Semaphore>,
    waiting: AtomicUsize,
    most_waiting: usize,
    longest_wait: Duration,
}

/// A place in the waiting line. It is left on drop.
struct Waiting<'a>(&'a AtomicUsize);

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Gate {
    #[must_use]
    pub(crate) fn new(places: usize, most_waiting: usize, longest_wait: Duration) -> Self {
        let places = Arc::new(Semaphore::new(places));
        Gate { places, waiting: AtomicUsize::new(0), most_waiting, longest_wait }
    }

    /// Waits for a place, first come, first served.
    ///
    /// # Errors
    /// [`Refusal::Overloaded`] if the line is full, or the wait took too long.
    pub(crate) async fn enter(&self) -> Result<OwnedSemaphorePermit, Refusal> {
        const OVERLOADED: Refusal = Refusal::Overloaded { retry_after: RETRY_AFTER };
        if let Ok(place) = self.places.clone().try_acquire_owned() {
            return Ok(place);
        }
        let before = self.waiting.fetch_add(1, Ordering::Relaxed);
        let _waiting = Waiting(&self.waiting);
        if before >= self.most_waiting {
            return Err(OVERLOADED);
        }
        let place = timeout(self.longest_wait, self.places.clone().acquire_owned()).await;
        place.ok().and_then(Result::ok).ok_or(OVERLOADED)
    }
}

#[cfg(test)]
mod tests {
    use std::pin::pin;
    use std::time::{Duration, Instant};

    use paros_booth_rules::Refusal;
    use tokio::time::timeout;

    use super::Gate;

    fn run<T>(test: impl Future<Output = T>) -> T {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build();
        runtime.expect("a thread").block_on(test)
    }

    #[test]
    fn a_line_that_is_too_long_is_told_at_once() {
        run(async {
            let gate = Gate::new(1, 2, Duration::from_secs(60));
            let place = gate.enter().await.expect("it is free");
            let (mut second, mut third) = (pin!(gate.enter()), pin!(gate.enter()));
            for waiting in [second.as_mut(), third.as_mut()] {
                assert!(timeout(Duration::from_millis(5), waiting).await.is_err(), "it waits");
            }
            let start = Instant::now();
            let refused = gate.enter().await.expect_err("two wait");
            assert!(matches!(refused, Refusal::Overloaded { retry_after: 1.. }));
            assert_eq!((refused.status(), refused.retry_after()), (503, Some(3)));
            assert!(start.elapsed() < Duration::from_secs(30));
            drop(place);
            let place = second.await.expect("its turn");
            assert!(timeout(Duration::from_millis(5), third.as_mut()).await.is_err(), "taken");
            drop(place);
            drop(third.await.expect("its turn"));
            assert!(gate.enter().await.is_ok(), "all are gone");
        });
    }

    #[test]
    fn nobody_waits_for_too_long_and_who_gave_up_is_in_no_line() {
        run(async {
            let gate = Gate::new(1, 1, Duration::from_millis(20));
            let _place = gate.enter().await.expect("it is free");
            for _ in 0..3 {
                let start = Instant::now();
                assert!(gate.enter().await.is_err());
                assert!(start.elapsed() >= Duration::from_millis(20), "it waited its time");
            }
        });
    }
}
