//! The closure rule for one column. [`Volume`](crate::Volume) documents the rule and its consequences.

use core::cmp::Reverse;

use crate::volume::range::Range;
use crate::volume::range_maps::Column;
use crate::volume::row::BitSet;

impl<const K: usize> Column<K> {
    /// Returns the closure of the exact voxels `voxels`, by the closure rule. `before` is the column before
    /// the edit. Every end of an interval is a voxel of `voxels`.
    #[must_use]
    #[inline]
    pub fn closed_over<R: BitSet>(voxels: R, before: &Self) -> Self {
        let hull = Range::hull_of(voxels);
        if K == 1 || voxels.without_lowest_run().is_empty() {
            return Self::from_range(hull);
        }
        Self::from_runs(&voxels, hull)
            .unwrap_or_else(|| Self::with_chosen_gaps(voxels, hull, before))
    }

    /// Returns the column of `hull` whose intervals are the runs of `voxels`, or `None` if there are more
    /// than K runs.
    #[inline(never)] // runs are rarely more than one
    fn from_runs<R: BitSet>(voxels: &R, hull: Range) -> Option<Self> {
        let (mut column, mut rest) = (Self::from_range(hull), *voxels);
        let mut beyond = rest.without_lowest_run();
        let mut interval = 0;
        while let Some(first) = beyond.first() {
            let last = (rest ^ beyond).last()?;
            if interval + 1 == K {
                return None;
            }
            column.set_range(interval + 1, hull.with_first(first));
            column.set_range(interval, column.range(interval).with_last(last));
            (rest, beyond, interval) = (beyond, beyond.without_lowest_run(), interval + 1);
        }
        Some(column)
    }

    /// Returns the voxels in the gaps between the first and the last interval, as a row.
    #[must_use]
    #[inline]
    pub fn gaps<R: BitSet>(&self) -> R {
        self.hull().to_row::<R>() & !self.to_row::<R>()
    }

    /// Returns `true` if the column has more than one interval.
    #[must_use]
    #[inline]
    pub fn has_gaps(&self) -> bool {
        K > 1 && !self.range(1).is_empty()
    }

    /// Returns `true` if a run of empty voxels holds a voxel of one of the column's gaps.
    #[inline]
    pub(crate) fn has_gap_overlapping(&self, run: Range) -> bool {
        (1..K).any(|i| {
            let (below, above) = (self.range(i - 1), self.range(i));
            !above.is_empty() & (below.last() < run.last()) & (run.first() < above.first())
        })
    }

    /// Returns `true` if the column has no room for another gap.
    #[inline]
    pub(crate) fn is_full(&self) -> bool {
        !self.range(K - 1).is_empty()
    }

    /// Returns the index of the last interval that isn't empty.
    #[inline]
    fn last_index(&self) -> usize {
        self.ranges().iter().rposition(|interval| !interval.is_empty()).unwrap_or(0)
    }

    /// Moves the first end of the hull. Drops intervals that lie below it, but keeps at least one.
    #[inline]
    pub(crate) fn set_hull_first(&mut self, first: usize) {
        while self.has_gaps() && self.range(0).last() < first {
            let mut ranges = self.ranges();
            ranges.rotate_left(1);
            ranges[K - 1] = Range::EMPTY;
            *self = Self::new(ranges);
        }
        self.set_range(0, self.range(0).with_first(first));
    }

    /// Moves the last end of the hull. Drops intervals that lie above it, but keeps at least one.
    #[inline]
    pub(crate) fn set_hull_last(&mut self, last: usize) {
        let mut index = self.last_index();
        while index > 0 && last < self.range(index).first() {
            self.set_range(index, Range::EMPTY);
            index -= 1;
        }
        self.set_range(index, self.range(index).with_last(last));
    }

    /// Returns `true` if both voxels beside each gap are occupied.
    #[inline]
    pub(crate) fn do_gap_ends_stand(&self, is_occupied: impl Fn(usize) -> bool) -> bool {
        (1..K).fold(true, |all, i| {
            all & is_occupied(self.range(i - 1).last()) & is_occupied(self.range(i).first())
        })
    }

    /// Returns `true` if no voxel of a gap is occupied at the positions `among`.
    #[inline]
    pub(crate) fn are_gaps_empty(&self, among: Range, is_occupied: impl Fn(usize) -> bool) -> bool {
        (1..K).all(|i| {
            let (below, above) = (self.range(i - 1).last(), self.range(i).first());
            !(among.first().max(below + 1)..(among.last() + 1).min(above)).any(&is_occupied)
        })
    }

