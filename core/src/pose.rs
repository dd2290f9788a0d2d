//! Poses in the grid: float positions in voxels for paths, fixed point for every decision.

use glam::{IVec3, Quat, Vec3};

/// Fixed-point units in a voxel. Voxel `i` spans `SUB * i ..= SUB * (i + 1)`; its centre is at
/// `SUB * i + SUB / 2`.
pub const SUB: i32 = 256;

/// Fixed-point one of a direction's components.
pub const UNIT: i32 = 1 << 14;

/// Where a bit is, in voxels, and how it is turned, in the frame of the stool.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pose {
    /// Position in voxels.
    pub position: Vec3,
    /// Unit rotation from the bit's frame to the grid's.
    pub rotation: Quat,
}

impl Pose {
    /// Upright at the grid's corner.
    pub const ZERO: Pose = Pose { position: Vec3::ZERO, rotation: Quat::IDENTITY };

    /// The pose a fraction `t` of the way to `other`: straight, and turning the shorter way round.
    #[must_use]
    pub fn toward(&self, other: &Pose, t: f32) -> Pose {
        if t >= 1.0 {
            return *other;
        }
        Pose {
            position: self.position + (other.position - self.position) * t,
            rotation: self.rotation.slerp(other.rotation, t).normalize(),
        }
    }

    /// The angle between the two rotations, in radians, 0 to pi.
    #[must_use]
    pub fn angle_to(&self, other: &Pose) -> f32 {
        self.rotation.angle_between(other.rotation)
    }

    /// The position in fixed point, held to the square of 8,192 voxels round the grid.
    #[must_use]
    pub fn fixed_position(&self) -> IVec3 {
        to_fixed(self.position)
    }

    /// The frame's three unit axes in fixed point ([`UNIT`] is one).
    #[must_use]
    pub fn fixed_axes(&self) -> [IVec3; 3] {
        [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
            let v = self.rotation * axis * UNIT as f32;
            IVec3::new(round(v.x), round(v.y), round(v.z))
        })
    }
}

/// A length or position in voxels, as fixed point. NaN becomes 0; far values are held in range.
#[must_use]
pub fn to_fixed(v: Vec3) -> IVec3 {
    let one = |f: f32| round((f * SUB as f32).clamp(-FAR, FAR));
    IVec3::new(one(v.x), one(v.y), one(v.z))
}

/// 8,192 voxels: products of two such lengths with a grid coordinate stay in 64 bits.
const FAR: f32 = 8192.0 * SUB as f32;

fn round(f: f32) -> i32 {
    libm::roundf(f) as i32
}
