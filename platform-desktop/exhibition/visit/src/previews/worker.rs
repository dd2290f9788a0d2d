//! A thread that previews run on: the frame's thread gives it ticks and takes its pictures, and waits for neither.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use paros_core::session::SessionMode;
use paros_shaders::Image;

use super::show::PreviewShow;

/// Ticks that wait while a picture is drawn. Where it takes longer, further ones are left out: previews are slower then,
/// not late.
const WAITING_TICKS: usize = 4;

/// Pictures that wait for a frame; where none is drawn further ones are left out.
const WAITING_PICTURES: usize = 4;

/// Worlds and density fields are made on the stack before they are boxed, in a debug build more than once.
const STACK_BYTES: usize = 16 << 20;

/// The thread, as long as this lives.
#[derive(Debug)]
pub(crate) struct PreviewWorker {
    ticks: Option<SyncSender<()>>,
    pictures: Receiver<(u8, Image)>,
    thread: Option<JoinHandle<()>>,
}

impl PreviewWorker {
    /// Starts the previews of starts. None where the system has no thread left.
    pub(crate) fn spawn(starts: &[SessionMode]) -> Option<Self> {
        let (ticks, due) = sync_channel(WAITING_TICKS);
        let (drawn, pictures) = sync_channel(WAITING_PICTURES);
        let starts = starts.to_vec();
        let builder = thread::Builder::new().name("previews".into()).stack_size(STACK_BYTES);
        let thread = builder.spawn(move || run_previews(&starts, &due, &drawn)).ok()?;
        Some(PreviewWorker { ticks: Some(ticks), pictures, thread: Some(thread) })
    }

    /// Has a tick run, unless too many wait.
    pub(crate) fn pass_tick(&self) {
        if let Some(ticks) = &self.ticks {
            // A full queue leaves it out.
            let _ = ticks.try_send(());
        }
    }

    /// A picture that is drawn, and its cell.
    pub(crate) fn take_picture(&self) -> Option<(u8, Image)> {
        self.pictures.try_recv().ok()
    }

    /// Has the thread end once the tick or picture that it is at is done.
    pub(crate) fn close(&mut self) {
        self.ticks = None;
    }

    /// Whether the thread has ended.
    pub(crate) fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for PreviewWorker {
    fn drop(&mut self) {
        self.close();
        if let Some(thread) = self.thread.take() {
            // Previews that panicked are pictures that stand still.
            let _ = thread.join();
        }
    }
}

/// Runs a tick for each that is due, until there are no more to come.
fn run_previews(starts: &[SessionMode], due: &Receiver<()>, drawn: &SyncSender<(u8, Image)>) {
    // Pictures are drawn on this thread alone: other cores are the frame's.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    let Ok(pool) = pool else { return };
    let mut show = PreviewShow::new(starts);
    let mut is_open = true;
    while is_open && due.recv().is_ok() {
        if let Some(picture) = pool.install(|| show.run_tick()) {
            // Where too many wait, a newer one comes.
            is_open = !matches!(
                drawn.try_send(picture),
                Err(std::sync::mpsc::TrySendError::Disconnected(_))
            );
        }
    }
}
