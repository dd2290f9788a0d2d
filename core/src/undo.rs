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

use heapless::Vec;

use crate::codec::{BadBytes, Reader, Writer};
use crate::dirty::Dirty;
use crate::limits::{UNDO_ENTRIES, UNDO_PLANES};
use crate::maps::{Axis, Column, Range};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::{Volume, mix};

type Cell = [u8; 2];

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
        if usize::from(self.applied) != self.len() || !self.has_head {
            self.open();
        }
        let changed = &mut self.head.changed[axis as usize][line];
        if !changed.contains(place) {
            changed.insert(place);
            self.head.others[axis as usize][line][place] = old;
            self.head.sum = self.head.sum.wrapping_add(term(axis, at, old));
        }
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

/// State as bytes, and its digest.
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
            self.changed[axis as usize][line].insert(place);
            self.others[axis as usize][line][place] = column_of::<N>(*cell);
        }
    }
}

/// The columns of a packed entry, in the order of its values.
struct Columns<'a, const N: usize> {
    flags: &'a [Cell],
    words: &'a [[Cell; 4]],
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
    fn of(cells: &'a [Cell]) -> (Self, &'a [Cell]) {
        let (bitmap, values) = cells.split_at(Self::bitmap_cells(cells));
        (Self::new(bitmap), values)
    }

    /// The same, the values to be changed.
    fn split(cells: &'a mut [Cell]) -> (Self, &'a mut [Cell]) {
        let (bitmap, values) = cells.split_at_mut(Self::bitmap_cells(cells));
        (Self::new(bitmap), values)
    }

    fn bitmap_cells(cells: &[Cell]) -> usize {
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
const fn flag_cells<const N: usize>() -> usize
where
    Grid<N>: Size,
{
    3 * N * <Grid<N> as Size>::Row::WORDS / 16
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

/// The sum of [`term`] over the columns of the entry that `cells` begin with.
fn sum_of<const N: usize>(cells: &[Cell]) -> u64
where
    Grid<N>: Size,
{
    let (columns, values) = Columns::<N>::of(cells);
    let terms = columns.zip(values).map(|((axis, at), cell)| {
        term(axis, at, column_of::<N>(*cell))
    });
    terms.fold(0, u64::wrapping_add)
}

/// What a column adds to the digest of an entry: unlike [`crate::volume::column_digest`] not
/// nothing when it is empty, as it counts that the entry holds it.
#[inline]
fn term(axis: Axis, (line, place): (usize, usize), column: Column) -> u64 {
    let [a, b] = bytes_of(column);
    mix(u64::from_le_bytes([a, b, place as u8, line as u8, axis as u8, 1, 0, 0]))
}

#[inline]
fn bytes_of(column: Column) -> Cell {
    column.0[0].to_bytes()
}

/// The inverse of [`bytes_of`], for bytes it made or that were checked.
#[inline]
fn column_of<const N: usize>(cell: Cell) -> Column {
    Column([Range::from_bytes(cell, N).unwrap_or(Range::EMPTY)])
}

#[inline]
fn u64_of(word: &[Cell; 4]) -> u64 {
    let mut bytes = [0; 8];
    bytes.copy_from_slice(word.as_flattened());
    u64::from_le_bytes(bytes)
}
