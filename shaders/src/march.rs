//! Steps along a ray, one for each voxel layer of its dominant axis, through the range maps.
//!
//! Source: section 4.1 of the paper.

use glam::Vec3;
use paros_core::maps::{Axis, Maps};

/// A half-line. `direction` has unit length.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ray {
    /// Where it starts.
    pub origin: Vec3,
    /// Where it goes.
    pub direction: Vec3,
}

impl Ray {
    /// The point at a distance from the origin.
    #[must_use]
    #[inline]
    pub fn at(&self, distance: f32) -> Vec3 {
        self.origin + self.direction * distance
    }
}

/// The first occupied sample on a ray.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Sample {
    /// The voxel it lies in.
    pub voxel: [usize; 3],
    /// Its distance from the ray's origin, in voxels.
    pub distance: f32,
}

/// The first occupied sample of a ray given in voxels, stepping from layer centre to layer centre
/// of the ray's dominant axis: at most N steps, and none outside the cube.
///
/// A step looks at the dominant axis's map alone, and at the other two only where that one holds
/// the sample. With `full` every step looks at all three, for comparison; the answer is the same.
#[must_use]
pub fn march<const N: usize>(maps: &Maps<N>, ray: &Ray, full: bool) -> Option<Sample> {
    let span = inside_cube(ray, N as f32)?;
    match dominant(ray.direction) {
        Axis::X => march_along::<N, 0>(maps, ray, span, full),
        Axis::Y => march_along::<N, 1>(maps, ray, span, full),
        Axis::Z => march_along::<N, 2>(maps, ray, span, full),
    }
}

/// The distances at which a ray enters and leaves the cube of side `n` at the origin, the first
/// one not behind the ray's origin. `None` if it misses.
#[must_use]
pub fn inside_cube(ray: &Ray, n: f32) -> Option<(f32, f32)> {
    let (mut near, mut far) = (0.0f32, f32::INFINITY);
    for axis in 0..3 {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        if direction == 0.0 {
            if !(0.0..n).contains(&origin) {
                return None;
            }
        } else {
            let (a, b) = (-origin / direction, (n - origin) / direction);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
    }
    (near < far).then_some((near, far))
}

/// Whether the voxel that holds a point is occupied; outside the cube is empty.
#[must_use]
#[inline]
pub fn occupied<const N: usize>(maps: &Maps<N>, point: Vec3) -> bool {
    let inside = |c: f32| c >= 0.0 && c < N as f32;
    inside(point.x)
        && inside(point.y)
        && inside(point.z)
        && maps.contains([point.x as usize, point.y as usize, point.z as usize])
}

/// The axis most parallel to a direction; the earlier one of equals.
#[must_use]
pub fn dominant(direction: Vec3) -> Axis {
    let size = direction.abs();
    if size.x >= size.y && size.x >= size.z {
        Axis::X
    } else if size.y >= size.z {
        Axis::Y
    } else {
        Axis::Z
    }
}

fn march_along<const N: usize, const AXIS: usize>(
    maps: &Maps<N>,
    ray: &Ray,
    (near, far): (f32, f32),
    full: bool,
) -> Option<Sample> {
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
    // Voxels in fixed point, as the shader steps, so that both look at the same ones.
    let fixed = |c: f32| (c * ONE) as i32;
    let mut place = ray.at(distance).to_array().map(|c| fixed(c + 1.0));
    let slide = (ray.direction * each).to_array().map(fixed);
    let steps = ((far - distance) / each).ceil().clamp(0.0, N as f32) as usize;
    for i in 0..steps {
        if !(0..N as isize).contains(&layer) {
            break;
        }
        let mut voxel = place.map(|c| (c >> BITS) - 1);
        voxel[AXIS] = layer as i32;
        // A last digit may carry a place out of the grid, where all is empty.
        if voxel.iter().all(|&c| (0..N as i32).contains(&c)) {
            let voxel = voxel.map(|c| c as usize);
            let hit = if full {
                maps.contains(voxel)
            } else {
                maps.column(axis, axis.address(voxel)).contains(voxel[AXIS])
                    && others_hold::<N, AXIS>(maps, voxel)
            };
            if hit {
                return Some(Sample { voxel, distance: distance + each * i as f32 });
            }
        }
        for (place, slide) in place.iter_mut().zip(slide) {
            *place = place.wrapping_add(slide);
        }
        layer += step;
    }
    None
}

/// A voxel in fixed point, and the bits of its fraction.
const ONE: f32 = 65536.0;
const BITS: u32 = 16;

#[inline]
fn others_hold<const N: usize, const AXIS: usize>(maps: &Maps<N>, voxel: [usize; 3]) -> bool {
    [Axis::ALL[(AXIS + 1) % 3], Axis::ALL[(AXIS + 2) % 3]]
        .iter()
        .all(|&axis| maps.column(axis, axis.address(voxel)).contains(voxel[axis as usize]))
}
