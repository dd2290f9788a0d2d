//! The edits of bits along their paths.

use crate::edit::brush::Brush;
use crate::edit::operation::{
    ANY_DEPTH, Edit, EditOperation, EditReport, apply_edit, brush_mirror_touches_volume,
    brush_touches_volume,
};
use crate::edit::pose::Pose;
use crate::limits::{flattening_reach, light_smoothing_radius, smoothing_radius};
use crate::session::bared::BaringJournal;
use crate::session::float::half_space_in_lower_half;
use crate::session::journals::StrokeJournal;
use crate::session::tool_step::RunningBit;
use crate::session::tools::BitAction;
use crate::session::world::World;
use crate::volume::size::{Grid, Size};

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Applies a bit's edit along its path between two poses in the grid.
    pub(super) fn edit_along_path(
        &mut self,
        running: &RunningBit<'_>,
        from: &Pose,
        to: &Pose,
    ) -> EditReport {
        let brush = running.brush;
        let operation = self.operation_of_bit(running, to);
        let (swept, rows) = (brush.swept_brush(from, to), self.volume.rows());
        // Paste that touches nothing would fall.
        let is_paste = running.bit.spec().action == BitAction::Fill;
        if is_paste && !brush_touches_volume(&swept, rows) {
            return EditReport::default();
        }
        let mirrored =
            self.state.symmetry && (!is_paste || brush_mirror_touches_volume(&swept, rows));
        self.edit_with_brush(&swept, &brush.piece_at(to).into(), operation, mirrored)
    }

    /// Returns the operation of a bit's edit that ends at a pose.
    fn operation_of_bit(&self, running: &RunningBit<'_>, to: &Pose) -> EditOperation {
        match running.bit.spec().action {
            BitAction::Carve => {
                EditOperation::Carve { depth: running.grid_bit.bite_depth_voxels() }
            }
            BitAction::Fill => EditOperation::Fill { depth: ANY_DEPTH },
            BitAction::Smooth => {
                let radius_of =
                    if running.is_light { light_smoothing_radius } else { smoothing_radius };
                EditOperation::Smooth { radius: radius_of(N), dither: running.dither_at(to) }
            }
            BitAction::Flatten => {
                let above = running.above_float;
                let above = match self.state.symmetry {
                    true => half_space_in_lower_half(above, to, N),
                    false => above,
                };
                EditOperation::Flatten { above, reach: flattening_reach(N) }
            }
        }
    }

    /// Applies an edit of a brush. If the brush is too large for the scratch memory, uses `smaller` instead.
    pub(super) fn edit_with_brush(
        &mut self,
        brush: &Brush,
        smaller: &Brush,
        operation: EditOperation,
        mirrored: bool,
    ) -> EditReport {
        let journal = StrokeJournal {
            undo: &mut self.undo,
            dirty: &mut self.dirty,
            islands: &mut self.islands,
        };
        let (figure, ends) = (&self.mask, &mut self.bared);
        let counted_axes = self.state.counted_axes;
        let mut journal = BaringJournal { journal, figure, counted_axes, ends };
        let mut apply_brush = |brush| {
            let edit = Edit { brush, operation, mirrored };
            apply_edit(&mut self.volume, &self.mask, &edit, &mut self.scratch, &mut journal)
        };
        let report = apply_brush(brush).or_else(|_| apply_brush(smaller)).unwrap_or_default();
        self.dirty.end_edit();
        if report.changed_volume() {
            self.islands.request_pass();
        }
        report
    }
}
