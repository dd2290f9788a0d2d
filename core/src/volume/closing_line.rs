//! The closure rule for a line of columns after an edit. It processes only columns that the edit touched, as
//! far as possible all at once with bit operations.

use crate::volume::closure::ChosenGaps;
use crate::volume::line_scan::{HoleScan, close_columns};
use crate::volume::range::Range;
use crate::volume::range_maps::{Column, find_columns};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// A line of columns after an edit, with known hulls and gaps still to be computed.
pub(crate) struct ClosingLine<'a, const K: usize> {
    /// The line before the edit.
    pub(crate) before: &'a [Column<K>],
    /// The line to complete: each changed column as before the edit, except for the new ends of its hull and
    /// the intervals beyond them, which are removed.
    pub(crate) after: &'a mut [Column<K>],
    /// The positions of the changed voxels.
    pub(crate) changed: Range,
    /// `true` if voxels were only removed.
    pub(crate) removed_only: bool,
}

/// Returns the columns `among` of a line that have gaps.
#[inline]
pub(crate) fn find_gapped<R: BitSet, const K: usize>(line: &[Column<K>], among: R) -> R {
    // Every interval except the first.
    if K == 1 { R::EMPTY } else { find_columns(line, among, |column| column >> 16 != 0) }
}

impl<const K: usize> ClosingLine<'_, K> {
    /// Completes the columns `among`, in which voxels changed, by the closure rule. `gapped` are the columns
    /// among them that had gaps. `row(i)` holds voxel `i` of each column, exact. Returns the columns whose
    /// gaps changed, and possibly others if voxels were added.
    #[inline]
    pub(crate) fn close_gaps<const N: usize, R: BitSet>(
        mut self,
        among: R,
        gapped: R,
        row: impl Fn(usize) -> R,
    ) -> R
    where
        Grid<N>: Size,
    {
        if K == 1 {
            return R::EMPTY;
        }
        let TouchedGaps { widened, filled, mut lost } = if self.removed_only {
            self.widen_gaps(gapped, &row)
        } else {
            self.find_touched_gaps(gapped, &row)
        };
        for place in filled.iter_ones() {
            let voxels: <Grid<N> as Size>::Row = gather_column(self.changed, place, &row);
            let mut chosen = ChosenGaps::<K>::NONE;
            let gaps = self.before[place].gaps::<<Grid<N> as Size>::Row>();
            chosen.insert_runs(gaps & !voxels, true);
            if chosen.is_full() {
                self.after[place] = chosen.into_column(self.after[place].hull());
            } else {
                lost.insert(place);
            }
        }
        let solid = among & !gapped;
        let scanned = self.positions_of_holes(solid);
        let split = if solid.is_empty() { solid } else { find_split::<N, R>(solid, scanned, &row) };
        for place in split.iter_ones() {
            match self.split_once(place, scanned, &row) {
                Some(column) => self.after[place] = column,
                None => lost.insert(place),
            }
        }
        self.close_lost::<N, _>(lost, &row);
        widened | filled | split | lost
    }

    /// Completes columns that must be searched as a whole; several columns are scanned at once. Most columns
    /// that lost an island have one interval now.
    #[inline]
    fn close_lost<const N: usize, R: BitSet>(&mut self, lost: R, row: impl Fn(usize) -> R)
    where
        Grid<N>: Size,
    {
        if lost.count_ones() < LEAST_SCANNED {
            for place in lost.iter_ones() {
                let hull = self.after[place].hull();
                let voxels: <Grid<N> as Size>::Row = gather_column(hull, place, &row);
                self.after[place] = Column::closed_over(voxels, &self.before[place]);
            }
            return;
        }
        let mut span = Range::EMPTY;
        for place in lost.iter_ones() {
            let hull = self.after[place].hull();
            span = span.hull_with(hull);
            self.after[place] = Column::from_range(hull);
        }
        let mut holes = HoleScan::NONE;
        (span.first()..span.last() + 1).for_each(|i| holes.pass(row(i) & lost));
        if !holes.found.is_empty() {
            close_columns::<N, K, _>(self.before, self.after, holes.found, span, row);
        }
    }

    /// Widens the gaps of columns after a removal, where voxels at their ends are gone.
    #[inline]
    fn widen_gaps<R: BitSet>(&mut self, gapped: R, row: impl Fn(usize) -> R) -> TouchedGaps<R> {
        let (mut widened, mut lost) = (R::EMPTY, R::EMPTY);
        for place in gapped.iter_ones() {
            // With fewer intervals, a gap was cut off with an end of the hull.
            let is_full = self.before[place].is_full() & self.after[place].is_full();
            lost.insert_if(!is_full, place);
        }
        let full = gapped & !lost;
        for i in 1..K {
            let (mut below, mut above) = (R::EMPTY, R::EMPTY);
            for place in full.iter_ones() {
                let before = self.before[place];
                below.insert_if(!row(before.range(i - 1).last()).contains(place), place);
                above.insert_if(!row(before.range(i).first()).contains(place), place);
            }
            for place in below.iter_ones() {
                let interval = self.after[place].range(i - 1);
                match find_last_voxel(interval, place, &row) {
                    Some(last) => self.after[place].set_range(i - 1, interval.with_last(last)),
                    None => lost.insert(place),
                }
            }
            for place in above.iter_ones() {
                let interval = self.after[place].range(i);
                match find_first_voxel(interval, place, &row) {
                    Some(first) => self.after[place].set_range(i, interval.with_first(first)),
                    None => lost.insert(place),
                }
            }
            widened |= below | above;
        }
        TouchedGaps { widened, filled: R::EMPTY, lost }
    }

    /// Finds the gaps to update where voxels were added. The `filled` columns aren't changed yet.
    #[inline]
    fn find_touched_gaps<R: BitSet>(&self, gapped: R, row: impl Fn(usize) -> R) -> TouchedGaps<R> {
        let (mut filled, mut lost) = (R::EMPTY, R::EMPTY);
        for place in gapped.iter_ones() {
            let is_occupied = |i: usize| row(i).contains(place);
            let before = self.before[place];
            let stand = before.is_full() && before.do_gap_ends_stand(is_occupied);
            lost.insert_if(!stand, place);
            filled.insert_if(stand && !before.are_gaps_empty(self.changed, is_occupied), place);
        }
        TouchedGaps { widened: R::EMPTY, filled, lost }
    }

    /// Returns the column at `place`, which had no gaps, with its only hole at the positions `scanned`, or
    /// `None` if there are more holes.
    #[inline]
    fn split_once<R: BitSet>(
        &self,
        place: usize,
        scanned: Range,
        row: impl Fn(usize) -> R,
    ) -> Option<Column<K>> {
        let mut column = self.after[place];
        let hull = column.range(0);
        let first = scanned.first().max(hull.first());
        let hole = find_only_hole_within_64((first, scanned.last().min(hull.last())), place, row)?;
        column.set_range(0, hull.with_last(hole.first() - 1));
        column.set_range(1, hull.with_first(hole.last() + 1));
        Some(column)
    }

    /// Returns the only positions at which columns that had no gaps can have an empty voxel inside their
    /// hull.
    #[inline]
    fn positions_of_holes<R: BitSet>(&self, columns: R) -> Range {
        if self.removed_only {
            return self.changed;
        }
        let (mut first, mut last) = (self.changed.first(), self.changed.last());
        for before in columns.iter_ones().map(|place| self.before[place].range(0)) {
            if !before.is_empty() {
                (first, last) = (first.min(before.last()), last.max(before.first()));
            }
        }
        Range::new(first, last)
    }
}

