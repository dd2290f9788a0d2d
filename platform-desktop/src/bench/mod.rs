//! `paros bench`: this code and others' on the same volumes in the same run, taking turns.

mod bake;
mod callgrind;
mod clock;
pub mod dense;
mod edit;
mod edit_frame;
mod field;
mod frames;
mod islands;
mod mesh;
mod order;
pub mod paper;
mod peers;
mod render;
mod rig;
mod row;
mod section5;
mod step;
mod subject;

use std::path::{Path, PathBuf};

use clap::ValueEnum;

pub use row::{Row, table};
pub use subject::Subject;

use crate::error::Error;
use frames::Studio;
use peers::{Missing, Peers};

/// What can be measured.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub enum Bench {
    /// The search for islands.
    Islands,
    /// Carving and filling.
    Edit,
    /// Export to STL.
    Mesh,
    /// From triangles to a volume.
    Bake,
    /// Sizes in memory, and instructions of a tick of recorded sessions.
    Step,
    /// What a frame spends on keeping the fast path's textures up to date.
    Field,
    /// The sculpture's pass on a Vulkan device, by both paths.
    Render,
    /// The experiments of the paper's section 5.
    Paper,
}

/// What is to be measured, on what, and how often.
#[derive(Debug)]
pub struct Plan {
    /// The benches, in order.
    pub benches: Vec<Bench>,
    /// What they run on, all but [`Bench::Step`].
    pub subjects: Vec<Subject>,
    /// Sessions that [`Bench::Step`] plays; the demo at both sizes where there are none.
    pub traces: Vec<PathBuf>,
    /// Runs of each side; the best counts.
    pub runs: usize,
    /// Runs of each frame; the best counts.
    pub frame_runs: usize,
    /// Pixels across and down a frame.
    pub canvas: [u32; 2],
    /// A part of the name of the Vulkan device that is meant.
    pub device: Option<String>,
    /// The Python that has the peers' packages.
    pub python: PathBuf,
}

/// What was measured, and what wasn't.
#[derive(Debug, Default)]
pub struct Report {
    /// The rows, in the order of the plan.
    pub rows: Vec<Row>,
    /// Why some figures are missing, each reason once.
    pub skipped: Vec<String>,
}

