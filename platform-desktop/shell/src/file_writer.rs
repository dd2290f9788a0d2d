//! Background file writer: one thread writes queued files in order, so that no frame waits for a
//! disk to sync.
//!
//! It takes [`WriteJob`]s and returns a [`WriteOutcome`] for each, in the same order. It does not interpret
//! the bytes.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, channel, sync_channel};
use std::thread::{self, JoinHandle};

use crate::durable::{self, WriteError, WriteTarget};

/// The kind of a job's files. The writer returns it with the outcome and does not use it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FileKind {
    /// The save of the current session.
    Session,
    /// The save of the session before it.
    PreviousSession,
    /// The time at which the headset was last used.
    LastUse,
    /// A finished sculpture: print, volume and picture.
    Sculpture,
    /// A recorded trace.
    Trace,
    /// The graphics driver's pipeline cache.
    PipelineCache,
}

/// The destination of a job's files.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Destination {
    /// Fixed paths. Existing files are replaced.
    Replace(Vec<PathBuf>),
    /// Numbered files: `STEM-NNN.EXTENSION` for each extension, with the first free number, in the first
    /// writable folder. No existing file is replaced.
    NextFree {
        /// The folders, in order of preference.
        folders: Vec<PathBuf>,
        /// The file name before the number.
        stem: &'static str,
        /// The extension of each file, without the dot.
        extensions: Vec<&'static str>,
    },
}

/// Files to be written.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct WriteJob {
    /// The kind of the files.
    pub kind: FileKind,
    /// Their destination.
    pub destination: Destination,
    /// The bytes of each file, in the order of the destination's paths or extensions.
    pub contents: Vec<Vec<u8>>,
}

/// The result of a [`WriteJob`].
#[derive(Debug)]
pub struct WriteOutcome {
    /// The job itself, so that it can be submitted again or its buffers reused.
    pub job: WriteJob,
    /// The paths written, in the order of the contents, or the first error.
    pub result: Result<Vec<PathBuf>, WriteError>,
    /// The error of the first folder, if the files went to a later one.
    pub fallback_cause: Option<WriteError>,
}

/// The capacity of the job queue. [`FileWriter::submit_or_wait`] blocks while the queue is full; in practice
/// it is not, as at most one save of a session is queued at a time, and visitors cause the other jobs. The
/// queue is allocated once: submitting a job allocates nothing.
const QUEUE_CAPACITY: usize = 16;

/// A thread that writes files in the order in which they are submitted. Dropping this waits until all files
/// are written.
#[derive(Debug)]
pub struct FileWriter {
    /// `None` only during drop: the thread ends when the queue is closed.
    queue: Option<SyncSender<WriteJob>>,
    outcomes: Receiver<WriteOutcome>,
    thread: Option<JoinHandle<()>>,
    /// Jobs submitted whose outcomes have not been received.
    pending: usize,
}

impl FileWriter {
    /// Starts the thread.
    #[must_use]
    pub fn spawn() -> Self {
        let (queue, jobs) = sync_channel::<WriteJob>(QUEUE_CAPACITY);
        let (outcome_sender, outcomes) = channel();
        let work = move || {
            for job in jobs {
                if outcome_sender.send(run_job(job)).is_err() {
                    break;
                }
            }
        };
        FileWriter { queue: Some(queue), outcomes, thread: Some(thread::spawn(work)), pending: 0 }
    }

    /// Submits one file that replaces the file at `path`. The writer creates its folder. Blocks while the
    /// queue is full.
    pub fn submit_file_or_wait(&mut self, kind: FileKind, path: PathBuf, bytes: Vec<u8>) {
        let destination = Destination::Replace(vec![path]);
        self.submit_or_wait(WriteJob { kind, destination, contents: vec![bytes] });
    }

    /// Submits files. The writer creates their folders. Blocks while the queue is full.
    pub fn submit_or_wait(&mut self, job: WriteJob) {
        if let Some(queue) = &self.queue {
            self.pending += usize::from(queue.send(job).is_ok());
        }
    }

