//! Island removal against the model's flood fill, without edits during a pass; `islands_in_flight` tests it
//! with edits.
//!
//! Planted faults, and what catches each (tried by hand; `at_rest` and `while_visitors_edit` unless noted):
//! - `queue_neighbours`: never the row below, or before; `visit_queued_rows`: a row never becomes open, or
//!   open rows below, or above, are forgotten; `visit_row`: the row itself gives no seeds.
//! - `mark_added_as_reached`: the row, or its neighbours, not queued; the voxels not reached ->
//!   `while_visitors_edit`. Voxels reached before queued again -> `one_voxel_for_ever`.
//! - `open_rows_around`: neighbours across a word border not checked -> `across_words`.
//! - `begin_pass`: the mask, or the ground, forgotten -> `at_rest`, `mask_holds`.
//! - `advance_pass`: the ground not checked at the end -> `ground_goes_in_flight`; edits in flight
//!   forgotten -> `while_visitors_edit`.
//! - `remove_islands`: a map not tightened, rows not closed -> `at_rest`; kept voxels reported again ->
//!   `kept_is_told_once`.

use std::sync::{Mutex, PoisonError};

use paros_core::Volume;
use paros_core::codec::ByteReader;
use paros_core::edit::IslandReport;
use paros_core::limits::max_island_row_visits_per_tick;
use paros_core::volume::{BitSet, Grid, Size};
use paros_models::cases::random_cases;
use paros_models::dense::{
    DenseVolume, MaskedVolume, closed_volumes, closed_volumes_with_inner_mask,
};
use paros_models::island_harness::{IslandHarness, RandomEdit, WholePass, barely_joined_volumes};
use paros_models::islands::clear_islands;
use proptest::prelude::*;

fn check_at_rest<const N: usize>(
    harness: &Mutex<IslandHarness<N>>,
    MaskedVolume { volume, mask }: &MaskedVolume,
    budget: u32,
) -> Result<(), TestCaseError>
where
    Grid<N>: Size,
{
    let mut harness = harness.lock().unwrap_or_else(|e| e.into_inner());
    harness.set_volume(volume, mask);
    let expected = clear_islands(volume, mask);
    // All zero bytes: forgets the kept voxels of an earlier case.
    prop_assert_eq!(harness.islands.load(&mut ByteReader::new(&[0; 17])), Ok(()));
    let report = harness.run_pass(budget)?.report;
    prop_assert!(
        harness.to_dense() == expected.after,
        "{:?} instead of {:?}",
        harness.to_dense(),
        expected
    );
    prop_assert_eq!(report.removed, expected.removed);
    prop_assert_eq!(report.unsupported, expected.unsupported);
    harness.check_closed()?;
    let again = harness.run_pass(budget)?.report;
    prop_assert!(harness.to_dense() == expected.after, "a second pass changes nothing");
    prop_assert_eq!((again.removed, again.kept), (0, 0));
    prop_assert_eq!(report.kept, expected.kept);
    Ok(())
}

static AT_REST_16: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
static AT_REST_32: Mutex<IslandHarness<32>> = Mutex::new(IslandHarness::new());
static AT_REST_64: Mutex<IslandHarness<64>> = Mutex::new(IslandHarness::new());
static AT_REST_128: Mutex<IslandHarness<128>> = Mutex::new(IslandHarness::new());

proptest! {
    #![proptest_config(random_cases(250))]
    #[test]
    fn at_rest(case in closed_volumes_with_inner_mask(16), budget in 1u32..400) {
        check_at_rest(&AT_REST_16, &case, budget)?;
    }

    #[test]
    fn at_rest_loose(case in barely_joined_volumes(16), budget in 1u32..400) {
        check_at_rest(&AT_REST_16, &case, budget)?;
    }
}

proptest! {
    #![proptest_config(random_cases(20))]
    #[test]
    fn at_rest_32(case in closed_volumes_with_inner_mask(32), budget in 1u32..2000) {
        check_at_rest(&AT_REST_32, &case, budget)?;
    }
}

proptest! {
    #![proptest_config(random_cases(2))]
    #[test]
    fn at_rest_64(case in closed_volumes_with_inner_mask(64), budget in 100u32..8000) {
        check_at_rest(&AT_REST_64, &case, budget)?;
    }
}

