//! Edits against the model: every voxel, every count of the report, every journalled column.

mod harness;
mod layers;

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use glam::{IVec3, Quat, Vec3};
use paros_core::edit::{
    ANY_DEPTH, BrushTooLarge, EditOperation, EditReport, Pose, SUBUNITS_PER_VOXEL,
};
use paros_core::internals::maps_digest;
use paros_core::limits::{SHELL_DEPTH, SMOOTH_LINES};
use paros_core::volume::{Axis, BitSet, Grid, Range, Size, VoxelBox};
use paros_core::{Brush, Edit, RangeMaps, apply_edit};
use paros_models::cases::random_cases;
use paros_models::dense::{DenseVolume, MaskedVolume, closed_volumes_with_inner_mask};
use paros_models::edit::{
    ExpectedEdit, assert_edit_invariants, assert_mirror_is_kept, expected_edit,
};
use proptest::prelude::*;

use harness::{BrushSpec, EditHarness, JournalNotes, Stroke, any_strokes};

/// Applies strokes one after the other and compares each with the model.
fn assert_strokes_follow_definition<const N: usize>(
    harness: &Mutex<EditHarness<N>>,
    MaskedVolume { volume, mask }: &MaskedVolume,
    strokes: &[Stroke],
) where
    Grid<N>: Size,
{
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    harness.volume.set_voxels(|plane| volume.insert_into_empty_bits(plane));
    mask.write_maps(&mut harness.mask);
    let mut volume = volume.clone();
    for stroke in strokes {
        volume = assert_stroke_follows_definition(harness, &volume, mask, stroke);
    }
}

fn assert_stroke_follows_definition<const N: usize>(
    harness: &mut EditHarness<N>,
    volume: &DenseVolume,
    mask: &DenseVolume,
    Stroke { shape, operation, mirrored }: &Stroke,
) -> DenseVolume
where
    Grid<N>: Size,
{
    let brush = shape.to_brush();
    let (operation, mirrored) = (*operation, *mirrored);
    let edit = Edit { brush: &brush, operation, mirrored };
    let mut notes = JournalNotes { columns: vec![], added: DenseVolume::empty(N) };
    harness.before.copy_from(harness.volume.maps());
    let done =
        apply_edit(&mut harness.volume, &harness.mask, &edit, &mut harness.scratch, &mut notes);
    let Ok(report) = done else {
        assert_eq!(done, Err(BrushTooLarge));
        assert!(matches!(operation, EditOperation::Smooth { .. } | EditOperation::Flatten { .. }));
        let bounds = brush.bounds(N).expect("a brush too large for the grid touches it");
        let sides = [1, 2].map(|i| bounds.hi[i] - bounds.lo[i] + 1);
        assert!(sides[0] * sides[1] > SMOOTH_LINES * N);
        assert_eq!(harness.volume.maps(), &harness.before);
        assert!(notes.columns.is_empty() && notes.added.is_empty());
        return volume.clone();
    };
    let dense = voxels_by_rows::<N>(&brush);
    let ExpectedEdit { after, report: expected } =
        expected_edit(volume, mask, &dense, operation, mirrored);
    assert_eq!(DenseVolume::from_bits(harness.volume.rows()), after, "the volume");
    assert_eq!(report, expected);
    assert_eq!(report.changed_volume(), &after != volume);
    after.write_maps(&mut harness.tight);
    assert_eq!(harness.volume.maps(), &harness.tight, "tight hulls");
    harness.rows.set_from_maps(harness.volume.maps());
    assert_eq!(harness.volume.rows(), &harness.rows, "rows are the intersection of the maps");
    assert_eq!(harness.volume.digest(), maps_digest(harness.volume.maps()));
    assert_eq!(notes.added, after.difference(volume), "added");
    assert_columns_are_changes(&notes, &harness.before, harness.volume.maps());
    assert_edit_invariants(volume, mask, &dense, operation, mirrored, &after);
    if mirrored {
        assert_mirror_is_kept(volume, mask, &after);
    }
    after
}

