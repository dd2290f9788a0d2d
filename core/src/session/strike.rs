//! Actions before a bit follows its hand: laying a float on the stone, and splitting off a flake by a blow.

use crate::edit::brush::{Brush, BrushPiece};
use crate::edit::flake::find_flake;
use crate::edit::grid_bit::{GridBit, GridShape};
use crate::edit::operation::{ANY_DEPTH, EditOperation, EditReport};
use crate::session::events::WorldEvent;
use crate::session::float::half_space_above_float;
use crate::session::hand::{HandPresses, HandState};
use crate::session::ledger::{BitWork, work_of_contact};
use crate::session::tools::{BitAction, ToolBit};
use crate::session::world::World;
use crate::volume::range::Range;
use crate::volume::size::{Grid, Size};
use crate::volume::voxel_box::VoxelBox;

/// The result of the actions before a bit's movement.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct PreparedBit {
    /// Work done.
    pub(super) work: u32,
    /// The report of splitting off a flake, if one was split off.
    pub(super) split: Option<EditReport>,
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Stores the plane of a float that begins to work, or splits off a flake if a chisel is struck and the
    /// hand's `share` of the tick's work suffices.
    pub(super) fn lay_or_strike(
        &mut self,
        hand: usize,
        (bit, grid_bit): (ToolBit, &GridBit),
        state: &mut HandState,
        presses: HandPresses,
        share: u32,
    ) -> PreparedBit {
        if bit.spec().action == BitAction::Flatten && presses.pulled {
            let contact = self.obstacle().contact_at(grid_bit, &state.raw_pose);
            state.above_float = half_space_above_float(grid_bit, &state.raw_pose, &contact);
            return PreparedBit { work: work_of_contact(grid_bit, &contact), split: None };
        }
        let voxel_um = self.stool_frame().voxel_metres() * 1e6;
        let reach = bit.to_grid_flake_reach(voxel_um).filter(|_| {
            let is_struck = state.trigger && bit.spec().is_blow_at(state.trigger_ticks);
            is_struck && state.can_sweep && state.has_frozen_pose
        });
        let Some(reach) = reach else { return PreparedBit::default() };
        let work = BitWork::of_flake(reach, self.state.symmetry);
        let GridShape::Box(half_extents) = grid_bit.shape else { return PreparedBit::default() };
        let flake = find_flake(self.volume.rows(), &state.frozen_pose, half_extents.z, reach);
        let Some(flake) = flake.filter(|_| work <= share) else { return PreparedBit::default() };
        PreparedBit { work, split: Some(self.split_off(hand, flake)) }
    }

    /// Removes a whole flake, except for the mask and what closure restores, and reports an event.
    fn split_off(&mut self, hand: usize, flake: BrushPiece) -> EditReport {
        let brush = Brush::from(flake);
        let carve = EditOperation::Carve { depth: ANY_DEPTH };
        let report = self.edit_with_brush(&brush, &brush, carve, self.state.symmetry);
        let within = flake.bounds(N).map_or(VoxelBox::EMPTY, |bounds| {
            VoxelBox::new([0, 1, 2].map(|i| Range::new(bounds.lo[i], bounds.hi[i])))
        });
        if report.removed > 0 {
            let removed = report.removed;
            self.push_event(WorldEvent::Split { hand: hand as u8, removed, within });
        }
        report
    }
}
