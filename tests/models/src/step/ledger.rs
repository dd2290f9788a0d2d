//! The ledger of a tick's work: what undo and redo, hands and islands may spend together, in row visits of the
//! island search.

use paros_core::edit::Pose;
use paros_core::internals::{GridBit, GridShape, WayBudget};
use paros_core::limits::{
    ball_sweep_work_per_quarter_voxel, bit_side_voxels, bit_step_work, bite_work,
    box_sweep_work_per_quarter_voxel, island_removal_row_visits, island_reserve,
    max_bit_steps_per_tick, rewind_work, tick_work,
};

use crate::contact::path_poses;
use crate::step::StepModel;

/// What is left of a tick's work for the hands.
#[derive(Clone, Copy, Debug)]
pub struct Ledger {
    side: usize,
    /// Beyond what is the islands' anyway.
    left: u32,
    hands_left: u32,
}

/// What a hand may do in a tick.
#[derive(Clone, Copy, Debug)]
pub struct HandShare {
    /// How far its bit may go.
    pub way: WayBudget,
    /// Whether it may edit.
    pub may_edit: bool,
}

/// What a hand did.
#[derive(Clone, Copy, Debug)]
pub struct HandWork {
    /// Steps of its way.
    pub steps: u32,
    /// The ends of the way along which it edited.
    pub edited: Option<(Pose, Pose)>,
}

impl Ledger {
    /// The ledger of a tick in which undo or redo changed the volume, or not.
    pub fn of_tick<const K: usize>(model: &StepModel<K>, rewound: bool) -> Self {
        let side = model.side();
        let rewind = if rewound { rewind_work(side, K) } else { 0 };
        let islands = match model.islands.is_removal_due() {
            true => island_reserve(side).max(island_removal_row_visits(side)),
            false => island_reserve(side),
        };
        let left = tick_work(side).saturating_sub(rewind).saturating_sub(islands);
        Ledger { side, left, hands_left: 2 }
    }

    /// What the next hand may do: the first of two has half of what is left. A bit that runs leaves room for an
    /// edit in place, and in each of its steps for what the edit is longer by it.
    pub fn share_of_next_hand(&mut self, bit: &GridBit, runs: bool) -> HandShare {
        let share = self.left / self.hands_left;
        self.hands_left -= 1;
        let most = max_bit_steps_per_tick(self.side);
        let work = BitWork::of(bit);
        let way = if runs {
            let beside_bite = share.saturating_sub(work.bite);
            let steps = (beside_bite / (work.step + work.sweep)).min(most);
            let quarter_voxels = (beside_bite - steps * work.step) / work.sweep;
            WayBudget { steps, quarter_voxels }
        } else {
            WayBudget { steps: (share / work.step).min(most), quarter_voxels: u32::MAX }
        };
        HandShare { way, may_edit: share >= work.bite }
    }

    /// A hand without a tool has had its turn.
    pub fn skip_hand(&mut self) {
        self.hands_left -= 1;
    }

    /// Charges what a hand did.
    pub fn charge(&mut self, bit: &GridBit, done: &HandWork) {
        let work = BitWork::of(bit);
        let edit = done.edited.map_or(0, |(from, to)| {
            work.bite + work.sweep * path_poses(bit, &from, &to).count() as u32
        });
        self.left = self.left.saturating_sub(done.steps * work.step + edit);
    }
}

/// What a bit's movements and edits cost.
struct BitWork {
    /// A step.
    step: u32,
    /// An edit in place.
    bite: u32,
    /// What a quarter voxel of way adds to an edit.
    sweep: u32,
}

impl BitWork {
    fn of(bit: &GridBit) -> Self {
        let side = bit_side_voxels(bit.circumscribed_radius_subunits());
        BitWork {
            step: bit_step_work(side),
            bite: bite_work(side),
            sweep: match bit.shape {
                GridShape::Ball(_) => ball_sweep_work_per_quarter_voxel(side),
                GridShape::Box(_) => box_sweep_work_per_quarter_voxel(side),
            },
        }
    }
}
