//! `bench step`: what the core takes in memory, and the instructions of each tick of the demo.
//!
//! Callgrind counts them, on the demo's recorded trace.

use std::fs;
use std::hint::black_box;
use std::mem::size_of;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use paros_core::bake::Baker;
use paros_core::export::Exporter;
use paros_core::input::Input;
use paros_core::islands::Islands;
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_core::undo::Undo;
use paros_core::volume::Volume;
use paros_core::world::{Starts, World};
use paros_shell::figures::Figure;
use paros_shell::rmap;
use paros_shell::stage::Stage;
use paros_shell::statics::Resident;
use paros_shell::trace::Trace;

use super::callgrind::{Folder, counts};
use super::row::Row;
use crate::demo;
use crate::error::Error;

const N: usize = 128;

/// Of so many ticks in a row, the first [`COUNTED`] are counted one by one: a dump of every
/// tick would take too long.
const WINDOW: usize = 400;
const COUNTED: usize = 40;

/// Sizes of the core's residents and instructions of a tick, and why these are missing if they are.
pub(super) fn rows() -> Result<(Vec<Row>, Option<String>), Error> {
    let mut rows = sizes::<128>();
    rows.extend(sizes::<256>());
    let folder = Folder::new()?;
    record(&folder.0)?;
    match counts(COUNTED_TICK, &folder.0, &folder) {
        Ok(counts) => {
            rows.extend(tick_rows(counts));
            Ok((rows, None))
        }
        Err(why) => Ok((rows, Some(format!("instructions of a tick: {why}")))),
    }
}

fn sizes<const N: usize>() -> Vec<Row>
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

/// Plays the demo; leaves its trace and what it started from.
fn record(folder: &Path) -> Result<(), Error> {
    let mut starts = Grid::<N>::start_volumes();
    starts.make(&mut Grid::<N>::plane(), |_| {});
    for figure in Figure::ALL {
        rmap::write(&volume(folder, figure), starts.figure(figure)).map_err(Error::failure)?;
    }
    let hidden = starts.hidden();
    let mut world = Grid::<N>::world();
    let mut stage = Stage::new(&mut world, starts.starts(&hidden));
    stage.record();
    demo::play(&mut stage, 0, &mut |_| ControlFlow::Continue(()), |_, _| {});
    let trace = stage.end_recording().unwrap_or_default();
    fs::write(folder.join(TRACE), trace).map_err(Error::failure)
}

const TRACE: &str = "session.trace";

fn volume(folder: &Path, figure: Figure) -> PathBuf {
    folder.join(figure.name()).with_extension("rmap")
}

/// Plays a trace again under Callgrind: the child's part.
///
/// # Errors
/// A file that is not as the measuring run left it.
pub(super) fn replay(folder: &Path) -> Result<(), Error> {
    static FIGURES: Mutex<[Maps<N>; Figure::ALL.len()]> =
        Mutex::new([const { Maps::new() }; Figure::ALL.len()]);
    let mut figures = FIGURES.lock().map_err(Error::failure)?;
    for (maps, figure) in figures.iter_mut().zip(Figure::ALL) {
        rmap::read(&volume(folder, figure), maps).map_err(Error::input)?;
    }
    let hidden = Figure::HIDDEN.map(|figure| &figures[figure as usize]);
    let starts = Starts {
        lump: &figures[Figure::Lump as usize],
        figures: &hidden,
        creative: &figures[Figure::Toy as usize],
        own: None,
    };
    let trace = Trace::read(&folder.join(TRACE)).map_err(Error::input)?;
    let mut world = Grid::<N>::world();
    let mut stage = Stage::new(&mut world, starts);
    for (tick, record) in trace.records().enumerate() {
        if tick % WINDOW < COUNTED {
            counted_tick(&mut stage, &record.input);
        } else {
            stage.tick(&record.input);
        }
    }
    match trace.records().last().map(paros_core::trace::Record::digest) {
        Some(digest) if digest != stage.world().digest() => {
            Err(Error::Failure("the replay came to another digest".into()))
        }
        _ => Ok(()),
    }
}

const COUNTED_TICK: &str = concat!(module_path!(), "::counted_tick");

/// A tick with a dump of its own, found by this name.
#[inline(never)]
fn counted_tick(stage: &mut Stage<'_, N>, input: &Input) {
    stage.tick(black_box(input));
    black_box(stage.world().tick());
}

/// Of the instructions of the ticks counted one by one.
fn tick_rows(mut counts: Vec<u64>) -> [Row; 3] {
    counts.sort_unstable();
    let mean = counts.iter().sum::<u64>() / counts.len() as u64;
    let p99 = counts[(counts.len() * 99).div_ceil(100) - 1];
    let worst = counts[counts.len() - 1];
    let of = format!("{} of the demo's ticks, {COUNTED} in every {WINDOW}", counts.len());
    let row = |(name, count)| Row {
        instructions: Some(count),
        ..Row::new("step", "demo", N, format!("{name} of {of}"))
    };
    [("mean", mean), ("p99", p99), ("worst", worst)].map(row)
}
