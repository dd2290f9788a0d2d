//! Islands against connected components of plain booleans, at rest and under the visitor's hands.
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

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::codec::{Reader, Writer};
use paros_core::edit::{self, Edit, EditScratch, Operation};
use paros_core::islands::{IslandReport, Islands};
use paros_core::limits::row_visits;
use paros_core::maps::{Axis, Column, Maps};
use paros_core::pose::SUB;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::volume::{Journal, Volume, maps_digest};
use paros_tests::models::dense::{Dense, masked_volumes, volumes};
use paros_tests::models::islands::{cleared, untouched_islands};
use proptest::prelude::*;

struct Bench<const N: usize>
where
    Grid<N>: Size,
{
    volume: Volume<N>,
    mask: Maps<N>,
    islands: Islands<N>,
    scratch: EditScratch<N>,
    spare: Maps<N>,
}

impl<const N: usize> Bench<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Bench {
            volume: Volume::new(),
            mask: Maps::new(),
            islands: Islands::new(),
            scratch: EditScratch::new(),
            spare: Maps::new(),
        }
    }

    fn set(&mut self, volume: &Dense, mask: &Dense) {
        self.volume.set_voxels(|plane| volume.write_plane(plane));
        mask.write_maps(&mut self.mask);
        self.islands.abort();
    }

    fn dense(&self) -> Dense {
        Dense::from_plane(self.volume.rows())
    }

    /// Advances once. The journal must tell of exactly the columns that changed, nothing may be
    /// added, the maps must be tight and the digests right.
    fn advance(&mut self, budget: u32) -> Result<Option<IslandReport>, TestCaseError> {
        self.spare.copy_from(self.volume.maps());
        let mut changes = Changes::default();
        let report = self.islands.advance(&mut self.volume, &self.mask, budget, &mut changes);
        prop_assert!(changes.added.is_empty(), "an island pass adds nothing");
        for (axis, at, old) in changes.columns {
            prop_assert_eq!(self.spare.column(axis, at), old, "told once, with the old value");
            let new = self.volume.maps().column(axis, at);
            prop_assert!(new != old, "told without a change");
            self.spare.set_column(axis, at, new);
        }
        prop_assert!(self.spare == *self.volume.maps(), "a change wasn't told");
        prop_assert_eq!(self.islands.digest(), self.islands.recompute_digest());
        if report.is_some() {
            prop_assert_eq!(self.volume.digest(), maps_digest(self.volume.maps()));
            self.check_closed()?;
        }
        Ok(report)
    }

    /// Rows are the intersection of the maps, and every range is tight.
    fn check_closed(&mut self) -> Result<(), TestCaseError> {
        let dense = self.dense();
        prop_assert!(dense == Dense::from_maps(self.volume.maps()), "rows and maps differ");
        dense.write_maps(&mut self.spare);
        prop_assert!(self.spare == *self.volume.maps(), "a range isn't tight");
        Ok(())
    }

    fn run(&mut self, budget: u32) -> Result<(IslandReport, u32), TestCaseError> {
        self.islands.edited();
        for ticks in 1.. {
            if let Some(report) = self.advance(budget)? {
                return Ok((report, ticks));
            }
        }
        unreachable!()
    }

    fn edit(&mut self, visit: &Visit) -> Vec<((usize, usize), <Grid<N> as Size>::Row)> {
        let place = |i: i32| i * SUB + SUB / 2;
        let brush = Brush::sphere(IVec3::from_array(visit.at.map(place)), visit.radius * SUB / 2);
        let operation = match visit.kind {
            0 => Operation::Carve { depth: 4 },
            1 => Operation::Fill { depth: 2 },
            _ => Operation::Smooth,
        };
        let edit = Edit { brush: &brush, operation, mirrored: false };
        let mut log = Log { islands: &mut self.islands, added: Vec::new() };
        let report = edit::apply(&mut self.volume, &self.mask, &edit, &mut self.scratch, &mut log);
        let added = log.added;
        if report.is_ok_and(|report| report.changed()) {
            self.islands.edited();
        }
        added
    }
}

/// What a journal was told.
struct Changes<R> {
    columns: Vec<(Axis, (usize, usize), Column)>,
    added: Vec<((usize, usize), R)>,
}

impl<R> Default for Changes<R> {
    fn default() -> Self {
        Changes { columns: Vec::new(), added: Vec::new() }
    }
}

impl<const N: usize> Journal<N> for Changes<<Grid<N> as Size>::Row>
where
    Grid<N>: Size,
{
    fn column(&mut self, axis: Axis, at: (usize, usize), old: Column) {
        self.columns.push((axis, at, old));
    }
    fn added(&mut self, row: (usize, usize), voxels: <Grid<N> as Size>::Row) {
        self.added.push((row, voxels));
    }
}

/// Passes an edit's additions on.
struct Log<'a, const N: usize>
where
    Grid<N>: Size,
{
    islands: &'a mut Islands<N>,
    added: Vec<((usize, usize), <Grid<N> as Size>::Row)>,
}

