//! Analytic solids with signed distance functions, whose surface and normal are known exactly.

use glam::{Quat, Vec3};

use crate::dense::DenseVolume;

/// A solid at a pose, in voxels.
#[derive(Clone, Copy, Debug)]
pub struct Solid {
    /// The shape, centred at the origin.
    pub shape: SolidShape,
    /// The position of its centre.
    pub centre: Vec3,
    /// Its rotation.
    pub rotation: Quat,
}

/// The shape of a solid, centred at the origin; all lengths are in voxels.
#[derive(Clone, Copy, Debug)]
pub enum SolidShape {
    /// A sphere.
    Sphere {
        /// The radius.
        radius: f32,
    },
    /// A torus about the y axis.
    Torus {
        /// The major radius, from the centre to the tube's centre line.
        ring: f32,
        /// The minor radius, of the tube.
        tube: f32,
    },
    /// A box with rounded edges.
    Rounded {
        /// The half extents.
        half: Vec3,
        /// The radius of the edges.
        radius: f32,
    },
}

/// The nearest point of a surface, as seen from a point.
struct SurfaceProjection {
    /// The signed distance, negative inside.
    signed_distance: f32,
    /// The outward unit normal at the nearest point.
    normal: Vec3,
}

impl Solid {
    /// Returns the signed distance of a point to the surface, negative inside.
    pub fn signed_distance(&self, point: Vec3) -> f32 {
        self.shape
            .nearest_on_surface(self.rotation.inverse() * (point - self.centre))
            .signed_distance
    }

    /// Returns the outward unit normal at the point of the surface nearest to `point`.
    pub fn nearest_normal(&self, point: Vec3) -> Vec3 {
        self.rotation
            * self.shape.nearest_on_surface(self.rotation.inverse() * (point - self.centre)).normal
    }

    /// Returns the voxels whose centres lie inside.
    pub fn to_voxels(&self, n: usize) -> DenseVolume {
        DenseVolume::from_fn(n, |voxel| {
            self.signed_distance(Vec3::from_array(voxel.map(|c| c as f32 + 0.5))) <= 0.0
        })
    }
}

impl SolidShape {
    /// Returns the signed distance of a point, and the outward normal at the nearest point of the surface.
    fn nearest_on_surface(self, point: Vec3) -> SurfaceProjection {
        let found = |signed_distance, normal| SurfaceProjection { signed_distance, normal };
        match self {
            SolidShape::Sphere { radius } => found(point.length() - radius, point.normalize()),
            SolidShape::Torus { ring, tube } => {
                let flat = Vec3::new(point.x, 0.0, point.z);
                let from = point - flat.normalize() * ring;
                found(from.length() - tube, from.normalize())
            }
            SolidShape::Rounded { half, radius } => {
                let over = point.abs() - (half - radius);
                let outside = over.max(Vec3::ZERO);
                if outside != Vec3::ZERO {
                    let away = outside.normalize() * point.signum();
                    return found(outside.length() - radius, away);
                }
                let axis = if over.x >= over.y && over.x >= over.z {
                    Vec3::X
                } else if over.y >= over.z {
                    Vec3::Y
                } else {
                    Vec3::Z
                };
                found(over.max_element() - radius, axis * point.signum())
            }
        }
    }
}
