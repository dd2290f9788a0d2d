//! Threads that do one thing after the other, when they are woken and now and then.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// A thread; it ends when this is dropped, after what it does.
pub(crate) struct Worker {
    wake: SyncSender<()>,
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What wakes the thread.
#[derive(Clone)]
pub(crate) struct Waker(SyncSender<()>);

impl Worker {
    /// Starts the thread. `work` does one thing, and says for how long there is nothing to do if nobody wakes it.
    #[must_use]
    pub(crate) fn start(mut work: impl FnMut() -> Duration + Send + 'static) -> Self {
        let (wake, woken) = sync_channel(1);
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = is_over.clone();
        let thread = thread::spawn(move || {
            while !ends.load(Ordering::Relaxed) {
                // Woken or not, it looks again.
                let _ = woken.recv_timeout(work());
            }
        });
        Worker { wake, is_over, thread: Some(thread) }
    }

    /// Ends the thread without waiting for what it does, as that may wait for somebody else.
    pub(crate) fn leave(mut self) {
        // Without its handle, nobody waits.
        self.thread = None;
    }

    /// What tells the thread that there is work.
    #[must_use]
    pub(crate) fn waker(&self) -> Waker {
        Waker(self.wake.clone())
    }
}

impl Waker {
    /// Tells the thread that there is work.
    pub(crate) fn wake(&self) {
        // Full, it is about to look; closed, nobody waits for it.
        let _ = self.0.try_send(());
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        // Full, it is about to look.
        let _ = self.wake.try_send(());
        if let Some(thread) = self.thread.take() {
            // A panic of it was printed.
            let _ = thread.join();
        }
    }
}
