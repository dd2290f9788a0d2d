//! The studio: one world's sessions with their ticks, saves, prints and traces.
//!
//! It takes tick inputs and gives files, through the [`FileWriter`]. `session` holds the world,
//! `autosave` decides when it is saved, `recorder` records its trace, `export` makes a finished
//! sculpture's files. It knows no window and no headset.

mod autosave;
mod export;
mod files;
mod pending_read;
mod recorder;
mod sculpture_files;
mod session;

use std::path::{Path, PathBuf};

use crate::file_writer::{FileKind, FileWriter};
use crate::print::StlPrinter;
use crate::start_volume_store::StartVolumeStore;
use crate::statics::Resident;
use crate::studio_paths::StudioPaths;
use crate::tick_runner::TickRunner;
use crate::{durable, rmap};
use autosave::Autosave;
use export::SculptureExport;
use paros_core::{Grid, RangeMaps, SessionMode, Size, TickInput, World, WorldEvent};
use pending_read::PendingRead;
use recorder::Recorder;
use session::LiveSession;

/// Draws a finished sculpture and returns the bytes of a PNG file. It is called in a thread.
pub type DrawPicture<const N: usize> = fn(&RangeMaps<N>) -> Result<Vec<u8>, String>;

/// Reads a file into the static range maps of its size. It is called in a thread.
pub type ReadVolume = fn(&Path) -> Result<(), String>;

/// A message for the visitor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Notice {
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
    // Dropped before `session`, whose claim on its file must outlast all writes.
    file_writer: FileWriter,
    session: LiveSession<'a, N>,
    autosave: Autosave,
    recorder: Recorder,
    export: SculptureExport<'a, N>,
    paths: StudioPaths,
    opening: Option<PendingRead>,
    notices: Vec<Notice>,
}

