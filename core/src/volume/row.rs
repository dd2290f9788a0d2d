//! A bit row: one line of voxels along x as machine words. Bit i is voxel x = i.

use core::array;
use core::fmt::Debug;
use core::ops::{BitAnd, BitAndAssign, BitOr, BitOrAssign, BitXor, BitXorAssign, Not};

use crate::volume::range::Range;
use crate::volume::row_iter::{BitRuns, SetBits};

/// A row of `64 * WORDS` bits, lowest first.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BitRow<const WORDS: usize>(pub [u64; WORDS]);

/// Bit set operations on a row. The rows of a grid never have bits at or above N set; `!` sets them, so
/// a complement must be intersected with a row.
pub trait BitSet:
    Copy
    + Eq
    + Debug
    + Send
    + Sync
    + 'static
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
    + BitAndAssign
    + BitOrAssign
    + BitXorAssign
{
    /// No bit set.
    const EMPTY: Self;
    /// Machine words in a row.
    const WORDS: usize;

    /// Returns a row with bits `first..=last` set, cut at the row's end; empty if `first > last`.
    #[must_use]
    fn span(first: usize, last: usize) -> Self;
    /// Returns a row with the voxels of a range set, cut at the row's end, without a branch.
    #[must_use]
    fn from_range(range: Range) -> Self;
    /// Returns words `first_word..first_word + W` as a row.
    #[must_use]
    fn word_span<const W: usize>(&self, first_word: usize) -> BitRow<W>;
    /// Replaces words `first_word..first_word + W`.
    fn set_word_span<const W: usize>(&mut self, first_word: usize, words: BitRow<W>);
    /// Returns a row with the words `first_word..first_word + W` set and all others empty.
    #[must_use]
    #[inline]
    fn from_word_span<const W: usize>(first_word: usize, words: BitRow<W>) -> Self {
        let mut row = Self::EMPTY;
        row.set_word_span(first_word, words);
        row
    }
    /// Returns word `i`, which holds the bits from `64 * i` on.
    #[must_use]
    fn word(&self, i: usize) -> u64;
    /// Replaces word `i`.
    fn set_word(&mut self, i: usize, word: u64);
    /// Returns `true` if bit `i` is set.
    #[must_use]
    #[inline]
    fn contains(&self, i: usize) -> bool {
        self.word(i / 64) >> (i % 64) & 1 != 0
    }
    /// Sets bit `i`.
    #[inline]
    fn insert(&mut self, i: usize) {
        self.set_word(i / 64, self.word(i / 64) | 1 << (i % 64));
    }
    /// Sets bit `i` if `set`, without a branch.
    #[inline]
    fn insert_if(&mut self, set: bool, i: usize) {
        self.set_word(i / 64, self.word(i / 64) | u64::from(set) << (i % 64));
    }
    /// Flips bit `i`.
    #[inline]
    fn toggle(&mut self, i: usize) {
        self.set_word(i / 64, self.word(i / 64) ^ 1 << (i % 64));
    }
    /// Returns `true` if no bit is set.
    #[must_use]
    fn is_empty(&self) -> bool;
    /// Returns the number of bits set.
    #[must_use]
    fn count_ones(&self) -> u32;
    /// Returns the lowest set bit.
    #[must_use]
    fn first(&self) -> Option<usize>;
    /// Returns the highest set bit.
    #[must_use]
    fn last(&self) -> Option<usize>;
    /// Returns the row with every bit moved one place up (towards +x).
    #[must_use]
    fn shifted_up(self) -> Self;
    /// Returns the row with every bit moved one place down (towards -x).
    #[must_use]
    fn shifted_down(self) -> Self;
    /// Returns the mirror image of a row of `grid_side` voxels: bit i of the result is bit `grid_side - 1 -
    /// i`.
    #[must_use]
    fn mirrored(self, grid_side: usize) -> Self;
    /// Flood fill along the row: returns the maximal runs of `self` that contain at least one bit of `seeds`.
    #[must_use]
    fn flood_from(self, seeds: Self) -> Self;
    /// Returns the row without its lowest maximal run.
    #[must_use]
    fn without_lowest_run(self) -> Self;
    /// Iterates over the set bits, lowest first.
    fn iter_ones(self) -> SetBits<Self> {
        SetBits::new(self)
    }
    /// Iterates over the runs of set bits, lowest first, split at word boundaries.
    fn iter_runs_within_words(self) -> BitRuns<Self> {
        BitRuns::new(self)
    }
}

