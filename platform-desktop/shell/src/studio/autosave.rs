//! Autosave: decides after each tick whether to save the session, and submits the save to the file writer.

use std::mem;

use paros_core::limits::{INTERVALS, max_save_bytes};
use paros_core::session::{SessionState, TICK_RATE};
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};

use super::session::LiveSession;
use crate::durable;
use crate::file_writer::{Destination, FileKind, FileWriter, WriteJob};
use crate::studio_paths::StudioPaths;

/// The least ticks between two saves: three seconds.
const SAVE_TICKS: u64 = 3 * TICK_RATE as u64;

/// The least ticks between two saves if a stroke has just ended: one second.
const STROKE_TICKS: u64 = TICK_RATE as u64;

/// The session's state relative to its last save.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum SaveState {
    /// Unchanged since the last save.
    Saved,
    /// Changed since the last save.
    Changed,
    /// To be saved as soon as the last save has been written.
    Due,
}

/// The decision whether to notify the visitor of a failed save: only the first failure in a row is reported.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum FailureNotice {
    Due,
    NotDue,
}

/// Saves the session from time to time, with one buffer that is lent to the file writer.
pub(super) struct Autosave {
    state: SaveState,
    /// The save job, its buffer large enough for any session. `None` while it is being written.
    buffer: Option<WriteJob>,
    /// The tick of the last save.
    saved_at_tick: u64,
    /// `true` if a stroke was in progress after the last tick.
    stroke_open: bool,
    /// The reason why the last save was not written.
    save_error: Option<String>,
    /// `true` if the save that is being written is of the session in the world, not of a previous session.
    writes_this_session: bool,
    /// `true` if the save on the disk, if there is one, is of the session in the world.
    is_this_on_disk: bool,
}

impl Autosave {
    /// Creates a state with nothing to save. Allocates the buffer.
    pub(super) fn new<const N: usize>(paths: &StudioPaths) -> Self {
        let buffer = WriteJob {
            kind: FileKind::Session,
            destination: Destination::Replace(vec![paths.session_file(N)]),
            contents: vec![vec![0; max_save_bytes(N, INTERVALS)]],
        };
        Autosave {
            state: SaveState::Saved,
            buffer: Some(buffer),
            saved_at_tick: 0,
            stroke_open: false,
            save_error: None,
            writes_this_session: false,
            is_this_on_disk: true,
        }
    }

    /// Returns `true` if the save on the disk, if there is one, is of the session in the world.
    pub(super) const fn is_this_session_on_disk(&self) -> bool {
        self.is_this_on_disk
    }

    /// Returns the error of the last save, while saving fails.
    pub(super) fn save_error(&self) -> Option<&str> {
        self.save_error.as_deref()
    }

    /// Returns `true` if the session is to be saved as soon as the last save has been written.
    pub(super) fn is_due(&self) -> bool {
        self.state == SaveState::Due
    }

    /// Returns `true` if the session may differ from the last save.
    pub(super) fn is_changed(&self) -> bool {
        self.state != SaveState::Saved
    }

    /// Returns `true` while a save is being written.
    #[cfg(test)]
    pub(super) const fn is_writing(&self) -> bool {
        self.buffer.is_none()
    }

    /// Restarts the interval for a new session, whose ticks count from 0.
    pub(super) fn restart_save_interval(&mut self) {
        self.saved_at_tick = 0;
        (self.writes_this_session, self.is_this_on_disk) = (false, false);
    }

    /// Updates the state after a tick. A save becomes due when something has changed, and either the session
    /// is finished or the last save is old enough: one second if a stroke has just ended, else three.
    pub(super) fn mark_due_after_tick<const N: usize>(&mut self, world: &World<N, INTERVALS>)
    where
        Grid<N>: Size,
    {
        if !world.events().is_empty() || !world.dirty_rects().is_empty() {
            self.mark_changed();
        }
        let was_open = mem::replace(&mut self.stroke_open, world.is_stroke_open());
        let stroke_ended = was_open && !self.stroke_open;
        let interval = if stroke_ended { STROKE_TICKS } else { SAVE_TICKS };
        let is_old = world.tick() >= self.saved_at_tick + interval;
        if self.state == SaveState::Changed
            && (is_old || world.events().contains(&WorldEvent::Finished))
        {
            self.state = SaveState::Due;
        }
    }

    /// Encodes and submits the session. While the last save is still being written, the buffer is missing and
    /// the save stays due.
    pub(super) fn submit_save_or_stay_due<const N: usize>(
        &mut self,
        session: &LiveSession<'_, N>,
        file_writer: &mut FileWriter,
    ) where
        Grid<N>: Size,
    {
        if session.world.session_state() == SessionState::Waiting {
            return;
        }
        let Some(mut job) = self.buffer.take() else {
            self.state = SaveState::Due;
            return;
        };
        job.contents.iter_mut().for_each(|bytes| session.encode_into(bytes));
        file_writer.submit_or_wait(job);
        (self.state, self.saved_at_tick) = (SaveState::Saved, session.world.tick());
        self.writes_this_session = true;
    }

    /// Takes back the buffer of a save, with its error if it failed. A failed save is retried.
    pub(super) fn reclaim_buffer(
        &mut self,
        job: WriteJob,
        error: Option<&durable::WriteError>,
    ) -> FailureNotice {
        self.buffer = Some(job);
        let was_well = self.save_error.is_none();
        self.save_error = error.map(ToString::to_string);
        match error {
            Some(_) => self.mark_changed(),
            None => self.is_this_on_disk |= self.writes_this_session,
        }
        match was_well && error.is_some() {
            true => FailureNotice::Due,
            false => FailureNotice::NotDue,
        }
    }

    fn mark_changed(&mut self) {
        if self.state == SaveState::Saved {
            self.state = SaveState::Changed;
        }
    }
}
