//! `bench render`: the sculpture's pass by the fast path and by the paper's, on the device's clock.
//!
//! Values are the milliseconds of a frame's sculpture: for the fast path, the search for the rays' start
//! points and the drawing; for the paper's, the drawing. They are the mean over a ring of eight views, in
//! which the sculpture fills a quarter of the image on average, of each view's best run. All setups of a
//! volume alternate. The same voxels are also drawn in columns of two intervals, with the programs and
//! textures for two; the picture is the same.
//!
//! Then follow the view that the sculpture fills, and whole frames: with a stroke's uploads, the scene in
//! other draw orders, and the scene of a visit with everything on screen at once.

use paros_core::volume::Grid;
use paros_headless::Error;
use paros_shaders::gpu::{PaperVariant, RenderPath};
use paros_shell::with_size;

use super::clock::OursTheirs;
use super::edit_frame;
use super::filled;
use super::fixture::HasFixture;
use super::frames::{FrameFormat, FrameTimer, RenderSetup};
use super::framing::Framing;
use super::order;
use super::row::ReportRow;
use super::subject::BenchSubject;
use super::visit_scene;

pub(super) const BENCH: &str = "render";

/// The render paths that draw a volume, ours first.
const PATHS: [RenderPath; 3] = [
    RenderPath::Fast,
    RenderPath::Paper(PaperVariant::Whole),
    RenderPath::Paper(PaperVariant::FullMarch),
];

/// Milliseconds of the three paths, with one interval a column and with two.
#[derive(Clone, Copy)]
struct Costs {
    one: [f64; PATHS.len()],
    two: [f64; PATHS.len()],
}

pub(super) fn measure_rows(
    subject: &BenchSubject,
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<Vec<ReportRow>, Error> {
    let framings = load_and_fit_framings(subject, &FrameFormat::ALL, timer)?;
    let mut rows = vec![];
    for format in FrameFormat::ALL {
        let setups: Vec<RenderSetup> = framings
            .iter()
            .flat_map(|framing| [*framing, framing.of_two_intervals()])
            .flat_map(|framing| PATHS.map(|path| RenderSetup::picture(framing, path)))
            .collect();
        let times = timer.mean_of_best_ms_per_setup(&setups, format, runs)?;
        let costs = times.as_chunks::<{ PATHS.len() }>().0.as_chunks::<2>().0;
        let costs: Vec<Costs> = costs.iter().map(|&[one, two]| Costs { one, two }).collect();
        rows.extend(format_rows(subject, &framings, &costs, format));
    }
    rows.extend(filled::measure_rows(subject, &framings, runs, timer)?);
    for framing in framings {
        let edits = with_size!(framing.volume.grid_side(), N => edit_frame::measure_rows::<N>(subject, framing, runs, timer));
        rows.extend(edits?);
        if framing.volume.grid_side() == 128 {
            rows.extend(order::measure_rows::<128>(subject, runs, timer)?);
            rows.extend(visit_scene::measure_rows::<128>(subject, runs, timer)?);
        }
    }
    for row in &mut rows {
        row.device = Some(timer.device_name().into());
    }
    Ok(rows)
}

/// Returns the geometric means of the ratios of render rows, one for each comparison that was made on several
/// volumes.
pub(super) fn geometric_means(rows: &[ReportRow]) -> Vec<ReportRow> {
    let mut means: Vec<(ReportRow, f64, u32)> = vec![];
    for row in rows.iter().filter(|row| row.bench == BENCH) {
        let Some(ratio) = row.ratio else { continue };
        match means.iter_mut().find(|(mean, ..)| mean.is_same_comparison(row)) {
            Some((_, sum, count)) => (*sum, *count) = (*sum + ratio.ln(), *count + 1),
            None => {
                let mean = ReportRow {
                    device: row.device.clone(),
                    added_percent: row.added_percent,
                    ..ReportRow::new(BENCH, "", row.size, row.against.clone())
                };
                means.push((mean, ratio.ln(), 1));
            }
        }
    }
    let row = |(mean, sum, count): (ReportRow, f64, u32)| {
        let ratio = (sum / f64::from(count)).exp();
        let added_percent = mean.added_percent.map(|_| 100.0 * (1.0 / ratio - 1.0));
        let volume = format!("geometric mean of {count}");
        ReportRow { volume, ratio: Some(ratio), added_percent, ..mean }
    };
    means.into_iter().filter(|(.., count)| *count > 1).map(row).collect()
}

/// Loads a subject at its sizes, in columns of one interval and of two, and finds a framing for each size.
pub(super) fn load_and_fit_framings(
    subject: &BenchSubject,
    formats: &[FrameFormat],
    timer: &mut FrameTimer,
) -> Result<Vec<Framing>, Error> {
    let load = |size: &usize| {
        with_size!(*size, N => {
            let fixture = &mut *Grid::<N>::lock_fixture();
            let framing = timer.load_and_fit_framing(subject, formats, fixture)?;
            timer.load_two_intervals(formats, &fixture.bit_grid)?;
            Ok(framing)
        })
    };
    subject.grid_sides().iter().map(load).collect()
}

fn format_rows(
    subject: &BenchSubject,
    framings: &[Framing],
    costs: &[Costs],
    format: FrameFormat,
) -> Vec<ReportRow> {
    let row = |framing: &Framing, against: &str, ours: f64, theirs: f64| ReportRow {
        filled: Some(framing.filled),
        ..ReportRow::new(
            BENCH,
            subject.name(),
            framing.volume.grid_side(),
            format!("{against}; {}", format.name()),
        )
        .with_times_ms(OursTheirs { ours, theirs })
    };
    let mut rows = vec![];
    for (framing, &Costs { one: [fast, paper, full], two }) in framings.iter().zip(costs) {
        rows.push(row(framing, "the paper's path", fast, paper));
        rows.push(row(framing, "the paper's path with a full march, ours without", paper, full));
        let [fast_two, paper_two, full_two] = two;
        let against = "the paper's path of two intervals with a full march, ours without";
        rows.push(row(framing, against, paper_two, full_two));
        rows.push(row(framing, "the paper's path with one interval, ours two", paper_two, paper));
        rows.push(row(framing, "our fast path with one interval, ours two", fast_two, fast));
    }
    if let (&[small, large], &[Costs { one: of_small, .. }, Costs { one: of_large, .. }]) =
        (framings, costs)
    {
        let ([_, paper_small, _], [fast_large, paper_large, _]) = (of_small, of_large);
        rows.push(row(&large, "the paper's path at 128", fast_large, paper_small));
        let against = "the paper's path at 256, ours the same at 128";
        rows.push(row(&small, against, paper_small, paper_large));
    }
    rows
}
