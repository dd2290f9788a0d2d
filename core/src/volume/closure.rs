//! The closure rule for one column, and for a line of columns after an edit. The rule, and what follows
//! from it, stands at [`Volume`](crate::Volume).

use crate::volume::range::Range;
use crate::volume::range_maps::Column;
use crate::volume::row::BitSet;

impl<const K: usize> Column<K> {
    /// The column of the exact voxels `voxels`, which had the intervals of `before`, by the closure
    /// rule. Every end of an interval is a voxel of `voxels`.
    #[must_use]
    #[inline]
    pub fn closed_over<R: BitSet>(voxels: R, before: &Self) -> Self {
        let hull = Range::hull_of(voxels);
        let mut column = Self::EMPTY;
        column.0[0] = hull;
        if K == 1 {
            return column;
        }
        let empty = hull.to_row::<R>() & !voxels;
        if empty.is_empty() { column } else { column.with_gaps_among(empty, before.gaps()) }
    }

    /// The same where voxels were only removed.
    #[inline]
    pub(crate) fn closed_over_removal<R: BitSet>(voxels: R, before: &Self) -> Self {
        let widened = match before.has_gaps() {
            true => before.widened(Range::hull_of(voxels), |i| voxels.contains(i)),
            false => None,
        };
        widened.unwrap_or_else(|| Self::closed_over(voxels, before))
    }

    /// The voxels between the first interval and the last that no interval holds, as a row.
    #[must_use]
    #[inline]
    pub fn gaps<R: BitSet>(&self) -> R {
        self.hull().to_row::<R>() & !self.to_row::<R>()
    }

    /// Whether the column has more than one interval.
    #[must_use]
    #[inline]
    pub fn has_gaps(&self) -> bool {
        K > 1 && !self.0[1].is_empty()
    }

    /// A column of one interval with gaps chosen among the runs of `empty`, which lie inside it.
    fn with_gaps_among<R: BitSet>(self, empty: R, old_gaps: R) -> Self {
        let held = empty.flood_from(old_gaps);
        let mut chosen = LongestRuns::<K> { runs: [Range::EMPTY; K], count: 0 };
        chosen.take_longest(held);
        chosen.take_longest(empty & !held);
        chosen.runs[..chosen.count].sort_unstable_by_key(|run| run.first());
        let mut column = Self::EMPTY;
        let mut rest = self.0[0];
        for (i, gap) in chosen.runs[..chosen.count].iter().enumerate() {
            column.0[i] = rest.with_last(gap.first() - 1);
            column.0[i + 1] = rest.with_first(gap.last() + 1);
            rest = column.0[i + 1];
        }
        column
    }
}

/// A line of columns after an edit, whose hulls are new and whose gaps are missing.
pub(crate) struct ClosingLine<'a, const K: usize> {
    /// The line as it was.
    pub(crate) before: &'a [Column<K>],
    /// The line to complete: each changed column is its new hull, as one interval.
    pub(crate) after: &'a mut [Column<K>],
    /// The positions at which voxels changed: outside them, a column that had no gaps is solid as far as its
    /// new hull goes.
    pub(crate) changed: Range,
    /// Whether voxels were only removed.
    pub(crate) removed_only: bool,
}

impl<const K: usize> ClosingLine<'_, K> {
    /// Completes the columns `among` by the closure rule. `row(i)` holds voxel `i` of each column, exact;
    /// `R` is a row along the line and `C` one along a column.
    #[inline]
    pub(crate) fn insert_gaps<R: BitSet, C: BitSet>(mut self, among: R, row: impl Fn(usize) -> R) {
        if K == 1 {
            return;
        }
        let mut solid_before = among;
        for place in among.iter_ones() {
            let before = self.before[place];
            if !before.has_gaps() {
                continue;
            }
            solid_before.toggle(place);
            let hull = self.after[place].0[0];
            let is_occupied = |i: usize| row(i).contains(place);
            let widened = if self.removed_only { before.widened(hull, is_occupied) } else { None };
            self.after[place] = widened.unwrap_or_else(|| {
                Column::closed_over(gather_column::<R, C>(hull, place, &row), &before)
            });
        }
        if !solid_before.is_empty() {
            self.split_at_holes(solid_before, row);
        }
    }

    /// Gives columns that had no gaps the longest runs of empty voxels inside their hull: a scan for the
    /// ends of runs, all columns at once.
    #[inline]
    fn split_at_holes<R: BitSet>(&mut self, among: R, row: impl Fn(usize) -> R) {
        let (first, last) = (self.changed.first(), self.changed.last());
        let (mut inside, mut above) = (R::EMPTY, R::EMPTY);
        for place in among.iter_ones() {
            let hull = self.after[place].0[0];
            inside.insert_if(!hull.is_empty() && hull.first() < first, place);
            above.insert_if(hull.last() > last, place);
        }
        let mut starts = [0; 256];
        let mut in_run = R::EMPTY;
        for i in first..last + 1 {
            let occupied = row(i) & among;
            for place in (in_run & occupied).iter_ones() {
                self.after[place].offer_gap(Range::new(starts[place].into(), i - 1));
            }
            for place in (inside & !occupied & !in_run).iter_ones() {
                starts[place] = i as u8;
            }
            inside |= occupied;
            in_run = inside & !occupied;
        }
        for place in (in_run & above).iter_ones() {
            self.after[place].offer_gap(Range::new(starts[place].into(), last));
        }
    }
}

