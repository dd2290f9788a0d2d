//! Threads that do one thing after the other, when they are woken and now and then.

use std::mem;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// As that of slicers.
pub(crate) const LOW_PRIORITY: i32 = 15;

/// That of work on whole parcels, which headsets wait for: behind heartbeats, which take a moment.
pub(crate) const WHOLE_PRIORITY: i32 = 5;

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

    /// The same at a low priority: what waits for nobody, and takes a processor for a while.
    #[must_use]
    pub(crate) fn start_behind(mut work: impl FnMut() -> Duration + Send + 'static) -> Self {
        let mut is_behind = false;
        Worker::start(move || {
            if !mem::replace(&mut is_behind, true) {
                go_behind(LOW_PRIORITY);
            }
            work()
        })
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

/// Has threads of a smaller number go before this one, from now on: others have 0.
pub(crate) fn go_behind(priority: i32) {
    // Where it isn't granted, it is a little slower for who waits. Linux counts it by threads.
    let _ = rustix::process::setpriority_process(Some(rustix::thread::gettid()), priority);
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

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::time::Duration;

    use rustix::process::getpriority_process;

    use super::{LOW_PRIORITY, Worker};

    #[test]
    fn only_who_is_to_go_behind_does() {
        let own = || getpriority_process(Some(rustix::thread::gettid())).expect("Linux");
        let (tell, told) = channel();
        let of_first = tell.clone();
        let look = Duration::from_secs(60);
        let first = Worker::start_behind(move || {
            of_first.send(own()).expect("it is waited for");
            look
        });
        assert_eq!(told.recv().expect("it runs"), LOW_PRIORITY.max(own()));
        let second = Worker::start(move || {
            tell.send(own()).expect("it is waited for");
            look
        });
        assert_eq!(told.recv().expect("it runs"), own());
        drop((first, second));
    }
}
