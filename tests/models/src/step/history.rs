//! Model of the undo history. Each stroke has a full copy of the volume's columns on the other side of the
//! stroke, and the set of columns that it touched, which determines its size.

use std::collections::BTreeSet;

use paros_core::edit::UndoCounts;
use paros_core::limits::{UNDO_ENTRIES, UNDO_PLANES};

use crate::step::volume::{ChangedColumn, ColumnName, Columns, StepVolume};

/// One stroke.
#[derive(Clone, PartialEq, Debug)]
struct Entry<const K: usize> {
    /// All columns after an undo or redo of this entry.
    other: Columns<K>,
    /// The columns changed at any time during the stroke.
    touched: BTreeSet<ColumnName>,
}

/// The strokes that can be undone and redone.
#[derive(Clone, PartialEq, Debug)]
pub struct HistoryModel<const K: usize> {
    side: usize,
    /// The entries, oldest first.
    entries: Vec<Entry<K>>,
    /// The number of applied entries; the others were undone.
    applied: usize,
    /// `true` if the next change opens an entry.
    opens_entry: bool,
}

impl<const K: usize> HistoryModel<K> {
    /// Creates an empty history.
    pub fn new(side: usize) -> Self {
        HistoryModel { side, entries: Vec::new(), applied: 0, opens_entry: false }
    }

    /// Begins a new entry at the next change.
    pub fn begin_stroke(&mut self) {
        self.opens_entry = true;
    }

    /// Returns the number of strokes that can be undone and redone.
    pub fn counts(&self) -> UndoCounts {
        UndoCounts { undoable: self.applied, redoable: self.entries.len() - self.applied }
    }

    /// Records an edit's changes; `before` are the volume's columns before it.
    pub fn note_edit(&mut self, before: &Columns<K>, changes: &[ChangedColumn<K>]) {
        if self.opens_entry && !changes.is_empty() {
            self.open_entry(before);
        }
        self.note_removal(before, changes);
    }

    /// Records the changes of an island removal, which belong to the newest stroke even if the next stroke
    /// has begun.
    pub fn note_removal(&mut self, before: &Columns<K>, changes: &[ChangedColumn<K>]) {
        if changes.is_empty() {
            return;
        }
        if self.entries.is_empty() || self.applied < self.entries.len() {
            self.open_entry(before);
        }
        let newest = self.entries.last_mut().expect("one was opened");
        newest.touched.extend(changes.iter().map(|change| change.name));
    }

    /// Undoes the newest applied stroke. Returns `false` if there is none.
    pub fn undo(&mut self, volume: &mut StepVolume<K>) -> bool {
        let Some(newest) = self.applied.checked_sub(1) else { return false };
        self.applied = newest;
        self.exchange(newest, volume);
        true
    }

    /// Redoes the oldest undone stroke. Returns `false` if there is none.
    pub fn redo(&mut self, volume: &mut StepVolume<K>) -> bool {
        if self.applied == self.entries.len() {
            return false;
        }
        self.exchange(self.applied, volume);
        self.applied += 1;
        true
    }

    /// Writes the history in a save's format.
    pub fn write(&self, to: &mut Vec<u8>) {
        let packed = self.entries.len().saturating_sub(1);
        to.extend(u16::to_le_bytes(packed as u16));
        to.extend(u16::to_le_bytes(self.applied as u16));
        to.push(u8::from(!self.entries.is_empty()) | u8::from(self.opens_entry) << 1);
        for entry in &self.entries {
            let bytes = entry.packed(self.side);
            to.extend(u32::to_le_bytes(bytes.len() as u32 / 2));
            to.extend(bytes);
        }
    }

    fn exchange(&mut self, index: usize, volume: &mut StepVolume<K>) {
        let ours = volume.columns().clone();
        let theirs = std::mem::replace(&mut self.entries[index].other, ours);
        volume.replace_columns(&theirs);
        // Later changes belong to a new entry.
        self.opens_entry = true;
    }

    /// Drops the redo history, or else the oldest strokes that no longer fit beside the newest; then opens an
    /// entry.
    fn open_entry(&mut self, before: &Columns<K>) {
        if self.applied < self.entries.len() {
            self.entries.truncate(self.applied);
        } else {
            let room = 2 * UNDO_PLANES * self.side * self.side * K;
            let takes = |entry: &Entry<K>| entry.packed(self.side).len();
            while self.entries.len() > UNDO_ENTRIES
                || self.entries.iter().map(takes).sum::<usize>() > room
            {
                self.entries.remove(0);
            }
        }
        self.entries.push(Entry { other: before.clone(), touched: BTreeSet::new() });
        (self.applied, self.opens_entry) = (self.entries.len(), false);
    }
}

impl<const K: usize> Entry<K> {
    /// Returns the entry's bytes: flags of the non-zero words of its bitmap, those words, and the columns.
    fn packed(&self, side: usize) -> Vec<u8> {
        let words_of_line = side.div_ceil(64);
        let mut bitmap = vec![0u64; 3 * side * words_of_line];
        let mut columns = Vec::<u8>::new();
        for &(axis, (line, place)) in &self.touched {
            bitmap[(axis * side + line) * words_of_line + place / 64] |= 1 << (place % 64);
            let column = self.other[axis][line * side + place];
            columns.extend(column.to_bytes().as_flattened());
        }
        let mut bytes = vec![0u8; bitmap.len() / 8];
        for (i, _) in bitmap.iter().enumerate().filter(|(_, word)| **word != 0) {
            bytes[i / 8] |= 1 << (i % 8);
        }
        bytes.extend(bitmap.iter().filter(|word| **word != 0).flat_map(|word| word.to_le_bytes()));
        bytes.extend(columns);
        bytes
    }
}
