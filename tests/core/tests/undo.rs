//! Undo and redo against complete copies of the maps, with island removals in between.

use std::sync::Mutex;

use glam::IVec3;
use paros_core::Brush;
use paros_core::edit::{EditOperation, SUBUNITS_PER_VOXEL, UndoCounts};
use paros_core::volume::{Grid, Size};
use paros_models::cases::random_cases;
use paros_models::undo_harness::{IslandClearing, SphereEdit, UndoHarness, apply_stroke};
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum UndoAction {
    /// A stroke: edits, with islands cleared after some of them, perhaps only after the next stroke has
    /// begun.
    Stroke {
        edits: Vec<SphereEdit>,
        clear: IslandClearing,
    },
    Undo,
    Redo,
    Save,
}

fn any_actions(n: i32, most: usize) -> impl Strategy<Value = Vec<UndoAction>> {
    let touch = ([0..n, 0..n, 0..n], 0..n, any::<bool>())
        .prop_map(|(at, radius, fill)| SphereEdit { at, radius, fill });
    let clear = prop_oneof![
        Just(IslandClearing::Never),
        Just(IslandClearing::AtEnd),
        Just(IslandClearing::Late)
    ];
    let stroke = (proptest::collection::vec(touch, 0..5), clear)
        .prop_map(|(edits, clear)| UndoAction::Stroke { edits, clear });
    let step = prop_oneof![6 => stroke, 3 => Just(UndoAction::Undo), 2 => Just(UndoAction::Redo), 1 => Just(UndoAction::Save)];
    proptest::collection::vec(step, 1..most)
}

fn check_actions<const N: usize>(
    harness: &Mutex<UndoHarness<N>>,
    steps: &[UndoAction],
) -> Result<(), TestCaseError>
where
    Grid<N>: Size,
{
    let mut harness = harness.lock().unwrap_or_else(|e| e.into_inner());
    let mut history = harness.reset_to_block();
    for step in steps {
        match step {
            UndoAction::Stroke { edits, clear } => {
                apply_stroke(&mut harness, &mut history, edits, *clear);
            }
            UndoAction::Undo => {
                prop_assert_eq!(harness.try_undo_checked()?, history.undo().is_some());
            }
            UndoAction::Redo => {
                prop_assert_eq!(harness.try_redo_checked()?, history.redo().is_some());
            }
            UndoAction::Save => harness.check_save_round_trip()?,
        }
        let UndoCounts { undoable, redoable } = harness.undo.undo_counts();
        prop_assert!(undoable >= history.stroke_counts().undoable.min(2), "two entries always fit");
        prop_assert!(undoable <= history.stroke_counts().undoable);
        history.drop_oldest_until_undoable(undoable);
        prop_assert_eq!(redoable, history.stroke_counts().redoable);
        prop_assert_eq!(harness.undo.digest(), harness.undo.recompute_digest());
    }
    while let Some(maps) = history.undo() {
        prop_assert!(harness.try_undo_checked()?);
        harness.check_volume_equals(maps)?;
    }
    prop_assert!(!harness.try_undo_checked()?);
    while let Some(maps) = history.redo() {
        prop_assert!(harness.try_redo_checked()?);
        harness.check_volume_equals(maps)?;
    }
    prop_assert!(!harness.try_redo_checked()?);
    harness.check_save_round_trip()
}

static STEPS_16: Mutex<UndoHarness<16>> = Mutex::new(UndoHarness::new());
static STEPS_32: Mutex<UndoHarness<32>> = Mutex::new(UndoHarness::new());
static STEPS_128: Mutex<UndoHarness<128>> = Mutex::new(UndoHarness::new());

proptest! {
    #![proptest_config(random_cases(300))]
    #[test]
    fn strokes_16(steps in any_actions(16, 40)) {
        check_actions(&STEPS_16, &steps)?;
    }
}

proptest! {
    #![proptest_config(random_cases(30))]
    #[test]
    fn strokes_32(steps in any_actions(32, 60)) {
        check_actions(&STEPS_32, &steps)?;
    }
}

proptest! {
    #![proptest_config(random_cases(1))]
    #[test]
    fn strokes_128(steps in any_actions(128, 12)) {
        check_actions(&STEPS_128, &steps)?;
    }
}

/// A stroke that changes nothing adds no entry and keeps the redo history.
#[test]
fn idle_stroke() {
    static HARNESS: Mutex<UndoHarness<16>> = Mutex::new(UndoHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let mut history = harness.reset_to_block();
    let dent = SphereEdit { at: [8, 11, 8], radius: 5, fill: false };
    apply_stroke(&mut harness, &mut history, std::slice::from_ref(&dent), IslandClearing::Never);
    assert!(harness.try_undo_checked().unwrap());
    apply_stroke(
        &mut harness,
        &mut history,
        &[SphereEdit { at: [8, 15, 8], radius: 1, fill: false }],
        IslandClearing::Never,
    );
    assert_eq!(harness.undo.undo_counts(), UndoCounts { undoable: 0, redoable: 1 });
    apply_stroke(&mut harness, &mut history, &[dent], IslandClearing::Never);
    assert_eq!(harness.undo.undo_counts(), UndoCounts { undoable: 1, redoable: 0 });
}

/// Edits after an undo or a redo in the same pull of the trigger form a separate entry.
#[test]
fn undo_and_redo_end_the_stroke() {
    static HARNESS: Mutex<UndoHarness<16>> = Mutex::new(UndoHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let carve = |harness: &mut UndoHarness<16>, x: i32| {
        let centre = IVec3::new(x, 12, 8) * SUBUNITS_PER_VOXEL;
        let brush = Brush::sphere(centre, 2 * SUBUNITS_PER_VOXEL);
        let report = harness.apply_edit(&brush, EditOperation::Carve { depth: 4 });
        assert!(report.unwrap().removed > 0);
    };
    let _ = harness.reset_to_block();
    harness.undo.begin_stroke();
    carve(&mut harness, 3);
    let first = harness.volume.maps().clone();
    assert!(harness.try_undo_checked().unwrap());
    assert!(harness.try_redo_checked().unwrap());
    harness.check_volume_equals(&first).unwrap();
    carve(&mut harness, 12);
    assert_eq!(harness.undo.undo_counts(), UndoCounts { undoable: 2, redoable: 0 });
    assert!(harness.try_undo_checked().unwrap());
    harness.check_volume_equals(&first).unwrap();
}