fn voxels_by_rows<const N: usize>(brush: &Brush) -> DenseVolume
where
    Grid<N>: Size,
{
    let mut dense = DenseVolume::empty(N);
    for (y, z) in (0..N * N).map(|i| (i / N, i % N)) {
        let row = brush.row_bits::<N>(y, z);
        row.iter_ones().for_each(|x| dense.set([x as i32, y as i32, z as i32], true));
    }
    dense
}

/// Asserts that each changed column is journalled once, with its old value.
fn assert_columns_are_changes<const N: usize>(
    notes: &JournalNotes,
    before: &RangeMaps<N>,
    after: &RangeMaps<N>,
) {
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
    #![proptest_config(random_cases(150))]

    #[test]
    fn strokes_on_16_follow_the_definition(start in closed_volumes_with_inner_mask(16), strokes in any_strokes(16, 4)) {
        static HARNESS: Mutex<EditHarness<16>> = Mutex::new(EditHarness::new());
        assert_strokes_follow_definition(&HARNESS, &start, &strokes);
    }

    #[test]
    fn mirrored_strokes_on_a_mirrored_16_stay_mirrored(start in closed_volumes_with_inner_mask(16), strokes in any_strokes(16, 3)) {
        static HARNESS: Mutex<EditHarness<16>> = Mutex::new(EditHarness::new());
        let MaskedVolume { volume, mask } = start;
        let start = MaskedVolume {
            volume: volume.union(&volume.mirrored_in_x()).closure(),
            mask: mask.union(&mask.mirrored_in_x()).closure(),
        };
        let strokes: Vec<_> = strokes.into_iter().map(|stroke| Stroke { mirrored: true, ..stroke }).collect();
        assert_strokes_follow_definition(&HARNESS, &start, &strokes);
    }
}

proptest! {
    #![proptest_config(random_cases(12))]

    #[test]
    fn strokes_on_32_follow_the_definition(start in closed_volumes_with_inner_mask(32), strokes in any_strokes(32, 4)) {
        static HARNESS: Mutex<EditHarness<32>> = Mutex::new(EditHarness::new());
        assert_strokes_follow_definition(&HARNESS, &start, &strokes);
    }
}

proptest! {
    #![proptest_config(random_cases(1))]

    #[test]
    fn strokes_on_64_follow_the_definition(start in closed_volumes_with_inner_mask(64), strokes in any_strokes(64, 3)) {
        static HARNESS: Mutex<EditHarness<64>> = Mutex::new(EditHarness::new());
        assert_strokes_follow_definition(&HARNESS, &start, &strokes);
    }
}

proptest! {
    #![proptest_config(random_cases(1))]

    #[test]
    fn strokes_on_128_follow_the_definition(start in closed_volumes_with_inner_mask(128), strokes in any_strokes(128, 2)) {
        static HARNESS: Mutex<EditHarness<128>> = Mutex::new(EditHarness::new());
        assert_strokes_follow_definition(&HARNESS, &start, &strokes);
    }
}

/// Translation invariance: strokes on a volume of 32^3, moved by `shift` voxels along x in a larger grid,
/// give the model's result of the unmoved strokes.
fn assert_shifted_strokes_do_the_same<const N: usize>(
    harness: &Mutex<EditHarness<N>>,
    MaskedVolume { volume, mask }: &MaskedVolume,
    shift: i32,
    strokes: &[Stroke],
) where
    Grid<N>: Size,
{
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    let shifted = |dense: &DenseVolume| {
        let mut far = DenseVolume::empty(N);
        dense.occupied().for_each(|[x, y, z]| far.set([x + shift, y, z], true));
        far
    };
    harness.volume.set_voxels(|plane| shifted(volume).insert_into_empty_bits(plane));
    shifted(mask).write_maps(&mut harness.mask);
    let mut volume = volume.clone();
    for Stroke { shape, operation, .. } in strokes {
        let BrushSpec::Capsule(a, b, radius) = *shape else { continue };
        let voxels = voxels_by_rows::<32>(&Brush::capsule(a, b, radius));
        let away = IVec3::new(shift * SUBUNITS_PER_VOXEL, 0, 0);
        let brush = Brush::capsule(a + away, b + away, radius);
        let edit = Edit { brush: &brush, operation: *operation, mirrored: false };
        let mut notes = JournalNotes { columns: vec![], added: DenseVolume::empty(N) };
        harness.before.copy_from(harness.volume.maps());
        let report =
            apply_edit(&mut harness.volume, &harness.mask, &edit, &mut harness.scratch, &mut notes);
        let ExpectedEdit { after, report: expected } =
            expected_edit(&volume, mask, &voxels, *operation, false);
        let [x, y, z] = expected.closure_box.ranges();
        let x = match x.is_empty() {
            true => x,
            false => Range::new(x.first() + shift as usize, x.last() + shift as usize),
        };
        let closure_box = VoxelBox::new([x, y, z]);
        assert_eq!(report, Ok(EditReport { closure_box, ..expected }));
        let rows = harness.volume.rows();
        let is_occupied =
            |[x, y, z]: [i32; 3]| rows.contains([x + shift, y, z].map(|i| i as usize));
        assert!(after.occupied().all(is_occupied));
        assert_eq!(rows.count_voxels(), u64::from(after.count()));
        let added = after.difference(&volume);
        assert!(added.occupied().all(|[x, y, z]| notes.added.contains([x + shift, y, z])));
        assert_eq!(notes.added.count(), added.count());
        harness.volume.rows().write_hulls(&mut harness.tight);
        assert_eq!(harness.volume.maps(), &harness.tight, "tight hulls");
        assert_eq!(harness.volume.digest(), maps_digest(harness.volume.maps()));
        assert_columns_are_changes(&notes, &harness.before, harness.volume.maps());
        volume = after;
    }
}

