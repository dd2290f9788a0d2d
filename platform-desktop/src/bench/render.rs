//! `bench render`: the sculpture's pass by the fast path and by the paper's, on the device's clock.
//!
//! Milliseconds of a frame's sculpture: the fast path's is what finds where rays start and what
//! draws, the paper's what draws. A ring of eight views, the sculpture filling a quarter of the image
//! on average; the mean over the views of each one's best run; all shots of a volume take turns.
//! Then whole frames: those in which a stroke bites, and the studio drawn in other orders.

use paros_core::size::{Grid, Size};
use paros_shaders::gpu::{Parts, Path};

use super::edit_frame;
use super::frames::{Framing, Kind, Shot, Studio};
use super::order;
use super::rig::Rigged;
use super::row::Row;
use super::subject::Subject;
use crate::error::Error;

const BENCH: &str = "render";

/// What is drawn of a volume, ours first.
const PATHS: [Path; 3] = [Path::Fast, Path::Paper(Parts::Whole), Path::Paper(Parts::FullMarch)];

/// Milliseconds of the three paths.
type Costs = [f64; 3];

pub(super) fn rows(subject: &Subject, runs: usize, studio: &mut Studio) -> Result<Vec<Row>, Error> {
    let mut framings = vec![];
    for &size in subject.sizes() {
        framings.push(match size {
            256 => hang::<256>(subject, studio)?,
            _ => hang::<128>(subject, studio)?,
        });
    }
    let mut rows = vec![];
    for kind in Kind::ALL {
        let shots: Vec<Shot> =
            framings.iter().flat_map(|&framing| PATHS.map(|path| Shot { framing, path })).collect();
        let times = studio.time(&shots, kind, runs)?;
        let costs: Vec<Costs> =
            times.chunks_exact(PATHS.len()).map(|costs| [costs[0], costs[1], costs[2]]).collect();
        rows.extend(kind_rows(subject, &framings, &costs, kind));
    }
    for framing in framings {
        rows.extend(match framing.size {
            256 => edit_frame::rows::<256>(subject, framing, runs, studio)?,
            _ => edit_frame::rows::<128>(subject, framing, runs, studio)?,
        });
        if framing.size == 128 {
            rows.extend(order::rows::<128>(subject, runs, studio)?);
        }
    }
    for row in &mut rows {
        row.device = Some(studio.device().into());
    }
    Ok(rows)
}

/// The geometric means of the ratios of render rows, one for each thing that was compared on several
/// volumes.
pub(super) fn means(rows: &[Row]) -> Vec<Row> {
    let mut means: Vec<(Row, f64, u32)> = vec![];
    for row in rows.iter().filter(|row| row.bench == BENCH) {
        let Some(ratio) = row.ratio else { continue };
        match means.iter_mut().find(|(mean, ..)| mean.is_like(row)) {
            Some((_, sum, count)) => (*sum, *count) = (*sum + ratio.ln(), *count + 1),
            None => {
                let mean = Row {
                    device: row.device.clone(),
                    added_percent: row.added_percent,
                    ..Row::new(BENCH, "", row.size, row.against.clone())
                };
                means.push((mean, ratio.ln(), 1));
            }
        }
    }
    let row = |(mean, sum, count): (Row, f64, u32)| {
        let ratio = (sum / f64::from(count)).exp();
        let added_percent = mean.added_percent.map(|_| 100.0 * (1.0 / ratio - 1.0));
        let volume = format!("geometric mean of {count}");
        Row { volume, ratio: Some(ratio), added_percent, ..mean }
    };
    means.into_iter().filter(|(.., count)| *count > 1).map(row).collect()
}

fn hang<const N: usize>(subject: &Subject, studio: &mut Studio) -> Result<Framing, Error>
where
    Grid<N>: Size + Rigged<N>,
{
    studio.hang(subject, &Kind::ALL, &mut *Grid::<N>::rig())
}

fn kind_rows(subject: &Subject, framings: &[Framing], costs: &[Costs], kind: Kind) -> Vec<Row> {
    let row = |framing: &Framing, against: &str, times: [f64; 2]| Row {
        filled: Some(framing.filled),
        ..Row::new(BENCH, subject.name(), framing.size, format!("{against}; {}", kind.name()))
            .times(times)
    };
    let mut rows = vec![];
    for (framing, &[fast, paper, full]) in framings.iter().zip(costs) {
        rows.push(row(framing, "the paper's path", [fast, paper]));
        rows.push(row(framing, "the paper's path with a full march, ours without", [paper, full]));
    }
    if let (&[small, large], &[[_, paper_small, _], [fast_large, paper_large, _]]) =
        (framings, costs)
    {
        rows.push(row(&large, "the paper's path at 128", [fast_large, paper_small]));
        let against = "the paper's path at 256, ours the same at 128";
        rows.push(row(&small, against, [paper_small, paper_large]));
    }
    rows
}
