//! The time of the headset's last use, in a file beside the session's save, for shells whose visitors change.
//! Other shells don't use it, and resume any session that they find.

use std::path::PathBuf;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};

use super::Studio;
use crate::durable::{self, WriteError};
use crate::file_writer::{Destination, FileKind, FileWriter, WriteJob};
use crate::last_use::LastUse;
use crate::statics::Resident;

/// The file, with one buffer that is lent to the file writer.
pub(super) struct LastUseFile {
    /// The write job; `None` while it is being written.
    job: Option<WriteJob>,
    /// The time to write next.
    pending: Option<LastUse>,
    /// `true` if the last write failed.
    is_failing: bool,
}

impl LastUseFile {
    /// Creates a state with nothing to write.
    pub(super) fn new(path: PathBuf) -> Self {
        let job = WriteJob {
            kind: FileKind::LastUse,
            destination: Destination::Replace(vec![path]),
            contents: vec![Vec::with_capacity(LastUse::BYTES)],
        };
        LastUseFile { job: Some(job), pending: None, is_failing: false }
    }

    /// Takes back the buffer. Returns a message for the visitor for the first failure in a row. A failed
    /// write is not retried, as the next time follows soon.
    pub(super) fn reclaim_buffer(
        &mut self,
        job: WriteJob,
        error: Option<&WriteError>,
    ) -> Option<String> {
        self.job = Some(job);
        let was_failing = core::mem::replace(&mut self.is_failing, error.is_some());
        let error = error.filter(|_| !was_failing)?;
        Some(format!("the time of the last use can't be kept: {error}"))
    }

    fn submit_if_free(&mut self, file_writer: &mut FileWriter) {
        if let Some(last_use) = self.pending
            && let Some(mut job) = self.job.take()
        {
            for bytes in &mut job.contents {
                bytes.clear();
                bytes.extend_from_slice(&last_use.encode());
            }
            file_writer.submit_or_wait(job);
            self.pending = None;
        }
    }
}

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Keeps the time at which this session's visitor was last seen. The time is written only once the
    /// session is on the disk: beside a former visitor's session it would assign that session to this
    /// visitor.
    pub fn keep_last_use(&mut self, last_use: LastUse) {
        self.last_use.pending = Some(last_use);
    }

    /// Reads the time that is stored beside the session on the disk.
    ///
    /// # Errors
    /// Returns a line for the log, with the file's path, if the file can't be read or holds no such time.
    pub fn read_last_use(&self) -> Result<LastUse, String> {
        let path = self.paths.last_use_file(N);
        let bytes = durable::read_regular_file_up_to(&path, LastUse::BYTES as u64);
        let bytes = bytes.map_err(|error| format!("{}: cannot read: {error}", path.display()))?;
        LastUse::decode(&bytes).map_err(|bad| {
            format!("{}: offset {}: expected {}", path.display(), bad.offset, bad.expected)
        })
    }

    /// Submits the time to write, if its session is on the disk and the last write is done.
    pub(super) fn submit_last_use(&mut self) {
        if self.autosave.is_this_session_on_disk() {
            self.last_use.submit_if_free(&mut self.file_writer);
        }
    }
}
