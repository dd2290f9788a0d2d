//! Stones whose surface a stroke follows, and the grip with which a hand turns each bit to it.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{Quat, Vec3};
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{GridBit, GridShape, mix_bits};
use paros_core::session::ToolBit;

/// Side of the grid in millimetres.
pub(crate) const BOX_MM: f32 = 450.0;

/// The stone of a stroke. Round stone is a part of a ball of 180 mm radius.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Stone {
    Flat,
    Convex,
    Concave,
}

impl Stone {
    pub(crate) const ALL: [Stone; 3] = [Stone::Flat, Stone::Convex, Stone::Concave];

    /// Returns the surface `along` voxels from the path's middle: a point of it, and the rotation that takes
    /// y to its normal and -z to the path's direction. `side` is the grid's.
    pub(crate) fn surface_at(self, side: f32, along: f32) -> Pose {
        let radius = ball_radius(side);
        let (about, turn, out) = match self {
            Stone::Flat => (Vec3::new(side / 2.0, side / 4.0, side / 2.0 - along), 0.0, 0.0),
            Stone::Convex => (self.ball_centre(side), -along / radius, radius),
            Stone::Concave => (self.ball_centre(side), along / radius, -radius),
        };
        let rotation = Quat::from_rotation_x(turn);
        // Keeps out of the voxels' planes of symmetry.
        let aside = Vec3::X * 0.3;
        Pose { position: about + aside + rotation * Vec3::Y * out, rotation }
    }

    /// Returns `true` if a voxel is stone. Rough stone has a bump of a voxel at one place in eight, and as
    /// many pits.
    pub(crate) fn contains(self, side: usize, voxel: [usize; 3], is_rough: bool) -> bool {
        let [x, y, z] = voxel.map(|i| i as f32 + 0.5);
        let n = side as f32;
        let from_ball = (Vec3::new(x, y, z) - self.ball_centre(n)).length() - ball_radius(n);
        let height = match self {
            Stone::Flat => y - n / 4.0,
            Stone::Convex => from_ball,
            Stone::Concave if y > 0.6 * n => return false,
            Stone::Concave => -from_ball,
        };
        // Roughness is by columns along y, so that nothing floats.
        let rough = match mix_bits((voxel[0] | voxel[2] << 16) as u64) % 8 {
            0 if is_rough => 1.0,
            1 if is_rough => -1.0,
            _ => 0.0,
        };
        height < rough
    }

    fn ball_centre(self, side: f32) -> Vec3 {
        let height = if self == Stone::Concave { 0.62 * side } else { 0.0 };
        Vec3::new(side / 2.0, height, side / 2.0)
    }
}

const fn ball_radius(side: f32) -> f32 {
    0.4 * side
}

/// Returns a bit's grip for stone with normal y and a path along -z: a cylinder lies across the path, a
/// grinder flat on its disc, a chisel is pushed ahead, and a file lies along the path.
pub(crate) fn grip_of(bit: ToolBit) -> Quat {
    match bit {
        ToolBit::Cylinder => Quat::from_rotation_y(FRAC_PI_2),
        ToolBit::Grinder => Quat::from_rotation_x(-FRAC_PI_2),
        ToolBit::PointChisel | ToolBit::FlatChisel | ToolBit::PitchingChisel => {
            Quat::from_rotation_x(-FRAC_PI_4)
        }
        _ => Quat::IDENTITY,
    }
}

/// Returns a bit's extent from its centre toward stone with normal y, in voxels.
pub(crate) fn reach_of(bit: &GridBit, grip: Quat) -> f32 {
    let subunits = match bit.shape {
        GridShape::Ball(radius) => radius as f32,
        GridShape::Box(half) => (grip.inverse() * Vec3::Y).abs().dot(half.as_vec3()),
        GridShape::Disc { radius, .. } => radius as f32,
    };
    subunits / SUBUNITS_PER_VOXEL as f32
}
