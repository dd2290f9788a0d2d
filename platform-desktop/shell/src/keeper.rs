//! Writes files beside the frames: a disk may take longer to sync than a frame lasts.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, channel, sync_channel};
use std::thread::{self, JoinHandle};

use crate::durable::{self, Target};

/// What is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum What {
    /// The session under way.
    Session,
    /// The session that was left for it.
    Before,
    /// A finished sculpture's print, volume and picture.
    Sculpture,
    /// A trace.
    Trace,
    /// The driver's compiled programs.
    Cache,
}

/// Where files go.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Place {
    /// To these paths, in place of what is there.
    At(Vec<PathBuf>),
    /// Beside what is there: under the first free number after a name, with an ending each, in the
    /// first of some folders that takes them.
    Free {
        /// The folders.
        folders: Vec<PathBuf>,
        /// The name before the number.
        name: &'static str,
        /// How each file's name ends.
        endings: Vec<&'static str>,
    },
}

/// Files to be written, all or none.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Job {
    /// What they are.
    pub what: What,
    /// Where they go.
    pub place: Place,
    /// What is in each.
    pub bytes: Vec<Vec<u8>>,
}

/// What became of files.
#[derive(Debug)]
pub struct Kept {
    /// The job, to be tried again, or filled anew.
    pub job: Job,
    /// The files, in the order in which they were given; or why there are none.
    pub done: Result<Vec<PathBuf>, durable::Error>,
    /// Why they are not in the folder that was meant.
    pub instead: Option<durable::Error>,
}

/// Jobs that wait at the most; who gives one more waits too. A session's save comes back before it
/// is given again, the others are a visitor's deeds. The room is made once, so that giving a job
/// takes no memory.
const WAITING: usize = 16;

/// A thread that writes files, in the order in which they come.
#[derive(Debug)]
pub struct Keeper {
    jobs: Option<SyncSender<Job>>,
    kept: Receiver<Kept>,
    thread: Option<JoinHandle<()>>,
    /// Jobs that have not been heard of again.
    pending: usize,
}

impl Keeper {
    /// Begins the thread.
    #[must_use]
    #[allow(clippy::new_without_default)] // a thread: to be made on purpose
    pub fn new() -> Self {
        let (jobs, todo) = sync_channel::<Job>(WAITING);
        let (tell, kept) = channel();
        let work = move || {
            for job in todo {
                if tell.send(write(job)).is_err() {
                    break;
                }
            }
        };
        Keeper { jobs: Some(jobs), kept, thread: Some(thread::spawn(work)), pending: 0 }
    }

    /// Has a file written in place of what is there; its folder is made.
    pub fn keep(&mut self, what: What, path: PathBuf, bytes: Vec<u8>) {
        self.give(Job { what, place: Place::At(vec![path]), bytes: vec![bytes] });
    }

    /// Has files written; their folders are made.
    pub fn give(&mut self, job: Job) {
        if let Some(jobs) = &self.jobs {
            self.pending += usize::from(jobs.send(job).is_ok());
        }
    }

    /// Whether something is still to be written.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.pending > 0
    }

    /// What became of the oldest files not yet told of, if they are done.
    pub fn heard(&mut self) -> Option<Kept> {
        match self.kept.try_recv() {
            Ok(kept) => {
                self.pending -= 1;
                Some(kept)
            }
            Err(TryRecvError::Empty | TryRecvError::Disconnected) => None,
        }
    }

    /// Waits for the oldest files not yet told of; none where there are no such.
    pub fn wait(&mut self) -> Option<Kept> {
        if self.pending == 0 {
            return None;
        }
        self.pending -= 1;
        self.kept.recv().ok()
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(thread) = self.thread.take() {
            // It has no reason to panic; nothing is left to do if it has.
            let _ = thread.join();
        }
    }
}

fn write(job: Job) -> Kept {
    let (done, instead) = match &job.place {
        Place::At(paths) => (write_at(paths, &job.bytes), None),
        Place::Free { folders, name, endings } => write_free(folders, name, endings, &job.bytes),
    };
    Kept { job, done, instead }
}

fn write_at(paths: &[PathBuf], bytes: &[Vec<u8>]) -> Result<Vec<PathBuf>, durable::Error> {
    durable::write_all(&targets(paths, bytes)?)?;
    Ok(paths.to_vec())
}

/// The files, and why they are not in the first folder.
fn write_free(
    folders: &[PathBuf],
    name: &str,
    endings: &[&str],
    bytes: &[Vec<u8>],
) -> (Result<Vec<PathBuf>, durable::Error>, Option<durable::Error>) {
    let mut refused = None;
    for folder in folders {
        match write_numbered(&folder.join(name), endings, bytes) {
            Ok(paths) => return (Ok(paths), refused),
            Err(error) => refused = refused.or(Some(error)),
        }
    }
    let none = || durable::Error {
        path: name.into(),
        action: "create",
        source: std::io::ErrorKind::NotFound.into(),
    };
    (Err(refused.unwrap_or_else(none)), None)
}

fn write_numbered(
    stem: &Path,
    endings: &[&str],
    bytes: &[Vec<u8>],
) -> Result<Vec<PathBuf>, durable::Error> {
    let mut number = 1;
    loop {
        let path = |ending: &&str| {
            let mut name = stem.as_os_str().to_owned();
            name.push(format!("-{number:03}.{ending}"));
            PathBuf::from(name)
        };
        let paths: Vec<PathBuf> = endings.iter().map(path).collect();
        number += 1;
        if paths.iter().any(|path| path.symlink_metadata().is_ok()) {
            continue;
        }
        match durable::write_all_new(&targets(&paths, bytes)?) {
            // Another window was faster.
            Err(error) if error.source.kind() == ErrorKind::AlreadyExists => {}
            done => return done.map(|()| paths),
        }
    }
}

fn targets<'a>(
    paths: &[PathBuf],
    bytes: &'a [Vec<u8>],
) -> Result<Vec<(Target, &'a [u8])>, durable::Error> {
    let pairs = paths.iter().zip(bytes);
    pairs
        .map(|(path, bytes)| {
            if let Some(folder) = path.parent() {
                durable::make_folder(folder)?;
            }
            Ok((Target::new(path)?, &bytes[..]))
        })
        .collect()
}

#[cfg(test)]
mod tests;