proptest! {
    #![proptest_config(random_cases(1))]
    #[test]
    fn at_rest_128(case in closed_volumes_with_inner_mask(128)) {
        check_at_rest(&AT_REST_128, &case, max_island_row_visits_per_tick(128))?;
    }
}

/// Kept voxels are reported when they change, and not again after an edit elsewhere.
#[test]
fn kept_is_told_once() {
    static HARNESS: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let (cave, mask) = (pinwheel_volume(16, [7, 7, 7]), DenseVolume::empty(16));
    harness.set_volume(&cave, &mask);
    let expected = clear_islands(&cave, &mask);
    assert!(expected.kept > 0, "the shape keeps a loose voxel");
    let report = harness.run_pass(1000).unwrap().report;
    assert_eq!((report.removed, report.kept), (0, expected.kept));
    harness.apply_edit(&RandomEdit { at: [0, 15, 0], radius: 1, kind: 0 });
    let report = harness.run_pass(1000).unwrap().report;
    assert_eq!((report.removed, report.kept), (0, 0));
}

/// Kept voxels are reported wherever they lie: the hash of a single voxel near the end of its row differs
/// from the hash of no voxels, although the even keys of some layers shift its bit out.
#[test]
fn kept_is_told_near_the_end_of_a_row() {
    const N: i32 = 64;
    let mut harness = AT_REST_64.lock().unwrap_or_else(PoisonError::into_inner);
    for y in 3..N - 3 {
        let cave = pinwheel_volume(N, [N - 3, y, 7]);
        harness.set_volume(&cave, &DenseVolume::empty(64));
        harness.islands.reset();
        let report = harness.run_pass(4096).unwrap().report;
        assert_eq!((report.removed, report.kept), (0, 1), "at y = {y}");
        let report = harness.run_pass(4096).unwrap().report;
        assert_eq!((report.removed, report.kept), (0, 0), "at y = {y}, again");
    }
}

/// Returns a loose voxel at `c` between the ends of six arms, which stand on the ground and shield it on all
/// axes.
fn pinwheel_volume(side: i32, c: [i32; 3]) -> DenseVolume {
    let mut dense = DenseVolume::empty(side as usize);
    let mut bar = |a: [i32; 3], b: [i32; 3]| {
        let [x, y, z] = [0, 1, 2].map(|i| a[i].min(b[i])..=a[i].max(b[i]));
        for y in y {
            for z in z.clone() {
                x.clone().for_each(|x| dense.set([x, y, z], true));
            }
        }
    };
    let ([x, y, z], end) = (c, side - 1);
    bar(c, c);
    bar([x, 0, z], [x, 1, z]);
    for (tip, corner) in [([0, y, z], [0, y, 0]), ([end, y, z], [end, y, end])] {
        bar(tip, corner);
        bar(corner, [corner[0], 0, corner[2]]);
    }
    for (tip, corner) in [([x, y, 0], [end, y, 0]), ([x, y, end], [0, y, end])] {
        bar(tip, corner);
        bar(corner, [corner[0], 0, corner[2]]);
    }
    bar([x, y, 0], [x, end, 0]);
    bar([x, end, 0], [x, end, z]);
    dense.closure()
}

/// Sheets in series need about N^3 / 2 sequential row visits: many ticks, and no island.
#[test]
fn comb_of_sheets() {
    const N: usize = 128;
    static HARNESS: Mutex<IslandHarness<N>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    write_comb(&mut harness.volume);
    let voxels = harness.volume.count_voxels();
    harness.islands.request_pass();
    let mut ticks = 1;
    let report = loop {
        let harness = &mut *harness;
        let budget = max_island_row_visits_per_tick(N);
        if let Some(report) =
            harness.islands.advance_pass(&mut harness.volume, &harness.mask, budget, &mut ())
        {
            break report;
        }
        ticks += 1;
    };
    assert_eq!(report, IslandReport::default());
    assert_eq!(harness.volume.count_voxels(), voxels);
    let visits = ticks * max_island_row_visits_per_tick(N);
    assert!((900_000..1_300_000).contains(&visits), "{visits} row visits");
}

