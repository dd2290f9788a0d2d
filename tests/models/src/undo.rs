//! Model of the undo ring by the naive definition of undo and redo: a list of complete copies of the maps.

use paros_core::RangeMaps;

/// The maps before each stroke and after the newest, with the current position.
pub struct SnapshotHistory<const N: usize> {
    /// The states, oldest first.
    states: Vec<Box<RangeMaps<N>>>,
    at: usize,
}

/// The number of strokes that can be undone and redone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct StrokeCounts {
    /// Number of strokes that can be undone.
    pub undoable: usize,
    /// Number of strokes that can be redone.
    pub redoable: usize,
}

impl<const N: usize> SnapshotHistory<N> {
    /// Creates a history of one state, with nothing to undo.
    pub fn new(maps: &RangeMaps<N>) -> Self {
        SnapshotHistory { states: vec![Box::new(maps.clone())], at: 0 }
    }

    /// Appends the maps after a stroke and drops the redo history.
    pub fn push_state(&mut self, maps: &RangeMaps<N>) {
        self.states.truncate(self.at + 1);
        self.states.push(Box::new(maps.clone()));
        self.at += 1;
    }

    /// Replaces the current state, as when a later removal belongs to the newest stroke.
    pub fn replace_current(&mut self, maps: &RangeMaps<N>) {
        self.states[self.at].copy_from(maps);
    }

    /// Drops the oldest states, so that only `strokes` can be undone.
    pub fn drop_oldest_until_undoable(&mut self, strokes: usize) {
        self.states.drain(..self.at - strokes);
        self.at = strokes;
    }

    /// Undoes a stroke. Returns the maps before it, or `None` if there is nothing to undo.
    pub fn undo(&mut self) -> Option<&RangeMaps<N>> {
        self.at = self.at.checked_sub(1)?;
        Some(&self.states[self.at])
    }

    /// Redoes a stroke. Returns the maps after it, or `None` if there is nothing to redo.
    pub fn redo(&mut self) -> Option<&RangeMaps<N>> {
        let next = self.states.get(self.at + 1)?;
        self.at += 1;
        Some(next)
    }

    /// Returns the number of strokes that can be undone and redone.
    pub fn stroke_counts(&self) -> StrokeCounts {
        StrokeCounts { undoable: self.at, redoable: self.states.len() - 1 - self.at }
    }
}