/// Returns the columns among `solid`, which had no gaps, that have holes at the positions `scanned`.
#[inline]
fn find_split<const N: usize, R: BitSet>(solid: R, scanned: Range, row: impl Fn(usize) -> R) -> R
where
    Grid<N>: Size,
{
    let (first, last) = (scanned.first(), scanned.last());
    let below = if first > 0 { row(first - 1) & solid } else { R::EMPTY };
    let above = if last + 1 < N { row(last + 1) & solid } else { R::EMPTY };
    let mut holes = HoleScan::NONE;
    holes.pass(below);
    (first..last + 1).for_each(|i| holes.pass(row(i) & solid));
    holes.pass(above);
    holes.found
}

/// The changes to the gaps of columns. Unchanged columns are in none of the rows.
struct TouchedGaps<R> {
    /// Columns whose gaps are wider now.
    widened: R,
    /// Columns in whose gaps voxels were added.
    filled: R,
    /// Columns that must be searched as a whole, as a gap vanished or met another, or as there is room for
    /// one more.
    lost: R,
}

/// Returns the voxels `rows` of the column at `place` of a line, as a row along the column.
#[inline]
fn gather_column<R: BitSet, C: BitSet>(rows: Range, place: usize, row: impl Fn(usize) -> R) -> C {
    let mut voxels = C::EMPTY;
    for word in rows.first() / 64..rows.last() / 64 + 1 {
        let first = rows.first().max(64 * word);
        let last = rows.last().min(64 * word + 63);
        voxels.set_word(word, gather_bits((first, last), place, &row) << (first % 64));
    }
    voxels
}

