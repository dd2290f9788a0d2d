//! `bench edit`: spheres at the surface, carved and filled, against a grid of bytes.

use std::cell::RefCell;

use glam::IVec3;
use paros_core::edit::{EditOperation, SUBUNITS_PER_VOXEL};
use paros_core::internals::StrokeJournal;
use paros_core::volume::{Axis, BitGrid, BitSet, Grid, Size};
use paros_core::{Brush, Edit, apply_edit};
use paros_headless::Error;

use super::clock::{OursTheirs, min_in_turns_ms, time_ms};
use super::dense::DenseGrid;
use super::fixture::{Fixture, HasFixture, restore_start_volume};
use super::row::ReportRow;
use super::subject::BenchSubject;

/// Radius of the spheres, in voxels.
pub(super) const RADIUS: i32 = 6;

/// Maximum number of surface layers that a carve removes.
const DEPTH: usize = 2;

/// Number of edits, each at another voxel of the surface.
const EDITS: usize = 64;

pub(super) const CARVE: EditOperation = EditOperation::Carve { depth: DEPTH };
pub(super) const FILL: EditOperation = EditOperation::Fill { depth: DEPTH };

pub(super) fn measure_rows<const N: usize>(
    subject: &BenchSubject,
    runs: usize,
) -> Result<Vec<ReportRow>, Error>
where
    Grid<N>: Size + HasFixture<N>,
{
    let fixture = &mut *Grid::<N>::lock_fixture();
    subject.load_into(&mut fixture.start, &mut fixture.bit_grid)?;
    let voxels = sample_surface_voxels(&fixture.bit_grid);
    check_agreement(fixture, &voxels, subject.name())?;
    let fixture = RefCell::new(fixture);
    let (mut fill, mut strokes) = (f64::INFINITY, f64::INFINITY);
    let times = min_in_turns_ms(
        runs,
        || {
            let fixture = &mut **fixture.borrow_mut();
            fill = fill.min(mean_edit_in_one_stroke_ms(fixture, &voxels, FILL));
            strokes = strokes.min(mean_edit_with_a_stroke_each_ms(fixture, &voxels, CARVE));
            Ok::<_, Error>(mean_edit_in_one_stroke_ms(fixture, &voxels, CARVE))
        },
        || {
            let mut grid = DenseGrid::new(&fixture.borrow().start);
            let carve =
                |voxel: &[usize; 3]| grid.carve_sphere(voxel_centre(*voxel), RADIUS as f32, DEPTH);
            let whole = time_ms(|| voxels.iter().for_each(carve));
            Ok(whole / voxels.len() as f64)
        },
    )?;
    let row = |against: &str| ReportRow::new("edit", subject.name(), N, against);
    Ok(vec![
        row("a dense carve of radius 6, maps recomputed").with_times_ms(times),
        row("the same, ours a fill").with_times_ms(OursTheirs { ours: fill, ..times }),
        row("the same, ours a stroke each, with as many to undo as fit")
            .with_times_ms(OursTheirs { ours: strokes, ..times }),
    ])
}

/// Times the same carve at both grid sizes. The ratio is the small grid's time over the large one's.
pub(super) fn measure_scaling(
    subject: &BenchSubject,
    runs: usize,
) -> Result<Vec<ReportRow>, Error> {
    let (small, large) = (&mut *Grid::<128>::lock_fixture(), &mut *Grid::<256>::lock_fixture());
    subject.load_into(&mut small.start, &mut small.bit_grid)?;
    subject.load_into(&mut large.start, &mut large.bit_grid)?;
    let (in_small, in_large) =
        (sample_surface_voxels(&small.bit_grid), sample_surface_voxels(&large.bit_grid));
    let times = min_in_turns_ms(
        runs,
        || Ok::<_, Error>(mean_edit_in_one_stroke_ms(large, &in_large, CARVE)),
        || Ok(mean_edit_in_one_stroke_ms(small, &in_small, CARVE)),
    )?;
    Ok(vec![
        ReportRow::new("edit", subject.name(), 256, "ours at 128, the same radius")
            .with_times_ms(times),
    ])
}

