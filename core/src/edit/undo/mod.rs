//! Undo history: each entry holds the columns that a stroke changed, with their other values. Undo swaps
//! those values with the volume's columns; redo is the same swap.
//!
//! The newest entry, the *head*, is stored unpacked: a bitmap of its columns and an array of values,
//! so that recording a column is a test and a store. Older entries are packed contiguously, oldest first;
//! the oldest is dropped when space runs out.
//!
//! A packed entry is a sequence of cells of two bytes: first a flag for each word of the bitmap of columns,
//! then the bitmap as words of 64 columns (map by map, line by line) without the zero words, then the K
//! ranges of each column in that order.

mod bytes;
mod check;
mod packed;
mod unpacked;

pub(crate) use check::UnsoundEntry;

use heapless::Vec;

use crate::codec::digest::DIGEST_KEYS;
use crate::limits::{UNDO_ENTRIES, UNDO_PLANES};
use crate::volume::column_digest::line_key;
use crate::volume::editable::Volume;
use crate::volume::journal::SwapJournal;
use crate::volume::range_maps::{Axis, Column, ColumnAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use crate::volume::voxel_box::VoxelBox;
use check::box_of_changes;
use packed::{EntryCell, EntryColumns, EntryRun, digest_of_run, nonzero_column_number};
use unpacked::UnpackedEntry;

/// The strokes that can be undone and redone in a volume of N^3 voxels.
#[derive(Debug)]
pub struct UndoHistory<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    head: UnpackedEntry<N, K>,
    /// The packed entries.
    cells: [[[[EntryCell; K]; N]; N]; UNDO_PLANES],
    packed: Vec<PackedEntry, UNDO_ENTRIES, u16>,
    /// Number of applied entries; later entries are undone.
    applied: u16,
    has_head: bool,
    /// `true` if a stroke began and has recorded no change yet.
    fresh: bool,
}

/// The numbers of strokes that can be undone and redone.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct UndoCounts {
    /// Strokes that are applied.
    pub undoable: usize,
    /// Strokes that were undone.
    pub redoable: usize,
}

/// One packed entry.
#[derive(Debug, Clone, Copy)]
struct PackedEntry {
    cells: u32,
    /// The sum of [`digest_term`] over its columns.
    sum: u64,
}

