//! Smooth solids whose surface and normal are known, to voxelise.

use glam::{Quat, Vec3};

use super::dense::Dense;

/// A solid in a place, in voxels.
#[derive(Clone, Copy, Debug)]
pub struct Solid {
    /// What it is.
    pub shape: Shape,
    /// Its middle.
    pub middle: Vec3,
    /// How it is turned.
    pub turn: Quat,
}

/// A solid about the origin.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// All around the same.
    Sphere {
        /// From the middle to the surface.
        radius: f32,
    },
    /// A ring about y.
    Torus {
        /// From the middle to the middle of the tube.
        ring: f32,
        /// From there to the surface.
        tube: f32,
    },
    /// A box with round edges.
    Rounded {
        /// From the middle to the faces.
        half: Vec3,
        /// Of the edges.
        radius: f32,
    },
}

impl Solid {
    /// Signed distance of a point to the surface, negative inside.
    pub fn distance(&self, point: Vec3) -> f32 {
        self.shape.gap(self.turn.inverse() * (point - self.middle)).0
    }

    /// The outward unit normal at the surface's place nearest to a point.
    pub fn normal(&self, point: Vec3) -> Vec3 {
        self.turn * self.shape.gap(self.turn.inverse() * (point - self.middle)).1
    }

    /// The voxels whose centres lie inside.
    pub fn voxels(&self, n: usize) -> Dense {
        Dense::from_fn(n, |voxel| {
            self.distance(Vec3::from_array(voxel.map(|c| c as f32 + 0.5))) <= 0.0
        })
    }
}

impl Shape {
    fn gap(self, point: Vec3) -> (f32, Vec3) {
        match self {
            Shape::Sphere { radius } => (point.length() - radius, point.normalize()),
            Shape::Torus { ring, tube } => {
                let flat = Vec3::new(point.x, 0.0, point.z);
                let from = point - flat.normalize() * ring;
                (from.length() - tube, from.normalize())
            }
            Shape::Rounded { half, radius } => {
                let over = point.abs() - (half - radius);
                let outside = over.max(Vec3::ZERO);
                if outside != Vec3::ZERO {
                    let away = outside.normalize() * point.signum();
                    return (outside.length() - radius, away);
                }
                let axis = if over.x >= over.y && over.x >= over.z {
                    Vec3::X
                } else if over.y >= over.z {
                    Vec3::Y
                } else {
                    Vec3::Z
                };
                (over.max_element() - radius, axis * point.signum())
            }
        }
    }
}
