//! Ray marching of the range maps: one step for each voxel layer of the ray's dominant axis.
//!
//! Source: section 4.1 of the paper.

use glam::Vec3;
use paros_core::RangeMaps;
use paros_core::volume::Axis;

use crate::constants::MARCH_FRACTION_BITS;

/// A half-line. `direction` has unit length.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ray {
    /// The start.
    pub origin: Vec3,
    /// The direction, of unit length.
    pub direction: Vec3,
}

impl Ray {
    /// Returns the point at a distance from the origin.
    #[must_use]
    #[inline]
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }
}

/// The first occupied sample on a ray.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct VoxelHit {
    /// The voxel that the sample lies in.
    pub voxel: [usize; 3],
    /// The sample's distance from the ray's origin, in voxels.
    pub distance: f32,
}

/// A part of a ray, by distances from its origin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RaySpan {
    /// The distance of its start; at least 0.
    pub near: f32,
    /// The distance of its end.
    pub far: f32,
}

/// The maps that a step of a march reads; the result is the same.
#[derive(Clone, Copy)]
enum MapReadOrder {
    /// The dominant axis's map, and the other two only if that map holds the sample.
    DominantFirst,
    /// All three.
    AllThree,
}

/// Returns the first occupied sample of a ray given in voxels, stepping from layer centre to layer centre
/// of the ray's dominant axis: at most N steps, and none outside the cube.
///
/// A step reads the dominant axis's map, and the other two only if that map holds the sample.
#[must_use]
pub fn march_maps<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    grid_ray: &Ray,
) -> Option<VoxelHit> {
    march_reading(maps, grid_ray, MapReadOrder::DominantFirst)
}

/// Does the same as [`march_maps`], but every step reads all three maps, for comparison. The result is the
/// same.
#[must_use]
pub fn march_all_maps<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    grid_ray: &Ray,
) -> Option<VoxelHit> {
    march_reading(maps, grid_ray, MapReadOrder::AllThree)
}

fn march_reading<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    ray: &Ray,
    read_order: MapReadOrder,
) -> Option<VoxelHit> {
    let span = clip_to_cube(ray, N as f32)?;
    match dominant_axis(ray.direction) {
        Axis::X => first_sample_hit_along_axis::<N, K, 0>(maps, ray, span, read_order),
        Axis::Y => first_sample_hit_along_axis::<N, K, 1>(maps, ray, span, read_order),
        Axis::Z => first_sample_hit_along_axis::<N, K, 2>(maps, ray, span, read_order),
    }
}

/// Slab test: returns the part of a ray in the cube from the origin to `side` along each axis; `None` if
/// the ray misses.
#[must_use]
pub fn clip_to_cube(ray: &Ray, side: f32) -> Option<RaySpan> {
    let (mut near, mut far) = (0.0f32, f32::INFINITY);
    for axis in 0..3 {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        if direction == 0.0 {
            if !(0.0..side).contains(&origin) {
                return None;
            }
        } else {
            let (a, b) = (-origin / direction, (side - origin) / direction);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
    }
    (near < far).then_some(RaySpan { near, far })
}

/// Returns `true` if the voxel that holds a point is occupied. Outside the cube all is empty.
#[must_use]
#[inline]
pub fn is_point_occupied<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    grid_point: Vec3,
) -> bool {
    let inside = |c: f32| c >= 0.0 && c < N as f32;
    inside(grid_point.x)
        && inside(grid_point.y)
        && inside(grid_point.z)
        && maps.contains([grid_point.x as usize, grid_point.y as usize, grid_point.z as usize])
}

/// Returns the axis most parallel to a direction; of equal axes the earlier one.
#[must_use]
pub fn dominant_axis(direction: Vec3) -> Axis {
    let size = direction.abs();
    if size.x >= size.y && size.x >= size.z {
        Axis::X
    } else if size.y >= size.z {
        Axis::Y
    } else {
        Axis::Z
    }
}

fn first_sample_hit_along_axis<const N: usize, const K: usize, const AXIS: usize>(
    maps: &RangeMaps<N, K>,
    ray: &Ray,
    RaySpan { near, far }: RaySpan,
    read_order: MapReadOrder,
) -> Option<VoxelHit> {
    let axis = Axis::ALL[AXIS];
    let towards = ray.direction[AXIS];
    let each = 1.0 / towards.abs();
    let first = (ray.at(near)[AXIS] as usize).min(N - 1);
    let mut distance = (first as f32 + 0.5 - ray.origin[AXIS]) / towards;
    let mut layer = first as isize;
    let step = if towards > 0.0 { 1 } else { -1 };
    if distance < near {
        layer += step;
        distance += each;
    }
    // Steps in fixed point, as the shader does, so that both look at the same voxels.
    let fixed = |c: f32| (c * ONE_VOXEL) as i32;
    let mut place = ray.at(distance).to_array().map(|c| fixed(c + 1.0));
    let slide = (ray.direction * each).to_array().map(fixed);
    let steps = ((far - distance) / each).ceil().clamp(0.0, N as f32) as usize;
    for i in 0..steps {
        if !(0..N as isize).contains(&layer) {
            break;
        }
        let mut voxel = place.map(|c| (c >> MARCH_FRACTION_BITS) - 1);
        voxel[AXIS] = layer as i32;
        // Rounding may carry a position out of the grid, where all is empty.
        if voxel.iter().all(|&c| (0..N as i32).contains(&c)) {
            let voxel = voxel.map(|c| c as usize);
            let hit = match read_order {
                MapReadOrder::AllThree => maps.contains(voxel),
                MapReadOrder::DominantFirst => {
                    maps.column(axis, axis.column_address(voxel)).contains(voxel[AXIS])
                        && other_maps_hold::<N, K, AXIS>(maps, voxel)
                }
            };
            if hit {
                return Some(VoxelHit { voxel, distance: distance + each * i as f32 });
            }
        }
        for (place, slide) in place.iter_mut().zip(slide) {
            *place = place.wrapping_add(slide);
        }
        layer += step;
    }
    None
}

/// One voxel in fixed point.
const ONE_VOXEL: f32 = (1 << MARCH_FRACTION_BITS) as f32;

#[inline]
fn other_maps_hold<const N: usize, const K: usize, const AXIS: usize>(
    maps: &RangeMaps<N, K>,
    voxel: [usize; 3],
) -> bool {
    [Axis::ALL[(AXIS + 1) % 3], Axis::ALL[(AXIS + 2) % 3]]
        .iter()
        .all(|&axis| maps.column(axis, axis.column_address(voxel)).contains(voxel[axis as usize]))
}
