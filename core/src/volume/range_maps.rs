//! Range maps: for each axis, the first and last occupied voxel of every column along it.
//!
//! Source: section 3.2 of the paper, after Karabassi, Papaioannou and Theoharis (1999).

use core::fmt;

use crate::volume::column_digest::column_number;
use crate::volume::range::Range;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// The address of a column in a range map: (line, place in the line). See [`Axis::column_address`].
pub type ColumnAddress = (usize, usize);

/// The address of a bit row: (y, z).
pub type RowAddress = (usize, usize);

/// An axis of the grid, and the index of its range map.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Axis {
    /// Columns along x, addressed by (y, z).
    X = 0,
    /// Columns along y, addressed by (z, x).
    Y = 1,
    /// Columns along z, addressed by (y, x).
    Z = 2,
}

impl Axis {
    /// All three, in the order of the maps.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// Returns the address of this axis' column through a voxel.
    ///
    /// Lines are laid out so that the bits of a row run along a line of the Y and Z maps, and a column
    /// of the X map has the address of its bit row.
    #[must_use]
    #[inline]
    pub const fn column_address(self, voxel: [usize; 3]) -> ColumnAddress {
        let [x, y, z] = voxel;
        match self {
            Axis::X => (y, z),
            Axis::Y => (z, x),
            Axis::Z => (y, x),
        }
    }

    /// Returns the voxel at index `i` along the column of this axis at `(line, place)`.
    #[must_use]
    #[inline]
    pub const fn voxel_at(self, (line, place): ColumnAddress, i: usize) -> [usize; 3] {
        match self {
            Axis::X => [i, line, place],
            Axis::Y => [place, i, line],
            Axis::Z => [place, line, i],
        }
    }
}

/// Up to `K` disjoint intervals of one column, lowest first, followed by empty ones.
///
/// An interval is stored as one integer, its [`Range::to_bytes`]. Rustc checks every element of a static's
/// initial value, and checks arrays of integers seven times as fast as arrays of structs.
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Column<const K: usize = 1>([u16; K]);

impl<const K: usize> Column<K> {
    /// A column without voxels.
    pub const EMPTY: Self = Column([0; K]);

    /// Creates a column of these intervals, which must be disjoint and in ascending order, empty ones last.
    #[must_use]
    #[inline]
    pub fn new(ranges: [Range; K]) -> Self {
        Column(ranges.map(Range::to_number))
    }

    /// Creates a column of one interval, or an empty column if `range` is empty.
    #[must_use]
    #[inline]
    pub const fn from_range(range: Range) -> Self {
        let mut column = Self::EMPTY;
        column.0[0] = range.to_number();
        column
    }

    /// Returns all intervals, the empty ones last.
    #[must_use]
    #[inline]
    pub fn ranges(self) -> [Range; K] {
        self.0.map(Range::from_number)
    }

    /// Returns interval `i`, which must be below K.
    #[must_use]
    #[inline]
    pub const fn range(&self, i: usize) -> Range {
        Range::from_number(self.0[i])
    }

    /// Replaces interval `i`, which must be below K. The caller must keep the intervals disjoint and in
    /// order.
    #[inline]
    pub const fn set_range(&mut self, i: usize, range: Range) {
        self.0[i] = range.to_number();
    }

    /// Returns the intervals that aren't empty, lowest first.
    #[inline]
    pub fn intervals(self) -> impl Iterator<Item = Range> {
        let held = (0..K).take_while(move |i| self.0[*i] != 0);
        held.map(move |i| self.range(i))
    }

    /// Returns the intervals' bytes as stored, each as [`Range::to_bytes`].
    #[must_use]
    #[inline]
    pub fn to_bytes(self) -> [[u8; 2]; K] {
        self.0.map(u16::to_le_bytes)
    }

    /// The inverse of [`Column::to_bytes`]. The bytes must come from it or have been accepted by
    /// [`Column::from_bytes`].
    #[must_use]
    #[inline]
    pub(crate) fn from_checked_bytes(bytes: [[u8; 2]; K]) -> Self {
        Column(bytes.map(u16::from_le_bytes))
    }

    /// Returns the intervals' numbers as stored.
    #[inline]
    pub(crate) const fn numbers(&self) -> &[u16; K] {
        &self.0
    }

    /// The inverse of [`Column::to_bytes`]. Returns `None` for bytes that are invalid in a grid of
    /// `grid_side` voxels a side: an invalid range, intervals that overlap, touch or aren't in ascending
    /// order, or a non-empty interval after an empty one.
    #[must_use]
    pub fn from_bytes(bytes: [[u8; 2]; K], grid_side: usize) -> Option<Self> {
        let mut column = Self::EMPTY;
        for (i, bytes) in bytes.into_iter().enumerate() {
            let range = Range::from_bytes(bytes, grid_side)?;
            if i > 0 && !range.is_empty() {
                let before = column.range(i - 1);
                if before.is_empty() || range.first() <= before.last() + 1 {
                    return None;
                }
            }
            column.set_range(i, range);
        }
        Some(column)
    }

