//! The view that the sculpture fills, as seen while working on it: times beside the paper's path and beside a
//! lower bound, and the texels that a pixel fetches in this view and in the quarter view.

use paros_headless::Error;
use paros_shaders::gpu::{Drawn, PaperVariant, RenderPath};

use super::clock::OursTheirs;
use super::frames::{FrameFormat, FrameTimer, RenderSetup};
use super::framing::{FILLING, Framing};
use super::render::BENCH;
use super::row::ReportRow;
use super::subject::BenchSubject;

const PAPER: RenderPath = RenderPath::Paper(PaperVariant::Whole);

/// Measures a subject that has just been loaded. `framings` are those of the quarter view.
pub(super) fn measure_rows(
    subject: &BenchSubject,
    framings: &[Framing],
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<Vec<ReportRow>, Error> {
    let mut rows = vec![];
    for quarter in framings {
        let filling = timer.refit_framing(quarter, FILLING)?;
        for format in FrameFormat::ALL {
            rows.extend(compare_times(subject, &filling, format, runs, timer)?);
        }
        for (framing, view) in [(quarter, "a quarter"), (&filling, "the view filled")] {
            for (path, name) in [(RenderPath::Fast, "our fast path"), (PAPER, "the paper's path")] {
                let setup = RenderSetup::picture(*framing, path);
                let counts = timer.count_fetches(&setup, FrameFormat::HEADSET)?;
                let what = format!("{view}, {name}; {}", FrameFormat::HEADSET.name());
                let row = new_row(subject, framing, what);
                rows.push(ReportRow { fetches: Some(counts.into()), ..row });
            }
        }
    }
    Ok(rows)
}

fn compare_times(
    subject: &BenchSubject,
    framing: &Framing,
    format: FrameFormat,
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<[ReportRow; 2], Error> {
    let fast = RenderSetup::picture(*framing, RenderPath::Fast);
    let floor = RenderSetup { drawn: Drawn::Floor, ..fast };
    let setups = [fast, RenderSetup::picture(*framing, PAPER), floor];
    let times = timer.mean_of_best_ms_per_setup(&setups, format, runs)?;
    let row = |against: &str, theirs: usize| {
        let what = format!("the view filled, {against}; {}", format.name());
        let times = OursTheirs { ours: times[0], theirs: times[theirs] };
        new_row(subject, framing, what).with_times_ms(times)
    };
    Ok([row("the paper's path", 1), row("no march and two fetches", 2)])
}

fn new_row(subject: &BenchSubject, framing: &Framing, what: String) -> ReportRow {
    let row = ReportRow::new(BENCH, subject.name(), framing.volume.grid_side(), what);
    ReportRow { filled: Some(framing.filled), ..row }
}
