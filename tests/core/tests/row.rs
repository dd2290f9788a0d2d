//! Bit rows, bit grids and range maps against plain booleans.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::internals::{BitRow, maps_digest};
use paros_core::volume::{Axis, BitGrid, BitSet, Column, Grid, Range, Size};
use paros_core::{RangeMaps, Volume};
use paros_models::cases::random_cases;
use paros_models::dense::{DenseVolume, any_voxels};
use proptest::prelude::*;

type RowType<const N: usize> = <Grid<N> as Size>::Row;

fn row_from_bits<const N: usize>(bits: &[bool]) -> RowType<N>
where
    Grid<N>: Size,
{
    let mut row = RowType::<N>::EMPTY;
    bits.iter().enumerate().filter(|(_, bit)| **bit).for_each(|(i, _)| row.insert(i));
    row
}

/// Returns the lowest `n` bits of a row. Asserts that no higher bit is set.
fn row_to_bits<R: BitSet>(row: R, n: usize) -> Vec<bool> {
    assert!((n..64 * R::WORDS).all(|i| !row.contains(i)), "a bit above the grid: {row:?}");
    (0..n).map(|i| row.contains(i)).collect()
}

/// A strategy for `n` bits: of all densities, in runs of all lengths, full, empty, and one bit set or clear.
fn any_bits(n: usize) -> impl Strategy<Value = Vec<bool>> {
    prop_oneof![
        4 => proptest::collection::vec(any::<bool>(), n),
        2 => (1..9u8).prop_flat_map(move |d| proptest::collection::vec((0..9u8).prop_map(move |b| b < d), n)),
        4 => proptest::collection::vec(1..40usize, n).prop_map(move |runs| {
            let runs = runs.into_iter().enumerate();
            runs.flat_map(|(i, run)| std::iter::repeat_n(i % 2 == 0, run)).take(n).collect()
        }),
        1 => Just(vec![true; n]),
        1 => Just(vec![false; n]),
        1 => (0..n).prop_map(move |i| (0..n).map(|j| j == i).collect()),
        1 => (0..n).prop_map(move |i| (0..n).map(|j| j != i).collect()),
    ]
}

fn assert_row_is_bit_by_bit<const N: usize>(a: &[bool], b: &[bool], (lo, hi): (usize, usize))
where
    Grid<N>: Size,
{
    let (ra, rb) = (row_from_bits::<N>(a), row_from_bits::<N>(b));
    let full = Grid::<N>::FULL;
    let each = |op: fn(bool, bool) -> bool| (0..N).map(|i| op(a[i], b[i])).collect::<Vec<_>>();
    assert_eq!(row_to_bits(ra, N), a);
    assert_eq!(row_to_bits(full, N), vec![true; N]);
    assert_eq!(row_to_bits(ra & rb, N), each(|a, b| a & b));
    assert_eq!(row_to_bits(ra | rb, N), each(|a, b| a | b));
    assert_eq!(row_to_bits(ra ^ rb, N), each(|a, b| a ^ b));
    assert_eq!(row_to_bits(!ra & full, N), each(|a, _| !a));
    assert_eq!(row_to_bits(ra & !rb, N), each(|a, b| a & !b));
    assert_eq!(
        row_to_bits(ra.shifted_up() & full, N),
        (0..N).map(|i| i > 0 && a[i - 1]).collect::<Vec<_>>()
    );
    assert_eq!(
        row_to_bits(ra.shifted_down(), N),
        (0..N).map(|i| i + 1 < N && a[i + 1]).collect::<Vec<_>>()
    );
    assert_eq!(row_to_bits(ra.mirrored(N), N), a.iter().rev().copied().collect::<Vec<_>>());
    assert_eq!(
        row_to_bits(RowType::<N>::span(lo, hi), N),
        (0..N).map(|i| lo <= i && i <= hi).collect::<Vec<_>>()
    );
    let ones: Vec<_> = (0..N).filter(|&i| a[i]).collect();
    assert_eq!(ra.iter_ones().collect::<Vec<_>>(), ones);
    assert_eq!(ra.count_ones() as usize, ones.len());
    assert_eq!(ra.is_empty(), ones.is_empty());
    assert_eq!((ra.first(), ra.last()), (ones.first().copied(), ones.last().copied()));
    let runs: Vec<_> = ra.iter_runs_within_words().map(|run| (run.first(), run.last())).collect();
    assert_eq!(runs, runs_in_words(a));
    let mut toggled = ra;
    toggled.toggle(lo);
    assert_eq!(row_to_bits(ra ^ toggled, N), (0..N).map(|i| i == lo).collect::<Vec<_>>());
    assert_eq!(row_to_bits(ra.flood_from(rb), N), runs_with_seeds(a, b));
    assert_eq!(row_to_bits(ra.without_lowest_run(), N), bits_beyond_lowest_run(a));
    let range = Range::hull_of(ra);
    assert_eq!(
        (range.is_empty(), range.to_row::<RowType<N>>()),
        match (ra.first(), ra.last()) {
            (Some(lo), Some(hi)) => (false, RowType::<N>::span(lo, hi)),
            _ => (true, RowType::<N>::EMPTY),
        }
    );
}

