//! Dirty rectangles: the parts of the range maps that a tick changed.

use heapless::Vec;

use crate::limits::MAX_DIRTY_RECTS;
use crate::volume::journal::{Journal, SwapJournal};
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// A rectangle of columns of a range map, from `first` to `last`, both included. Addresses are (line,
/// place).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ColumnRect {
    /// The least line and place.
    pub first: (u8, u8),
    /// The greatest line and place.
    pub last: (u8, u8),
}

impl ColumnRect {
    /// Creates the rectangle of one column.
    #[must_use]
    pub const fn of_column((line, place): ColumnAddress) -> Self {
        let at = (line as u8, place as u8);
        ColumnRect { first: at, last: at }
    }

    /// Returns the smallest rectangle that contains both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        ColumnRect {
            first: (self.first.0.min(other.first.0), self.first.1.min(other.first.1)),
            last: (self.last.0.max(other.last.0), self.last.1.max(other.last.1)),
        }
    }

    /// Returns the number of columns inside.
    #[must_use]
    pub fn area(self) -> u32 {
        let side = |lo: u8, hi: u8| u32::from(hi) - u32::from(lo) + 1;
        side(self.first.0, self.last.0) * side(self.first.1, self.last.1)
    }

    /// Returns `true` if a column is inside.
    #[must_use]
    pub fn contains(self, (line, place): ColumnAddress) -> bool {
        let inside = |lo: u8, at: usize, hi: u8| usize::from(lo) <= at && at <= usize::from(hi);
        inside(self.first.0, line, self.last.0) && inside(self.first.1, place, self.last.1)
    }
}

/// The dirty rectangles of the three range maps. Each edit adds one rectangle to each map, the bounds of its
/// changes. Rectangles of several edits are merged if that doesn't increase their area, or, when the capacity
/// is exceeded, where it increases the area least.
#[derive(Debug)]
pub struct DirtyRects {
    edit_bounds: [Option<ColumnRect>; 3],
    rects: [Vec<ColumnRect, MAX_DIRTY_RECTS, u8>; 3],
}

impl DirtyRects {
    /// Creates an empty set of rectangles.
    #[must_use]
    #[allow(clippy::new_without_default)] // `const fn new` is the one way these are made
    pub const fn new() -> Self {
        DirtyRects { edit_bounds: [None; 3], rects: [Vec::new(), Vec::new(), Vec::new()] }
    }

    /// Removes all rectangles.
    pub fn clear(&mut self) {
        self.edit_bounds = [None; 3];
        self.rects.iter_mut().for_each(Vec::clear);
    }

    /// Adds a column to the bounds of the current edit.
    #[inline]
    pub fn mark_column(&mut self, axis: Axis, at: ColumnAddress) {
        let open = &mut self.edit_bounds[axis as usize];
        match open {
            Some(open) if open.contains(at) => {}
            Some(open) => *open = open.union(ColumnRect::of_column(at)),
            None => *open = Some(ColumnRect::of_column(at)),
        }
    }

    /// Adds columns of a line to the bounds of the current edit.
    #[inline]
    pub(crate) fn mark_columns(&mut self, axis: Axis, line: usize, places: impl BitSet) {
        if let (Some(first), Some(last)) = (places.first(), places.last()) {
            let rect =
                ColumnRect { first: (line as u8, first as u8), last: (line as u8, last as u8) };
            let open = &mut self.edit_bounds[axis as usize];
            *open = Some(open.map_or(rect, |open| open.union(rect)));
        }
    }

    /// Ends the current edit: its bounds become one rectangle in each map.
    pub fn end_edit(&mut self) {
        for (open, rects) in self.edit_bounds.iter_mut().zip(&mut self.rects) {
            if let Some(rect) = open.take() {
                push_merged(rects, rect);
            }
        }
    }

    /// Marks every column of a grid of `grid_side` voxels a side.
    pub fn mark_all(&mut self, grid_side: usize) {
        self.clear();
        for rects in &mut self.rects {
            push_merged(
                rects,
                ColumnRect::of_column((0, 0))
                    .union(ColumnRect::of_column((grid_side - 1, grid_side - 1))),
            );
        }
    }

    /// Returns the rectangles of one map, without the current edit's. They may overlap.
    #[must_use]
    pub fn rects(&self, axis: Axis) -> &[ColumnRect] {
        &self.rects[axis as usize]
    }

    /// Returns `true` if no column changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rects.iter().all(Vec::is_empty)
    }
}

/// Records only the bounds of an edit.
impl<const N: usize, const K: usize> Journal<N, K> for DirtyRects
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        _: (&[Column<K>; N], &[Column<K>; N]),
    ) {
        self.mark_columns(axis, line, places);
    }

    fn record_added(&mut self, _: RowAddress, _: <Grid<N> as Size>::Row) {}
}

impl<const K: usize> SwapJournal<K> for DirtyRects {
    fn record_swap(
        &mut self,
        axis: Axis,
        (line, first): ColumnAddress,
        old: &[Column<K>],
        new: &[Column<K>],
    ) {
        let differs = |i: &usize| old[*i] != new[*i];
        let ends = [(0..old.len()).find(differs), (0..old.len()).rfind(differs)];
        ends.into_iter().flatten().for_each(|i| self.mark_column(axis, (line, first + i)));
    }

    fn end_swaps(&mut self) {
        self.end_edit();
    }
}

/// Adds a rectangle, and merges any two whose union is no larger than the sum of their areas. So the areas of
/// no pair sum to more than the bounds of all, and those of eight to at most four times that.
fn push_merged(rects: &mut Vec<ColumnRect, MAX_DIRTY_RECTS, u8>, mut rect: ColumnRect) {
    let growth = |a: &ColumnRect, b: ColumnRect| i64::from(a.union(b).area()) - i64::from(a.area());
    while let Some(least) = find_least_growth(rects, |r| growth(r, rect)) {
        if least.growth > i64::from(rect.area()) && !rects.is_full() {
            break;
        }
        rect = rect.union(rects.swap_remove(least.index));
    }
    // Cannot fail: a full list was merged first.
    let _ = rects.push(rect);
}

/// The rectangle of a list that would grow least when merged.
struct LeastGrowth {
    index: usize,
    /// The number of columns that it would gain.
    growth: i64,
}

fn find_least_growth(
    rects: &[ColumnRect],
    growth: impl Fn(&ColumnRect) -> i64,
) -> Option<LeastGrowth> {
    let growths = rects.iter().map(growth).enumerate();
    growths.map(|(index, growth)| LeastGrowth { index, growth }).min_by_key(|least| least.growth)
}
