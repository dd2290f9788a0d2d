//! `bench paper`: the experiments in section 5 of the paper, beside the published values.
//!
//! Drawn experiments are timed on the device, over a ring of views of a headset's frame. Each value is the
//! ratio to the whole frame by the paper's path at the subject's smallest size. The paper gives milliseconds
//! of an application's frame, and does not break down the rest. The clean-up runs on one thread and is given
//! in frames of 1/72 s.

use std::cell::RefCell;

use paros_core::session::TICK_RATE;
use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_shaders::gpu::{PaperVariant, RenderPath};
use paros_shell::with_size;

use super::clock::min_of_each_tick_ms;
use super::fixture::HasFixture;
use super::frames::{FrameFormat, FrameTimer, RenderSetup};
use super::framing::Framing;
use super::islands::{our_ticks_ms, paper_ticks_ms};
use super::paper::{PAPER_VISITS, VoxelFill};
use super::row::{Measured, ReportRow};
use super::subject::BenchSubject;

const BENCH: &str = "paper";

/// Frames of the display in a second: one for each tick.
const RATE_HZ: f64 = TICK_RATE as f64;
const FRAME_MS: f64 = 1e3 / RATE_HZ;

/// Time of the whole frame on the paper's headset, in milliseconds.
const WHOLE_MS: f64 = 14.7;
/// Time of a frame that keeps up with the display, as rounded in the paper, which gives no more detail.
const KEPT_UP_MS: f64 = 13.8;
/// Frames a second with a full march, and with a grid of 256.
const FULL_MARCH_FPS: f64 = 60.0;
const AT_256_FPS: f64 = 50.0;
/// Milliseconds of a frame if every frame has a clean-up.
const EVERY_FRAME_MS: f64 = 76.0;

/// An experiment that draws frames.
#[derive(Clone, Copy)]
struct DrawnExperiment {
    name: &'static str,
    path: RenderPath,
    /// `true` for the largest of a subject's sides, which must be larger than the smallest; `false` for the
    /// smallest.
    at_largest_side: bool,
    /// Published time as a fraction of the whole frame's.
    published_share: Option<f64>,
}

const DRAWN: [DrawnExperiment; 7] = [
    DrawnExperiment {
        name: "whole frame",
        path: RenderPath::Paper(PaperVariant::Whole),
        at_largest_side: false,
        published_share: Some(1.0),
    },
    DrawnExperiment {
        name: "SDF off (published: at most)",
        path: RenderPath::Paper(PaperVariant::NoSdf),
        at_largest_side: false,
        published_share: Some(KEPT_UP_MS / WHOLE_MS),
    },
    DrawnExperiment {
        name: "shading off (published: at most)",
        path: RenderPath::Paper(PaperVariant::NoShading),
        at_largest_side: false,
        published_share: Some(KEPT_UP_MS / WHOLE_MS),
    },
    DrawnExperiment {
        name: "full march",
        path: RenderPath::Paper(PaperVariant::FullMarch),
        at_largest_side: false,
        published_share: Some(1e3 / FULL_MARCH_FPS / WHOLE_MS),
    },
    DrawnExperiment {
        name: "whole frame at 256",
        path: RenderPath::Paper(PaperVariant::Whole),
        at_largest_side: true,
        published_share: Some(1e3 / AT_256_FPS / WHOLE_MS),
    },
    DrawnExperiment {
        name: "our fast path",
        path: RenderPath::Fast,
        at_largest_side: false,
        published_share: None,
    },
    DrawnExperiment {
        name: "our fast path at 256",
        path: RenderPath::Fast,
        at_largest_side: true,
        published_share: None,
    },
];

pub(super) fn measure_rows(
    subject: &BenchSubject,
    runs: usize,
    timer: Result<&mut FrameTimer, &str>,
) -> Result<Measured, Error> {
    let (mut rows, skipped) = match timer {
        Ok(timer) => (measure_drawn(subject, runs, timer)?, None),
        Err(why) => (skipped_rows(subject, why), Some(format!("frames: {why}"))),
    };
    rows.extend(with_size!(subject.grid_sides()[0], N => measure_clean_up::<N>(subject, runs))?);
    Ok(Measured { rows, skipped })
}

/// An experiment with the side of its grid.
struct SizedExperiment {
    experiment: DrawnExperiment,
    grid_side: usize,
}

