//! `paros demo`: a scripted session, from the lump to a print.

use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::ValueEnum;
use paros_core::limits::INTERVALS;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{World, WorldEvent};
use paros_headless::{Error, show_progress};
use paros_shaders::{Camera, Image, RenderOptions, contact_sheet, render_image};
use paros_shell::demo::{self, Chapter, DemoScript};
use paros_shell::durable::WriteTarget;
use paros_shell::edit_totals::EditTotals;
use paros_shell::roughness::{Roughness, measure_roughness};
use paros_shell::statics::{Resident, WorldWithStarts};
use paros_shell::stl_export::{DEFAULT_HEIGHT_MM, FinishedStl, StlExporter};
use paros_shell::tick_runner::TickRunner;
use paros_shell::{durable, rmap, with_intervals};

use super::volume;

/// The files that the command writes.
const FILES: [&str; 5] =
    ["session.trace", "sculpture.rmap", "sculpture.stl", "contact-sheet.png", "report.txt"];

/// Play a scripted session, and write its trace, sculpture, STL file, pictures and report.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Session to play: an owl hidden in the stone, or a lantern.
    #[arg(value_enum, default_value = "owl")]
    script: ScriptChoice,
    /// Folder for the files.
    #[arg(short, long, value_name = "DIR", default_value = "paros-demo")]
    output: PathBuf,
    /// Intervals per column. With 1, a column holds no gaps, so that more of each cut is restored.
    #[arg(long, value_name = "K", default_value = "2", value_parser = volume::interval_count_parser())]
    layers: usize,
}

