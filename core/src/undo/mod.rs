//! Undo and redo: for each stroke the columns it changed and what they held, swapped to and fro.
//!
//! The newest entry, the *head*, lies unpacked: a bitmap of its columns, and their other values at
//! their own places, so that recording a column is a test and a store. The entries before it lie
//! packed one after the other, oldest first and first to go. An undo swaps an entry's values with
//! the volume's columns; a redo is the same swap.
//!
//! A packed entry is a sequence of cells of two bytes: a bitmap of the columns as words of 64 (map
//! by map, line by line) without the zero words, behind one flag a word; then a range for each
//! column in that order.

mod bytes;
mod packed;

use heapless::Vec;

use crate::dirty::Dirty;
use crate::limits::{UNDO_ENTRIES, UNDO_PLANES};
use crate::maps::{Axis, Column};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::{KEYS, Volume, line_key};
use packed::{Cell, Columns, bytes_of, column_of, entry_number, flag_cells, term};

/// The strokes that can be undone and redone in a volume of N^3 voxels.
#[derive(Debug)]
pub struct Undo<const N: usize>
where
    Grid<N>: Size,
{
    head: Head<N>,
    /// The packed entries.
    cells: [[[Cell; N]; N]; UNDO_PLANES],
    packed: Vec<Packed, UNDO_ENTRIES, u16>,
    /// Entries that stand; those behind them are undone.
    applied: u16,
    has_head: bool,
    /// Whether a stroke began that hasn't changed anything yet.
    fresh: bool,
}

/// The newest entry. Empty where `changed` is.
#[derive(Debug)]
struct Head<const N: usize>
where
    Grid<N>: Size,
{
    /// Bit `place` of `changed[axis][line]`: a column of the entry.
    changed: [[<Grid<N> as Size>::Row; N]; 3],
    /// Its other value. Elsewhere these mean nothing.
    others: [[[Column; N]; N]; 3],
    sum: u64,
}

/// One packed entry.
#[derive(Debug, Clone, Copy)]
struct Packed {
    cells: u32,
    /// The sum of [`term`] over its columns.
    sum: u64,
}

