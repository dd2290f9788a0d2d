//! Which parts of the axis maps a tick changed, as rectangles.

use heapless::Vec;

use crate::limits::DIRTY_RECTS;
use crate::maps::{Axis, Column};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::Journal;

/// Columns `lo..=hi` of a map: (line, place), ends included.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Rect {
    /// Least line and place.
    pub lo: (u8, u8),
    /// Greatest line and place.
    pub hi: (u8, u8),
}

impl Rect {
    /// One column.
    #[must_use]
    pub const fn at((line, place): (usize, usize)) -> Self {
        let at = (line as u8, place as u8);
        Rect { lo: at, hi: at }
    }

    /// The least rectangle that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Rect {
            lo: (self.lo.0.min(other.lo.0), self.lo.1.min(other.lo.1)),
            hi: (self.hi.0.max(other.hi.0), self.hi.1.max(other.hi.1)),
        }
    }

    /// Columns inside.
    #[must_use]
    pub fn area(self) -> u32 {
        let side = |lo: u8, hi: u8| u32::from(hi) - u32::from(lo) + 1;
        side(self.lo.0, self.hi.0) * side(self.lo.1, self.hi.1)
    }

    /// Whether a column is inside.
    #[must_use]
    pub fn contains(self, (line, place): (usize, usize)) -> bool {
        let inside = |lo: u8, at: usize, hi: u8| usize::from(lo) <= at && at <= usize::from(hi);
        inside(self.lo.0, line, self.hi.0) && inside(self.lo.1, place, self.hi.1)
    }
}

/// The dirty rectangles of the three maps. An edit's changes to a map are one rectangle, their
/// bounds; those of several edits merge where that doesn't grow their area, and, when there are
/// more than there is room for, where it grows least.
#[derive(Debug)]
pub struct Dirty {
    open: [Option<Rect>; 3],
    rects: [Vec<Rect, DIRTY_RECTS, u8>; 3],
}

impl Dirty {
    /// Nothing dirty.
    #[must_use]
    #[allow(clippy::new_without_default)] // `const fn new` is the one way these are made
    pub const fn new() -> Self {
        Dirty { open: [None; 3], rects: [Vec::new(), Vec::new(), Vec::new()] }
    }

    /// Forgets all rectangles.
    pub fn clear(&mut self) {
        self.open = [None; 3];
        self.rects.iter_mut().for_each(Vec::clear);
    }

    /// A column changed.
    #[inline]
    pub fn note(&mut self, axis: Axis, at: (usize, usize)) {
        let open = &mut self.open[axis as usize];
        match open {
            Some(open) if open.contains(at) => {}
            Some(open) => *open = open.union(Rect::at(at)),
            None => *open = Some(Rect::at(at)),
        }
    }

    /// Columns of a line changed.
    #[inline]
    pub fn note_line(&mut self, axis: Axis, line: usize, places: impl Bits) {
        if let (Some(first), Some(last)) = (places.first(), places.last()) {
            let rect = Rect { lo: (line as u8, first as u8), hi: (line as u8, last as u8) };
            let open = &mut self.open[axis as usize];
            *open = Some(open.map_or(rect, |open| open.union(rect)));
        }
    }

    /// The edit is over: its bounds become rectangles of their own.
    pub fn close(&mut self) {
        for (open, rects) in self.open.iter_mut().zip(&mut self.rects) {
            if let Some(rect) = open.take() {
                push(rects, rect);
            }
        }
    }

    /// Everything changed.
    pub fn note_all(&mut self, n: usize) {
        self.clear();
        for rects in &mut self.rects {
            push(rects, Rect::at((0, 0)).union(Rect::at((n - 1, n - 1))));
        }
    }

    /// The rectangles of one map. They may overlap.
    #[must_use]
    pub fn rects(&self, axis: Axis) -> &[Rect] {
        &self.rects[axis as usize]
    }

    /// Whether no column changed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rects.iter().all(Vec::is_empty)
    }
}

/// For who hears of an edit and only wants to know where it was.
impl<const N: usize> Journal<N> for Dirty
where
    Grid<N>: Size,
{
    fn columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        _: &[Column; N],
    ) {
        self.note_line(axis, line, places);
    }

    fn added(&mut self, _: (usize, usize), _: <Grid<N> as Size>::Row) {}
}

/// Adds a rectangle; any two whose union is no larger than they are together become one. No pair
/// then sums to more than the bounds of all, so eight never sum to more than four times those.
fn push(rects: &mut Vec<Rect, DIRTY_RECTS, u8>, mut rect: Rect) {
    let growth = |a: &Rect, b: Rect| i64::from(a.union(b).area()) - i64::from(a.area());
    while let Some((i, least)) = nearest(rects, |r| growth(r, rect)) {
        if least > i64::from(rect.area()) && !rects.is_full() {
            break;
        }
        rect = rect.union(rects.swap_remove(i));
    }
    // Cannot fail: a full list was merged into.
    let _ = rects.push(rect);
}

fn nearest(rects: &[Rect], growth: impl Fn(&Rect) -> i64) -> Option<(usize, i64)> {
    rects.iter().map(growth).enumerate().min_by_key(|&(_, growth)| growth)
}
