//! Edits against their definition on dense voxels: every voxel, every count, every column told.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use glam::{IVec3, Quat, Vec3};
use paros_core::brush::Brush;
use paros_core::edit::{BrushTooLarge, Edit, EditReport, EditScratch, Operation, apply};
use paros_core::limits::{SHELL_DEPTH, SMOOTH_LINES};
use paros_core::maps::{Axis, Column, Maps};
use paros_core::plane::Plane;
use paros_core::pose::{Pose, SUB};
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::volume::{Journal, Volume, maps_digest};
use paros_tests::models::dense::{Dense, masked_volumes};
use paros_tests::models::edit::{edited, stays_in_reach};
use proptest::prelude::*;

/// Writes down what it is told.
struct Notes {
    columns: Vec<(Axis, (usize, usize), Column)>,
    added: Dense,
}

impl<const N: usize> Journal<N> for Notes
where
    Grid<N>: Size,
{
    fn columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        self.columns.extend(places.ones().map(|place| (axis, (line, place), old[place])));
    }

    fn added(&mut self, (y, z): (usize, usize), voxels: <Grid<N> as Size>::Row) {
        for x in voxels.ones() {
            let voxel = [x as i32, y as i32, z as i32];
            assert!(!self.added.contains(voxel), "{voxel:?} added twice");
            self.added.set(voxel, true);
        }
    }
}

struct Studio<const N: usize>
where
    Grid<N>: Size,
{
    volume: Volume<N>,
    before: Maps<N>,
    mask: Maps<N>,
    tight: Maps<N>,
    rows: Plane<N>,
    scratch: EditScratch<N>,
}

impl<const N: usize> Studio<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Studio {
            volume: Volume::new(),
            before: Maps::new(),
            mask: Maps::new(),
            tight: Maps::new(),
            rows: Plane::new(),
            scratch: EditScratch::new(),
        }
    }
}

/// A brush as it is handed to an edit.
#[derive(Clone, Debug)]
enum Shape {
    Capsule(IVec3, IVec3, i32),
    Box(IVec3, Pose),
    Sweep(IVec3, Pose, Pose),
}

impl Shape {
    fn brush(&self) -> Brush {
        match self {
            Shape::Capsule(a, b, radius) => Brush::capsule(*a, *b, *radius),
            Shape::Box(half, pose) => Brush::oriented_box(*half, pose),
            Shape::Sweep(half, from, to) => Brush::swept_box(*half, from, to),
        }
    }
}

#[derive(Clone, Debug)]
struct Stroke {
    shape: Shape,
    operation: Operation,
    mirrored: bool,
}

fn strokes(n: i32, longest: usize) -> impl Strategy<Value = Vec<Stroke>> {
    let within =
        move || [-2 * SUB..(n + 2) * SUB, -2 * SUB..(n + 2) * SUB, -2 * SUB..(n + 2) * SUB];
    let at = move || within().prop_map(IVec3::from_array);
    let on =
        move || [0..n, 0..n, 0..n].prop_map(|v| IVec3::from_array(v) * SUB + IVec3::splat(SUB / 2));
    let radius = move || prop_oneof![4 => 0..n * SUB / 3, 1 => Just(3 * SUB), 1 => 0..2 * n * SUB];
    let half = move || [0..n * SUB / 3, 0..n * SUB / 3, 0..n * SUB / 3].prop_map(IVec3::from_array);
    let pose = move || {
        (at(), [-1.0f32..1.0, -1.0..1.0, -1.0..1.0, 0.1..1.0]).prop_map(|(at, q)| Pose {
            position: at.as_vec3() / SUB as f32,
            rotation: Quat::from_array(q).normalize(),
        })
    };
    let shape = prop_oneof![
        4 => (prop_oneof![at(), on()], radius()).prop_map(|(a, r)| Shape::Capsule(a, a, r)),
        3 => (at(), at(), radius()).prop_map(|(a, b, r)| Shape::Capsule(a, b, r)),
        // The rows that its bounds and its layers claim are rounded each in its own way.
        1 => (on(), on(), 1..n / 3).prop_map(|(a, b, r)| Shape::Capsule(a, b, r * SUB - 1)),
        2 => (half(), pose()).prop_map(|(half, pose)| Shape::Box(half, pose)),
        2 => (half(), pose(), pose()).prop_map(|(half, a, b)| Shape::Sweep(half, a, b)),
    ];
    let depth = || prop_oneof![4 => 1..=SHELL_DEPTH, 1 => Just(0), 1 => Just(2)];
    let operation = prop_oneof![
        3 => depth().prop_map(|depth| Operation::Carve { depth }),
        3 => depth().prop_map(|depth| Operation::Fill { depth }),
        2 => Just(Operation::Smooth),
    ];
    let stroke = (shape, operation, any::<bool>())
        .prop_map(|(shape, operation, mirrored)| Stroke { shape, operation, mirrored });
    proptest::collection::vec(stroke, 1..=longest)
}

