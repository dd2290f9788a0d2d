//! Model of paste as a nozzle lays it.

use paros_core::Brush;
use paros_core::edit::{ANY_DEPTH, EditOperation, EditReport};

use crate::step::StepModel;
use crate::step::volume::{Voxel, voxels_of_brush};

impl<const K: usize> StepModel<K> {
    /// Lays paste all along a brush where it is connected to the stone or the ground, and in its mirror image
    /// where the image is connected too. Never fills the image alone.
    pub(super) fn lay_paste(&mut self, brush: &Brush) -> EditReport {
        let side = self.side();
        let own = voxels_of_brush(brush, side, false);
        if !own.iter().any(|&voxel| self.holds_paste(voxel)) {
            return EditReport::default();
        }
        let image_of = |[x, y, z]: Voxel| [side as i32 - 1 - x, y, z];
        let is_mirrored =
            self.is_mirrored && own.iter().any(|&voxel| self.holds_paste(image_of(voxel)));
        let voxels = voxels_of_brush(brush, side, is_mirrored);
        self.edit_voxels(EditOperation::Fill { depth: ANY_DEPTH }, &voxels, is_mirrored)
    }

    /// Returns `true` if a voxel is stone, or shares a face with stone or with the ground.
    fn holds_paste(&self, voxel: Voxel) -> bool {
        const STEPS: [Voxel; 7] =
            [[0, 0, 0], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
        STEPS.iter().any(|step| {
            let near = [0, 1, 2].map(|i| voxel[i] + step[i]);
            near[1] < 0 || self.volume.voxels().contains(near)
        })
    }
}
