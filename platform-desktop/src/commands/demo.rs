//! `paros demo`: a scripted session, from the lump to a print.

use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use paros_core::events::Event;
use paros_core::size::{Grid, Size};
use paros_core::world::World;
use paros_shaders::{Camera, Image, RenderOptions, contact_sheet, render};
use paros_shell::durable::Target;
use paros_shell::figures::Figure;
use paros_shell::print::{HEIGHT_MM, Print, Printer};
use paros_shell::stage::Stage;
use paros_shell::statics::Resident;
use paros_shell::{durable, rmap};

use super::progress;
use crate::demo::{self, Chapter};
use crate::error::Error;

/// Voxels along an edge.
const N: usize = 128;

/// Which of the hidden figures comes to light.
const FIGURE: u8 = 0;

/// What it leaves.
const FILES: [&str; 5] =
    ["session.trace", "sculpture.rmap", "sculpture.stl", "contact-sheet.png", "report.txt"];

/// Play a scripted sculptor's session and leave its trace, sculpture, print and pictures.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The folder for the files.
    #[arg(short, long, value_name = "DIR", default_value = "paros-demo")]
    output: PathBuf,
}

impl Default for Args {
    fn default() -> Self {
        Args { output: "paros-demo".into() }
    }
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    let folder = &args.output;
    durable::make_folder(folder)?;
    // Tried before the work, and written together after it.
    let tried = FILES.iter().map(|name| Target::tried(&folder.join(name)));
    let targets = tried.collect::<Result<Vec<_>, _>>()?;
    let session = sculpt()?;
    let mut png = Vec::new();
    contact_sheet(&session.pictures, 3).write_png(&mut png).map_err(Error::failure)?;
    let world = Grid::<N>::world();
    let maps = rmap::encode(world.volume().maps());
    let mut report = session.report(world.volume().count());
    let bytes = [&session.trace, &maps, &session.print.stl, &png, report.as_bytes()];
    durable::write_all(&targets.into_iter().zip(bytes).collect::<Vec<_>>())?;
    let _ = writeln!(report, "{}: {}", folder.display(), FILES.join(", "));
    Ok(report)
}

/// What came of the session, but for the world itself.
struct Session {
    trace: Vec<u8>,
    print: Print,
    pictures: Vec<Image>,
    tally: Tally,
    chapters: Vec<(Chapter, u64, u64)>,
    digest: u64,
    spent: Duration,
}

/// Counts over all ticks.
#[derive(Default)]
struct Tally {
    edits: u64,
    removed: u64,
    added: u64,
    refused_by_mask: u64,
    island_voxels: u64,
    largest_island: u32,
    undone: u32,
}

impl Tally {
    fn count<const N: usize>(&mut self, world: &World<N>)
    where
        Grid<N>: Size,
    {
        for event in world.events() {
            match event {
                Event::Edited { report, .. } => {
                    self.edits += 1;
                    self.removed += u64::from(report.removed);
                    self.added += u64::from(report.added + report.closed);
                    self.refused_by_mask += u64::from(report.refused_by_mask);
                }
                Event::Islands(report) => {
                    self.island_voxels += u64::from(report.removed);
                    self.largest_island = self.largest_island.max(report.removed);
                }
                Event::Undone => self.undone += 1,
                _ => {}
            }
        }
    }
}

impl Session {
    fn report(&self, voxels: u64) -> String {
        let t = &self.tally;
        let ticks = self.chapters.last().map_or(0, |chapter| chapter.1);
        let mut lines = String::new();
        let _ = writeln!(
            lines,
            "the {} from the stone: {ticks} ticks ({} s of sculpting), stepped in {:.2} s",
            Figure::HIDDEN[usize::from(FIGURE)].name(),
            ticks / u64::from(paros_core::input::TICK_RATE),
            self.spent.as_secs_f32(),
        );
        for (chapter, tick, voxels) in &self.chapters {
            let _ = writeln!(lines, "  tick {tick:>6}  {voxels:>8} voxels  {}", chapter.words());
        }
        let _ = writeln!(
            lines,
            "{} bites removed {} voxels and added {}; the mask held {} back",
            t.edits, t.removed, t.added, t.refused_by_mask
        );
        let _ = writeln!(
            lines,
            "islands: {} voxels fell, at most {} at once; {} stroke undone",
            t.island_voxels, t.largest_island, t.undone
        );
        let _ = writeln!(lines, "{voxels} voxels remain; digest {:016x}", self.digest);
        let _ = writeln!(lines, "print: {} triangles, {HEIGHT_MM} mm high", self.print.triangles);
        lines
    }
}

fn sculpt() -> Result<Session, Error> {
    let making = progress::bar("quarrying", None);
    let mut starts = Grid::<N>::start_volumes();
    starts.make(&mut Grid::<N>::plane(), |_| {});
    drop(making);
    let hidden = starts.hidden();
    let mut world = Grid::<N>::world();
    let mut stage = Stage::new(&mut world, starts.starts(&hidden));
    stage.record();
    let mut press = Grid::<N>::press();
    let (mut printer, mut print) = (Printer::new(&mut press, HEIGHT_MM)?, None);

    let bar = progress::bar("sculpting", Some(Chapter::ALL.len() as u64));
    let (mut tally, mut pictures, mut chapters) = (Tally::default(), Vec::new(), Vec::new());
    let mut drawing = Duration::ZERO;
    let begun = Instant::now();
    demo::play(
        &mut stage,
        FIGURE,
        &mut |world| {
            tally.count(world);
            print = printer.tick(world).or(print.take());
            ControlFlow::Continue(())
        },
        |chapter, world| {
            let drawn = Instant::now();
            chapters.push((chapter, world.tick(), world.volume().count()));
            let options = RenderOptions { width: 480, height: 480, ..RenderOptions::default() };
            let camera = Camera::ring(0.45, 0.3);
            pictures.push(render(world.volume().maps(), &camera, &options, &|_| {}));
            bar.advance_to(chapters.len() as u64);
            drawing += drawn.elapsed();
        },
    );
    let spent = begun.elapsed() - drawing;
    let trace = stage.end_recording().unwrap_or_default();
    // No more ticks come for it to go on with.
    let print = printer.complete().or(print);
    let print = print.ok_or_else(|| Error::Failure("the demo was not finished".into()))?;
    let digest = stage.world().digest();
    Ok(Session { trace, print, pictures, tally, chapters, digest, spent })
}
