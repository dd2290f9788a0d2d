//! The arguments of `paros-bench`, and its report.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use paros_bench::{BenchSubject, Benchmark, Plan, format_table};
use paros_headless::{Error, parse_width_x_height, show_progress};
use paros_shell::require::require_or_skip;

/// Compare speed and size with the usual methods: alternating, best of many runs, on one thread.
#[derive(Debug, clap::Parser)]
#[command(name = "paros-bench", version)]
pub(super) struct Args {
    /// Benchmark to run.
    #[arg(default_value = "all", value_parser = choice_parser())]
    what: BenchChoice,
    /// Meshes, volumes (.rmap) or figures (lump, owl, cat, amphora, dolphin, toy) to measure.
    ///
    /// For `step`, traces of sessions, each of which takes minutes. For `layers`, also traces (.trace).
    #[arg(value_name = "V")]
    named: Vec<PathBuf>,
    /// Like V, but one for each --volume.
    #[arg(long = "volume", value_name = "V")]
    volumes: Vec<PathBuf>,
    /// Write the rows as JSON.
    #[arg(long)]
    json: bool,
    /// Runs of each side, of which the best counts [default: 21, and 9 for each frame]. `step` always takes
    /// 3.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    runs: Option<u16>,
    /// Width and height of a frame in pixels.
    #[arg(long, value_name = "WxH", default_value = "1440x1584",
        value_parser = parse_width_x_height, allow_hyphen_values = true)]
    size: [usize; 2],
    /// Part of the name of the Vulkan device that draws. By default the best device, which for `all` and
    /// `paper` must be a GPU.
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
    /// Python interpreter that has vtk, trimesh, numpy and scipy.
    #[arg(long, value_name = "PATH", default_value = "python3")]
    python: PathBuf,
    /// For internal use: replay the files of a measuring run under Callgrind, which counts from outside.
    #[arg(long, hide = true, value_name = "PATH")]
    replay: Option<PathBuf>,
}

/// Default number of runs of each side, and of each frame (there are many frames).
const RUNS: u16 = 21;
const FRAME_RUNS: u16 = 9;

/// Steps of the progress bar for each piece.
const BAR: u64 = 1000;

#[derive(Clone, Copy, Debug)]
enum BenchChoice {
    All,
    One(Benchmark),
}

fn choice_parser() -> impl TypedValueParser<Value = BenchChoice> {
    let names = Benchmark::ALL.map(Benchmark::name);
    PossibleValuesParser::new(["all"].into_iter().chain(names))
        .map(|name| Benchmark::from_name(&name).map_or(BenchChoice::All, BenchChoice::One))
}

fn has_trace_extension(path: &Path) -> bool {
    path.extension().is_some_and(|kind| kind.eq_ignore_ascii_case("trace"))
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    if let Some(what) = &args.replay {
        return paros_bench::replay_for_callgrind(what).map(|()| String::new());
    }
    let mut named: Vec<_> = args.named.iter().chain(&args.volumes).collect();
    let mut traces = vec![];
    match args.what {
        BenchChoice::One(Benchmark::Step) => traces = std::mem::take(&mut named),
        BenchChoice::One(Benchmark::Layers) => {
            (traces, named) = named.into_iter().partition(|name| has_trace_extension(name));
        }
        _ => {}
    }
    let subjects = named.into_iter().map(|v| BenchSubject::from_name_or_path(v));
    let mut subjects = subjects.collect::<Result<Vec<_>, _>>()?;
    if subjects.is_empty() {
        subjects = BenchSubject::default_figures();
    }
    let benches = match args.what {
        BenchChoice::All => Benchmark::ALL.to_vec(),
        BenchChoice::One(bench) => vec![bench],
    };
    let plan = Plan {
        benches,
        subjects,
        traces: traces.into_iter().cloned().collect(),
        runs: args.runs.unwrap_or(RUNS).into(),
        frame_runs: args.runs.unwrap_or(FRAME_RUNS).into(),
        canvas: args.size.map(|side| side as u32),
        device: args.device.clone(),
        python: args.python.clone(),
    };
    let slow = plan.benches.contains(&Benchmark::Step);
    let what = if slow { "measuring (step takes minutes)" } else { "measuring" };
    let bar = show_progress(what, Some(BAR * plan.piece_count() as u64));
    let report = plan.run(|done| bar.set_steps_done((BAR as f64 * done) as u64))?;
    drop(bar);
    for note in &report.notes {
        // Standard error may be closed.
        let _ = writeln!(io::stderr(), "{note}");
    }
    let missing = report.skipped.iter().map(|why| require_or_skip::<(), _>(Err(why)));
    // Report all missing dependencies before the first of them becomes an error.
    for missing in missing.collect::<Vec<_>>() {
        missing.map_err(Error::failure)?;
    }
    match args.json {
        true => {
            serde_json::to_string_pretty(&report.rows).map(|s| s + "\n").map_err(Error::failure)
        }
        false => Ok(format_table(&report.rows)),
    }
}
