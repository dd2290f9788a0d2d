//! Winding numbers along columns: find the untouched runs of a column that lie outside the mesh, and so are
//! gaps.
//!
//! The winding number of a run is the number of surfaces that the column's ray enters below it, minus those
//! that it leaves. It is constant in the whole run, as a crossing lies on a triangle and therefore in a
//! touched voxel. It is signed: 2 where two solids overlap, which a parity test would hollow. In a balanced
//! column, which leaves as many surfaces as it enters, a run between touched voxels with the number 0 is
//! outside. In any other column the mesh has a hole and the numbers are unknown, so the column has one
//! interval.
//!
//! A column stores all crossings of its ray, a set that doesn't depend on the order of the triangles. It has
//! room for [`BAKED_CROSSINGS`]; a column with more has one interval. So no number is ever wrong, and no
//! solid is taken for a gap, however many solids overlap.

use crate::limits::BAKED_CROSSINGS;
use crate::volume::bit_grid::BitGrid;
use crate::volume::line_scan;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RangeMaps};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use store::WindingStore;

/// The information of a [`Baker`](crate::Baker) about winding numbers: [`NoWindings`] or [`ColumnWindings`].
pub trait Windings<const N: usize>: WindingStore<N> {}

/// No winding numbers: sufficient for columns of one interval.
#[derive(Clone, Copy, Debug)]
pub struct NoWindings;

/// The crossings of every column, which determine the gaps of columns with two or more intervals. 3 MiB at
/// 128, 12.2 MiB at 256.
#[derive(Debug)]
pub struct ColumnWindings<const N: usize> {
    /// For each column, the number of its crossings; `BAKED_CROSSINGS + 1` means too many.
    counts: [[[u8; N]; N]; 3],
    /// For each column, its crossings, as many as `counts` says. Each is a [`Crossing::to_number`], an
    /// integer for the reason given at [`Column`].
    crossings: [[[[u16; BAKED_CROSSINGS]; N]; N]; 3],
}

const _: () = assert!(BAKED_CROSSINGS < u8::MAX as usize);

/// A crossing of a column's ray with a triangle.
#[derive(Clone, Copy)]
struct Crossing {
    /// The voxel that contains it.
    voxel: usize,
    /// 1 if the ray enters a surface, -1 if it leaves one.
    entered: i8,
}

impl Crossing {
    /// Returns the crossing as a number. The numbers have the order of the voxels.
    #[inline]
    const fn to_number(self) -> u16 {
        (self.voxel as u16) << 1 | (self.entered > 0) as u16
    }

    /// The inverse of [`Crossing::to_number`].
    #[inline]
    const fn from_number(number: u16) -> Self {
        Crossing { voxel: (number >> 1) as usize, entered: if number & 1 == 1 { 1 } else { -1 } }
    }
}

pub(super) mod store {
    use super::{Axis, BitGrid, ColumnAddress, Grid, RangeMaps, Size};

    /// The implementation of [`Windings`](super::Windings), private to the crate.
    pub trait WindingStore<const N: usize>: Sized {
        /// No crossing.
        const NONE: Self;
        /// `true` if crossings are stored.
        const COUNTS: bool;

        /// Removes every crossing, in place.
        fn clear(&mut self);

        /// Adds a crossing of the column at `at`, in its voxel `voxel`. `entered` is 1 if the ray enters a
        /// surface, -1 if it leaves one.
        fn add_crossing(
            &mut self,
            axis: Axis,
            at: ColumnAddress,
            entered: i8,
            voxel: impl FnOnce() -> usize,
        );

        /// Writes the columns of the mesh: the hulls of the touched voxels without the runs outside the mesh
        /// that the closure rule chooses as gaps.
        fn write_columns<const K: usize>(&self, touched: &BitGrid<N>, maps: &mut RangeMaps<N, K>)
        where
            Grid<N>: Size;
    }
}

impl<const N: usize> Windings<N> for NoWindings {}

impl<const N: usize> WindingStore<N> for NoWindings {
    const NONE: Self = NoWindings;
    const COUNTS: bool = false;

    #[inline(always)]
    fn clear(&mut self) {}

    #[inline(always)]
    fn add_crossing(
        &mut self,
        _: Axis,
        _: ColumnAddress,
        _entered: i8,
        _voxel: impl FnOnce() -> usize,
    ) {
    }

    fn write_columns<const K: usize>(&self, touched: &BitGrid<N>, maps: &mut RangeMaps<N, K>)
    where
        Grid<N>: Size,
    {
        touched.write_hulls(maps);
    }
}

impl<const N: usize> Windings<N> for ColumnWindings<N> {}

