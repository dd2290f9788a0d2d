//! `bench step`: the core's size in memory, and the instructions of a session's ticks.
//!
//! A session is played to find its slowest ticks by the clock. These are counted one by one under Callgrind,
//! with a sample of all ticks for the mean; counting every tick would take too long.

use std::fmt::Write as _;
use std::fs;
use std::hint::black_box;
use std::io::{self, Write as _};
use std::iter;
use std::mem::size_of;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use paros_core::codec::trace::TickRecord;
use paros_core::convert::ColumnWindings;
use paros_core::internals::{IslandSearch, UndoHistory};
use paros_core::limits::INTERVALS;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{Baker, Exporter, RangeMaps, TickInput, Volume, World};
use paros_headless::Error;
use paros_shell::demo::{self, DemoScript};
use paros_shell::durable;
use paros_shell::rmap;
use paros_shell::sizes::GRID_SIDES;
use paros_shell::start_volume_store::StartVolume;
use paros_shell::statics::Resident;
use paros_shell::tick_runner::{TickRunner, with_fresh_world};
use paros_shell::trace::{ReplayDivergence, Trace};
use paros_shell::{with_intervals, with_size};

use super::OnProgress;
use super::callgrind::{ScratchFolder, count_instructions_per_call};
use super::clock::time_ms;
use super::row::{Measured, ReportRow};

/// Number of slowest ticks that are counted.
const SLOWEST: usize = 300;

/// Sampling interval of the other ticks: a prime, so that no periodic work coincides with it.
const SAMPLED: usize = 41;

/// Number of times that a session is played by the clock. The minimum of each tick excludes outside delays.
const RUNS: usize = 3;

/// Fraction of the progress bar for the runs by the clock; the rest is counting.
const TIMED: f64 = 0.1;

/// Returns rows with the `size_of` of the core's large types, at each grid size.
pub(super) fn type_size_rows() -> Vec<ReportRow> {
    GRID_SIDES
        .into_iter()
        .flat_map(|size| {
            with_size!(size, N => [
                type_size_rows_at::<N>(),
                layered_size_rows_at::<N, 1>(),
                layered_size_rows_at::<N, INTERVALS>(),
            ])
        })
        .flatten()
        .collect()
}

/// Counts the instructions of a tick of the demo.
pub(super) fn measure_demo<const N: usize>(on_progress: OnProgress<'_>) -> Result<Measured, Error>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let bytes = with_fresh_world::<N, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        let mut watcher = |_: &World<N, INTERVALS>| ControlFlow::Continue(());
        demo::play_demo(DemoScript::Owl, &mut runner, &mut watcher, |_, _| {});
        runner.end_recording_to_bytes().unwrap_or_default()
    });
    let trace = Trace::decode(&bytes).map_err(|fault| Error::failure(fault.bad.expected))?;
    measure_session::<N, INTERVALS>("demo", &trace, &bytes, on_progress)
}

/// Counts the instructions of a tick of a recorded session.
pub(super) fn measure_recorded(
    path: &Path,
    on_progress: OnProgress<'_>,
) -> Result<Measured, Error> {
    let trace = Trace::read(path).map_err(Error::input)?;
    let bytes = durable::read_regular_file(path).map_err(Error::input)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let header = trace.header();
    let measured = with_size!(header.side, N => with_intervals!(
        header.intervals.into(),
        K => measure_session::<N, K>(&name, &trace, &bytes, on_progress),
        else Err(Error::input(ReplayDivergence::no_world_of_intervals(&header))),
    ));
    measured.map_err(|error| match error {
        Error::Input(why) => Error::Input(format!("{}: {why}", path.display())),
        failure @ Error::Failure(_) => failure,
    })
}

fn type_size_rows_at<const N: usize>() -> Vec<ReportRow>
where
    Grid<N>: Size,
{
    let sizes = [
        (format!("Exporter<{N}>"), size_of::<Exporter<N>>()),
        (format!("Baker<{N}>"), size_of::<Baker<N>>()),
        (format!("Baker<{N}, ColumnWindings<{N}>>"), size_of::<Baker<N, ColumnWindings<N>>>()),
        (format!("IslandSearch<{N}>"), size_of::<IslandSearch<N>>()),
        (format!("BitGrid<{N}>"), size_of::<BitGrid<N>>()),
    ];
    sizes.map(|(name, bytes)| type_size_row(N, &name, bytes)).into()
}