/// Returns the bits of `a` beyond its lowest run, found bit by bit.
fn bits_beyond_lowest_run(a: &[bool]) -> Vec<bool> {
    let first = a.iter().position(|&bit| bit).unwrap_or(a.len());
    let end = a[first..].iter().position(|&bit| !bit).map_or(a.len(), |length| first + length);
    a.iter().enumerate().map(|(i, &bit)| bit && i >= end).collect()
}

/// Returns the runs of `a` that contain a seed, found bit by bit.
fn runs_with_seeds(a: &[bool], seeds: &[bool]) -> Vec<bool> {
    let mut found = vec![false; a.len()];
    let mut i = 0;
    while i < a.len() {
        let end = (i..a.len()).find(|&j| !a[j]).unwrap_or(a.len());
        if (i..end).any(|j| seeds[j]) {
            found[i..end].fill(true);
        }
        i = end + 1;
    }
    found
}

/// Returns the first and last bit of each run; runs are split at the borders of 64-bit words.
fn runs_in_words(a: &[bool]) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = vec![];
    for i in (0..a.len()).filter(|&i| a[i]) {
        match runs.last_mut() {
            Some((_, hi)) if *hi + 1 == i && i % 64 != 0 => *hi = i,
            _ => runs.push((i, i)),
        }
    }
    runs
}

/// Returns maps with one line of columns: those set in `columns` have intervals with the ends `ends`, the
/// others are empty.
fn line_from_columns<const N: usize, const K: usize>(
    columns: &[bool],
    ends: &[[usize; 8]],
) -> RangeMaps<N, K> {
    let mut maps = RangeMaps::new();
    for place in (0..N).filter(|&place| columns[place]) {
        maps.set_column(Axis::Z, (1, place), column_from_ends(ends[place]));
    }
    maps
}

/// Builds a column from sorted ends, with as many intervals as don't touch.
fn column_from_ends<const K: usize>(mut ends: [usize; 8]) -> Column<K> {
    ends.sort_unstable();
    let mut column = Column::EMPTY;
    for (i, [first, last]) in ends.as_chunks().0[..K].iter().enumerate() {
        if i > 0 && column.range(i - 1).last() + 1 >= *first {
            break;
        }
        column.set_range(i, Range::new(*first, *last));
    }
    column
}

fn assert_line_is_column_by_column<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    columns: &[bool],
    (first, last): (usize, usize),
) where
    Grid<N>: Size,
{
    let each = |f: &dyn Fn(Range) -> bool| {
        let line = maps.line(Axis::Z, 1).iter();
        line.map(|column| f(column.hull())).collect::<Vec<_>>()
    };
    assert_eq!(row_to_bits(maps.occupied_columns(Axis::Z, 1), N), each(&|range| !range.is_empty()));
    let beyond = maps.columns_beyond(Axis::Z, 1, row_from_bits::<N>(columns), first, last);
    let among = |row: RowType<N>, f: &dyn Fn(Range) -> bool| {
        let expected = each(f).into_iter().zip(columns).map(|(is, among)| is && *among);
        assert_eq!(row_to_bits(row, N), expected.collect::<Vec<_>>());
    };
    among(beyond.below_first, &|range| range.first() < first);
    among(beyond.above_last, &|range| range.last() > last);
}

