//! `paros play`: a recorded session is stepped again, and must lead to the same digests.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use paros_core::size::{Grid, Size};
use paros_core::world::{Session, World};
use paros_shaders::Camera;
use paros_shell::durable::{self, Target};
use paros_shell::print::{HEIGHT_MM, Print, Printer};
use paros_shell::stage::Stage;
use paros_shell::statics::Resident;
use paros_shell::trace::Trace;

use super::drawing::{Drawing, Painter};
use super::{progress, volume};
use crate::error::Error;

/// Play a trace; stop at the first tick that differs from the recording.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The trace.
    trace: PathBuf,
    /// The volume that the trace's sessions start from as the visitor's own.
    #[arg(long, value_name = "V.rmap")]
    volume: Option<PathBuf>,
    /// Write every tick's digest to a file, one a line.
    #[arg(long, value_name = "F")]
    digests: Option<PathBuf>,
    /// Write a picture every half second of the session into a folder; each may take a second.
    #[arg(long, value_name = "DIR")]
    frames: Option<PathBuf>,
    /// Export the sculpture of the last tick.
    #[arg(long, value_name = "F")]
    stl: Option<PathBuf>,
    #[command(flatten)]
    drawing: Drawing,
}

/// Width and height of a picture.
const FRAME_SIZE: [usize; 2] = [640, 480];

/// Ticks from one picture to the next.
const FRAME_TICKS: usize = 36;

pub(super) fn run(args: &Args) -> Result<String, Error> {
    for output in [&args.digests, &args.stl].into_iter().flatten() {
        volume::check_distinct(&args.trace, output)?;
        if let Some(volume) = &args.volume {
            volume::check_distinct(volume, output)?;
        }
    }
    if let Some(stl) = &args.stl {
        volume::check_ending(stl, "stl")?;
    }
    if volume::is_one(&args.trace) {
        let what = args.trace.display();
        let why = format!("{what}: is a volume, not a trace; `paros render` draws it");
        return Err(Error::Input(why));
    }
    let trace = Trace::read(&args.trace).map_err(Error::input)?;
    match trace.header().size {
        256 => play::<256>(args, &trace),
        _ => play::<128>(args, &trace),
    }
}

fn play<const N: usize>(args: &Args, trace: &Trace) -> Result<String, Error>
where
    Grid<N>: Size + Resident<N>,
{
    let outputs = Outputs::tried(args)?;
    let mut starts = Grid::<N>::start_volumes();
    if let Some(path) = &args.volume {
        match volume::size(path)? {
            n if n == N => volume::read(path, starts.own_mut())?,
            n => {
                let path = path.display();
                return Err(Error::Input(format!("{path}: has size {n}, the trace {N}")));
            }
        }
    }
    let making = progress::bar("quarrying", None);
    starts.make(&mut Grid::<N>::plane(), |_| {});
    drop(making);
    let (hidden, mut world) = (starts.hidden(), Grid::<N>::world());
    let mut stage = Stage::new(&mut world, starts.starts(&hidden));
    let played = replay(args, trace, &mut stage)?;

    let world = stage.world();
    let mut report = format!(
        "{}: {} ticks, all as recorded; {} voxels, digest {:016x}\n",
        args.trace.display(),
        trace.records().len(),
        world.volume().count(),
        world.digest()
    );
    outputs.write(&played)?;
    if let (Some(path), Some(print)) = (&args.stl, &played.print) {
        let _ = writeln!(report, "{}: {} triangles", path.display(), print.triangles);
    }
    if let Some(folder) = &args.frames {
        let _ = writeln!(report, "{}: {} pictures", folder.display(), played.frames);
    }
    Ok(report)
}

/// Where the files go that are written at the end.
struct Outputs {
    digests: Option<Target>,
    stl: Option<Target>,
}

impl Outputs {
    /// Tried before the work: a place where no file can be is told at once.
    fn tried(args: &Args) -> Result<Self, Error> {
        let tried = |path: &Option<PathBuf>| path.as_deref().map(Target::tried).transpose();
        let outputs = Outputs { digests: tried(&args.digests)?, stl: tried(&args.stl)? };
        match (&outputs.digests, &outputs.stl) {
            (Some(a), Some(b)) if a.is_same_file(b) => {
                Err(Error::Input(format!("{}: named for two outputs", b.path().display())))
            }
            _ => Ok(outputs),
        }
    }

    fn write(self, played: &Played) -> Result<(), Error> {
        let digests = self.digests.map(|target| (target, played.digests.as_bytes()));
        let print = self.stl.zip(played.print.as_ref().map(|print| &print.stl[..]));
        let files: Vec<_> = digests.into_iter().chain(print).collect();
        Ok(durable::write_all(&files)?)
    }
}

/// What a replay leaves besides the world.
struct Played {
    digests: String,
    print: Option<Print>,
    frames: usize,
}

fn replay<const N: usize>(
    args: &Args,
    trace: &Trace,
    stage: &mut Stage<'_, N>,
) -> Result<Played, Error>
where
    Grid<N>: Size + Resident<N>,
{
    let bar = progress::bar("playing", Some(trace.records().len() as u64));
    let mut played = Played { digests: String::new(), print: None, frames: 0 };
    let mut drawn = Ok(());
    let mut frames = match args.frames.as_deref() {
        Some(folder) => Some((folder, args.drawing.painter::<N>(FRAME_SIZE, 1)?)),
        None => None,
    };
    let mut press = Grid::<N>::press();
    let mut printer = Printer::new(&mut press, HEIGHT_MM)?;
    stage
        .replay(trace, |tick, world| {
            let _ = writeln!(played.digests, "{:016x}", world.digest());
            if args.stl.is_some()
                && let Some(print) = printer.tick(world)
            {
                played.print = Some(print);
            }
            if tick % 64 == 0 {
                bar.advance_to(tick as u64);
            }
            if let Some((folder, painter)) = &mut frames
                && tick % FRAME_TICKS == 0
                && drawn.is_ok()
            {
                drawn = draw(painter, folder, tick / FRAME_TICKS, world);
                played.frames += 1;
            }
        })
        .map_err(|diverged| Error::Input(format!("{}: {diverged}", args.trace.display())))?;
    drawn?;
    if args.stl.is_some() {
        let last = last_print(&mut printer, played.print.take(), stage.world());
        played.print = Some(volume::printed(last, &args.trace)?);
    }
    Ok(played)
}

/// The print of the last tick's sculpture: the one under way or made, if its session is the one that
/// was finished last.
fn last_print<const N: usize>(
    printer: &mut Printer<'_, N>,
    made: Option<Print>,
    world: &World<N>,
) -> Option<Print>
where
    Grid<N>: Size,
{
    if world.session() != Session::Finished {
        printer.begin(world.volume().rows(), world.mask());
    }
    printer.complete().or(made)
}

/// Draws one picture of a replay. The folder is made with the first, once the trace was found to fit.
fn draw<const N: usize>(
    painter: &mut Painter<N>,
    folder: &Path,
    frame: usize,
    world: &World<N>,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    let image = painter.paint(world.volume().maps(), &Camera::ring(0.45, 0.3), &|_| {})?;
    durable::make_folder(folder)?;
    let mut png = Vec::new();
    image.write_png(&mut png).map_err(Error::failure)?;
    durable::write(&folder.join(format!("{frame:06}.png")), &png)?;
    Ok(())
}
