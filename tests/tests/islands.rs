//! Islands against connected components of plain booleans, at rest. `islands_in_flight` has what
//! happens under the visitor's hands.
//!
//! Planted faults, one line each, and what catches them (tried by hand; `at_rest` and
//! `while_visitors_edit` where nothing else is said):
//! - `wake_beside`: never the row below, or before; `visit_rows`: a row never becomes open, or open
//!   rows below, or above, are forgotten; `visit`: the row itself gives no seeds.
//! - `added`: the row, or its neighbours, not queued; the voxels not reached ->
//!   `while_visitors_edit`. Voxels reached before queued again -> `one_voxel_for_ever`.
//! - `open_about`: no look across the border of a word -> `across_words`.
//! - `begin`: the mask, or the ground, forgotten -> `at_rest`, `mask_holds`.
//! - `advance`: no look at the ground at the end -> `ground_goes_in_flight`; edits in flight
//!   forgotten -> `while_visitors_edit`.
//! - `remove`: a map not tightened, rows not closed -> `at_rest`; kept told again ->
//!   `kept_is_told_once`.

use std::sync::Mutex;

use paros_core::codec::Reader;
use paros_core::islands::IslandReport;
use paros_core::limits::row_visits;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::volume::Volume;
use paros_tests::models::dense::{Dense, masked_volumes, volumes};
use paros_tests::models::island_bench::{Bench, Visit, loose_volumes};
use paros_tests::models::islands::cleared;
use proptest::prelude::*;

fn check_at_rest<const N: usize>(
    bench: &Mutex<Bench<N>>,
    (volume, mask): &(Dense, Dense),
    budget: u32,
) -> Result<(), TestCaseError>
where
    Grid<N>: Size,
{
    let mut bench = bench.lock().unwrap_or_else(|e| e.into_inner());
    bench.set(volume, mask);
    let expected = cleared(volume, mask);
    // All zero: no kept voxels remembered from another case.
    prop_assert_eq!(bench.islands.load(&mut Reader::new(&[0; 17])), Ok(()));
    let (report, _) = bench.run(budget)?;
    prop_assert!(bench.dense() == expected.after, "{:?} instead of {:?}", bench.dense(), expected);
    prop_assert_eq!(report.removed, expected.removed);
    prop_assert_eq!(report.unsupported, expected.unsupported);
    bench.check_closed()?;
    let (again, _) = bench.run(budget)?;
    prop_assert!(bench.dense() == expected.after, "a second pass changes nothing");
    prop_assert_eq!((again.removed, again.kept), (0, 0));
    prop_assert_eq!(report.kept, expected.kept);
    Ok(())
}

static AT_REST_16: Mutex<Bench<16>> = Mutex::new(Bench::new());
static AT_REST_32: Mutex<Bench<32>> = Mutex::new(Bench::new());
static AT_REST_64: Mutex<Bench<64>> = Mutex::new(Bench::new());
static AT_REST_128: Mutex<Bench<128>> = Mutex::new(Bench::new());

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2500))]
    #[test]
    fn at_rest(case in masked_volumes(16), budget in 1u32..400) {
        check_at_rest(&AT_REST_16, &case, budget)?;
    }

    #[test]
    fn at_rest_loose(case in loose_volumes(16), budget in 1u32..400) {
        check_at_rest(&AT_REST_16, &case, budget)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn at_rest_32(case in masked_volumes(32), budget in 1u32..2000) {
        check_at_rest(&AT_REST_32, &case, budget)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn at_rest_64(case in masked_volumes(64), budget in 100u32..8000) {
        check_at_rest(&AT_REST_64, &case, budget)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3))]
    #[test]
    fn at_rest_128(case in masked_volumes(128)) {
        check_at_rest(&AT_REST_128, &case, row_visits(128))?;
    }
}

/// Kept voxels are reported when they change, and not again after an edit elsewhere.
#[test]
fn kept_is_told_once() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let (cave, mask) = (pinwheel(), Dense::new(16));
    bench.set(&cave, &mask);
    let expected = cleared(&cave, &mask);
    assert!(expected.kept > 0, "the shape keeps a loose voxel");
    let (report, _) = bench.run(1000).unwrap();
    assert_eq!((report.removed, report.kept), (0, expected.kept));
    bench.edit(&Visit { at: [0, 15, 0], radius: 1, kind: 0 });
    let (report, _) = bench.run(1000).unwrap();
    assert_eq!((report.removed, report.kept), (0, 0));
}

