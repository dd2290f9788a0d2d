//! The ledger of a tick: the work budget shared by undo or redo, the hands and the island search.
//!
//! The unit of work is a row visit of the island search, some 150 instructions at 128 and half as many again
//! at 256. The work that an undo leaves goes to one hand after the other, and the rest to the islands, which
//! also have a reserve of their own. So no tick is long, and every pass ends whatever the hands do.

use crate::edit::contact::{Contact, WayBudget};
use crate::edit::grid_bit::{GridBit, GridShape};
use crate::limits::{
    ball_sweep_work_per_quarter_voxel, bit_side_voxels, bit_step_work, bite_work,
    box_sweep_work_per_quarter_voxel, buried_contact_work, contact_work, dear_rewind_columns,
    disc_bite_work, disc_contact_work, disc_step_work, disc_sweep_work_per_step, flake_work,
    island_removal_row_visits, island_reserve, max_bit_steps_per_tick,
    max_island_row_visits_per_tick, rewind_work, smoothing_sweep_work_per_quarter_voxel,
    smoothing_work, spall_work, tick_work,
};

/// The remaining work budget of a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct TickLedger {
    left: u32,
    /// The islands' reserve, which nothing else may spend.
    reserve: u32,
    most_row_visits: u32,
}

impl TickLedger {
    /// Opens the ledger of a tick. `rewound_columns` is the number of columns that undo or redo swapped, 0
    /// for none; `is_removal_due` is `true` if the island search has to remove the islands found.
    ///
    /// An undo or redo restarts the search, so if it takes the whole tick, no pass loses progress.
    pub(crate) fn open(
        grid_side: usize,
        intervals: usize,
        rewound_columns: u32,
        is_removal_due: bool,
    ) -> Self {
        let most_row_visits = max_island_row_visits_per_tick(grid_side);
        let rewind = match rewound_columns {
            0 => 0,
            columns if columns > dear_rewind_columns(grid_side) => {
                return TickLedger { left: 0, reserve: 0, most_row_visits };
            }
            _ => rewind_work(grid_side, intervals),
        };
        let removal = if is_removal_due { island_removal_row_visits(grid_side) } else { 0 };
        TickLedger {
            left: tick_work(grid_side).saturating_sub(rewind),
            reserve: island_reserve(grid_side).max(removal),
            most_row_visits,
        }
    }

    /// The work that a hand may do, of `hands_left` that haven't had their turn.
    pub(crate) const fn hand_share(&self, hands_left: u32) -> u32 {
        self.left.saturating_sub(self.reserve) / hands_left
    }

    /// Subtracts work that was done.
    pub(crate) const fn charge(&mut self, work: u32) {
        self.left = self.left.saturating_sub(work);
    }

    /// Returns the remaining budget of the islands, in row visits.
    pub(crate) fn island_row_visits(&self) -> u32 {
        self.left.max(self.reserve).min(self.most_row_visits)
    }
}

/// The costs of a bit's movements and edits.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct BitWork {
    /// A step of its path.
    step: u32,
    /// An edit in place.
    bite: u32,
    /// The work that each quarter voxel of travel adds to a swept edit.
    sweep: u32,
    /// The work of finding its contact, if this is charged here; 0 for bits that pay for the contact found.
    contact: u32,
    most_steps: u32,
}

impl BitWork {
    /// Returns the costs of a bit in a grid `grid_side` voxels wide. A mirrored edit costs two.
    pub(crate) fn of(bit: &GridBit, grid_side: usize, is_mirrored: bool) -> Self {
        let side = bit_side_voxels(bit.circumscribed_radius_subunits());
        let (step, bite) = (bit_step_work(side), bite_work(side));
        let (step, bite, sweep) = match bit.shape {
            GridShape::Ball(_) => (step, bite, ball_sweep_work_per_quarter_voxel(side)),
            GridShape::Box(_) => (step, bite, box_sweep_work_per_quarter_voxel(side)),
            GridShape::Disc { .. } => (
                disc_step_work(grid_side, side),
                disc_bite_work(grid_side, side),
                disc_sweep_work_per_step(side),
            ),
        };
        let most_steps = max_bit_steps_per_tick(grid_side);
        let edits = 1 + u32::from(is_mirrored);
        BitWork { step, bite: edits * bite, sweep: edits * sweep, contact: 0, most_steps }
    }

    /// Returns the costs of a file, whose edits have a larger brush, and whose steps lead through the stone
    /// to the mask.
    pub(crate) fn of_file(
        bit: &GridBit,
        brush: &GridBit,
        grid_side: usize,
        is_mirrored: bool,
    ) -> Self {
        let side = bit_side_voxels(brush.circumscribed_radius_subunits());
        let edits = 1 + u32::from(is_mirrored);
        let of_bit = BitWork::of(bit, grid_side, is_mirrored);
        BitWork {
            step: of_bit.step * 3 / 2,
            bite: edits * smoothing_work(grid_side, side),
            sweep: edits * smoothing_sweep_work_per_quarter_voxel(side),
            contact: buried_contact_work(bit_side_voxels(bit.circumscribed_radius_subunits())),
            ..of_bit
        }
    }