/// Strokes one after the other on one volume, each compared with the definition.
fn strokes_follow_the_definition<const N: usize>(
    studio: &Mutex<Studio<N>>,
    (volume, mask): &(Dense, Dense),
    strokes: &[Stroke],
) where
    Grid<N>: Size,
{
    let studio = &mut *studio.lock().unwrap_or_else(PoisonError::into_inner);
    studio.volume.set_voxels(|plane| volume.write_plane(plane));
    mask.write_maps(&mut studio.mask);
    let mut volume = volume.clone();
    for stroke in strokes {
        volume = stroke_follows_the_definition(studio, &volume, mask, stroke);
    }
}

fn stroke_follows_the_definition<const N: usize>(
    studio: &mut Studio<N>,
    volume: &Dense,
    mask: &Dense,
    Stroke { shape, operation, mirrored }: &Stroke,
) -> Dense
where
    Grid<N>: Size,
{
    let brush = shape.brush();
    let (operation, mirrored) = (*operation, *mirrored);
    let edit = Edit { brush: &brush, operation, mirrored };
    let mut notes = Notes { columns: vec![], added: Dense::new(N) };
    studio.before.copy_from(studio.volume.maps());
    let done = apply(&mut studio.volume, &studio.mask, &edit, &mut studio.scratch, &mut notes);
    let Ok(report) = done else {
        assert_eq!(done, Err(BrushTooLarge));
        assert_eq!(operation, Operation::Smooth);
        let bounds = brush.bounds(N).expect("a brush too large for the grid touches it");
        let sides = [1, 2].map(|i| bounds.hi[i] - bounds.lo[i] + 1);
        assert!(sides[0] * sides[1] > SMOOTH_LINES * N);
        assert_eq!(studio.volume.maps(), &studio.before);
        assert!(notes.columns.is_empty() && notes.added.is_empty());
        return volume.clone();
    };
    let dense = voxels_of::<N>(&brush);
    let (after, expected) = edited(volume, mask, &dense, operation, mirrored);
    assert_eq!(Dense::from_plane(studio.volume.rows()), after, "the volume");
    assert_eq!(report, expected);
    assert_eq!(report.changed(), &after != volume);
    after.write_maps(&mut studio.tight);
    assert_eq!(studio.volume.maps(), &studio.tight, "tight hulls");
    studio.rows.expand(studio.volume.maps());
    assert_eq!(studio.volume.rows(), &studio.rows, "rows are the intersection of the maps");
    assert_eq!(studio.volume.digest(), maps_digest(studio.volume.maps()));
    assert_eq!(notes.added, after.without(volume), "added");
    columns_are_the_changes(&notes, &studio.before, studio.volume.maps());
    stays_in_reach(volume, mask, &after, &dense, operation, mirrored);
    after
}

fn voxels_of<const N: usize>(brush: &Brush) -> Dense
where
    Grid<N>: Size,
{
    let mut dense = Dense::new(N);
    for (y, z) in (0..N * N).map(|i| (i / N, i % N)) {
        let row = brush.row::<N>(y, z);
        row.ones().for_each(|x| dense.set([x as i32, y as i32, z as i32], true));
    }
    dense
}

