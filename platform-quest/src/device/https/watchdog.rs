//! Java bounds how long a connection takes to be there, and each read, but no write and no answer as a whole: one that
//! comes byte by byte may take all day. `HttpURLConnection.disconnect` may be called by another thread.

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

/// A thread that closes a connection on which a request takes too long. It ends when this is dropped.
#[derive(Debug)]
pub(super) struct Watchdog {
    tell: Sender<Option<Watch>>,
}

/// A connection that is closed at an instant, and then noted as late.
#[derive(Debug)]
struct Watch {
    connection: Global<JObject<'static>>,
    deadline: Instant,
    is_late: Arc<AtomicBool>,
}

impl Watchdog {
    pub(super) fn start(vm: JavaVM) -> Self {
        let (tell, told) = channel();
        // Where the system refuses a thread, Java's own bounds are left.
        let _ = thread::Builder::new().name("link".into()).spawn(move || keep_watch(&vm, &told));
        Watchdog { tell }
    }

    /// Closes a connection at an instant, unless [`rest`](Watchdog::rest) comes before. Returns whether it was closed,
    /// from then on.
    pub(super) fn watch(
        &self,
        connection: Global<JObject<'static>>,
        deadline: Instant,
    ) -> Arc<AtomicBool> {
        let is_late = Arc::new(AtomicBool::new(false));
        let watch = Watch { connection, deadline, is_late: Arc::clone(&is_late) };
        // It has ended where there is no thread.
        let _ = self.tell.send(Some(watch));
        is_late
    }

    /// The request is over.
    pub(super) fn rest(&self) {
        let _ = self.tell.send(None);
    }
}

fn keep_watch(vm: &JavaVM, told: &Receiver<Option<Watch>>) {
    // Attached as long as it runs: it gives references back.
    let _ = vm.attach_current_thread(|_| Ok::<_, JavaError>(()));
    while let Ok(watch) = told.recv() {
        let Some(Watch { connection, deadline, is_late }) = watch else { continue };
        let left = deadline.saturating_duration_since(Instant::now());
        if matches!(told.recv_timeout(left), Err(RecvTimeoutError::Timeout)) {
            is_late.store(true, Ordering::Release);
            let closed = vm.attach_current_thread(|env: &mut Env<'_>| -> Result<_, JavaError> {
                JavaCaller::new(env, API_LEVEL).call_method(DISCONNECT, &connection, &[])
            });
            // Then the request is over by itself.
            let _ = closed;
        }
    }
}
