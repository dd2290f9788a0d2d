//! Frames with the texture uploads of a carving stroke, beside the same frames without them.

use paros_core::volume::{Grid, Size};
use paros_headless::Error;
use paros_headless::Uploads;
use paros_shaders::field::{Budget, DensityField};
use paros_shaders::gpu::RenderPath;
use paros_shaders::upload::VolumeFormat;

use super::clock::OursTheirs;
use super::edit::{CARVE, RADIUS, sample_surface_voxels, try_edit_sphere_at};
use super::fixture::{HasFixture, restore_start_volume};
use super::frames::{FrameFormat, FrameTimer, RenderSetup, mean_ms};
use super::framing::{Framing, VIEWS};
use super::row::ReportRow;
use super::subject::BenchSubject;

/// Measures one edit for each view of the ring, at voxels spread over the surface. The subject is already
/// loaded into the renderers.
pub(super) fn measure_rows<const N: usize>(
    subject: &BenchSubject,
    framing: Framing,
    runs: usize,
    timer: &mut FrameTimer,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    let voxels = sample_surface_voxels(&fixture.bit_grid);
    let mut field = Box::new(DensityField::<N>::new());
    field.rebuild_from(&fixture.start);
    restore_start_volume(fixture);
    let setup = RenderSetup::picture(framing, RenderPath::Fast);
    let mut best = [[[u64::MAX; VIEWS]; 2]; FrameFormat::ALL.len()];
    let (mut in_frame, mut in_all) = (0, 0);
    for view in 0..VIEWS {
        try_edit_sphere_at(fixture, voxels[view * voxels.len() / VIEWS], CARVE);
        field.note_dirty_columns(fixture.volume.maps(), &fixture.dirty);
        let uploads = collect_uploads(&mut field, Budget::per_frame(N));
        for (format, best) in FrameFormat::ALL.into_iter().zip(&mut best) {
            for _ in 0..runs {
                for (uploads, best) in [&uploads, &vec![]].into_iter().zip(&mut *best) {
                    let times = timer.draw_view(&setup, format, view, uploads)?;
                    best[view] = best[view].min(times.total_ns);
                }
            }
        }
        let bytes = upload_bytes(&uploads);
        in_frame = in_frame.max(bytes);
        in_all = in_all.max(bytes + upload_rest_and_count_bytes(&mut field, timer)?);
    }
    let row = |against: String| ReportRow::new("render", subject.name(), N, against);
    let stroke = format!("a stroke of radius {RADIUS}");
    let bytes = |count: usize, what: &str| ReportRow {
        bytes: Some(count as u64),
        ..row(format!("worst upload of {stroke}, {what}"))
    };
    let mut rows = vec![bytes(in_frame, "in its frame"), bytes(in_all, "in all frames")];
    for (format, [with, without]) in FrameFormat::ALL.into_iter().zip(best) {
        let times = OursTheirs { ours: mean_ms(&with), theirs: mean_ms(&without) };
        let added = 100.0 * (times.ours / times.theirs - 1.0);
        let against = format!("whole frame, ours with the upload of {stroke}; {}", format.name());
        rows.push(ReportRow { added_percent: Some(added), ..row(against).with_times_ms(times) });
    }
    Ok(rows)
}

/// Uploads the rest of an edit after its own frame. Returns the number of bytes.
fn upload_rest_and_count_bytes<const N: usize>(
    field: &mut DensityField<N>,
    timer: &mut FrameTimer,
) -> Result<usize, Error> {
    let mut later = 0;
    while field.has_pending() {
        let uploads = collect_uploads(field, Budget::UNLIMITED);
        later += upload_bytes(&uploads);
        for (region, bytes) in uploads {
            for format in FrameFormat::ALL {
                let renderer = timer.renderer_for(VolumeFormat::of::<N, 1>(), format)?;
                renderer.upload_region(region, &bytes)?;
            }
        }
    }
    Ok(later)
}

fn upload_bytes(uploads: &Uploads) -> usize {
    uploads.iter().map(|(region, _)| region.byte_count()).sum()
}

fn collect_uploads<const N: usize>(field: &mut DensityField<N>, budget: Budget) -> Uploads {
    let mut uploads = vec![];
    field.update_textures(budget, &mut |region, bytes| uploads.push((region, bytes.to_vec())));
    uploads
}
