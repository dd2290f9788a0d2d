//! A file on its way in, read beside the frames.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use super::Read;

/// A file on its way in. Once it is there, the resident maps of its size hold it.
#[derive(Debug)]
pub(super) struct Opening {
    /// The file.
    pub(super) path: PathBuf,
    done: Receiver<Result<(), String>>,
}

impl Opening {
    /// Begins to read a file.
    #[must_use]
    pub(super) fn begin(path: &Path, read: Read) -> Self {
        let (tell, done) = channel();
        let file = path.to_owned();
        thread::spawn(move || {
            // Nobody listens any more once the studio is closed.
            let _ = tell.send(read(&file));
        });
        Opening { path: path.to_owned(), done }
    }

    /// What came of it, once it has.
    #[must_use]
    pub(super) fn done(&self) -> Option<Result<(), String>> {
        match self.done.try_recv() {
            Ok(done) => Some(done),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => {
                Some(Err(format!("{}: could not be read", self.path.display())))
            }
        }
    }
}
