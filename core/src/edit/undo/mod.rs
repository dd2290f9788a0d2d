//! Undo history: for each stroke, the columns that it changed and their other values. Undo swaps those
//! values with the volume's columns; redo is the same swap.
//!
//! The newest entry, the *head*, is stored unpacked: a bitmap of its columns and an array of values,
//! so that recording a column is a test and a store. Older entries are packed contiguously, oldest first;
//! the oldest is dropped when space runs out.
//!
//! A packed entry is a sequence of cells of two bytes: a bitmap of the columns as words of 64 (map
//! by map, line by line) without the zero words, behind one flag a word; then a range for each
//! column in that order.

mod bytes;
mod packed;

use heapless::Vec;

use crate::codec::digest::DIGEST_KEYS;
use crate::limits::{UNDO_ENTRIES, UNDO_PLANES};
use crate::volume::column_digest::line_key;
use crate::volume::dirty::DirtyRects;
use crate::volume::editable::Volume;
use crate::volume::range_maps::{Axis, Column};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use packed::{
    EntryCell, EntryColumns, cell_from_column, column_code, column_from_cell, digest_term,
    flag_cells,
};

/// The strokes that can be undone and redone in a volume of N^3 voxels.
#[derive(Debug)]
pub struct UndoHistory<const N: usize>
where
    Grid<N>: Size,
{
    head: UnpackedEntry<N>,
    /// The packed entries.
    cells: [[[EntryCell; N]; N]; UNDO_PLANES],
    packed: Vec<PackedEntry, UNDO_ENTRIES, u16>,
    /// Number of applied entries; those after them are undone.
    applied: u16,
    has_head: bool,
    /// Whether a stroke began and has recorded no change yet.
    fresh: bool,
}

/// The newest entry. Empty where `changed` is.
#[derive(Debug)]
struct UnpackedEntry<const N: usize>
where
    Grid<N>: Size,
{
    /// Bit `place` of `changed[axis][line]`: a column of the entry.
    changed: [[<Grid<N> as Size>::Row; N]; 3],
    /// Bit `line` of `lines[axis]`: a line that holds such a column.
    lines: [<Grid<N> as Size>::Row; 3],
    /// The other values of the entry's columns; meaningless elsewhere.
    others: [[[Column; N]; N]; 3],
    sum: u64,
}

/// One packed entry.
#[derive(Debug, Clone, Copy)]
struct PackedEntry {
    cells: u32,
    /// The sum of [`digest_term`] over its columns.
    sum: u64,
}

impl<const N: usize> UndoHistory<N>
where
    Grid<N>: Size,
{
    /// No entries. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the entries about by value
    pub const fn new() -> Self {
        UndoHistory {
            head: UnpackedEntry {
                changed: [[<Grid<N> as Size>::Row::EMPTY; N]; 3],
                lines: [<Grid<N> as Size>::Row::EMPTY; 3],
                others: [[[Column::EMPTY; N]; N]; 3],
                sum: 0,
            },
            cells: [[[[0; 2]; N]; N]; UNDO_PLANES],
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

    /// Records columns that a stroke is about to change: those at `places` of a line, whose present
    /// values are `old`.
    #[inline]
    pub fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        if self.fresh && !places.is_empty() {
            self.open_entry();
        }
        self.amend_newest(axis, line, places, old);
    }

    /// Records columns that an island removal is about to change. They join the newest entry, even when
    /// the next stroke has begun but changed nothing.
    pub fn amend_newest(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        if places.is_empty() {
            return;
        }
        self.ensure_head_is_newest();
        let new = places & !self.head.changed[axis as usize][line];
        self.head.insert_columns(axis, line, new);
        let others = &mut self.head.others[axis as usize][line];
        let mut sum = 0u64;
        for run in new.iter_runs() {
            let run = run.first()..=run.last();
            others[run.clone()].copy_from_slice(&old[run.clone()]);
            for (old, key) in old[run.clone()].iter().zip(&DIGEST_KEYS[run]) {
                sum = sum.wrapping_add(key.wrapping_mul(column_code(*old)));
            }
        }
        self.head.sum = self.head.sum.wrapping_add(sum.wrapping_mul(line_key(axis, line)));
    }

    /// The number of entries that can be undone, and redone.
    #[must_use]
    pub fn undo_redo_counts(&self) -> (usize, usize) {
        (self.applied.into(), self.len() - usize::from(self.applied))
    }

    /// Undoes the newest applied entry and marks its columns in `dirty` as one edit. Returns `false`
    /// when there is none.
    pub fn undo(&mut self, volume: &mut Volume<N>, dirty: &mut DirtyRects) -> bool {
        if self.applied == 0 {
            return false;
        }
        self.applied -= 1;
        self.swap_entry(self.applied.into(), volume, dirty);
        true
    }

    /// Redoes the oldest undone entry, likewise. Returns `false` when there is none.
    pub fn redo(&mut self, volume: &mut Volume<N>, dirty: &mut DirtyRects) -> bool {
        if usize::from(self.applied) == self.len() {
            return false;
        }
        self.swap_entry(self.applied.into(), volume, dirty);
        self.applied += 1;
        true
    }

    fn len(&self) -> usize {
        self.packed.len() + usize::from(self.has_head)
    }

    /// Makes the head the newest applied entry, by opening one if it isn't.
    fn ensure_head_is_newest(&mut self) {
        if usize::from(self.applied) != self.len() || !self.has_head {
            self.open_entry();
        }
    }

    /// Opens an entry as the head: drops the undone entries, or packs the head of before.
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
        let need = self.head.packed_len();
        self.make_room(need);
        let mut end = self.used_cells();
        let cells = self.cells.as_flattened_mut().as_flattened_mut();
        self.head.write_packed(|cell| {
            cells[end] = cell;
            end += 1;
        });
        let entry = PackedEntry { cells: need as u32, sum: self.head.sum };
        self.packed.push(entry).expect("room was made");
    }

    /// Drops the oldest entries until one of `need` cells fits after the rest.
    fn make_room(&mut self, need: usize) {
        let room = UNDO_PLANES * N * N;
        let (mut dropped, mut freed, used) = (0, 0, self.used_cells());
        while used - freed + need > room || self.packed.len() - dropped == UNDO_ENTRIES {
            freed += self.packed[dropped].cells as usize;
            dropped += 1;
        }
        if dropped > 0 {
            self.cells.as_flattened_mut().as_flattened_mut().copy_within(freed..used, 0);
            self.packed.rotate_left(dropped);
            self.packed.truncate(self.packed.len() - dropped);
        }
    }

    /// Cells that the packed entries take.
    fn used_cells(&self) -> usize {
        self.packed.iter().map(|entry| entry.cells as usize).sum()
    }

    /// Swaps the values of entry `index` with the volume's columns.
    fn swap_entry(&mut self, index: usize, volume: &mut Volume<N>, dirty: &mut DirtyRects) {
        let mut sum = 0u64;
        let mut exchange = |axis, at, theirs: Column| {
            let ours = volume.replace_column_leaving_rows(axis, at, theirs);
            if ours != theirs {
                dirty.mark_column(axis, at);
            }
            sum = sum.wrapping_add(digest_term(axis, at, ours));
            ours
        };
        if index < self.packed.len() {
            let start = self.packed[..index].iter().map(|entry| entry.cells as usize).sum();
            let cells = self.cells.as_flattened_mut().as_flattened_mut();
            let (columns, values) = EntryColumns::<N>::parse_mut(&mut cells[start..]);
            for ((axis, at), cell) in columns.zip(values) {
                *cell = cell_from_column(exchange(axis, at, column_from_cell::<N>(*cell)));
            }
            self.packed[index].sum = sum;
        } else {
            self.head.for_each_column(|axis, at, other| *other = exchange(axis, at, *other));
            self.head.sum = sum;
        }
        dirty.end_edit();
        volume.rebuild_rows();
        // Later changes don't belong to the entry that was undone or redone.
        self.fresh = true;
    }
}

