//! The studio's writes: submits sessions, sculptures and traces to the file writer, and reports the outcomes
//! to the visitor.

use std::path::PathBuf;

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};

use super::autosave::FailureNotice;
use super::sculpture_files::MadeSculpture;
use super::{Notice, Studio};
use crate::durable::{self, StorageLimit};
use crate::file_writer::{Destination, FileKind, WriteJob, WriteOutcome};
use crate::statics::Resident;

/// The stem of the names of a sculpture's files.
pub(super) const SCULPTURE_STEM: &str = "sculpture";

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Submits a save of the session, now or as soon as the last save has been written.
    pub(super) fn save_session(&mut self) {
        self.autosave.submit_save_or_stay_due(&self.session, &mut self.file_writer);
    }

    /// Waits for all pending writes, and for saves that become due meanwhile.
    ///
    /// # Errors
    /// Returns the error of the first write that failed.
    pub(super) fn wait_for_writes(&mut self) -> Result<(), durable::WriteError> {
        let mut done = Ok(());
        self.submit_last_use();
        while let Some(outcome) = self.file_writer.wait_for_next_outcome() {
            done = done.and(self.handle_write_outcome(outcome));
            if self.autosave.is_due() {
                self.save_session();
            }
            self.submit_last_use();
        }
        done
    }

    /// Submits a finished sculpture's files, once all are ready.
    pub(super) fn submit_finished_sculpture(&mut self) {
        match self.export.take_finished_files() {
            None => {}
            Some(Ok(MadeSculpture { files, badge })) => {
                if let Some(receiver) = &mut self.receiver {
                    receiver.keep(badge);
                }
                if files.is_empty() {
                    return;
                }
                let (extensions, bytes) = files.into_iter().unzip();
                self.submit_numbered_files(FileKind::Sculpture, SCULPTURE_STEM, extensions, bytes);
            }
            Some(Err(why)) => {
                if let Some(receiver) = &mut self.receiver {
                    receiver.abandon();
                }
                self.push_notice(Notice::Bad(why));
            }
        }
    }

    /// Submits numbered files to the sculptures' folder or, if that fails, the sessions' folder.
    pub(super) fn submit_numbered_files(
        &mut self,
        kind: FileKind,
        stem: &'static str,
        extensions: Vec<&'static str>,
        bytes: Vec<Vec<u8>>,
    ) {
        let folders = vec![self.paths.sculptures.clone(), self.paths.sessions.clone()];
        self.submit_job(WriteJob {
            kind,
            destination: Destination::NextFree { folders, stem, extensions },
            contents: bytes,
        });
    }

    /// Submits files, and counts those of a sculpture until the writer answers.
    pub(super) fn submit_job(&mut self, job: WriteJob) {
        if job.kind == FileKind::Sculpture {
            self.export.note_submitted();
        }
        self.file_writer.submit_or_wait(job);
    }

    /// Handles a write's outcome: adds messages for the visitor, takes back the save's buffer, and keeps
    /// failed sculptures for a retry.
    ///
    /// # Errors
    /// Returns the write's error.
    pub(super) fn handle_write_outcome(
        &mut self,
        outcome: WriteOutcome,
    ) -> Result<(), durable::WriteError> {
        self.notice_storage_warnings();
        if let Some(refused) = outcome.fallback_cause {
            self.push_notice(Notice::Bad(refused.to_string()));
        }
        let kind = outcome.job.kind;
        if kind == FileKind::Sculpture {
            self.export.note_answered();
        }
        let written = outcome.result.map(|paths| self.report_written(kind, paths));
        let error = written.as_ref().err();
        if kind == FileKind::Session {
            if self.autosave.reclaim_buffer(outcome.job, error) == FailureNotice::Due
                && let Some(error) = error
            {
                self.push_notice(Notice::Bad(format!("the session can't be saved: {error}")));
            }
            return written;
        }
        if kind == FileKind::LastUse {
            if let Some(text) = self.last_use.reclaim_buffer(outcome.job, error) {
                self.push_notice(Notice::Bad(text));
            }
            return written;
        }
        if let Some(error) = error {
            self.push_notice(Notice::Bad(error.to_string()));
            if matches!(kind, FileKind::Sculpture | FileKind::PreviousSession) {
                self.export.keep_failed_job(outcome.job);
            }
        }
        written
    }

    /// Adds messages for the storage's warnings.
    fn notice_storage_warnings(&mut self) {
        for warning in durable::take_storage_warnings() {
            let text = warning.to_string();
            self.push_notice(match warning.limit {
                StorageLimit::UnsyncedFolder => Notice::Bad(text),
                StorageLimit::NoLinks => Notice::Good(text),
            });
        }
    }

    fn report_written(&mut self, kind: FileKind, paths: Vec<PathBuf>) {
        match kind {
            FileKind::Sculpture => self.export.set_session_stl_path(paths.into_iter().next()),
            FileKind::Trace => {
                let path = paths.first().map_or(String::new(), |path| path.display().to_string());
                self.push_notice(Notice::Good(format!("recorded: {path}")));
            }
            FileKind::Session
            | FileKind::PreviousSession
            | FileKind::LastUse
            | FileKind::PipelineCache => {}
        }
    }
}
