//! An interval of voxels of a column, in two bytes.

/// A closed interval of voxels, `first..=last`, in two bytes. The first is stored complemented, so that two
/// zero bytes (first 255, last 0) are the only encoding of *empty* at every grid size.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(C)]
pub struct Range {
    not_first: u8,
    last: u8,
}

impl Range {
    /// The empty range.
    pub const EMPTY: Range = Range { not_first: 0, last: 0 };

    /// Creates the range of voxels `first..=last`, which is empty if `first > last`. Both must be below 256.
    #[must_use]
    #[inline]
    pub const fn new(first: usize, last: usize) -> Self {
        debug_assert!(first < 256 && last < 256);
        if first > last {
            return Self::EMPTY;
        }
        Range { not_first: !(first as u8), last: last as u8 }
    }

    /// Returns the first voxel, or 255 if the range is empty.
    #[must_use]
    #[inline]
    pub const fn first(self) -> usize {
        !self.not_first as usize
    }

    /// Returns the last voxel, or 0 if the range is empty.
    #[must_use]
    #[inline]
    pub const fn last(self) -> usize {
        self.last as usize
    }

    /// Returns the range with another first voxel, which must be at most the last.
    #[must_use]
    #[inline]
    pub(crate) const fn with_first(self, first: usize) -> Self {
        Range { not_first: !(first as u8), last: self.last }
    }

    /// Returns the range with another last voxel, which must be at least the first.
    #[must_use]
    #[inline]
    pub(crate) const fn with_last(self, last: usize) -> Self {
        Range { not_first: self.not_first, last: last as u8 }
    }

    /// Returns `true` if no voxel is inside.
    #[must_use]
    #[inline]
    pub const fn is_empty(self) -> bool {
        self.not_first | self.last == 0
    }

    /// Returns `true` if voxel `i` is inside.
    #[must_use]
    #[inline]
    pub const fn contains(self, i: usize) -> bool {
        (self.first() <= i) & (i <= self.last())
    }

    /// Returns two flags: `true` if both ranges have the same first voxel, and `true` if they have the same
    /// last voxel.
    #[inline]
    pub(crate) const fn equal_ends(self, other: Range) -> [bool; 2] {
        let differing_bits = self.to_number() ^ other.to_number();
        [differing_bits & 0xff == 0, differing_bits < 0x100]
    }

    /// Returns the smallest range that contains both.
    #[must_use]
    #[inline]
    pub const fn hull_with(self, other: Range) -> Range {
        // With the first complemented, both ends of the hull are maxima.
        Range {
            not_first: if self.not_first > other.not_first {
                self.not_first
            } else {
                other.not_first
            },
            last: if self.last > other.last { self.last } else { other.last },
        }
    }

    /// Returns the range with `last` as its last voxel, or a range of this single voxel if it was empty.
    #[must_use]
    #[inline]
    pub(crate) const fn extended_to(self, last: usize) -> Range {
        if self.is_empty() { Range::new(last, last) } else { self.with_last(last) }
    }

    /// Returns the two bytes as stored: the complement of the first voxel, then the last.
    #[must_use]
    #[inline]
    pub const fn to_bytes(self) -> [u8; 2] {
        [self.not_first, self.last]
    }

    /// Returns [`Range::to_bytes`] as a number.
    #[inline]
    pub(crate) const fn to_number(self) -> u16 {
        u16::from_le_bytes(self.to_bytes())
    }

    /// The inverse of [`Range::to_number`]. The bytes must have been accepted by [`Range::from_bytes`].
    #[inline]
    pub(crate) const fn from_number(number: u16) -> Self {
        let [not_first, last] = number.to_le_bytes();
        Range { not_first, last }
    }

    /// The inverse of [`Range::to_bytes`]. Returns `None` for bytes that are invalid in a grid of `grid_side`
    /// voxels a side: an end outside the grid, or an empty range that isn't two zero bytes.
    #[must_use]
    pub fn from_bytes([not_first, last]: [u8; 2], grid_side: usize) -> Option<Self> {
        let range = Range { not_first, last };
        let valid =
            range == Self::EMPTY || (range.first() <= range.last() && range.last() < grid_side);
        valid.then_some(range)
    }
}
