//! Undo and redo against whole copies of the maps, with island removals in between.

use std::sync::Mutex;

use paros_core::size::{Grid, Size};
use paros_tests::models::undo_bench::{Bench, Clear, Touch, stroke};
use proptest::prelude::*;

#[derive(Clone, Debug)]
enum Step {
    /// A stroke: edits, with islands cleared after some of them, perhaps after the next began.
    Stroke {
        edits: Vec<Touch>,
        clear: Clear,
    },
    Undo,
    Redo,
    Save,
}

fn steps(n: i32, most: usize) -> impl Strategy<Value = Vec<Step>> {
    let touch = ([0..n, 0..n, 0..n], 0..n, any::<bool>()).prop_map(|(at, radius, fill)| Touch {
        at,
        radius,
        fill,
    });
    let clear = prop_oneof![Just(Clear::Never), Just(Clear::AtEnd), Just(Clear::Late)];
    let stroke = (proptest::collection::vec(touch, 0..5), clear)
        .prop_map(|(edits, clear)| Step::Stroke { edits, clear });
    let step = prop_oneof![6 => stroke, 3 => Just(Step::Undo), 2 => Just(Step::Redo), 1 => Just(Step::Save)];
    proptest::collection::vec(step, 1..most)
}

fn check_steps<const N: usize>(bench: &Mutex<Bench<N>>, steps: &[Step]) -> Result<(), TestCaseError>
where
    Grid<N>: Size,
{
    let mut bench = bench.lock().unwrap_or_else(|e| e.into_inner());
    let mut history = bench.reset();
    for step in steps {
        match step {
            Step::Stroke { edits, clear } => stroke(&mut bench, &mut history, edits, *clear),
            Step::Undo => prop_assert_eq!(bench.step(true)?, history.undo().is_some()),
            Step::Redo => prop_assert_eq!(bench.step(false)?, history.redo().is_some()),
            Step::Save => bench.check_saved()?,
        }
        let (undoable, redoable) = bench.undo.counts();
        prop_assert!(undoable >= history.counts().0.min(2), "two entries always fit");
        prop_assert!(undoable <= history.counts().0);
        history.forget(undoable);
        prop_assert_eq!(redoable, history.counts().1);
        prop_assert_eq!(bench.undo.digest(), bench.undo.recompute_digest());
    }
    while let Some(maps) = history.undo() {
        prop_assert!(bench.step(true)?);
        bench.check(maps)?;
    }
    prop_assert!(!bench.step(true)?);
    while let Some(maps) = history.redo() {
        prop_assert!(bench.step(false)?);
        bench.check(maps)?;
    }
    prop_assert!(!bench.step(false)?);
    bench.check_saved()
}

static STEPS_16: Mutex<Bench<16>> = Mutex::new(Bench::new());
static STEPS_32: Mutex<Bench<32>> = Mutex::new(Bench::new());
static STEPS_128: Mutex<Bench<128>> = Mutex::new(Bench::new());

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]
    #[test]
    fn strokes_16(steps in steps(16, 40)) {
        check_steps(&STEPS_16, &steps)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn strokes_32(steps in steps(32, 60)) {
        check_steps(&STEPS_32, &steps)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]
    #[test]
    fn strokes_128(steps in steps(128, 12)) {
        check_steps(&STEPS_128, &steps)?;
    }
}

/// A stroke that changes nothing leaves no entry, and doesn't drop what was undone.
#[test]
fn idle_stroke() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let mut history = bench.reset();
    let dent = Touch { at: [8, 11, 8], radius: 5, fill: false };
    stroke(&mut bench, &mut history, std::slice::from_ref(&dent), Clear::Never);
    assert!(bench.step(true).unwrap());
    stroke(
        &mut bench,
        &mut history,
        &[Touch { at: [8, 15, 8], radius: 1, fill: false }],
        Clear::Never,
    );
    assert_eq!(bench.undo.counts(), (0, 1));
    stroke(&mut bench, &mut history, &[dent], Clear::Never);
    assert_eq!(bench.undo.counts(), (1, 0));
}
