//! The studio: one world's sessions with their ticks, saves, exports and traces.
//!
//! It takes tick inputs and writes files through the [`FileWriter`]. `session` holds the world, `autosave`
//! decides when it is saved, `recorder` records its trace, and `export` makes a finished sculpture's files.
//! The studio depends on no window and no headset.

mod autosave;
mod carve_on;
mod cut_off_export;
mod export;
mod files;
mod last_use;
mod one_before;
mod pending_read;
mod receiver;
mod recorder;
mod sculpture_files;
mod session;

use std::path::{Path, PathBuf};

use crate::file_writer::{FileKind, FileWriter};
use crate::statics::{Resident, WorldWithStarts};
use crate::stl_export::{StlBuffers, StlExporter};
use crate::studio_paths::StudioPaths;
use crate::tick_runner::TickRunner;
use crate::{durable, rmap};
use autosave::Autosave;
pub use carve_on::CarvingOn;
use export::SculptureExport;
use last_use::LastUseFile;
use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_core::visit::{VisitCommand, VisitPhase};
use paros_core::volume::{Grid, Size};
use paros_core::{RangeMaps, TickInput, World, WorldEvent};
use pending_read::PendingRead;
pub use receiver::SculptureReceiver;
use recorder::Recorder;
use session::LiveSession;

/// A function that draws a finished sculpture and returns the bytes of a PNG file. It is called in a thread.
pub type DrawPicture<const N: usize> = fn(&RangeMaps<N, INTERVALS>) -> Result<Vec<u8>, String>;

/// A function that reads a file into the static range maps of its size. It is called in a thread.
pub type VolumeReader = fn(&Path) -> Result<(), String>;

/// A session for the shell to start with the next tick's input.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SessionToStart {
    /// The session mode.
    pub mode: SessionMode,
}

/// A message for the visitor.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Notice {
    /// A success.
    Good(String),
    /// A failure.
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
    last_use: LastUseFile,
    recorder: Recorder,
    export: SculptureExport<'a, N>,
    paths: StudioPaths,
    pending_read: Option<PendingRead>,
    /// `true` if the resident maps hold a volume that was read, from which no session has started yet.
    has_read_volume: bool,
    /// The save of the previous sculpture, which was left unfinished for this one.
    one_before: Option<Vec<u8>>,
    /// The save of the sculpture just before it was finished.
    before_finish: Option<Vec<u8>>,
    /// The receiver of finished sculptures, if there is one.
    receiver: Option<Box<dyn SculptureReceiver<N>>>,
    notices: Vec<Notice>,
}