/// Returns up to 64 voxels of the column at `place` of a line; bit 0 is the first.
#[inline]
fn gather_bits<R: BitSet>(
    (first, last): (usize, usize),
    place: usize,
    row: impl Fn(usize) -> R,
) -> u64 {
    // From the top down: each step needs the previous one, which keeps the compiler from vectorising the
    // rows.
    (first..last + 1).rev().fold(0, |bits, i| bits << 1 | u64::from(row(i).contains(place)))
}

/// Positions that a search reads at once, to reduce branches.
const SEARCH_STEP: usize = 8;

/// Number of columns from which scanning the line is cheaper than searching each column.
const LEAST_SCANNED: u32 = 4;

/// Returns the last voxel of the column at `place` in an interval.
#[inline]
fn find_last_voxel<R: BitSet>(
    interval: Range,
    place: usize,
    row: impl Fn(usize) -> R,
) -> Option<usize> {
    let (first, mut end) = (interval.first(), interval.last() + 1);
    while first < end {
        let from = first.max(end.saturating_sub(SEARCH_STEP));
        let bits = gather_bits((from, end - 1), place, &row);
        if bits != 0 {
            return Some(from + 63 - bits.leading_zeros() as usize);
        }
        end = from;
    }
    None
}

/// Returns the first voxel of the column at `place` in an interval.
#[inline]
fn find_first_voxel<R: BitSet>(
    interval: Range,
    place: usize,
    row: impl Fn(usize) -> R,
) -> Option<usize> {
    let (mut first, end) = (interval.first(), interval.last() + 1);
    while first < end {
        let to = end.min(first + SEARCH_STEP);
        let bits = gather_bits((first, to - 1), place, &row);
        if bits != 0 {
            return Some(first + bits.trailing_zeros() as usize);
        }
        first = to;
    }
    None
}

/// Returns the empty voxels of the column at `place` from `first` to `last`, if they are one run and there
/// are at most 64 positions.
#[inline]
fn find_only_hole_within_64<R: BitSet>(
    (first, last): (usize, usize),
    place: usize,
    row: impl Fn(usize) -> R,
) -> Option<Range> {
    let above_last = 63usize.checked_sub(last.checked_sub(first)?)?;
    let bits = !gather_bits((first, last), place, row) & u64::MAX >> above_last;
    let beyond = bits & bits.wrapping_add(bits & bits.wrapping_neg());
    let highest = 63usize.checked_sub(bits.leading_zeros() as usize)?;
    let run = || Range::new(first + bits.trailing_zeros() as usize, first + highest);
    (beyond == 0).then(run)
}
