//! A hand's tool in a tick: its bit follows the hand as far as the volume lets it, and edits.

use crate::edit::contact::{FreezeResult, Obstacle, WayBudget};
use crate::edit::grid_bit::GridBit;
use crate::edit::operation::{Edit, EditOperation, EditReport, apply_edit};
use crate::edit::pose::Pose;
use crate::session::events::WorldEvent;
use crate::session::hand::{HandPresses, HandState, haptic_amplitude};
use crate::session::journals::StrokeJournal;
use crate::session::ledger::BitWork;
use crate::session::state::SessionState;
use crate::session::step::metres_from_um;
use crate::session::tools::{BitAction, ToolBit};
use crate::session::world::World;
use crate::volume::size::{Grid, Size};

/// The way of a bit in a tick.
struct BitWay {
    /// Where it led.
    freeze: FreezeResult,
    /// The pose from which an edit is swept to the end of the way, which is the end itself where the bit
    /// jumped or wasn't swept yet. `None` while the bit catches up: nothing is edited.
    sweep_start: Option<Pose>,
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Moves the bit of a held tool with its hand, as far as the volume lets it, and applies the edit if
    /// the tool is running, all within its `share` of the tick's work. Returns what it spent. Nothing
    /// happens without a tool, without tracking, or outside a sculpting session.
    pub(crate) fn step_tool(&mut self, hand: usize, presses: HandPresses, share: u32) -> u32 {
        let Some((tool, bit)) = self.held_tool(hand) else {
            return 0;
        };
        let mut state = self.state.hands[hand];
        if !state.tracked || self.state.session != SessionState::Sculpting {
            return 0;
        }
        let frame = self.stool_frame();
        let grid_bit = bit.to_grid_bit(frame.voxel_metres() * 1e6);
        let (position, rotation) = state.bit_centre_pose(metres_from_um(tool.length_um()));
        let raw = frame.to_grid(position, rotation);
        let work = BitWork::of(&grid_bit, N);
        let budget = work.way_budget(share, state.trigger);
        let BitWay { freeze, sweep_start } =
            self.find_bit_way(&state, presses, (bit, &grid_bit), &raw, budget);
        let contact = self.obstacle().contact_at(&grid_bit, &freeze.pose);

        // Haptics follow the speed of the hand, not that of the bit.
        let moved_voxels = match state.has_frozen_pose {
            true => (raw.position - state.raw_pose.position).length(),
            false => 0.0,
        };
        let speed_um = (moved_voxels * frame.voxel_metres() * 1e6).min(1e6) as u32;
        let (running, ticks) = (state.trigger, state.trigger_ticks);
        state.haptic = haptic_amplitude(bit.spec(), &contact, running, ticks, speed_um);

        (state.raw_pose, state.frozen_pose) = (raw, freeze.pose);
        (state.can_sweep, state.has_frozen_pose) = (sweep_start.is_some(), true);
        self.state.hands[hand] = state;
        self.contacts[hand] = contact;
        self.has_contact[hand] = true;

        let mut spent = work.of_steps(freeze.steps);
        if let Some(start) = sweep_start
            && running
            && work.fits_bite(share)
            && ticks.is_multiple_of(u16::from(bit.spec().bite_period))
        {
            self.edit_along_path(hand, bit, &start, &freeze.pose);
            spent += work.of_edit(grid_bit.path_steps(&start, &freeze.pose));
        }
        spent
    }

    /// What bits collide with.
    fn obstacle(&self) -> Obstacle<'_, N, K> {
        let mask = self.state.masked.then_some(&self.mask);
        Obstacle { rows: self.volume.rows(), mask, is_mask_alone: false }
    }

    /// The way of a bit toward the pose `raw` that its hand asks for, both in the grid.
    ///
    /// The volume doesn't hold a nozzle that runs, which would stick in its own paste; the mask does. One
    /// that was buried as it began to run jumps to its hand, so that no paste is laid on the way there.
    fn find_bit_way(
        &self,
        state: &HandState,
        presses: HandPresses,
        (bit, grid_bit): (ToolBit, &GridBit),
        raw: &Pose,
        budget: WayBudget,
    ) -> BitWay {
        let last = if state.has_frozen_pose { state.frozen_pose } else { *raw };
        let is_laying = state.trigger && bit.spec().action == BitAction::Fill;
        let mut can_sweep = state.can_sweep;
        let obstacle = self.obstacle();
        let holding = Obstacle { is_mask_alone: is_laying, ..obstacle };
        let begins = is_laying && (presses.pulled || !can_sweep);
        let freeze = if begins && obstacle.buries(grid_bit, &last) {
            can_sweep = false;
            let jump = holding.jump_if_bite_allows(grid_bit, &last, raw, budget);
            FreezeResult { ran_out: !jump.jumped, ..jump }
        } else {
            holding.freeze_bit(grid_bit, &last, raw, budget)
        };
        let is_swept = can_sweep && !freeze.jumped;
        let sweep_start = match (is_swept, can_sweep || !freeze.ran_out) {
            (true, _) => Some(last),
            (false, has_caught_up) => has_caught_up.then_some(freeze.pose),
        };
        BitWay { freeze, sweep_start }
    }

    /// Applies a bit's edit along its path between two poses in the grid.
    fn edit_along_path(&mut self, hand: usize, bit: ToolBit, from: &Pose, to: &Pose) {
        let grid_bit = bit.to_grid_bit(self.stool_frame().voxel_metres() * 1e6);
        let depth = grid_bit.bite_depth_voxels();
        let operation = match bit.spec().action {
            BitAction::Carve => EditOperation::Carve { depth },
            BitAction::Fill => EditOperation::Fill { depth },
            BitAction::Smooth => EditOperation::Smooth,
        };
        let mirrored = self.state.symmetry;
        let mut journal = StrokeJournal {
            undo: &mut self.undo,
            dirty: &mut self.dirty,
            islands: &mut self.islands,
        };
        let mut apply_brush = |brush| {
            let edit = Edit { brush: &brush, operation, mirrored };
            apply_edit(&mut self.volume, &self.mask, &edit, &mut self.scratch, &mut journal)
        };
        // A smoothing brush too large for the scratch memory is replaced by the bit at its last pose.
        let report = apply_brush(grid_bit.swept_brush(from, to))
            .or_else(|_| apply_brush(grid_bit.piece_at(to).into()))
            .unwrap_or_default();
        self.dirty.end_edit();
        if report.changed_volume() {
            self.islands.request_pass();
        }
        if report != EditReport::default() {
            self.push_event(WorldEvent::Edited { hand: hand as u8, bit, report });
        }
    }
}