macro_rules! lines {
    ($($name:ident: $n:literal, of $($k:literal)+;)*) => {
        proptest! {
            #![proptest_config(random_cases(100))]
            $(#[test]
            fn $name(
                held in any_bits($n),
                columns in any_bits($n),
                ends in proptest::collection::vec(proptest::array::uniform8(0..$n as usize), $n),
                first in 0..$n as usize,
                last in 0..$n as usize,
            ) {
                $(let maps = line_from_columns::<$n, $k>(&held, &ends);
                assert_line_is_column_by_column(&maps, &columns, (first, last));)+
            })*
        }
    };
}

lines! {
    lines_of_16_are_column_by_column: 16, of 1 2 4;
    lines_of_128_are_column_by_column: 128, of 2;
    lines_of_256_are_column_by_column: 256, of 1;
}

macro_rules! rows {
    ($($name:ident: $n:literal;)*) => {
        proptest! {
            #![proptest_config(random_cases(300))]
            $(#[test]
            fn $name(a in any_bits($n), b in any_bits($n), lo in 0..$n as usize, hi in 0..$n as usize) {
                assert_row_is_bit_by_bit::<$n>(&a, &b, (lo, hi));
            })*
        }
    };
}

rows! {
    rows_of_16: 16;
    rows_of_32: 32;
    rows_of_64: 64;
    rows_of_128: 128;
    rows_of_256: 256;
}

#[test]
fn a_bit_that_is_set_again_stays_set() {
    for i in [0, 5, 63, 64, 127] {
        let mut row = BitRow::<2>::EMPTY;
        row.insert_if(false, i);
        assert_eq!(row, BitRow::EMPTY);
        for set in [true, true, false] {
            row.insert_if(set, i);
            assert_eq!(row, BitRow::span(i, i));
        }
        row.insert(i);
        assert_eq!(row, BitRow::span(i, i));
        row.toggle(i);
        assert_eq!(row, BitRow::EMPTY);
    }
}

#[test]
fn every_range_is_its_two_bytes_again() {
    for n in [16usize, 32, 64, 128, 256] {
        let mut valid = 0;
        for bytes in 0..=u16::MAX {
            if let Some(range) = Range::from_bytes(bytes.to_le_bytes(), n) {
                valid += 1;
                assert_eq!(range.to_bytes(), bytes.to_le_bytes());
                let occupied: Vec<_> = (0..256).filter(|&i| range.contains(i)).collect();
                assert!(occupied.iter().all(|&i| i < n));
                assert_eq!(occupied.is_empty(), range.is_empty());
                if !range.is_empty() {
                    assert_eq!(range, Range::new(occupied[0], occupied[occupied.len() - 1]));
                }
                assert_eq!(range.is_empty(), range == Range::EMPTY);
            }
        }
        assert_eq!(valid, 1 + n * (n + 1) / 2, "ranges of a grid of {n}");
    }
}

proptest! {
    #[test]
    fn the_hull_of_two_ranges_holds_both(a in 0..257usize, b in 0..257usize, c in 0..257usize, d in 0..257usize) {
        let range = |a: usize, b: usize| if a.max(b) > 255 { Range::EMPTY } else { Range::new(a.min(b), a.max(b)) };
        let (p, q) = (range(a, b), range(c, d));
        let held: Vec<_> = (0..256).filter(|&i| p.contains(i) || q.contains(i)).collect();
        let hull = held.first().map_or(Range::EMPTY, |&lo| Range::new(lo, held[held.len() - 1]));
        prop_assert_eq!(p.hull_with(q), hull);
    }
}

struct GridPair<const N: usize>
where
    Grid<N>: Size,
{
    plane: BitGrid<N>,
    other: BitGrid<N>,
    maps: RangeMaps<N>,
    volume: Volume<N>,
}

impl<const N: usize> GridPair<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        GridPair {
            plane: BitGrid::new(),
            other: BitGrid::new(),
            maps: RangeMaps::new(),
            volume: Volume::new(),
        }
    }
}

