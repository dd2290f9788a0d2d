//! The transform between the room, in metres, and the grid on its turning stool, in voxels.

use glam::{Quat, Vec2, Vec3};

use crate::edit::pose::Pose;
use crate::session::hand::RoomPose;

/// Side of the sculpture's box, in metres.
pub const BOX_SIDE: f32 = 0.45;

/// Radius of the stool's top, in metres: just enough to carry the box's corners.
pub const STOOL_RADIUS: f32 = BOX_SIDE * core::f32::consts::FRAC_1_SQRT_2 + 0.014;

/// Distance from the stool's axis, in metres, below which a hand's direction from the axis is undefined.
const LEAST_RADIUS: f32 = 0.05;

/// Centre of the stool's top, on which the box stands, in metres in the room.
pub const STOOL_TOP: Vec3 = Vec3::new(0.0, 0.8, -0.55);

/// Returns the distance of a point of the room from the rim of the stool's top, in metres.
pub(crate) fn distance_from_stool_rim(point: Vec3) -> f32 {
    let from_top = point - STOOL_TOP;
    let across = Vec2::new(from_top.x, from_top.z).length() - STOOL_RADIUS;
    Vec2::new(across, from_top.y).length()
}

/// Returns the angle about the stool's axis from one point to another, the shorter way round, in 65,536ths of
/// a turn; 0 if one of them is on the axis. The angles of a path's parts add up to the angle of the whole.
pub(crate) fn turn_about_stool(from: Vec3, to: Vec3) -> i32 {
    let bearing = |point: Vec3| {
        let Vec3 { x, z, .. } = point - STOOL_TOP;
        let radians = libm::atan2(f64::from(-z), f64::from(x));
        let units = libm::round(radians * (65_536.0 / core::f64::consts::TAU));
        (Vec2::new(x, z).length() >= LEAST_RADIUS).then_some(units as i32)
    };
    match (bearing(from), bearing(to)) {
        (Some(from), Some(to)) => i32::from((to - from) as i16),
        _ => 0,
    }
}

/// The frame of a turned stool that carries a grid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StoolFrame {
    rotation: Quat,
    voxel_metres: f32,
    /// Half the grid's side, in voxels.
    half_side: f32,
}

impl StoolFrame {
    /// Creates the frame of a grid of `grid_side`^3 voxels. The turn is counter-clockwise as seen from above.
    #[must_use]
    pub fn new(turn_65536ths: u16, grid_side: usize) -> Self {
        let radians = f32::from(turn_65536ths) * (core::f32::consts::TAU / 65_536.0);
        StoolFrame {
            rotation: Quat::from_rotation_y(radians),
            voxel_metres: BOX_SIDE / grid_side as f32,
            half_side: grid_side as f32 / 2.0,
        }
    }

    /// Returns the side of a voxel, in metres.
    #[must_use]
    pub const fn voxel_metres(&self) -> f32 {
        self.voxel_metres
    }

    /// Transforms a pose from the room (metres) to the grid (voxels).
    #[must_use]
    pub fn to_grid(&self, position_metres: Vec3, rotation: Quat) -> Pose {
        let to_stool = self.rotation.conjugate();
        let from_top = to_stool * (position_metres - STOOL_TOP) / self.voxel_metres;
        Pose {
            position: from_top + Vec3::new(self.half_side, 0.0, self.half_side),
            rotation: (to_stool * rotation).normalize(),
        }
    }

    /// Transforms a pose from the grid (voxels) to the room (metres).
    #[must_use]
    pub fn to_room(&self, pose: &Pose) -> RoomPose {
        let from_top =
            (pose.position - Vec3::new(self.half_side, 0.0, self.half_side)) * self.voxel_metres;
        (self.rotation * from_top + STOOL_TOP, (self.rotation * pose.rotation).normalize())
    }
}
