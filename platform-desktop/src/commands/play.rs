//! `paros play`: replays a recorded session, which must lead to the same digests.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use paros_core::session::SessionState;
use paros_core::volume::{Grid, Size};
use paros_core::{RangeMaps, World};
use paros_headless::{Error, show_progress};
use paros_shaders::Camera;
use paros_shell::durable::{self, WriteTarget};
use paros_shell::edit_totals::EditTotals;
use paros_shell::statics::{Resident, WorldWithStarts};
use paros_shell::stl_export::{FinishedStl, StlExporter};
use paros_shell::tick_runner::{ReplayedTick, TickRunner};
use paros_shell::trace::{ReplayDivergence, Trace};
use paros_shell::{with_intervals, with_size};
use serde::Serialize;

use super::drawing::{DrawingBackground, DrawingOptions, PictureRenderer};
use super::volume;

/// Replay a trace, and stop at the first tick that differs from the recording.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Trace to replay.
    trace: PathBuf,
    /// Volume from which the trace's sessions start as the visitor's own.
    #[arg(long, value_name = "V.rmap")]
    volume: Option<PathBuf>,
    /// Write each tick's digest to a file, one per line.
    #[arg(long, value_name = "F")]
    digests: Option<PathBuf>,
    /// Write a picture for each half second of the session into a folder. Each picture may take a second.
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Export the sculpture of the last tick as STL.
    #[arg(long, value_name = "F")]
    stl: Option<PathBuf>,
    /// Report how many voxels the session's edits removed, added and were refused.
    ///
    /// Voxels are refused by closure (restored, because a column holds no more gaps), by the mask, or by
    /// depth (inside the brush, but deeper than one edit reaches; each edit counts these voxels again).
    /// Percentages are of all removed and refused voxels together.
    #[arg(long)]
    stats: bool,
    /// Write the statistics as a JSON object instead of lines.
    #[arg(long, requires = "stats")]
    json: bool,
    #[command(flatten)]
    layers: volume::LayersOption,
    #[command(flatten)]
    drawing: DrawingOptions,
}

/// Width and height of a picture.
const FRAME_SIZE: [usize; 2] = [640, 480];

/// Ticks between two pictures.
const FRAME_TICKS: usize = 36;

pub(super) fn run(args: &Args) -> Result<String, Error> {
    for output in [&args.digests, &args.stl].into_iter().flatten() {
        volume::check_output_is_not_input(&args.trace, output)?;
        if let Some(volume) = &args.volume {
            volume::check_output_is_not_input(volume, output)?;
        }
    }
    if let Some(stl) = &args.stl {
        volume::refuse_other_extension(stl, "stl")?;
    }
    let trace = read_trace(&args.trace)?;
    let header = trace.header();
    args.layers.check_intervals_of(&args.trace, header.intervals.into())?;
    let unplayable = || {
        let why = ReplayDivergence::no_world_of_intervals(&header);
        Err(Error::Input(format!("{}: {why}", args.trace.display())))
    };
    with_size!(header.side, N => with_intervals!(
        usize::from(header.intervals),
        K => play_trace::<N, K>(args, &trace),
        else unplayable(),
    ))
}

/// Reads a trace. A volume in its place is reported as such.
pub(super) fn read_trace(path: &Path) -> Result<Trace, Error> {
    if volume::has_volume_header(path) {
        let what = path.display();
        let why = format!("{what}: is a volume, not a trace; `paros render` draws it");
        return Err(Error::Input(why));
    }
    Trace::read(path).map_err(Error::input)
}

fn play_trace<const N: usize, const K: usize>(args: &Args, trace: &Trace) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    let outputs = OutputTargets::check_writable(args)?;
    let mut resident = Grid::<N>::lock_world();
    let filled = match &args.volume {
        Some(path) => {
            read_visitor_volume(&args.layers, path, resident.start_volumes.offer_visitor_volume())?
        }
        None => String::new(),
    };
    let making = show_progress("quarrying", None);
    resident.generate_starts();
    drop(making);
    let WorldWithStarts { start_volumes, world } = &mut *resident;
    let hidden = start_volumes.hidden_figures();
    let mut runner = TickRunner::new(world, start_volumes.start_volumes(&hidden));
    let played = replay_for_outputs(args, trace, &mut runner)?;

    let world = runner.world();
    let mut report = format!(
        "{filled}{}: {} ticks, all as recorded; {} voxels, digest {:016x}\n",
        args.trace.display(),
        trace.records().len(),
        world.volume().count_voxels(),
        world.digest()
    );
    outputs.write_files(&played)?;
    if args.json {
        // Standard error may be closed.
        let _ = write!(io::stderr(), "{filled}");
        let stats = EditStats::new(&played.edits);
        return serde_json::to_string_pretty(&stats).map(|s| s + "\n").map_err(Error::failure);
    }
    if args.stats {
        let _ = write!(report, "{}", played.edits);
    }
    if let (Some(path), Some(stl)) = (&args.stl, &played.stl) {
        let _ = writeln!(report, "{}: {} triangles", path.display(), stl.triangle_count);
    }
    if let Some(folder) = &args.frames {
        let _ = writeln!(report, "{}: {} pictures", folder.display(), played.frames);
    }
    Ok(report)
}

/// Reads the volume for sessions that start from the visitor's own, with as many intervals a column as the
/// trace has. Returns a line that reports the voxels filled for that.
pub(super) fn read_visitor_volume<const N: usize, const K: usize>(
    layers: &volume::LayersOption,
    path: &Path,
    maps: &mut RangeMaps<N, K>,
) -> Result<String, Error>
where
    Grid<N>: Size,
{
    let side = volume::read_header(path)?.grid_side;
    if side != N {
        let path = path.display();
        return Err(Error::Input(format!("{path}: has size {side}, the trace {N}")));
    }
    layers.read_nonempty_volume(path, maps)
}