/// Returns voxels of the surface above the ground layer, evenly spaced in the order of y, z, x.
pub(super) fn sample_surface_voxels<const N: usize>(bit_grid: &BitGrid<N>) -> Vec<[usize; 3]>
where
    Grid<N>: Size,
{
    let mut all = vec![];
    for y in 1..N - 1 {
        for z in 1..N - 1 {
            let here = bit_grid.row(y, z);
            let inner = here.shifted_up()
                & here.shifted_down()
                & bit_grid.row(y - 1, z)
                & bit_grid.row(y + 1, z)
                & bit_grid.row(y, z - 1)
                & bit_grid.row(y, z + 1);
            all.extend((here & !inner).iter_ones().map(|x| [x, y, z]));
        }
    }
    let count = all.len().min(EDITS);
    (0..count).map(|i| all[(2 * i + 1) * all.len() / (2 * count)]).collect()
}

/// Returns the mean milliseconds of an edit: one at each voxel, all in one stroke.
pub(super) fn mean_edit_in_one_stroke_ms<const N: usize, const K: usize>(
    fixture: &mut Fixture<N, K>,
    voxels: &[[usize; 3]],
    operation: EditOperation,
) -> f64
where
    Grid<N>: Size,
{
    restore_start_volume(fixture);
    let whole = time_ms(|| {
        fixture.undo.begin_stroke();
        for voxel in voxels {
            try_edit_sphere_at(fixture, *voxel, operation);
        }
    });
    whole / voxels.len() as f64
}

/// Like [`mean_edit_in_one_stroke_ms`], with a stroke for each edit. The third round counts: the undo history
/// is full by then, and every new stroke evicts the oldest.
fn mean_edit_with_a_stroke_each_ms<const N: usize>(
    fixture: &mut Fixture<N>,
    voxels: &[[usize; 3]],
    operation: EditOperation,
) -> f64
where
    Grid<N>: Size,
{
    restore_start_volume(fixture);
    let mut whole = 0.0;
    for _ in 0..3 {
        fixture.volume.set_maps(&fixture.start);
        whole = time_ms(|| {
            for voxel in voxels {
                fixture.undo.begin_stroke();
                try_edit_sphere_at(fixture, *voxel, operation);
            }
        });
    }
    whole / voxels.len() as f64
}

/// Makes an edit as the world does: with undo, dirty rectangles, island search and digest kept up to date.
pub(super) fn try_edit_sphere_at<const N: usize, const K: usize>(
    fixture: &mut Fixture<N, K>,
    voxel: [usize; 3],
    operation: EditOperation,
) where
    Grid<N>: Size,
{
    let [x, y, z] = voxel.map(|i| i as i32 * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2);
    let brush = Brush::sphere(IVec3::new(x, y, z), RADIUS * SUBUNITS_PER_VOXEL);
    try_edit(fixture, &brush, operation);
}

/// Makes such an edit with any brush. Returns `true` if the volume changed.
pub(super) fn try_edit<const N: usize, const K: usize>(
    fixture: &mut Fixture<N, K>,
    brush: &Brush,
    operation: EditOperation,
) -> bool
where
    Grid<N>: Size,
{
    fixture.dirty.clear();
    let edit = Edit { brush, operation, mirrored: false };
    let mut log = StrokeJournal {
        undo: &mut fixture.undo,
        dirty: &mut fixture.dirty,
        islands: &mut fixture.islands,
    };
    let report =
        apply_edit(&mut fixture.volume, &fixture.mask, &edit, &mut fixture.scratch, &mut log);
    fixture.dirty.end_edit();
    let changed = report.is_ok_and(|report| report.changed_volume());
    if changed {
        fixture.islands.request_pass();
    }
    changed
}

/// Checks that some of the carves, each on the start volume, give both sides the same maps.
fn check_agreement<const N: usize>(
    fixture: &mut Fixture<N>,
    voxels: &[[usize; 3]],
    name: &str,
) -> Result<(), Error>
where
    Grid<N>: Size,
{
    for &voxel in voxels.iter().step_by(EDITS / 2) {
        restore_start_volume(fixture);
        try_edit_sphere_at(fixture, voxel, CARVE);
        let mut grid = DenseGrid::new(&fixture.start);
        grid.carve_sphere(voxel_centre(voxel), RADIUS as f32, DEPTH);
        let columns = Axis::ALL.into_iter().flat_map(|axis| (0..N * N).map(move |i| (axis, i)));
        for (axis, i) in columns {
            let at = (i / N, i % N);
            if fixture.volume.maps().column(axis, at).range(0) != grid.column_range(axis, at) {
                let what = format!("{name} at {N}: carves at {voxel:?} differ");
                return Err(Error::Failure(what));
            }
        }
    }
    Ok(())
}

fn voxel_centre(voxel: [usize; 3]) -> [f32; 3] {
    voxel.map(|i| i as f32 + 0.5)
}