fn lock_mutex<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Asserts that hulls, expansion and the volume made of them equal the model's closure.
fn assert_grid_closes_as_model<const N: usize>(grids: &mut GridPair<N>, dense: &DenseVolume)
where
    Grid<N>: Size,
{
    let GridPair { plane, other, maps, volume } = grids;
    plane.clear();
    dense.insert_into_empty_bits(plane);
    assert_eq!(&DenseVolume::from_bits(plane), dense);
    assert_eq!(plane.count_voxels(), u64::from(dense.count()));
    plane.write_hulls(maps);
    for axis in Axis::ALL {
        for at in (0..N * N).map(|i| (i / N, i % N)) {
            let range = maps.column(axis, at).range(0);
            let hull = (!range.is_empty()).then_some(range);
            assert_eq!(hull, dense.column_hull(axis, at), "{axis:?} {at:?}");
        }
    }
    let closed = dense.closure();
    assert_eq!(DenseVolume::from_maps(maps), closed);
    plane.set_from_maps(maps);
    assert_eq!(DenseVolume::from_bits(plane), closed);
    assert_eq!(closed.closure(), closed, "closure is idempotent");
    volume.set_voxels(|plane| dense.insert_into_empty_bits(plane));
    assert_eq!((volume.maps(), volume.rows()), (&*maps, &*plane));
    assert_eq!(volume.digest(), maps_digest(maps));
    assert_eq!(volume.count_voxels(), u64::from(closed.count()));
    assert_eq!(volume.touches_ground(), closed.occupied().any(|voxel| voxel[1] == 0));
    assert_eq!(maps.is_empty(), closed.is_empty());
    other.copy_from(plane);
    for y in 0..N {
        for z in 0..N {
            let all = maps.occupied_among((y, z), Grid::<N>::FULL);
            assert_eq!(all, plane.row(y, z));
            assert_eq!(other.layer(y)[z], all);
        }
    }
}

proptest! {
    #![proptest_config(random_cases(150))]

    #[test]
    fn planes_of_16_close_as_the_model(dense in any_voxels(16)) {
        static GRIDS: Mutex<GridPair<16>> = Mutex::new(GridPair::new());
        assert_grid_closes_as_model(&mut lock_mutex(&GRIDS), &dense);
    }

    #[test]
    fn a_map_digest_tells_columns_apart(
        axis in 0..3usize, line in 0..16usize, place in 0..16usize, a in 0..16usize, b in 0..16usize,
    ) {
        static MAPS: Mutex<RangeMaps<16>> = Mutex::new(RangeMaps::new());
        let maps = &mut *lock_mutex(&MAPS);
        maps.clear();
        prop_assert_eq!(maps_digest(maps), 0);
        maps.set_column(Axis::ALL[axis], (line, place), Column::new([Range::new(a.min(b), a.max(b))]));
        let one = maps_digest(maps);
        prop_assert_ne!(one, 0);
        maps.set_column(Axis::ALL[axis], (line, place), Column::EMPTY);
        maps.set_column(Axis::ALL[(axis + 1) % 3], (line, place), Column::new([Range::new(a.min(b), a.max(b))]));
        prop_assert_ne!(maps_digest(maps), one);
    }
}

proptest! {
    #![proptest_config(random_cases(20))]

    #[test]
    fn planes_of_32_close_as_the_model(dense in any_voxels(32)) {
        static GRIDS: Mutex<GridPair<32>> = Mutex::new(GridPair::new());
        assert_grid_closes_as_model(&mut lock_mutex(&GRIDS), &dense);
    }
}

proptest! {
    #![proptest_config(random_cases(2))]

    #[test]
    fn planes_of_64_close_as_the_model(dense in any_voxels(64)) {
        static GRIDS: Mutex<GridPair<64>> = Mutex::new(GridPair::new());
        assert_grid_closes_as_model(&mut lock_mutex(&GRIDS), &dense);
    }
}

proptest! {
    #![proptest_config(random_cases(1))]

    #[test]
    fn planes_of_128_close_as_the_model(dense in any_voxels(128)) {
        static GRIDS: Mutex<GridPair<128>> = Mutex::new(GridPair::new());
        assert_grid_closes_as_model(&mut lock_mutex(&GRIDS), &dense);
    }
}

#[test]
fn a_full_grid_of_256_closes_as_the_model() {
    static GRIDS: Mutex<GridPair<256>> = Mutex::new(GridPair::new());
    let grids = &mut *lock_mutex(&GRIDS);
    grids.volume.set_voxels(|plane| {
        (0..256).for_each(|y| plane.layer_mut(y).fill(Grid::<256>::FULL));
    });
    assert_eq!(grids.volume.count_voxels(), 1 << 24);
    assert_eq!(grids.volume.maps().column(Axis::Y, (255, 255)), Column::new([Range::new(0, 255)]));
}