impl<const K: usize> Column<K> {
    /// This column after voxels were removed, when its hull is `hull`: with its gaps, wider where voxels at
    /// their ends are gone. `None` where a gap went or met another, or there is room for one more: then the
    /// whole column counts.
    #[inline]
    fn widened(mut self, hull: Range, is_occupied: impl Fn(usize) -> bool) -> Option<Self> {
        let has_room = self.0[K - 1].is_empty();
        if has_room || self.0[0].last() < hull.first() || hull.last() < self.0[K - 1].first() {
            return None;
        }
        self.0[0] = self.0[0].with_first(hull.first());
        self.0[K - 1] = self.0[K - 1].with_last(hull.last());
        for interval in 0..K {
            let (mut first, mut last) = (self.0[interval].first(), self.0[interval].last());
            while first <= last && !is_occupied(first) {
                first += 1;
            }
            if first > last {
                return None;
            }
            while !is_occupied(last) {
                last -= 1;
            }
            self.0[interval] = Range::new(first, last);
        }
        Some(self)
    }

    /// Takes a run as a gap if it has room, or in place of a shorter one. Runs must come lowest first.
    #[inline]
    fn offer_gap(&mut self, run: Range) {
        let mut last = self.0.iter().rposition(|interval| !interval.is_empty()).unwrap_or(0);
        if last == K - 1 {
            let gap = |i: usize| self.0[i].first() - self.0[i - 1].last() - 1;
            // Of equally short ones the highest.
            let shortest = (1..K).rev().min_by_key(|&i| gap(i)).unwrap_or(1);
            if gap(shortest) > run.last() - run.first() {
                return;
            }
            self.0[shortest - 1] = self.0[shortest - 1].with_last(self.0[shortest].last());
            self.0.copy_within(shortest + 1.., shortest);
            last -= 1;
        }
        self.0[last + 1] = self.0[last].with_first(run.last() + 1);
        self.0[last] = self.0[last].with_last(run.first() - 1);
    }
}

/// The voxels `rows` of the column at `place` of a line, as a row along the column.
#[inline]
fn gather_column<R: BitSet, C: BitSet>(rows: Range, place: usize, row: impl Fn(usize) -> R) -> C {
    let mut voxels = C::EMPTY;
    for i in rows.first()..rows.last() + 1 {
        voxels.insert_if(row(i).contains(place), i);
    }
    voxels
}

/// Up to K - 1 runs, those of one call of [`LongestRuns::take_longest`] before those of the next.
struct LongestRuns<const K: usize> {
    runs: [Range; K],
    count: usize,
}

impl<const K: usize> LongestRuns<K> {
    /// Appends the longest runs of a row for which there is room, of equally long ones the lowest.
    fn take_longest<R: BitSet>(&mut self, row: R) {
        let taken = self.count;
        for_each_maximal_run(row, |run| {
            let longer = |other: &Range| other.last() - other.first() >= run.last() - run.first();
            let place =
                self.runs[taken..self.count].iter().take_while(|other| longer(other)).count();
            let place = taken + place;
            if place < K - 1 {
                self.count = (self.count + 1).min(K - 1);
                self.runs[place..self.count].rotate_right(1);
                self.runs[place] = run;
            }
        });
    }
}

/// Calls `visit` for each maximal run of set bits, lowest first.
fn for_each_maximal_run<R: BitSet>(row: R, mut visit: impl FnMut(Range)) {
    let mut joined = Range::EMPTY;
    // Runs come split at the borders of words.
    for run in row.iter_runs() {
        if !joined.is_empty() && joined.last() + 1 == run.first() {
            joined = joined.with_last(run.last());
            continue;
        }
        if !joined.is_empty() {
            visit(joined);
        }
        joined = run;
    }
    if !joined.is_empty() {
        visit(joined);
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
        column.0.map(|range| (range.first(), range.last()))
    }

    const NONE: (usize, usize) = (255, 0);

    #[test]
    fn the_longest_runs_are_the_gaps() {
        let voxels = row("..#.##..#...##..#");
        assert_eq!(drawn(Column::closed_over(voxels, &Column::EMPTY)), [(2, 16)]);
        assert_eq!(drawn(Column::closed_over(voxels, &Column::EMPTY)), [(2, 8), (12, 16)]);
        // Of the two runs of two, the lower.
        let after = Column::closed_over(voxels, &Column::EMPTY);
        assert_eq!(drawn(after), [(2, 5), (8, 8), (12, 16)]);
    }

    #[test]
    fn a_held_gap_comes_before_a_longer_one() {
        let before = Column([Range::new(2, 3), Range::new(5, 20)]);
        assert_eq!(drawn(Column::closed_over(row("..##.##......##"), &before)), [(2, 3), (5, 14)]);
        // It grows.
        assert_eq!(drawn(Column::closed_over(row("..#..##......##"), &before)), [(2, 2), (5, 14)]);
        // Split: the longer part.
        let before = Column([Range::new(0, 2), Range::new(9, 20)]);
        assert_eq!(
            drawn(Column::closed_over(row("###.#....####...#"), &before)),
            [(0, 4), (9, 16)]
        );
        // Outside the hull it is none: the whole column is searched.
        assert_eq!(
            drawn(Column::closed_over(row(".........####...#"), &before)),
            [(9, 12), (16, 16)]
        );
        // Two that become one leave room.
        let before = Column([Range::new(0, 2), Range::new(5, 5), Range::new(7, 12)]);
        let after = Column::closed_over(row("###.....####.#"), &before);
        assert_eq!(drawn(after), [(0, 2), (8, 11), (13, 13)]);
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
