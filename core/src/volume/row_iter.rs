//! Iterators over the set bits of a row and over its runs.

use crate::volume::range::Range;
use crate::volume::row::BitSet;

/// Iterator over the set bits of a row.
#[derive(Debug, Clone)]
pub struct SetBits<R> {
    row: R,
    word: usize,
    /// The bits of that word that weren't visited yet.
    bits: u64,
}

impl<R: BitSet> SetBits<R> {
    /// Creates an iterator over all set bits of a row, lowest first.
    pub(super) fn new(row: R) -> Self {
        SetBits { row, word: 0, bits: row.word(0) }
    }
}

impl<R: BitSet> Iterator for SetBits<R> {
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
pub struct BitRuns<R> {
    row: R,
    word: usize,
    /// The bits of that word that weren't visited yet.
    bits: u64,
}

impl<R: BitSet> BitRuns<R> {
    /// Creates an iterator over all runs of a row, lowest first.
    pub(super) fn new(row: R) -> Self {
        BitRuns { row, word: 0, bits: row.word(0) }
    }
}

impl<R: BitSet> Iterator for BitRuns<R> {
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
