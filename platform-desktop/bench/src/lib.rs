//! Benchmarks: this code and its rivals on the same volumes, in alternating runs of one process.
//!
//! [`Plan::run`] measures a [`Plan`] and returns a [`Report`] of rows. The only command-line option that this
//! library depends on is `--replay`: with it the program restarts itself under Callgrind. The library needs
//! neither window nor headset.
#![forbid(unsafe_code)]

mod bake;
mod callgrind;
mod clock;
pub mod dense;
mod edit;
mod edit_frame;
mod feel;
mod field;
mod filled;
mod fixture;
mod frames;
mod framing;
mod islands;
mod layer_costs;
mod layers;
mod mesh;
mod order;
pub mod paper;
mod peers;
mod render;
mod row;
mod section5;
mod step;
mod subject;
mod visit_scene;

use std::path::{Path, PathBuf};

use paros_headless::Error;
use paros_shell::sizes::GRID_SIDES;
use paros_shell::with_size;

pub use row::{ReportRow, format_table};
pub use subject::BenchSubject;

use frames::FrameTimer;
use peers::{MissingPeer, PythonPeers};
use row::Measured;

/// A benchmark of one part of the program.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Benchmark {
    /// The search for islands.
    Islands,
    /// Carving and filling.
    Edit,
    /// Two intervals a column against one: the share of cuts that closure refuses, and the costs.
    Layers,
    /// Export to STL.
    Mesh,
    /// Conversion of triangles to a volume.
    Bake,
    /// The part of a slow groove that a quick hand cuts, and the material removed in a second.
    Feel,
    /// Sizes in memory, and instructions of a tick in recorded sessions.
    Step,
    /// The cost of keeping the fast path's textures up to date in a frame.
    Field,
    /// The sculpture's pass on a Vulkan device, by both render paths.
    Render,
    /// The experiments of the paper's section 5.
    Paper,
}

impl Benchmark {
    /// All benchmarks, in the order in which `all` runs them.
    pub const ALL: [Benchmark; 10] = [
        Benchmark::Islands,
        Benchmark::Edit,
        Benchmark::Layers,
        Benchmark::Mesh,
        Benchmark::Bake,
        Benchmark::Feel,
        Benchmark::Step,
        Benchmark::Field,
        Benchmark::Render,
        Benchmark::Paper,
    ];

    /// Returns the benchmark's name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Benchmark::Islands => "islands",
            Benchmark::Edit => "edit",
            Benchmark::Layers => "layers",
            Benchmark::Mesh => "mesh",
            Benchmark::Bake => "bake",
            Benchmark::Feel => "feel",
            Benchmark::Step => "step",
            Benchmark::Field => "field",
            Benchmark::Render => "render",
            Benchmark::Paper => "paper",
        }
    }

    /// Returns the benchmark with a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|bench| bench.name() == name)
    }
}

/// A measuring plan: benchmarks, their inputs, and the number of runs.
#[derive(Debug)]
pub struct Plan {
    /// The benches, in order.
    pub benches: Vec<Benchmark>,
    /// Inputs of all benchmarks except [`Benchmark::Feel`] and [`Benchmark::Step`].
    pub subjects: Vec<BenchSubject>,
    /// Sessions that [`Benchmark::Step`] and [`Benchmark::Layers`] play. If empty, the former plays the demo
    /// at both sizes.
    pub traces: Vec<PathBuf>,
    /// Runs of each side; the best counts.
    pub runs: usize,
    /// Runs of each frame; the best counts.
    pub frame_runs: usize,
    /// Width and height of a frame in pixels.
    pub canvas: [u32; 2],
    /// A part of the name of the Vulkan device to use; `None` for the best device.
    pub device: Option<String>,
    /// The Python interpreter that has the rivals' packages.
    pub python: PathBuf,
}

/// The results of a plan, and the reasons for missing results.
#[derive(Debug, Default)]
pub struct Report {
    /// The rows, in the order of the plan.
    pub rows: Vec<ReportRow>,
    /// Reasons for missing values, each once.
    pub skipped: Vec<String>,
    /// Notes on changes made to the subjects before measuring.
    pub notes: Vec<String>,
}

