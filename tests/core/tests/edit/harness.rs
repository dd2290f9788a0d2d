//! Volumes, strokes and a journal for the tests of edits.

use glam::{IVec3, Quat};
use paros_core::edit::{
    ANY_DEPTH, Dither, EditOperation, EditScratch, HalfSpace, Pose, SUBUNITS_PER_VOXEL,
};
use paros_core::internals::{BrushPiece, FIXED_ONE};
use paros_core::limits::{MAX_FLATTENING_REACH, MAX_SMOOTHING_RADIUS, SHELL_DEPTH};
use paros_core::volume::{Axis, BitGrid, BitSet, Column, Grid, Journal, Size};
use paros_core::{Brush, RangeMaps, Volume};
use paros_models::dense::DenseVolume;
use proptest::prelude::*;

/// A journal that records everything.
pub(super) struct JournalNotes {
    pub(super) columns: Vec<(Axis, (usize, usize), Column)>,
    pub(super) added: DenseVolume,
}

impl<const N: usize> Journal<N> for JournalNotes
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        (old, _): (&[Column; N], &[Column; N]),
    ) {
        self.columns.extend(places.iter_ones().map(|place| (axis, (line, place), old[place])));
    }

    fn record_added(&mut self, (y, z): (usize, usize), voxels: <Grid<N> as Size>::Row) {
        for x in voxels.iter_ones() {
            let voxel = [x as i32, y as i32, z as i32];
            assert!(!self.added.contains(voxel), "{voxel:?} added twice");
            self.added.set(voxel, true);
        }
    }
}

pub(super) struct EditHarness<const N: usize>
where
    Grid<N>: Size,
{
    pub(super) volume: Volume<N>,
    pub(super) before: RangeMaps<N>,
    pub(super) mask: RangeMaps<N>,
    pub(super) tight: RangeMaps<N>,
    pub(super) rows: BitGrid<N>,
    pub(super) scratch: EditScratch<N>,
}

impl<const N: usize> EditHarness<N>
where
    Grid<N>: Size,
{
    pub(super) const fn new() -> Self {
        EditHarness {
            volume: Volume::new(),
            before: RangeMaps::new(),
            mask: RangeMaps::new(),
            tight: RangeMaps::new(),
            rows: BitGrid::new(),
            scratch: EditScratch::new(),
        }
    }
}

/// The parameters of a brush.
#[derive(Clone, Debug)]
pub(super) enum BrushSpec {
    Capsule(IVec3, IVec3, i32),
    Box(IVec3, Pose),
    Sweep(IVec3, Pose, Pose),
}