    /// Returns `true` if voxel `i` is in one of the intervals.
    #[must_use]
    #[inline]
    pub fn contains(&self, i: usize) -> bool {
        self.ranges().iter().any(|range| range.contains(i))
    }

    /// Converts the column to a row with its voxels set.
    #[must_use]
    #[inline]
    pub fn to_row<R: BitSet>(&self) -> R {
        let ranges = self.ranges();
        let row = ranges[0].to_row();
        match self.has_gaps() {
            true => ranges[1..].iter().fold(row, |row, range| row | range.to_row()),
            false => row,
        }
    }

    /// Returns the range from the first occupied voxel to the last.
    #[must_use]
    #[inline]
    pub fn hull(&self) -> Range {
        self.ranges().into_iter().fold(Range::EMPTY, Range::hull_with)
    }
}

impl<const K: usize> Column<K> {
    /// Returns `true` if every interval is tight: both its end voxels are occupied.
    pub(crate) fn is_tight(&self, is_occupied: impl Fn(usize) -> bool) -> bool {
        self.intervals().all(|range| is_occupied(range.first()) && is_occupied(range.last()))
    }

    /// Returns `true` if the column has no room for another gap, or no other empty voxel inside its hull.
    pub(crate) fn is_saturated(&self, is_occupied: impl Fn(usize) -> bool) -> bool {
        let solid = |range: Range| (range.first()..range.last() + 1).all(&is_occupied);
        K == 1 || self.is_full() || self.intervals().all(solid)
    }
}

impl<const K: usize> fmt::Debug for Column<K> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.intervals()).finish()
    }
}

/// Places of columns that reach beyond an interval; see [`RangeMaps::columns_beyond`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ColumnsBeyond<R> {
    /// Columns that begin below the interval's first voxel.
    pub below_first: R,
    /// Columns that end above the interval's last voxel.
    pub above_last: R,
}

/// The three range maps of a grid of N^3 voxels: 3 x N x N columns, in the order of
/// [`Axis::column_address`]. All zero bytes are the empty volume.
#[derive(Clone, PartialEq, Eq, Debug)]
#[repr(C)]
pub struct RangeMaps<const N: usize, const K: usize = 1> {
    columns: [[[Column<K>; N]; N]; 3],
}

impl<const N: usize, const K: usize> RangeMaps<N, K> {
    /// Creates an empty volume. For a `static`, as [`World::new`](crate::World::new).
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would be moved by value
    pub const fn new() -> Self {
        RangeMaps { columns: [[[Column::EMPTY; N]; N]; 3] }
    }

    /// Makes the volume empty.
    pub fn clear(&mut self) {
        self.columns.as_flattened_mut().as_flattened_mut().fill(Column::EMPTY);
    }

    /// Makes the volume a solid block: every voxel is occupied.
    pub fn fill_block(&mut self) {
        let column = Column::from_range(Range::new(0, N - 1));
        self.columns.as_flattened_mut().as_flattened_mut().fill(column);
    }

    /// Copies `other` into `self`.
    pub fn copy_from(&mut self, other: &Self) {
        for (mine, its) in self.columns.iter_mut().zip(&other.columns) {
            mine.copy_from_slice(its);
        }
    }

    /// Returns one column.
    #[must_use]
    #[inline]
    pub fn column(&self, axis: Axis, (line, place): ColumnAddress) -> Column<K> {
        self.columns[axis as usize][line][place]
    }

    /// Replaces one column. The caller must keep the maps tight.
    #[inline]
    pub fn set_column(&mut self, axis: Axis, (line, place): ColumnAddress, column: Column<K>) {
        self.columns[axis as usize][line][place] = column;
    }

    /// Copies the columns at `places` of a line from `other`. The caller must keep the maps tight.
    #[inline]
    pub fn copy_columns(&mut self, other: &Self, axis: Axis, line: usize, places: Range) {
        let (map, (first, last)) = (axis as usize, (places.first(), places.last()));
        let columns = &other.columns[map][line][first..=last];
        self.columns[map][line][first..=last].copy_from_slice(columns);
    }

    /// Returns a line of N columns of a map.
    #[must_use]
    #[inline]
    pub fn line(&self, axis: Axis, line: usize) -> &[Column<K>; N] {
        &self.columns[axis as usize][line]
    }

    /// Returns a line of N columns of a map for changes. The caller must keep the maps tight.
    #[inline]
    pub(crate) fn line_mut(&mut self, axis: Axis, line: usize) -> &mut [Column<K>; N] {
        &mut self.columns[axis as usize][line]
    }

    /// Returns the first column for which `is_sought` returns `true`, in the order of the maps, their lines
    /// and places.
    pub(crate) fn find_column(
        &self,
        mut is_sought: impl FnMut(Axis, ColumnAddress, &Column<K>) -> bool,
    ) -> Option<(Axis, ColumnAddress)> {
        Axis::ALL.into_iter().find_map(|axis| {
            (0..N).find_map(|line| {
                let mut columns = self.line(axis, line).iter().enumerate();
                let place = columns.find(|(place, c)| is_sought(axis, (line, *place), c))?.0;
                Some((axis, (line, place)))
            })
        })
    }