impl<const N: usize> UnpackedEntry<N>
where
    Grid<N>: Size,
{
    fn clear(&mut self) {
        for (changed, lines) in self.changed.iter_mut().zip(&mut self.lines) {
            lines.iter_ones().for_each(|line| changed[line] = BitSet::EMPTY);
            *lines = BitSet::EMPTY;
        }
        self.sum = 0;
    }

    /// Adds columns of a line to the entry.
    #[inline]
    fn insert_columns(&mut self, axis: Axis, line: usize, places: <Grid<N> as Size>::Row) {
        self.changed[axis as usize][line] |= places;
        self.lines[axis as usize].insert(line);
    }

    fn for_each_column(&mut self, mut f: impl FnMut(Axis, (usize, usize), &mut Column)) {
        for axis in Axis::ALL {
            for line in self.lines[axis as usize].iter_ones() {
                for place in self.changed[axis as usize][line].iter_ones() {
                    f(axis, (line, place), &mut self.others[axis as usize][line][place]);
                }
            }
        }
    }

    /// Calls `f` for each line of the entry with its index in the three maps, the columns, and the other
    /// values.
    #[inline]
    fn for_each_line(&self, mut f: impl FnMut(usize, <Grid<N> as Size>::Row, &[Column; N])) {
        for axis in 0..3 {
            for line in self.lines[axis].iter_ones() {
                f(axis * N + line, self.changed[axis][line], &self.others[axis][line]);
            }
        }
    }

    /// Calls `f` with the index and the value of each non-zero word of the bitmap.
    #[inline]
    fn for_each_word(&self, mut f: impl FnMut(usize, u64)) {
        let words = <Grid<N> as Size>::Row::WORDS;
        self.for_each_line(|line, columns, _| {
            for i in 0..words {
                if columns.word(i) != 0 {
                    f(line * words + i, columns.word(i));
                }
            }
        });
    }

    /// Cells that [`UnpackedEntry::write_packed`] emits.
    fn packed_len(&self) -> usize {
        let mut cells = flag_cells::<N>();
        self.for_each_word(|_, word| cells += 4 + word.count_ones() as usize);
        cells
    }

    fn write_packed(&self, mut emit: impl FnMut(EntryCell)) {
        let (mut flags, mut cell) = (0u16, 0);
        self.for_each_word(|i, _| {
            while cell < i / 16 {
                emit(flags.to_le_bytes());
                (flags, cell) = (0, cell + 1);
            }
            flags |= 1 << (i % 16);
        });
        for _ in cell..flag_cells::<N>() {
            emit(flags.to_le_bytes());
            flags = 0;
        }
        self.for_each_word(|_, word| {
            word.to_le_bytes().as_chunks().0.iter().for_each(|cell| emit(*cell));
        });
        self.for_each_line(|_, columns, others| {
            columns.iter_ones().for_each(|place| emit(cell_from_column(others[place])));
        });
    }
}
