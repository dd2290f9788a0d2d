//! Undo as a stack of whole copies of the maps.

use paros_core::maps::Maps;

/// The maps before each stroke, and after the newest.
pub struct History<const N: usize> {
    /// Oldest first.
    states: Vec<Box<Maps<N>>>,
    at: usize,
}

impl<const N: usize> History<N> {
    /// Begins with one state.
    pub fn new(maps: &Maps<N>) -> Self {
        History { states: vec![Box::new(maps.clone())], at: 0 }
    }

    /// A stroke led to these maps.
    pub fn push(&mut self, maps: &Maps<N>) {
        self.states.truncate(self.at + 1);
        self.states.push(Box::new(maps.clone()));
        self.at += 1;
    }

    /// The newest stroke turns out to have led to these maps.
    pub fn amend(&mut self, maps: &Maps<N>) {
        self.states[self.at].copy_from(maps);
    }

    /// Forgets all but the newest `strokes` that can be undone.
    pub fn forget(&mut self, strokes: usize) {
        self.states.drain(..self.at - strokes);
        self.at = strokes;
    }

    /// Steps back.
    pub fn undo(&mut self) -> Option<&Maps<N>> {
        self.at = self.at.checked_sub(1)?;
        Some(&self.states[self.at])
    }

    /// Steps forward.
    pub fn redo(&mut self) -> Option<&Maps<N>> {
        let next = self.states.get(self.at + 1)?;
        self.at += 1;
        Some(next)
    }

    /// Strokes that can be undone, and redone.
    pub fn counts(&self) -> (usize, usize) {
        (self.at, self.states.len() - 1 - self.at)
    }
}
