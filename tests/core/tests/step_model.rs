//! `World::step` against its dense model: everything visible after a tick, the save, the digest and the dirty
//! rectangles. `PAROS_STEP_CASES` multiplies the number of sessions.

use std::cell::RefCell;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use paros_core::edit::{ANY_DEPTH, EditOperation, SUBUNITS_PER_VOXEL};
use paros_core::volume::{Grid, Size};
use paros_core::{Brush, RangeMaps};
use paros_models::cases::{random_cases, scaled_cases};
use paros_models::dense::{DenseVolume, MaskedVolume, any_voxels, closed_volumes_with_inner_mask};
use paros_models::edit::exact_edit;
use paros_models::layers::LayeredVolume;
use paros_models::step::plan::{SessionPlan, session_plans};
use paros_models::step::session::{SessionTally, StepFailure, StepHarness};
use paros_models::step::starts::scattered_boxes;
use paros_models::step::trace::StepTrace;
use paros_models::step::volume::StepVolume;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{TestError, TestRunner};

static AT_16: Mutex<StepHarness<16, 1>> = Mutex::new(StepHarness::new());
static AT_16_OF_2: Mutex<StepHarness<16, 2>> = Mutex::new(StepHarness::new());
static AT_16_OF_3: Mutex<StepHarness<16, 3>> = Mutex::new(StepHarness::new());
static AT_32: Mutex<StepHarness<32, 1>> = Mutex::new(StepHarness::new());
static AT_32_OF_2: Mutex<StepHarness<32, 2>> = Mutex::new(StepHarness::new());
static AT_64: Mutex<StepHarness<64, 1>> = Mutex::new(StepHarness::new());
static AT_64_OF_2: Mutex<StepHarness<64, 2>> = Mutex::new(StepHarness::new());
static AT_128: Mutex<StepHarness<128, 2>> = Mutex::new(StepHarness::new());
static AT_256: Mutex<StepHarness<256, 1>> = Mutex::new(StepHarness::new());

/// Runs sessions of a number of phases. A failure is shrunk and written as a trace, which
/// `a_failure_can_be_replayed` runs.
fn check_sessions<const N: usize, const K: usize>(
    harness: &Mutex<StepHarness<N, K>>,
    starts: impl Strategy<Value = MaskedVolume>,
    cases: u32,
    phases: RangeInclusive<usize>,
) -> SessionTally
where
    Grid<N>: Size,
{
    let harness = &mut *harness.lock().unwrap_or_else(PoisonError::into_inner);
    let mut config = random_cases(cases);
    if std::env::var_os("PROPTEST_MAX_SHRINK_ITERS").is_none() {
        config.max_shrink_iters = if N > 64 { 30 } else { 3000 };
    }
    let run = RefCell::new((harness, SessionTally::default()));
    let result = TestRunner::new(config).run(&session_plans(starts, N, phases), |plan| {
        let (harness, tally) = &mut *run.borrow_mut();
        let one = harness.run_plan(&plan);
        *tally = tally.sum_with(one.map_err(|failure| TestCaseError::fail(failure.message))?);
        Ok(())
    });
    let (harness, tally) = run.into_inner();
    match result {
        Ok(()) => println!("{N}^3, {K} intervals: {tally:?}"),
        Err(TestError::Fail(_, plan)) => panic_with_trace(harness, &plan),
        Err(TestError::Abort(reason)) => panic!("{reason}"),
    }
    tally
}

/// Runs a failed plan once more, writes its trace, and panics with instructions for replaying it.
fn panic_with_trace<const N: usize, const K: usize>(
    harness: &mut StepHarness<N, K>,
    plan: &SessionPlan,
) -> !
where
    Grid<N>: Size,
{
    let failure = harness.run_plan(plan).expect_err("it failed before");
    let StepFailure { message, trace } = *failure;
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join(format!("step-{N}-{K}.trace"));
    std::fs::write(&path, trace.to_string()).expect("a folder for temporary files");
    let phases = &plan.phases;
    let test = "cargo test -p paros-tests-core --test main a_failure_can_be_replayed";
    panic!("{message}\n{phases:#?}\nPAROS_STEP_TRACE={} {test}", path.display());
}