impl<const N: usize> Undo<N>
where
    Grid<N>: Size,
{
    /// No entries. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the entries about by value
    pub const fn new() -> Self {
        Undo {
            head: Head {
                changed: [[<Grid<N> as Size>::Row::EMPTY; N]; 3],
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

    /// Forgets all entries.
    pub fn clear(&mut self) {
        self.packed.clear();
        self.head.clear();
        (self.applied, self.has_head, self.fresh) = (0, false, false);
    }

    /// A stroke begins: the next change recorded opens an entry, and drops those undone.
    pub fn begin_stroke(&mut self) {
        self.fresh = true;
    }

    /// A column is about to be changed by a stroke; `old` is what it holds.
    #[inline]
    pub fn record(&mut self, axis: Axis, at: (usize, usize), old: Column) {
        if self.fresh {
            self.open();
        }
        self.amend(axis, at, old);
    }

    /// A column is about to be changed by what earlier strokes led to (islands): that belongs to
    /// the newest entry, even when the next stroke has begun but changed nothing.
    #[inline]
    pub fn amend(&mut self, axis: Axis, at @ (line, place): (usize, usize), old: Column) {
        self.ready();
        let changed = &mut self.head.changed[axis as usize][line];
        if !changed.contains(place) {
            changed.insert(place);
            self.head.others[axis as usize][line][place] = old;
            self.head.sum = self.head.sum.wrapping_add(term(axis, at, old));
        }
    }

    /// The same for `columns` of a line, of which `old` is what all hold.
    #[inline]
    pub fn amend_line(
        &mut self,
        axis: Axis,
        line: usize,
        columns: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        if columns.is_empty() {
            return;
        }
        self.ready();
        let changed = &mut self.head.changed[axis as usize][line];
        let others = &mut self.head.others[axis as usize][line];
        let new = columns & !*changed;
        *changed |= new;
        let mut sum = 0u64;
        for run in new.runs() {
            let run = run.lo()..=run.hi();
            others[run.clone()].copy_from_slice(&old[run.clone()]);
            for (old, key) in old[run.clone()].iter().zip(&KEYS[run]) {
                sum = sum.wrapping_add(key.wrapping_mul(entry_number(*old)));
            }
        }
        self.head.sum = self.head.sum.wrapping_add(sum.wrapping_mul(line_key(axis, line)));
    }

    /// Entries that can be undone, and redone.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        (self.applied.into(), self.len() - usize::from(self.applied))
    }

    /// Takes back the newest entry that stands. Notes the columns as an edit of `dirty`, closed.
    /// False when there is none.
    pub fn undo(&mut self, volume: &mut Volume<N>, dirty: &mut Dirty) -> bool {
        if self.applied == 0 {
            return false;
        }
        self.applied -= 1;
        self.swap(self.applied.into(), volume, dirty);
        true
    }

    /// Does the oldest undone entry again. False when there is none.
    pub fn redo(&mut self, volume: &mut Volume<N>, dirty: &mut Dirty) -> bool {
        if usize::from(self.applied) == self.len() {
            return false;
        }
        self.swap(self.applied.into(), volume, dirty);
        self.applied += 1;
        true
    }

    /// The head is an entry that stands.
    #[inline]
    fn ready(&mut self) {
        if usize::from(self.applied) != self.len() || !self.has_head {
            self.open();
        }
    }

    fn len(&self) -> usize {
        self.packed.len() + usize::from(self.has_head)
    }

    /// Opens an entry: those undone go, the head is packed.
    fn open(&mut self) {
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
        let need = self.head.cells();
        self.make_room(need);
        let mut end = self.used();
        let cells = self.cells.as_flattened_mut().as_flattened_mut();
        self.head.pack(|cell| {
            cells[end] = cell;
            end += 1;
        });
        let entry = Packed { cells: need as u32, sum: self.head.sum };
        self.packed.push(entry).expect("room was made");
    }

    /// Drops the oldest entries until one of `need` cells has room behind the rest.
    fn make_room(&mut self, need: usize) {
        let room = UNDO_PLANES * N * N;
        let (mut dropped, mut freed, used) = (0, 0, self.used());
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
    fn used(&self) -> usize {
        self.packed.iter().map(|entry| entry.cells as usize).sum()
    }

    /// Swaps the values of entry `index` with the volume's columns.
    fn swap(&mut self, index: usize, volume: &mut Volume<N>, dirty: &mut Dirty) {
        let mut sum = 0u64;
        let mut exchange = |axis, at, theirs: Column| {
            let ours = volume.swap_column(axis, at, theirs);
            if ours != theirs {
                dirty.note(axis, at);
            }
            sum = sum.wrapping_add(term(axis, at, ours));
            ours
        };
        if index < self.packed.len() {
            let start = self.packed[..index].iter().map(|entry| entry.cells as usize).sum();
            let cells = self.cells.as_flattened_mut().as_flattened_mut();
            let (columns, values) = Columns::<N>::split(&mut cells[start..]);
            for ((axis, at), cell) in columns.zip(values) {
                *cell = bytes_of(exchange(axis, at, column_of::<N>(*cell)));
            }
            self.packed[index].sum = sum;
        } else {
            self.head.each(|axis, at, other| *other = exchange(axis, at, *other));
            self.head.sum = sum;
        }
        dirty.close();
        volume.restore_rows();
        // Whatever comes next is no part of the entry that was undone or redone.
        self.fresh = true;
    }
}

impl<const N: usize> Head<N>
where
    Grid<N>: Size,
{
    fn clear(&mut self) {
        self.changed.as_flattened_mut().fill(<Grid<N> as Size>::Row::EMPTY);
        self.sum = 0;
    }

    fn each(&mut self, mut f: impl FnMut(Axis, (usize, usize), &mut Column)) {
        for axis in Axis::ALL {
            for line in 0..N {
                for place in self.changed[axis as usize][line].ones() {
                    f(axis, (line, place), &mut self.others[axis as usize][line][place]);
                }
            }
        }
    }

    fn words(&self) -> impl Iterator<Item = u64> {
        let words = <Grid<N> as Size>::Row::WORDS;
        self.changed.as_flattened().iter().flat_map(move |row| (0..words).map(|i| row.word(i)))
    }

    /// Cells that [`Head::pack`] emits.
    fn cells(&self) -> usize {
        let cells = |word: u64| if word == 0 { 0 } else { 4 + word.count_ones() as usize };
        flag_cells::<N>() + self.words().map(cells).sum::<usize>()
    }

    fn pack(&self, mut emit: impl FnMut(Cell)) {
        let (mut flags, mut count) = (0u16, 0);
        for word in self.words() {
            flags |= u16::from(word != 0) << count;
            count += 1;
            if count == 16 {
                emit(flags.to_le_bytes());
                (flags, count) = (0, 0);
            }
        }
        for word in self.words().filter(|word| *word != 0) {
            word.to_le_bytes().as_chunks().0.iter().for_each(|cell| emit(*cell));
        }
        for (row, others) in self.changed.as_flattened().iter().zip(self.others.as_flattened()) {
            row.ones().for_each(|place| emit(bytes_of(others[place])));
        }
    }
}
