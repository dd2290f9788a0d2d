//! A visitor's "here is ahead": at the time that the runtime names, all poses jump.

/// A jump that is to come.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Recentre {
    at: Option<i64>,
}

impl Recentre {
    /// Poses from a time on, in nanoseconds, are in another frame than those before it.
    pub fn pending(&mut self, at: i64) {
        self.at = Some(self.at.map_or(at, |earlier| earlier.min(at)));
    }

    /// Whether the tick at a time is the first after the jump: its hands are not to be believed, so
    /// that no stroke sweeps from one frame to the other.
    #[must_use]
    pub fn breaks(&mut self, tick_at: i64) -> bool {
        let due = self.at.is_some_and(|at| at <= tick_at);
        if due {
            self.at = None;
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::Recentre;

    #[test]
    fn one_tick_is_broken_at_the_time_of_change() {
        let mut recentre = Recentre::default();
        assert!(!recentre.breaks(0));
        recentre.pending(100);
        recentre.pending(120);
        assert_eq!([99, 100, 101].map(|at| recentre.breaks(at)), [false, true, false]);
    }
}
