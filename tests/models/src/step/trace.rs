//! A session's inputs as text, for replaying a failure: `step SIDE INTERVALS`, the start volume and its mask
//! as run lengths beginning with an empty run, and a line for each tick.

use std::fmt::{Display, Formatter};
use std::str::FromStr;

use paros_core::TickInput;
use paros_core::codec::ByteReader;
use paros_core::internals::ByteWriter;

use crate::dense::{DenseVolume, MaskedVolume};

/// A session's inputs.
#[derive(Clone, PartialEq, Debug)]
pub struct StepTrace {
    /// Voxels a side.
    pub side: usize,
    /// Intervals a column.
    pub intervals: usize,
    /// The start volume.
    pub volume: DenseVolume,
    /// The hidden figure.
    pub mask: DenseVolume,
    /// The events.
    pub events: Vec<TraceEvent>,
}

/// A line of a trace.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum TraceEvent {
    /// A tick.
    Tick(TickInput),
    /// The world is saved and loaded into another world, which continues.
    Reload,
}

impl StepTrace {
    /// Creates a trace without events.
    pub fn from_start(start: &MaskedVolume, intervals: usize) -> Self {
        StepTrace {
            side: start.volume.side(),
            intervals,
            volume: start.volume.clone(),
            mask: start.mask.clone(),
            events: Vec::new(),
        }
    }
}

impl Display for StepTrace {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "step {} {}", self.side, self.intervals)?;
        for (name, voxels) in [("volume", &self.volume), ("mask", &self.mask)] {
            write!(f, "{name}")?;
            for run in runs_of(voxels) {
                write!(f, " {run}")?;
            }
            writeln!(f)?;
        }
        for event in &self.events {
            match event {
                TraceEvent::Reload => writeln!(f, "reload")?,
                TraceEvent::Tick(input) => {
                    let mut bytes = [0; TickInput::BYTES];
                    input.write(&mut ByteWriter::new(&mut bytes));
                    write!(f, "tick ")?;
                    bytes.iter().try_for_each(|byte| write!(f, "{byte:02x}"))?;
                    writeln!(f)?;
                }
            }
        }
        Ok(())
    }
}

impl FromStr for StepTrace {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut lines = text.lines().enumerate();
        let mut words_of = |name: &str| {
            let (_, line) = lines.next().ok_or(format!("no line of {name}"))?;
            let words = line.strip_prefix(name).ok_or(format!("a line of {name}, not {line}"))?;
            let numbers = words.split_whitespace().map(str::parse::<usize>);
            numbers.collect::<Result<Vec<_>, _>>().map_err(|error| format!("{name}: {error}"))
        };
        let &[side, intervals] = &words_of("step")?[..] else {
            return Err("side and intervals".into());
        };
        let volume = from_runs(side, &words_of("volume")?)?;
        let mask = from_runs(side, &words_of("mask")?)?;
        let events = lines.map(|(i, line)| {
            let event = read_event(line).ok_or(format!("line {}: no event: {line}", i + 1))?;
            Ok(event)
        });
        let events = events.collect::<Result<Vec<_>, String>>()?;
        Ok(StepTrace { side, intervals, volume, mask, events })
    }
}

fn read_event(line: &str) -> Option<TraceEvent> {
    if line == "reload" {
        return Some(TraceEvent::Reload);
    }
    let digits = line.strip_prefix("tick ")?;
    let bytes =
        (0..digits.len() / 2).map(|i| u8::from_str_radix(digits.get(2 * i..2 * i + 2)?, 16).ok());
    let bytes = bytes.collect::<Option<Vec<_>>>()?;
    TickInput::read(&mut ByteReader::new(&bytes)).ok().map(TraceEvent::Tick)
}

fn runs_of(voxels: &DenseVolume) -> Vec<usize> {
    let mut runs = vec![0];
    let mut occupied = false;
    for voxel in voxels.all_voxels() {
        if voxels.contains(voxel) != occupied {
            occupied = !occupied;
            runs.push(0);
        }
        *runs.last_mut().expect("a run") += 1;
    }
    runs
}

fn from_runs(side: usize, runs: &[usize]) -> Result<DenseVolume, String> {
    let mut voxels = DenseVolume::empty(side);
    let mut all = voxels.all_voxels();
    for (i, &run) in runs.iter().enumerate() {
        for _ in 0..run {
            let voxel = all.next().ok_or("more voxels than there are")?;
            voxels.set(voxel, i % 2 == 1);
        }
    }
    Ok(voxels)
}
