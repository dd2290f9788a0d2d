//! A session and what comes of it: ticks, saves, prints, traces. It knows no window and no headset.

mod files;
mod finishing;
mod opening;

use std::path::{Path, PathBuf};

use crate::claim::Claim;
use crate::keeper::{Job, Keeper, Place, What};
use crate::places::Places;
use crate::print::Printer;
use crate::stage::{Recording, Stage};
use crate::starts::StartVolumes;
use crate::statics::Resident;
use crate::{durable, rmap};
use finishing::Finishing;
use opening::Opening;
use paros_core::events::Event;
use paros_core::input::{Input, Mode};
use paros_core::limits::save_bytes;
use paros_core::maps::Maps;
use paros_core::size::{Grid, Size};
use paros_core::world::{Session, World};

/// Draws a finished sculpture, as the bytes of a PNG file; in a thread, at its leisure.
pub type Portrait<const N: usize> = fn(&Maps<N>) -> Result<Vec<u8>, String>;

/// Reads a file into the resident maps of its size; in a thread.
pub type Read = fn(&Path) -> Result<(), String>;

/// Ticks from one save to the next while something changes: three seconds.
const SAVE_TICKS: u64 = 3 * 72;

/// Ticks after which a stroke's end is saved at once.
const STROKE_TICKS: u64 = 72;

/// Ticks that are recorded at the most of a session whose trace nobody has asked for: its first two
/// hours, 70 MiB.
const RECORD_TICKS: u32 = 2 * 60 * 60 * 72;

/// Something to tell the visitor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Note {
    /// All is well.
    Good(String),
    /// Something could not be done.
    Bad(String),
}

/// A world with its start volumes and its files.
pub struct Studio<'a, const N: usize>
where
    Grid<N>: Size,
{
    world: &'a mut World<N>,
    volumes: &'a mut StartVolumes<N>,
    printer: Printer<'a, N>,
    places: Places,
    portrait: Portrait<N>,
    keeper: Keeper,
    // Held for the session's file, until the keeper has written it.
    _claim: Claim,
    /// From the session's start on; none of a session that was resumed.
    recording: Option<Recording>,
    /// Whether sessions are recorded at all.
    records: bool,
    /// Where the last session's trace goes at the end.
    record_to: Option<PathBuf>,
    opening: Option<Opening>,
    finishing: Option<Finishing>,
    notes: Vec<Note>,
    /// Where the last print is.
    printed: Option<PathBuf>,
    /// Files of a sculpture, finished or left, that no folder took.
    unwritten: Vec<Job>,
    /// Why the session is not saved.
    fault: Option<String>,
    /// What saves the session, with room for all that it can be, while it is not being written.
    saving: Option<Job>,
    /// A save is to come as soon as the last one is written.
    due: bool,
    changed: bool,
    running: bool,
    saved: u64,
}

