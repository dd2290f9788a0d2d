//! The studio's things as triangles: shapes, the things made of them, and the light that falls on them.

pub(crate) mod bits;
mod decor;
pub(crate) mod extent;
pub(crate) mod furniture;
pub(crate) mod hands;
pub(crate) mod light;
pub(crate) mod paint;
pub(crate) mod room;
pub(crate) mod shapes;
pub(crate) mod tools;

use glam::{Affine3A, Vec3};

/// A corner of a triangle while meshes are made.
#[derive(Clone, Copy)]
pub(crate) struct Corner {
    /// Position, in metres.
    pub(crate) position: Vec3,
    /// Unit outward normal.
    pub(crate) normal: Vec3,
    /// Linear reflectance.
    pub(crate) colour: Vec3,
    /// Openness: the part of the ambient light that arrives, 0 to 1.
    pub(crate) openness: f32,
}

/// An indexed triangle mesh while it is built; triangles wind counter-clockwise as seen from outside.
#[derive(Clone, Default)]
pub(crate) struct MeshBuilder {
    pub(crate) corners: Vec<Corner>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl MeshBuilder {
    /// Adds a corner, of openness 1, and returns its index.
    pub(crate) fn add_corner(&mut self, position: Vec3, normal: Vec3, colour: Vec3) -> u32 {
        self.corners.push(Corner { position, normal, colour, openness: 1.0 });
        self.corners.len() as u32 - 1
    }

    /// Adds a quadrilateral as two triangles; leaves out a triangle of no area.
    pub(crate) fn add_quad(&mut self, [a, b, c, d]: [u32; 4]) {
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|i| self.corners[i as usize].position);
            if (q - p).cross(r - p).length() > 1e-12 {
                self.triangles.push(triangle);
            }
        }
    }

    /// Appends a copy of another mesh, transformed. A mirroring transform reverses the winding.
    pub(crate) fn append(&mut self, other: &MeshBuilder, transform: Affine3A) {
        let first = self.corners.len() as u32;
        let normals = transform.matrix3.inverse().transpose();
        self.corners.extend(other.corners.iter().map(|corner| Corner {
            position: transform.transform_point3(corner.position),
            normal: (normals * corner.normal).normalize(),
            ..*corner
        }));
        let mirrored = transform.matrix3.determinant() < 0.0;
        self.triangles.extend(other.triangles.iter().map(|[a, b, c]| {
            let [b, c] = if mirrored { [c, b] } else { [b, c] };
            [a, b, c].map(|i| i + first)
        }));
    }

    /// Returns a transformed copy.
    pub(crate) fn transformed(&self, transform: Affine3A) -> MeshBuilder {
        let mut moved = MeshBuilder::default();
        moved.append(self, transform);
        moved
    }

    /// Returns the positions of a triangle's corners.
    pub(crate) fn corner_positions(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|i| self.corners[i as usize].position)
    }
}

/// Returns a translation, in metres.
pub(crate) fn translation(x: f32, y: f32, z: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z))
}