/// Replays a trace in a world of the trace's grid size.
fn replay(trace: &StepTrace) -> Result<SessionTally, Box<StepFailure>> {
    fn on<const N: usize, const K: usize>(
        harness: &Mutex<StepHarness<N, K>>,
        trace: &StepTrace,
    ) -> Result<SessionTally, Box<StepFailure>>
    where
        Grid<N>: Size,
    {
        harness.lock().unwrap_or_else(PoisonError::into_inner).run_trace(trace)
    }
    match (trace.side, trace.intervals) {
        (16, 1) => on(&AT_16, trace),
        (16, 2) => on(&AT_16_OF_2, trace),
        (16, 3) => on(&AT_16_OF_3, trace),
        (32, 1) => on(&AT_32, trace),
        (32, 2) => on(&AT_32_OF_2, trace),
        (64, 1) => on(&AT_64, trace),
        (64, 2) => on(&AT_64_OF_2, trace),
        (128, 2) => on(&AT_128, trace),
        (256, 1) => on(&AT_256, trace),
        size => panic!("no world of {size:?}"),
    }
}

#[test]
fn sessions_at_16_follow_the_model() {
    let starts = || closed_volumes_with_inner_mask(16);
    let tally = check_sessions(&AT_16, starts(), 80, 1..=24)
        .sum_with(check_sessions(&AT_16_OF_2, starts(), 60, 1..=24))
        .sum_with(check_sessions(&AT_16_OF_3, starts(), 40, 1..=24));
    assert!(tally.edits > 300 && tally.fills > 30 && tally.refusals > 30, "{tally:?}");
    assert!(tally.removals > 30 && tally.rewinds > 30 && tally.loads > 30, "{tally:?}");
    assert!(tally.swaps > 30 && tally.rim_turns > 30, "{tally:?}");
}

#[test]
fn sessions_at_32_follow_the_model() {
    let starts = || closed_volumes_with_inner_mask(32);
    let tally = check_sessions(&AT_32, starts(), 24, 1..=24).sum_with(check_sessions(
        &AT_32_OF_2,
        starts(),
        24,
        1..=24,
    ));
    assert!(tally.edits > 300 && tally.both > 10 && tally.removals > 10, "{tally:?}");
}

#[test]
fn long_sessions_follow_the_model() {
    let starts = closed_volumes_with_inner_mask;
    let tally = check_sessions(&AT_16_OF_2, starts(16), 4, 200..=200)
        .sum_with(check_sessions(&AT_32, starts(32), 1, 150..=150))
        .sum_with(check_sessions(&AT_64, starts(64), 1, 60..=60))
        .sum_with(check_sessions(&AT_64_OF_2, starts(64), 1, 60..=60));
    assert!(tally.ticks > 3000 && tally.edits > 300 && tally.loads > 10, "{tally:?}");
}

/// Runs some 100 ticks at 128; the nightly run has 300 ticks there and at 256.
#[test]
fn sessions_on_large_grids_follow_the_model() {
    let boxes = |side: usize| (0..9u64).prop_map(move |seed| scattered_boxes(side, seed));
    let phases = if scaled_cases(1) > 1 { 45..=45 } else { 15..=15 };
    let mut tallies = vec![check_sessions(&AT_128, boxes(128), 1, phases.clone())];
    if scaled_cases(1) > 1 {
        tallies.push(check_sessions(&AT_256, boxes(256), 1, phases));
    }
    assert!(tallies.iter().all(|tally| tally.ticks > 60 && tally.edits > 2), "{tallies:?}");
}

