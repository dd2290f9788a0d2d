//! The bared part of a hidden figure: the ends of its columns at which the stone ends too.

use crate::volume::dirty::DirtyRects;
use crate::volume::journal::{Journal, SwapJournal};
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// Counts of the ends of a hidden figure's columns: the first and the last voxel of each interval along each
/// axis, except ends on the ground, which no tool reaches.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BaredEnds {
    /// Ends at which the stone's interval ends too, so that the figure shows.
    pub bared: u32,
    /// All ends; 0 without a figure.
    pub all: u32,
}

/// The part of a figure that was reported as bared: 0 to 9 tenths, 10 from [`FOUND_PERCENT`] on, 11 if all
/// ends are bared.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct ToldPart(u8);

/// The percentage of bared ends from which a figure counts as found. The rest are hollows that no ball
/// reaches.
pub const FOUND_PERCENT: u32 = 95;

impl BaredEnds {
    pub(crate) const NONE: BaredEnds = BaredEnds { bared: 0, all: 0 };

    /// Returns the bared part in percent, rounded down; 0 without a figure.
    #[must_use]
    pub const fn percent(&self) -> u32 {
        match self.all {
            0 => 0,
            all => (self.bared as u64 * 100 / all as u64) as u32,
        }
    }

    /// Adds the ends of a figure's columns along an axis.
    pub(crate) fn add_axis<const N: usize, const K: usize>(
        &mut self,
        axis: Axis,
        figure: &RangeMaps<N, K>,
        stone: &RangeMaps<N, K>,
    ) {
        for line in 0..N {
            let columns = figure.line(axis, line).iter().zip(stone.line(axis, line));
            for (figure, stone) in columns.filter(|(figure, _)| !figure.range(0).is_empty()) {
                self.all += count_ends(axis, figure);
                self.bared += count_shared_ends(axis, figure, stone);
            }
        }
    }

    /// Updates the counts for columns of the stone that are replaced, from `first` on.
    #[inline]
    fn follow_columns<const K: usize>(
        &mut self,
        axis: Axis,
        figure: &[Column<K>],
        (old, new): (&[Column<K>], &[Column<K>]),
    ) {
        for ((figure, old), new) in figure.iter().zip(old).zip(new) {
            if !figure.range(0).is_empty() {
                self.bared += count_shared_ends(axis, figure, new);
                self.bared -= count_shared_ends(axis, figure, old);
            }
        }
    }
}

impl ToldPart {
    pub(crate) const NONE: ToldPart = ToldPart(0);

    pub(crate) fn of(ends: BaredEnds) -> Self {
        ToldPart(match ends.percent() {
            100 => 11,
            FOUND_PERCENT.. => 10,
            percent => (percent / 10) as u8,
        })
    }

    pub(crate) const fn from_number(number: u8) -> Option<Self> {
        if number <= 11 { Some(ToldPart(number)) } else { None }
    }

    pub(crate) const fn number(self) -> u8 {
        self.0
    }

    /// Returns the tenths that this part stands for.
    pub(crate) const fn tenths(self) -> u8 {
        match self.0 {
            11 => 10,
            10 => 9,
            tenths => tenths,
        }
    }

    /// Returns `true` if the figure is found.
    pub(crate) const fn is_found(self) -> bool {
        self.0 >= 10
    }
}

/// Counts the ends of a figure's column.
#[inline]
fn count_ends<const K: usize>(axis: Axis, figure: &Column<K>) -> u32 {
    let intervals = figure.intervals().count() as u32;
    2 * intervals - u32::from(stands_on_ground(axis, figure.range(0)))
}

/// Returns `true` if the first voxel of a figure's interval lies on the ground.
#[inline]
fn stands_on_ground(axis: Axis, interval: Range) -> bool {
    axis == Axis::Y && !interval.is_empty() && interval.first() == 0
}

/// Counts the ends of a figure's column at which an interval of the stone ends too.
#[inline]
fn count_shared_ends<const K: usize>(axis: Axis, figure: &Column<K>, stone: &Column<K>) -> u32 {
    let mut shared = 0;
    for ours in figure.intervals() {
        let stands_on_ground = stands_on_ground(axis, ours);
        for its in stone.intervals() {
            let [first, last] = ours.equal_ends(its);
            shared += u32::from(first & !stands_on_ground) + u32::from(last);
        }
    }
    shared
}