    /// Returns the column of `hull` with gaps chosen among the runs of empty voxels.
    fn with_chosen_gaps<R: BitSet>(voxels: R, hull: Range, before: &Self) -> Self {
        let gaps = before.gaps::<R>();
        let stand = before.is_full() && before.do_gap_ends_stand(|i| voxels.contains(i));
        if stand && (gaps & voxels).is_empty() {
            let mut column = *before;
            column.set_hull_first(hull.first());
            column.set_hull_last(hull.last());
            return column;
        }
        let empty = hull.to_row::<R>() & !voxels;
        let held = empty.flood_from(gaps);
        let mut chosen = ChosenGaps::NONE;
        chosen.insert_runs(held, true);
        if !chosen.is_full() {
            chosen.insert_runs(empty & !held, false);
        }
        chosen.into_column(hull)
    }
}

/// The runs that become a column's gaps: the first K - 1 of all inserted runs, in the closure rule's order.
#[derive(Clone, Copy)]
pub(crate) struct ChosenGaps<const K: usize> {
    /// The runs in that order. The last element is always empty.
    ranks: [GapRank; K],
}

/// The rank of a run as a number; a greater number comes earlier in the closure rule's order. From the
/// highest byte on: a flag, 1 if the run holds a voxel of a gap that the column had before, its length, and
/// the complement of its first voxel. 0 means no run.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct GapRank(u32);

impl GapRank {
    const NONE: Self = GapRank(0);

    #[inline]
    fn new(run: Range, is_held: bool) -> Self {
        let [not_first, last] = run.to_bytes();
        let length = u32::from(last) + u32::from(not_first) + 1 - 255;
        GapRank(u32::from(is_held) << 16 | length << 8 | u32::from(not_first))
    }

    #[inline]
    fn run(self) -> Range {
        let [not_first, length, ..] = self.0.to_le_bytes();
        let first = usize::from(!not_first);
        Range::new(first, first + usize::from(length) - 1)
    }
}

impl<const K: usize> ChosenGaps<K> {
    /// No runs.
    pub(crate) const NONE: Self = ChosenGaps { ranks: [GapRank::NONE; K] };

    /// Returns `true` if there is no room for another run.
    pub(crate) fn is_full(&self) -> bool {
        self.ranks[..K - 1].iter().all(|rank| *rank != GapRank::NONE)
    }

    /// Inserts a run, and drops the last one if there are K then.
    #[inline]
    pub(crate) fn insert(&mut self, run: Range, is_held: bool) {
        let mut rank = GapRank::new(run, is_held);
        for kept in &mut self.ranks[..K - 1] {
            (*kept, rank) = (rank.max(*kept), rank.min(*kept));
        }
    }

    /// Inserts the runs of a row.
    pub(crate) fn insert_runs<R: BitSet>(&mut self, row: R, are_held: bool) {
        let mut rest = row;
        while !rest.is_empty() {
            let beyond = rest.without_lowest_run();
            self.insert(Range::hull_of(rest ^ beyond), are_held);
            rest = beyond;
        }
    }

