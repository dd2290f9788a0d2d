//! Model of a blow that splits off a flake.

use glam::{I64Vec3, IVec3};
use paros_core::WorldEvent;
use paros_core::edit::{ANY_DEPTH, EditOperation, EditReport};
use paros_core::internals::{GridBit, GridShape};
use paros_core::limits::{bit_side_voxels, flake_work};
use paros_core::session::ToolBit;
use paros_core::volume::{Range, VoxelBox};

use crate::step::StepModel;
use crate::step::hands::is_blow_at;
use crate::step::ledger::HandWork;

/// Half of the ball around a struck point.
struct Flake {
    struck: I64Vec3,
    normal: I64Vec3,
    reach: i64,
}

impl<const K: usize> StepModel<K> {
    /// Splits off a flake, if the chisel can, is struck in this tick near enough to an edge, and the hand has
    /// enough work left. Returns the edit's report and its work.
    pub(super) fn strike(
        &mut self,
        hand: usize,
        (bit, grid_bit): (ToolBit, &GridBit),
        share: &HandWork,
    ) -> Option<(EditReport, u32)> {
        let reach = bit.to_grid_flake_reach(self.stool_frame().voxel_metres() * 1e6)?;
        let state = &self.hands[hand];
        let is_struck = state.trigger && is_blow_at(bit, state.trigger_ticks);
        if !is_struck || !state.can_sweep || !state.has_frozen_pose {
            return None;
        }
        let flake = self.flake_under(hand, grid_bit, i64::from(reach))?;
        let work = flake_work(bit_side_voxels(reach)) * if self.is_mirrored { 2 } else { 1 };
        if work > share.left_beside(0) {
            return None;
        }
        let side = self.side() as i32;
        let is_in = |voxel: [i32; 3]| {
            let off = (IVec3::from_array(voxel) * 256 + 128).as_i64vec3() - flake.struck;
            off.dot(off) <= flake.reach * flake.reach && off.dot(flake.normal) > 0
        };
        let mut voxels: Vec<_> = self.volume.voxels().all_voxels().filter(|&v| is_in(v)).collect();
        if self.is_mirrored {
            let images: Vec<_> = voxels.iter().map(|&[x, y, z]| [side - 1 - x, y, z]).collect();
            voxels.extend(images);
            voxels.sort_unstable();
            voxels.dedup();
        }
        let carve = EditOperation::Carve { depth: ANY_DEPTH };
        let report = self.edit_voxels(carve, &voxels, self.is_mirrored);
        if report.removed > 0 {
            let (removed, within) = (report.removed, flake.ball_box(self.side()));
            self.events.push(WorldEvent::Split { hand: hand as u8, removed, within });
        }
        Some((report, work))
    }

    /// Returns the flake that a hand's chisel would split off: its tip must be on stone, and the stone must
    /// end within reach along the blow and to one side of the blade.
    fn flake_under(&self, hand: usize, grid_bit: &GridBit, reach: i64) -> Option<Flake> {
        let GridShape::Box(half) = grid_bit.shape else { return None };
        let pose = self.hands[hand].frozen_pose;
        let axes = pose.unit_axes_q14().map(|axis| axis.as_i64vec3());
        let (up, blow) = (axes[1], -axes[2]);
        let tip = moved(pose.clamped_position_subunits().as_i64vec3(), blow, i64::from(half.z));
        let struck =
            (0..=4).map(|i| moved(tip, blow, 128 * i)).find(|&point| self.is_stone_at(point))?;
        // In half voxels; the ground under the stone doesn't count as an end.
        let end = |way: I64Vec3| {
            (1..=reach / 128).find(|i| {
                let point = moved(struck, way, 128 * i);
                point.y >= 0 && !self.is_stone_at(point)
            })
        };
        end(blow)?;
        let normal = match (end(up), end(-up)) {
            (None, None) => return None,
            (Some(over), Some(under)) if over > under => -up,
            (None, Some(_)) => -up,
            _ => up,
        };
        Some(Flake { struck, normal, reach })
    }

    fn is_stone_at(&self, point: I64Vec3) -> bool {
        let voxel = point.to_array().map(|part| part.div_euclid(256));
        voxel.iter().all(|&i| (0..self.side() as i64).contains(&i))
            && self.volume.voxels().contains(voxel.map(|i| i as i32))
    }
}

impl Flake {
    /// Returns the box around the voxels of the whole ball.
    fn ball_box(&self, side: usize) -> VoxelBox {
        VoxelBox::new([0, 1, 2].map(|axis| {
            let middle = self.struck.to_array()[axis];
            let is_in = |&i: &usize| (i as i64 * 256 + 128 - middle).abs() <= self.reach;
            let mut inside = (0..side).filter(is_in);
            match (inside.next(), inside.next_back()) {
                (Some(first), last) => Range::new(first, last.unwrap_or(first)),
                _ => Range::EMPTY,
            }
        }))
    }
}

/// Returns a point moved along a unit direction, in fixed point with 2^14 as 1.
fn moved(from: I64Vec3, way: I64Vec3, distance: i64) -> I64Vec3 {
    from + I64Vec3::from_array((way * distance).to_array().map(|part| part >> 14))
}
