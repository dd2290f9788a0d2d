//! Recentring: the visitor redefines "ahead". From the time that the runtime names, all poses are in another
//! reference space.

/// A pending change of the reference space (`XrEventDataReferenceSpaceChangePending`).
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct PendingRecentering {
    change_time_ns: Option<i64>,
}

impl PendingRecentering {
    /// Schedules a change: poses from `change_time_ns` on are in another space. The earliest of several
    /// pending changes counts.
    pub fn schedule_change(&mut self, change_time_ns: i64) {
        self.change_time_ns =
            Some(self.change_time_ns.map_or(change_time_ns, |at| at.min(change_time_ns)));
    }

    /// Returns `true` if the tick at `tick_time_ns` is the first after the change. Its hand poses must be
    /// left out: a stroke would sweep from the old space to the new one.
    #[must_use]
    pub fn take_change_due_at(&mut self, tick_time_ns: i64) -> bool {
        let due = self.change_time_ns.is_some_and(|at| at <= tick_time_ns);
        if due {
            self.change_time_ns = None;
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::PendingRecentering;

    #[test]
    fn one_tick_is_broken_at_the_time_of_change() {
        let mut recentering = PendingRecentering::default();
        assert!(!recentering.take_change_due_at(0));
        recentering.schedule_change(100);
        recentering.schedule_change(120);
        assert_eq!(
            [99, 100, 101].map(|at| recentering.take_change_due_at(at)),
            [false, true, false]
        );
    }
}