/// A journal that updates a hidden figure's bared ends in addition to another journal.
#[derive(Debug)]
pub(crate) struct BaringJournal<'a, const N: usize, const K: usize, J> {
    pub(crate) journal: J,
    pub(crate) figure: &'a RangeMaps<N, K>,
    /// The number of counted axes; changes along the other axes are ignored until they are counted.
    pub(crate) counted_axes: u8,
    pub(crate) ends: &'a mut BaredEnds,
}

impl<const N: usize, const K: usize, J: Journal<N, K>> Journal<N, K> for BaringJournal<'_, N, K, J>
where
    Grid<N>: Size,
{
    #[inline]
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        (old, new): (&[Column<K>; N], &[Column<K>; N]),
    ) {
        self.journal.record_columns(axis, line, places, (old, new));
        if (axis as u8) < self.counted_axes {
            let figure = self.figure.line(axis, line);
            for run in places.iter_runs_within_words() {
                let run = run.first()..run.last() + 1;
                let columns = (&old[run.clone()], &new[run.clone()]);
                self.ends.follow_columns(axis, &figure[run], columns);
            }
        }
    }

    #[inline]
    fn record_added(&mut self, row: RowAddress, voxels: <Grid<N> as Size>::Row) {
        self.journal.record_added(row, voxels);
    }
}

impl<const N: usize, const K: usize> SwapJournal<K> for BaringJournal<'_, N, K, &mut DirtyRects> {
    fn record_swap(
        &mut self,
        axis: Axis,
        (line, first): ColumnAddress,
        old: &[Column<K>],
        new: &[Column<K>],
    ) {
        self.journal.record_swap(axis, (line, first), old, new);
        if (axis as u8) < self.counted_axes {
            let figure = &self.figure.line(axis, line)[first..first + old.len()];
            self.ends.follow_columns(axis, figure, (old, new));
        }
    }

    fn end_swaps(&mut self) {
        SwapJournal::<K>::end_swaps(self.journal);
    }
}

#[cfg(test)]
mod tests {
    use super::{BaredEnds, ToldPart, count_ends, count_shared_ends};
    use crate::volume::range::Range;
    use crate::volume::range_maps::{Axis, Column};

    #[test]
    fn ends_are_shared_on_the_same_side_alone() {
        let figure = Column::new([Range::new(0, 4), Range::new(8, 9)]);
        let count = |axis, stone: Column<2>| count_shared_ends(axis, &figure, &stone);
        assert_eq!((count(Axis::X, figure), count_ends(Axis::X, &figure)), (4, 4));
        let on_ground = (count(Axis::Y, figure), count_ends(Axis::Y, &figure));
        assert_eq!(on_ground, (3, 3), "the ground is no end");
        assert_eq!(count(Axis::Z, Column::new([Range::new(0, 12), Range::EMPTY])), 1);
        assert_eq!(count(Axis::Z, Column::new([Range::new(1, 9), Range::EMPTY])), 1);
        // A gap larger than the figure's gap shares one of its sides.
        assert_eq!(count(Axis::X, Column::new([Range::new(0, 4), Range::new(7, 9)])), 3);
        assert_eq!(count(Axis::X, Column::new([Range::new(4, 7), Range::EMPTY])), 0);
    }

    #[test]
    fn a_part_is_told_in_tenths_until_the_figure_is_found() {
        let part = |bared| ToldPart::of(BaredEnds { bared, all: 200 });
        let told = |bared| (part(bared).tenths(), part(bared).is_found());
        assert_eq!([19, 20, 39, 189].map(told), [(0, false), (1, false), (1, false), (9, false)]);
        assert_eq!([190, 199, 200].map(told), [(9, true), (9, true), (10, true)]);
        assert_eq!(ToldPart::of(BaredEnds::NONE), ToldPart::NONE);
        for number in 0..=255 {
            let back = ToldPart::from_number(number).map(ToldPart::number);
            assert_eq!(back, (number <= 11).then_some(number));
        }
    }
}