/// A unit of work of a plan: a benchmark on one input.
#[derive(Clone, Copy)]
enum PlanPiece<'a> {
    On(Benchmark, &'a BenchSubject, usize),
    Scaling(&'a BenchSubject),
    LayerCuts,
    LayerSizes,
    LayerCosts(&'a BenchSubject, usize),
    LayerFrames(&'a BenchSubject),
    LayerSession(&'a Path),
    Render(&'a BenchSubject),
    Paper(&'a BenchSubject),
    Feel(usize),
    Sizes,
    Demo(usize),
    Recorded(&'a Path),
}

/// A callback that gets the fraction of a piece that is done, 0 to 1.
type OnProgress<'a> = &'a dyn Fn(f64);

/// The reason why a plan that continues without a device times no frames.
struct NoFrameTimer(String);

/// External resources that the pieces of a plan share, or why they are not available.
struct BenchResources {
    peers: Result<PythonPeers, MissingPeer>,
    timer: Result<FrameTimer, NoFrameTimer>,
}

impl Plan {
    /// Returns the number of pieces, for a progress bar.
    #[must_use]
    pub fn piece_count(&self) -> usize {
        self.split_pieces().len()
    }

    /// Runs the measurements. `on_pieces_done` gets the number of finished pieces, plus the fraction of the
    /// present one.
    ///
    /// # Errors
    /// A subject is empty, two sides have different results, or there is no device although only frames are
    /// to be measured.
    pub fn run(&self, on_pieces_done: impl Fn(f64)) -> Result<Report, Error> {
        let notes = self.subjects.iter().map(BenchSubject::describe_closing_to_one);
        let notes = notes.filter_map(Result::transpose).collect::<Result<_, _>>()?;
        let mut report = Report { notes, ..Report::default() };
        let mut resources =
            BenchResources { peers: self.start_peers(), timer: self.open_frame_timer()? };
        for (i, piece) in self.split_pieces().into_iter().enumerate() {
            let on_progress = |part: f64| on_pieces_done(i as f64 + part);
            on_progress(0.0);
            let Measured { rows, skipped } = self.run_piece(piece, &mut resources, &on_progress)?;
            report.rows.extend(rows);
            report.skipped.extend(skipped.filter(|why| !report.skipped.contains(why)));
        }
        let means = render::geometric_means(&report.rows);
        report.rows.extend(means);
        Ok(report)
    }

    fn includes_any(&self, some: &[Benchmark]) -> bool {
        self.benches.iter().any(|bench| some.contains(bench))
    }

    fn start_peers(&self) -> Result<PythonPeers, MissingPeer> {
        match self.includes_any(&[Benchmark::Mesh, Benchmark::Bake]) {
            true => PythonPeers::start_python(&self.python),
            false => Err(MissingPeer::not_started()),
        }
    }

    /// Opens the device that draws frames, or returns the reason why there is none.
    fn open_frame_timer(&self) -> Result<Result<FrameTimer, NoFrameTimer>, Error> {
        if !self.includes_any(&[Benchmark::Layers, Benchmark::Render, Benchmark::Paper]) {
            return Ok(Err(NoFrameTimer(String::new())));
        }
        let timer = FrameTimer::open_device(self.device.as_deref(), self.canvas);
        if self.benches == [Benchmark::Render] {
            return timer.map(Ok);
        }
        // Frames in software would take hours, with meaningless results.
        let slow = |timer: &FrameTimer| timer.is_software() && self.device.is_none();
        Ok(match timer {
            Ok(timer) if slow(&timer) => {
                let name = timer.device_name();
                Err(NoFrameTimer(format!("{name} is no GPU; `--device` may name it")))
            }
            timer => timer.map_err(|error| NoFrameTimer(error.to_string())),
        })
    }

    fn split_pieces(&self) -> Vec<PlanPiece<'_>> {
        let mut pieces = vec![];
        for &bench in &self.benches {
            match bench {
                Benchmark::Feel => pieces.extend(GRID_SIDES.map(PlanPiece::Feel)),
                Benchmark::Step => pieces.extend(self.step_pieces()),
                Benchmark::Layers => pieces.extend(self.layer_pieces()),
                Benchmark::Render => pieces.extend(self.subjects.iter().map(PlanPiece::Render)),
                Benchmark::Paper => pieces.extend(self.subjects.iter().map(PlanPiece::Paper)),
                _ => pieces.extend(
                    self.subjects.iter().flat_map(|subject| pieces_by_grid_side(bench, subject)),
                ),
            }
        }
        pieces
    }

    fn step_pieces(&self) -> impl Iterator<Item = PlanPiece<'_>> {
        let demo = GRID_SIDES.map(PlanPiece::Demo).into_iter().filter(|_| self.traces.is_empty());
        let recorded = self.traces.iter().map(|path| PlanPiece::Recorded(path));
        [PlanPiece::Sizes].into_iter().chain(demo).chain(recorded)
    }

    fn layer_pieces(&self) -> impl Iterator<Item = PlanPiece<'_>> {
        let costs = self.subjects.iter().flat_map(|subject| {
            subject.grid_sides().iter().map(move |&side| PlanPiece::LayerCosts(subject, side))
        });
        let frames = self.subjects.iter().map(PlanPiece::LayerFrames);
        let sessions = self.traces.iter().map(|path| PlanPiece::LayerSession(path));
        let cuts = [PlanPiece::LayerCuts, PlanPiece::LayerSizes];
        cuts.into_iter().chain(costs).chain(frames).chain(sessions)
    }

    fn run_piece(
        &self,
        piece: PlanPiece<'_>,
        resources: &mut BenchResources,
        on_progress: OnProgress<'_>,
    ) -> Result<Measured, Error> {
        let (runs, peers) = (self.runs, &mut resources.peers);
        let timer = resources.timer.as_mut().map_err(|NoFrameTimer(why)| why.as_str());
        let whole = |rows: Vec<ReportRow>| Measured { rows, skipped: None };
        match piece {
            PlanPiece::On(Benchmark::Islands, on, size) => {
                with_size!(size, N => islands::measure_rows::<N>(on, runs)).map(whole)
            }
            PlanPiece::On(Benchmark::Edit, on, size) => {
                with_size!(size, N => edit::measure_rows::<N>(on, runs)).map(whole)
            }
            PlanPiece::On(Benchmark::Mesh, on, size) => {
                with_size!(size, N => mesh::measure_rows::<N>(on, runs, peers))
            }
            PlanPiece::On(Benchmark::Bake, on, size) => {
                with_size!(size, N => bake::measure_rows::<N>(on, runs, peers))
            }
            PlanPiece::On(Benchmark::Field, on, size) => {
                with_size!(size, N => field::measure_rows::<N>(on))
            }
            PlanPiece::Scaling(on) => edit::measure_scaling(on, runs).map(whole),
            PlanPiece::LayerCuts | PlanPiece::On(Benchmark::Layers, ..) => {
                Ok(whole(layers::measure_cuts()))
            }
            PlanPiece::LayerSizes => Ok(whole(layer_costs::size_rows())),
            PlanPiece::LayerCosts(on, size) => {
                with_size!(size, N => layer_costs::measure_rows::<N>(on, runs)).map(whole)
            }
            PlanPiece::LayerFrames(on) => measure_if_drawn(timer, |timer| {
                layer_costs::measure_frames(on, self.frame_runs, timer)
            }),
            PlanPiece::LayerSession(path) => layers::measure_refusals_of_session(path).map(whole),
            PlanPiece::Render(on) | PlanPiece::On(Benchmark::Render, on, _) => {
                measure_if_drawn(timer, |timer| render::measure_rows(on, self.frame_runs, timer))
            }
            PlanPiece::Paper(on) | PlanPiece::On(Benchmark::Paper, on, _) => {
                section5::measure_rows(on, self.frame_runs, timer)
            }
            PlanPiece::Feel(size) | PlanPiece::On(Benchmark::Feel, _, size) => {
                Ok(whole(with_size!(size, N => feel::measure_rows::<N>())))
            }
            PlanPiece::Sizes | PlanPiece::On(Benchmark::Step, ..) => {
                Ok(whole(step::type_size_rows()))
            }
            PlanPiece::Demo(size) => with_size!(size, N => step::measure_demo::<N>(on_progress)),
            PlanPiece::Recorded(path) => step::measure_recorded(path, on_progress),
        }
    }
}

/// Measures rows that need frames, or returns the reason why there are none.
fn measure_if_drawn(
    timer: Result<&mut FrameTimer, &str>,
    measure: impl FnOnce(&mut FrameTimer) -> Result<Vec<ReportRow>, Error>,
) -> Result<Measured, Error> {
    match timer {
        Ok(timer) => Ok(Measured { rows: measure(timer)?, skipped: None }),
        Err(why) => Ok(Measured { rows: vec![], skipped: Some(format!("frames: {why}")) }),
    }
}

/// Runs the child process under Callgrind: plays the files that a measuring run has written, a session's
/// folder or a volume's file.
///
/// # Errors
/// The files differ from what the measuring run wrote.
pub fn replay_for_callgrind(folder_or_volume: &Path) -> Result<(), Error> {
    if folder_or_volume.is_dir() {
        step::replay_ticks(folder_or_volume)
    } else {
        field::replay_changes(folder_or_volume)
    }
}

/// Returns the pieces of a benchmark that measures each size separately.
fn pieces_by_grid_side(bench: Benchmark, subject: &BenchSubject) -> Vec<PlanPiece<'_>> {
    let sides = subject.grid_sides();
    let mut pieces: Vec<_> =
        sides.iter().map(|&side| PlanPiece::On(bench, subject, side)).collect();
    if bench == Benchmark::Edit && sides.len() == 2 {
        pieces.push(PlanPiece::Scaling(subject));
    }
    pieces
}
