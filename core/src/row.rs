//! One line of voxels along x as machine words: bit i is voxel x = i.

use core::fmt::Debug;
use core::ops::{BitAnd, BitAndAssign, BitOr, BitOrAssign, BitXor, BitXorAssign, Not};

use crate::maps::Range;

/// A row of `64 * WORDS` bits, lowest first.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Row<const WORDS: usize>(pub [u64; WORDS]);

/// What every algorithm here needs of a row. Bits above the grid's N are never set by the grid's
/// own rows; `!` sets them, so a complement is always met with a row.
pub trait Bits:
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

    /// Bits `lo..=hi`, as far as the row goes; none when `lo > hi`.
    #[must_use]
    fn span(lo: usize, hi: usize) -> Self;
    /// Words `first..first + W` as a row of their own.
    #[must_use]
    fn part<const W: usize>(&self, first: usize) -> Row<W>;
    /// Replaces these words.
    fn set_part<const W: usize>(&mut self, first: usize, part: Row<W>);
    /// A row of these words and no others.
    #[must_use]
    #[inline]
    fn of_part<const W: usize>(first: usize, part: Row<W>) -> Self {
        let mut row = Self::EMPTY;
        row.set_part(first, part);
        row
    }
    /// The word that holds bits `64 * i ..`.
    #[must_use]
    fn word(&self, i: usize) -> u64;
    /// Replaces a word.
    fn set_word(&mut self, i: usize, word: u64);
    /// Whether bit `i` is set.
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
    /// Whether no bit is set.
    #[must_use]
    fn is_empty(&self) -> bool;
    /// Number of bits set.
    #[must_use]
    fn count(&self) -> u32;
    /// The lowest set bit.
    #[must_use]
    fn first(&self) -> Option<usize>;
    /// The highest set bit.
    #[must_use]
    fn last(&self) -> Option<usize>;
    /// Every bit one place up (towards +x).
    #[must_use]
    fn up(self) -> Self;
    /// Every bit one place down (towards -x).
    #[must_use]
    fn down(self) -> Self;
    /// Bit i of the result is bit `n - 1 - i`: the voxel mirror of a row of `n` voxels.
    #[must_use]
    fn mirrored(self, n: usize) -> Self;
    /// The maximal runs of `self` that hold at least one bit of `seeds`, whole.
    #[must_use]
    fn runs_with(self, seeds: Self) -> Self;
    /// The set bits, lowest first.
    fn ones(self) -> Ones<Self> {
        Ones { row: self, word: 0, bits: self.word(0) }
    }
    /// The maximal runs of set bits, lowest first, but cut where a word of 64 ends.
    fn runs(self) -> Runs<Self> {
        Runs { row: self, word: 0, bits: self.word(0) }
    }
}

/// Iterator over the set bits of a row.
#[derive(Debug, Clone)]
pub struct Ones<R> {
    row: R,
    word: usize,
    /// What is left of that word.
    bits: u64,
}

impl<R: Bits> Iterator for Ones<R> {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        while self.bits == 0 {
            if self.word + 1 == R::WORDS {
                return None;
            }
            self.word += 1;
            self.bits = self.row.word(self.word);
        }
        let bit = self.bits.trailing_zeros() as usize;
        self.bits &= self.bits - 1;
        Some(self.word * 64 + bit)
    }
}

/// Iterator over the runs of a row, as ranges that are not empty.
#[derive(Debug, Clone)]
pub struct Runs<R> {
    row: R,
    word: usize,
    /// What is left of that word.
    bits: u64,
}

impl<R: Bits> Iterator for Runs<R> {
    type Item = Range;

    #[inline]
    fn next(&mut self) -> Option<Range> {
        while self.bits == 0 {
            if self.word + 1 == R::WORDS {
                return None;
            }
            self.word += 1;
            self.bits = self.row.word(self.word);
        }
        let lo = self.bits.trailing_zeros();
        let len = (!(self.bits >> lo)).trailing_zeros();
        self.bits &= u64::MAX.checked_shl(lo + len).unwrap_or(0);
        let base = self.word * 64;
        Some(Range::new(base + lo as usize, base + (lo + len) as usize - 1))
    }
}

