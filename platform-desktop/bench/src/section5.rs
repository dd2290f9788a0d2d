//! `bench paper`: section 5 of the paper, experiment by experiment, beside what it published.
//!
//! What draws is timed on the device, over a ring of views of a headset's frame; each figure is
//! given as its ratio to the whole frame by the paper's path at the figure's least size. The paper gives
//! milliseconds of an application's frame, and does not break down the rest. The clean-up runs on one
//! thread and is given in frames of 1/72 s.

use std::cell::RefCell;

use paros_core::{Grid, Size, TICK_RATE};
use paros_headless::Error;
use paros_shaders::gpu::{PaperVariant, RenderPath};
use paros_shell::with_size;

use super::clock::best_ticks_ms;
use super::fixture::HasFixture;
use super::frames::{FrameFormat, FrameTimer, Framing, RenderSetup};
use super::islands::{our_ticks_ms, paper_ticks_ms};
use super::paper::{PAPER_VISITS, VoxelFill};
use super::row::ReportRow;
use super::subject::Subject;

const BENCH: &str = "paper";

/// The display's frames in a second: one for each tick.
const RATE_HZ: f64 = TICK_RATE as f64;
const FRAME_MS: f64 = 1e3 / RATE_HZ;

/// The whole frame on the paper's headset, in milliseconds.
const WHOLE_MS: f64 = 14.7;
/// Its frame where it keeps up with the display, as the paper rounds it: no more is known.
const KEPT_UP_MS: f64 = 13.8;
/// Frames a second with a full march, and at 256.
const FULL_MARCH_FPS: f64 = 60.0;
const AT_256_FPS: f64 = 50.0;
/// Milliseconds of a frame with a clean-up in every one.
const EVERY_FRAME_MS: f64 = 76.0;

/// An experiment that is drawn: its name, path, whether at 256, and the published ratio.
type DrawnExperiment = (&'static str, RenderPath, bool, Option<f64>);

const DRAWN: [DrawnExperiment; 7] = [
    ("whole frame", RenderPath::Paper(PaperVariant::Whole), false, Some(1.0)),
    (
        "SDF off (published: at most)",
        RenderPath::Paper(PaperVariant::NoSdf),
        false,
        Some(KEPT_UP_MS / WHOLE_MS),
    ),
    (
        "shading off (published: at most)",
        RenderPath::Paper(PaperVariant::NoShading),
        false,
        Some(KEPT_UP_MS / WHOLE_MS),
    ),
    (
        "full march",
        RenderPath::Paper(PaperVariant::FullMarch),
        false,
        Some(1e3 / FULL_MARCH_FPS / WHOLE_MS),
    ),
    (
        "whole frame at 256",
        RenderPath::Paper(PaperVariant::Whole),
        true,
        Some(1e3 / AT_256_FPS / WHOLE_MS),
    ),
    ("our fast path", RenderPath::Fast, false, None),
    ("our fast path at 256", RenderPath::Fast, true, None),
];

/// The rows, and why those that are drawn have no figures if they haven't.
pub(super) fn measure_rows(
    subject: &Subject,
    runs: usize,
    timer: Result<&mut FrameTimer, &str>,
) -> Result<(Vec<ReportRow>, Option<String>), Error> {
    let (mut rows, skipped) = match timer {
        Ok(timer) => (measure_drawn(subject, runs, timer)?, None),
        Err(why) => (skipped_rows(subject, why), Some(format!("frames: {why}"))),
    };
    rows.extend(with_size!(subject.sizes()[0], N => measure_clean_up::<N>(subject, runs))?);
    Ok((rows, skipped))
}

/// The experiments that a subject's sizes allow, each with its size.
fn available_experiments(subject: &Subject) -> impl Iterator<Item = (DrawnExperiment, usize)> {
    let sizes = subject.sizes();
    let (least, most) = (sizes[0], sizes[sizes.len() - 1]);
    DRAWN
        .into_iter()
        .filter(move |(_, _, at_256, _)| !at_256 || most > least)
        .map(move |drawn| (drawn, if drawn.2 { most } else { least }))
}

fn measure_drawn(
    subject: &Subject,
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<Vec<ReportRow>, Error> {
    let mut framings = vec![];
    for &size in subject.sizes() {
        framings.push(with_size!(size, N => load_and_frame::<N>(subject, timer))?);
    }
    let framed = |size: usize| framings.iter().find(|framing| framing.size == size);
    let setups: Vec<RenderSetup> = available_experiments(subject)
        .filter_map(|((_, path, ..), size)| Some(RenderSetup { framing: *framed(size)?, path }))
        .collect();
    let times = timer.time_setups_ms(&setups, FrameFormat::HEADSET, runs)?;
    let whole = times[0];
    let rows = available_experiments(subject).zip(times).map(|((drawn, size), ms)| ReportRow {
        device: Some(timer.device_name().into()),
        share: Some(ms / whole),
        ..experiment_row(subject, size, &drawn).with_our_time_ms(ms)
    });
    Ok(rows.collect())
}

fn skipped_rows(subject: &Subject, why: &str) -> Vec<ReportRow> {
    available_experiments(subject)
        .map(|(drawn, size)| ReportRow {
            skipped: Some(why.into()),
            ..experiment_row(subject, size, &drawn)
        })
        .collect()
}

fn experiment_row(
    subject: &Subject,
    size: usize,
    (name, _, _, published): &DrawnExperiment,
) -> ReportRow {
    ReportRow { published: *published, ..ReportRow::new(BENCH, subject.name(), size, *name) }
}

fn load_and_frame<const N: usize>(
    subject: &Subject,
    timer: &mut FrameTimer,
) -> Result<Framing, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    timer.load_and_frame(subject, &[FrameFormat::HEADSET], &mut *Grid::<N>::lock_fixture())
}

/// The island pass on a volume without islands, the usual case, by the paper's queue and by our rows.
fn measure_clean_up<const N: usize>(subject: &Subject, runs: usize) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    subject.load_into(&mut fixture.start, &mut fixture.plane)?;
    let both = RefCell::new((fixture, VoxelFill::<N>::new()));
    let ticks = |ours: u32, theirs: usize| {
        best_ticks_ms(
            runs,
            || our_ticks_ms(both.borrow_mut().0, ours),
            || {
                let (fixture, paper) = &mut *both.borrow_mut();
                fixture.other.copy_from(&fixture.start);
                paper_ticks_ms(paper, &mut fixture.other, theirs)
            },
        )
    };
    let whole = ticks(u32::MAX, usize::MAX);
    let parts = ticks(paros_core::limits::island_row_visits(N), PAPER_VISITS);
    let mut rows = vec![];
    for (way, whole, parts) in
        [("the paper's queue", &whole[1], &parts[1]), ("our rows", &whole[0], &parts[0])]
    {
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
