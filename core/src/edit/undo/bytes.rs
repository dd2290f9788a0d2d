//! Serialisation and digest of the undo history.

use super::packed::{
    EntryCell, EntryColumns, digest_sum, digest_term, flag_cell_count, word_from_cells,
};
use super::unpacked::UnpackedEntry;
use super::{PackedEntry, UndoHistory};
use crate::codec::bad_save::{BadSave, INTERVALS_OF_A_COLUMN};
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::digest::mix_bits;
use crate::limits::UNDO_ENTRIES;
use crate::volume::range_maps::{Axis, Column};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// Bytes of a saved history before its first entry: two numbers and flags.
const HEADER_BYTES: usize = 5;

impl<const N: usize, const K: usize> UndoHistory<N, K>
where
    Grid<N>: Size,
{
    /// Returns a digest of all entries and of which are applied. The columns' part is maintained
    /// incrementally.
    #[must_use]
    pub fn digest(&self) -> u64 {
        self.digest_with(self.head.sum, |entry, _| entry.sum)
    }

    /// Returns the same digest, computed without the incremental sums.
    #[must_use]
    pub fn recompute_digest(&self) -> u64 {
        let mut sum = 0u64;
        for (axis, line) in Axis::ALL.into_iter().flat_map(|axis| (0..N).map(move |i| (axis, i))) {
            for place in self.head.changed[axis as usize][line].iter_ones() {
                let other = self.head.others[axis as usize][line][place];
                sum = sum.wrapping_add(digest_term(axis, (line, place), other));
            }
        }
        self.digest_with(sum, |_, cells| digest_sum::<N, K>(cells))
    }

    fn digest_with(&self, head: u64, packed: impl Fn(&PackedEntry, &[EntryCell]) -> u64) -> u64 {
        let mut cells = self.cells.as_flattened().as_flattened().as_flattened();
        let mut digest = mix_bits(
            u64::from(self.applied) << 2 | u64::from(self.has_head) << 1 | u64::from(self.fresh),
        );
        for entry in &self.packed {
            digest = mix_bits(digest.wrapping_add(packed(entry, cells)));
            cells = &cells[entry.cells as usize..];
        }
        mix_bits(digest.wrapping_add(head))
    }

    /// Writes the history: the number of packed entries (u16) and of applied ones (u16), flags (u8), then
    /// each entry with its length in cells (u32), the head packed like the others.
    pub fn save(&self, out: &mut ByteWriter<'_>) {
        out.u16(self.packed.len() as u16);
        out.u16(self.applied);
        out.u8(u8::from(self.has_head) | u8::from(self.fresh) << 1);
        let mut cells = self.cells.as_flattened().as_flattened().as_flattened();
        for entry in &self.packed {
            let (these, rest) = cells.split_at(entry.cells as usize);
            out.u32(entry.cells);
            out.bytes(these.as_flattened());
            cells = rest;
        }
        if self.has_head {
            out.u32(self.head.packed_cell_count() as u32);
            self.head.write_packed(|cells| out.bytes(cells.as_flattened()));
        }
    }

    /// Returns the offset of an entry from the start of the output of [`UndoHistory::save`].
    pub(crate) fn saved_offset_of(&self, entry: usize) -> usize {
        let before = self.packed.iter().take(entry).map(|packed| packed.cells as usize);
        before.fold(HEADER_BYTES, |offset, cells| {
            offset + size_of::<u32>() + cells * size_of::<EntryCell>()
        })
    }

    /// Reads the output of [`UndoHistory::save`]. Doesn't check what the entries do to the volume: see
    /// `UndoHistory::check_entries`.
    ///
    /// # Errors
    /// [`BadSave`] if the bytes end early or are invalid. Then the history is empty.
    pub fn load(&mut self, bytes: &mut ByteReader<'_>) -> Result<(), BadSave> {
        self.clear();
        self.load_entries(bytes).inspect_err(|_| self.clear())
    }

    fn load_entries(&mut self, bytes: &mut ByteReader<'_>) -> Result<(), BadSave> {
        let count = usize::from(bytes.u16()?);
        if count > UNDO_ENTRIES {
            return Err(bytes.error_here("fewer undo entries").into());
        }
        let applied = bytes.u16()?;
        let flags = bytes.u8()?;
        let has_head = flags & 1 != 0;
        if flags > 3
            || usize::from(applied) > count + usize::from(has_head)
            || (count > 0 && !has_head)
        {
            return Err(bytes.error_here("flags of an undo ring").into());
        }
        let mut used = 0;
        for _ in 0..count {
            let entry = read_entry::<N, K>(bytes)?;
            let room =
                self.cells.as_flattened_mut().as_flattened_mut().as_flattened_mut().get_mut(used..);
            let room = room.and_then(|room| room.get_mut(..entry.len()));
            room.ok_or(bytes.error_here("fewer undo columns"))?.copy_from_slice(entry);
            used += entry.len();
            let packed = PackedEntry { cells: entry.len() as u32, sum: digest_sum::<N, K>(entry) };
            self.packed.push(packed).map_err(|_| bytes.error_here("fewer undo entries"))?;
        }
        if has_head {
            self.head.set_from_packed(read_entry::<N, K>(bytes)?);
        }
        (self.applied, self.has_head, self.fresh) = (applied, has_head, flags & 2 != 0);
        Ok(())
    }
}

impl<const N: usize, const K: usize> UnpackedEntry<N, K>
where
    Grid<N>: Size,
{
    /// Sets the entry from a packed entry, which must be valid.
    fn set_from_packed(&mut self, entry: &[EntryCell]) {
        self.clear();
        self.sum = digest_sum::<N, K>(entry);
        let (columns, values) = EntryColumns::<N>::split_columns_and_values(entry);
        for ((axis, (line, place)), cells) in columns.zip(values.as_chunks().0) {
            self.insert_columns(axis, line, BitSet::span(place, place));
            self.others[axis as usize][line][place] = Column::from_checked_bytes(*cells);
        }
    }
}

/// Reads a packed entry and validates it.
fn read_entry<'a, const N: usize, const K: usize>(
    bytes: &mut ByteReader<'a>,
) -> Result<&'a [EntryCell], BadSave>
where
    Grid<N>: Size,
{
    let bad = bytes.error_here("an undo entry");
    let len = bytes.u32()? as usize;
    let cells = bytes.bytes(len.saturating_mul(2))?.as_chunks().0;
    if cells.len() < flag_cell_count::<N>()
        || cells.len() < EntryColumns::<N>::bitmap_cell_count(cells)
    {
        return Err(bad.into());
    }
    let (columns, values) = EntryColumns::<N>::split_columns_and_values(cells);
    let grid: u64 = Grid::<N>::FULL.word(0);
    let fits = columns.words.iter().map(word_from_cells).all(|word| word != 0 && word & !grid == 0);
    let count: u32 = columns.words.iter().map(|word| word_from_cells(word).count_ones()).sum();
    if !fits || count as usize * K != values.len() {
        return Err(bad.into());
    }
    let mut offset = bytes.offset() - size_of_val(values);
    for ((axis, address), cells) in columns.zip(values.as_chunks::<K>().0) {
        if Column::from_bytes(*cells, N).is_none() {
            let bad = BadBytes { offset, expected: INTERVALS_OF_A_COLUMN };
            return Err(BadSave::Column { bad, axis, address });
        }
        offset += size_of_val(cells);
    }
    Ok(cells)
}