/// Each changed column is told once, with what it held before.
fn columns_are_the_changes<const N: usize>(notes: &Notes, before: &Maps<N>, after: &Maps<N>) {
    let mut told = BTreeMap::new();
    for &(axis, at, old) in &notes.columns {
        assert!(told.insert((axis as u8, at), old).is_none(), "{axis:?} {at:?} told twice");
    }
    for axis in Axis::ALL {
        for at in (0..N * N).map(|i| (i / N, i % N)) {
            let (old, new) = (before.column(axis, at), after.column(axis, at));
            let expected = (old != new).then_some(old);
            assert_eq!(told.get(&(axis as u8, at)).copied(), expected, "{axis:?} {at:?}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn strokes_on_16_follow_the_definition(start in masked_volumes(16), strokes in strokes(16, 4)) {
        static STUDIO: Mutex<Studio<16>> = Mutex::new(Studio::new());
        strokes_follow_the_definition(&STUDIO, &start, &strokes);
    }

    #[test]
    fn mirrored_strokes_on_a_mirrored_16_stay_mirrored(start in masked_volumes(16), strokes in strokes(16, 3)) {
        static STUDIO: Mutex<Studio<16>> = Mutex::new(Studio::new());
        let (volume, mask) = start;
        let start = (volume.or(&volume.mirrored()).closure(), mask.or(&mask.mirrored()).closure());
        let strokes: Vec<_> = strokes.into_iter().map(|stroke| Stroke { mirrored: true, ..stroke }).collect();
        strokes_follow_the_definition(&STUDIO, &start, &strokes);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(120))]

    #[test]
    fn strokes_on_32_follow_the_definition(start in masked_volumes(32), strokes in strokes(32, 4)) {
        static STUDIO: Mutex<Studio<32>> = Mutex::new(Studio::new());
        strokes_follow_the_definition(&STUDIO, &start, &strokes);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    #[test]
    fn strokes_on_64_follow_the_definition(start in masked_volumes(64), strokes in strokes(64, 3)) {
        static STUDIO: Mutex<Studio<64>> = Mutex::new(Studio::new());
        strokes_follow_the_definition(&STUDIO, &start, &strokes);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    #[test]
    fn strokes_on_128_follow_the_definition(start in masked_volumes(128), strokes in strokes(128, 2)) {
        static STUDIO: Mutex<Studio<128>> = Mutex::new(Studio::new());
        strokes_follow_the_definition(&STUDIO, &start, &strokes);
    }
}

/// Strokes in a corner of nothing: the volume is one of 32 voxels a side, `shift` voxels along x.
fn strokes_far_along_x_do_the_same<const N: usize>(
    studio: &Mutex<Studio<N>>,
    (volume, mask): &(Dense, Dense),
    shift: i32,
    strokes: &[Stroke],
) where
    Grid<N>: Size,
{
    let studio = &mut *studio.lock().unwrap_or_else(PoisonError::into_inner);
    let shifted = |dense: &Dense| {
        let mut far = Dense::new(N);
        dense.occupied().for_each(|[x, y, z]| far.set([x + shift, y, z], true));
        far
    };
    studio.volume.set_voxels(|plane| shifted(volume).write_plane(plane));
    shifted(mask).write_maps(&mut studio.mask);
    let mut volume = volume.clone();
    for Stroke { shape, operation, .. } in strokes {
        let Shape::Capsule(a, b, radius) = *shape else { continue };
        let voxels = voxels_of::<32>(&Brush::capsule(a, b, radius));
        let away = IVec3::new(shift * SUB, 0, 0);
        let brush = Brush::capsule(a + away, b + away, radius);
        let edit = Edit { brush: &brush, operation: *operation, mirrored: false };
        let mut notes = Notes { columns: vec![], added: Dense::new(N) };
        studio.before.copy_from(studio.volume.maps());
        let report =
            apply(&mut studio.volume, &studio.mask, &edit, &mut studio.scratch, &mut notes);
        let (after, expected) = edited(&volume, mask, &voxels, *operation, false);
        assert_eq!(report, Ok(expected));
        let rows = studio.volume.rows();
        let is_occupied =
            |[x, y, z]: [i32; 3]| rows.contains([x + shift, y, z].map(|i| i as usize));
        assert!(after.occupied().all(is_occupied));
        assert_eq!(rows.count(), u64::from(after.count()));
        let added = after.without(&volume);
        assert!(added.occupied().all(|[x, y, z]| notes.added.contains([x + shift, y, z])));
        assert_eq!(notes.added.count(), added.count());
        studio.volume.rows().hulls(&mut studio.tight);
        assert_eq!(studio.volume.maps(), &studio.tight, "tight hulls");
        assert_eq!(studio.volume.digest(), maps_digest(studio.volume.maps()));
        columns_are_the_changes(&notes, &studio.before, studio.volume.maps());
        volume = after;
    }
}

/// Brushes that lie within a grid of 32 with all that they look at: at most 4 voxels beyond.
fn inner_strokes() -> impl Strategy<Value = Vec<Stroke>> {
    let at =
        || [12 * SUB..20 * SUB, 12 * SUB..20 * SUB, 12 * SUB..20 * SUB].prop_map(IVec3::from_array);
    let shape = (at(), at(), 0..8 * SUB).prop_map(|(a, b, radius)| Shape::Capsule(a, b, radius));
    let shape = prop_oneof![shape, (at(), 0..8 * SUB).prop_map(|(a, r)| Shape::Capsule(a, a, r))];
    let depth = || 0..=SHELL_DEPTH;
    let operation = prop_oneof![
        depth().prop_map(|depth| Operation::Carve { depth }),
        depth().prop_map(|depth| Operation::Fill { depth }),
        Just(Operation::Smooth),
    ];
    let stroke = (shape, operation).prop_map(|(shape, operation)| Stroke {
        shape,
        operation,
        mirrored: false,
    });
    proptest::collection::vec(stroke, 1..6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(80))]

    /// An edit works on the words of a row that it touches: any of them, and across their borders.
    #[test]
    fn strokes_in_any_words_of_a_row_do_the_same(
        start in masked_volumes(32), shift in prop_oneof![0..=96i32, 36..=60i32], far in 0..=224i32, strokes in inner_strokes(),
    ) {
        static STUDIO: Mutex<Studio<128>> = Mutex::new(Studio::new());
        static LARGE: Mutex<Studio<256>> = Mutex::new(Studio::new());
        strokes_far_along_x_do_the_same(&STUDIO, &start, shift, &strokes);
        if far % 16 == 0 {
            strokes_far_along_x_do_the_same(&LARGE, &start, far, &strokes);
        }
    }
}

/// One stroke across the whole of the largest grid, of which only the border is not word-aligned.
#[test]
fn a_stroke_across_256_follows_the_definition() {
    static STUDIO: Mutex<Studio<256>> = Mutex::new(Studio::new());
    let volume = Dense::from_fn(256, |[x, y, z]| {
        [x, y, z].iter().map(|i| (i - 128) * (i - 128)).sum::<i32>() < 120 * 120 || y < 20
    });
    let start = (volume.closure(), Dense::from_fn(256, |[x, y, _]| y < 2 && x < 99));
    let shape = Shape::Capsule(IVec3::splat(3 * SUB), IVec3::splat(250 * SUB), 9 * SUB + 77);
    let stroke = |operation, mirrored| Stroke { shape: shape.clone(), operation, mirrored };
    let strokes = [
        stroke(Operation::Carve { depth: 4 }, false),
        stroke(Operation::Carve { depth: 3 }, true),
        stroke(Operation::Fill { depth: 2 }, true),
    ];
    strokes_follow_the_definition(&STUDIO, &start, &strokes);
}

#[test]
fn paste_never_floats_but_stands_on_the_ground() {
    static STUDIO: Mutex<Studio<16>> = Mutex::new(Studio::new());
    let nothing = (Dense::new(16), Dense::new(16));
    let all = Shape::Capsule(IVec3::splat(8 * SUB), IVec3::splat(8 * SUB), 99 * SUB);
    let stroke = Stroke { shape: all, operation: Operation::Fill { depth: 2 }, mirrored: false };
    strokes_follow_the_definition(&STUDIO, &nothing, &[stroke]);
    let studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let laid = Dense::from_plane(studio.volume.rows());
    assert_eq!(laid, Dense::from_fn(16, |[_, y, _]| y < 2));
}

#[test]
fn a_brush_beside_the_grid_does_nothing() {
    static STUDIO: Mutex<Studio<16>> = Mutex::new(Studio::new());
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    let Studio { volume, mask, scratch, .. } = &mut *studio;
    volume.set_voxels(|plane| Dense::from_fn(16, |_| true).write_plane(plane));
    let digest = volume.digest();
    let beside = Pose { position: Vec3::new(-9.0, 3.0, 3.0), rotation: Quat::IDENTITY };
    let brush = Brush::oriented_box(IVec3::splat(2 * SUB), &beside);
    for mirrored in [false, true] {
        let edit = Edit { brush: &brush, operation: Operation::Carve { depth: 2 }, mirrored };
        assert_eq!(apply(volume, mask, &edit, scratch, &mut ()), Ok(EditReport::default()));
    }
    assert_eq!(volume.digest(), digest);
}
