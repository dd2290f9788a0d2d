//! Trace recording of the current session. It runs the ticks and gives a trace's bytes. It writes no
//! files; it only keeps the path that the trace gets at the end.

use std::path::{Path, PathBuf};

use paros_core::limits::INTERVALS;
use paros_core::session::TICK_RATE;
use paros_core::visit::VisitPhase;
use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, WorldEvent};

use crate::tick_runner::{TickRunner, TraceRecording};

/// The most ticks recorded of a session without a file for its trace: two hours, 70 MiB.
const MAX_UNASKED_TICKS: u32 = 2 * 60 * 60 * TICK_RATE;

/// How much of each session is recorded.
#[derive(Clone, PartialEq, Eq, Debug)]
enum RecordingExtent {
    /// Nothing.
    None,
    /// The first [`MAX_UNASKED_TICKS`].
    Limited,
    /// All of it. At the end the trace goes to this file.
    Whole(PathBuf),
}

/// Records each session from its start. A session resumed from a save is not recorded: a trace must
/// begin at its start.
#[derive(Debug)]
pub(super) struct Recorder {
    extent: RecordingExtent,
    recording: Option<TraceRecording>,
    /// Visitors who came since the session's start.
    visitors: u32,
}

impl Recorder {
    /// Records the first hours of each session.
    pub(super) const fn new() -> Self {
        Recorder { extent: RecordingExtent::Limited, recording: None, visitors: 0 }
    }

    /// Records nothing from now on.
    pub(super) fn disable_recording(&mut self) {
        self.extent = RecordingExtent::None;
    }

    /// Sets the file for the last session's trace, and records whole sessions; with `None`, their first
    /// two hours.
    pub(super) fn set_trace_path_at_exit(&mut self, trace_path: Option<PathBuf>) {
        self.extent = trace_path.map_or(RecordingExtent::Limited, RecordingExtent::Whole);
    }

    /// The file for the last session's trace.
    pub(super) fn trace_path(&self) -> Option<&Path> {
        match &self.extent {
            RecordingExtent::Whole(path) => Some(path),
            RecordingExtent::None | RecordingExtent::Limited => None,
        }
    }

    /// The bytes of the trace so far; `None` for a session that is not recorded.
    pub(super) fn trace_bytes(&self) -> Option<Vec<u8>> {
        self.recording.as_ref().map(TraceRecording::to_trace_bytes)
    }

    /// The bytes of a trace that is whole and has one visitor at most.
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

    /// Runs one tick, recorded if the session is. `starts_session` tells whether the tick starts a
    /// session.
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
