//! What the studio reads and writes: sessions, sculptures, traces.

use std::io::ErrorKind;
use std::path::PathBuf;

use paros_core::limits::save_bytes;
use paros_core::size::{Grid, Size};
use paros_core::world::Session;

use super::{Note, Studio};
use crate::durable;
use crate::keeper::{Job, Kept, Place, What};
use crate::statics::Resident;

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// Goes on with the session in the file, if it is one.
    pub(super) fn resume(&mut self) {
        let path = self.places.session(N);
        if self.places.window > 1 {
            let text = "another window has the studio's session; this one's is kept beside it, in";
            self.note(Note::Good(format!("{text} {}", path.display())));
        }
        let fault = match durable::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return,
            Err(error) => error.to_string(),
            Ok(bytes) => match self.world.load(&bytes) {
                Ok(()) => return,
                Err(bad) => format!("expected {} at byte {}", bad.expected, bad.offset),
            },
        };
        let aside = self.places.aside(N);
        let kept = match std::fs::rename(&path, &aside) {
            Ok(()) => format!("it is kept as {}", aside.display()),
            Err(error) => format!("it is {}, and can't be moved: {error}", path.display()),
        };
        self.note(Note::Bad(format!("the saved session can't be read: {fault}; {kept}")));
    }

    /// Has the session written. While the last save is, there is nothing to write this one in: it
    /// stays due.
    pub(super) fn save(&mut self) {
        if self.world.session() == Session::Waiting {
            return;
        }
        let Some(mut job) = self.saving.take() else {
            self.due = true;
            return;
        };
        job.bytes.iter_mut().for_each(|bytes| self.fill(bytes));
        self.keeper.give(job);
        (self.changed, self.due, self.saved) = (false, false, self.world.tick());
    }

    /// The world, in bytes that are held already if there is room in them for all that it can be.
    pub(super) fn fill(&self, bytes: &mut Vec<u8>) {
        bytes.resize(save_bytes(N), 0);
        let len = self.world.save(bytes);
        debug_assert!(len <= bytes.len(), "a world of {len} bytes");
        bytes.truncate(len);
    }

    /// Waits for all that is being written, and for a save that is due then.
    ///
    /// # Errors
    /// The first thing that could not be.
    pub(super) fn wait(&mut self) -> Result<(), durable::Error> {
        let mut done = Ok(());
        while let Some(kept) = self.keeper.wait() {
            if let Some(failed) = self.tell(kept) {
                done = done.and(Err(failed));
            }
            if self.due {
                self.save();
            }
        }
        done
    }

    pub(super) fn write_finished(&mut self) {
        let Some(finishing) = &mut self.finishing else { return };
        match finishing.files() {
            None => {}
            Some(Ok(files)) => {
                self.finishing = None;
                let (endings, bytes) = files.into_iter().unzip();
                self.give(What::Sculpture, "sculpture", endings, bytes);
            }
            Some(Err(why)) => {
                self.finishing = None;
                self.note(Note::Bad(why));
            }
        }
    }

    /// Has files written where the visitor finds them, or else beside the sessions.
    pub(super) fn give(
        &mut self,
        what: What,
        name: &'static str,
        endings: Vec<&'static str>,
        bytes: Vec<Vec<u8>>,
    ) {
        let folders = vec![self.places.sculptures.clone(), self.places.sessions.clone()];
        self.keeper.give(Job { what, place: Place::Free { folders, name, endings }, bytes });
    }

    /// Takes in what became of files; what is lost if no one tries again comes back.
    pub(super) fn tell(&mut self, kept: Kept) -> Option<durable::Error> {
        if let Some(refused) = kept.instead {
            self.note(Note::Bad(refused.to_string()));
        }
        let what = kept.job.what;
        let failed = match (kept.done, what) {
            (Err(error), What::Session) => {
                // Told while it lasts, and tried again.
                if self.fault.is_none() {
                    self.note(Note::Bad(format!("the session can't be saved: {error}")));
                }
                (self.fault, self.changed) = (Some(error.to_string()), true);
                Some(error)
            }
            (Err(error), _) => {
                self.note(Note::Bad(error.to_string()));
                Some(error)
            }
            (Ok(paths), _) => {
                self.tell_written(what, paths);
                None
            }
        };
        match what {
            What::Session => self.saving = Some(kept.job),
            What::Sculpture | What::Before if failed.is_some() => self.unwritten.push(kept.job),
            _ => {}
        }
        failed
    }

    fn tell_written(&mut self, what: What, paths: Vec<PathBuf>) {
        match what {
            What::Session => self.fault = None,
            What::Sculpture => self.printed = paths.into_iter().next(),
            What::Trace => {
                let path = paths.first().map_or(String::new(), |path| path.display().to_string());
                self.note(Note::Good(format!("recorded: {path}")));
            }
            What::Before | What::Cache => {}
        }
    }
}
