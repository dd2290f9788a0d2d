//! Packed undo entries: a bitmap of columns without its zero words, then their values, K cells each.

use crate::codec::digest::DIGEST_KEYS;
use crate::volume::column_digest::{column_key, column_number, line_key};
use crate::volume::range_maps::{Axis, Column, ColumnAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// Two bytes: a range, or a part of the bitmap.
pub(super) type EntryCell = [u8; 2];

/// The columns of a packed entry, in the order of its values.
pub(super) struct EntryColumns<'a, const N: usize> {
    flags: &'a [EntryCell],
    pub(super) words: &'a [[EntryCell; 4]],
    /// The index of the next word of the bitmap.
    next: usize,
    /// The unread bits of the word before it.
    bits: u64,
}

/// Adjacent columns in a line, 64 at most.
pub(super) struct EntryRun {
    pub(super) axis: Axis,
    pub(super) first: ColumnAddress,
    pub(super) columns: usize,
}

impl<'a, const N: usize> EntryColumns<'a, N>
where
    Grid<N>: Size,
{
    /// Parses the entry at the start of `cells`. Returns its columns, and the cells from its values on.
    pub(super) fn split_columns_and_values(cells: &'a [EntryCell]) -> (Self, &'a [EntryCell]) {
        let (bitmap, values) = cells.split_at(Self::bitmap_cell_count(cells));
        (Self::new(bitmap), values)
    }

    /// [`EntryColumns::split_columns_and_values`] with mutable values.
    pub(super) fn split_columns_and_values_mut(
        cells: &'a mut [EntryCell],
    ) -> (Self, &'a mut [EntryCell]) {
        let (bitmap, values) = cells.split_at_mut(Self::bitmap_cell_count(cells));
        (Self::new(bitmap), values)
    }

    /// Returns the number of cells of the bitmap of the entry at the start of `cells`, including its flags.
    pub(super) fn bitmap_cell_count(cells: &[EntryCell]) -> usize {
        let flags = &cells[..flag_cell_count::<N>()];
        let words: u32 = flags.iter().map(|cell| u16::from_le_bytes(*cell).count_ones()).sum();
        flags.len() + 4 * words as usize
    }

    fn new(bitmap: &'a [EntryCell]) -> Self {
        let (flags, words) = bitmap.split_at(flag_cell_count::<N>());
        EntryColumns { flags, words: words.as_chunks().0, next: 0, bits: 0 }
    }

    /// Returns the next adjacent columns in a word of the bitmap.
    #[inline]
    pub(super) fn next_run(&mut self) -> Option<EntryRun> {
        self.read_word_if_needed()?;
        let bit = self.bits.trailing_zeros() as usize;
        let columns = (self.bits >> bit).trailing_ones() as usize;
        // Carries through the run; higher bits are kept.
        self.bits &= self.bits.wrapping_add(1 << bit);
        let (axis, first) = self.column_of_bit(bit);
        Some(EntryRun { axis, first, columns })
    }

    /// Advances to the next non-zero word once all bits of the last word are read. Returns `None` at the end.
    #[inline]
    fn read_word_if_needed(&mut self) -> Option<()> {
        while self.bits == 0 {
            let flags = u16::from_le_bytes(*self.flags.get(self.next / 16)?);
            if flags >> (self.next % 16) & 1 != 0 {
                let (word, rest) = self.words.split_first()?;
                self.words = rest;
                self.bits = word_from_cells(word);
            }
            self.next += 1;
        }
        Some(())
    }

    /// Returns the column of a bit of the word read last.
    #[inline]
    const fn column_of_bit(&self, bit: usize) -> (Axis, ColumnAddress) {
        let words = <Grid<N> as Size>::Row::WORDS;
        let (row, word) = ((self.next - 1) / words, (self.next - 1) % words);
        (Axis::ALL[row / N], (row % N, word * 64 + bit))
    }
}

impl<const N: usize> Iterator for EntryColumns<'_, N>
where
    Grid<N>: Size,
{
    type Item = (Axis, ColumnAddress);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        self.read_word_if_needed()?;
        let bit = self.bits.trailing_zeros() as usize;
        self.bits &= self.bits - 1;
        Some(self.column_of_bit(bit))
    }
}

/// Returns the number of cells of an entry's flags, one bit for each word of the bitmap.
pub(super) const fn flag_cell_count<const N: usize>() -> usize
where
    Grid<N>: Size,
{
    3 * N * <Grid<N> as Size>::Row::WORDS / 16
}

/// Returns the sum of [`digest_term`] over the columns of the entry at the start of `cells`.
pub(super) fn digest_sum<const N: usize, const K: usize>(cells: &[EntryCell]) -> u64
where
    Grid<N>: Size,
{
    let (columns, values) = EntryColumns::<N>::split_columns_and_values(cells);
    let terms = columns
        .zip(values.as_chunks().0)
        .map(|((axis, at), cells)| digest_term(axis, at, Column::<K>::from_checked_bytes(*cells)));
    terms.fold(0, u64::wrapping_add)
}

/// Returns a column's term in the digest of an entry. Unlike in a digest of maps, an empty column has a
/// non-zero term, as it counts that the entry contains the column.
#[inline]
pub(super) fn digest_term<const K: usize>(axis: Axis, at: ColumnAddress, column: Column<K>) -> u64 {
    column_key(axis, at).wrapping_mul(nonzero_column_number(column))
}

/// Returns a column's bytes as a number other than 0.
#[inline]
pub(super) fn nonzero_column_number<const K: usize>(column: Column<K>) -> u64 {
    // No column has all bits of its number set: two intervals can't both begin at 0.
    if K == 1 { column_number(column) | 1 << 16 } else { column_number(column) + 1 }
}

/// Returns the sum of [`digest_term`] over columns of a line, from `first` on.
#[inline]
pub(super) fn digest_of_run<const K: usize>(
    axis: Axis,
    (line, first): ColumnAddress,
    columns: &[Column<K>],
) -> u64 {
    let terms = columns.iter().zip(&DIGEST_KEYS[first..]);
    let sum = terms.fold(0u64, |sum, (column, key)| {
        sum.wrapping_add(key.wrapping_mul(nonzero_column_number(*column)))
    });
    sum.wrapping_mul(line_key(axis, line))
}

#[inline]
pub(super) fn word_from_cells(word: &[EntryCell; 4]) -> u64 {
    let mut bytes = [0; 8];
    bytes.copy_from_slice(word.as_flattened());
    u64::from_le_bytes(bytes)
}