/// Returns rows for the types whose size depends on the intervals of a column.
fn layered_size_rows_at<const N: usize, const K: usize>() -> Vec<ReportRow>
where
    Grid<N>: Size,
{
    let sizes = [
        ("World", size_of::<World<N, K>>()),
        ("Volume", size_of::<Volume<N, K>>()),
        ("UndoHistory", size_of::<UndoHistory<N, K>>()),
        ("RangeMaps", size_of::<RangeMaps<N, K>>()),
    ];
    sizes.map(|(name, bytes)| type_size_row(N, &format!("{name}<{N}, {K}>"), bytes)).into()
}

fn type_size_row(grid_side: usize, name: &str, bytes: usize) -> ReportRow {
    ReportRow {
        bytes: Some(bytes as u64),
        ..ReportRow::new("step", "any", grid_side, format!("size of {name}"))
    }
}

/// Plays a trace by the clock, then counts its slowest and its sampled ticks under Callgrind.
/// `trace_bytes` is the encoded trace.
fn measure_session<const N: usize, const K: usize>(
    name: &str,
    trace: &Trace,
    trace_bytes: &[u8],
    on_progress: OnProgress<'_>,
) -> Result<Measured, Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    with_fresh_world::<N, K, _>(|mut runner| runner.replay_on_same_start(trace, |_| {}))
        .map_err(Error::input)?;
    let mut times = vec![f64::INFINITY; trace.records().len()];
    for run in 1..=RUNS {
        on_progress(TIMED * run as f64 / (RUNS + 1) as f64);
        with_fresh_world::<N, K, _>(|mut runner| {
            replay_and_lower_best_ms(&mut runner, trace, &mut times);
        });
    }
    if times.is_empty() {
        return Ok(Measured { rows: vec![], skipped: None });
    }
    let folder = ScratchFolder::new()?;
    durable::write_file(&folder.0.join(TRACE), trace_bytes)?;
    let chosen = choose_ticks_to_count(&times);
    let starts = Grid::<N>::lock_world();
    for volume in StartVolume::all() {
        rmap::write(&volume_path(&folder.0, volume), starts.start_volumes.volume(volume))
            .map_err(Error::failure)?;
    }
    drop(starts);
    let mut list = String::new();
    for tick in &chosen {
        let _ = writeln!(list, "{tick}");
    }
    durable::write_file(&folder.0.join(CHOSEN), list.as_bytes())?;
    let counting = |part: f64| on_progress(TIMED + (1.0 - TIMED) * part);
    counting(0.0);
    match count_instructions_per_call(COUNTED_TICK, &folder.0, &folder, &counting) {
        Ok(counts) if counts.len() == chosen.len() => {
            let counted: Vec<_> = iter::zip(chosen, counts)
                .map(|(index, instructions)| CountedTick { index, instructions })
                .collect();
            let rows = tick_rows::<N>(name, times.len(), &counted);
            Ok(Measured { rows, skipped: None })
        }
        Ok(counts) => {
            let (counts, chosen) = (counts.len(), chosen.len());
            Err(Error::Failure(format!("valgrind counted {counts} ticks instead of {chosen}")))
        }
        Err(why) => {
            let skipped = Some(format!("instructions of a tick: {why}"));
            Ok(Measured { rows: vec![], skipped })
        }
    }
}

/// Plays a trace, and lowers `best_ms` to each tick's milliseconds if they are less.
fn replay_and_lower_best_ms<const N: usize, const K: usize>(
    runner: &mut TickRunner<'_, N, K>,
    trace: &Trace,
    best_ms: &mut [f64],
) where
    Grid<N>: Size,
{
    for (best, record) in iter::zip(best_ms, trace.records()) {
        runner.run_tick_wrapped(&record.input, |step| *best = best.min(time_ms(step)));
    }
}

/// Returns the numbers of the [`SLOWEST`] ticks and of every tick in [`SAMPLED`], ascending.
fn choose_ticks_to_count(times_ms: &[f64]) -> Vec<usize> {
    let mut ticks: Vec<usize> = (0..times_ms.len()).collect();
    ticks.sort_unstable_by(|&a, &b| times_ms[b].total_cmp(&times_ms[a]));
    ticks.truncate(SLOWEST);
    ticks.extend((0..times_ms.len()).step_by(SAMPLED));
    ticks.sort_unstable();
    ticks.dedup();
    ticks
}

/// Approximate number of progress lines that a replay writes.
const PARTS: usize = 500;

const TRACE: &str = "session.trace";
const CHOSEN: &str = "ticks";

fn volume_path(folder: &Path, volume: StartVolume) -> PathBuf {
    folder.join(volume.name()).with_extension("rmap")
}

