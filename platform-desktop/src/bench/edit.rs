//! `bench edit`: spheres at the surface, carved and filled, against a grid of bytes.

use std::cell::RefCell;

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::edit::{Edit, Operation, apply};
use paros_core::maps::Axis;
use paros_core::plane::Plane;
use paros_core::pose::SUB;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::tick::Log;

use super::clock::{duel, timed};
use super::dense::DenseGrid;
use super::rig::{Rig, Rigged, reset};
use super::row::Row;
use super::subject::Subject;
use crate::error::Error;

/// In voxels.
pub(super) const RADIUS: i32 = 6;

/// Layers of the shell that may go.
const DEPTH: usize = 2;

/// Places on the surface, one edit each.
const PLACES: usize = 64;

pub(super) const CARVE: Operation = Operation::Carve { depth: DEPTH };
const FILL: Operation = Operation::Fill { depth: DEPTH };

pub(super) fn rows<const N: usize>(subject: &Subject, runs: usize) -> Result<Vec<Row>, Error>
where
    Grid<N>: Size + Rigged<N>,
{
    let rig = &mut *Grid::<N>::rig();
    subject.load(&mut rig.start, &mut rig.plane)?;
    let places = surface(&rig.plane);
    agree(rig, &places, subject.name())?;
    let rig = RefCell::new(rig);
    let (mut fill, mut strokes) = (f64::INFINITY, f64::INFINITY);
    let times = duel(
        runs,
        || {
            let rig = &mut **rig.borrow_mut();
            fill = fill.min(edits(rig, &places, FILL));
            strokes = strokes.min(edits_of_a_stroke_each(rig, &places, CARVE));
            Ok::<_, Error>(edits(rig, &places, CARVE))
        },
        || {
            let mut grid = DenseGrid::new(&rig.borrow().start);
            let carve =
                |place: &[usize; 3]| grid.carve_sphere(middle(*place), RADIUS as f32, DEPTH);
            let whole = timed(|| places.iter().for_each(carve));
            Ok(whole / places.len() as f64)
        },
    )?;
    let row = |against: &str| Row::new("edit", subject.name(), N, against);
    Ok(vec![
        row("a dense carve of radius 6, maps recomputed").times(times),
        row("the same, ours a fill").times([fill, times[1]]),
        row("the same, ours a stroke each, with as many to undo as fit").times([strokes, times[1]]),
    ])
}

/// The same carve at both sizes. The ratio is the small grid's time over the large one's.
pub(super) fn scaling(subject: &Subject, runs: usize) -> Result<Vec<Row>, Error> {
    let (small, large) = (&mut *Grid::<128>::rig(), &mut *Grid::<256>::rig());
    subject.load(&mut small.start, &mut small.plane)?;
    subject.load(&mut large.start, &mut large.plane)?;
    let (in_small, in_large) = (surface(&small.plane), surface(&large.plane));
    let times = duel(
        runs,
        || Ok::<_, Error>(edits(large, &in_large, CARVE)),
        || Ok(edits(small, &in_small, CARVE)),
    )?;
    Ok(vec![Row::new("edit", subject.name(), 256, "ours at 128, the same radius").times(times)])
}

/// Voxels of the surface above the ground layer, evenly spaced in the order of y, z, x.
pub(super) fn surface<const N: usize>(plane: &Plane<N>) -> Vec<[usize; 3]>
where
    Grid<N>: Size,
{
    let mut all = vec![];
    for y in 1..N - 1 {
        for z in 1..N - 1 {
            let here = plane.row(y, z);
            let inner = here.up()
                & here.down()
                & plane.row(y - 1, z)
                & plane.row(y + 1, z)
                & plane.row(y, z - 1)
                & plane.row(y, z + 1);
            all.extend((here & !inner).ones().map(|x| [x, y, z]));
        }
    }
    let count = all.len().min(PLACES);
    (0..count).map(|i| all[(2 * i + 1) * all.len() / (2 * count)]).collect()
}

/// Milliseconds of an edit, one at each place, all one stroke from the start on.
fn edits<const N: usize>(rig: &mut Rig<N>, places: &[[usize; 3]], operation: Operation) -> f64
where
    Grid<N>: Size,
{
    reset(rig);
    let whole = timed(|| {
        rig.undo.begin_stroke();
        for place in places {
            edit(rig, *place, operation);
        }
    });
    whole / places.len() as f64
}

/// The same with a stroke for each. It is the third round that counts, when the oldest strokes must
/// make room for every new one.
fn edits_of_a_stroke_each<const N: usize>(
    rig: &mut Rig<N>,
    places: &[[usize; 3]],
    operation: Operation,
) -> f64
where
    Grid<N>: Size,
{
    reset(rig);
    let mut whole = 0.0;
    for _ in 0..3 {
        rig.volume.set_maps(&rig.start);
        whole = timed(|| {
            for place in places {
                rig.undo.begin_stroke();
                edit(rig, *place, operation);
            }
        });
    }
    whole / places.len() as f64
}

/// What the world does for an edit: the edit itself with undo, dirty rectangles and islands told,
/// digest kept up.
pub(super) fn edit<const N: usize>(rig: &mut Rig<N>, place: [usize; 3], operation: Operation)
where
    Grid<N>: Size,
{
    rig.dirty.clear();
    let [x, y, z] = place.map(|i| i as i32 * SUB + SUB / 2);
    let brush = Brush::sphere(IVec3::new(x, y, z), RADIUS * SUB);
    let edit = Edit { brush: &brush, operation, mirrored: false };
    let mut log = Log { undo: &mut rig.undo, dirty: &mut rig.dirty, islands: &mut rig.islands };
    let report = apply(&mut rig.volume, &rig.mask, &edit, &mut rig.scratch, &mut log);
    rig.dirty.close();
    if report.is_ok_and(|report| report.changed()) {
        rig.islands.edited();
    }
}

/// Some of the carves, each from the start, must leave both sides with the same maps.
fn agree<const N: usize>(rig: &mut Rig<N>, places: &[[usize; 3]], name: &str) -> Result<(), Error>
where
    Grid<N>: Size,
{
    for &place in places.iter().step_by(PLACES / 2) {
        reset(rig);
        edit(rig, place, CARVE);
        let mut grid = DenseGrid::new(&rig.start);
        grid.carve_sphere(middle(place), RADIUS as f32, DEPTH);
        let columns = Axis::ALL.into_iter().flat_map(|axis| (0..N * N).map(move |i| (axis, i)));
        for (axis, i) in columns {
            let at = (i / N, i % N);
            if rig.volume.maps().column(axis, at).0[0] != grid.range(axis, at) {
                let what = format!("{name} at {N}: carves at {place:?} differ");
                return Err(Error::Failure(what));
            }
        }
    }
    Ok(())
}

fn middle(place: [usize; 3]) -> [f32; 3] {
    place.map(|i| i as f32 + 0.5)
}
