//! Model of spalling: stone that comes off a hidden figure near a bit that touches it.

use paros_core::edit::{EditOperation, EditReport};
use paros_core::session::ToolBit;

use crate::step::StepModel;
use crate::step::hands::is_blow_at;
use crate::step::ledger::Ledger;
use crate::step::volume::whole_voxels;

impl<const K: usize> StepModel<K> {
    /// Removes all stone within reach of a hand's bit that touches the figure, if the tool runs and `left` of
    /// the hand's work is enough.
    pub(super) fn spall(
        &mut self,
        hand: usize,
        bit: ToolBit,
        left: u32,
        ledger: &mut Ledger,
    ) -> EditReport {
        let state = self.hands[hand];
        let voxel_um = self.stool_frame().voxel_metres() * 1e6;
        let Some(spall) = self.spec_of(bit).to_grid_spall(voxel_um) else {
            return EditReport::default();
        };
        let work = ledger.work_of_spall(&spall);
        let works = self.runs_tool(hand) && is_blow_at(bit, state.trigger_ticks);
        if !works || !state.can_sweep || work > left {
            return EditReport::default();
        }
        ledger.charge_work(work);
        let brush = spall.piece_at(&state.frozen_pose).into();
        self.edit(EditOperation::Carve { depth: whole_voxels(spall.bite) }, &brush, &brush)
    }
}
