//! Trace recording of the current session. It runs the ticks and returns a trace's bytes. It writes no files;
//! it only stores the path for the trace at exit.

use std::path::{Path, PathBuf};

use paros_core::limits::INTERVALS;
use paros_core::session::TICK_RATE;
use paros_core::visit::VisitPhase;
use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, WorldEvent};

use crate::tick_runner::{TickRunner, TraceRecording};

/// The most ticks recorded of a session if no trace file is set: two hours, 70 MiB.
const MAX_UNASKED_TICKS: u32 = 2 * 60 * 60 * TICK_RATE;

/// The extent to which each session is recorded.
#[derive(Clone, PartialEq, Eq, Debug)]
enum RecordingExtent {
    /// No ticks.
    None,
    /// The first [`MAX_UNASKED_TICKS`].
    Limited,
    /// All ticks. At exit the trace is written to this file.
    Whole(PathBuf),
}

/// Records each session from its start. A session that was resumed from a save is not recorded, as a trace
/// must begin at a session's start.
#[derive(Debug)]
pub(super) struct Recorder {
    extent: RecordingExtent,
    recording: Option<TraceRecording>,
    /// The number of visitors since the session's start.
    visitors: u32,
}

impl Recorder {
    /// Creates a recorder of the first [`MAX_UNASKED_TICKS`] of each session.
    pub(super) const fn new() -> Self {
        Recorder { extent: RecordingExtent::Limited, recording: None, visitors: 0 }
    }

    /// Stops recording.
    pub(super) fn disable_recording(&mut self) {
        self.extent = RecordingExtent::None;
    }

    /// Sets the file for the last session's trace, and records whole sessions; with `None`, their first two
    /// hours only.
    pub(super) fn set_trace_path_at_exit(&mut self, trace_path: Option<PathBuf>) {
        self.extent = trace_path.map_or(RecordingExtent::Limited, RecordingExtent::Whole);
    }

    /// Returns the file for the last session's trace.
    pub(super) fn trace_path(&self) -> Option<&Path> {
        match &self.extent {
            RecordingExtent::Whole(path) => Some(path),
            RecordingExtent::None | RecordingExtent::Limited => None,
        }
    }

    /// Returns the bytes of the trace so far; `None` for a session that is not recorded.
    pub(super) fn trace_bytes(&self) -> Option<Vec<u8>> {
        self.recording.as_ref().map(TraceRecording::to_trace_bytes)
    }

    /// Returns the bytes of the trace if it is whole and has at most one visitor.
    pub(super) fn visitors_own_trace(&self) -> Option<Vec<u8>> {
        let is_own = self.visitors <= 1 && !self.has_reached_limit();
        is_own.then(|| self.trace_bytes()).flatten()
    }

    /// Returns `true` if the recording has reached its limit.
    pub(super) fn has_reached_limit(&self) -> bool {
        self.recording.as_ref().is_some_and(|recording| !self.has_room_in(recording))
    }

    /// Drops the recording.
    pub(super) fn discard_recording(&mut self) {
        self.recording = None;
    }

    /// Runs one tick, and records it if the session is recorded. `starts_session` is `true` if the tick
    /// starts a session.
    pub(super) fn run_tick<const N: usize>(
        &mut self,
        mut runner: TickRunner<'_, N, INTERVALS>,
        starts_session: bool,
        input: &TickInput,
        wrap_step: impl FnOnce(&mut dyn FnMut()),
    ) where
        Grid<N>: Size,
    {
        if starts_session {
            self.visitors = 0;
        }
        if self.has_reached_limit() {
            runner.run_tick_wrapped(input, wrap_step);
            return;
        }
        match self.recording.take() {
            Some(recording) => runner.attach_recording(recording),
            None if starts_session && self.extent != RecordingExtent::None => {
                runner.start_recording();
            }
            None => {}
        }
        runner.run_tick_wrapped(input, wrap_step);
        let comes = |event: &WorldEvent| *event == WorldEvent::Visit(VisitPhase::Welcome);
        self.visitors += u32::from(runner.world().events().iter().any(comes));
        self.recording = runner.detach_recording();
    }

    fn has_room_in(&self, recording: &TraceRecording) -> bool {
        self.trace_path().is_some() || recording.tick_count() < MAX_UNASKED_TICKS
    }
}
