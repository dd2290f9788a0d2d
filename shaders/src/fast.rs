//! The fast path: the smooth surface where the blurred volume is half full, its normal, its light.
//!
//! Beyond the paper, whose blobs know seven voxels, and show them. The twin of `wgsl/fast.wgsl`;
//! beams of rays, by which the GPU finds where a ray may start, are left out: a ray starts at the
//! box here.

use glam::Vec3;

use crate::constants::{
    FAST_FAR_OPEN, FAST_OPEN, FAST_SEEN, FAST_SHADOW, FAST_STEP, FAST_THIN, MARBLE_GREY,
    MARBLE_WHITE,
};
use crate::field::{Field, PAD};
use crate::marble;
use crate::march::{Ray, inside_cube};
use crate::surface::Surface;

/// Where a ray in voxels first meets the half-full surface. It may lie up to a voxel outside of
/// the grid, but not under the ground.
#[must_use]
pub fn surface<const N: usize>(field: &Field<N>, ray: &Ray) -> Option<Surface> {
    let side = N as f32 + 2.0;
    let around = Ray { origin: ray.origin + Vec3::ONE, ..*ray };
    let (near, far) = inside_cube(&around, side)?;
    // The ground ends a ray.
    let ground = if ray.direction.y < 0.0 { -ray.origin.y / ray.direction.y } else { far };
    let met = march(field, ray, near, far.min(ground))?;
    Some(meet(field, ray, &met))
}

/// The radiance of a point of the surface over that of white in full light, before a display's
/// curve: marble under a sun and an ambient light, given in directions of the grid.
#[must_use]
pub fn lit<const N: usize>(
    field: &Field<N>,
    at: &Surface,
    (sun, sun_color): (Vec3, Vec3),
    ambient: Vec3,
) -> Vec3 {
    let scale = N as f32 / 128.0;
    let facing = at.normal.dot(sun);
    let direct = if facing > 0.0 {
        sun_color * (facing * visibility(field, at.position, sun, scale))
    } else {
        let through = at.position + (sun * 3.0 - at.normal) * scale;
        sun_color * Vec3::from_array(FAST_THIN) * ((1.0 - field.sample(1, through)) * -facing)
    };
    let above = field.sample(2, at.position + at.normal * (FAST_FAR_OPEN * scale));
    let open = FAST_OPEN - FAST_OPEN * above.min(0.9);
    let grey = marble::sample(at.position / N as f32);
    let stone = Vec3::from_array(MARBLE_WHITE).lerp(Vec3::from_array(MARBLE_GREY), grey);
    stone * (direct + ambient * open)
}

/// Where a march ended: at the first sample inside.
struct Met {
    /// Its distance.
    t: f32,
    /// Its density.
    full: f32,
    /// How far the step to it reached.
    reach: f32,
}

fn march<const N: usize>(field: &Field<N>, ray: &Ray, near: f32, end: f32) -> Option<Met> {
    let (mut t, mut reach) = (near, step(0.0));
    // A ray from so far that a step is less than its last digit goes nowhere.
    let mut turns = 8 * N;
    while t < end && turns > 0 {
        // Near the surface.
        let mut left = 8.0;
        while left > 0.0 && turns > 0 {
            let full = field.sample(0, ray.at(t));
            if full >= 0.5 {
                return (t < end).then_some(Met { t, full, reach });
            }
            reach = step(full);
            t += reach;
            left -= reach;
            turns -= 1;
        }
        // Empty cells.
        while t < end && turns > 0 {
            let free = field.free(ray.at(t));
            if free == 0.0 {
                break;
            }
            t += free;
            turns -= 1;
        }
        turns = turns.saturating_sub(1);
    }
    None
}

/// A step in voxels reaches a little past where a plane would be met: what is one voxel thick is
/// not leapt over.
fn step(full: f32) -> f32 {
    let [[a, b], [c, d]] = FAST_STEP;
    (a - b * full).max(c - d * full)
}

/// The density from which a step reached so far.
fn before(reach: f32) -> f32 {
    let [[a, b], [c, d]] = FAST_STEP;
    ((a - reach) / b).max((c - reach) / d)
}

/// From a point inside back to where the density is a half, by the profile of a plane's edge.
fn meet<const N: usize>(field: &Field<N>, ray: &Ray, met: &Met) -> Surface {
    // What the blur makes of a distance, undone but for a factor.
    let apart = |above: f32| above + 2.0 * above * above * above;
    let (inside, outside) = (apart(met.full - 0.5), apart(0.5 - before(met.reach)));
    let distance = met.t - met.reach * inside / (inside + outside);
    let position = ray.at(distance);
    let normal = fall(field, position).try_normalize().unwrap_or(Vec3::Y);
    Surface { position, normal, distance }
}

/// How the blurred density falls, 4 times a voxel's worth: samples on a tetrahedron's corners.
fn fall<const N: usize>(field: &Field<N>, point: Vec3) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for (y, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let corner = Vec3::new(y * z, y, z);
        sum -= corner * field.sample(1, point + corner);
    }
    sum
}

/// Three samples towards the sun, blurred as they are far.
fn visibility<const N: usize>(field: &Field<N>, point: Vec3, sun: Vec3, scale: f32) -> f32 {
    let [mut far, grows] = FAST_SHADOW;
    let mut seen = 1.0;
    for level in 1..4 {
        seen -= seen * FAST_SEEN * field.sample(level, point + sun * (far * scale));
        far *= grows;
    }
    seen
}

const _: () = assert!(PAD >= 1, "a ray's first and last voxel lie outside of the grid");
