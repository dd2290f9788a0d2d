//! Model of a file and its smoothing.

use paros_core::edit::{Dither, EditOperation, EditReport, Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{BitAction, GridBit, GridShape};
use paros_core::limits::{
    DITHER_RIM_VOXELS, LIGHT_SMOOTHING_PERIOD, SMOOTHING_PERIOD, finishing_edits,
    light_smoothing_radius, smoothing_radius,
};
use paros_core::session::ToolBit;

use crate::step::StepModel;
use crate::step::hand_input::HandPresses;
use crate::step::hands::WayToFind;
use crate::step::ledger::HandWork;

impl<const K: usize> StepModel<K> {
    /// Moves a file to its hand, or to the place where it was released, and smooths in every other tick, the
    /// hands alternating.
    pub(super) fn rub(
        &mut self,
        hand: usize,
        presses: HandPresses,
        (bit, grid_bit): (ToolBit, &GridBit),
        mut work: HandWork,
    ) -> Result<(HandWork, EditReport), String> {
        let edits = self.runs_tool(hand) && self.has_files_turn(hand, self.hands[hand].is_light);
        let share = work.share_of_file(edits);
        let state = self.hands[hand];
        let wanted = match self.trails[hand].front() {
            Some(pose) if !state.trigger => *pose,
            _ => state.raw_pose,
        };
        let from = if state.has_frozen_pose { state.frozen_pose } else { wanted };
        let goes_through_stone = state.trigger;
        let way_of =
            WayToFind { grid_bit, from: &from, wanted: &wanted, slides: true, goes_through_stone };
        let way = self.find_way(&state, presses, &way_of, share.way);
        self.check_way(hand, &way, grid_bit, goes_through_stone)?;
        let frozen = way.freeze.pose;
        let state = &mut self.hands[hand];
        (state.frozen_pose, state.has_frozen_pose) = (frozen, true);
        state.can_sweep = way.may_edit;
        work.charge_steps(way.freeze.steps);
        work.charge_contact_of_file(grid_bit);
        if !(edits && way.may_edit && share.may_edit) {
            return Ok((work, EditReport::default()));
        }
        let (is_finishing, is_light) = (!state.trigger, state.is_light);
        // The edit starts from the pose of the last edit.
        let brush = self.brush_of(bit);
        let affordable = |start: &Pose| work.allows_edit(&brush, start, &frozen);
        let start = self.trails[hand].front().copied().filter(affordable).unwrap_or(frozen);
        let trail = &mut self.trails[hand];
        if is_finishing {
            trail.pop_front();
        } else {
            *trail = vec![frozen; finishing_edits(is_light)].into();
        }
        work.charge_edit(&brush, &start, &frozen);
        let inside =
            shrunk_box(&brush, DITHER_RIM_VOXELS * SUBUNITS_PER_VOXEL).filter(|_| !is_finishing);
        let seed = self.tick.wrapping_mul(2).wrapping_add(hand as u64);
        let dither = inside.map(|inside| Dither { piece: inside.piece_at(&frozen), seed });
        let radius = if is_light { light_smoothing_radius } else { smoothing_radius }(self.side());
        let operation = match bit.spec().action {
            BitAction::Flatten => self.flattening(hand, &frozen),
            _ => EditOperation::Smooth { radius, dither },
        };
        let swept = brush.swept_brush(&start, &frozen);
        Ok((work, self.edit(operation, &swept, &brush.piece_at(&frozen).into())))
    }

    /// Returns `true` if a file's edits fall on this tick: odd ticks for the first hand, even ticks for the
    /// second, and a quarter of these while it works lightly.
    const fn has_files_turn(&self, hand: usize, is_light: bool) -> bool {
        let ticks = if is_light { LIGHT_SMOOTHING_PERIOD } else { SMOOTHING_PERIOD };
        (self.tick + hand as u64) % ticks == 1
    }

    /// Returns the brush of a bit's edits.
    pub(super) fn brush_of(&self, bit: ToolBit) -> GridBit {
        self.spec_of(bit).to_grid_brush(self.stool_frame().voxel_metres() * 1e6)
    }
}

/// Returns a box shrunk by a rim, or `None` if nothing is left.
fn shrunk_box(bit: &GridBit, rim_subunits: i32) -> Option<GridBit> {
    let GridShape::Box(half) = bit.shape else { return None };
    let left = half.to_array().map(|half| half - rim_subunits);
    let shape = GridShape::Box(left.into());
    left.iter().all(|&half| half > 0).then_some(GridBit { shape, ..*bit })
}