impl<'a, const N: usize> Studio<'a, N>
where
    Grid<N>: Size + Resident<N>,
{
    /// Opens a studio: claims a session file, removes stale temporary files, and resumes the saved
    /// session if there is one.
    #[must_use]
    pub fn new(
        world: &'a mut World<N>,
        volumes: &'a mut StartVolumeStore<N>,
        printer: StlPrinter<'a, N>,
        mut paths: StudioPaths,
        draw_picture: DrawPicture<N>,
    ) -> Self {
        let mut session = LiveSession::claim_file(world, volumes, &mut paths);
        for folder in [&paths.sculptures, &paths.sessions, &paths.cache] {
            durable::remove_stale_drafts(folder);
        }
        let autosave = Autosave::new::<N>(&paths);
        let notices = session.resume_saved(&paths);
        Studio {
            file_writer: FileWriter::spawn(),
            session,
            autosave,
            recorder: Recorder::new(),
            export: SculptureExport::new(printer, draw_picture),
            paths,
            opening: None,
            notices,
        }
    }

    /// The world as of the last tick.
    #[must_use]
    pub const fn world(&self) -> &World<N> {
        self.session.world
    }

    /// Records no traces from now on: a recording grows with every tick.
    pub fn disable_recording(&mut self) {
        self.recorder.disable_recording();
    }

    /// Sets the file to which [`Studio::close`] writes the trace of the last session; `None` for none.
    pub fn write_trace_at_close(&mut self, path: Option<PathBuf>) {
        self.recorder.record_whole_to(path);
    }

    /// The studio's folders and file names.
    #[must_use]
    pub const fn paths(&self) -> &StudioPaths {
        &self.paths
    }

    /// The background file writer.
    pub const fn file_writer(&mut self) -> &mut FileWriter {
        &mut self.file_writer
    }

    /// The path of the last finished sculpture's print, once it is written.
    #[must_use]
    pub fn last_print_path(&self) -> Option<&Path> {
        self.export.last_print_path()
    }

    /// The error of the last save, while saving fails.
    #[must_use]
    pub fn save_fault(&self) -> Option<&str> {
        self.autosave.fault()
    }

    /// Whether files of a sculpture could not be written and wait for
    /// [`Studio::retry_unwritten_files`].
    #[must_use]
    pub const fn has_unwritten_files(&self) -> bool {
        self.export.has_unwritten()
    }

    /// The path of the file being read.
    #[must_use]
    pub fn opening_path(&self) -> Option<&Path> {
        self.opening.as_ref().map(|opening| &*opening.path)
    }

    /// Whether a print is being made or written.
    #[must_use]
    pub const fn is_printing(&self) -> bool {
        self.export.is_busy()
    }

    /// Removes and returns the messages for the visitor.
    pub fn take_notices(&mut self) -> impl Iterator<Item = Notice> {
        self.notices.drain(..)
    }

    /// Adds a message for the visitor.
    pub fn push_notice(&mut self, note: Notice) {
        self.notices.push(note);
    }

    /// Runs one tick. Where it starts a session, the one before is saved to a file of its own.
    pub fn run_tick(&mut self, input: &TickInput) {
        self.run_tick_with(input, |step| step());
    }

    /// Runs one tick. `around` must call its argument, the step itself, exactly once: it can measure
    /// the step's time, say.
    pub fn run_tick_with(&mut self, input: &TickInput, around: impl FnOnce(&mut dyn FnMut())) {
        let starts = input.start != SessionMode::None;
        if starts {
            self.leave_session();
        }
        let LiveSession { world, volumes, .. } = &mut self.session;
        let hidden = volumes.hidden_figures();
        let stage = TickRunner::new(world, volumes.start_volumes(&hidden));
        self.recorder.run_tick(stage, starts, input, around);
        self.after_tick();
    }

    /// Collects finished writes and reads. Returns the mode of the session to start where a file has
    /// been read.
    pub fn poll_threads(&mut self) -> Option<SessionMode> {
        while let Some(outcome) = self.file_writer.poll() {
            self.report_outcome(outcome);
        }
        self.submit_finished_sculpture();
        let done = self.opening.as_ref()?.poll_result()?;
        self.opening = None;
        match done {
            Ok(()) => {
                self.session.volumes.own_volume_mut().copy_from(&Grid::<N>::lock_range_maps());
                Some(SessionMode::Own)
            }
            Err(why) => {
                self.push_notice(Notice::Bad(why));
                None
            }
        }
    }

    /// Starts to read a file, for a new session. One at a time; others are refused with a message.
    pub fn open_file(&mut self, path: &Path, read: ReadVolume) {
        match &self.opening {
            None => self.opening = Some(PendingRead::spawn(path, read)),
            Some(opening) => {
                let (path, first) = (path.display(), opening.path.display());
                self.push_notice(Notice::Bad(format!(
                    "{path}: not opened, {first} is still being read"
                )));
            }
        }
    }

    /// Submits once more the files that could not be written.
    pub fn retry_unwritten_files(&mut self) {
        self.export.take_unwritten().for_each(|job| self.file_writer.submit(job));
    }

    /// Copies the current sculpture to the visitor's own start volume. Returns the mode that starts
    /// from it.
    pub fn adopt_sculpture(&mut self) -> SessionMode {
        let LiveSession { world, volumes, .. } = &mut self.session;
        volumes.own_volume_mut().copy_from(world.volume().maps());
        SessionMode::Own
    }

    /// Submits the trace of the session so far, and its start volume if that was the visitor's own.
    pub fn write_trace(&mut self) {
        let Some(trace) = self.recorder.trace_bytes() else {
            let why = "only a session that began here can be recorded";
            self.push_notice(Notice::Bad(why.into()));
            return;
        };
        if self.recorder.is_full() {
            let text = "two hours of a session are recorded: the trace ends there";
            self.notices.push(Notice::Good(text.into()));
        }
        let (mut extensions, mut bytes) = (vec!["trace"], vec![trace]);
        let hidden = self.session.volumes.hidden_figures();
        if let Some(own) = self.session.volumes.start_volumes(&hidden).own {
            extensions.push("rmap");
            bytes.push(rmap::encode(own));
        }
        self.submit_numbered_files(FileKind::Trace, "session", extensions, bytes);
    }

    /// Saves the session and waits until it is written: the process may be suspended next.
    pub fn save_and_wait(&mut self) {
        if self.autosave.is_changed() {
            self.save_session();
        }
        // Errors have been added to the messages.
        let _ = self.wait_for_writes();
    }

    /// Finishes the print under way, saves the session, and waits until all is written.
    ///
    /// # Errors
    /// The first write that failed.
    pub fn close(&mut self) -> Result<(), durable::WriteError> {
        self.export.finish_files();
        self.submit_finished_sculpture();
        self.retry_unwritten_files();
        self.save_session();
        if let Some(path) = self.recorder.trace_path().map(PathBuf::from) {
            match self.recorder.trace_bytes() {
                Some(trace) => self.file_writer.submit_file(FileKind::Trace, path, trace),
                None => {
                    let text = "not written: no session began here";
                    self.push_notice(Notice::Bad(format!("{}: {text}", path.display())));
                }
            }
        }
        self.wait_for_writes()
    }

    fn leave_session(&mut self) {
        if let Some(save) = self.session.save_and_clear() {
            self.file_writer.submit_file(
                FileKind::PreviousSession,
                self.paths.previous_session_file(N),
                save,
            );
        }
        self.recorder.discard_recording();
        self.export.set_last_print_path(None);
        self.autosave.begin_session();
    }

    fn after_tick(&mut self) {
        let world = &*self.session.world;
        self.export.advance_print(world);
        if world.events().contains(&WorldEvent::Finished) {
            // The printer has made the last one's print at once, before it began with this one's.
            self.export.wait_for_picture();
            self.submit_finished_sculpture();
            self.export.start_files(self.session.world);
        }
        self.autosave.observe_tick(self.session.world);
        if self.autosave.is_due() {
            self.save_session();
        }
    }
}

#[cfg(test)]
mod tests;
