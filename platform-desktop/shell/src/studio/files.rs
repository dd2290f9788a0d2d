//! What the studio reads and writes: sessions, sculptures, traces.

use std::io::ErrorKind;

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

    /// Has the session written.
    pub(super) fn save(&mut self) {
        if self.world.session() == Session::Waiting {
            return;
        }
        let bytes = self.saved_world();
        self.keeper.keep(What::Session, self.places.session(N), bytes);
        (self.changed, self.saved) = (false, self.world.tick());
    }

    pub(super) fn saved_world(&self) -> Vec<u8> {
        let mut bytes = vec![0; self.world.save(&mut [])];
        let len = self.world.save(&mut bytes);
        debug_assert_eq!(len, bytes.len());
        bytes
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
        match (kept.done, kept.what) {
            (Ok(_), What::Session) => self.fault = None,
            (Ok(paths), What::Sculpture) => self.printed = paths.into_iter().next(),
            (Ok(paths), What::Trace) => {
                let path = paths.first().map_or(String::new(), |path| path.display().to_string());
                self.note(Note::Good(format!("recorded: {path}")));
            }
            (_, What::Cache) | (Ok(_), What::Before) => {}
            (Err((error, job)), what) => {
                match what {
                    // Told while it lasts, and tried again.
                    What::Session => {
                        if self.fault.is_none() {
                            self.note(Note::Bad(format!("the session can't be saved: {error}")));
                        }
                        (self.fault, self.changed) = (Some(error.to_string()), true);
                    }
                    _ => self.note(Note::Bad(error.to_string())),
                }
                if matches!(what, What::Sculpture | What::Before) {
                    self.unwritten.push(job);
                }
                return Some(error);
            }
        }
        None
    }
}
