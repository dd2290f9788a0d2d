//! The budget of a frame: what an update may cost, and what each of its pieces is held to cost.

/// A frame's limits of work and upload.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Budget {
    /// CPU work, in units of about one instruction (x86-64 with SSE2, counted by Callgrind).
    pub work: usize,
    /// Bytes uploaded.
    pub bytes: usize,
}

impl Budget {
    /// No limit.
    pub const UNLIMITED: Budget = Budget { work: usize::MAX, bytes: usize::MAX };

    /// The shells' budget for a volume of `side` voxels a side: less than a million instructions
    /// and 256 KiB at 128, four times that at 256, where four times as much surface changes.
    /// Estimates of work may be a third too low, hence three quarters of a million.
    #[must_use]
    pub const fn per_frame(side: usize) -> Self {
        let more = if side > 128 { 4 } else { 1 };
        Budget { work: more * 750_000, bytes: more * 256 * 1024 }
    }
}

/// Accounts for what of a budget is spent.
pub(super) struct BudgetMeter {
    pub(super) budget: Budget,
    pub(super) spent: Budget,
}

impl BudgetMeter {
    pub(super) const fn spend(&mut self, work: usize, bytes: usize) {
        self.spent.work += work;
        self.spent.bytes += bytes;
    }

    pub(super) fn remaining(&self) -> Budget {
        let less = |all: usize, spent| all.saturating_sub(spent);
        let work = less(self.budget.work, self.spent.work);
        Budget { work, bytes: less(self.budget.bytes, self.spent.bytes) }
    }

    /// Whether so much work and so many bytes remain.
    pub(super) fn can_afford(&self, work: usize, bytes: usize) -> bool {
        let left = self.remaining();
        work <= left.work && bytes <= left.bytes
    }
}

/// Work for each voxel that is loaded, for each voxel in a uniform neighbourhood that is blurred,
/// and for each group of sixteen texels in a mixed one.
pub(super) const VOXEL_WORK: usize = 6;
pub(super) const UNIFORM_WORK: usize = 3;
pub(super) const GROUP_WORK: usize = 220;
/// Work for each texel that is compared, for each that changed (all mip levels included), for each
/// in the box of those that crossed a half, and the sum of the three.
pub(super) const COMPARED_WORK: usize = 5;
pub(super) const CHANGED_WORK: usize = 6;
pub(super) const CROSSED_WORK: usize = 6;
pub(super) const TEXEL_WORK: usize = COMPARED_WORK + CHANGED_WORK + CROSSED_WORK;
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
