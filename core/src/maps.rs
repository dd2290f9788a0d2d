//! Range maps: for each axis, the first and last occupied voxel of every column along it.
//!
//! Source: section 3.2 of the paper, after Karabassi, Papaioannou and Theoharis (1999).

use crate::row::Bits;
use crate::size::{Grid, Size};

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

    /// The address of the column of this axis through a voxel: (line, place in the line).
    ///
    /// Lines are laid out so that a bit row's x runs along a line of the Y and Z maps, and a
    /// column of the X map has the address of its bit row.
    #[must_use]
    #[inline]
    pub const fn address(self, voxel: [usize; 3]) -> (usize, usize) {
        let [x, y, z] = voxel;
        match self {
            Axis::X => (y, z),
            Axis::Y => (z, x),
            Axis::Z => (y, x),
        }
    }

    /// The voxel at place `i` of the column of this axis at `(line, place)`.
    #[must_use]
    #[inline]
    pub const fn voxel(self, (line, place): (usize, usize), i: usize) -> [usize; 3] {
        match self {
            Axis::X => [i, line, place],
            Axis::Y => [place, i, line],
            Axis::Z => [place, line, i],
        }
    }
}

/// An interval of voxels `lo..=hi` in two bytes. The low end is stored complemented, so that two
/// zero bytes (low end 255, high end 0) are the one encoding of *empty* at every size.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(C)]
pub struct Range {
    not_lo: u8,
    hi: u8,
}

impl Range {
    /// No voxel.
    pub const EMPTY: Range = Range { not_lo: 0, hi: 0 };

    /// Voxels `lo..=hi`; empty when `lo > hi`. Both below 256.
    #[must_use]
    #[inline]
    pub const fn new(lo: usize, hi: usize) -> Self {
        debug_assert!(lo < 256 && hi < 256);
        if lo > hi {
            return Self::EMPTY;
        }
        Range { not_lo: !(lo as u8), hi: hi as u8 }
    }

    /// The hull of a row's set bits.
    #[must_use]
    #[inline]
    pub fn hull<R: Bits>(row: R) -> Self {
        match (row.first(), row.last()) {
            (Some(lo), Some(hi)) => Self::new(lo, hi),
            _ => Self::EMPTY,
        }
    }

    /// The first voxel; 255 when empty.
    #[must_use]
    #[inline]
    pub const fn lo(self) -> usize {
        !self.not_lo as usize
    }

    /// The last voxel; 0 when empty.
    #[must_use]
    #[inline]
    pub const fn hi(self) -> usize {
        self.hi as usize
    }

    /// The same with another first voxel, which isn't behind the last.
    #[must_use]
    #[inline]
    pub(crate) const fn with_lo(self, lo: usize) -> Self {
        Range { not_lo: !(lo as u8), hi: self.hi }
    }

    /// The same with another last voxel, which isn't before the first.
    #[must_use]
    #[inline]
    pub(crate) const fn with_hi(self, hi: usize) -> Self {
        Range { not_lo: self.not_lo, hi: hi as u8 }
    }

    /// Whether no voxel is inside.
    #[must_use]
    #[inline]
    pub const fn is_empty(self) -> bool {
        self.not_lo | self.hi == 0
    }

    /// Whether voxel `i` is inside.
    #[must_use]
    #[inline]
    pub const fn contains(self, i: usize) -> bool {
        (self.lo() <= i) & (i <= self.hi())
    }

    /// The voxels inside as a row.
    #[must_use]
    #[inline]
    pub fn row<R: Bits>(self) -> R {
        if self.is_empty() { R::EMPTY } else { R::span(self.lo(), self.hi()) }
    }

    /// The least range that holds both.
    #[must_use]
    #[inline]
    pub const fn hull_with(self, other: Range) -> Range {
        // The complemented low end makes both ends of the hull a maximum.
        Range {
            not_lo: if self.not_lo > other.not_lo { self.not_lo } else { other.not_lo },
            hi: if self.hi > other.hi { self.hi } else { other.hi },
        }
    }

    /// The same with `hi` as its last voxel, or its only one.
    #[must_use]
    #[inline]
    pub(crate) const fn up_to(self, hi: usize) -> Range {
        if self.is_empty() { Range::new(hi, hi) } else { self.with_hi(hi) }
    }

