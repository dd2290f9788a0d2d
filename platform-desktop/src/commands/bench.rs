//! `paros bench`: how fast, how small, beside what.

use std::path::PathBuf;

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};

use paros_shell::require::require;

use super::progress;
use crate::bench::{Bench, Plan, Subject, step, table};
use crate::error::Error;

/// Measure speed and size against the usual ways, in turns, best of many runs, on one thread.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// What to measure.
    #[arg(default_value = "all", value_parser = which())]
    what: Which,
    /// What to measure on: a mesh, a volume (.rmap) or a figure's name; may be repeated.
    #[arg(long = "volume", value_name = "V")]
    volumes: Vec<PathBuf>,
    /// Rows as JSON.
    #[arg(long)]
    json: bool,
    /// Runs of each side; the best counts.
    #[arg(long, default_value = "21", value_parser = clap::value_parser!(u16).range(1..))]
    runs: u16,
    /// The Python that has vtk, trimesh, numpy and scipy.
    #[arg(long, value_name = "PATH", default_value = "python3")]
    python: PathBuf,
    /// For the bench's own use: steps a recorded session, to be counted from outside.
    #[arg(long, hide = true, value_name = "DIR")]
    replay: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug)]
enum Which {
    All,
    One(Bench),
}

fn which() -> impl TypedValueParser<Value = Which> {
    PossibleValuesParser::new(["all", "islands", "edit", "mesh", "bake", "step"])
        .map(|name| Bench::from_str(&name, false).map_or(Which::All, Which::One))
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    if let Some(folder) = &args.replay {
        return step::replay(folder).map(|()| String::new());
    }
    let subjects = match args.volumes.as_slice() {
        [] => Subject::own(),
        named => named.iter().map(|v| Subject::named(v)).collect::<Result<_, _>>()?,
    };
    let benches = match args.what {
        Which::All => Bench::value_variants().to_vec(),
        Which::One(bench) => vec![bench],
    };
    let plan = Plan { benches, subjects, runs: args.runs.into(), python: args.python.clone() };
    let bar = progress::bar("measuring", Some(plan.pieces() as u64));
    let report = plan.run(|done| bar.advance_to(done as u64))?;
    drop(bar);
    let missing = report.skipped.iter().map(|why| require::<(), _>(Err(why)));
    // All are told before the first of them counts.
    for missing in missing.collect::<Vec<_>>() {
        missing.map_err(Error::failure)?;
    }
    match args.json {
        true => {
            serde_json::to_string_pretty(&report.rows).map(|s| s + "\n").map_err(Error::failure)
        }
        false => Ok(table(&report.rows)),
    }
}
