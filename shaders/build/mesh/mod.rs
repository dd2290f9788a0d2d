//! The studio's things as triangles: shapes, the things made of them, and the light that falls there.

pub(crate) mod bits;
pub(crate) mod bvh;
mod decor;
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
    /// In metres.
    pub(crate) position: Vec3,
    /// Unit, outward.
    pub(crate) normal: Vec3,
    /// Linear reflectance.
    pub(crate) colour: Vec3,
    /// The part of the ambient light that arrives.
    pub(crate) open: f32,
}

/// Triangles over corners, counter-clockwise as seen from outside.
#[derive(Clone, Default)]
pub(crate) struct Mesh {
    pub(crate) corners: Vec<Corner>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Adds a corner and gives its number.
    pub(crate) fn corner(&mut self, position: Vec3, normal: Vec3, colour: Vec3) -> u32 {
        self.corners.push(Corner { position, normal, colour, open: 1.0 });
        self.corners.len() as u32 - 1
    }

    /// Two triangles; corners that coincide leave one out.
    pub(crate) fn quad(&mut self, [a, b, c, d]: [u32; 4]) {
        for triangle in [[a, b, c], [a, c, d]] {
            let [p, q, r] = triangle.map(|i| self.corners[i as usize].position);
            if (q - p).cross(r - p).length() > 1e-12 {
                self.triangles.push(triangle);
            }
        }
    }

    /// Adds another mesh, moved. A mirror image is turned right side out.
    pub(crate) fn add(&mut self, other: &Mesh, at: Affine3A) {
        let first = self.corners.len() as u32;
        let normals = at.matrix3.inverse().transpose();
        self.corners.extend(other.corners.iter().map(|corner| Corner {
            position: at.transform_point3(corner.position),
            normal: (normals * corner.normal).normalize(),
            ..*corner
        }));
        let mirrored = at.matrix3.determinant() < 0.0;
        self.triangles.extend(other.triangles.iter().map(|[a, b, c]| {
            let [b, c] = if mirrored { [c, b] } else { [b, c] };
            [a, b, c].map(|i| i + first)
        }));
    }

    /// The mesh, moved.
    pub(crate) fn moved(&self, at: Affine3A) -> Mesh {
        let mut moved = Mesh::default();
        moved.add(self, at);
        moved
    }

    /// The positions of a triangle's corners.
    pub(crate) fn positions(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|i| self.corners[i as usize].position)
    }
}

/// A shift.
pub(crate) fn to(x: f32, y: f32, z: f32) -> Affine3A {
    Affine3A::from_translation(Vec3::new(x, y, z))
}