/// A strategy for strokes that stay at least 4 voxels inside a grid of 32^3.
fn any_inner_strokes() -> impl Strategy<Value = Vec<Stroke>> {
    let at = || {
        [
            12 * SUBUNITS_PER_VOXEL..20 * SUBUNITS_PER_VOXEL,
            12 * SUBUNITS_PER_VOXEL..20 * SUBUNITS_PER_VOXEL,
            12 * SUBUNITS_PER_VOXEL..20 * SUBUNITS_PER_VOXEL,
        ]
        .prop_map(IVec3::from_array)
    };
    let shape = (at(), at(), 0..8 * SUBUNITS_PER_VOXEL)
        .prop_map(|(a, b, radius)| BrushSpec::Capsule(a, b, radius));
    let shape = prop_oneof![
        shape,
        (at(), 0..8 * SUBUNITS_PER_VOXEL).prop_map(|(a, r)| BrushSpec::Capsule(a, a, r))
    ];
    let depth = || 0..=SHELL_DEPTH;
    let operation = prop_oneof![
        depth().prop_map(|depth| EditOperation::Carve { depth }),
        depth().prop_map(|depth| EditOperation::Fill { depth }),
        Just(EditOperation::Carve { depth: ANY_DEPTH }),
        Just(EditOperation::Fill { depth: ANY_DEPTH }),
        prop::sample::select(&[1usize, 3, 7][..])
            .prop_map(|radius| EditOperation::Smooth { radius, dither: None }),
    ];
    let stroke = (shape, operation).prop_map(|(shape, operation)| Stroke {
        shape,
        operation,
        mirrored: false,
    });
    proptest::collection::vec(stroke, 1..6)
}

proptest! {
    #![proptest_config(random_cases(10))]

    /// An edit reads only the words of a row that its brush touches. Tests any words, and brushes across word
    /// borders.
    #[test]
    fn strokes_in_any_words_of_a_row_do_the_same(
        start in closed_volumes_with_inner_mask(32), shift in prop_oneof![0..=96i32, 36..=60i32], far in 0..=224i32, strokes in any_inner_strokes(),
    ) {
        static HARNESS: Mutex<EditHarness<128>> = Mutex::new(EditHarness::new());
        static LARGE: Mutex<EditHarness<256>> = Mutex::new(EditHarness::new());
        assert_shifted_strokes_do_the_same(&HARNESS, &start, shift, &strokes);
        if far % 16 == 0 {
            assert_shifted_strokes_do_the_same(&LARGE, &start, far, &strokes);
        }
    }
}

