//! Model of flattening: tests each voxel's neighbours one by one.

use glam::IVec3;
use paros_core::edit::{EditOperation, HalfSpace, SUBUNITS_PER_VOXEL};

use crate::dense::DenseVolume;

type Voxel = [i32; 3];

/// The rule of a flattening edit, as documented at
/// [`EditOperation::Flatten`](paros_core::edit::EditOperation).
#[derive(Clone, Copy, Debug)]
pub struct Flattening {
    /// The half space that is removed.
    pub above: HalfSpace,
    /// Half the width of the widest pit that is filled.
    pub reach: i32,
    /// `true` if the edit includes the brush's mirror image.
    pub is_mirrored: bool,
}

impl Flattening {
    /// Returns the rule of an operation, or `None` if it doesn't flatten.
    pub fn of(operation: EditOperation, is_mirrored: bool) -> Option<Self> {
        match operation {
            EditOperation::Flatten { above, reach } => {
                Some(Flattening { above, reach: reach as i32, is_mirrored })
            }
            _ => None,
        }
    }

    /// Returns `true` if a voxel of the brush is occupied after the edit, before closure.
    pub fn is_occupied_after(&self, volume: &DenseVolume, voxel: Voxel) -> bool {
        let last = volume.side() as i32 - 1;
        let is_image = self.is_mirrored && 2 * voxel[0] > last;
        let above = match is_image {
            true => self.above.mirrored(volume.side()),
            false => self.above,
        };
        let middle = IVec3::from_array(voxel) * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2;
        if above.normal.as_i64vec3().dot(middle.as_i64vec3()) > above.offset {
            return false;
        }
        if volume.contains(voxel) {
            return true;
        }
        let parts = above.normal.to_array();
        let most = parts.map(i32::abs).into_iter().max().unwrap_or(0);
        let axis = parts.iter().position(|part| part.abs() == most).unwrap_or(0);
        // A plane that lies along an axis has its floor where the plane itself would have.
        let points_up = if is_image && axis == 0 { parts[0] >= 0 } else { parts[axis] > 0 };
        let is_stone = |axis: usize, step: i32| {
            let mut place = voxel;
            place[axis] += step;
            place[1] < 0 || volume.contains(place)
        };
        let has_wall = |axis: usize, sign: i32| (1..=self.reach).any(|i| is_stone(axis, sign * i));
        let is_walled = |axis: usize| has_wall(axis, -1) && has_wall(axis, 1);
        is_stone(axis, if points_up { -1 } else { 1 })
            && (0..3).any(|other| other != axis && is_walled(other))
    }
}