/// Writes walls across x, two voxels apart, each joined to the next at the bottom and at the top alternately.
fn write_comb<const N: usize>(volume: &mut Volume<N>)
where
    Grid<N>: Size,
{
    let mut walls = <Grid<N> as Size>::Row::EMPTY;
    let (mut low, mut high) = (walls, walls);
    for x in 0..N {
        match x % 4 {
            1 => high.insert(x),
            3 => low.insert(x),
            _ => walls.insert(x),
        }
    }
    volume.set_voxels(|plane| {
        for y in 0..N {
            for z in 0..N {
                *plane.row_mut(y, z) = walls
                    | if y == 1 { low } else { <Grid<N> as Size>::Row::EMPTY }
                    | if y == N - 1 { high } else { <Grid<N> as Size>::Row::EMPTY };
            }
        }
        // Only the first wall stands on the ground.
        for z in 0..N {
            let mut first = <Grid<N> as Size>::Row::EMPTY;
            first.insert(0);
            *plane.row_mut(0, z) = first;
        }
    });
}

/// A beam that is reached late, at its far end and from above, crosses a word border of the queue.
#[test]
fn across_words() {
    const N: usize = 128;
    static HARNESS: Mutex<IslandHarness<N>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    for end in [20, N - 1 - 20] {
        harness.volume.set_voxels(|plane| {
            for y in 0..=8 {
                plane.row_mut(y, end).insert(30);
                if y >= 5 {
                    plane.row_mut(y, end).insert(10);
                }
            }
            *plane.row_mut(8, end) |= <Grid<N> as Size>::Row::span(10, 30);
            (20..N - 20).for_each(|z| plane.row_mut(5, z).insert(10));
        });
        let voxels = harness.volume.count_voxels();
        let report = harness.run_pass(max_island_row_visits_per_tick(N)).unwrap().report;
        assert_eq!((report.removed, harness.volume.count_voxels()), (0, voxels));
    }
}

/// With neither ground nor mask, nothing is removed, and every pass after an edit reports the missing
/// support.
#[test]
fn nothing_to_stand_on() {
    static HARNESS: Mutex<IslandHarness<16>> = Mutex::new(IslandHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let floating = DenseVolume::from_fn(16, |[_, y, _]| y > 0 && y != 5);
    harness.set_volume(&floating.closure(), &DenseVolume::empty(16));
    for _ in 0..2 {
        let WholePass { report, ticks } = harness.run_pass(10).unwrap();
        assert_eq!(report, IslandReport { unsupported: true, ..Default::default() });
        assert_eq!(ticks, 1);
    }
    assert!(harness.to_dense() == floating.closure());
}

proptest! {
    #![proptest_config(random_cases(30))]
    /// A mask over the whole volume supports all of it.
    #[test]
    fn mask_holds(volume in closed_volumes(16)) {
        check_at_rest(&AT_REST_16, &MaskedVolume { mask: volume.clone(), volume }, 50)?;
    }
}

/// The mask costs no extra tick: each row's part of it is read when the row is visited.
#[test]
fn the_mask_takes_no_tick() {
    let mut harness = AT_REST_16.lock().unwrap_or_else(|e| e.into_inner());
    let budget = max_island_row_visits_per_tick(16);
    for height in [1, 4] {
        let floor = DenseVolume::from_fn(16, |[_, y, _]| y < height);
        for mask in [DenseVolume::empty(16), floor.clone()] {
            harness.set_volume(&floor, &mask);
            assert_eq!(harness.run_pass(budget).unwrap().ticks, 1, "{height} high");
        }
    }
}

/// A block that floats in a well: columns along x and z can represent it whole, so it is too large to test
/// voxel by voxel, but no column along y can.
#[test]
fn a_block_in_a_well() {
    let wall = |i: i32| i == 0 || i == 15;
    let inside = |i: i32| (2..14).contains(&i);
    let well = DenseVolume::from_fn(16, |[x, y, z]| {
        wall(x) || wall(z) || (inside(x) && inside(z) && (2..15).contains(&y))
    });
    assert!(
        well == well.closure()
            && clear_islands(&well, &DenseVolume::empty(16)).removed == 12 * 13 * 12
    );
    check_at_rest(&AT_REST_16, &MaskedVolume { volume: well, mask: DenseVolume::empty(16) }, 50)
        .unwrap();
}