/// Balls that end at a word's last voxel or begin at its first. Inside a block, no surface is near enough for
/// a carve.
#[test]
fn an_edit_looks_past_the_words_of_its_brush() {
    static HARNESS: Mutex<EditHarness<128>> = Mutex::new(EditHarness::new());
    let EditHarness { volume, mask, scratch, .. } = &mut *HARNESS.lock().unwrap();
    volume.set_voxels(|plane| (0..128).for_each(|y| plane.layer_mut(y).fill(Grid::<128>::FULL)));
    for (x, ends) in [(60, [57, 63]), (67, [64, 70])] {
        let centre = IVec3::new(x, 64, 64) * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2;
        let brush = Brush::sphere(centre, 3 * SUBUNITS_PER_VOXEL);
        let bounds = brush.bounds(128).expect("it lies in the grid");
        assert_eq!([bounds.lo[0], bounds.hi[0]], ends);
        let operation = EditOperation::Carve { depth: 2 };
        let edit = Edit { brush: &brush, operation, mirrored: false };
        let report = apply_edit(volume, mask, &edit, scratch, &mut ()).unwrap();
        let refused_by_depth = report.refused_by_depth;
        assert_eq!(report, EditReport { refused_by_depth, ..EditReport::default() });
        assert!(refused_by_depth > 100);
    }
}

/// One stroke across the whole largest grid, where only the grid's border isn't word-aligned.
#[test]
fn a_stroke_across_256_follows_the_definition() {
    static HARNESS: Mutex<EditHarness<256>> = Mutex::new(EditHarness::new());
    let volume = DenseVolume::from_fn(256, |[x, y, z]| {
        [x, y, z].iter().map(|i| (i - 128) * (i - 128)).sum::<i32>() < 120 * 120 || y < 20
    });
    let start = MaskedVolume {
        volume: volume.closure(),
        mask: DenseVolume::from_fn(256, |[x, y, _]| y < 2 && x < 99),
    };
    let shape = BrushSpec::Capsule(
        IVec3::splat(3 * SUBUNITS_PER_VOXEL),
        IVec3::splat(250 * SUBUNITS_PER_VOXEL),
        9 * SUBUNITS_PER_VOXEL + 77,
    );
    let stroke = |operation, mirrored| Stroke { shape: shape.clone(), operation, mirrored };
    let strokes = [
        stroke(EditOperation::Carve { depth: 4 }, false),
        stroke(EditOperation::Carve { depth: 3 }, true),
        stroke(EditOperation::Fill { depth: 2 }, true),
    ];
    assert_strokes_follow_definition(&HARNESS, &start, &strokes);
}

#[test]
fn paste_never_floats_but_stands_on_the_ground() {
    static HARNESS: Mutex<EditHarness<16>> = Mutex::new(EditHarness::new());
    let nothing = MaskedVolume { volume: DenseVolume::empty(16), mask: DenseVolume::empty(16) };
    let all = BrushSpec::Capsule(
        IVec3::splat(8 * SUBUNITS_PER_VOXEL),
        IVec3::splat(8 * SUBUNITS_PER_VOXEL),
        99 * SUBUNITS_PER_VOXEL,
    );
    let stroke =
        Stroke { shape: all, operation: EditOperation::Fill { depth: 2 }, mirrored: false };
    assert_strokes_follow_definition(&HARNESS, &nothing, &[stroke]);
    let harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    let laid = DenseVolume::from_bits(harness.volume.rows());
    assert_eq!(laid, DenseVolume::from_fn(16, |[_, y, _]| y < 2));
}

#[test]
fn a_brush_beside_the_grid_does_nothing() {
    static HARNESS: Mutex<EditHarness<16>> = Mutex::new(EditHarness::new());
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    let EditHarness { volume, mask, scratch, .. } = &mut *harness;
    volume.set_voxels(|plane| DenseVolume::from_fn(16, |_| true).insert_into_empty_bits(plane));
    let digest = volume.digest();
    let beside = Pose { position: Vec3::new(-9.0, 3.0, 3.0), rotation: Quat::IDENTITY };
    let brush = Brush::oriented_box(IVec3::splat(2 * SUBUNITS_PER_VOXEL), &beside);
    for mirrored in [false, true] {
        let edit = Edit { brush: &brush, operation: EditOperation::Carve { depth: 2 }, mirrored };
        assert_eq!(apply_edit(volume, mask, &edit, scratch, &mut ()), Ok(EditReport::default()));
    }
    assert_eq!(volume.digest(), digest);
}