impl Range {
    /// Returns the smallest range that contains all set bits of a row.
    #[must_use]
    #[inline]
    pub fn hull_of<R: BitSet>(row: R) -> Self {
        row.first().zip(row.last()).map_or(Self::EMPTY, |(lo, hi)| Self::new(lo, hi))
    }

    /// Returns the voxels inside as a row.
    #[must_use]
    #[inline]
    pub fn to_row<R: BitSet>(self) -> R {
        if self.is_empty() { R::EMPTY } else { R::span(self.first(), self.last()) }
    }
}

impl<const W: usize> BitSet for BitRow<W> {
    const EMPTY: Self = BitRow([0; W]);
    const WORDS: usize = W;

    #[inline]
    fn span(first: usize, last: usize) -> Self {
        if first > last {
            return Self::EMPTY;
        }
        if last < 64 {
            return Self::from_word_span(0, BitRow([u64::MAX << first & u64::MAX >> (63 - last)]));
        }
        BitRow(Self::BITS_BELOW[(last + 1).min(256)]) & !BitRow(Self::BITS_BELOW[first.min(256)])
    }

    #[inline]
    fn from_range(range: Range) -> Self {
        let end = range.last() + 1; // an empty range begins at 255, behind it
        BitRow(Self::BITS_BELOW[end]) ^ BitRow(Self::BITS_BELOW[range.first().min(end)])
    }

    #[inline]
    fn word_span<const P: usize>(&self, first_word: usize) -> BitRow<P> {
        let mut words = [0; P];
        words.copy_from_slice(&self.0[first_word..first_word + P]);
        BitRow(words)
    }

    #[inline]
    fn set_word_span<const P: usize>(&mut self, first_word: usize, words: BitRow<P>) {
        self.0[first_word..first_word + P].copy_from_slice(&words.0);
    }

    #[inline]
    fn word(&self, i: usize) -> u64 {
        self.0[i]
    }

    #[inline]
    fn set_word(&mut self, i: usize, word: u64) {
        self.0[i] = word;
    }

    #[inline]
    fn is_empty(&self) -> bool {
        self.0.iter().fold(0, |all, w| all | w) == 0
    }

    #[inline]
    fn count_ones(&self) -> u32 {
        self.0.iter().map(|w| w.count_ones()).sum()
    }

    #[inline]
    fn first(&self) -> Option<usize> {
        (0..W).find(|&i| self.0[i] != 0).map(|i| i * 64 + self.0[i].trailing_zeros() as usize)
    }

    #[inline]
    fn last(&self) -> Option<usize> {
        (0..W)
            .rev()
            .find(|&i| self.0[i] != 0)
            .map(|i| i * 64 + 63 - self.0[i].leading_zeros() as usize)
    }

    #[inline]
    fn shifted_up(self) -> Self {
        let mut words = [0; W];
        let mut carry = 0;
        for (word, w) in words.iter_mut().zip(self.0) {
            *word = w << 1 | carry;
            carry = w >> 63;
        }
        BitRow(words)
    }

    #[inline]
    fn shifted_down(self) -> Self {
        let mut words = [0; W];
        let mut carry = 0;
        for i in (0..W).rev() {
            words[i] = self.0[i] >> 1 | carry;
            carry = self.0[i] << 63;
        }
        BitRow(words)
    }

    #[inline]
    fn mirrored(self, grid_side: usize) -> Self {
        let mut words = [0; W];
        for (i, word) in words.iter_mut().enumerate() {
            *word = self.0[W - 1 - i].reverse_bits();
        }
        // Fewer than 64 voxels are in the low bits of one word, and end up in its high bits.
        if grid_side < 64 {
            words[0] >>= 64 - grid_side;
        }
        BitRow(words)
    }

    /// Carry propagation: adding the seeds to the runs carries from the lowest seed of each run out of its
    /// top, which clears the bits between except for further seeds. The bits below each lowest seed are then
    /// filled run by run.
    #[inline]
    fn flood_from(self, seeds: Self) -> Self {
        let seeds = seeds & self;
        // Every bit is a seed.
        if self == seeds {
            return self;
        }
        let mut found = self & (!add_with_carry(self, seeds) | seeds);
        let mut open = found & (self & !found).shifted_up();
        for i in 0..W {
            while open.0[i] != 0 {
                found |= self.run_ending_before(i * 64 + open.0[i].trailing_zeros() as usize);
                open.0[i] &= open.0[i] - 1;
            }
        }
        found
    }

    /// Adding the lowest bit carries out of the top of its run.
    #[inline]
    fn without_lowest_run(self) -> Self {
        let mut lowest = Self::EMPTY;
        let mut below = 0;
        for (bit, word) in lowest.0.iter_mut().zip(self.0) {
            *bit = if below == 0 { word & word.wrapping_neg() } else { 0 };
            below |= word;
        }
        add_with_carry(self, lowest) & self
    }
}

