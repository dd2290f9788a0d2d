//! The paper's surface around a hit voxel: a smooth union of blobs, sphere traced, and its normal.
//!
//! Source: section 4.2 of the paper, after Hart (1995) and Shepard (1968).

use glam::Vec3;
use paros_core::RangeMaps;

use super::march::{Ray, VoxelHit};
use crate::constants::{
    BLOB_BLEND_WIDTH, BLOB_HIT_DISTANCE, BLOB_MAX_STEPS, BLOB_RADIUS, BLOB_START_BACK,
};

/// A point to be shaded.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SurfacePoint {
    /// Position, in voxels.
    pub position: Vec3,
    /// The outward unit normal.
    pub normal: Vec3,
    /// Distance from the ray's origin, in voxels.
    pub distance: f32,
}

/// Sphere traces the blobs around a hit voxel, from half a voxel before the sample. If the ray misses the
/// blobs, takes its closest approach. The normal is that of equation 1.
#[must_use]
pub fn trace_blobs_or_closest_approach<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    grid_ray: &Ray,
    hit: &VoxelHit,
) -> SurfacePoint {
    let neighbours = Neighbours::around_voxel(maps, hit.voxel);
    let centre = voxel_centre(hit.voxel);
    let mut distance = hit.distance - BLOB_START_BACK;
    let (mut closest, mut closest_gap) = (distance, f32::INFINITY);
    for _ in 0..BLOB_MAX_STEPS {
        let gap = neighbours.blob_distance(grid_ray.at(distance) - centre);
        if gap.abs() < closest_gap {
            (closest, closest_gap) = (distance, gap.abs());
        }
        if closest_gap < BLOB_HIT_DISTANCE {
            break;
        }
        distance += gap;
    }
    let position = grid_ray.at(closest);
    SurfacePoint {
        position,
        normal: neighbours.shepard_normal(position - centre),
        distance: closest,
    }
}

/// Returns the point where a ray enters the hit voxel, with the normal of that face, for pictures without
/// blobs.
#[must_use]
pub fn entry_face_point(grid_ray: &Ray, hit: &VoxelHit) -> SurfacePoint {
    let centre = voxel_centre(hit.voxel);
    let (mut distance, mut axis) = (f32::NEG_INFINITY, 0);
    for i in 0..3 {
        let towards = grid_ray.direction[i];
        if towards != 0.0 {
            let entry = (centre[i] - 0.5 * towards.signum() - grid_ray.origin[i]) / towards;
            if entry > distance {
                (distance, axis) = (entry, i);
            }
        }
    }
    let mut normal = Vec3::ZERO;
    normal[axis] = -grid_ray.direction[axis].signum();
    SurfacePoint { position: grid_ray.at(distance), normal, distance }
}

/// Occupancy of a voxel's six neighbours: -x, +x, -y, +y, -z, +z.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Neighbours(pub [bool; 6]);

impl Neighbours {
    /// Returns the neighbours of a voxel; outside the cube all is empty.
    #[must_use]
    pub fn around_voxel<const N: usize, const K: usize>(
        maps: &RangeMaps<N, K>,
        voxel: [usize; 3],
    ) -> Self {
        let mut occupied = [false; 6];
        for (i, occupied) in occupied.iter_mut().enumerate() {
            let mut at = voxel;
            let (c, up) = (&mut at[i / 2], i % 2 == 1);
            *c = if up { *c + 1 } else { c.wrapping_sub(1) };
            *occupied = *c < N && maps.contains(at);
        }
        Neighbours(occupied)
    }

    /// Returns the signed distance from a point, given from the hit voxel's centre, to the smooth union of
    /// the blobs of that voxel and its occupied neighbours, in voxels.
    #[must_use]
    pub fn blob_distance(&self, from_voxel_centre: Vec3) -> f32 {
        let point = from_voxel_centre;
        let square = point.length_squared();
        let weight = |square: f32| ((BLOB_RADIUS - square.sqrt()) / BLOB_BLEND_WIDTH).exp();
        let mut sum = weight(square);
        for i in 0..6 {
            if self.0[i] {
                sum +=
                    weight((square + 1.0 - 2.0 * component_towards_neighbour(point, i)).max(0.0));
            }
        }
        -BLOB_BLEND_WIDTH * sum.ln()
    }

    /// Returns the unit normal of equation 1 (Shepard 1968): the directions from the occupied neighbours to
    /// a point, given from the hit voxel's centre, weighted by inverse square distance. A voxel without
    /// neighbours is a ball.
    #[must_use]
    pub fn shepard_normal(&self, from_voxel_centre: Vec3) -> Vec3 {
        let point = from_voxel_centre;
        let mut sum = Vec3::ZERO;
        for i in 0..6 {
            if self.0[i] {
                let from = point - neighbour_offset(i);
                sum += from / from.length_squared().max(1e-6);
            }
        }
        sum.try_normalize().or_else(|| point.try_normalize()).unwrap_or(Vec3::Y)
    }
}

fn voxel_centre(voxel: [usize; 3]) -> Vec3 {
    Vec3::from_array(voxel.map(|c| c as f32 + 0.5))
}

/// Returns a vector's component in the direction of a neighbour, one of the six.
fn component_towards_neighbour(vector: Vec3, neighbour: usize) -> f32 {
    if neighbour % 2 == 1 { vector[neighbour / 2] } else { -vector[neighbour / 2] }
}

/// Returns the unit step to a neighbour, one of the six.
fn neighbour_offset(neighbour: usize) -> Vec3 {
    let mut offset = Vec3::ZERO;
    offset[neighbour / 2] = if neighbour % 2 == 1 { 1.0 } else { -1.0 };
    offset
}
