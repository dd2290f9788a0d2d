//! A fair queue for password hashing: a client that sends many passwords waits only for its own.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use paros_booth_rules::Refusal;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::server::gate::Gate;

/// The most passwords that are hashed at once: each takes 19 MiB.
const MAX_HASHES: usize = 2;

/// The most waiting passwords of one client: half a second's work.
const MAX_WAITING: usize = 16;

/// The longest wait for other passwords of the same client: a person is waiting at a browser.
const LONGEST_WAIT: Duration = Duration::from_secs(10);

/// Limits hashing in total, and to one password at a time for each client, so that a place is left for
/// others.
pub(crate) struct HashQueue<K> {
    places: Arc<Semaphore>,
    askers: Mutex<HashMap<K, Arc<Gate>>>,
}

/// A turn to hash a password. It ends on drop.
pub(crate) struct HashTurn {
    _of_asker: OwnedSemaphorePermit,
    _of_all: Option<OwnedSemaphorePermit>,
    _gate: Arc<Gate>,
}

impl<K: Eq + Hash> HashQueue<K> {
    pub(crate) fn new() -> Self {
        HashQueue { places: Arc::new(Semaphore::new(MAX_HASHES)), askers: Mutex::default() }
    }

    /// Waits for a turn. As each client has at most one password in the line for a place, a client waits for
    /// at most one password of each other client.
    ///
    /// # Errors
    /// [`Refusal::Overloaded`] if too many passwords of the same client wait.
    pub(crate) async fn enter(&self, asker: K) -> Result<HashTurn, Refusal> {
        let gate = self.gate_of(asker);
        let of_asker = gate.enter().await?;
        // The semaphore is never closed.
        let of_all = self.places.clone().acquire_owned().await.ok();
        Ok(HashTurn { _of_asker: of_asker, _of_all: of_all, _gate: gate })
    }

    fn gate_of(&self, asker: K) -> Arc<Gate> {
        let mut askers = self.askers.lock().unwrap_or_else(PoisonError::into_inner);
        askers.retain(|_, gate| Arc::strong_count(gate) > 1);
        let new = || Arc::new(Gate::new(1, MAX_WAITING, LONGEST_WAIT));
        askers.entry(asker).or_insert_with(new).clone()
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use paros_booth_rules::Refusal;
    use tokio::task::yield_now;
    use tokio::time::timeout;

    use super::{HashQueue, MAX_WAITING};

    #[test]
    fn who_sends_many_waits_for_their_own() {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build();
        runtime.expect("a thread").block_on(async {
            let queue = std::sync::Arc::new(HashQueue::new());
            let first = queue.enter(1).await.expect("it is free");
            let waiting: Vec<_> = (0..MAX_WAITING)
                .map(|_| {
                    let queue = queue.clone();
                    tokio::spawn(async move { queue.enter(1).await.map(drop) })
                })
                .collect();
            yield_now().await;
            let full = queue.enter(1).await.err().expect("the line is full");
            assert!(matches!(full, Refusal::Overloaded { .. }), "{full}");
            let second = queue.enter(2).await.expect("a place is left for others");
            assert!(timeout(Duration::from_millis(5), queue.enter(3)).await.is_err(), "two");
            drop(second);
            drop(queue.enter(3).await.expect("its turn"));
            assert!(waiting.iter().all(|waiting| !waiting.is_finished()), "one at a time");
            drop(first);
            for waiting in waiting {
                waiting.await.expect("it ends").expect("its turn");
            }
            drop(queue.enter(4).await);
            assert_eq!(queue.askers.lock().unwrap().len(), 1, "the others are forgotten");
        });
    }
}