impl<'a, const N: usize> Studio<'a, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// A studio in which the last session goes on, if there is one.
    #[must_use]
    pub fn new(
        world: &'a mut World<N>,
        volumes: &'a mut StartVolumes<N>,
        printer: Printer<'a, N>,
        mut places: Places,
        portrait: Portrait<N>,
    ) -> Self {
        let claim = Claim::new(&places.sessions, N);
        places.window = claim.number();
        for folder in [&places.sculptures, &places.sessions, &places.cache] {
            durable::sweep(folder);
        }
        let saving = Job {
            what: What::Session,
            place: Place::At(vec![places.session(N)]),
            bytes: vec![vec![0; save_bytes(N)]],
        };
        let mut studio = Studio {
            world,
            volumes,
            printer,
            places,
            portrait,
            _claim: claim,
            keeper: Keeper::new(),
            recording: None,
            records: true,
            record_to: None,
            opening: None,
            finishing: None,
            notes: Vec::new(),
            printed: None,
            unwritten: Vec::new(),
            fault: None,
            saving: Some(saving),
            due: false,
            changed: false,
            running: false,
            saved: 0,
        };
        studio.resume();
        studio
    }

    /// The world as of the last tick.
    #[must_use]
    pub const fn world(&self) -> &World<N> {
        self.world
    }

    /// Records no sessions: a recording grows with every tick, and here nobody can ask for it.
    pub fn record_nothing(&mut self) {
        self.records = false;
    }

    /// Has the trace of the session that is under way at the end written to a file then.
    pub fn record_to(&mut self, path: Option<PathBuf>) {
        self.record_to = path;
    }

    /// Where files go.
    #[must_use]
    pub const fn places(&self) -> &Places {
        &self.places
    }

    /// Has files written beside the frames.
    pub const fn keeper(&mut self) -> &mut Keeper {
        &mut self.keeper
    }

    /// Where the last finished sculpture's print is.
    #[must_use]
    pub fn printed(&self) -> Option<&Path> {
        self.printed.as_deref()
    }

    /// Why the session is not on the disk, while it can't be written there.
    #[must_use]
    pub fn fault(&self) -> Option<&str> {
        self.fault.as_deref()
    }

    /// Whether there is a finished sculpture that no folder took.
    #[must_use]
    pub const fn is_unwritten(&self) -> bool {
        !self.unwritten.is_empty()
    }

    /// The file that is being read.
    #[must_use]
    pub fn opening(&self) -> Option<&Path> {
        self.opening.as_ref().map(|opening| &*opening.path)
    }

    /// Whether a print is being made or written.
    #[must_use]
    pub const fn is_printing(&self) -> bool {
        self.finishing.is_some()
    }

    /// What is to be told since this was asked last.
    pub fn notes(&mut self) -> impl Iterator<Item = Note> {
        self.notes.drain(..)
    }

    /// Tells the visitor something.
    pub fn note(&mut self, note: Note) {
        self.notes.push(note);
    }

    /// One tick. A session that starts leaves the one before in a file of its own.
    pub fn tick(&mut self, input: &Input) {
        self.tick_within(input, |step| step());
    }

    /// One tick whose step `around` carries out, once: between two looks at a clock, say.
    pub fn tick_within(&mut self, input: &Input, around: impl FnOnce(&mut dyn FnMut())) {
        let starts = input.start != Mode::None;
        if starts {
            self.leave_session();
        }
        let hidden = self.volumes.hidden();
        let mut stage = Stage::new(self.world, self.volumes.starts(&hidden));
        let endless = self.record_to.is_some();
        let has_room = |recording: &mut Recording| endless || recording.ticks() < RECORD_TICKS;
        match self.recording.take_if(has_room) {
            Some(recording) => stage.resume(recording),
            None if starts && self.records => stage.record(),
            None => {}
        }
        stage.tick_within(input, around);
        self.recording = stage.leave().or(self.recording.take());
        self.after_tick(input);
    }

    /// Takes in what threads have done.
    pub fn poll(&mut self) -> Option<Mode> {
        while let Some(kept) = self.keeper.heard() {
            self.tell(kept);
        }
        self.write_finished();
        let done = self.opening.as_ref()?.done()?;
        self.opening = None;
        match done {
            Ok(()) => {
                self.volumes.own_mut().copy_from(&Grid::<N>::maps());
                Some(Mode::Own)
            }
            Err(why) => {
                self.note(Note::Bad(why));
                None
            }
        }
    }

    /// Has a file read, for a session of its own.
    pub fn open(&mut self, path: &Path, read: Read) {
        match &self.opening {
            None => self.opening = Some(Opening::begin(path, read)),
            Some(opening) => {
                let (path, first) = (path.display(), opening.path.display());
                self.note(Note::Bad(format!("{path}: not opened, {first} is still being read")));
            }
        }
    }

    /// Tries once more to write what no folder took.
    pub fn write_again(&mut self) {
        self.unwritten.drain(..).for_each(|job| self.keeper.give(job));
    }

    /// The sculpture as it is becomes a volume to start from.
    pub fn adopt(&mut self) -> Mode {
        self.volumes.own_mut().copy_from(self.world.volume().maps());
        Mode::Own
    }

    /// Writes the trace of the session so far, and the volume that it began with if that was the
    /// visitor's own.
    pub fn write_trace(&mut self) {
        let Some(recording) = &self.recording else {
            let why = "only a session that began here can be recorded";
            self.note(Note::Bad(why.into()));
            return;
        };
        if recording.ticks() >= RECORD_TICKS && self.record_to.is_none() {
            let what = "two hours of a session are recorded: the trace ends there";
            self.notes.push(Note::Good(what.into()));
        }
        let (mut endings, mut bytes) = (vec!["trace"], vec![recording.trace()]);
        let hidden = self.volumes.hidden();
        if let Some(own) = self.volumes.starts(&hidden).own {
            endings.push("rmap");
            bytes.push(rmap::encode(own));
        }
        self.give(What::Trace, "session", endings, bytes);
    }

    /// Saves the session, and waits for the disk: nobody can say when the studio will go on.
    pub fn pause(&mut self) {
        if self.changed {
            self.save();
        }
        // What went wrong is told.
        let _ = self.wait();
    }

    /// Finishes what is under way and saves the session, and waits for the disk.
    ///
    /// # Errors
    /// The first thing that could not be written.
    pub fn close(&mut self) -> Result<(), durable::Error> {
        if let Some(finishing) = &mut self.finishing {
            finishing.complete(&mut self.printer);
        }
        self.write_finished();
        self.write_again();
        self.save();
        match (&self.record_to, &self.recording) {
            (Some(path), Some(recording)) => {
                self.keeper.keep(What::Trace, path.clone(), recording.trace());
            }
            (Some(path), None) => {
                let text = "not written: no session began here";
                self.note(Note::Bad(format!("{}: {text}", path.display())));
            }
            (None, _) => {}
        }
        self.wait()
    }

    fn leave_session(&mut self) {
        if self.world.session() == Session::Sculpting && self.world.undo_counts() != (0, 0) {
            let mut bytes = Vec::new();
            self.fill(&mut bytes);
            self.keeper.keep(What::Before, self.places.session_before(N), bytes);
        }
        self.world.clear();
        self.recording = None;
        self.printed = None;
        self.saved = 0;
    }

    fn after_tick(&mut self, input: &Input) {
        let print = self.printer.tick(self.world);
        if let Some(finishing) = &mut self.finishing {
            finishing.take_print(print);
        }
        let finished = self.world.events().contains(&Event::Finished);
        if finished {
            // The printer has made the last one's print at once, before it began with this one's.
            if let Some(last) = &mut self.finishing {
                last.wait_for_picture();
                self.write_finished();
            }
            self.finishing = Some(Finishing::begin(self.world, self.portrait));
        }
        let tick = self.world.tick();
        self.changed |= !self.world.events().is_empty() || !self.world.dirty().is_empty();
        let running = input.hands.iter().any(|hand| hand.trigger > 127);
        let stroke_ended = self.running && !running && tick >= self.saved + STROKE_TICKS;
        self.running = running;
        self.due |= self.changed && (finished || stroke_ended || tick >= self.saved + SAVE_TICKS);
        if self.due {
            self.save();
        }
    }
}

#[cfg(test)]
mod tests;
