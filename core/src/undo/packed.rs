//! Packed entries: a bitmap of columns without its zero words, then their values.

use crate::maps::{Axis, Column, Range};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::{column_key, column_number};

/// Two bytes: a range, or a part of the bitmap.
pub(super) type Cell = [u8; 2];

/// The columns of a packed entry, in the order of its values.
pub(super) struct Columns<'a, const N: usize> {
    flags: &'a [Cell],
    pub(super) words: &'a [[Cell; 4]],
    /// Which word of the bitmap comes next.
    next: usize,
    /// What is left of the one before it.
    bits: u64,
}

impl<'a, const N: usize> Columns<'a, N>
where
    Grid<N>: Size,
{
    /// The columns of the entry that `cells` begin with, and its values with all that follows.
    pub(super) fn of(cells: &'a [Cell]) -> (Self, &'a [Cell]) {
        let (bitmap, values) = cells.split_at(Self::bitmap_cells(cells));
        (Self::new(bitmap), values)
    }

    /// The same, the values to be changed.
    pub(super) fn split(cells: &'a mut [Cell]) -> (Self, &'a mut [Cell]) {
        let (bitmap, values) = cells.split_at_mut(Self::bitmap_cells(cells));
        (Self::new(bitmap), values)
    }

    pub(super) fn bitmap_cells(cells: &[Cell]) -> usize {
        let flags = &cells[..flag_cells::<N>()];
        let words: u32 = flags.iter().map(|cell| u16::from_le_bytes(*cell).count_ones()).sum();
        flags.len() + 4 * words as usize
    }

    fn new(bitmap: &'a [Cell]) -> Self {
        let (flags, words) = bitmap.split_at(flag_cells::<N>());
        Columns { flags, words: words.as_chunks().0, next: 0, bits: 0 }
    }
}

impl<const N: usize> Iterator for Columns<'_, N>
where
    Grid<N>: Size,
{
    type Item = (Axis, (usize, usize));

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        while self.bits == 0 {
            let flags = u16::from_le_bytes(*self.flags.get(self.next / 16)?);
            if flags >> (self.next % 16) & 1 != 0 {
                let (word, rest) = self.words.split_first()?;
                self.words = rest;
                self.bits = u64_of(word);
            }
            self.next += 1;
        }
        let bit = self.bits.trailing_zeros() as usize;
        self.bits &= self.bits - 1;
        let words = <Grid<N> as Size>::Row::WORDS;
        let (row, word) = ((self.next - 1) / words, (self.next - 1) % words);
        Some((Axis::ALL[row / N], (row % N, word * 64 + bit)))
    }
}

/// Cells that an entry's flags take, one bit for each word of the bitmap.
pub(super) const fn flag_cells<const N: usize>() -> usize
where
    Grid<N>: Size,
{
    3 * N * <Grid<N> as Size>::Row::WORDS / 16
}

/// The sum of [`term`] over the columns of the entry that `cells` begin with.
pub(super) fn sum_of<const N: usize>(cells: &[Cell]) -> u64
where
    Grid<N>: Size,
{
    let (columns, values) = Columns::<N>::of(cells);
    let terms = columns.zip(values).map(|((axis, at), cell)| term(axis, at, column_of::<N>(*cell)));
    terms.fold(0, u64::wrapping_add)
}

/// What a column adds to the digest of an entry: unlike [`crate::volume::column_digest`] not
/// nothing when it is empty, as it counts that the entry holds it.
#[inline]
pub(super) fn term(axis: Axis, at: (usize, usize), column: Column) -> u64 {
    column_key(axis, at).wrapping_mul(entry_number(column))
}

/// A column's bytes as a number that is never 0.
#[inline]
pub(super) fn entry_number(column: Column) -> u64 {
    column_number(column) | 1 << 16
}

#[inline]
pub(super) fn bytes_of(column: Column) -> Cell {
    column.0[0].to_bytes()
}

/// The inverse of [`bytes_of`], for bytes it made or that were checked.
#[inline]
pub(super) fn column_of<const N: usize>(cell: Cell) -> Column {
    Column([Range::from_bytes(cell, N).unwrap_or(Range::EMPTY)])
}

#[inline]
pub(super) fn u64_of(word: &[Cell; 4]) -> u64 {
    let mut bytes = [0; 8];
    bytes.copy_from_slice(word.as_flattened());
    u64::from_le_bytes(bytes)
}
