//! Where the sculpture stands: metres in the room, voxels in the frame of the turning stool.

use glam::{Quat, Vec3};

use crate::pose::Pose;

/// Side of the sculpture's box, in metres.
pub const BOX: f32 = 0.45;

/// The middle of the stool's top, where the box stands: metres in front of the visitor.
pub const STOOL: Vec3 = Vec3::new(0.0, 0.8, -0.55);

/// A turned stool, for a grid of `n` voxels a side.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Frame {
    turn: Quat,
    voxel: f32,
    half: f32,
}

impl Frame {
    /// The stool turned by `angle` 65,536ths of a turn, counter-clockwise as seen from above.
    #[must_use]
    pub fn new(angle: u16, n: usize) -> Self {
        let radians = f32::from(angle) * (core::f32::consts::TAU / 65_536.0);
        Frame { turn: Quat::from_rotation_y(radians), voxel: BOX / n as f32, half: n as f32 / 2.0 }
    }

    /// Side of a voxel, in metres.
    #[must_use]
    pub const fn voxel(&self) -> f32 {
        self.voxel
    }

    /// A pose in the room, as one in the grid.
    #[must_use]
    pub fn to_grid(&self, position: Vec3, rotation: Quat) -> Pose {
        let back = self.turn.conjugate();
        let from_foot = back * (position - STOOL) / self.voxel;
        Pose {
            position: from_foot + Vec3::new(self.half, 0.0, self.half),
            rotation: (back * rotation).normalize(),
        }
    }

    /// A pose in the grid, as one in the room: metres and rotation.
    #[must_use]
    pub fn to_room(&self, pose: &Pose) -> (Vec3, Quat) {
        let from_foot = (pose.position - Vec3::new(self.half, 0.0, self.half)) * self.voxel;
        (self.turn * from_foot + STOOL, (self.turn * pose.rotation).normalize())
    }
}
