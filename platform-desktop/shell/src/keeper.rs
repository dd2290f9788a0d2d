//! Writes files beside the frames: a disk may take longer to sync than a frame lasts.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread::{self, JoinHandle};

use crate::durable::{self, Target};

/// What is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum What {
    /// The session under way.
    Session,
    /// A finished sculpture's print, volume and picture.
    Sculpture,
    /// A trace.
    Trace,
    /// The driver's compiled programs.
    Cache,
}

/// What became of files.
#[derive(Debug)]
pub struct Kept {
    /// What they are.
    pub what: What,
    /// The files, in the order in which they were given.
    pub paths: Vec<PathBuf>,
    /// Whether they are on the disk; none is if one is not.
    pub done: Result<(), durable::Error>,
}

type Job = (What, Vec<(PathBuf, Vec<u8>)>);

/// A thread that writes files, in the order in which they come.
#[derive(Debug)]
pub struct Keeper {
    jobs: Option<Sender<Job>>,
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
        let (jobs, todo) = channel::<Job>();
        let (tell, kept) = channel();
        let work = move || {
            for (what, files) in todo {
                let done = write(&files);
                let paths = files.into_iter().map(|(path, _)| path).collect();
                if tell.send(Kept { what, paths, done }).is_err() {
                    break;
                }
            }
        };
        Keeper { jobs: Some(jobs), kept, thread: Some(thread::spawn(work)), pending: 0 }
    }

    /// Has files written, all or none; their folders are made.
    pub fn keep(&mut self, what: What, files: Vec<(PathBuf, Vec<u8>)>) {
        if let Some(jobs) = &self.jobs {
            self.pending += usize::from(jobs.send((what, files)).is_ok());
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

fn write(files: &[(PathBuf, Vec<u8>)]) -> Result<(), durable::Error> {
    let mut targets = Vec::new();
    for (path, bytes) in files {
        if let Some(folder) = path.parent() {
            durable::make_folder(folder)?;
        }
        targets.push((Target::new(path)?, &bytes[..]));
    }
    durable::write_all(&targets)
}

#[cfg(test)]
mod tests {
    use super::{Keeper, What};

    #[test]
    fn files_are_written_in_order_and_all_or_none() {
        let folder = std::env::temp_dir().join(format!("paros-keeper-{}", std::process::id()));
        let (a, b) = (folder.join("deep/a"), folder.join("b"));
        let mut keeper = Keeper::new();
        for bytes in [b"old".to_vec(), b"new".to_vec()] {
            keeper.keep(What::Session, vec![(a.clone(), bytes)]);
        }
        // A folder can't be replaced by a file.
        keeper.keep(What::Trace, vec![(b.clone(), vec![1]), (folder.join("deep"), vec![2])]);
        let heard: Vec<_> = std::iter::from_fn(|| keeper.wait()).collect();
        assert!(heard[0].done.is_ok() && heard[1].done.is_ok() && heard[2].done.is_err());
        assert_eq!((heard[2].what, heard.len()), (What::Trace, 3));
        assert_eq!(std::fs::read(&a).expect("written"), b"new");
        assert!(!b.exists());
        std::fs::remove_dir_all(&folder).expect("the folder can be removed");
    }
}
