//! The gradients' part of an incremental update: stale boxes, within a frame's budget.

use super::budget::{
    BudgetMeter, Cost, GRADIENT_GROUP_WORK, GRADIENT_ROW_WORK, GRADIENT_WINDOW_WORK,
};
use super::extent::TexelBox;
use super::gradient::{GRADIENT_LEVEL, GRADIENT_REACH, GradientTexel, LANES};
use super::textures::DensityField;
use crate::upload::{Region, Texture};

/// Texels of the largest box that is recomputed at once.
const MAX_BOX_TEXELS: usize = 4096;

impl<const N: usize, const K: usize> DensityField<N, K> {
    /// Recomputes stale gradients within the budget, and passes each box to `sink`.
    pub(super) fn recompute_gradients(
        &mut self,
        meter: &mut BudgetMeter,
        sink: &mut impl FnMut(Region, &[u8]),
    ) {
        while let Some(mut extent) = self.gradients.stale.take_merged_box() {
            // Splits a box of more than half a frame's work; the upper half is done later.
            while extent.volume() > MAX_BOX_TEXELS {
                let middle = (extent.lo[2] + extent.hi[2]) / 2;
                let upper = TexelBox { lo: [extent.lo[0], extent.lo[1], middle], ..extent };
                self.gradients.stale.mark_texels(&upper);
                extent.hi[2] = middle;
            }
            let work = estimate_work(&extent);
            let cost = Cost { work, bytes: size_of::<GradientTexel>() * extent.volume() };
            if !meter.allows_unit_of_work(cost) {
                self.gradients.stale.mark_texels(&extent);
                return;
            }
            self.gradients.recompute_box(&self.density[GRADIENT_LEVEL], extent);
            self.staging.clear();
            for (y, z) in extent.rows() {
                self.staging.extend_from_slice(self.gradients.row_bytes(y, z, &extent));
            }
            sink(extent.to_region(Texture::Gradient), &self.staging);
            meter.finish_unit_of_work(cost);
        }
    }
}

/// Estimates the work on a box: on its window's rows and their groups of texels, and on its own groups.
fn estimate_work(extent: &TexelBox) -> usize {
    let [x, y, z] = extent.size();
    let (groups, rows) = (x.div_ceil(LANES), (y + 2 * GRADIENT_REACH) * (z + 2 * GRADIENT_REACH));
    rows * (GRADIENT_ROW_WORK + GRADIENT_WINDOW_WORK * groups)
        + GRADIENT_GROUP_WORK * groups * y * z
}