    /// Returns the work of splitting off a flake of this reach.
    pub(crate) fn of_flake(reach_subunits: i32, is_mirrored: bool) -> u32 {
        (1 + u32::from(is_mirrored)) * flake_work(bit_side_voxels(reach_subunits))
    }

    /// Returns the work of spalling, which is done in place.
    pub(crate) fn of_spall(spall: &GridBit, is_mirrored: bool) -> u32 {
        let side = bit_side_voxels(spall.circumscribed_radius_subunits());
        (1 + u32::from(is_mirrored)) * spall_work(side)
    }

    /// Returns how far the bit may move with a share of a tick's work. A running bit reserves work for its
    /// edit.
    pub(crate) fn way_budget(&self, share: u32, is_running: bool) -> WayBudget {
        if !is_running {
            return WayBudget::of_steps((share / self.step).min(self.most_steps));
        }
        let share = share.saturating_sub(self.bite);
        let steps = (share / (self.step + self.sweep)).min(self.most_steps);
        WayBudget { steps, quarter_voxels: (share - steps * self.step) / self.sweep }
    }

    /// Returns how far a bit may move that edits at its destination. The length is limited to a quarter voxel
    /// for each step: a longer step costs more than it is charged, which together with an edit would exceed a
    /// tick's work.
    pub(crate) fn way_budget_beside_edit(&self, share: u32) -> WayBudget {
        let steps = (share.saturating_sub(self.bite) / self.step).min(self.most_steps);
        WayBudget { steps, quarter_voxels: steps }
    }

    /// Returns `true` if an edit in place fits in a share of a tick's work.
    pub(crate) const fn fits_bite(&self, share: u32) -> bool {
        share >= self.bite
    }

    /// Returns the work of a number of steps.
    pub(crate) const fn of_steps(&self, steps: u32) -> u32 {
        steps * self.step
    }

    /// Returns the work of finding the bit's contact.
    pub(crate) const fn of_contact(&self) -> u32 {
        self.contact
    }

    /// Returns the work of an edit that is swept along a number of quarter voxels.
    pub(crate) const fn of_edit(&self, quarter_voxels: u32) -> u32 {
        self.bite + quarter_voxels * self.sweep
    }
}

/// Returns the work of finding a bit's contact, which is highest if the bit is deeper than its bite. For a
/// file, the work is known in advance instead.
pub(crate) fn work_of_contact(bit: &GridBit, contact: &Contact) -> u32 {
    let side = bit_side_voxels(bit.circumscribed_radius_subunits());
    match bit.shape {
        _ if contact.overlap == 0 => 0,
        GridShape::Disc { .. } => disc_contact_work(side),
        GridShape::Ball(_) | GridShape::Box(_) if contact.depth <= bit.bite => contact_work(side),
        GridShape::Ball(_) | GridShape::Box(_) => buried_contact_work(side),
    }
}

#[cfg(test)]
mod tests {
    use super::{BitWork, TickLedger, work_of_contact};
    use crate::edit::contact::Contact;
    use crate::edit::grid_bit::GridShape;
    use crate::limits::{dear_rewind_columns, island_reserve};
    use crate::session::tools::ToolBit;

    #[test]
    fn a_mirrored_edit_is_two() {
        for bit in ToolBit::ALL.map(|bit| bit.to_grid_bit(1758.0)) {
            let [one, two] = [false, true].map(|mirrored| BitWork::of(&bit, 256, mirrored));
            assert_eq!(two.of_edit(7), 2 * one.of_edit(7));
            assert_eq!(two.of_steps(7), one.of_steps(7));
            assert!(!two.fits_bite(one.of_edit(0)));
        }
    }

    /// A contact without stone is free; a bit deeper in stone than its bite pays for each of its voxels.
    #[test]
    fn a_contact_costs_what_it_finds() {
        for bit in ToolBit::ALL.map(|bit| bit.to_grid_bit(1758.0)) {
            let work = |overlap, depth| {
                work_of_contact(&bit, &Contact { overlap, depth, ..Contact::NONE })
            };
            let [free, touching, buried] = [work(0, 0), work(1, bit.bite), work(1, bit.bite + 1)];
            assert!(free == 0 && touching > 0, "{bit:?}");
            match bit.shape {
                GridShape::Disc { .. } => assert_eq!(buried, touching),
                GridShape::Ball(_) | GridShape::Box(_) => assert_eq!(buried, 4 * touching),
            }
        }
    }

    #[test]
    fn a_dear_undo_takes_the_whole_tick() {
        for (side, intervals) in [(128, 1), (128, 2), (256, 1), (256, 2)] {
            let dear = dear_rewind_columns(side);
            let ledger = TickLedger::open(side, intervals, dear + 1, false);
            assert_eq!((ledger.hand_share(2), ledger.island_row_visits()), (0, 0));
            let ledger = TickLedger::open(side, intervals, dear, false);
            // At 256 with two intervals an undo leaves the hands nothing either, but the islands keep their
            // reserve.
            assert_eq!(ledger.hand_share(2) > 0, (side, intervals) != (256, 2));
            assert!(ledger.island_row_visits() >= island_reserve(side));
        }
    }
}