impl BrushSpec {
    pub(super) fn to_brush(&self) -> Brush {
        match self {
            BrushSpec::Capsule(a, b, radius) => Brush::capsule(*a, *b, *radius),
            BrushSpec::Box(half, pose) => Brush::oriented_box(*half, pose),
            BrushSpec::Sweep(half, from, to) => Brush::swept_box(*half, from, to),
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Stroke {
    pub(super) shape: BrushSpec,
    pub(super) operation: EditOperation,
    pub(super) mirrored: bool,
}

pub(super) fn any_strokes(n: i32, longest: usize) -> impl Strategy<Value = Vec<Stroke>> {
    let within = move || {
        [
            -2 * SUBUNITS_PER_VOXEL..(n + 2) * SUBUNITS_PER_VOXEL,
            -2 * SUBUNITS_PER_VOXEL..(n + 2) * SUBUNITS_PER_VOXEL,
            -2 * SUBUNITS_PER_VOXEL..(n + 2) * SUBUNITS_PER_VOXEL,
        ]
    };
    let at = move || within().prop_map(IVec3::from_array);
    let on = move || {
        [0..n, 0..n, 0..n].prop_map(|v| {
            IVec3::from_array(v) * SUBUNITS_PER_VOXEL + IVec3::splat(SUBUNITS_PER_VOXEL / 2)
        })
    };
    let radius = move || prop_oneof![4 => 0..n * SUBUNITS_PER_VOXEL / 3, 1 => Just(3 * SUBUNITS_PER_VOXEL), 1 => 0..2 * n * SUBUNITS_PER_VOXEL];
    let half = move || {
        [
            0..n * SUBUNITS_PER_VOXEL / 3,
            0..n * SUBUNITS_PER_VOXEL / 3,
            0..n * SUBUNITS_PER_VOXEL / 3,
        ]
        .prop_map(IVec3::from_array)
    };
    let pose = move || {
        (at(), [-1.0f32..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0]).prop_map(|(at, q)| Pose {
            position: at.as_vec3() / SUBUNITS_PER_VOXEL as f32,
            rotation: Quat::from_array(q).normalize(),
        })
    };
    let shape = prop_oneof![
        4 => (prop_oneof![at(), on()], radius()).prop_map(|(a, r)| BrushSpec::Capsule(a, a, r)),
        3 => (at(), at(), radius()).prop_map(|(a, b, r)| BrushSpec::Capsule(a, b, r)),
        // A capsule whose bounds and layers round their rows differently.
        1 => (on(), on(), 1..n / 3).prop_map(|(a, b, r)| BrushSpec::Capsule(a, b, r * SUBUNITS_PER_VOXEL - 1)),
        2 => (half(), pose()).prop_map(|(half, pose)| BrushSpec::Box(half, pose)),
        2 => (half(), pose(), pose()).prop_map(|(half, a, b)| BrushSpec::Sweep(half, a, b)),
    ];
    let depth =
        || prop_oneof![4 => 1..=SHELL_DEPTH, 1 => Just(0), 1 => Just(2), 1 => Just(ANY_DEPTH)];
    let operation = prop_oneof![
        3 => depth().prop_map(|depth| EditOperation::Carve { depth }),
        3 => depth().prop_map(|depth| EditOperation::Fill { depth }),
        2 => any_smoothing(n),
        2 => any_flattening(n),
    ];
    let stroke = (shape, operation, any::<bool>())
        .prop_map(|(shape, operation, mirrored)| Stroke { shape, operation, mirrored });
    proptest::collection::vec(stroke, 1..=longest)
}

/// A strategy for flattening to a plane through the grid, inclined arbitrarily or parallel to the axes.
fn any_flattening(n: i32) -> impl Strategy<Value = EditOperation> {
    let through = [0..n, 0..n, 0..n].prop_map(|at| IVec3::from_array(at) * SUBUNITS_PER_VOXEL);
    let part = || prop_oneof![2 => -FIXED_ONE..=FIXED_ONE, 1 => Just(0), 1 => Just(FIXED_ONE), 1 => Just(-FIXED_ONE)];
    let reach = prop_oneof![4 => 0..5usize, 1 => Just(MAX_FLATTENING_REACH)];
    (through, [part(), part(), part()], reach).prop_map(|(through, normal, reach)| {
        let normal = IVec3::from_array(normal);
        let offset = normal.as_i64vec3().dot(through.as_i64vec3());
        EditOperation::Flatten { above: HalfSpace { normal, offset }, reach }
    })
}

/// A strategy for smoothing with any radius, dithered in a ball or not.
fn any_smoothing(n: i32) -> impl Strategy<Value = EditOperation> {
    let at = [0..n, 0..n, 0..n].prop_map(|at| IVec3::from_array(at) * SUBUNITS_PER_VOXEL);
    let ball = (at, 0..n * SUBUNITS_PER_VOXEL / 2, any::<u64>())
        .prop_map(|(at, radius, seed)| Dither { piece: BrushPiece::sphere(at, radius), seed });
    let dither = prop_oneof![1 => Just(None), 3 => ball.prop_map(Some)];
    // A larger radius makes the model slow.
    let radius = prop_oneof![5 => Just(1), 4 => Just(3), 1 => Just(MAX_SMOOTHING_RADIUS)];
    (radius, dither).prop_map(|(radius, dither)| EditOperation::Smooth { radius, dither })
}
