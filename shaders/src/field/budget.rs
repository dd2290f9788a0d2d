//! The budget of a frame: the limits of an update, and the estimated cost of each piece of work.

/// A frame's limits of work and upload.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Budget {
    /// CPU work, in units of about one instruction (x86-64 with SSE2, counted by Callgrind).
    pub work: usize,
    /// Bytes uploaded.
    pub bytes: usize,
}

/// The cost of an update, in the units of [`Budget`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Cost {
    /// CPU work.
    pub work: usize,
    /// Bytes uploaded.
    pub bytes: usize,
}

impl Cost {
    pub(super) const NONE: Cost = Cost { work: 0, bytes: 0 };

    /// Work alone, without an upload.
    pub(super) const fn of_work(work: usize) -> Self {
        Cost { work, bytes: 0 }
    }
}

impl Budget {
    /// No limit.
    pub const UNLIMITED: Budget = Budget { work: usize::MAX, bytes: usize::MAX };

    /// The most ticks of one frame that each add a budget: as many as the shells' clock runs in one frame.
    pub const MAX_TICKS: u32 = 4;

    /// Returns the shells' budget for a volume of `grid_side` voxels a side: less than a million
    /// instructions and 256 KiB at 128, four times that at 256, where four times as much surface changes.
    /// Estimates of work may be a third too low, hence three quarters of a million.
    #[must_use]
    pub const fn per_frame(grid_side: usize) -> Self {
        let more = if grid_side > 128 { 4 } else { 1 };
        Budget { work: more * 750_000, bytes: more * 256 * 1024 }
    }

    /// Returns the budget of a frame that shows `ticks` ticks: a full budget for each, up to
    /// [`Budget::MAX_TICKS`]. A frame that late has the time, and the textures would otherwise lag ever
    /// further behind the hands.
    #[must_use]
    pub const fn of_frame_after(grid_side: usize, ticks: u32) -> Self {
        let Budget { work, bytes } = Self::per_frame(grid_side);
        let ticks = if ticks > Self::MAX_TICKS { Self::MAX_TICKS } else { ticks };
        let times = if ticks == 0 { 1 } else { ticks as usize };
        Budget { work: times * work, bytes: times * bytes }
    }
}

/// Tracks how much of a budget is spent.
pub(super) struct BudgetMeter {
    budget: Budget,
    spent: Cost,
    /// `true` once a unit of work was done: the first unit may exceed the budget.
    has_progressed: bool,
}

impl BudgetMeter {
    /// Creates a meter with nothing spent.
    pub(super) const fn new(budget: Budget) -> Self {
        BudgetMeter { budget, spent: Cost::NONE, has_progressed: false }
    }

    pub(super) const fn spent(&self) -> Cost {
        self.spent
    }

    /// Counts a cost that is no unit of work by itself.
    pub(super) const fn spend(&mut self, cost: Cost) {
        self.spent.work += cost.work;
        self.spent.bytes += cost.bytes;
    }

    /// Counts the cost of a unit of work, or of its last part.
    pub(super) const fn finish_unit_of_work(&mut self, cost: Cost) {
        self.spend(cost);
        self.has_progressed = true;
    }

    pub(super) fn remaining(&self) -> Budget {
        let less = |all: usize, spent| all.saturating_sub(spent);
        let work = less(self.budget.work, self.spent.work);
        Budget { work, bytes: less(self.budget.bytes, self.spent.bytes) }
    }

    /// Returns `true` if a unit of work of this cost may be done: it is the first unit, or the remaining
    /// budget covers it.
    pub(super) fn allows_unit_of_work(&self, cost: Cost) -> bool {
        let left = self.remaining();
        !self.has_progressed || cost.work <= left.work && cost.bytes <= left.bytes
    }
}

/// Returns the work on columns of `intervals` intervals, from that on columns of one: half of it more for
/// each further interval.
pub(super) const fn work_on_intervals(work_on_one: usize, intervals: usize) -> usize {
    work_on_one * (intervals + 1) / 2
}

/// Work for each voxel that is loaded (two more for each interval beyond the first), for each voxel in a
/// uniform neighbourhood that is blurred, and for each group of sixteen texels in a mixed one.
pub(super) const VOXEL_WORK: usize = 6;
pub(super) const UNIFORM_WORK: usize = 3;
pub(super) const GROUP_WORK: usize = 220;
/// Work for each texel that is compared, for each that changed (all mip levels included), for each
/// in the box of those that crossed a half, and the sum of the three.
pub(super) const COMPARED_WORK: usize = 5;
pub(super) const CHANGED_WORK: usize = 6;
pub(super) const CROSSED_WORK: usize = 6;
pub(super) const TEXEL_WORK: usize = COMPARED_WORK + CHANGED_WORK + CROSSED_WORK;
/// Work for each row of a box of gradients and of its window, for each group of eight texels in the window, and
/// for each in the box itself.
pub(super) const GRADIENT_ROW_WORK: usize = 260;
pub(super) const GRADIENT_WINDOW_WORK: usize = 210;
pub(super) const GRADIENT_GROUP_WORK: usize = 520;
/// Work for each row of cells, all distances included.
pub(super) const CELL_ROW_WORK: usize = 660;
/// Work for each line that is noted; for each line of a map in a search for stale ones; for each
/// tile that is compared, each of its columns, each column that changed, and each column of a line
/// after the change of a whole map; and for marking a tile's box of texels stale.
pub(super) const LINE_WORK: usize = 100;
pub(super) const SCAN_WORK: usize = 18;
pub(super) const TILE_WORK: usize = 200;
pub(super) const COLUMN_WORK: usize = 14;
pub(super) const CHANGED_COLUMN_WORK: usize = 100;
pub(super) const WHOLE_MAP_COLUMN_WORK: usize = 60;
pub(super) const STALE_BOX_WORK: usize = 800;

#[cfg(test)]
mod tests {
    use super::Budget;

    #[test]
    fn a_late_frame_has_the_budget_of_each_tick_that_it_shows_up_to_four() {
        for side in [128, 256] {
            let Budget { work, bytes } = Budget::per_frame(side);
            for (ticks, times) in [(0, 1), (1, 1), (3, 3), (4, 4), (u32::MAX, 4)] {
                let wanted = Budget { work: times * work, bytes: times * bytes };
                assert_eq!(Budget::of_frame_after(side, ticks), wanted, "{ticks} ticks at {side}");
            }
        }
    }
}
