//! `bench step`: what the core takes in memory, and the instructions of a session's ticks.
//!
//! A session is played to find its slowest ticks by the clock. These are counted one by one under
//! Callgrind, and some of all kinds for the mean; to count every tick would take too long.

use std::fmt::Write as _;
use std::fs;
use std::hint::black_box;
use std::io::{self, Write as _};
use std::iter;
use std::mem::size_of;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use paros_core::bake::Baker;
use paros_core::export::Exporter;
use paros_core::input::Input;
use paros_core::islands::Islands;
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_core::trace::Record;
use paros_core::undo::Undo;
use paros_core::volume::Volume;
use paros_core::world::World;
use paros_shell::durable;
use paros_shell::figures::Figure;
use paros_shell::rmap;
use paros_shell::stage::{Stage, fresh};
use paros_shell::statics::Resident;
use paros_shell::trace::Trace;

use super::Heard;
use super::callgrind::{Folder, counts};
use super::clock::timed;
use super::row::Row;
use crate::demo;
use crate::error::Error;

/// Ticks that are counted because no others take longer.
const SLOWEST: usize = 1000;

/// One tick in so many is counted whatever it does: a prime, so that nothing periodic keeps step.
const SAMPLED: usize = 41;

/// Times that a session is played: what delays a tick from outside doesn't do so each time.
const RUNS: usize = 3;

/// The part of the time that playing a session by the clock takes; the rest is counting.
const TIMED: f64 = 0.1;

/// Rows, and why some are missing if they are.
type Told = (Vec<Row>, Option<String>);

/// Sizes of the core's residents.
pub(super) fn sizes() -> Vec<Row> {
    let mut rows = sizes_at::<128>();
    rows.extend(sizes_at::<256>());
    rows
}