    /// Returns `true` if outcomes are still to be received.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.pending > 0
    }

    /// Returns the outcome of the oldest pending job if it is done. Does not block.
    pub fn poll_outcome(&mut self) -> Option<WriteOutcome> {
        match self.outcomes.try_recv() {
            Ok(outcome) => {
                self.pending -= 1;
                Some(outcome)
            }
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => None,
        }
    }

    /// Waits for the outcome of the oldest pending job. Returns `None` if no job is pending.
    pub fn wait_for_next_outcome(&mut self) -> Option<WriteOutcome> {
        if self.pending == 0 {
            return None;
        }
        self.pending -= 1;
        self.outcomes.recv().ok()
    }
}

impl Drop for FileWriter {
    fn drop(&mut self) {
        self.queue = None;
        if let Some(thread) = self.thread.take() {
            // The thread should not panic; if it did, nothing can be done here.
            let _ = thread.join();
        }
    }
}

/// The result of writing files to one of several folders.
struct FolderWrite {
    /// The paths written, or the first folder's error.
    result: Result<Vec<PathBuf>, WriteError>,
    /// The first folder's error, if a later folder took the files.
    fallback_cause: Option<WriteError>,
}

fn run_job(job: WriteJob) -> WriteOutcome {
    let FolderWrite { result, fallback_cause } = match &job.destination {
        Destination::Replace(paths) => {
            FolderWrite { result: replace_files(paths, &job.contents), fallback_cause: None }
        }
        Destination::NextFree { folders, stem, extensions } => {
            write_to_first_writable_folder(folders, stem, extensions, &job.contents)
        }
    };
    WriteOutcome { job, result, fallback_cause }
}

fn replace_files(paths: &[PathBuf], contents: &[Vec<u8>]) -> Result<Vec<PathBuf>, WriteError> {
    durable::write_files(&prepare_targets(paths, contents)?)?;
    Ok(paths.to_vec())
}

/// Tries one folder after another.
fn write_to_first_writable_folder(
    folders: &[PathBuf],
    stem: &str,
    extensions: &[&str],
    contents: &[Vec<u8>],
) -> FolderWrite {
    let mut first_error = None;
    for folder in folders {
        match write_under_lowest_free_number(&folder.join(stem), extensions, contents) {
            Ok(paths) => return FolderWrite { result: Ok(paths), fallback_cause: first_error },
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    let no_folder =
        || WriteError { path: stem.into(), action: "create", source: ErrorKind::NotFound.into() };
    FolderWrite { result: Err(first_error.unwrap_or_else(no_folder)), fallback_cause: None }
}

/// Writes `STEM-NNN.EXTENSION` files under the lowest number that is free for all extensions.
fn write_under_lowest_free_number(
    path_stem: &Path,
    extensions: &[&str],
    contents: &[Vec<u8>],
) -> Result<Vec<PathBuf>, WriteError> {
    let mut number = 1;
    loop {
        let path = |extension: &&str| {
            let mut name = path_stem.as_os_str().to_owned();
            name.push(format!("-{number:03}.{extension}"));
            PathBuf::from(name)
        };
        let paths: Vec<PathBuf> = extensions.iter().map(path).collect();
        number += 1;
        if paths.iter().any(|path| path.symlink_metadata().is_ok()) {
            continue;
        }
        match durable::create_new_files(&prepare_targets(&paths, contents)?) {
            // Another process took the number in the meantime.
            Err(error) if error.source.kind() == ErrorKind::AlreadyExists => {}
            result => return result.map(|()| paths),
        }
    }
}

/// Creates the paths' folders and pairs each resolved path with its bytes.
fn prepare_targets<'a>(
    paths: &[PathBuf],
    contents: &'a [Vec<u8>],
) -> Result<Vec<(WriteTarget, &'a [u8])>, WriteError> {
    let pairs = paths.iter().zip(contents);
    pairs
        .map(|(path, bytes)| {
            if let Some(folder) = path.parent() {
                durable::make_folder(folder)?;
            }
            Ok((WriteTarget::resolve(path)?, &bytes[..]))
        })
        .collect()
}

#[cfg(test)]
mod tests;
