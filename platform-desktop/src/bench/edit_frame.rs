//! Frames in which a stroke bites, beside the same frames without its uploads.

use paros_core::size::{Grid, Size};
use paros_shaders::field::{Budget, Field};
use paros_shaders::gpu::Path;

use super::edit::{CARVE, RADIUS, edit, surface};
use super::frames::{Framing, Kind, Shot, Studio, VIEWS, mean_ms};
use super::rig::{Rigged, reset};
use super::row::Row;
use super::subject::Subject;
use crate::error::Error;
use crate::headless::Uploads;

/// The volume hangs in the studio. One edit for each view of the ring, at places all over the
/// surface.
pub(super) fn rows<const N: usize>(
    subject: &Subject,
    framing: Framing,
    runs: usize,
    studio: &mut Studio,
) -> Result<Vec<Row>, Error>
where
    Grid<N>: Size + Rigged<N>,
{
    let rig = &mut *Grid::<N>::rig();
    let places = surface(&rig.plane);
    let mut field = Box::new(Field::<N>::new());
    field.rebuild(&rig.start);
    reset(rig);
    let shot = Shot { framing, path: Path::Fast };
    let mut best = [[[u64::MAX; VIEWS]; 2]; Kind::ALL.len()];
    let (mut in_frame, mut in_all) = (0, 0);
    for view in 0..VIEWS {
        edit(rig, places[view * places.len() / VIEWS], CARVE);
        field.note(rig.volume.maps(), &rig.dirty);
        let uploads = advance(&mut field, Budget::frame(N));
        for (kind, best) in Kind::ALL.into_iter().zip(&mut best) {
            for _ in 0..runs {
                for (uploads, best) in [&uploads, &vec![]].into_iter().zip(&mut *best) {
                    let times = studio.draw(&shot, kind, view, uploads)?;
                    best[view] = best[view].min(times.whole);
                }
            }
        }
        let bytes = bytes(&uploads);
        in_frame = in_frame.max(bytes);
        in_all = in_all.max(bytes + settle(&mut field, studio)?);
    }
    let row = |against: String| Row::new("render", subject.name(), N, against);
    let stroke = format!("a stroke of radius {RADIUS}");
    let bytes = |count: usize, what: &str| Row {
        bytes: Some(count as u64),
        ..row(format!("worst upload of {stroke}, {what}"))
    };
    let mut rows = vec![bytes(in_frame, "in its frame"), bytes(in_all, "in all frames")];
    for (kind, [with, without]) in Kind::ALL.into_iter().zip(best) {
        let times = [mean_ms(&with), mean_ms(&without)];
        let added = 100.0 * (times[0] / times[1] - 1.0);
        let against = format!("whole frame, ours with the upload of {stroke}; {}", kind.name());
        rows.push(Row { added_percent: Some(added), ..row(against).times(times) });
    }
    Ok(rows)
}

/// What is still to be done after the edit's own frame; its bytes.
fn settle<const N: usize>(field: &mut Field<N>, studio: &mut Studio) -> Result<usize, Error> {
    let mut later = 0;
    while field.pending() {
        let uploads = advance(field, Budget::UNLIMITED);
        later += bytes(&uploads);
        for (region, bytes) in uploads {
            for kind in Kind::ALL {
                studio.easel(N, kind)?.upload(region, &bytes)?;
            }
        }
    }
    Ok(later)
}

fn bytes(uploads: &Uploads) -> usize {
    uploads.iter().map(|(region, _)| region.bytes()).sum()
}

fn advance<const N: usize>(field: &mut Field<N>, budget: Budget) -> Uploads {
    let mut uploads = vec![];
    field.advance(budget, &mut |region, bytes| uploads.push((region, bytes.to_vec())));
    uploads
}