/// Replays a trace under Callgrind, in the child process.
///
/// # Errors
/// A file differs from what the measuring run wrote.
pub(super) fn replay_ticks(session_folder: &Path) -> Result<(), Error> {
    let trace = Trace::read(&session_folder.join(TRACE)).map_err(Error::input)?;
    let list = fs::read_to_string(session_folder.join(CHOSEN)).map_err(Error::input)?;
    let chosen: Result<Vec<usize>, _> = list.lines().map(str::parse).collect();
    let chosen = chosen.map_err(Error::input)?;
    let header = trace.header();
    with_size!(header.side, N => with_intervals!(
        header.intervals.into(),
        K => replay_ticks_at::<N, K>(session_folder, &trace, &chosen),
        else Err(Error::input(ReplayDivergence::no_world_of_intervals(&header))),
    ))
}

fn replay_ticks_at<const N: usize, const K: usize>(
    folder: &Path,
    trace: &Trace,
    chosen: &[usize],
) -> Result<(), Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    let load_into = |volume, maps: &mut _| rmap::read(&volume_path(folder, volume), maps).map(drop);
    Grid::<N>::lock_world().start_volumes.load(load_into).map_err(Error::input)?;
    let mut chosen = chosen.iter().copied().peekable();
    let (ticks, mut out) = (trace.records().len(), io::stdout().lock());
    let digest = with_fresh_world::<N, K, _>(|mut runner| {
        for (tick, record) in trace.records().enumerate() {
            if tick % ticks.div_ceil(PARTS) == 0 {
                // The reader may have closed the pipe.
                let _ = writeln!(out, "{}", tick as f64 / ticks as f64);
            }
            match chosen.next_if_eq(&tick) {
                Some(_) => counted_tick(&mut runner, &record.input),
                None => runner.run_tick(&record.input),
            }
        }
        runner.world().digest()
    });
    match trace.records().last().map(TickRecord::digest) {
        Some(recorded) if recorded != digest => {
            Err(Error::Failure("the replay came to another digest".into()))
        }
        _ => Ok(()),
    }
}

/// The counted function's name, as the prefix that all grid sizes share.
const COUNTED_TICK: &str = concat!(module_path!(), "::counted_tick");

/// Runs one tick. Callgrind counts this function by its name.
#[inline(never)]
fn counted_tick<const N: usize, const K: usize>(
    runner: &mut TickRunner<'_, N, K>,
    input: &TickInput,
) where
    Grid<N>: Size,
{
    runner.run_tick(black_box(input));
    black_box(runner.world().tick());
}

/// A tick of a session, and its number of instructions.
#[derive(Clone, Copy)]
struct CountedTick {
    /// The number of ticks before this one.
    index: usize,
    instructions: u64,
}

/// Returns rows for the mean, the 99th percentile and the worst tick.
fn tick_rows<const N: usize>(
    session_name: &str,
    session_ticks: usize,
    counted: &[CountedTick],
) -> Vec<ReportRow> {
    let sample = counted.iter().filter(|tick| tick.index % SAMPLED == 0);
    let mut sample: Vec<u64> = sample.map(|tick| tick.instructions).collect();
    sample.sort_unstable();
    let row = |count, what: String| ReportRow {
        instructions: Some(count),
        ..ReportRow::new("step", session_name, N, what)
    };
    let of = format!("of {} of its {session_ticks} ticks, one in {SAMPLED}", sample.len());
    let mean = sample.iter().sum::<u64>() / sample.len().max(1) as u64;
    let p99 = sample.get((sample.len() * 99).div_ceil(100).saturating_sub(1));
    let worst = counted.iter().max_by_key(|tick| tick.instructions);
    let mut rows = vec![row(mean, format!("mean {of}"))];
    rows.extend(p99.map(|&p99| row(p99, format!("p99 {of}"))));
    rows.extend(worst.map(|&CountedTick { index, instructions }| {
        let of = format!("{} of them, {SLOWEST} the slowest", counted.len());
        row(instructions, format!("worst of {of}: tick {index}"))
    }));
    rows
}

#[cfg(test)]
mod tests {
    use super::type_size_rows;

    #[test]
    fn the_baker_of_several_intervals_has_a_row() {
        let rows = type_size_rows();
        for side in [128, 256] {
            let bytes_of = |name: String| {
                let row = rows.iter().find(|row| row.against == format!("size of {name}"));
                row.and_then(|row| row.bytes).unwrap_or_else(|| panic!("no {name}"))
            };
            let [one, more] = [
                bytes_of(format!("Baker<{side}>")),
                bytes_of(format!("Baker<{side}, ColumnWindings<{side}>>")),
            ];
            assert!(one < more && more < 2 * one, "{one} {more}");
        }
    }
}