impl<const N: usize> Journal<N> for Log<'_, N>
where
    Grid<N>: Size,
{
    fn column(&mut self, _: Axis, _: (usize, usize), _: Column) {}
    fn added(&mut self, row: (usize, usize), voxels: <Grid<N> as Size>::Row) {
        self.islands.added(row, voxels);
        self.added.push((row, voxels));
    }
}

/// A visitor's edit in one tick.
#[derive(Clone, Debug)]
struct Visit {
    at: [i32; 3],
    radius: i32,
    kind: u8,
}

fn visits(n: i32) -> impl Strategy<Value = Vec<Visit>> {
    let visit = ([0..n, 0..n, 0..n], 0..n / 2 + 2, 0..3u8).prop_map(|(at, radius, kind)| Visit {
        at,
        radius,
        kind,
    });
    proptest::collection::vec(visit, 1..40)
}

/// Blobs barely held together: what an edit easily cuts loose.
fn loose_volumes(n: usize) -> impl Strategy<Value = (Dense, Dense)> {
    let side = n as i32;
    let ball = ([0..side, 0..side, 0..side], 1..side / 2);
    let balls = proptest::collection::vec(ball, 1..8).prop_map(move |balls| {
        let inside = |[x, y, z]: [i32; 3], ([i, j, k], r): ([i32; 3], i32)| {
            4 * ((x - i).pow(2) + (y - j).pow(2) + (z - k).pow(2)) <= r * r
        };
        let voxels = Dense::from_fn(n, |v| balls.iter().any(|&ball| inside(v, ball)));
        (voxels.closure(), Dense::new(n))
    });
    prop_oneof![2 => balls, 1 => masked_volumes(n)]
}

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
static VISITED: Mutex<Bench<16>> = Mutex::new(Bench::new());

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
    #![proptest_config(ProptestConfig::with_cases(1500))]
    #[test]
    fn while_visitors_edit(
        (volume, mask) in loose_volumes(16),
        visits in visits(16),
        budget in 1u32..60,
    ) {
        check_visited(&volume, &mask, &visits, budget)?;
    }

    #[test]
    fn saved_in_the_middle(
        (volume, mask) in loose_volumes(16),
        visits in visits(16),
        budget in 1u32..60,
        cut in 0usize..20,
    ) {
        check_saved(&volume, &mask, &visits, budget, cut)?;
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

/// Edits on every tick. No pass removes what is supported in that tick; what was an island when a
/// pass began, and was let be, is gone when it ends, but for what closure keeps of it; and the
/// volume comes to rest as the definition says.
fn check_visited(
    volume: &Dense,
    mask: &Dense,
    visits: &[Visit],
    budget: u32,
) -> Result<(), TestCaseError> {
    const N: usize = 16;
    let mut bench = VISITED.lock().unwrap_or_else(|e| e.into_inner());
    bench.set(volume, mask);
    bench.islands.edited();
    let mut begun = None;
    let mut added = Dense::new(N);
    for visit in visits {
        for ((y, z), voxels) in bench.edit(visit) {
            voxels.ones().for_each(|x| added.set([x as i32, y as i32, z as i32], true));
        }
        prop_assert_eq!(bench.islands.digest(), bench.islands.recompute_digest());
        let before = bench.dense();
        if begun.is_none() && bench.islands.is_busy() {
            begun = Some(before.clone());
            added = Dense::new(N);
        }
        let Some(report) = bench.advance(budget)? else { continue };
        let after = bench.dense();
        let gone = before.without(&after);
        prop_assert_eq!(gone.count(), report.removed);
        prop_assert!(after.is_within(&before));
        prop_assert!(gone.and(&before.supported(mask)).is_empty(), "supported voxels are gone");
        let start = begun.take().expect("a pass began");
        if report.unsupported {
            prop_assert!(gone.is_empty());
        } else {
            let let_be = untouched_islands(&start, mask, &added);
            let rest = after.without(&let_be);
            prop_assert!(after.is_within(&rest.closure()), "an island is still there");
        }
    }
    // Hands off: one more pass may be needed for what happened during the one in flight.
    let mut passes = 0;
    while bench.islands.is_busy() {
        passes += u32::from(bench.advance(budget)?.is_some());
        prop_assert!(passes <= 2);
    }
    let at_rest = bench.dense();
    prop_assert!(cleared(&at_rest, mask).after == at_rest, "not at rest");
    Ok(())
}

fn check_saved(
    volume: &Dense,
    mask: &Dense,
    visits: &[Visit],
    budget: u32,
    cut: usize,
) -> Result<(), TestCaseError> {
    static PAIR: Mutex<(Bench<16>, Bench<16>)> = Mutex::new((Bench::new(), Bench::new()));
    let mut pair = PAIR.lock().unwrap_or_else(|e| e.into_inner());
    let (one, other) = &mut *pair;
    one.set(volume, mask);
    other.set(volume, mask);
    one.islands.edited();
    for (tick, visit) in visits.iter().enumerate() {
        if tick == cut.min(visits.len() - 1) {
            other.volume.set_maps(one.volume.maps());
            let bytes = saved(&one.islands);
            other.islands.edited();
            let mut reader = Reader::new(&bytes);
            prop_assert_eq!(other.islands.load(&mut reader), Ok(()));
            prop_assert_eq!(reader.end(), Ok(()));
            prop_assert_eq!(saved(&other.islands), bytes);
        }
        one.edit(visit);
        let report = one.advance(budget)?;
        if tick >= cut.min(visits.len() - 1) {
            other.edit(visit);
            prop_assert_eq!(other.advance(budget)?, report);
            prop_assert_eq!(other.islands.digest(), one.islands.digest());
            prop_assert_eq!(other.volume.digest(), one.volume.digest());
        }
    }
    Ok(())
}

fn saved<const N: usize>(islands: &Islands<N>) -> Vec<u8>
where
    Grid<N>: Size,
{
    let mut sizing = Writer::new(&mut []);
    islands.save(&mut sizing);
    let mut bytes = vec![0; sizing.len()];
    let mut writer = Writer::new(&mut bytes);
    islands.save(&mut writer);
    assert!(writer.fits());
    bytes
}

/// Cut short or with bytes changed: an error and no pass, or a state, but no panic.
#[test]
fn bad_bytes() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    bench.set(
        &Dense::from_fn(16, |[x, y, z]| (x + z) % 3 != 0 || y == 2).closure(),
        &Dense::new(16),
    );
    bench.islands.edited();
    assert_eq!(bench.advance(40).unwrap(), None);
    let bytes = saved(&bench.islands);
    for len in 0..bytes.len() {
        assert!(bench.islands.load(&mut Reader::new(&bytes[..len])).is_err(), "cut at {len}");
        assert!(!bench.islands.is_busy());
    }
    let mut refused = 0;
    for at in 0..bytes.len() {
        for flip in [1, 2, 4, 16, 128, 255] {
            let mut bytes = bytes.clone();
            bytes[at] ^= flip;
            match bench.islands.load(&mut Reader::new(&bytes)) {
                Ok(()) => assert_eq!(bench.islands.digest(), bench.islands.recompute_digest()),
                Err(error) => {
                    assert!(error.offset <= bytes.len());
                    assert!(!bench.islands.is_busy());
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > bytes.len(), "rows of 16 voxels in words of 64 leave most flips detectable");
}

/// A visitor who for ever carves and fills the same voxel doesn't keep a pass from ending.
#[test]
fn one_voxel_for_ever() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    bench.set(&Dense::from_fn(16, |[_, y, _]| y < 12), &Dense::new(16));
    bench.islands.edited();
    for tick in 0.. {
        assert!(tick < 1000, "the pass doesn't end");
        bench.edit(&Visit { at: [8, 11, 8], radius: 0, kind: (tick % 2) as u8 });
        if bench.advance(2).unwrap().is_some() {
            break;
        }
    }
}

/// In flight every tick moves the digest; at rest none does.
#[test]
fn digest_moves() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    bench.set(&Dense::from_fn(16, |_| true), &Dense::new(16));
    bench.islands.edited();
    let mut digests = vec![bench.islands.digest()];
    while bench.advance(3).unwrap().is_none() {
        digests.push(bench.islands.digest());
    }
    let rest = bench.islands.digest();
    digests.push(rest);
    let count = digests.len();
    digests.sort_unstable();
    digests.dedup();
    assert_eq!(digests.len(), count);
    assert_eq!(bench.advance(3).unwrap(), None);
    assert_eq!(bench.islands.digest(), rest);
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

/// The ground goes while a pass is in flight: at its end nothing is left to stand on.
#[test]
fn ground_goes_in_flight() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let stand =
        Dense::from_fn(16, |[x, y, z]| (x < 3 && z < 3 && y < 6) || (x > 10 && z > 10 && y > 10));
    bench.set(&stand, &Dense::new(16));
    bench.islands.edited();
    assert_eq!(bench.advance(1).unwrap(), None);
    bench.edit(&Visit { at: [1, 0, 1], radius: 8, kind: 0 });
    let before = bench.dense();
    let (report, _) = bench.run(10).unwrap();
    assert_eq!(report, IslandReport { unsupported: true, ..Default::default() });
    assert!(bench.dense() == before);
}

/// Aborted, a pass leaves nothing behind.
#[test]
fn aborted() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let idle = bench.islands.digest();
    bench.set(&Dense::from_fn(16, |[x, y, z]| y == 0 || (x + z) % 2 == 0), &Dense::new(16));
    bench.islands.edited();
    assert_eq!(bench.advance(5).unwrap(), None);
    bench.islands.abort();
    assert_eq!(bench.islands.digest(), idle);
    assert_eq!(bench.islands.recompute_digest(), idle);
    assert_eq!(bench.advance(5).unwrap(), None);
    assert!(!bench.islands.is_busy());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    /// All of the volume masked: all of it stands.
    #[test]
    fn mask_holds(volume in volumes(16)) {
        check_at_rest(&AT_REST_16, &(volume.clone(), volume), 50)?;
    }
}