impl<const W: usize> Bits for Row<W> {
    const EMPTY: Self = Row([0; W]);
    const WORDS: usize = W;

    #[inline]
    fn span(lo: usize, hi: usize) -> Self {
        if lo > hi {
            return Self::EMPTY;
        }
        if hi < 64 {
            return Self::of_part(0, Row([u64::MAX << lo & u64::MAX >> (63 - hi)]));
        }
        Row(Self::BELOW[(hi + 1).min(256)]) & !Row(Self::BELOW[lo.min(256)])
    }

    #[inline]
    fn part<const P: usize>(&self, first: usize) -> Row<P> {
        let mut part = [0; P];
        part.copy_from_slice(&self.0[first..first + P]);
        Row(part)
    }

    #[inline]
    fn set_part<const P: usize>(&mut self, first: usize, part: Row<P>) {
        self.0[first..first + P].copy_from_slice(&part.0);
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
    fn count(&self) -> u32 {
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
    fn up(self) -> Self {
        let mut words = [0; W];
        let mut carry = 0;
        for (word, w) in words.iter_mut().zip(self.0) {
            *word = w << 1 | carry;
            carry = w >> 63;
        }
        Row(words)
    }

    #[inline]
    fn down(self) -> Self {
        let mut words = [0; W];
        let mut carry = 0;
        for i in (0..W).rev() {
            words[i] = self.0[i] >> 1 | carry;
            carry = self.0[i] << 63;
        }
        Row(words)
    }

    #[inline]
    fn mirrored(self, n: usize) -> Self {
        let mut words = [0; W];
        for (i, word) in words.iter_mut().enumerate() {
            *word = self.0[W - 1 - i].reverse_bits();
        }
        // Fewer than 64 voxels sit in the low bits of one word, and come out in its high bits.
        if n < 64 {
            words[0] >>= 64 - n;
        }
        Row(words)
    }

    /// Adding the seeds to the runs carries from the first seed of each run out of its top, which
    /// empties all places between but those of further seeds. What lies below a first seed is
    /// looked for run by run.
    #[inline]
    fn runs_with(self, seeds: Self) -> Self {
        let seeds = seeds & self;
        // Nothing but seeds.
        if self == seeds {
            return self;
        }
        let mut found = self & (!add(self, seeds) | seeds);
        let mut open = found & (self & !found).up();
        for i in 0..W {
            while open.0[i] != 0 {
                found |= self.run_below(i * 64 + open.0[i].trailing_zeros() as usize);
                open.0[i] &= open.0[i] - 1;
            }
        }
        found
    }
}

impl<const W: usize> Row<W> {
    /// The bits below each place.
    const BELOW: &[[u64; W]; 257] = &{
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

    /// The run of set bits that ends just below bit `end`.
    #[inline]
    fn run_below(self, end: usize) -> Self {
        let below = Self::span(0, end - 1);
        let start = (!self & below).last().map_or(0, |gap| gap + 1);
        Self::span(start, end - 1)
    }
}

/// The sum, without the carry out of the top.
#[inline]
fn add<const W: usize>(a: Row<W>, b: Row<W>) -> Row<W> {
    let mut sum = Row([0; W]);
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
        impl<const W: usize> $op for Row<W> {
            type Output = Self;
            #[inline]
            fn $f(mut self, other: Self) -> Self {
                self.$f_assign(other);
                self
            }
        }
        impl<const W: usize> $op_assign for Row<W> {
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

impl<const W: usize> Not for Row<W> {
    type Output = Self;
    #[inline]
    fn not(mut self) -> Self {
        for w in &mut self.0 {
            *w = !*w;
        }
        self
    }
}
