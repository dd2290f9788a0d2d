//! Poses in the grid: floats in voxels for interpolation, fixed point for all decisions.

use glam::{IVec3, Quat, Vec3};

/// Fixed-point scale of lengths: subunits in a voxel's side. Voxel `i` starts at `i` times this scale; its
/// centre is half a voxel farther.
pub const SUBUNITS_PER_VOXEL: i32 = 256;

/// Fixed-point scale of directions: the representation of 1.
pub const FIXED_ONE: i32 = 1 << 14;

/// Position and rotation of a bit in the grid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pose {
    /// Position in voxels.
    pub position: Vec3,
    /// Unit rotation from the bit's frame to the grid's.
    pub rotation: Quat,
}

impl Pose {
    /// The identity rotation at the grid's origin.
    pub const ZERO: Pose = Pose { position: Vec3::ZERO, rotation: Quat::IDENTITY };

    /// Interpolates to `other` by `t` (0 to 1): position linearly, rotation by slerp on the shorter arc.
    #[must_use]
    pub fn interpolate(&self, other: &Pose, t: f32) -> Pose {
        if t >= 1.0 {
            return *other;
        }
        Pose {
            position: self.position + (other.position - self.position) * t,
            rotation: self.rotation.slerp(other.rotation, t).normalize(),
        }
    }

    /// Returns the angle between the two rotations, in radians, 0 to pi.
    #[must_use]
    pub fn angle_radians_to(&self, other: &Pose) -> f32 {
        self.rotation.angle_between(other.rotation)
    }

    /// Returns the position in fixed point, clamped to 8,192 voxels along each axis.
    #[must_use]
    pub fn clamped_position_subunits(&self) -> IVec3 {
        subunits_from_voxels(self.position)
    }

    /// Returns the bit's three unit axes in the grid, in fixed point ([`FIXED_ONE`] is 1).
    #[must_use]
    pub fn unit_axes_q14(&self) -> [IVec3; 3] {
        [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
            let v = self.rotation * axis * FIXED_ONE as f32;
            IVec3::new(round_to_i32(v.x), round_to_i32(v.y), round_to_i32(v.z))
        })
    }
}

/// Converts voxels to fixed point, rounded and clamped to [`FAR`]. NaN becomes 0.
#[must_use]
pub(crate) fn subunits_from_voxels(v: Vec3) -> IVec3 {
    let one = |f: f32| round_to_i32((f * SUBUNITS_PER_VOXEL as f32).clamp(-FAR, FAR));
    IVec3::new(one(v.x), one(v.y), one(v.z))
}

/// 8,192 voxels in fixed point: products of two such lengths with a grid coordinate fit in 64 bits.
const FAR: f32 = 8192.0 * SUBUNITS_PER_VOXEL as f32;

fn round_to_i32(f: f32) -> i32 {
    libm::roundf(f) as i32
}