impl<const N: usize> WindingStore<N> for ColumnWindings<N> {
    const NONE: Self =
        ColumnWindings { counts: [[[0; N]; N]; 3], crossings: [[[[0; BAKED_CROSSINGS]; N]; N]; 3] };
    const COUNTS: bool = true;

    fn clear(&mut self) {
        self.counts.as_flattened_mut().as_flattened_mut().fill(0);
    }

    #[inline(always)]
    fn add_crossing(
        &mut self,
        axis: Axis,
        (line, place): ColumnAddress,
        entered: i8,
        voxel: impl FnOnce() -> usize,
    ) {
        let count = &mut self.counts[axis as usize][line][place];
        let column = &mut self.crossings[axis as usize][line][place];
        if let Some(free) = column.get_mut(usize::from(*count)) {
            *free = Crossing { voxel: voxel(), entered }.to_number();
            *count += 1;
        } else {
            *count = BAKED_CROSSINGS as u8 + 1;
        }
    }

    fn write_columns<const K: usize>(&self, touched: &BitGrid<N>, maps: &mut RangeMaps<N, K>)
    where
        Grid<N>: Size,
    {
        maps.clear();
        for i in 0..N {
            self.write_columns_along_x(i, touched.layer(i), maps.line_mut(Axis::X, i));
            self.write_line(Axis::Y, i, |y| touched.row(y, i), maps);
            self.write_line(Axis::Z, i, |z| touched.row(i, z), maps);
        }
    }
}

/// `true` if a column is balanced, so that its winding numbers are known.
type IsBalanced = bool;

impl<const N: usize> ColumnWindings<N> {
    /// Calls `visit` for each stretch of a column with non-zero winding numbers, with the voxels of its first
    /// and its last crossing. The stretches are complete only if the column is balanced. Returns `true` if it
    /// is.
    #[inline]
    fn visit_wound_stretches(
        &self,
        axis: Axis,
        (line, place): ColumnAddress,
        mut visit: impl FnMut(usize, usize),
    ) -> IsBalanced {
        let count = usize::from(self.counts[axis as usize][line][place]);
        if count == 0 {
            return true;
        }
        let mut crossings = self.crossings[axis as usize][line][place];
        let Some(crossings) = crossings.get_mut(..count) else {
            return false;
        };
        crossings.sort_unstable();
        let (mut winding, mut start) = (0, 0);
        for crossing in crossings.iter().map(|number| Crossing::from_number(*number)) {
            if winding == 0 {
                start = crossing.voxel;
            }
            winding += crossing.entered;
            if winding == 0 {
                visit(start, crossing.voxel);
            }
        }
        winding == 0
    }

    /// Writes the columns along x of layer `y`.
    fn write_columns_along_x<const K: usize>(
        &self,
        y: usize,
        touched: &[<Grid<N> as Size>::Row; N],
        empty_columns: &mut [Column<K>; N],
    ) where
        Grid<N>: Size,
    {
        for (z, (column, touched)) in empty_columns.iter_mut().zip(touched).enumerate() {
            if touched.is_empty() {
                continue;
            }
            let mut solid = *touched;
            let wind = |first, last| solid |= BitSet::span(first, last);
            *column = if self.visit_wound_stretches(Axis::X, (y, z), wind) {
                Column::closed_over(solid, &Column::EMPTY)
            } else {
                Column::from_range(Range::hull_of(*touched))
            };
        }
    }

    /// Writes a line of columns along y or z, all columns at once. `touched_at(i)` holds voxel `i` of each
    /// column.
    fn write_line<const K: usize>(
        &self,
        axis: Axis,
        line: usize,
        touched_at: impl Fn(usize) -> <Grid<N> as Size>::Row,
        maps: &mut RangeMaps<N, K>,
    ) where
        Grid<N>: Size,
    {
        let columns = maps.line_mut(axis, line);
        if self.counts[axis as usize][line] == [0; N] {
            return line_scan::close_line(columns, (0..N).map(touched_at));
        }
        // Each stretch toggles its column's bit at both ends, as in `BitGrid::set_from_maps`.
        let mut toggles = [<Grid<N> as Size>::Row::EMPTY; N];
        let mut unbalanced = <Grid<N> as Size>::Row::EMPTY;
        for place in 0..N {
            let is_balanced = self.visit_wound_stretches(axis, (line, place), |first, last| {
                toggles[first].toggle(place);
                toggles[last].toggle(place);
            });
            unbalanced.insert_if(!is_balanced, place);
        }
        let mut wound = <Grid<N> as Size>::Row::EMPTY;
        let solid = toggles.iter().enumerate().map(|(i, toggled)| {
            wound ^= *toggled;
            wound | touched_at(i)
        });
        line_scan::close_line(columns, solid);
        for place in unbalanced.iter_ones() {
            columns[place] = Column::from_range(columns[place].hull());
        }
    }
}
