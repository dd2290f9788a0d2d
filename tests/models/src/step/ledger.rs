//! Model of the ledger of a tick's work: how much undo and redo, hands and islands may spend together, in row
//! visits of the island search.

use paros_core::edit::{Contact, Pose};
use paros_core::internals::{GridBit, GridShape, WayBudget};
use paros_core::limits::{
    ball_sweep_work_per_quarter_voxel, bared_count_work, bit_side_voxels, bit_step_work, bite_work,
    box_sweep_work_per_quarter_voxel, buried_contact_work, contact_work, disc_bite_work,
    disc_contact_work, disc_step_work, disc_sweep_work_per_step, island_removal_row_visits,
    island_reserve, max_bit_steps_per_tick, rewind_work, smoothing_sweep_work_per_quarter_voxel,
    smoothing_work, spall_work, tick_work,
};

use crate::path::path_poses;
use crate::step::StepModel;

/// The rest of a tick's work for the hands.
#[derive(Clone, Copy, Debug)]
pub struct Ledger {
    side: usize,
    is_mirrored: bool,
    /// Work left beyond the islands' reserve.
    left: u32,
    /// Number of hands with a tool that still have to work.
    hands_left: u32,
}

/// The share of a hand in a tick.
#[derive(Clone, Copy, Debug)]
pub struct HandShare {
    /// The budget of its bit's path.
    pub way: WayBudget,
    /// `true` if it may edit.
    pub may_edit: bool,
}

/// The work of a hand in a tick, from which each part is subtracted.
#[derive(Clone, Copy, Debug)]
pub struct HandWork {
    work: BitWork,
    most_steps: u32,
    left: u32,
}

impl Ledger {
    /// Creates the ledger of a tick, from whether undo or redo changed the volume, whether an axis of the
    /// figure was counted, and how many hands have a tool.
    pub fn of_tick<const K: usize>(
        model: &StepModel<K>,
        (rewound, counts): (bool, bool),
        hands: usize,
    ) -> Self {
        let side = model.side();
        let rewind = if rewound { rewind_work(side, K) } else { 0 };
        let islands = match model.islands.is_removal_due() {
            true => island_reserve(side).max(island_removal_row_visits(side)),
            false => island_reserve(side),
        };
        let counting = if counts { bared_count_work(side) } else { 0 };
        let done = rewind + islands + counting;
        let left = tick_work(side).saturating_sub(done);
        Ledger { side, is_mirrored: model.is_mirrored, left, hands_left: hands as u32 }
    }

    /// Returns the work of the next hand: the first of two gets half of what is left.
    pub fn work_of_next_hand(&mut self, bit: &GridBit, file_brush: Option<&GridBit>) -> HandWork {
        let left = self.left / self.hands_left;
        self.hands_left -= 1;
        let most_steps = max_bit_steps_per_tick(self.side);
        let mut work = BitWork::of(bit, self.side, self.is_mirrored);
        if let Some(brush) = file_brush {
            work.become_that_of_file(brush, self.side, self.is_mirrored);
        }
        HandWork { work, most_steps, left }
    }

    /// Charges a hand's work: the unused part of its share `before` goes to the next.
    pub fn charge(&mut self, before: &HandWork, after: &HandWork) {
        self.left -= before.left - after.left;
    }

    /// Charges work outside the hands' shares.
    pub fn charge_work(&mut self, work: u32) {
        self.left = self.left.saturating_sub(work);
    }

    /// Returns the cost of spalling.
    pub fn work_of_spall(&self, spall: &GridBit) -> u32 {
        let side = bit_side_voxels(spall.circumscribed_radius_subunits());
        if self.is_mirrored { 2 * spall_work(side) } else { spall_work(side) }
    }
}

/// Returns the cost of finding the contact of a bit that isn't a file: discs, and bits beyond their bite,
/// cost more.
pub fn work_of_contact(bit: &GridBit, contact: &Contact) -> u32 {
    let side = bit_side_voxels(bit.circumscribed_radius_subunits());
    let is_disc = matches!(bit.shape, GridShape::Disc { .. });
    let is_buried = contact.depth > bit.bite;
    match (contact.overlap > 0, is_disc, is_buried) {
        (false, ..) => 0,
        (true, true, _) => disc_contact_work(side),
        (true, false, true) => buried_contact_work(side),
        (true, false, false) => contact_work(side),
    }
}