    /// Returns the first column with a range that isn't tight.
    pub(crate) fn first_loose_column(
        &self,
        is_occupied: impl Fn([usize; 3]) -> bool,
    ) -> Option<(Axis, ColumnAddress)> {
        self.find_column(|axis, at, column| !column.is_tight(|i| is_occupied(axis.voxel_at(at, i))))
    }

    /// Returns the first column that isn't saturated.
    pub(crate) fn first_unsaturated_column(
        &self,
        is_occupied: impl Fn([usize; 3]) -> bool,
    ) -> Option<(Axis, ColumnAddress)> {
        if K == 1 {
            return None;
        }
        self.find_column(|axis, at, column| {
            !column.is_saturated(|i| is_occupied(axis.voxel_at(at, i)))
        })
    }

    /// Returns `true` if a voxel is occupied: all three of its columns contain it.
    #[must_use]
    #[inline]
    pub fn contains(&self, voxel: [usize; 3]) -> bool {
        Axis::ALL.iter().all(|&axis| {
            self.column(axis, axis.column_address(voxel)).contains(voxel[axis as usize])
        })
    }

    /// Returns `true` if no column contains a voxel.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        // A line at a time: without an early exit after every column, the compiler can vectorise the loop.
        let empty = |line: &[Column<K>; N]| {
            let bits = |column: &Column<K>| column.0.iter().fold(0, |all, number| all | number);
            line.iter().fold(0, |all, column| all | bits(column)) == 0
        };
        self.columns[0].iter().all(empty)
    }
}

impl<const N: usize, const K: usize> RangeMaps<N, K>
where
    Grid<N>: Size,
{
    /// Returns the occupied voxels of row (y, z), restricted to `among`.
    #[must_use]
    #[inline]
    pub fn occupied_among(
        &self,
        (y, z): RowAddress,
        among: <Grid<N> as Size>::Row,
    ) -> <Grid<N> as Size>::Row {
        let mut row = among & self.columns[0][y][z].to_row();
        for x in row.iter_ones() {
            if !(self.columns[1][z][x].contains(y) && self.columns[2][y][x].contains(z)) {
                row.toggle(x);
            }
        }
        row
    }
}

impl<const N: usize, const K: usize> RangeMaps<N, K>
where
    Grid<N>: Size,
{
    /// Returns the places of a line's columns that aren't empty, as a row of bits.
    #[must_use]
    #[inline]
    pub fn occupied_columns(&self, axis: Axis, line: usize) -> <Grid<N> as Size>::Row {
        // An empty column is the number 0.
        find_columns(self.line(axis, line), Grid::<N>::FULL, |column| column != 0)
    }

    /// Returns which columns of a line at `places` begin below `first`, and which end above `last`.
    #[must_use]
    #[inline]
    pub fn columns_beyond(
        &self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        first: usize,
        last: usize,
    ) -> ColumnsBeyond<<Grid<N> as Size>::Row> {
        let line = self.line(axis, line);
        // The lowest interval is the first, and an empty one neither begins below nor ends above.
        let begins_below = |column: u64| (column & 0xff) as u32 > 255 - first as u32;
        let ends_above = |column: u64| {
            (0..K)
                .fold(false, |any, i| any | ((column >> (16 * i + 8) & 0xff) as u32 > last as u32))
        };
        ColumnsBeyond {
            below_first: find_columns(line, places, begins_below),
            above_last: find_columns(line, places, ends_above),
        }
    }
}

/// Returns the places among `places` of a line's columns for which `is_sought` holds, given
/// [`column_number`].
///
/// The compiler vectorises the loop, as each column is one number and there is no branch.
#[inline]
pub(crate) fn find_columns<R: BitSet, const K: usize>(
    line: &[Column<K>],
    places: R,
    is_sought: impl Fn(u64) -> bool,
) -> R {
    let mut found = R::EMPTY;
    for (i, columns) in line.chunks(64).enumerate() {
        if places.word(i) == 0 {
            continue;
        }
        let mut flags = [0u8; 64];
        for (flag, column) in flags.iter_mut().zip(columns) {
            *flag = u8::from(is_sought(column_number(*column)));
        }
        let eights = flags.as_chunks::<8>().0.iter().enumerate();
        let word = eights.fold(0, |word, (k, eight)| word | gather_low_bits(*eight) << (8 * k));
        found.set_word(i, places.word(i) & word);
    }
    found
}

/// Gathers the low bits of eight bytes, whose other bits are 0, into one byte (a multiplication in place of
/// `pext`).
#[inline]
fn gather_low_bits(bytes: [u8; 8]) -> u64 {
    // Bit i x 8 times 2 to the 56 - i x 7 is bit 56 + i; no other product reaches the top byte without
    // overflowing.
    u64::from_le_bytes(bytes).wrapping_mul(0x0102_0408_1020_4080) >> 56
}
