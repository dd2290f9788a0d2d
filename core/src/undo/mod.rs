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
    /// Bit `line` of `lines[axis]`: a line that holds such a column.
    lines: [<Grid<N> as Size>::Row; 3],
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

    /// Those `places` of a line of columns are about to be changed by a stroke; `old` is what the
    /// line holds.
    #[inline]
    pub fn record(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        if self.fresh && !places.is_empty() {
            self.open();
        }
        self.amend(axis, line, places, old);
    }

    /// The same by what earlier strokes led to (islands): that belongs to the newest entry, even
    /// when the next stroke has begun but changed nothing.
    pub fn amend(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        if places.is_empty() {
            return;
        }
        self.reach_head();
        let new = places & !self.head.changed[axis as usize][line];
        self.head.insert(axis, line, new);
        let others = &mut self.head.others[axis as usize][line];
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

    fn len(&self) -> usize {
        self.packed.len() + usize::from(self.has_head)
    }

    /// Makes the head the newest entry that stands.
    fn reach_head(&mut self) {
        if usize::from(self.applied) != self.len() || !self.has_head {
            self.open();
        }
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
        for (changed, lines) in self.changed.iter_mut().zip(&mut self.lines) {
            lines.ones().for_each(|line| changed[line] = Bits::EMPTY);
            *lines = Bits::EMPTY;
        }
        self.sum = 0;
    }

    /// The entry holds these columns too.
    #[inline]
    fn insert(&mut self, axis: Axis, line: usize, places: <Grid<N> as Size>::Row) {
        self.changed[axis as usize][line] |= places;
        self.lines[axis as usize].insert(line);
    }

    fn each(&mut self, mut f: impl FnMut(Axis, (usize, usize), &mut Column)) {
        for axis in Axis::ALL {
            for line in self.lines[axis as usize].ones() {
                for place in self.changed[axis as usize][line].ones() {
                    f(axis, (line, place), &mut self.others[axis as usize][line][place]);
                }
            }
        }
    }

    /// Its lines: their place in the three maps, their columns, and the others.
    #[inline]
    fn each_line(&self, mut f: impl FnMut(usize, <Grid<N> as Size>::Row, &[Column; N])) {
        for axis in 0..3 {
            for line in self.lines[axis].ones() {
                f(axis * N + line, self.changed[axis][line], &self.others[axis][line]);
            }
        }
    }

    /// The words of the bitmap that aren't 0, with their place in it.
    #[inline]
    fn each_word(&self, mut f: impl FnMut(usize, u64)) {
        let words = <Grid<N> as Size>::Row::WORDS;
        self.each_line(|line, columns, _| {
            for i in 0..words {
                if columns.word(i) != 0 {
                    f(line * words + i, columns.word(i));
                }
            }
        });
    }

    /// Cells that [`Head::pack`] emits.
    fn cells(&self) -> usize {
        let mut cells = flag_cells::<N>();
        self.each_word(|_, word| cells += 4 + word.count_ones() as usize);
        cells
    }

    fn pack(&self, mut emit: impl FnMut(Cell)) {
        let (mut flags, mut cell) = (0u16, 0);
        self.each_word(|i, _| {
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
        self.each_word(|_, word| {
            word.to_le_bytes().as_chunks().0.iter().for_each(|cell| emit(*cell));
        });
        self.each_line(|_, columns, others| {
            columns.ones().for_each(|place| emit(bytes_of(others[place])));
        });
    }
}
