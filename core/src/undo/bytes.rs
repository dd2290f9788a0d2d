//! The undo ring as bytes, and its digest.

use super::packed::{Cell, Columns, column_of, flag_cells, sum_of, term, u64_of};
use super::{Head, Packed, Undo};
use crate::codec::{BadBytes, Reader, Writer};
use crate::limits::UNDO_ENTRIES;
use crate::maps::{Axis, Range};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::mix;

impl<const N: usize> Undo<N>
where
    Grid<N>: Size,
{
    /// Digest of all entries and of which stand. The columns' part is kept up with each change.
    #[must_use]
    pub fn digest(&self) -> u64 {
        self.digest_with(self.head.sum, |entry, _| entry.sum)
    }

    /// The same, with nothing taken from sums kept up.
    #[must_use]
    pub fn recompute_digest(&self) -> u64 {
        let mut sum = 0u64;
        for (axis, line) in Axis::ALL.into_iter().flat_map(|axis| (0..N).map(move |i| (axis, i))) {
            for place in self.head.changed[axis as usize][line].ones() {
                let other = self.head.others[axis as usize][line][place];
                sum = sum.wrapping_add(term(axis, (line, place), other));
            }
        }
        self.digest_with(sum, |_, cells| sum_of::<N>(cells))
    }

    fn digest_with(&self, head: u64, packed: impl Fn(&Packed, &[Cell]) -> u64) -> u64 {
        let mut cells = self.cells.as_flattened().as_flattened();
        let mut digest = mix(u64::from(self.applied) << 2
            | u64::from(self.has_head) << 1
            | u64::from(self.fresh));
        for entry in &self.packed {
            digest = mix(digest.wrapping_add(packed(entry, cells)));
            cells = &cells[entry.cells as usize..];
        }
        mix(digest.wrapping_add(head))
    }

    /// Writes the state: how many entries are packed (u16) and how many stand (u16), flags (u8),
    /// then each entry with its length in cells (u32), the head packed like the others.
    pub fn save(&self, out: &mut Writer<'_>) {
        out.u16(self.packed.len() as u16);
        out.u16(self.applied);
        out.u8(u8::from(self.has_head) | u8::from(self.fresh) << 1);
        let mut cells = self.cells.as_flattened().as_flattened();
        for entry in &self.packed {
            let (these, rest) = cells.split_at(entry.cells as usize);
            out.u32(entry.cells);
            out.bytes(these.as_flattened());
            cells = rest;
        }
        if self.has_head {
            out.u32(self.head.cells() as u32);
            self.head.pack(|cell| out.bytes(&cell));
        }
    }

    /// Reads what [`Undo::save`] wrote.
    ///
    /// # Errors
    /// [`BadBytes`] where the bytes end early or say what no undo ring holds; there are no entries
    /// then.
    pub fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), BadBytes> {
        self.clear();
        self.load_entries(bytes).inspect_err(|_| self.clear())
    }

    fn load_entries(&mut self, bytes: &mut Reader<'_>) -> Result<(), BadBytes> {
        let count = usize::from(bytes.u16()?);
        if count > UNDO_ENTRIES {
            return Err(bytes.bad("fewer undo entries"));
        }
        let applied = bytes.u16()?;
        let flags = bytes.u8()?;
        let has_head = flags & 1 != 0;
        if flags > 3
            || usize::from(applied) > count + usize::from(has_head)
            || (count > 0 && !has_head)
        {
            return Err(bytes.bad("flags of an undo ring"));
        }
        let mut used = 0;
        for _ in 0..count {
            let entry = read_entry::<N>(bytes)?;
            let room = self.cells.as_flattened_mut().as_flattened_mut().get_mut(used..);
            let room = room.and_then(|room| room.get_mut(..entry.len()));
            room.ok_or(bytes.bad("fewer undo columns"))?.copy_from_slice(entry);
            used += entry.len();
            let packed = Packed { cells: entry.len() as u32, sum: sum_of::<N>(entry) };
            self.packed.push(packed).map_err(|_| bytes.bad("fewer undo entries"))?;
        }
        if has_head {
            self.head.unpack(read_entry::<N>(bytes)?);
        }
        (self.applied, self.has_head, self.fresh) = (applied, has_head, flags & 2 != 0);
        Ok(())
    }
}

impl<const N: usize> Head<N>
where
    Grid<N>: Size,
{
    /// Becomes a packed entry.
    fn unpack(&mut self, entry: &[Cell]) {
        self.clear();
        self.sum = sum_of::<N>(entry);
        let (columns, values) = Columns::<N>::of(entry);
        for ((axis, (line, place)), cell) in columns.zip(values) {
            self.insert(axis, line, Bits::span(place, place));
            self.others[axis as usize][line][place] = column_of::<N>(*cell);
        }
    }
}

/// Reads an entry and checks that all of it can be.
fn read_entry<'a, const N: usize>(bytes: &mut Reader<'a>) -> Result<&'a [Cell], BadBytes>
where
    Grid<N>: Size,
{
    let bad = bytes.bad("an undo entry");
    let len = bytes.u32()? as usize;
    let cells = bytes.bytes(len.saturating_mul(2))?.as_chunks().0;
    if cells.len() < flag_cells::<N>() || cells.len() < Columns::<N>::bitmap_cells(cells) {
        return Err(bad);
    }
    let (columns, values) = Columns::<N>::of(cells);
    let grid: u64 = Grid::<N>::FULL.word(0);
    let fits = columns.words.iter().map(u64_of).all(|word| word != 0 && word & !grid == 0);
    let count: u32 = columns.words.iter().map(|word| u64_of(word).count_ones()).sum();
    let ranges = values.iter().all(|cell| Range::from_bytes(*cell, N).is_some());
    if fits && ranges && count as usize == values.len() { Ok(cells) } else { Err(bad) }
}