/// A loose voxel amid the ends of six arms, which stand on the ground and shield it on all axes.
fn pinwheel() -> Dense {
    let mut dense = Dense::new(16);
    let mut bar = |a: [i32; 3], b: [i32; 3]| {
        for voxel in Dense::new(16).all() {
            if (0..3).all(|i| a[i].min(b[i]) <= voxel[i] && voxel[i] <= a[i].max(b[i])) {
                dense.set(voxel, true);
            }
        }
    };
    bar([7, 7, 7], [7, 7, 7]);
    bar([7, 0, 7], [7, 1, 7]);
    for (tip, corner) in [([0, 7, 7], [0, 7, 0]), ([13, 7, 7], [13, 7, 13])] {
        bar(tip, corner);
        bar(corner, [corner[0], 0, corner[2]]);
    }
    for (tip, corner) in [([7, 7, 0], [13, 7, 0]), ([7, 7, 13], [0, 7, 13])] {
        bar(tip, corner);
        bar(corner, [corner[0], 0, corner[2]]);
    }
    bar([7, 7, 0], [7, 13, 0]);
    bar([7, 13, 0], [7, 13, 7]);
    dense.closure()
}

/// Sheets in series need about N^3 / 2 row visits, one after the other: many ticks, no island.
#[test]
fn comb_of_sheets() {
    const N: usize = 128;
    static BENCH: Mutex<Bench<N>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    comb(&mut bench.volume);
    let voxels = bench.volume.count();
    bench.islands.edited();
    let mut ticks = 1;
    let report = loop {
        let bench = &mut *bench;
        let budget = row_visits(N);
        if let Some(report) = bench.islands.advance(&mut bench.volume, &bench.mask, budget, &mut ())
        {
            break report;
        }
        ticks += 1;
    };
    assert_eq!(report, IslandReport::default());
    assert_eq!(bench.volume.count(), voxels);
    let visits = ticks * row_visits(N);
    assert!((900_000..1_300_000).contains(&visits), "{visits} row visits");
}

/// Walls across x, two voxels apart, joined to the next at the bottom and at the top in turn.
fn comb<const N: usize>(volume: &mut Volume<N>)
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
        // Only the first wall stands.
        for z in 0..N {
            let mut first = <Grid<N> as Size>::Row::EMPTY;
            first.insert(0);
            *plane.row_mut(0, z) = first;
        }
    });
}

/// A beam that is reached late, at its far end and from above, passes the queue's word border.
#[test]
fn across_words() {
    const N: usize = 128;
    static BENCH: Mutex<Bench<N>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    for end in [20, N - 1 - 20] {
        bench.volume.set_voxels(|plane| {
            for y in 0..=8 {
                plane.row_mut(y, end).insert(30);
                if y >= 5 {
                    plane.row_mut(y, end).insert(10);
                }
            }
            *plane.row_mut(8, end) |= <Grid<N> as Size>::Row::span(10, 30);
            (20..N - 20).for_each(|z| plane.row_mut(5, z).insert(10));
        });
        let voxels = bench.volume.count();
        let (report, _) = bench.run(row_visits(N)).unwrap();
        assert_eq!((report.removed, bench.volume.count()), (0, voxels));
    }
}

/// Neither ground nor mask: nothing goes, and that is said, after each edit anew.
#[test]
fn nothing_to_stand_on() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let floating = Dense::from_fn(16, |[_, y, _]| y > 0 && y != 5);
    bench.set(&floating.closure(), &Dense::new(16));
    for _ in 0..2 {
        let (report, ticks) = bench.run(10).unwrap();
        assert_eq!(report, IslandReport { unsupported: true, ..Default::default() });
        assert_eq!(ticks, 1);
    }
    assert!(bench.dense() == floating.closure());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// All of the volume masked: all of it stands.
    #[test]
    fn mask_holds(volume in volumes(16)) {
        check_at_rest(&AT_REST_16, &(volume.clone(), volume), 50)?;
    }
}

/// Laying out the mask is a tick's work, so a search that is short without one takes a second tick;
/// where only the ground is there, it is short indeed.
#[test]
fn the_mask_takes_a_tick() {
    let mut bench = AT_REST_16.lock().unwrap_or_else(|e| e.into_inner());
    for height in [1, 4] {
        let floor = Dense::from_fn(16, |[_, y, _]| y < height);
        for (mask, ticks) in [(Dense::new(16), 1), (floor.clone(), 2)] {
            bench.set(&floor, &mask);
            assert_eq!(bench.run(row_visits(16)).unwrap().1, ticks, "{height} high");
        }
    }
}

/// A block that floats in a well: columns along x and z hold all of it, too much to ask for voxel
/// by voxel, but none along y.
#[test]
fn a_block_in_a_well() {
    let wall = |i: i32| i == 0 || i == 15;
    let inside = |i: i32| (2..14).contains(&i);
    let well = Dense::from_fn(16, |[x, y, z]| {
        wall(x) || wall(z) || (inside(x) && inside(z) && (2..15).contains(&y))
    });
    assert!(well == well.closure() && cleared(&well, &Dense::new(16)).removed == 12 * 13 * 12);
    check_at_rest(&AT_REST_16, &(well, Dense::new(16)), 50).unwrap();
}