/// A trace that is written and read again gives the same session. With `PAROS_STEP_TRACE`, replays that trace
/// instead.
#[test]
fn a_failure_can_be_replayed() {
    if let Ok(path) = std::env::var("PAROS_STEP_TRACE") {
        let text = std::fs::read_to_string(&path).expect("a trace");
        let trace: StepTrace = text.parse().expect("a trace of a session");
        if let Err(failure) = replay(&trace) {
            panic!("{}", failure.message);
        }
        return;
    }
    let mut runner = TestRunner::deterministic();
    let plans = session_plans(closed_volumes_with_inner_mask(16), 16, 1..=24);
    let mut harness = AT_16.lock().unwrap_or_else(PoisonError::into_inner);
    for _ in 0..4 {
        let plan = plans.new_tree(&mut runner).expect("a plan").current();
        let (tally, trace) = harness.run_plan_traced(&plan).expect("as the model");
        let again: StepTrace = trace.to_string().parse().expect("a trace");
        assert_eq!(again, trace);
        assert_eq!(harness.run_trace(&again).expect("as the model"), tally);
        assert!(tally.ticks > 0);
    }
    assert!("step 16 1\nvolume 4096\nmask 4096\ntick 00".parse::<StepTrace>().is_err());
}

proptest! {
    #![proptest_config(random_cases(20))]

    /// The model's edits visit only the brush's voxels; the definition visits every voxel.
    #[test]
    fn the_models_edits_are_those_of_the_definition(
        start in any_voxels(16),
        edits in proptest::collection::vec(([0..16i32, 0..16i32, 0..16i32], 0..8i32, 0..7u8, any::<bool>()), 1..4),
        masked in any::<bool>(),
    ) {
        check_edits::<1>(&start, &edits, masked)?;
        check_edits::<2>(&start, &edits, masked)?;
        check_edits::<3>(&start, &edits, masked)?;
    }
}

/// A voxel, a radius in half voxels, an operation, and `true` if mirrored.
type BallEdit = ([i32; 3], i32, u8, bool);

fn check_edits<const K: usize>(
    start: &DenseVolume,
    edits: &[BallEdit],
    masked: bool,
) -> Result<(), TestCaseError> {
    let mut layered = LayeredVolume::new(start, K);
    let mut maps = RangeMaps::<16, K>::new();
    layered.write_maps(&mut maps);
    let mut volume = StepVolume::from_maps(&maps);
    let mask = match masked {
        true => DenseVolume::from_fn(16, |at| at[0] < 8 && layered.voxels().contains(at)),
        false => DenseVolume::empty(16),
    };
    for &(at, radius, kind, mirrored) in edits {
        let operation = match kind {
            0 => EditOperation::Smooth { radius: 1, dither: None },
            1 | 2 => EditOperation::Fill { depth: kind.into() },
            5 => EditOperation::Carve { depth: ANY_DEPTH },
            6 => EditOperation::Fill { depth: ANY_DEPTH },
            depth => EditOperation::Carve { depth: depth.into() },
        };
        let centre = at.map(|i| i * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2);
        let brush = Brush::sphere(centre.into(), radius * SUBUNITS_PER_VOXEL / 2);
        let ball = DenseVolume::from_fn(16, |[x, y, z]| {
            let row = brush.pieces().find_map(|piece| piece.x_range(y as usize, z as usize, 16));
            row.is_some_and(|row| row.contains(x as usize))
        });
        let before = layered.voxels().clone();
        let exact = exact_edit(&before, &mask, &ball, operation, mirrored);
        layered.become_closure_of(&exact.exact);
        let both = if mirrored { ball.union(&ball.mirrored_in_x()) } else { ball };
        let voxels: Vec<_> = both.occupied().collect();
        let (report, _) = volume.apply_edit(&mask, &voxels, operation, mirrored);
        prop_assert_eq!(report, exact.expected_report(&before, layered.voxels()));
        layered.write_maps(&mut maps);
        prop_assert!(volume == StepVolume::from_maps(&maps));
        volume.assert_tight_and_saturated();
    }
    Ok(())
}
