//! `paros bench`: this code and others' on the same volumes in the same run, taking turns.

mod bake;
mod clock;
pub mod dense;
mod edit;
mod islands;
mod mesh;
pub mod paper;
mod peers;
mod rig;
mod row;
pub mod step;
mod subject;

use std::path::PathBuf;

use clap::ValueEnum;

pub use row::{Row, table};
pub use subject::Subject;

use crate::error::Error;
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
    /// Sizes in memory and instructions of a tick.
    Step,
}

/// What is to be measured, on what, and how often.
#[derive(Debug)]
pub struct Plan {
    /// The benches, in order.
    pub benches: Vec<Bench>,
    /// What they run on.
    pub subjects: Vec<Subject>,
    /// Runs of each side; the best counts.
    pub runs: usize,
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
    Step,
}

impl Plan {
    /// How many pieces it has.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.jobs().len()
    }

    /// Measures. `progress` hears how many pieces are done.
    ///
    /// # Errors
    /// A subject that holds nothing, or two sides that come to different results.
    pub fn run(&self, progress: impl Fn(usize)) -> Result<Report, Error> {
        let mut report = Report::default();
        let needed = |bench: &Bench| matches!(bench, Bench::Mesh | Bench::Bake);
        let mut peers = match self.benches.iter().any(needed) {
            true => Peers::start(&self.python),
            false => Err(Missing::unneeded()),
        };
        for (i, job) in self.jobs().into_iter().enumerate() {
            progress(i);
            let (rows, skipped) = self.job(job, &mut peers)?;
            report.rows.extend(rows);
            report.skipped.extend(skipped.filter(|why| !report.skipped.contains(why)));
        }
        Ok(report)
    }

    fn jobs(&self) -> Vec<Job<'_>> {
        let mut jobs = vec![];
        for &bench in &self.benches {
            if bench == Bench::Step {
                jobs.push(Job::Step);
                continue;
            }
            for subject in &self.subjects {
                let sizes = subject.sizes();
                jobs.extend(sizes.iter().map(|&size| Job::On(bench, subject, size)));
                if bench == Bench::Edit && sizes.len() == 2 {
                    jobs.push(Job::Scaling(subject));
                }
            }
        }
        jobs
    }

    fn job(
        &self,
        job: Job<'_>,
        peers: &mut Result<Peers, Missing>,
    ) -> Result<(Vec<Row>, Option<String>), Error> {
        let runs = self.runs;
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
            Job::Scaling(on) => edit::scaling(on, runs).map(whole),
            Job::Step | Job::On(Bench::Step, ..) => step::rows(),
        }
    }
}