impl<const W: usize> BitRow<W> {
    /// The mask of all bits below a place, indexed by place.
    const BITS_BELOW: &[[u64; W]; 257] = &{
        let mut below = [[0; W]; 257];
        let mut place = 1;
        while place < below.len() {
            below[place] = below[place - 1];
            let word = (place - 1) / 64;
            if word < W {
                below[place][word] |= 1 << ((place - 1) % 64);
            }
            place += 1;
        }
        below
    };

    /// Returns `P` words of the row from any bit on, with zeros beyond its end.
    #[inline]
    pub(crate) fn bits_from<const P: usize>(self, first: usize) -> BitRow<P> {
        let (word, places) = (first / 64, first as u32 % 64);
        let word_at = |i: usize| u128::from(self.0.get(word + i).copied().unwrap_or(0));
        BitRow(array::from_fn(|i| ((word_at(i + 1) << 64 | word_at(i)) >> places) as u64))
    }

    /// The inverse of [`BitRow::bits_from`]: returns a row with `bits` from that bit on, and zeros elsewhere.
    #[inline]
    pub(crate) fn from_bits_at<const P: usize>(bits: BitRow<P>, first: usize) -> Self {
        let (word, places) = (first / 64, first as u32 % 64);
        let mut row = Self::EMPTY;
        for (i, bits) in bits.0.into_iter().enumerate() {
            let wide = u128::from(bits) << places;
            for (j, part) in [wide as u64, (wide >> 64) as u64].into_iter().enumerate() {
                if let Some(word) = row.0.get_mut(word + i + j) {
                    *word |= part;
                }
            }
        }
        row
    }

    /// Returns the row with every bit moved up by fewer than 64 places.
    #[inline]
    pub(crate) fn shifted_up_by(self, places: u32) -> Self {
        let mut words = [0; W];
        let mut carry = 0;
        for (word, w) in words.iter_mut().zip(self.0) {
            let wide = u128::from(w) << places;
            *word = wide as u64 | carry;
            carry = (wide >> 64) as u64;
        }
        BitRow(words)
    }

    /// Returns the row with every bit moved down by fewer than 64 places.
    #[inline]
    pub(crate) fn shifted_down_by(self, places: u32) -> Self {
        let mut words = [0; W];
        let mut carry = 0;
        for i in (0..W).rev() {
            let wide = (u128::from(self.0[i]) << 64) >> places;
            words[i] = (wide >> 64) as u64 | carry;
            carry = wide as u64;
        }
        BitRow(words)
    }

    /// Returns the run of set bits that ends just below bit `end`.
    #[inline]
    fn run_ending_before(self, end: usize) -> Self {
        let below = Self::span(0, end - 1);
        let start = (!self & below).last().map_or(0, |gap| gap + 1);
        Self::span(start, end - 1)
    }
}

/// Adds two rows as multiword integers, without the carry out of the top.
#[inline]
fn add_with_carry<const W: usize>(a: BitRow<W>, b: BitRow<W>) -> BitRow<W> {
    let mut sum = BitRow([0; W]);
    let mut carry = false;
    for i in 0..W {
        let (s, c1) = a.0[i].overflowing_add(b.0[i]);
        let (s, c2) = s.overflowing_add(u64::from(carry));
        sum.0[i] = s;
        carry = c1 | c2;
    }
    sum
}

macro_rules! word_wise {
    ($($op:ident, $op_assign:ident, $f:ident, $f_assign:ident;)*) => {$(
        impl<const W: usize> $op for BitRow<W> {
            type Output = Self;
            #[inline]
            fn $f(mut self, other: Self) -> Self {
                self.$f_assign(other);
                self
            }
        }
        impl<const W: usize> $op_assign for BitRow<W> {
            #[inline]
            fn $f_assign(&mut self, other: Self) {
                for (a, b) in self.0.iter_mut().zip(other.0) {
                    a.$f_assign(b);
                }
            }
        }
    )*};
}

word_wise! {
    BitAnd, BitAndAssign, bitand, bitand_assign;
    BitOr, BitOrAssign, bitor, bitor_assign;
    BitXor, BitXorAssign, bitxor, bitxor_assign;
}

impl<const W: usize> Not for BitRow<W> {
    type Output = Self;
    #[inline]
    fn not(mut self) -> Self {
        for w in &mut self.0 {
            *w = !*w;
        }
        self
    }
}