impl HandWork {
    /// Returns the rest of the hand's share. A running bit reserves an edit in place, and for each of its
    /// steps the cost by which the edit grows.
    pub fn share(&self, runs: bool) -> HandShare {
        let HandWork { work, most_steps, left } = *self;
        let way = if runs {
            let beside_bite = left.saturating_sub(work.bite);
            let steps = (beside_bite / (work.step + work.sweep)).min(most_steps);
            let quarter_voxels = (beside_bite - steps * work.step) / work.sweep;
            WayBudget { steps, quarter_voxels }
        } else {
            WayBudget { steps: (left / work.step).min(most_steps), quarter_voxels: u32::MAX }
        };
        HandShare { way, may_edit: left >= work.bite }
    }

    /// Returns the share of a file: it reserves an edit if it makes one, but not the edit's sweep.
    pub fn share_of_file(&self, edits: bool) -> HandShare {
        let beside = if edits { self.left.saturating_sub(self.work.bite) } else { self.left };
        let steps = (beside / self.work.step).min(self.most_steps);
        let way = WayBudget { steps, quarter_voxels: if edits { steps } else { u32::MAX } };
        HandShare { way, may_edit: self.left >= self.work.bite }
    }

    /// Returns the work left beside other work.
    pub fn left_beside(&self, work: u32) -> u32 {
        self.left.saturating_sub(work)
    }

    /// Charges steps of a path.
    pub fn charge_steps(&mut self, steps: u32) {
        self.left = self.left.saturating_sub(steps * self.work.step);
    }

    /// Charges work done before the hand's path.
    pub fn charge_other(&mut self, work: u32) {
        self.left = self.left.saturating_sub(work);
    }

    /// Charges the contact of a file.
    pub fn charge_contact_of_file(&mut self, bit: &GridBit) {
        let side = bit_side_voxels(bit.circumscribed_radius_subunits());
        self.left = self.left.saturating_sub(buried_contact_work(side));
    }

    /// Returns `true` if an edit along a path fits into the work left.
    pub fn allows_edit(&self, bit: &GridBit, from: &Pose, to: &Pose) -> bool {
        let mut after = HandWork { left: u32::MAX, ..*self };
        after.charge_edit(bit, from, to);
        u32::MAX - after.left <= self.left
    }

    /// Charges an edit along a path.
    pub fn charge_edit(&mut self, bit: &GridBit, from: &Pose, to: &Pose) {
        let longer = self.work.sweep * path_poses(bit, from, to).count() as u32;
        self.left = self.left.saturating_sub(self.work.bite + longer);
    }
}

/// The costs of a bit's movements and edits.
#[derive(Clone, Copy, Debug)]
struct BitWork {
    /// A step of the walk.
    step: u32,
    /// An edit in place.
    bite: u32,
    /// The additional cost of an edit a quarter voxel of path.
    sweep: u32,
}

impl BitWork {
    /// Returns the costs of a bit; a mirrored edit costs twice as much.
    fn of(bit: &GridBit, grid_side: usize, is_mirrored: bool) -> Self {
        let side = bit_side_voxels(bit.circumscribed_radius_subunits());
        let edits = if is_mirrored { 2 } else { 1 };
        let (step, bite, sweep) = match bit.shape {
            GridShape::Ball(_) => {
                (bit_step_work(side), bite_work(side), ball_sweep_work_per_quarter_voxel(side))
            }
            GridShape::Box(_) => {
                (bit_step_work(side), bite_work(side), box_sweep_work_per_quarter_voxel(side))
            }
            GridShape::Disc { .. } => (
                disc_step_work(grid_side, side),
                disc_bite_work(grid_side, side),
                disc_sweep_work_per_step(side),
            ),
        };
        BitWork { step, bite: edits * bite, sweep: edits * sweep }
    }

    /// Changes the costs to those of a file: smoothing has its own cost, and the brush is larger than the
    /// bit.
    fn become_that_of_file(&mut self, brush: &GridBit, grid_side: usize, is_mirrored: bool) {
        let side = bit_side_voxels(brush.circumscribed_radius_subunits());
        let edits = if is_mirrored { 2 } else { 1 };
        self.step = self.step * 3 / 2;
        self.bite = edits * smoothing_work(grid_side, side);
        self.sweep = edits * smoothing_sweep_work_per_quarter_voxel(side);
    }
}
