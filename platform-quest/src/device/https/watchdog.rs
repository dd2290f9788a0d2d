//! A deadline for whole requests. Java only has timeouts for connecting and for each read, not for writes or
//! a whole response, which may arrive byte by byte for a day. `HttpURLConnection.disconnect` may be called
//! from another thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::Instant;

use jni::objects::{Global, JObject};
use jni::{Env, JavaVM};

use super::API_LEVEL;
use crate::device::call::{JavaCaller, JavaError};
use crate::device::table::DISCONNECT;

/// A thread that closes a connection whose request takes too long. It ends when this handle is dropped.
#[derive(Debug)]
pub(super) struct Watchdog {
    tell: Sender<Option<Watch>>,
}

/// A connection that is closed at its deadline, and then marked as late.
#[derive(Debug)]
struct Watch {
    connection: Global<JObject<'static>>,
    deadline: Instant,
    is_late: Arc<AtomicBool>,
}

impl Watchdog {
    pub(super) fn start(vm: JavaVM) -> Self {
        let (tell, told) = channel();
        // If the system refuses a thread, only Java's own timeouts remain.
        let _ = thread::Builder::new().name("link".into()).spawn(move || keep_watch(&vm, &told));
        Watchdog { tell }
    }

    /// Closes a connection at `deadline`, unless [`rest`](Watchdog::rest) is called before. Returns a flag
    /// that becomes `true` when the connection is closed.
    pub(super) fn watch(
        &self,
        connection: Global<JObject<'static>>,
        deadline: Instant,
    ) -> Arc<AtomicBool> {
        let is_late = Arc::new(AtomicBool::new(false));
        let watch = Watch { connection, deadline, is_late: Arc::clone(&is_late) };
        // Sending fails if there is no thread.
        let _ = self.tell.send(Some(watch));
        is_late
    }

    /// Ends the watch, as the request is over.
    pub(super) fn rest(&self) {
        let _ = self.tell.send(None);
    }
}

fn keep_watch(vm: &JavaVM, told: &Receiver<Option<Watch>>) {
    // The thread stays attached while it runs, as it releases references.
    let _ = vm.attach_current_thread(|_| Ok::<_, JavaError>(()));
    while let Ok(watch) = told.recv() {
        let Some(Watch { connection, deadline, is_late }) = watch else { continue };
        let left = deadline.saturating_duration_since(Instant::now());
        if matches!(told.recv_timeout(left), Err(RecvTimeoutError::Timeout)) {
            is_late.store(true, Ordering::Release);
            let closed = vm.attach_current_thread(|env: &mut Env<'_>| -> Result<_, JavaError> {
                JavaCaller::new(env, API_LEVEL).call_method(DISCONNECT, &connection, &[])
            });
            // If closing fails, the request has already ended.
            let _ = closed;
        }
    }
}