/// Instructions of a tick of the demo.
pub(super) fn demo<const N: usize>(heard: Heard<'_>) -> Result<Told, Error>
where
    Grid<N>: Size + Resident<N>,
{
    let bytes = fresh::<N, _>(|mut stage| {
        stage.record();
        demo::play(&mut stage, 0, &mut |_| ControlFlow::Continue(()), |_, _| {});
        stage.end_recording().unwrap_or_default()
    });
    let trace = Trace::decode(&bytes).map_err(|(_, bad)| Error::failure(bad.expected))?;
    session::<N>("demo", &trace, &bytes, heard)
}

/// Instructions of a tick of a recorded session.
pub(super) fn recorded(path: &Path, heard: Heard<'_>) -> Result<Told, Error> {
    let trace = Trace::read(path).map_err(Error::input)?;
    let bytes = durable::read(path).map_err(Error::input)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    match trace.header().size {
        256 => session::<256>(&name, &trace, &bytes, heard),
        _ => session::<128>(&name, &trace, &bytes, heard),
    }
    .map_err(|error| match error {
        Error::Input(why) => Error::Input(format!("{}: {why}", path.display())),
        failure @ Error::Failure(_) => failure,
    })
}

fn sizes_at<const N: usize>() -> Vec<Row>
where
    Grid<N>: Size,
{
    let sizes = [
        ("World", size_of::<World<N>>()),
        ("Exporter", size_of::<Exporter<N>>()),
        ("Baker", size_of::<Baker<N>>()),
        ("Volume", size_of::<Volume<N>>()),
        ("Undo", size_of::<Undo<N>>()),
        ("Islands", size_of::<Islands<N>>()),
        ("Plane", size_of::<Plane<N>>()),
        ("Maps", size_of::<Maps<N>>()),
    ];
    let row = |(name, bytes): (&str, usize)| Row {
        bytes: Some(bytes as u64),
        ..Row::new("step", "any", N, format!("size of {name}<{N}>"))
    };
    sizes.map(row).into()
}

/// Of a trace, and its bytes.
fn session<const N: usize>(
    name: &str,
    trace: &Trace,
    bytes: &[u8],
    heard: Heard<'_>,
) -> Result<Told, Error>
where
    Grid<N>: Size + Resident<N>,
{
    fresh::<N, _>(|mut stage| stage.replay(trace, |_, _| {})).map_err(Error::input)?;
    let mut times = vec![f64::INFINITY; trace.records().len()];
    for run in 1..=RUNS {
        heard(TIMED * run as f64 / (RUNS + 1) as f64);
        fresh::<N, _>(|mut stage| best_times(&mut stage, trace, &mut times));
    }
    if times.is_empty() {
        return Ok((vec![], None));
    }
    let folder = Folder::new()?;
    durable::write(&folder.0.join(TRACE), bytes)?;
    let chosen = chosen(&times);
    let starts = Grid::<N>::start_volumes();
    for figure in Figure::ALL {
        rmap::write(&volume(&folder.0, figure), starts.figure(figure)).map_err(Error::failure)?;
    }
    drop(starts);
    let mut list = String::new();
    for tick in &chosen {
        let _ = writeln!(list, "{tick}");
    }
    durable::write(&folder.0.join(CHOSEN), list.as_bytes())?;
    let counting = |part: f64| heard(TIMED + (1.0 - TIMED) * part);
    counting(0.0);
    match counts(COUNTED_TICK, &folder.0, &folder, &counting) {
        Ok(counts) if counts.len() == chosen.len() => {
            let counted: Vec<_> = chosen.into_iter().zip(counts).collect();
            Ok((tick_rows::<N>(name, times.len(), &counted), None))
        }
        Ok(counts) => {
            let (counts, chosen) = (counts.len(), chosen.len());
            Err(Error::Failure(format!("valgrind counted {counts} ticks instead of {chosen}")))
        }
        Err(why) => Ok((vec![], Some(format!("instructions of a tick: {why}")))),
    }
}

/// Plays a trace, and keeps each tick's milliseconds if they are the least so far.
fn best_times<const N: usize>(stage: &mut Stage<'_, N>, trace: &Trace, best: &mut [f64])
where
    Grid<N>: Size,
{
    for (best, record) in iter::zip(best, trace.records()) {
        stage.tick_within(&record.input, |step| *best = best.min(timed(step)));
    }
}

/// The slowest ticks and the sampled ones, in order.
fn chosen(times: &[f64]) -> Vec<usize> {
    let mut ticks: Vec<usize> = (0..times.len()).collect();
    ticks.sort_unstable_by(|&a, &b| times[b].total_cmp(&times[a]));
    ticks.truncate(SLOWEST);
    ticks.extend((0..times.len()).step_by(SAMPLED));
    ticks.sort_unstable();
    ticks.dedup();
    ticks
}

/// How often a replay tells how far it is, about.
const PARTS: usize = 500;

const TRACE: &str = "session.trace";
const CHOSEN: &str = "ticks";

fn volume(folder: &Path, figure: Figure) -> PathBuf {
    folder.join(figure.name()).with_extension("rmap")
}

/// Plays a trace again under Callgrind: the child's part.
///
/// # Errors
/// A file that is not as the measuring run left it.
pub(super) fn replay(folder: &Path) -> Result<(), Error> {
    let trace = Trace::read(&folder.join(TRACE)).map_err(Error::input)?;
    let list = fs::read_to_string(folder.join(CHOSEN)).map_err(Error::input)?;
    let chosen: Result<Vec<usize>, _> = list.lines().map(str::parse).collect();
    let chosen = chosen.map_err(Error::input)?;
    match trace.header().size {
        256 => replay_at::<256>(folder, &trace, &chosen),
        _ => replay_at::<128>(folder, &trace, &chosen),
    }
}

fn replay_at<const N: usize>(folder: &Path, trace: &Trace, chosen: &[usize]) -> Result<(), Error>
where
    Grid<N>: Size + Resident<N>,
{
    let fill = |figure, maps: &mut _| rmap::read(&volume(folder, figure), maps).map(drop);
    Grid::<N>::start_volumes().take(fill).map_err(Error::input)?;
    let mut chosen = chosen.iter().copied().peekable();
    let (ticks, mut out) = (trace.records().len(), io::stdout().lock());
    let digest = fresh::<N, _>(|mut stage| {
        for (tick, record) in trace.records().enumerate() {
            if tick % ticks.div_ceil(PARTS) == 0 {
                // Nobody may be listening there.
                let _ = writeln!(out, "{}", tick as f64 / ticks as f64);
            }
            match chosen.next_if_eq(&tick) {
                Some(_) => counted_tick(&mut stage, &record.input),
                None => stage.tick(&record.input),
            }
        }
        stage.world().digest()
    });
    match trace.records().last().map(Record::digest) {
        Some(recorded) if recorded != digest => {
            Err(Error::Failure("the replay came to another digest".into()))
        }
        _ => Ok(()),
    }
}

/// What of its name both sizes share.
const COUNTED_TICK: &str = concat!(module_path!(), "::counted_tick");

/// A tick with a dump of its own, found by this name.
#[inline(never)]
fn counted_tick<const N: usize>(stage: &mut Stage<'_, N>, input: &Input)
where
    Grid<N>: Size,
{
    stage.tick(black_box(input));
    black_box(stage.world().tick());
}

/// Of the ticks that were counted.
fn tick_rows<const N: usize>(name: &str, ticks: usize, counted: &[(usize, u64)]) -> Vec<Row> {
    let sample = counted.iter().filter(|(tick, _)| tick % SAMPLED == 0);
    let mut sample: Vec<u64> = sample.map(|&(_, count)| count).collect();
    sample.sort_unstable();
    let row =
        |count, what: String| Row { instructions: Some(count), ..Row::new("step", name, N, what) };
    let of = format!("of {} of its {ticks} ticks, one in {SAMPLED}", sample.len());
    let mean = sample.iter().sum::<u64>() / sample.len().max(1) as u64;
    let p99 = sample.get((sample.len() * 99).div_ceil(100).saturating_sub(1));
    let worst = counted.iter().max_by_key(|&&(_, count)| count);
    let mut rows = vec![row(mean, format!("mean {of}"))];
    rows.extend(p99.map(|&p99| row(p99, format!("p99 {of}"))));
    rows.extend(worst.map(|&(tick, count)| {
        let of = format!("{} of them, {SLOWEST} the slowest", counted.len());
        row(count, format!("worst of {of}: tick {tick}"))
    }));
    rows
}
