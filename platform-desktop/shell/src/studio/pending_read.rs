//! A file being read in a thread, so that no frame waits for it.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use super::VolumeReader;

/// A file being read. When it is done, the static range maps of its size hold it.
#[derive(Debug)]
pub(super) struct PendingRead {
    /// The file's path.
    pub(super) path: PathBuf,
    done: Receiver<Result<(), String>>,
}

impl PendingRead {
    /// Starts a thread that reads a file.
    #[must_use]
    pub(super) fn spawn(path: &Path, reader: VolumeReader) -> Self {
        let (tell, done) = channel();
        let file = path.to_owned();
        thread::spawn(move || {
            // The receiver is gone if the studio was dropped.
            let _ = tell.send(reader(&file));
        });
        PendingRead { path: path.to_owned(), done }
    }

    /// The result, once the thread is done. Does not block.
    #[must_use]
    pub(super) fn poll_result(&self) -> Option<Result<(), String>> {
        match self.done.try_recv() {
            Ok(done) => Some(done),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(format!("{}: could not be read", self.path.display())))
            }
        }
    }
}
