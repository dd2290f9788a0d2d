//! Sums over the edits of many ticks.

use std::fmt;

use paros_core::edit::EditReport;
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};

/// Sums of [`EditReport`]s, in voxels. A voxel that several edits changed counts several times. Percentages
/// refer to all voxels that edits removed or were refused; additions don't count in them.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct EditTotals {
    /// Edits that changed something or were refused something.
    pub edits: u64,
    /// Voxels occupied before an edit and empty after it.
    pub removed: u64,
    /// Voxels empty before an edit and occupied after it, added by the edit or by closure.
    pub added: u64,
    /// Voxels removed and restored by closure.
    pub refused_by_closure: u64,
    /// Voxels not removed because the mask protects them.
    pub refused_by_mask: u64,
    /// Voxels not removed because they lie deeper in the brush than an edit may reach in one tick.
    pub refused_by_depth: u64,
}

impl EditTotals {
    /// Adds the edits of a world's last tick.
    pub fn add_tick<const N: usize, const K: usize>(&mut self, world: &World<N, K>)
    where
        Grid<N>: Size,
    {
        for event in world.events() {
            if let WorldEvent::Edited { report, .. } = event {
                self.add_edit(report);
            }
        }
    }

    /// Adds an edit.
    pub fn add_edit(&mut self, report: &EditReport) {
        self.edits += 1;
        self.removed += u64::from(report.removed);
        self.added += u64::from(report.added) + u64::from(report.closed);
        self.refused_by_closure += u64::from(report.refused_by_closure);
        self.refused_by_mask += u64::from(report.refused_by_mask);
        self.refused_by_depth += u64::from(report.refused_by_depth);
    }

    /// Returns the sums of both.
    #[must_use]
    pub const fn sum_with(self, other: &Self) -> Self {
        EditTotals {
            edits: self.edits + other.edits,
            removed: self.removed + other.removed,
            added: self.added + other.added,
            refused_by_closure: self.refused_by_closure + other.refused_by_closure,
            refused_by_mask: self.refused_by_mask + other.refused_by_mask,
            refused_by_depth: self.refused_by_depth + other.refused_by_depth,
        }
    }

    /// Returns the number of voxels that were removed, including those that closure restored.
    #[must_use]
    pub const fn removed_or_closed(&self) -> u64 {
        self.removed + self.refused_by_closure
    }

    /// Returns the voxels that closure restored in percent of [`EditTotals::removed_or_closed`]: the share of
    /// unprotected cuts that the range maps couldn't express.
    #[must_use]
    pub fn closure_percent(&self) -> f64 {
        percent_of(self.refused_by_closure, self.removed_or_closed())
    }

    /// Returns voxels in percent of all that was removed or refused.
    #[must_use]
    pub fn percent_of_whole(&self, voxels: u64) -> f64 {
        let held = self.refused_by_mask + self.refused_by_depth;
        percent_of(voxels, self.removed_or_closed() + held)
    }
}

/// Writes a table: a line for each count other than `edits`, with percentages.
impl fmt::Display for EditTotals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines = [
            ("removed", self.removed),
            ("added", self.added),
            ("refused by closure", self.refused_by_closure),
            ("refused by mask", self.refused_by_mask),
            ("refused by depth", self.refused_by_depth),
        ];
        let width = lines.iter().map(|(_, voxels)| voxels.to_string().len()).max().unwrap_or(0);
        for (name, voxels) in lines {
            write!(f, "{name:<18}  {voxels:>width$}")?;
            match name {
                "added" => writeln!(f)?,
                _ => writeln!(f, "  {:>5.1} %", self.percent_of_whole(voxels))?,
            }
        }
        Ok(())
    }
}

fn percent_of(part: u64, whole: u64) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

#[cfg(test)]
mod tests {
    use paros_core::edit::EditReport;

    use super::EditTotals;

    #[test]
    fn the_table_is_of_all_that_was_removed_or_refused() {
        let mut totals = EditTotals::default();
        let report = EditReport {
            removed: 600,
            added: 40,
            closed: 2,
            refused_by_closure: 1,
            refused_by_mask: 99,
            refused_by_depth: 300,
            ..EditReport::default()
        };
        totals.add_edit(&report);
        totals.add_edit(&EditReport { removed: 400, refused_by_mask: 600, ..Default::default() });
        let table = "\
            removed             1000   50.0 %\n\
            added                 42\n\
            refused by closure     1    0.1 %\n\
            refused by mask      699   35.0 %\n\
            refused by depth     300   15.0 %\n";
        assert_eq!(totals.to_string(), table);
        assert_eq!((totals.edits, totals.removed_or_closed()), (2, 1001));
        assert!((totals.closure_percent() - 100.0 / 1001.0).abs() < 1e-12);
        let twice = totals.sum_with(&totals);
        assert_eq!(
            twice,
            EditTotals {
                edits: 4,
                removed: 2000,
                added: 84,
                refused_by_closure: 2,
                refused_by_mask: 1398,
                refused_by_depth: 600
            }
        );
    }

    #[test]
    fn nothing_is_no_part_of_nothing() {
        let nothing = EditTotals::default();
        assert_eq!((nothing.percent_of_whole(0), nothing.closure_percent()), (0.0, 0.0));
    }
}