impl Default for Args {
    fn default() -> Self {
        Args { script: ScriptChoice::Owl, output: "paros-demo".into(), layers: INTERVALS }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ScriptChoice {
    Owl,
    Lantern,
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    let folder = &args.output;
    durable::make_folder(folder)?;
    // Check the targets before the work; they are written together after it.
    let tried =
        FILES.iter().map(|name| WriteTarget::resolve_and_check_writable(&folder.join(name)));
    let targets = tried.collect::<Result<Vec<_>, _>>()?;
    let (files, mut report) = with_intervals!(args.layers, K => match args.script {
        ScriptChoice::Owl => play_and_encode::<256, K>(DemoScript::Owl),
        // The lantern's slots are as wide as a bit, so that larger voxels show all of their detail.
        ScriptChoice::Lantern => play_and_encode::<128, K>(DemoScript::Lantern),
    })?;
    let targets_and_bytes = targets.into_iter().zip(files.iter().map(|bytes| &bytes[..]));
    durable::write_files(&targets_and_bytes.collect::<Vec<_>>())?;
    let _ = writeln!(report, "{}: {}", folder.display(), FILES.join(", "));
    Ok(report)
}

/// Returns the contents of [`FILES`] and the report, which is also the last of the files.
fn play_and_encode<const N: usize, const K: usize>(
    script: DemoScript,
) -> Result<([Vec<u8>; FILES.len()], String), Error>
where
    Grid<N>: Resident<N, K>,
{
    let session = play_session::<N, K>(script)?;
    let mut png = Vec::new();
    contact_sheet(&session.pictures, 3).write_png(&mut png).map_err(Error::failure)?;
    let world = &<Grid<N> as Resident<N, K>>::lock_world().world;
    let maps = rmap::encode(world.volume().maps());
    let report = session.format_report(world.volume().count_voxels());
    let DemoResult { trace, stl, .. } = session;
    Ok(([trace, maps, stl.bytes, png, report.clone().into_bytes()], report))
}

/// The session's results, except the world itself.
struct DemoResult {
    script: DemoScript,
    trace: Vec<u8>,
    stl: FinishedStl,
    pictures: Vec<Image>,
    edits: EditTotals,
    islands: IslandCounts,
    rasped: Option<Roughness>,
    chapters: Vec<(Chapter, u64, u64)>,
    digest: u64,
    spent: Duration,
}

/// The effect of the rasp on the stone.
struct RaspWork<const N: usize>
where
    Grid<N>: Size,
{
    before: Option<Box<BitGrid<N>>>,
    roughness: Option<Roughness>,
}

impl<const N: usize> RaspWork<N>
where
    Grid<N>: Size,
{
    /// Notes the stone at the end of a chapter.
    fn note_chapter(&mut self, chapter: Chapter, stone: &BitGrid<N>) {
        match chapter {
            Chapter::Cord => self.before = Some(Box::new(stone.clone())),
            Chapter::Finished => {
                let before = self.before.take();
                self.roughness = before.and_then(|before| measure_roughness(&before, stone));
            }
            _ => {}
        }
    }
}

/// Totals of removed islands and of undone strokes, over all ticks.
#[derive(Default)]
struct IslandCounts {
    voxels: u64,
    largest: u32,
    undone: u32,
}

impl IslandCounts {
    fn count_events<const N: usize, const K: usize>(&mut self, world: &World<N, K>)
    where
        Grid<N>: Size,
    {
        for event in world.events() {
            match event {
                WorldEvent::Islands(report) => {
                    self.voxels += u64::from(report.removed);
                    self.largest = self.largest.max(report.removed);
                }
                WorldEvent::Undone => self.undone += 1,
                _ => {}
            }
        }
    }
}

impl DemoResult {
    fn format_report(&self, remaining_voxels: u64) -> String {
        let ticks = self.chapters.last().map_or(0, |chapter| chapter.1);
        let mut lines = String::new();
        let _ = writeln!(
            lines,
            "the {} from the stone: {ticks} ticks ({} s of sculpting), stepped in {:.2} s",
            self.script.name(),
            ticks / u64::from(paros_core::session::TICK_RATE),
            self.spent.as_secs_f32(),
        );
        for (chapter, tick, voxels) in &self.chapters {
            let _ = writeln!(
                lines,
                "  tick {tick:>6}  {voxels:>8} voxels  {}",
                chapter.completion_announcement()
            );
        }
        if let Some(Roughness { before_mm, after_mm }) = self.rasped {
            let _ = writeln!(
                lines,
                "rasped: the height varies by {before_mm:.2} mm before and {after_mm:.2} mm after, \
                 root mean square within 10 mm"
            );
        }
        let _ = writeln!(
            lines,
            "{} edits; voxels, and percent of what they removed or were refused:",
            self.edits.edits
        );
        for line in self.edits.to_string().lines() {
            let _ = writeln!(lines, "  {line}");
        }
        let _ = writeln!(
            lines,
            "islands: {} voxels fell, at most {} at once; {} stroke undone",
            self.islands.voxels, self.islands.largest, self.islands.undone
        );
        let _ = writeln!(lines, "{remaining_voxels} voxels remain; digest {:016x}", self.digest);
        let _ = writeln!(
            lines,
            "print: {} triangles, {DEFAULT_HEIGHT_MM} mm high",
            self.stl.triangle_count
        );
        lines
    }
}

fn play_session<const N: usize, const K: usize>(script: DemoScript) -> Result<DemoResult, Error>
where
    Grid<N>: Resident<N, K>,
{
    let making = show_progress("quarrying", None);
    let mut resident = Grid::<N>::lock_world();
    resident.generate_starts();
    drop(making);
    let WorldWithStarts { start_volumes, world } = &mut *resident;
    let hidden = start_volumes.hidden_figures();
    let mut runner = TickRunner::new(world, start_volumes.start_volumes(&hidden));
    runner.start_recording();
    let mut stl_buffers = Grid::<N>::lock_stl_buffers();
    let (mut stl_exporter, mut stl) = (StlExporter::of_default_height(&mut stl_buffers), None);

    let bar = show_progress("sculpting", Some(script.chapters().len() as u64));
    let (mut edits, mut islands) = (EditTotals::default(), IslandCounts::default());
    let mut rasp = RaspWork::<N> { before: None, roughness: None };
    let (mut pictures, mut chapters) = (Vec::new(), Vec::new());
    let mut drawing = Duration::ZERO;
    let begun = Instant::now();
    demo::play_demo(
        script,
        &mut runner,
        &mut |world| {
            edits.add_tick(world);
            islands.count_events(world);
            stl = stl_exporter.begin_if_finished_or_advance(world).or(stl.take());
            ControlFlow::Continue(())
        },
        |chapter, world| {
            let drawn = Instant::now();
            chapters.push((chapter, world.tick(), world.volume().count_voxels()));
            rasp.note_chapter(chapter, world.volume().rows());
            let options = RenderOptions { width: 480, height: 480, ..RenderOptions::default() };
            let camera = Camera::orbiting(0.45, 0.3);
            pictures.push(render_image(world.volume().maps(), &camera, &options, &|_| {}));
            bar.set_steps_done(chapters.len() as u64);
            drawing += drawn.elapsed();
        },
    );
    let spent = begun.elapsed() - drawing;
    let trace = runner.end_recording_to_bytes().unwrap_or_default();
    // No more ticks follow: run the export to its end now.
    let stl = stl_exporter.run_export_to_end().or(stl);
    let stl = stl.ok_or_else(|| Error::Failure("the demo was not finished".into()))?;
    let digest = runner.world().digest();
    let rasped = rasp.roughness;
    Ok(DemoResult { script, trace, stl, pictures, edits, islands, rasped, chapters, digest, spent })
}