impl<const N: usize, const K: usize> UndoHistory<N, K>
where
    Grid<N>: Size,
{
    /// Creates an empty history. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the entries about by value
    pub const fn new() -> Self {
        UndoHistory {
            head: UnpackedEntry::new(),
            cells: [[[[[0; 2]; K]; N]; N]; UNDO_PLANES],
            packed: Vec::new(),
            applied: 0,
            has_head: false,
            fresh: false,
        }
    }

    /// Drops all entries.
    pub fn clear(&mut self) {
        self.packed.clear();
        self.head.clear();
        (self.applied, self.has_head, self.fresh) = (0, false, false);
    }

    /// Begins a stroke: the next recorded change opens an entry and drops the undone ones.
    pub fn begin_stroke(&mut self) {
        self.fresh = true;
    }

    /// Records columns that a stroke is about to change: the columns at `places` of a line, whose present
    /// values are in `old_columns`.
    #[inline]
    pub fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old_columns: &[Column<K>; N],
    ) {
        if self.fresh && !places.is_empty() {
            self.open_entry();
        }
        self.record_into_newest_entry(axis, line, places, old_columns);
    }

    /// Records columns that an island removal is about to change. They join the newest entry, even if the
    /// next stroke has begun but changed nothing.
    pub fn record_into_newest_entry(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old_columns: &[Column<K>; N],
    ) {
        if places.is_empty() {
            return;
        }
        self.open_entry_unless_head_is_newest();
        let new = places & !self.head.changed[axis as usize][line];
        self.head.insert_columns(axis, line, new);
        let others = &mut self.head.others[axis as usize][line];
        let mut sum = 0u64;
        for run in new.iter_runs_within_words() {
            let run = run.first()..=run.last();
            let (others, old_columns) = (&mut others[run.clone()], &old_columns[run.clone()]);
            for ((other, old), key) in others.iter_mut().zip(old_columns).zip(&DIGEST_KEYS[run]) {
                *other = *old;
                sum = sum.wrapping_add(key.wrapping_mul(nonzero_column_number(*old)));
            }
        }
        self.head.sum = self.head.sum.wrapping_add(sum.wrapping_mul(line_key(axis, line)));
    }

    /// Returns the numbers of entries that can be undone and redone.
    #[must_use]
    pub fn undo_counts(&self) -> UndoCounts {
        let undoable = usize::from(self.applied);
        UndoCounts { undoable, redoable: self.len() - undoable }
    }

    /// Undoes the newest applied entry and reports its columns to `journal`. Returns `false` if there is
    /// none.
    pub fn try_undo(
        &mut self,
        volume: &mut Volume<N, K>,
        journal: &mut impl SwapJournal<K>,
    ) -> bool {
        if self.applied == 0 {
            return false;
        }
        self.applied -= 1;
        self.swap_entry(self.applied.into(), volume, journal);
        true
    }

    /// Redoes the oldest undone entry and reports its columns to `journal`. Returns `false` if there is none.
    pub fn try_redo(
        &mut self,
        volume: &mut Volume<N, K>,
        journal: &mut impl SwapJournal<K>,
    ) -> bool {
        if usize::from(self.applied) == self.len() {
            return false;
        }
        self.swap_entry(self.applied.into(), volume, journal);
        self.applied += 1;
        true
    }

    /// Returns the number of columns of an entry, counted from the oldest.
    pub(crate) fn count_columns_of(&self, index: usize) -> u32 {
        let Some(entry) = self.packed.get(index) else { return self.head.count_columns() };
        let start: usize = self.packed[..index].iter().map(|entry| entry.cells as usize).sum();
        let cells = &self.cells.as_flattened().as_flattened().as_flattened()[start..];
        let values = entry.cells as usize - EntryColumns::<N>::bitmap_cell_count(cells);
        (values / K) as u32
    }

    fn len(&self) -> usize {
        self.packed.len() + usize::from(self.has_head)
    }

    /// Makes the head the newest applied entry. Opens a new one if it isn't.
    fn open_entry_unless_head_is_newest(&mut self) {
        if usize::from(self.applied) != self.len() || !self.has_head {
            self.open_entry();
        }
    }

    /// Opens an entry as the head: drops the undone entries, or packs the previous head.
    fn open_entry(&mut self) {
        let applied = usize::from(self.applied);
        if applied < self.len() {
            self.packed.truncate(applied);
        } else if self.has_head {
            self.pack_head();
        }
        self.head.clear();
        (self.has_head, self.fresh) = (true, false);
        self.applied = self.packed.len() as u16 + 1;
    }

    fn pack_head(&mut self) {
        let need = self.head.packed_cell_count();
        self.make_room_for_cells(need);
        let mut end = self.count_packed_cells();
        let cells = self.cells.as_flattened_mut().as_flattened_mut().as_flattened_mut();
        self.head.write_packed(|some| {
            cells[end..end + some.len()].copy_from_slice(some);
            end += some.len();
        });
        let entry = PackedEntry { cells: need as u32, sum: self.head.sum };
        self.packed.push(entry).expect("room was made");
    }

    /// Drops the oldest entries until an entry of `needed` cells fits after the rest.
    fn make_room_for_cells(&mut self, needed: usize) {
        let room = UNDO_PLANES * N * N * K;
        let (mut dropped, mut freed, used) = (0, 0, self.count_packed_cells());
        while used - freed + needed > room || self.packed.len() - dropped == UNDO_ENTRIES {
            freed += self.packed[dropped].cells as usize;
            dropped += 1;
        }
        if dropped > 0 {
            self.cells
                .as_flattened_mut()
                .as_flattened_mut()
                .as_flattened_mut()
                .copy_within(freed..used, 0);
            self.packed.rotate_left(dropped);
            self.packed.truncate(self.packed.len() - dropped);
        }
    }

    /// Returns the number of cells that the packed entries take.
    fn count_packed_cells(&self) -> usize {
        self.packed.iter().map(|entry| entry.cells as usize).sum()
    }

    /// Swaps the values of entry `index` with the volume's columns.
    fn swap_entry(
        &mut self,
        index: usize,
        volume: &mut Volume<N, K>,
        journal: &mut impl SwapJournal<K>,
    ) {
        // Inspecting many columns takes longer than rebuilding all rows.
        let are_few = self.count_columns_of(index) as usize <= N * N / 8;
        let mut changed = are_few.then_some(VoxelBox::EMPTY);
        self.swap_columns(index, volume, |axis, first, ours, theirs| {
            journal.record_swap(axis, first, ours, theirs);
            if let Some(changed) = &mut changed {
                *changed = changed.hull_with(box_of_changes::<N, K>(axis, first, ours, theirs));
            }
        });
        journal.end_swaps();
        match changed {
            Some(changed) => volume.rebuild_rows_in(changed),
            None => volume.rebuild_rows(),
        }
        // Later changes don't belong to the entry that was undone or redone.
        self.fresh = true;
    }

    /// Swaps the values of entry `index` with the volume's columns, which makes the volume's bit rows stale.
    /// Before each swap, calls `visit` for each run of columns with the first column's address, the volume's
    /// values and the entry's values.
    #[inline]
    fn swap_columns(
        &mut self,
        index: usize,
        volume: &mut Volume<N, K>,
        mut visit: impl FnMut(Axis, ColumnAddress, &[Column<K>], &[Column<K>]),
    ) {
        let (maps, digest) = volume.maps_and_digest_leaving_bit_rows();
        let mut sum = 0u64;
        let mut swap = |axis, at @ (line, first), others: &mut [Column<K>]| {
            let ours = &mut maps.line_mut(axis, line)[first..first + others.len()];
            visit(axis, at, ours, others);
            ours.swap_with_slice(others);
            sum = sum.wrapping_add(digest_of_run(axis, at, others));
        };
        if index < self.packed.len() {
            let start = self.packed[..index].iter().map(|entry| entry.cells as usize).sum();
            let cells = self.cells.as_flattened_mut().as_flattened_mut().as_flattened_mut();
            let (mut columns, values) =
                EntryColumns::<N>::split_columns_and_values_mut(&mut cells[start..]);
            let (mut values, mut buffer) = (values.as_chunks_mut::<K>().0, [Column::EMPTY; 64]);
            while let Some(EntryRun { axis, first, columns }) = columns.next_run() {
                let (cells, rest) = values.split_at_mut(columns);
                values = rest;
                let others = &mut buffer[..columns];
                others
                    .iter_mut()
                    .zip(&*cells)
                    .for_each(|(to, from)| *to = Column::from_checked_bytes(*from));
                swap(axis, first, others);
                cells.iter_mut().zip(others).for_each(|(to, from)| *to = from.to_bytes());
            }
        } else {
            self.head.visit_runs(swap);
        }
        let held = match self.packed.get_mut(index) {
            Some(packed) => &mut packed.sum,
            None => &mut self.head.sum,
        };
        // A term is the product of the key of a column's address and its number plus a constant: the volume
        // gains what the entry loses.
        *digest = digest.wrapping_add(held.wrapping_sub(sum));
        *held = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::UndoHistory;
    use crate::volume::range_maps::{Axis, Column};
    use crate::volume::row::BitSet;

    #[test]
    fn the_columns_of_each_entry_are_counted() {
        let mut undo = UndoHistory::<16, 2>::new();
        let columns = [Column::EMPTY; 16];
        for (lines, places) in [(1, 7), (16, 15), (3, 2)] {
            undo.begin_stroke();
            for (axis, line) in
                Axis::ALL.into_iter().flat_map(|axis| (0..lines).map(move |i| (axis, i)))
            {
                undo.record_columns(axis, line, BitSet::span(16 - places, 15), &columns);
            }
        }
        let counts = [0, 1, 2].map(|entry| undo.count_columns_of(entry));
        assert_eq!(counts, [3 * 7, 3 * 16 * 15, 3 * 3 * 2]);
    }
}
