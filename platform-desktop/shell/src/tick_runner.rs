//! The tick loop with a fixed time step. [`TickClock`] turns frame times into ticks, and [`TickRunner`] runs
//! each as one `World::step` and can record it in a trace. The module accesses no files and no display.

use std::time::Duration;

use paros_core::codec::trace::{
    HEADER_BYTES, RECORD_BYTES, TickRecord, TraceHeader, digest_start_volumes,
};
use paros_core::internals::ByteWriter;
use paros_core::session::TICK_RATE;
use paros_core::volume::{Grid, Size};
use paros_core::{StartVolumes, TickInput, World};

use crate::statics::{Resident, WorldWithStarts};
use crate::trace::{ReplayDivergence, Trace};

/// Runs the ticks of a world. It borrows the world and its start volumes, and records every tick during a
/// recording.
#[derive(Debug)]
pub struct TickRunner<'a, const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    world: &'a mut World<N, K>,
    start_volumes: StartVolumes<'a, N, K>,
    recording: Option<TraceRecording>,
}

/// A tick of a replay that has been run.
#[derive(Clone, Copy, Debug)]
pub struct ReplayedTick<'a, const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    /// The index of the tick, from 0.
    pub index: usize,
    /// The world after the tick.
    pub world: &'a World<N, K>,
}

/// A trace that is being recorded.
#[derive(Debug)]
pub struct TraceRecording {
    header: TraceHeader,
    /// Space for the header, then the records so far.
    bytes: Vec<u8>,
}

impl TraceRecording {
    /// Returns the number of ticks recorded so far.
    #[must_use]
    pub const fn tick_count(&self) -> u32 {
        self.header.ticks
    }

    /// Returns the bytes of a trace file that ends with the last recorded tick.
    #[must_use]
    pub fn to_trace_bytes(&self) -> Vec<u8> {
        let mut bytes = self.bytes.clone();
        self.header.write(&mut ByteWriter::new(&mut bytes));
        bytes
    }
}