    /// Returns the column of a hull with these gaps.
    #[inline]
    pub(crate) fn into_column(mut self, hull: Range) -> Column<K> {
        let mut column = Column::from_range(hull);
        let gaps = &mut self.ranks[..K - 1];
        // The lowest gap first, empty ranks last.
        gaps.sort_unstable_by_key(|gap| Reverse(gap.0 & 0xff));
        for (i, gap) in gaps.iter().enumerate() {
            if *gap != GapRank::NONE {
                let gap = gap.run();
                column.set_range(i, column.range(i).with_last(gap.first() - 1));
                column.set_range(i + 1, hull.with_first(gap.last() + 1));
            }
        }
        column
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::row::BitRow;

    fn row(voxels: &str) -> BitRow<4> {
        let mut row = BitRow::EMPTY;
        voxels.bytes().enumerate().for_each(|(i, c)| row.insert_if(c == b'#', i));
        row
    }

    fn drawn<const K: usize>(column: Column<K>) -> [(usize, usize); K] {
        column.ranges().map(|range| (range.first(), range.last()))
    }

    const NONE: (usize, usize) = (255, 0);

    #[test]
    fn the_longest_runs_are_the_gaps() {
        let voxels = row("..#.##..#...##..#");
        assert_eq!(drawn(Column::closed_over(voxels, &Column::EMPTY)), [(2, 16)]);
        assert_eq!(drawn(Column::closed_over(voxels, &Column::EMPTY)), [(2, 8), (12, 16)]);
        // The lower of the two runs of two.
        let after = Column::closed_over(voxels, &Column::EMPTY);
        assert_eq!(drawn(after), [(2, 5), (8, 8), (12, 16)]);
    }

    #[test]
    fn a_held_gap_comes_before_a_longer_one() {
        let before = Column::new([Range::new(2, 3), Range::new(5, 20)]);
        assert_eq!(drawn(Column::closed_over(row("..##.##......##"), &before)), [(2, 3), (5, 14)]);
        // The gap grows.
        assert_eq!(drawn(Column::closed_over(row("..#..##......##"), &before)), [(2, 2), (5, 14)]);
        // The gap is split: the longer part is kept.
        let before = Column::new([Range::new(0, 2), Range::new(9, 20)]);
        assert_eq!(
            drawn(Column::closed_over(row("###.#....####...#"), &before)),
            [(0, 4), (9, 16)]
        );
        // A gap outside the hull no longer counts: the whole column is searched.
        assert_eq!(
            drawn(Column::closed_over(row(".........####...#"), &before)),
            [(9, 12), (16, 16)]
        );
        // Two gaps that become one leave room for another.
        let before = Column::new([Range::new(0, 2), Range::new(5, 5), Range::new(7, 12)]);
        let after = Column::closed_over(row("###.....####.#"), &before);
        assert_eq!(drawn(after), [(0, 2), (8, 11), (13, 13)]);
    }

    #[test]
    fn an_end_that_moves_past_a_gap_drops_the_interval_beyond() {
        let before = Column::new([Range::new(2, 3), Range::new(5, 9), Range::new(12, 20)]);
        let mut column = before;
        column.set_hull_last(12);
        assert_eq!(drawn(column), [(2, 3), (5, 9), (12, 12)]);
        column.set_hull_last(9);
        assert_eq!(drawn(column), [(2, 3), (5, 9), NONE]);
        column.set_hull_first(4);
        assert_eq!(drawn(column), [(4, 9), NONE, NONE]);
        column = before;
        column.set_hull_first(13);
        assert_eq!(drawn(column), [(13, 20), NONE, NONE]);
        // One interval remains, wherever its ends move.
        column.set_hull_last(8);
        column.set_hull_first(7);
        assert_eq!(drawn(column), [(7, 8), NONE, NONE]);
        column.set_hull_first(30);
        column.set_hull_last(31);
        assert_eq!(drawn(column), [(30, 31), NONE, NONE]);
        // An interval of a single voxel at the end doesn't lie beyond it.
        column = before;
        column.set_hull_first(3);
        column.set_hull_last(5);
        assert_eq!(drawn(column), [(3, 3), (5, 5), NONE]);
    }

    /// All columns of eight voxels with up to three intervals, all stretches of them and all sets of voxels:
    /// the tests of gaps position by position agree with the tests by rows.
    #[test]
    fn gaps_are_asked_position_by_position_as_row_by_row() {
        let set = |bits: u64| {
            let mut row = BitRow::<4>::EMPTY;
            row.set_word(0, bits);
            row
        };
        let stretches = || (0..8).flat_map(|first| (first..8).map(move |last| (first, last)));
        for voxels in (0..256).map(set) {
            let Some(column) = Column::<3>::from_runs(&voxels, Range::hull_of(voxels)) else {
                continue;
            };
            let gaps: BitRow<4> = column.gaps();
            assert_eq!(column.has_gaps(), !gaps.is_empty());
            for (first, last) in stretches() {
                let (run, among) = (Range::new(first, last), BitRow::<4>::span(first, last));
                let is_one = !(gaps & among).is_empty();
                assert_eq!(column.has_gap_overlapping(run), is_one, "{column:?}, {run:?}");
            }
            // The other tests need a column that has all its gaps.
            for now in (0..256).map(set).filter(|_| column.is_full()) {
                let is_occupied = |i: usize| now.contains(i);
                let beside = (gaps.shifted_up() | gaps.shifted_down()) & voxels;
                let do_stand = (beside & !now).is_empty();
                assert_eq!(column.do_gap_ends_stand(is_occupied), do_stand, "{column:?}, {now:?}");
                for (first, last) in stretches() {
                    let are_empty = (gaps & now & BitRow::span(first, last)).is_empty();
                    let among = Range::new(first, last);
                    let found = column.are_gaps_empty(among, is_occupied);
                    assert_eq!(found, are_empty, "{column:?}, {now:?}, {among:?}");
                }
            }
        }
    }

    #[test]
    fn runs_cross_the_borders_of_words() {
        let mut voxels = BitRow::<4>::EMPTY;
        [3, 60, 200, 220].into_iter().for_each(|i| voxels.insert(i));
        let after = Column::closed_over(voxels, &Column::EMPTY);
        assert_eq!(drawn(after), [(3, 60), (200, 220)]);
        assert_eq!(drawn(Column::<2>::closed_over(BitRow::<4>::EMPTY, &after)), [NONE, NONE]);
    }
}
