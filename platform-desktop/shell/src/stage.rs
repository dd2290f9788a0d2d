//! The one loop: time becomes ticks, ticks become `World::step`, and every tick can be recorded.

use std::time::Duration;

use paros_core::codec::Writer;
use paros_core::input::{Input, TICK_RATE};
use paros_core::size::{Grid, Size};
use paros_core::trace::{HEADER_BYTES, Header, RECORD_BYTES, Record, starts_digest};
use paros_core::world::{Starts, World};

use crate::statics::Resident;
use crate::trace::{Diverged, Trace};

/// A world, what its sessions start from, and the recording of its ticks.
#[derive(Debug)]
pub struct Stage<'a, const N: usize>
where
    Grid<N>: Size,
{
    world: &'a mut World<N>,
    starts: Starts<'a, N>,
    recording: Option<Recording>,
}

/// A trace that is being recorded: its header, and the bytes so far, room for the header before the
/// records.
#[derive(Debug)]
pub struct Recording {
    header: Header,
    bytes: Vec<u8>,
}

impl Recording {
    /// Ticks so far.
    #[must_use]
    pub const fn ticks(&self) -> u32 {
        self.header.ticks
    }

    /// The bytes of a trace that ends here.
    #[must_use]
    pub fn trace(&self) -> Vec<u8> {
        let mut bytes = self.bytes.clone();
        self.header.write(&mut Writer::new(&mut bytes));
        bytes
    }
}

impl<'a, const N: usize> Stage<'a, N>
where
    Grid<N>: Size,
{
    /// Puts a world on stage.
    #[must_use]
    pub fn new(world: &'a mut World<N>, starts: Starts<'a, N>) -> Self {
        Stage { world, starts, recording: None }
    }

    /// The world as of the last tick.
    #[must_use]
    pub const fn world(&self) -> &World<N> {
        self.world
    }

    /// The header of a trace that starts now.
    #[must_use]
    pub fn header(&self) -> Header {
        Header {
            size: N as u16,
            ticks: 0,
            starts: starts_digest(&self.starts),
            first: self.world.digest(),
        }
    }

    /// Records all ticks from now on.
    pub fn record(&mut self) {
        self.recording = Some(Recording { header: self.header(), bytes: vec![0; HEADER_BYTES] });
    }

    /// Ends the recording: the bytes of a trace.
    #[must_use]
    pub fn end_recording(&mut self) -> Option<Vec<u8>> {
        self.recording.take().map(|recording| recording.trace())
    }

    /// Leaves the stage, with what is being recorded.
    #[must_use]
    pub fn leave(self) -> Option<Recording> {
        self.recording
    }

    /// Goes on recording what was begun on another stage of this world, and of these start volumes.
    pub fn resume(&mut self, recording: Recording) {
        self.recording = Some(recording);
    }

    /// One tick.
    pub fn tick(&mut self, input: &Input) {
        self.tick_within(input, |step| step());
    }

    /// One tick whose step `around` carries out, once: between two looks at a clock, say.
    #[expect(clippy::disallowed_methods, reason = "the one place outside tests")]
    pub fn tick_within(&mut self, input: &Input, around: impl FnOnce(&mut dyn FnMut())) {
        around(&mut || self.world.step(input, &self.starts));
        if let Some(Recording { header, bytes }) = &mut self.recording {
            header.ticks += 1;
            let at = bytes.len();
            bytes.resize(at + RECORD_BYTES, 0);
            let parts = self.world.part_digests().map(|(_, digest)| digest);
            let record = Record { input: *input, parts };
            record.write(&mut Writer::new(&mut bytes[at..]));
        }
    }

    /// Plays a trace, and hands the world to `each` after every tick, with the tick's number.
    ///
    /// # Errors
    /// [`Diverged`] where the trace was recorded on other start volumes or from another state, or
    /// at the first tick after which a part of the world's state differs.
    pub fn replay(
        &mut self,
        trace: &Trace,
        mut each: impl FnMut(usize, &World<N>),
    ) -> Result<(), Diverged> {
        let (recorded, here) = (trace.header(), self.header());
        if recorded.size != here.size {
            return Err(Diverged::Size { recorded: recorded.size, here: here.size });
        }
        if recorded.starts != here.starts {
            return Err(Diverged::Starts { recorded: recorded.starts, here: here.starts });
        }
        if recorded.first != here.first {
            return Err(Diverged::State { recorded: recorded.first, here: here.first });
        }
        for (tick, record) in trace.records().enumerate() {
            self.tick(&record.input);
            for ((part, here), recorded) in self.world.part_digests().into_iter().zip(record.parts)
            {
                if here != recorded {
                    return Err(Diverged::Tick { tick, part, recorded, here });
                }
            }
            each(tick, self.world);
        }
        Ok(())
    }
}

/// Puts the process's world, as before its first session, on stage, with start volumes that are made
/// for it, and has `act` do what is to be done there.
pub fn fresh<const N: usize, T>(act: impl FnOnce(Stage<'_, N>) -> T) -> T
where
    Grid<N>: Size + Resident<N>,
{
    let mut starts = Grid::<N>::start_volumes();
    starts.make(&mut Grid::<N>::plane(), |_| {});
    let (hidden, mut world) = (starts.hidden(), Grid::<N>::world());
    world.clear();
    act(Stage::new(&mut world, starts.starts(&hidden)))
}

/// Turns the time between frames into ticks at the fixed rate.
#[derive(Debug, Clone, Copy, Default)]
pub struct Pace {
    /// Time not yet made into ticks, in 72nds of a nanosecond.
    left: u128,
}

impl Pace {
    /// Ticks that a frame makes up at the most; what is beyond is dropped.
    pub const CATCH_UP: u32 = 4;

    /// The ticks that `elapsed` brings, and those it would bring beyond [`Pace::CATCH_UP`].
    #[must_use]
    pub fn ticks(&mut self, elapsed: Duration) -> (u32, u32) {
        let second = 1_000_000_000;
        self.left += elapsed.as_nanos() * u128::from(TICK_RATE);
        let due = u32::try_from(self.left / second).unwrap_or(u32::MAX);
        self.left %= second;
        (due.min(Self::CATCH_UP), due.saturating_sub(Self::CATCH_UP))
    }

    /// How far the time is from the last tick to the next, 0 to 1.
    #[must_use]
    pub fn between(&self) -> f32 {
        self.left as f32 / 1e9
    }
}