impl<'a, const N: usize, const K: usize> TickRunner<'a, N, K>
where
    Grid<N>: Size,
{
    /// Creates a runner that records nothing yet.
    #[must_use]
    pub fn new(world: &'a mut World<N, K>, start_volumes: StartVolumes<'a, N, K>) -> Self {
        TickRunner { world, start_volumes, recording: None }
    }

    /// Returns the world after the last tick.
    #[must_use]
    pub const fn world(&self) -> &World<N, K> {
        self.world
    }

    /// Returns the header of a trace that starts with the next tick: size and digests, with no ticks.
    #[must_use]
    pub fn trace_header(&self) -> TraceHeader {
        TraceHeader {
            side: N as u16,
            intervals: K as u16,
            ticks: 0,
            starts_digest: digest_start_volumes(&self.start_volumes),
            first_digest: self.world.digest(),
        }
    }

    /// Starts a recording with the next tick. Drops the current recording.
    pub fn start_recording(&mut self) {
        self.recording =
            Some(TraceRecording { header: self.trace_header(), bytes: vec![0; HEADER_BYTES] });
    }

    /// Ends the recording and returns the bytes of its trace file; `None` if there was none.
    #[must_use]
    pub fn end_recording_to_bytes(&mut self) -> Option<Vec<u8>> {
        self.recording.take().map(|recording| recording.to_trace_bytes())
    }

    /// Ends the borrow of the world and returns the current recording, for [`TickRunner::attach_recording`]
    /// of another runner.
    #[must_use]
    pub fn detach_recording(self) -> Option<TraceRecording> {
        self.recording
    }

    /// Continues a recording that another runner of this world and these start volumes began.
    pub fn attach_recording(&mut self, recording: TraceRecording) {
        self.recording = Some(recording);
    }

    /// Runs one tick.
    pub fn run_tick(&mut self, input: &TickInput) {
        self.run_tick_wrapped(input, |step| step());
    }

    /// Runs one tick. `wrap_step` must call its argument, the step itself, exactly once. It can measure the
    /// step's time, for example.
    #[expect(clippy::disallowed_methods, reason = "the one place outside tests")]
    pub fn run_tick_wrapped(
        &mut self,
        input: &TickInput,
        wrap_step: impl FnOnce(&mut dyn FnMut()),
    ) {
        wrap_step(&mut || self.world.step(input, &self.start_volumes));
        if let Some(TraceRecording { header, bytes }) = &mut self.recording {
            header.ticks += 1;
            let at = bytes.len();
            bytes.resize(at + RECORD_BYTES, 0);
            let parts = self.world.part_digests().map(|(_, digest)| digest);
            let record = TickRecord { input: *input, part_digests: parts };
            record.write(&mut ByteWriter::new(&mut bytes[at..]));
        }
    }

    /// Replays a trace. The runner must have the start volumes and the state on which the trace was recorded;
    /// the trace holds only their digests. Calls `after_tick` after every tick.
    ///
    /// # Errors
    /// Returns a [`ReplayDivergence`] if the trace was recorded on other start volumes or from another state,
    /// or at the first tick after which a part of the world's state differs.
    pub fn replay_on_same_start(
        &mut self,
        trace: &Trace,
        mut after_tick: impl FnMut(ReplayedTick<'_, N, K>),
    ) -> Result<(), ReplayDivergence> {
        let (recorded, here) = (trace.header(), self.trace_header());
        if recorded.side != here.side {
            return Err(ReplayDivergence::Size { recorded: recorded.side, here: here.side });
        }
        if recorded.intervals != here.intervals {
            return Err(ReplayDivergence::Intervals {
                recorded: recorded.intervals,
                here: here.intervals,
            });
        }
        if recorded.starts_digest != here.starts_digest {
            return Err(ReplayDivergence::Starts {
                recorded: recorded.starts_digest,
                here: here.starts_digest,
            });
        }
        if recorded.first_digest != here.first_digest {
            return Err(ReplayDivergence::State {
                recorded: recorded.first_digest,
                here: here.first_digest,
            });
        }
        for (tick, record) in trace.records().enumerate() {
            self.run_tick(&record.input);
            for ((part, here), recorded) in
                self.world.part_digests().into_iter().zip(record.part_digests)
            {
                if here != recorded {
                    return Err(ReplayDivergence::Tick { tick, part, recorded, here });
                }
            }
            after_tick(ReplayedTick { index: tick, world: self.world });
        }
        Ok(())
    }
}

/// Locks the process's resident world, clears it, generates its start volumes, and calls `run` with a runner
/// for it.
pub fn with_fresh_world<const N: usize, const K: usize, T>(
    run: impl FnOnce(TickRunner<'_, N, K>) -> T,
) -> T
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut resident = Grid::<N>::lock_world();
    resident.generate_starts();
    let WorldWithStarts { start_volumes, world } = &mut *resident;
    world.clear();
    run(TickRunner::new(world, start_volumes.start_volumes(&start_volumes.hidden_figures())))
}

/// The ticks that became due since the last frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ClockTicks {
    /// The ticks to run, at most [`TickClock::MAX_TICKS_PER_FRAME`].
    pub due: u32,
    /// The ticks beyond that number, which are dropped.
    pub dropped: u32,
}

/// Fixed-time-step accumulator: turns the time between frames into whole ticks at the core's
/// `TICK_RATE`, and carries the rest over.
#[derive(Debug, Clone, Copy, Default)]
pub struct TickClock {
    /// The time not yet turned into ticks, in nanoseconds times the tick rate: 1e9 is one tick.
    remainder: u128,
}

impl TickClock {
    /// The most ticks of one frame; further ticks are dropped.
    pub const MAX_TICKS_PER_FRAME: u32 = 4;

    /// Returns the ticks that became due in `since_last_call`, the time since the last call.
    #[must_use]
    pub fn take_due_ticks(&mut self, since_last_call: Duration) -> ClockTicks {
        let second = 1_000_000_000;
        self.remainder += since_last_call.as_nanos() * u128::from(TICK_RATE);
        let due = u32::try_from(self.remainder / second).unwrap_or(u32::MAX);
        self.remainder %= second;
        ClockTicks {
            due: due.min(Self::MAX_TICKS_PER_FRAME),
            dropped: due.saturating_sub(Self::MAX_TICKS_PER_FRAME),
        }
    }

    /// Returns the time since the last tick as a fraction of a tick, in 0..1, for interpolation.
    #[must_use]
    pub fn tick_fraction(&self) -> f32 {
        self.remainder as f32 / 1e9
    }
}
