//! `bench step`: what the core takes in memory, and the instructions of each tick of the demo.
//!
//! Callgrind counts them: this program runs itself under it, on the demo's recorded trace, with
//! each counted tick in a function of its own, and reads the totals of its many dumps.

use std::fs;
use std::hint::black_box;
use std::io::{BufRead, BufReader};
use std::mem::size_of;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
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
    match count(&folder.0) {
        Ok(counts) => {
            rows.extend(counts.rows());
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

/// A folder of this process alone, gone when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, Error> {
        let folder = std::env::temp_dir().join(format!("paros-bench-{}", std::process::id()));
        fs::create_dir_all(&folder)
            .map_err(|e| Error::Failure(format!("{}: can't be made: {e}", folder.display())))?;
        Ok(Folder(folder))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
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
pub fn replay(folder: &Path) -> Result<(), Error> {
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

/// The name of [`counted_tick`], whole: Callgrind finds no end to names with a `*` in front.
const COUNTED_TICK: &str = concat!(module_path!(), "::counted_tick");

/// A tick with a dump of its own, found by this name. Something must follow the tick, or it would
/// be a jump, of which Callgrind sees no end.
#[inline(never)]
fn counted_tick(stage: &mut Stage<'_, N>, input: &Input) {
    stage.tick(black_box(input));
    black_box(stage.world().tick());
}

/// Instructions of the ticks counted one by one, least first.
struct Counts(Vec<u64>);

impl Counts {
    fn rows(&self) -> Vec<Row> {
        let counts = &self.0;
        let mean = counts.iter().sum::<u64>() / counts.len() as u64;
        let p99 = counts[(counts.len() * 99).div_ceil(100) - 1];
        let worst = counts[counts.len() - 1];
        let of = format!("{} of the demo's ticks, {COUNTED} in every {WINDOW}", counts.len());
        let row = |(name, count)| Row {
            instructions: Some(count),
            ..Row::new("step", "demo", N, format!("{name} of {of}"))
        };
        [("mean", mean), ("p99", p99), ("worst", worst)].map(row).into()
    }
}

fn count(folder: &Path) -> Result<Counts, String> {
    let this = std::env::current_exe().map_err(|e| e.to_string())?;
    let dumps = folder.join("callgrind.out");
    let run = Command::new("valgrind")
        .args(["--tool=callgrind", "--combine-dumps=yes", "--dump-line=no", "--collect-atstart=no"])
        .args([format!("--toggle-collect={COUNTED_TICK}"), format!("--dump-after={COUNTED_TICK}")])
        .arg(format!("--callgrind-out-file={}", dumps.display()))
        .arg(this)
        .args(["bench", "--replay"])
        .arg(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .map_err(|e| format!("valgrind can't be started: {e}"))?;
    if !run.status.success() {
        let errors = String::from_utf8_lossy(&run.stderr);
        return Err(format!("valgrind failed: {}", errors.lines().last().unwrap_or_default()));
    }
    let file = fs::File::open(&dumps).map_err(|e| e.to_string())?;
    let mut counts: Vec<u64> = BufReader::new(file)
        .split(b'\n')
        .map_while(Result::ok)
        .filter_map(|line| {
            std::str::from_utf8(&line).ok()?.strip_prefix("summary: ")?.trim().parse().ok()
        })
        // The last dump, at the end of the program, holds no tick.
        .filter(|&count| count > 0)
        .collect();
    if counts.is_empty() {
        return Err("valgrind counted nothing".into());
    }
    counts.sort_unstable();
    Ok(Counts(counts))
}