impl<'a, const N: usize> Studio<'a, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Opens a studio: claims a session file, removes stale temporary files, and resumes the saved
    /// session if there is one.
    #[must_use]
    pub fn new(
        resident: &'a mut WorldWithStarts<N, INTERVALS>,
        stl_buffers: &'a mut StlBuffers<N, INTERVALS>,
        mut paths: StudioPaths,
        draw_picture: DrawPicture<N>,
    ) -> Self {
        let mut session = LiveSession::claim_file(resident, &mut paths);
        for folder in [&paths.sculptures, &paths.sessions, &paths.cache] {
            durable::remove_stale_temporaries(folder);
        }
        let autosave = Autosave::new::<N>(&paths);
        let last_use = LastUseFile::new(paths.last_use_file(N));
        let notices = session.resume_saved(&paths);
        let one_before = one_before::read_save_before::<N>(&paths);
        let mut studio = Studio {
            file_writer: FileWriter::spawn(),
            session,
            autosave,
            last_use,
            recorder: Recorder::new(),
            export: SculptureExport::new(StlExporter::of_default_height(stl_buffers), draw_picture),
            paths,
            pending_read: None,
            has_read_volume: false,
            one_before,
            before_finish: None,
            receiver: None,
            notices,
        };
        studio.export_what_was_cut_off();
        studio
    }

    /// Returns the world after the last tick.
    #[must_use]
    pub const fn world(&self) -> &World<N, INTERVALS> {
        self.session.world
    }

    /// Stops recording traces, as a recording grows with every tick.
    pub fn disable_recording(&mut self) {
        self.recorder.disable_recording();
    }

    /// Sets the file to which [`Studio::save_all_and_wait`] writes the trace of the last session;
    /// `None` for none.
    pub fn set_trace_path_at_exit(&mut self, path: Option<PathBuf>) {
        self.recorder.set_trace_path_at_exit(path);
    }

    /// Returns the studio's folders and file names.
    #[must_use]
    pub const fn paths(&self) -> &StudioPaths {
        &self.paths
    }

    /// Returns the background file writer.
    pub const fn file_writer(&mut self) -> &mut FileWriter {
        &mut self.file_writer
    }

    /// Returns the path of the last finished sculpture's STL file, once it is written.
    #[must_use]
    pub fn session_stl_path(&self) -> Option<&Path> {
        self.export.session_stl_path()
    }

    /// Returns the error of the last save, while saving fails.
    #[must_use]
    pub fn save_error(&self) -> Option<&str> {
        self.autosave.save_error()
    }

    /// Returns `true` if files of a sculpture or of a previous session could not be written and wait for
    /// [`Studio::retry_failed_writes`].
    #[must_use]
    pub const fn has_writes_to_retry(&self) -> bool {
        self.export.has_failed_jobs()
    }

    /// Returns the path of the file being read.
    #[must_use]
    pub fn path_being_read(&self) -> Option<&Path> {
        self.pending_read.as_ref().map(|pending| &*pending.path)
    }

    /// Returns `true` if a finished sculpture's files are being made or written.
    #[must_use]
    pub const fn is_exporting(&self) -> bool {
        self.export.is_busy()
    }

    /// Returns the number of finished or previous sculptures whose files are not on the disk yet.
    #[must_use]
    pub fn count_unkept_sculptures(&self) -> u32 {
        u32::try_from(self.export.count_unkept()).unwrap_or(u32::MAX)
    }

    /// Removes and returns the messages for the visitor.
    pub fn take_notices(&mut self) -> impl Iterator<Item = Notice> {
        self.notices.drain(..)
    }

    /// Adds a message for the visitor.
    pub fn push_notice(&mut self, notice: Notice) {
        self.notices.push(notice);
    }

    /// Runs one tick. If the tick starts a session and the current sculpture is unfinished, its save is first
    /// kept in a separate file.
    pub fn run_tick(&mut self, input: &TickInput) {
        self.run_tick_wrapped(input, |step| step());
    }

    /// Returns the finished fraction of the finished sculpture's print, 0 to 1.
    #[must_use]
    pub fn export_part(&self) -> f32 {
        self.export.part_made()
    }

    /// Runs one tick. `wrap_step` must call its argument, the step itself, exactly once. It can measure the
    /// step's time, for example.
    pub fn run_tick_wrapped(
        &mut self,
        input: &TickInput,
        wrap_step: impl FnOnce(&mut dyn FnMut()),
    ) {
        // Visits begin in an empty world, as recorded sessions do.
        let opens_visits = input.visit.command == VisitCommand::Open;
        let starts_session = input.start != SessionMode::None || opens_visits;
        if starts_session {
            self.save_and_leave_session();
        }
        self.keep_before_finish(input);
        let LiveSession { world, volumes, .. } = &mut self.session;
        let hidden = volumes.hidden_figures();
        let runner = TickRunner::new(world, volumes.start_volumes(&hidden));
        self.recorder.run_tick(runner, starts_session, input, wrap_step);
        self.after_tick();
    }

    /// Collects finished writes and reads, without blocking. Returns `true` if a file has just been read, for
    /// [`Studio::offer_read_volume`].
    pub fn poll_background_work(&mut self) -> bool {
        while let Some(outcome) = self.file_writer.poll_outcome() {
            // Errors are added to the messages.
            let _ = self.handle_write_outcome(outcome);
        }
        self.submit_last_use();
        if !self.is_badge_awaited() {
            self.submit_finished_sculpture();
        }
        let Some(done) = self.pending_read.as_ref().and_then(PendingRead::poll_result) else {
            return false;
        };
        self.pending_read = None;
        self.has_read_volume = done.is_ok();
        if let Err(why) = done {
            self.push_notice(Notice::Bad(why));
        }
        self.has_read_volume
    }

    /// Retries the writes that failed.
    pub fn retry_failed_writes(&mut self) {
        for job in self.export.take_failed_jobs() {
            self.submit_job(job);
        }
    }

    /// Submits the trace of the session so far, and the visitor's own start volume if one is offered.
    pub fn submit_trace_and_own_volume(&mut self) {
        let Some(trace) = self.recorder.trace_bytes() else {
            let why = "only a session that began here can be recorded";
            self.push_notice(Notice::Bad(why.into()));
            return;
        };
        if self.recorder.has_reached_limit() {
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
    pub fn save_session_and_wait(&mut self) {
        if self.is_printing_another() {
            self.export.make_files_to_end();
            self.submit_finished_sculpture();
            self.wait_for_receiver();
        }
        if self.autosave.is_changed() {
            self.save_session();
        }
        // Errors have been added to the messages.
        let _ = self.wait_for_writes();
    }

    /// Finishes the current export, saves the session, and waits until everything is written.
    ///
    /// # Errors
    /// Returns the error of the first write that failed.
    pub fn save_all_and_wait(&mut self) -> Result<(), durable::WriteError> {
        self.export.make_files_to_end();
        self.submit_finished_sculpture();
        self.wait_for_receiver();
        self.retry_failed_writes();
        self.save_session();
        if let Some(path) = self.recorder.trace_path().map(PathBuf::from) {
            match self.recorder.trace_bytes() {
                Some(trace) => self.file_writer.submit_file_or_wait(FileKind::Trace, path, trace),
                None => {
                    let text = "not written: no session began here";
                    self.push_notice(Notice::Bad(format!("{}: {text}", path.display())));
                }
            }
        }
        self.wait_for_writes()
    }

    fn save_and_leave_session(&mut self) {
        let leaves_a_sculpture = self.has_unfinished_sculpture();
        if let Some(save) = self.session.take_save_and_clear(leaves_a_sculpture) {
            self.keep_as_the_one_before(save);
        }
        self.forget_session_before();
    }

    /// Forgets the state of the previous session: its save before it was finished, its recording and its
    /// print.
    fn forget_session_before(&mut self) {
        self.before_finish = None;
        self.recorder.discard_recording();
        self.export.set_session_stl_path(None);
        self.autosave.restart_save_interval();
    }

    /// Adds a message if the hidden figure was found in the last tick. In a visit the visit itself reports
    /// it, in the visitor's language.
    fn notice_found_figure(&mut self) {
        let world = &*self.session.world;
        if let SessionMode::Constrained { figure } = world.mode()
            && world.visit().phase() == VisitPhase::Closed
            && world.events().contains(&WorldEvent::Found)
        {
            let name = self.session.volumes.hidden_figure_name(figure).unwrap_or("figure");
            self.push_notice(Notice::Good(format!("You found the {name}")));
        }
    }

    fn after_tick(&mut self) {
        let world = &*self.session.world;
        let has_started = |event: &WorldEvent| matches!(event, WorldEvent::Started(_));
        if world.visit().phase() != VisitPhase::Closed && world.events().iter().any(has_started) {
            // A visit began the session: its recording continues.
            self.before_finish = None;
            self.export.set_session_stl_path(None);
            // No visitor asks for it, and the next ones' are as large.
            self.retry_failed_writes();
        }
        let world = &*self.session.world;
        self.export.advance_stl_after_tick(world);
        if world.events().contains(&WorldEvent::Finished) {
            // The exporter has finished the previous sculpture's file before it began this one.
            self.export.wait_for_picture();
            self.submit_finished_sculpture();
            self.export.start_making_files(self.session.world);
            self.begin_in_receiver(false);
        }
        if let Some(receiver) = &mut self.receiver {
            receiver.follow_tick(self.session.world);
        }
        self.notice_found_figure();
        self.autosave.mark_due_after_tick(self.session.world);
        if self.autosave.is_due() && !self.is_printing_another() {
            self.save_session();
        }
    }
}

#[cfg(test)]
mod tests;