/// One piece of a plan.
#[derive(Clone, Copy)]
enum Job<'a> {
    On(Bench, &'a Subject, usize),
    Scaling(&'a Subject),
    Render(&'a Subject),
    Paper(&'a Subject),
    Sizes,
    Demo(usize),
    Recorded(&'a Path),
}

/// Hears what part of a piece is done, 0 to 1.
type Heard<'a> = &'a dyn Fn(f64);

/// What pieces of a plan share.
struct Shared {
    peers: Result<Peers, Missing>,
    studio: Result<Studio, String>,
}

impl Plan {
    /// How many pieces it has.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.jobs().len()
    }

    /// Measures. `progress` hears how many pieces are done, with the part of the one under way.
    ///
    /// # Errors
    /// A subject that holds nothing, two sides that come to different results, or no device to
    /// draw where nothing else is to be measured.
    pub fn run(&self, progress: impl Fn(f64)) -> Result<Report, Error> {
        let mut report = Report::default();
        let mut shared = Shared { peers: self.peers(), studio: self.studio()? };
        for (i, job) in self.jobs().into_iter().enumerate() {
            let heard = |part: f64| progress(i as f64 + part);
            heard(0.0);
            let (rows, skipped) = self.job(job, &mut shared, &heard)?;
            report.rows.extend(rows);
            report.skipped.extend(skipped.filter(|why| !report.skipped.contains(why)));
        }
        let means = render::means(&report.rows);
        report.rows.extend(means);
        Ok(report)
    }

    fn needs(&self, some: [Bench; 2]) -> bool {
        self.benches.iter().any(|bench| some.contains(bench))
    }

    fn peers(&self) -> Result<Peers, Missing> {
        match self.needs([Bench::Mesh, Bench::Bake]) {
            true => Peers::start(&self.python),
            false => Err(Missing::unneeded()),
        }
    }

    /// Where frames are drawn, or why nowhere.
    fn studio(&self) -> Result<Result<Studio, String>, Error> {
        if !self.needs([Bench::Render, Bench::Paper]) {
            return Ok(Err(String::new()));
        }
        let studio = Studio::open(self.device.as_deref(), self.canvas);
        if self.benches == [Bench::Render] {
            return studio.map(Ok);
        }
        // That would take hours and tell nothing.
        let slow = |studio: &Studio| studio.is_software() && self.device.is_none();
        Ok(match studio {
            Ok(studio) if slow(&studio) => {
                Err(format!("{} is no GPU; `--device` may name it", studio.device()))
            }
            studio => studio.map_err(|error| error.to_string()),
        })
    }

    fn jobs(&self) -> Vec<Job<'_>> {
        let mut jobs = vec![];
        for &bench in &self.benches {
            match bench {
                Bench::Step => jobs.extend(self.sessions()),
                Bench::Render => jobs.extend(self.subjects.iter().map(Job::Render)),
                Bench::Paper => jobs.extend(self.subjects.iter().map(Job::Paper)),
                _ => jobs.extend(self.subjects.iter().flat_map(|subject| sized(bench, subject))),
            }
        }
        jobs
    }

    fn sessions(&self) -> impl Iterator<Item = Job<'_>> {
        let demo = [128, 256].map(Job::Demo).into_iter().filter(|_| self.traces.is_empty());
        let recorded = self.traces.iter().map(|path| Job::Recorded(path));
        [Job::Sizes].into_iter().chain(demo).chain(recorded)
    }

    fn job(
        &self,
        job: Job<'_>,
        shared: &mut Shared,
        heard: Heard<'_>,
    ) -> Result<(Vec<Row>, Option<String>), Error> {
        let (runs, peers) = (self.runs, &mut shared.peers);
        let studio = shared.studio.as_mut().map_err(|why| why.as_str());
        let whole = |rows: Vec<Row>| (rows, None);
        match job {
            Job::On(Bench::Islands, on, 256) => islands::rows::<256>(on, runs).map(whole),
            Job::On(Bench::Islands, on, _) => islands::rows::<128>(on, runs).map(whole),
            Job::On(Bench::Edit, on, 256) => edit::rows::<256>(on, runs).map(whole),
            Job::On(Bench::Edit, on, _) => edit::rows::<128>(on, runs).map(whole),
            Job::On(Bench::Mesh, on, 256) => mesh::rows::<256>(on, runs, peers),
            Job::On(Bench::Mesh, on, _) => mesh::rows::<128>(on, runs, peers),
            Job::On(Bench::Bake, on, 256) => bake::rows::<256>(on, runs, peers),
            Job::On(Bench::Bake, on, _) => bake::rows::<128>(on, runs, peers),
            Job::On(Bench::Field, on, 256) => field::rows::<256>(on),
            Job::On(Bench::Field, on, _) => field::rows::<128>(on),
            Job::Scaling(on) => edit::scaling(on, runs).map(whole),
            Job::Render(on) | Job::On(Bench::Render, on, _) => match studio {
                Ok(studio) => render::rows(on, self.frame_runs, studio).map(whole),
                Err(why) => Ok((vec![], Some(format!("frames: {why}")))),
            },
            Job::Paper(on) | Job::On(Bench::Paper, on, _) => {
                section5::rows(on, self.frame_runs, studio)
            }
            Job::Sizes | Job::On(Bench::Step, ..) => Ok(whole(step::sizes())),
            Job::Demo(256) => step::demo::<256>(heard),
            Job::Demo(_) => step::demo::<128>(heard),
            Job::Recorded(path) => step::recorded(path, heard),
        }
    }
}

/// For the benches' own use: plays what one of them left, a session's folder or a volume's file, to
/// be counted from outside.
///
/// # Errors
/// It is not as the measuring run left it.
pub fn replay(what: &Path) -> Result<(), Error> {
    if what.is_dir() { step::replay(what) } else { field::replay(what) }
}

/// The pieces of a bench that takes each size by itself.
fn sized(bench: Bench, subject: &Subject) -> Vec<Job<'_>> {
    let sizes = subject.sizes();
    let mut jobs: Vec<_> = sizes.iter().map(|&size| Job::On(bench, subject, size)).collect();
    if bench == Bench::Edit && sizes.len() == 2 {
        jobs.push(Job::Scaling(subject));
    }
    jobs
}