    /// The two bytes as stored: the complement of the low end, then the high end.
    #[must_use]
    #[inline]
    pub const fn to_bytes(self) -> [u8; 2] {
        [self.not_lo, self.hi]
    }

    /// The inverse of [`Range::to_bytes`]. `None` for bytes no range of a grid of `n` has: an end
    /// outside the grid, or an empty range that is not two zero bytes.
    #[must_use]
    pub fn from_bytes([not_lo, hi]: [u8; 2], n: usize) -> Option<Self> {
        let range = Range { not_lo, hi };
        let valid = range == Self::EMPTY || (range.lo() <= range.hi() && range.hi() < n);
        valid.then_some(range)
    }
}

/// Up to `LAYERS` disjoint intervals of one column, lowest first, empty ones last.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(transparent)]
pub struct Column<const LAYERS: usize = 1>(pub [Range; LAYERS]);

impl<const LAYERS: usize> Column<LAYERS> {
    /// A column without voxels.
    pub const EMPTY: Self = Column([Range::EMPTY; LAYERS]);

    /// Whether voxel `i` is in one of the intervals.
    #[must_use]
    #[inline]
    pub fn contains(&self, i: usize) -> bool {
        self.0.iter().any(|range| range.contains(i))
    }

    /// The voxels inside as a row.
    #[must_use]
    #[inline]
    pub fn row<R: Bits>(&self) -> R {
        self.0.iter().fold(R::EMPTY, |row, range| row | range.row())
    }

    /// From the first occupied voxel to the last.
    #[must_use]
    #[inline]
    pub fn hull(&self) -> Range {
        self.0.iter().fold(Range::EMPTY, |hull, range| hull.hull_with(*range))
    }
}

/// The three range maps of a grid of N^3 voxels: 3 x N x N columns, in the order of
/// [`Axis::address`]. All zero bytes are the empty volume.
#[derive(Clone, PartialEq, Eq, Debug)]
#[repr(C)]
pub struct Maps<const N: usize, const LAYERS: usize = 1> {
    columns: [[[Column<LAYERS>; N]; N]; 3],
}

impl<const N: usize, const LAYERS: usize> Maps<N, LAYERS> {
    /// The empty volume. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the maps about by value
    pub const fn new() -> Self {
        Maps { columns: [[[Column::EMPTY; N]; N]; 3] }
    }

    /// Makes the volume empty, in place.
    pub fn clear(&mut self) {
        self.columns.as_flattened_mut().as_flattened_mut().fill(Column::EMPTY);
    }

    /// Becomes a copy of `other`, in place.
    pub fn copy_from(&mut self, other: &Self) {
        for (mine, its) in self.columns.iter_mut().zip(&other.columns) {
            mine.copy_from_slice(its);
        }
    }

    /// One column.
    #[must_use]
    #[inline]
    pub fn column(&self, axis: Axis, (line, place): (usize, usize)) -> Column<LAYERS> {
        self.columns[axis as usize][line][place]
    }

    /// Replaces one column; the caller keeps the maps tight.
    #[inline]
    pub fn set_column(
        &mut self,
        axis: Axis,
        (line, place): (usize, usize),
        column: Column<LAYERS>,
    ) {
        self.columns[axis as usize][line][place] = column;
    }

    /// Takes a line's columns in `places` over from `other`; the caller keeps the maps tight.
    #[inline]
    pub fn copy_places(&mut self, other: &Self, axis: Axis, line: usize, places: Range) {
        let (map, (first, last)) = (axis as usize, (places.lo(), places.hi()));
        let columns = &other.columns[map][line][first..=last];
        self.columns[map][line][first..=last].copy_from_slice(columns);
    }

    /// One line of N columns of a map.
    #[must_use]
    #[inline]
    pub fn line(&self, axis: Axis, line: usize) -> &[Column<LAYERS>; N] {
        &self.columns[axis as usize][line]
    }

    /// One line of N columns of a map, to be changed; the caller keeps the maps tight.
    #[inline]
    pub(crate) fn line_mut(&mut self, axis: Axis, line: usize) -> &mut [Column<LAYERS>; N] {
        &mut self.columns[axis as usize][line]
    }

