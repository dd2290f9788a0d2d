//! The fast path: ray marching of the blurred density to its level set of a half, gradient normal,
//! shading. The twin of `wgsl/fast.wgsl`.
//!
//! Not in the paper, whose blobs depend on seven voxels and so look like voxels. The GPU's cone
//! marching, which finds where a ray may start, is left out: rays start at the grid's box here.

use glam::Vec3;

use super::marble;
use super::march::{Ray, clip_to_cube};
use super::surface::SurfacePoint;
use crate::constants::{
    FAST_AO_HEIGHT, FAST_AO_MAX_DENSITY, FAST_AO_SCALE, FAST_EDGE_CUBIC, FAST_REFERENCE_SIDE,
    FAST_SHADOW_OPACITY, FAST_SHADOW_SPACING, FAST_SKIP_INTERVAL, FAST_STEP_FAR, FAST_STEP_NEAR,
    FAST_TRANSLUCENCY, FAST_TRANSLUCENCY_DEPTH, MARBLE_BASE_COLOR, MARBLE_VEIN_COLOR,
};
use crate::field::{DensityField, LEVELS, PAD};

/// Where a ray in voxels first meets the surface, the level set of a half. It may lie up to a voxel
/// outside of the grid, but not under the ground.
#[must_use]
pub fn find_surface<const N: usize>(field: &DensityField<N>, ray: &Ray) -> Option<SurfacePoint> {
    let side = N as f32 + 2.0;
    let around = Ray { origin: ray.origin + Vec3::ONE, ..*ray };
    let (near, far) = clip_to_cube(&around, side)?;
    // The ground ends a ray.
    let ground = if ray.direction.y < 0.0 { -ray.origin.y / ray.direction.y } else { far };
    let met = march_density(field, ray, near, far.min(ground))?;
    Some(refine_hit(field, ray, &met))
}

/// The linear radiance of a surface point, before tone mapping: Lambertian marble under a sun, as
/// its direction in the grid and its irradiance over pi, and an ambient irradiance over pi.
#[must_use]
pub fn shade_surface<const N: usize>(
    field: &DensityField<N>,
    at: &SurfacePoint,
    (sun, sun_color): (Vec3, Vec3),
    ambient_over_pi: Vec3,
) -> Vec3 {
    let scale = N as f32 / FAST_REFERENCE_SIDE;
    let facing = at.normal.dot(sun);
    let direct = if facing > 0.0 {
        sun_color * (facing * sun_visibility(field, at.position, sun, scale))
    } else {
        let through = at.position + (sun * FAST_TRANSLUCENCY_DEPTH - at.normal) * scale;
        sun_color
            * Vec3::from_array(FAST_TRANSLUCENCY)
            * ((1.0 - field.sample_density(1, through)) * -facing)
    };
    let above = field.sample_density(2, at.position + at.normal * (FAST_AO_HEIGHT * scale));
    let open = FAST_AO_SCALE - FAST_AO_SCALE * above.min(FAST_AO_MAX_DENSITY);
    let grey = marble::sample_grey(at.position / N as f32);
    let stone = Vec3::from_array(MARBLE_BASE_COLOR).lerp(Vec3::from_array(MARBLE_VEIN_COLOR), grey);
    stone * (direct + ambient_over_pi * open)
}

/// The end of a march: the first sample of density a half or more.
struct DensityHit {
    /// Its distance from the ray's origin, in voxels.
    t: f32,
    /// Its density.
    full: f32,
    /// Length of the step to it, in voxels.
    reach: f32,
}

fn march_density<const N: usize>(
    field: &DensityField<N>,
    ray: &Ray,
    near: f32,
    end: f32,
) -> Option<DensityHit> {
    let (mut t, mut reach) = (near, step_length(0.0));
    // From an origin so far that a step is less than the distance's precision, `t` doesn't grow.
    let mut steps_left = 8 * N;
    while t < end && steps_left > 0 {
        // Steps by density.
        let mut left = FAST_SKIP_INTERVAL;
        while left > 0.0 && steps_left > 0 {
            let full = field.sample_density(0, ray.at(t));
            if full >= 0.5 {
                return (t < end).then_some(DensityHit { t, full, reach });
            }
            reach = step_length(full);
            t += reach;
            left -= reach;
            steps_left -= 1;
        }
        // Empty-space skipping.
        while t < end && steps_left > 0 {
            let free = field.free_distance_voxels(ray.at(t));
            if free == 0.0 {
                break;
            }
            t += free;
            steps_left -= 1;
        }
        steps_left = steps_left.saturating_sub(1);
    }
    None
}

/// The march's step at a density, in voxels. It ends a little behind a plane of that density, yet a
/// wall one voxel thick can't be stepped over.
fn step_length(full: f32) -> f32 {
    let ([a, b], [c, d]) = (FAST_STEP_FAR, FAST_STEP_NEAR);
    (a - b * full).max(c - d * full)
}

/// The density at which a step is so long: [`step_length`] inverted.
fn density_before_step(reach: f32) -> f32 {
    let ([a, b], [c, d]) = (FAST_STEP_FAR, FAST_STEP_NEAR);
    ((a - reach) / b).max((c - reach) / d)
}

/// Steps back from a sample inside to the level set, by linear interpolation between the last two
/// samples' distances to a plane.
fn refine_hit<const N: usize>(
    field: &DensityField<N>,
    ray: &Ray,
    met: &DensityHit,
) -> SurfacePoint {
    // Distance to a plane, up to a factor, from its blurred density less a half.
    let edge_distance = |excess: f32| excess + FAST_EDGE_CUBIC * excess * excess * excess;
    let (inside, outside) =
        (edge_distance(met.full - 0.5), edge_distance(0.5 - density_before_step(met.reach)));
    let distance = met.t - met.reach * inside / (inside + outside);
    let position = ray.at(distance);
    let normal = density_descent(field, position).try_normalize().unwrap_or(Vec3::Y);
    SurfacePoint { position, normal, distance }
}

/// The negative gradient of the density at mip level 1, times 4 voxels, from four samples at the
/// corners of a tetrahedron.
fn density_descent<const N: usize>(field: &DensityField<N>, point: Vec3) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for (y, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let corner = Vec3::new(y * z, y, z);
        sum -= corner * field.sample_density(1, point + corner);
    }
    sum
}

/// Soft shadow by cone tracing: three samples towards the sun, each farther and of a coarser mip
/// level. Visibility, 0 to 1.
fn sun_visibility<const N: usize>(
    field: &DensityField<N>,
    point: Vec3,
    sun: Vec3,
    scale: f32,
) -> f32 {
    let [mut far, grows] = FAST_SHADOW_SPACING;
    let mut seen = 1.0;
    for level in 1..LEVELS {
        seen -=
            seen * FAST_SHADOW_OPACITY * field.sample_density(level, point + sun * (far * scale));
        far *= grows;
    }
    seen
}

const _: () = assert!(PAD >= 1, "a ray's first and last voxel lie outside of the grid");
