//! `bench paper`: section 5 of the paper, experiment by experiment, beside what it published.
//!
//! What draws is timed on the device, over a ring of views of a headset's frame; each figure is told
//! as its ratio to the whole frame by the paper's path at the figure's least size. The paper tells
//! milliseconds of an application's frame, the rest of which it doesn't take apart. The clean-up runs
//! on one thread and is told in frames of 1/72 s.

use std::cell::RefCell;

use paros_core::size::{Grid, Size};
use paros_shaders::gpu::{Parts, Path};

use super::clock::best_ticks;
use super::frames::{Framing, Kind, Shot, Studio};
use super::islands::{our_ticks, paper_ticks};
use super::paper::{PAPER_VISITS, VoxelFill};
use super::rig::Rigged;
use super::row::Row;
use super::subject::Subject;
use crate::error::Error;

const BENCH: &str = "paper";

/// The display's frames in a second.
const RATE: f64 = 72.0;
const FRAME_MS: f64 = 1e3 / RATE;

/// The whole frame on the paper's headset, in milliseconds.
const WHOLE: f64 = 14.7;
/// Its frame where it keeps up with the display, as the paper rounds it: no more is known.
const KEPT_UP: f64 = 13.8;
/// Frames a second with a full march, and at 256.
const FULL_MARCH: f64 = 60.0;
const AT_256: f64 = 50.0;
/// Milliseconds of a frame with a clean-up in every one.
const EVERY_FRAME: f64 = 76.0;

/// An experiment that is drawn: its name, path, whether at 256, and the published ratio.
type Drawn = (&'static str, Path, bool, Option<f64>);

const DRAWN: [Drawn; 7] = [
    ("whole frame", Path::Paper(Parts::Whole), false, Some(1.0)),
    ("SDF off (published: at most)", Path::Paper(Parts::NoSdf), false, Some(KEPT_UP / WHOLE)),
    (
        "shading off (published: at most)",
        Path::Paper(Parts::NoShading),
        false,
        Some(KEPT_UP / WHOLE),
    ),
    ("full march", Path::Paper(Parts::FullMarch), false, Some(1e3 / FULL_MARCH / WHOLE)),
    ("whole frame at 256", Path::Paper(Parts::Whole), true, Some(1e3 / AT_256 / WHOLE)),
    ("our fast path", Path::Fast, false, None),
    ("our fast path at 256", Path::Fast, true, None),
];

/// The rows, and why those that are drawn have no figures if they haven't.
pub(super) fn rows(
    subject: &Subject,
    runs: usize,
    studio: Result<&mut Studio, &str>,
) -> Result<(Vec<Row>, Option<String>), Error> {
    let (mut rows, skipped) = match studio {
        Ok(studio) => (drawn(subject, runs, studio)?, None),
        Err(why) => (undrawn(subject, why), Some(format!("frames: {why}"))),
    };
    rows.extend(match subject.sizes() {
        [256] => clean_up::<256>(subject, runs)?,
        _ => clean_up::<128>(subject, runs)?,
    });
    Ok((rows, skipped))
}

/// The experiments that a subject can be had for.
fn experiments(subject: &Subject) -> impl Iterator<Item = (Drawn, usize)> {
    let sizes = subject.sizes();
    let (least, most) = (sizes[0], sizes[sizes.len() - 1]);
    DRAWN
        .into_iter()
        .filter(move |(_, _, at_256, _)| !at_256 || most > least)
        .map(move |drawn| (drawn, if drawn.2 { most } else { least }))
}

fn drawn(subject: &Subject, runs: usize, studio: &mut Studio) -> Result<Vec<Row>, Error> {
    let mut framings = vec![];
    for &size in subject.sizes() {
        framings.push(match size {
            256 => hang::<256>(subject, studio)?,
            _ => hang::<128>(subject, studio)?,
        });
    }
    let framed = |size: usize| framings.iter().find(|framing| framing.size == size);
    let shots: Vec<Shot> = experiments(subject)
        .filter_map(|((_, path, ..), size)| Some(Shot { framing: *framed(size)?, path }))
        .collect();
    let times = studio.time(&shots, Kind::HEADSET, runs)?;
    let whole = times[0];
    let rows = experiments(subject).zip(times).map(|((drawn, size), ms)| Row {
        device: Some(studio.device().into()),
        share: Some(ms / whole),
        ..row(subject, size, &drawn).ours(ms)
    });
    Ok(rows.collect())
}

fn undrawn(subject: &Subject, why: &str) -> Vec<Row> {
    experiments(subject)
        .map(|(drawn, size)| Row { skipped: Some(why.into()), ..row(subject, size, &drawn) })
        .collect()
}

fn row(subject: &Subject, size: usize, (name, _, _, published): &Drawn) -> Row {
    Row { published: *published, ..Row::new(BENCH, subject.name(), size, *name) }
}

fn hang<const N: usize>(subject: &Subject, studio: &mut Studio) -> Result<Framing, Error>
where
    Grid<N>: Size + Rigged<N>,
{
    studio.hang(subject, &[Kind::HEADSET], &mut *Grid::<N>::rig())
}

/// The clean-up of a volume from which nothing is to be removed, as in all but a few ticks, by the
/// paper's queue and by our rows.
fn clean_up<const N: usize>(subject: &Subject, runs: usize) -> Result<Vec<Row>, Error>
where
    Grid<N>: Size + Rigged<N>,
{
    let rig = &mut *Grid::<N>::rig();
    subject.load(&mut rig.start, &mut rig.plane)?;
    let both = RefCell::new((rig, VoxelFill::<N>::new()));
    let ticks = |ours: u32, theirs: usize| {
        best_ticks(
            runs,
            || our_ticks(both.borrow_mut().0, ours),
            || {
                let (rig, paper) = &mut *both.borrow_mut();
                rig.other.copy_from(&rig.start);
                paper_ticks(paper, &mut rig.other, theirs)
            },
        )
    };
    let whole = ticks(u32::MAX, usize::MAX);
    let parts = ticks(paros_core::limits::row_visits(N), PAPER_VISITS);
    let mut rows = vec![];
    for (way, whole, parts) in
        [("the paper's queue", &whole[1], &parts[1]), ("our rows", &whole[0], &parts[0])]
    {
        let at_once: f64 = whole.iter().sum();
        let worst = parts.iter().copied().fold(0.0, f64::max);
        let mean = parts.iter().sum::<f64>() / parts.len() as f64;
        let published = (way == "the paper's queue").then_some(EVERY_FRAME / FRAME_MS);
        for (what, ms, published) in [
            ("clean-up every frame", at_once, published),
            ("clean-up at once, worst tick", at_once, None),
            ("clean-up at once each second, mean tick", at_once / RATE, None),
            ("amortised clean-up, worst tick", worst, None),
            ("amortised clean-up, mean tick", mean, None),
        ] {
            let row = Row::new(BENCH, subject.name(), N, format!("{what}: {way}"));
            rows.push(Row { share: Some(ms / FRAME_MS), published, ..row.ours(ms) });
        }
    }
    Ok(rows)
}