    /// Whether a voxel is occupied: all three of its columns hold it.
    #[must_use]
    #[inline]
    pub fn contains(&self, voxel: [usize; 3]) -> bool {
        Axis::ALL
            .iter()
            .all(|&axis| self.column(axis, axis.address(voxel)).contains(voxel[axis as usize]))
    }

    /// Whether no column holds anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        // A line at a time: without a way out after every column the compiler reads many at once.
        let empty = |line: &[Column<LAYERS>; N]| {
            let bits = |column: &Column<LAYERS>| {
                column.0.iter().fold(0, |all, r| all | u16::from_le_bytes(r.to_bytes()))
            };
            line.iter().fold(0, |all, column| all | bits(column)) == 0
        };
        self.columns[0].iter().all(empty)
    }
}

impl<const N: usize, const LAYERS: usize> Maps<N, LAYERS>
where
    Grid<N>: Size,
{
    /// Of the voxels `among` of row (y, z), those that are occupied.
    #[must_use]
    #[inline]
    pub fn row_among(
        &self,
        (y, z): (usize, usize),
        among: <Grid<N> as Size>::Row,
    ) -> <Grid<N> as Size>::Row {
        let mut row = among & self.columns[0][y][z].row();
        for x in row.ones() {
            if !(self.columns[1][z][x].contains(y) && self.columns[2][y][x].contains(z)) {
                row.toggle(x);
            }
        }
        row
    }
}

impl<const N: usize> Maps<N>
where
    Grid<N>: Size,
{
    /// Which columns of a line hold something.
    #[must_use]
    #[inline]
    pub fn occupied(&self, axis: Axis, line: usize) -> <Grid<N> as Size>::Row {
        let mut row = <Grid<N> as Size>::Row::EMPTY;
        for (i, columns) in self.line(axis, line).chunks(64).enumerate() {
            let mut word = 0;
            for (k, four) in columns.as_chunks::<4>().0.iter().enumerate() {
                // No sum carries out of its 16 bits.
                let columns = bytes_of_four(four);
                let any = ((columns & !TOP) + !TOP) | columns;
                word |= gather(any) << (4 * k);
            }
            row.set_word(i, word);
        }
        row
    }

    /// Which of `columns` of a line begin below `first`, and which end above `last`.
    #[must_use]
    #[inline]
    pub fn beyond(
        &self,
        axis: Axis,
        line: usize,
        columns: <Grid<N> as Size>::Row,
        first: usize,
        last: usize,
    ) -> (<Grid<N> as Size>::Row, <Grid<N> as Size>::Row) {
        // What makes the top bit of 16 tell that a byte in them is at least that.
        let at_least = |least: usize| EACH * (0x8000 - least as u64);
        let (from, to) = (at_least(256 - first), at_least(last + 1));
        let (mut below, mut above) = (columns, columns);
        for (i, line) in self.line(axis, line).chunks(64).enumerate() {
            let (mut lo, mut hi) = (0, 0);
            for (k, four) in line.as_chunks::<4>().0.iter().enumerate() {
                if columns.word(i) >> (4 * k) & 15 == 0 {
                    continue;
                }
                let bytes = bytes_of_four(four);
                lo |= gather((bytes & (0xff * EACH)) + from) << (4 * k);
                hi |= gather((bytes >> 8 & (0xff * EACH)) + to) << (4 * k);
            }
            below.set_word(i, columns.word(i) & lo);
            above.set_word(i, columns.word(i) & hi);
        }
        (below, above)
    }
}

/// One in each 16 bits, and the top bit of each.
const EACH: u64 = 0x0001_0001_0001_0001;
const TOP: u64 = 0x8000 * EACH;

/// The complements of the low ends in the low bytes of each 16 bits, the high ends in the others.
#[inline]
fn bytes_of_four(columns: &[Column; 4]) -> u64 {
    let [a, b, c, d] = columns.map(|column| u64::from(u16::from_le_bytes(column.0[0].to_bytes())));
    a | b << 16 | c << 32 | d << 48
}

/// The top bit of each 16, side by side.
#[inline]
fn gather(bits: u64) -> u64 {
    // Bit i x 16 times 2 to the 48 - i x 15 is bit 48 + i; no other product comes that high
    // without falling off the end.
    ((bits & TOP) >> 15).wrapping_mul(1 << 48 | 1 << 33 | 1 << 18 | 1 << 3) >> 48 & 15
}
