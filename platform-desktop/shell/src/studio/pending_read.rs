//! A file read in a thread, so that no frame waits for it.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_core::volume::{Grid, Size};

use super::{Notice, SessionToStart, Studio, VolumeReader};
use crate::statics::Resident;

/// A file being read into the static range maps of its size.
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

    /// Returns the result once the thread is done. Does not block.
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

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Copies the last volume read to the visitor's own start volume. Returns the session that starts from
    /// it; `None` if another file is being read since, or the volume was offered already.
    pub fn offer_read_volume(&mut self) -> Option<SessionToStart> {
        core::mem::take(&mut self.has_read_volume).then(|| {
            let own = self.session.volumes.offer_visitor_volume();
            own.copy_from(&Grid::<N>::lock_range_maps());
            SessionToStart { mode: SessionMode::Own }
        })
    }

    /// Starts to read a file for a new session. Only one file is read at a time; others are rejected with a
    /// message.
    pub fn open_file(&mut self, path: &Path, reader: VolumeReader) {
        match &self.pending_read {
            None => {
                self.has_read_volume = false;
                self.pending_read = Some(PendingRead::spawn(path, reader));
            }
            Some(pending) => {
                let (path, first) = (path.display(), pending.path.display());
                self.push_notice(Notice::Bad(format!(
                    "{path}: not opened, {first} is still being read"
                )));
            }
        }
    }
}
