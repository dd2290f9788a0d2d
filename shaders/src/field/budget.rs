//! The budget of a frame: what an update may cost, and what each of its pieces is held to cost.

/// A frame's limits of work and upload.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Budget {
    /// CPU work, in units of about one instruction (x86-64 with SSE2, counted by Callgrind).
    pub work: usize,
    /// Bytes uploaded.
    pub bytes: usize,
}

/// What an update costs of a [`Budget`], in the same units.
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

    /// Ticks of one frame that have a budget, as many as the shells' clock runs in one.
    pub const MAX_TICKS: u32 = 4;

    /// The shells' budget for a volume of `grid_side` voxels a side: less than a million instructions
    /// and 256 KiB at 128, four times that at 256, where four times as much surface changes.
    /// Estimates of work may be a third too low, hence three quarters of a million.
    #[must_use]
    pub const fn per_frame(grid_side: usize) -> Self {
        let more = if grid_side > 128 { 4 } else { 1 };
        Budget { work: more * 750_000, bytes: more * 256 * 1024 }
    }

    /// The budget of a frame that shows so many ticks: each has as much, up to [`Budget::MAX_TICKS`]. Frames that are
    /// that late have the time, and what hands do would show ever later otherwise.
    #[must_use]
    pub const fn of_frame_after(grid_side: usize, ticks: u32) -> Self {
        let Budget { work, bytes } = Self::per_frame(grid_side);
        let ticks = if ticks > Self::MAX_TICKS { Self::MAX_TICKS } else { ticks };
        let times = if ticks == 0 { 1 } else { ticks as usize };
        Budget { work: times * work, bytes: times * bytes }
    }
}

/// Accounts for what of a budget is spent.
pub(super) struct BudgetMeter {
    budget: Budget,
    spent: Cost,
    /// Whether a unit of work was done: the first one may be more than the budget.
    has_progressed: bool,
}

impl BudgetMeter {
    /// Nothing spent yet.
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

    /// Whether a unit of work of this cost may be done: it is the first one, or so much remains.
    pub(super) fn allows_unit_of_work(&self, cost: Cost) -> bool {
        let left = self.remaining();
        !self.has_progressed || cost.work <= left.work && cost.bytes <= left.bytes
    }
}

/// Work on columns of so many intervals, by that on columns of one: half of it again for each more.
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
