//! Worker threads: each does one task after the other, when it is woken and at intervals.

use std::mem;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// The `nice` value of background work, such as slicing.
pub(crate) const LOW_PRIORITY: i32 = 15;

/// The `nice` value of work on whole parcels: headsets wait for it, but heartbeats, which are short, go
/// first.
pub(crate) const WHOLE_PRIORITY: i32 = 5;

/// A worker thread. Dropping this waits for its current task, and ends it.
pub(crate) struct Worker {
    wake: SyncSender<()>,
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// A handle that wakes the thread.
#[derive(Clone)]
pub(crate) struct Waker(SyncSender<()>);

impl Worker {
    /// Starts the thread. `work` does one task, and returns the time until its next call if nothing wakes it.
    #[must_use]
    pub(crate) fn start(mut work: impl FnMut() -> Duration + Send + 'static) -> Self {
        let (wake, woken) = sync_channel(1);
        let is_over = Arc::new(AtomicBool::new(false));
        let ends = is_over.clone();
        let thread = thread::spawn(move || {
            while !ends.load(Ordering::Relaxed) {
                // Works again after a wake-up or a timeout.
                let _ = woken.recv_timeout(work());
            }
        });
        Worker { wake, is_over, thread: Some(thread) }
    }

    /// Starts the thread with a low priority: for work that takes a processor for a while and that nothing
    /// waits for.
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

    /// Ends the thread without waiting for its current task, which may wait for another machine.
    pub(crate) fn leave(mut self) {
        // Without its handle, the drop doesn't join the thread.
        self.thread = None;
    }

    /// Returns a handle that wakes the thread.
    #[must_use]
    pub(crate) fn waker(&self) -> Waker {
        Waker(self.wake.clone())
    }
}

impl Waker {
    /// Wakes the thread, as there is work.
    pub(crate) fn wake(&self) {
        // A full channel means that the thread is about to work; a closed one, that it has ended.
        let _ = self.0.try_send(());
    }
}

/// Sets the `nice` value of this thread: threads with a smaller value go first. The default is 0.
pub(crate) fn go_behind(priority: i32) {
    // Without permission, only latency suffers. Linux sets the priority of a single thread.
    let _ = rustix::process::setpriority_process(Some(rustix::thread::gettid()), priority);
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        // If the channel is full, the thread is about to work anyway.
        let _ = self.wake.try_send(());
        if let Some(thread) = self.thread.take() {
            // A panic was printed already.
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
