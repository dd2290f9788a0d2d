//! The thread of previews. The frame's thread sends it ticks and receives pictures, without blocking.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use paros_core::session::SessionMode;
use paros_shaders::Image;

use super::show::PreviewShow;

/// Capacity of the queue of ticks while a picture is drawn. Further ticks are dropped: previews get slower,
/// but don't lag.
const WAITING_TICKS: usize = 4;

/// Capacity of the queue of pictures. Further pictures are dropped if no frame is drawn.
const WAITING_PICTURES: usize = 4;

/// Stack size: worlds and density fields are made on the stack, in a debug build more than once.
const STACK_BYTES: usize = 16 << 20;

/// A handle to the thread, which ends when the handle is dropped.
#[derive(Debug)]
pub(crate) struct PreviewWorker {
    ticks: Option<SyncSender<()>>,
    pictures: Receiver<(u8, Image)>,
    thread: Option<JoinHandle<()>>,
}

impl PreviewWorker {
    /// Starts the previews of these starts. Returns `None` if the system can't start a thread.
    pub(crate) fn spawn(starts: &[SessionMode]) -> Option<Self> {
        let (ticks, due) = sync_channel(WAITING_TICKS);
        let (drawn, pictures) = sync_channel(WAITING_PICTURES);
        let starts = starts.to_vec();
        let builder = thread::Builder::new().name("previews".into()).stack_size(STACK_BYTES);
        let thread = builder.spawn(move || run_previews(&starts, &due, &drawn)).ok()?;
        Some(PreviewWorker { ticks: Some(ticks), pictures, thread: Some(thread) })
    }

    /// Sends a tick, unless too many are waiting.
    pub(crate) fn pass_tick(&self) {
        if let Some(ticks) = &self.ticks {
            // A full queue drops the tick.
            let _ = ticks.try_send(());
        }
    }

    /// Returns a finished picture with its cell; `None` if none is ready.
    pub(crate) fn take_picture(&self) -> Option<(u8, Image)> {
        self.pictures.try_recv().ok()
    }

    /// Makes the thread end after its current tick or picture.
    pub(crate) fn close(&mut self) {
        self.ticks = None;
    }

    /// Returns `true` if the thread has ended.
    pub(crate) fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for PreviewWorker {
    fn drop(&mut self) {
        self.close();
        if let Some(thread) = self.thread.take() {
            // After a panic, previews just stand still.
            let _ = thread.join();
        }
    }
}

/// Runs a tick for each received one, until the sender is dropped.
fn run_previews(starts: &[SessionMode], due: &Receiver<()>, drawn: &SyncSender<(u8, Image)>) {
    // Pictures are drawn on this thread only, which leaves the other cores to the frame.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    let Ok(pool) = pool else { return };
    let mut show = PreviewShow::new(starts);
    let mut is_open = true;
    while is_open && due.recv().is_ok() {
        if let Some(picture) = pool.install(|| show.run_tick()) {
            // If the queue is full, this picture is dropped. A newer one follows.
            is_open = !matches!(
                drawn.try_send(picture),
                Err(std::sync::mpsc::TrySendError::Disconnected(_))
            );
        }
    }
}