/// The files to write at the end.
struct OutputTargets {
    digests: Option<WriteTarget>,
    stl: Option<WriteTarget>,
}

impl OutputTargets {
    /// Checks before the work that the files can be written.
    fn check_writable(args: &Args) -> Result<Self, Error> {
        let tried = |path: &Option<PathBuf>| {
            path.as_deref().map(WriteTarget::resolve_and_check_writable).transpose()
        };
        let outputs = OutputTargets { digests: tried(&args.digests)?, stl: tried(&args.stl)? };
        match (&outputs.digests, &outputs.stl) {
            (Some(a), Some(b)) if a.is_same_file(b) => {
                Err(Error::Input(format!("{}: named for two outputs", b.path().display())))
            }
            _ => Ok(outputs),
        }
    }

    fn write_files(self, played: &ReplayResult) -> Result<(), Error> {
        let digests = self.digests.map(|target| (target, played.digests.as_bytes()));
        let stl = self.stl.zip(played.stl.as_ref().map(|stl| &stl.bytes[..]));
        let files: Vec<_> = digests.into_iter().chain(stl).collect();
        Ok(durable::write_files(&files)?)
    }
}

/// The results of a replay, except the world itself.
struct ReplayResult {
    digests: String,
    stl: Option<FinishedStl>,
    frames: usize,
    edits: EditTotals,
}

/// Statistics of the edits, for JSON. Percentages are of all removed and refused voxels together.
#[derive(Debug, Serialize)]
struct EditStats {
    edits: u64,
    removed: VoxelShare,
    added: u64,
    refused_by_closure: VoxelShare,
    refused_by_mask: VoxelShare,
    refused_by_depth: VoxelShare,
}

#[derive(Debug, Serialize)]
struct VoxelShare {
    voxels: u64,
    percent: f64,
}

impl EditStats {
    fn new(totals: &EditTotals) -> Self {
        let share = |voxels| VoxelShare { voxels, percent: totals.percent_of_whole(voxels) };
        EditStats {
            edits: totals.edits,
            removed: share(totals.removed),
            added: totals.added,
            refused_by_closure: share(totals.refused_by_closure),
            refused_by_mask: share(totals.refused_by_mask),
            refused_by_depth: share(totals.refused_by_depth),
        }
    }
}

fn replay_for_outputs<const N: usize, const K: usize>(
    args: &Args,
    trace: &Trace,
    runner: &mut TickRunner<'_, N, K>,
) -> Result<ReplayResult, Error>
where
    Grid<N>: Size + Resident<N, K>,
{
    let bar = show_progress("playing", Some(trace.records().len() as u64));
    let mut played =
        ReplayResult { digests: String::new(), stl: None, frames: 0, edits: EditTotals::default() };
    let mut drawn = Ok(());
    let mut frames = match args.frames.as_deref() {
        Some(folder) => Some((
            folder,
            args.drawing.make_renderer::<N, K>(FRAME_SIZE, 1, DrawingBackground::Backdrop)?,
        )),
        None => None,
    };
    let mut stl_buffers = Grid::<N>::lock_stl_buffers();
    let mut stl_exporter = StlExporter::of_default_height(&mut stl_buffers);
    runner
        .replay_on_same_start(trace, |ReplayedTick { index: tick, world }| {
            let _ = writeln!(played.digests, "{:016x}", world.digest());
            played.edits.add_tick(world);
            if args.stl.is_some()
                && let Some(stl) = stl_exporter.begin_if_finished_or_advance(world)
            {
                played.stl = Some(stl);
            }
            if tick % 64 == 0 {
                bar.set_steps_done(tick as u64);
            }
            if let Some((folder, renderer)) = &mut frames
                && tick % FRAME_TICKS == 0
                && drawn.is_ok()
            {
                drawn = write_picture(renderer, folder, tick / FRAME_TICKS, world);
                played.frames += 1;
            }
        })
        .map_err(|diverged| Error::Input(format!("{}: {diverged}", args.trace.display())))?;
    drawn?;
    if args.stl.is_some() {
        let last = stl_of_last_tick(&mut stl_exporter, played.stl.take(), runner.world());
        played.stl = Some(volume::require_nonempty_stl(last, &args.trace)?);
    }
    Ok(played)
}

/// Returns the STL file of the last tick's sculpture. Uses the export of a finished session, complete or in
/// progress; else starts an export.
fn stl_of_last_tick<const N: usize, const K: usize>(
    stl_exporter: &mut StlExporter<'_, N, K>,
    finished_earlier: Option<FinishedStl>,
    world: &World<N, K>,
) -> Option<FinishedStl>
where
    Grid<N>: Size,
{
    if world.session_state() != SessionState::Finished {
        stl_exporter.begin_export(world.volume().rows(), world.mask());
    }
    stl_exporter.run_export_to_end().or(finished_earlier)
}

/// Draws a picture of a replay to `{number:06}.png`. The folder is created with the first picture, once the
/// trace is known to match.
fn write_picture<const N: usize, const K: usize>(
    renderer: &mut PictureRenderer<N, K>,
    folder: &Path,
    number: usize,
    world: &World<N, K>,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    let image =
        renderer.draw_volume(world.volume().maps(), &Camera::orbiting(0.45, 0.3), &|_| {})?;
    durable::make_folder(folder)?;
    let mut png = Vec::new();
    image.write_png(&mut png).map_err(Error::failure)?;
    durable::write_file(&folder.join(format!("{number:06}.png")), &png)?;
    Ok(())
}