/// Returns the experiments that a subject's sides allow.
fn available_experiments(subject: &BenchSubject) -> impl Iterator<Item = SizedExperiment> {
    let sides = subject.grid_sides();
    let (least, most) = (sides[0], sides[sides.len() - 1]);
    DRAWN.into_iter().filter(move |experiment| !experiment.at_largest_side || most > least).map(
        move |experiment| SizedExperiment {
            experiment,
            grid_side: if experiment.at_largest_side { most } else { least },
        },
    )
}

fn measure_drawn(
    subject: &BenchSubject,
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<Vec<ReportRow>, Error> {
    let mut framings = vec![];
    for &size in subject.grid_sides() {
        framings.push(with_size!(size, N => load_and_fit_framing::<N>(subject, timer))?);
    }
    let framed =
        |grid_side: usize| framings.iter().find(|framing| framing.volume.grid_side() == grid_side);
    let setups: Vec<RenderSetup> = available_experiments(subject)
        .filter_map(|SizedExperiment { experiment: DrawnExperiment { path, .. }, grid_side }| {
            Some(RenderSetup::picture(*framed(grid_side)?, path))
        })
        .collect();
    let times = timer.mean_of_best_ms_per_setup(&setups, FrameFormat::HEADSET, runs)?;
    let whole = times[0];
    let rows = available_experiments(subject).zip(times).map(|(drawn, ms)| ReportRow {
        device: Some(timer.device_name().into()),
        share: Some(ms / whole),
        ..experiment_row(subject, &drawn).with_our_time_ms(ms)
    });
    Ok(rows.collect())
}

fn skipped_rows(subject: &BenchSubject, why: &str) -> Vec<ReportRow> {
    available_experiments(subject)
        .map(|drawn| ReportRow { skipped: Some(why.into()), ..experiment_row(subject, &drawn) })
        .collect()
}

fn experiment_row(
    subject: &BenchSubject,
    SizedExperiment { experiment, grid_side }: &SizedExperiment,
) -> ReportRow {
    ReportRow {
        published: experiment.published_share,
        ..ReportRow::new(BENCH, subject.name(), *grid_side, experiment.name)
    }
}

fn load_and_fit_framing<const N: usize>(
    subject: &BenchSubject,
    timer: &mut FrameTimer,
) -> Result<Framing, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    timer.load_and_fit_framing(subject, &[FrameFormat::HEADSET], &mut *Grid::<N>::lock_fixture())
}

/// Measures the island pass on a volume without islands, the usual case, by the paper's queue and by our
/// rows.
fn measure_clean_up<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    subject.load_into(&mut fixture.start, &mut fixture.bit_grid)?;
    let both = RefCell::new((fixture, VoxelFill::<N>::new()));
    let ticks = |row_visits: u32, voxel_visits: usize| {
        min_of_each_tick_ms(
            runs,
            || our_ticks_ms(both.borrow_mut().0, row_visits),
            || {
                let (fixture, paper) = &mut *both.borrow_mut();
                fixture.other.copy_from(&fixture.start);
                paper_ticks_ms(paper, &mut fixture.other, voxel_visits)
            },
        )
    };
    let whole = ticks(u32::MAX, usize::MAX);
    let parts = ticks(paros_core::limits::max_island_row_visits_per_tick(N), PAPER_VISITS);
    let mut rows = vec![];
    for (way, whole, parts) in [
        ("the paper's queue", &whole.theirs, &parts.theirs),
        ("our rows", &whole.ours, &parts.ours),
    ] {
        let at_once: f64 = whole.iter().sum();
        let worst = parts.iter().copied().fold(0.0, f64::max);
        let mean = parts.iter().sum::<f64>() / parts.len() as f64;
        let published = (way == "the paper's queue").then_some(EVERY_FRAME_MS / FRAME_MS);
        for (what, ms, published) in [
            ("clean-up every frame", at_once, published),
            ("clean-up at once, worst tick", at_once, None),
            ("clean-up at once each second, mean tick", at_once / RATE_HZ, None),
            ("amortised clean-up, worst tick", worst, None),
            ("amortised clean-up, mean tick", mean, None),
        ] {
            let row = ReportRow::new(BENCH, subject.name(), N, format!("{what}: {way}"));
            rows.push(ReportRow {
                share: Some(ms / FRAME_MS),
                published,
                ..row.with_our_time_ms(ms)
            });
        }
    }
    Ok(rows)
}
