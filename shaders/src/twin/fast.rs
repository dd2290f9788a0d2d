//! The fast path: ray marching of the blurred density to its level set of a half, gradient normal,
//! shading. The twin of `wgsl/fast.wgsl`.
//!
//! This path isn't in the paper, whose blobs depend on seven voxels and so look like voxels. The GPU's cone
//! marching, which finds where a ray may start, is left out: rays start at the grid's box here.

use glam::Vec3;

use super::carrara;
use super::march::{Ray, RaySpan, clip_to_cube};
use super::noise;
use super::surface::SurfacePoint;
use crate::constants::{
    CARRARA_BASE_COLOR, CARRARA_VEIN_COLOR, FAST_AO_HEIGHT, FAST_AO_LEAN, FAST_AO_MAX_DENSITY,
    FAST_AO_SCALE, FAST_CRYSTAL_NOISE, FAST_EDGE_CUBIC, FAST_GLOSS, FAST_GLOSS_SHARPNESS,
    FAST_REFERENCE_SIDE, FAST_ROUGHNESS, FAST_SHADOW_DISTANCE, FAST_SHADOW_OPACITY,
    FAST_SKIP_INTERVAL, FAST_SPARKLE, FAST_SPARKLE_RIM, FAST_STEP_FAR, FAST_STEP_NEAR,
    FAST_TRANSLUCENCY, FAST_TRANSLUCENCY_DEPTH, FAST_WEAR, FAST_WEAR_AT_EDGES, FIGURE_GLOW,
    FIGURE_LEAST_SHARE, FIGURE_SHARE_RISE, FIGURE_WARMTH, NOISE_CELLS,
};
use crate::field::{DensityField, LEVELS, PAD};

/// The number of texels that a ray fetches: the twin of [`Drawn::Counts`](crate::gpu::Drawn::Counts).
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct RayFetches {
    /// Texels for the march, one an iteration.
    pub march: u32,
    /// Texels for the surface and its light.
    pub shading: u32,
}

/// Finds the point where a ray in voxels first meets the surface, the level set of a half. The point may
/// lie up to a voxel outside of the grid, but not under the ground.
#[must_use]
pub fn find_surface<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    grid_ray: &Ray,
) -> Option<SurfacePoint> {
    find_surface_counting(field, grid_ray, &mut RayFetches::default())
}

/// Does the same as [`find_surface`], and counts the fetches. The ray starts at the grid's box, where the
/// GPU's starts at its beam's end.
#[must_use]
pub fn find_surface_counting<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    grid_ray: &Ray,
    fetches: &mut RayFetches,
) -> Option<SurfacePoint> {
    let side = N as f32 + 2.0;
    let around = Ray { origin: grid_ray.origin + Vec3::ONE, ..*grid_ray };
    let RaySpan { near, far } = clip_to_cube(&around, side)?;
    // The ground ends a ray.
    let ground =
        if grid_ray.direction.y < 0.0 { -grid_ray.origin.y / grid_ray.direction.y } else { far };
    let hit = march_density(field, grid_ray, RaySpan { near, far: far.min(ground) }, fetches)?;
    fetches.shading += 1;
    Some(refine_hit(field, grid_ray, &hit))
}

/// The sunlight on a surface.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SunLight {
    /// Unit vector towards the sun, in the grid.
    pub direction: Vec3,
    /// The sun's irradiance at normal incidence, over pi.
    pub color: Vec3,
    /// The result of [`halfway_to_eye`].
    pub halfway: Vec3,
}

/// Returns the unit vector halfway between the direction to the sun and the direction from the grid's
/// middle to an eye. It is the same all over the sculpture, so that both eyes of a visitor share its
/// highlights.
#[must_use]
pub fn halfway_to_eye(to_sun: Vec3, eye_in_voxels: Vec3, grid_side: usize) -> Vec3 {
    let back = eye_in_voxels - Vec3::splat(0.5 * grid_side as f32);
    (to_sun + back.normalize_or_zero()).normalize_or(to_sun)
}

/// Returns the linear radiance of a surface point, before tone mapping: marble under a sun and an ambient
/// irradiance over pi.
#[must_use]
pub fn shade_surface<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    surface: &SurfacePoint,
    sun: &SunLight,
    ambient_over_pi: Vec3,
) -> Vec3 {
    shade_surface_with_figure(field, surface, sun, ambient_over_pi, 0.0)
}

/// Does the same as [`shade_surface`] where a share of the stone is the hidden figure's, from
/// [`FigureShares`](crate::field::FigureShares): warm and shining where the figure is bared.
#[must_use]
pub fn shade_surface_with_figure<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    surface: &SurfacePoint,
    sun: &SunLight,
    ambient_over_pi: Vec3,
    figure_share: f32,
) -> Vec3 {
    let fetches = &mut RayFetches::default();
    shade_surface_counting(field, surface, sun, ambient_over_pi, figure_share, fetches)
}

/// Does the same as [`shade_surface_with_figure`], and counts the fetches. The shadow map's fetch is left
/// out: the twin casts a ray at the room's meshes instead.
#[must_use]
pub fn shade_surface_counting<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    surface: &SurfacePoint,
    sun: &SunLight,
    ambient_over_pi: Vec3,
    figure_share: f32,
    fetches: &mut RayFetches,
) -> Vec3 {
    // The density above the surface, and the marble.
    fetches.shading += 2;
    let SunLight { direction: to_sun, color: sun_color, halfway } = *sun;
    let scale = N as f32 / FAST_REFERENCE_SIDE;
    let facing = surface.normal.dot(to_sun);
    let convexity = field.sample_convexity(surface.position);
    let lean = FAST_AO_LEAN * facing.max(0.0);
    let offset = (surface.normal * FAST_AO_HEIGHT + to_sun * lean) * scale;
    let above = field.sample_density(level_above(N), surface.position + offset);
    let (mut direct, mut gloss) = (sun_color, 0.0);
    if facing > 0.0 {
        fetches.shading += 1;
        let seen = sun_visibility(field, surface.position, above, to_sun, scale);
        direct *= facing * seen;
        gloss = seen * highlight(surface, halfway, convexity, N, fetches);
    } else {
        fetches.shading += 1;
        let through =
            surface.position + (to_sun * FAST_TRANSLUCENCY_DEPTH - surface.normal) * scale;
        direct *= Vec3::from_array(FAST_TRANSLUCENCY)
            * ((1.0 - field.sample_density(level_above(N), through)) * -facing);
    }
    let open = FAST_AO_SCALE - FAST_AO_SCALE * above.min(FAST_AO_MAX_DENSITY);
    let grey = carrara::sample_grey_clamped(surface.position / N as f32);
    let stone =
        Vec3::from_array(CARRARA_BASE_COLOR).lerp(Vec3::from_array(CARRARA_VEIN_COLOR), grey);
    let worn = Vec3::ONE + Vec3::from_array(FAST_WEAR) * convexity.min(FAST_WEAR_AT_EDGES);
    let bared = ((figure_share - FIGURE_LEAST_SHARE) * FIGURE_SHARE_RISE).clamp(0.0, 1.0);
    let warm = Vec3::ONE + (Vec3::from_array(FIGURE_WARMTH) - Vec3::ONE) * bared;
    let shining = Vec3::from_array(FIGURE_GLOW) * bared;
    stone * warm * worn * (direct + ambient_over_pi * open) + sun_color * gloss + shining
}

/// Returns the sun's highlight at a point, as a part of the sunlight: a spherical Gaussian (Wang et al.
/// 2009), broad where the stone is rough, with the sparkle of its crystals.
fn highlight(
    surface: &SurfacePoint,
    halfway: Vec3,
    convexity: f32,
    grid_side: usize,
    fetches: &mut RayFetches,
) -> f32 {
    let [smooth, rough] = FAST_GLOSS_SHARPNESS;
    let roughness = (convexity.abs() * FAST_ROUGHNESS).min(1.0);
    let sharpness = smooth + (rough - smooth) * roughness;
    let toward = surface.normal.dot(halfway);
    let lobe = ((toward - 1.0) * sharpness).exp2() * sharpness * FAST_GLOSS;
    let ([periods, shift], [least, gain]) = (FAST_CRYSTAL_NOISE, FAST_SPARKLE);
    let padded = surface.position + Vec3::splat(PAD as f32);
    let grain = padded * (periods / grid_side as f32) + halfway * shift;
    let near = (toward.max(0.0).powi(2) - FAST_SPARKLE_RIM).max(0.0) / (1.0 - FAST_SPARKLE_RIM);
    if near == 0.0 {
        return lobe;
    }
    fetches.shading += 1;
    let crystal = noise::sample_noise(noise::noise_texture(), grain * NOISE_CELLS as f32);
    lobe + (crystal - least).max(0.0) * gain * near.powi(2)
}

/// The end of a march: the first sample of density a half or more.
struct DensityHit {
    /// Distance from the ray's origin, in voxels.
    t: f32,
    /// Density of the sample.
    density: f32,
    /// Length of the step to the sample, in voxels.
    step_voxels: f32,
}

fn march_density<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    ray: &Ray,
    RaySpan { near, far }: RaySpan,
    fetches: &mut RayFetches,
) -> Option<DensityHit> {
    let (mut t, mut step_voxels) = (near, overshooting_step_voxels(0.0));
    // If the origin is so far away that a step is less than the distance's precision, `t` doesn't grow.
    let mut steps_left = 8 * N;
    while t < far && steps_left > 0 {
        // Steps by density.
        let mut left = FAST_SKIP_INTERVAL;
        while left > 0.0 && steps_left > 0 {
            fetches.march += 1;
            let density = field.sample_density(0, ray.at(t));
            if density >= 0.5 {
                return (t < far).then_some(DensityHit { t, density, step_voxels });
            }
            step_voxels = overshooting_step_voxels(density);
            t += step_voxels;
            left -= step_voxels;
            steps_left -= 1;
        }
        // Empty-space skipping.
        while t < far && steps_left > 0 {
            fetches.march += 1;
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

/// Returns the march's step at a density, in voxels. The step ends a little behind a plane of that density,
/// but can't step over a wall one voxel thick.
fn overshooting_step_voxels(density: f32) -> f32 {
    let ([a, b], [c, d]) = (FAST_STEP_FAR, FAST_STEP_NEAR);
    (a - b * density).max(c - d * density)
}

/// Returns the density at which a step has this length: the inverse of [`overshooting_step_voxels`].
fn density_of_step_length(step_voxels: f32) -> f32 {
    let ([a, b], [c, d]) = (FAST_STEP_FAR, FAST_STEP_NEAR);
    ((a - step_voxels) / b).max((c - step_voxels) / d)
}

/// Steps back from a sample inside to the level set, by linear interpolation between the last two
/// samples' distances to a plane.
fn refine_hit<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    ray: &Ray,
    hit: &DensityHit,
) -> SurfacePoint {
    // Distance to a plane, up to a factor, from its blurred density less a half.
    let edge_distance = |excess: f32| excess + FAST_EDGE_CUBIC * excess * excess * excess;
    let (inside, outside) = (
        edge_distance(hit.density - 0.5),
        edge_distance(0.5 - density_of_step_length(hit.step_voxels)),
    );
    let distance = hit.t - hit.step_voxels * inside / (inside + outside);
    let position = ray.at(distance);
    let normal = field.sample_outward(position).try_normalize().unwrap_or(Vec3::Y);
    SurfacePoint { position, normal, distance }
}

/// Soft shadow by cone tracing: two samples towards the sun, the first of which is `above`, just above the
/// surface, the second farther and of a coarser mip level. Returns the visibility, 0 to 1;
/// `reference_voxel` is the side of the reference grid's voxels, in voxels.
fn sun_visibility<const N: usize, const K: usize>(
    field: &DensityField<N, K>,
    grid_point: Vec3,
    above: f32,
    to_sun: Vec3,
    reference_voxel: f32,
) -> f32 {
    let far = grid_point + to_sun * (FAST_SHADOW_DISTANCE * reference_voxel);
    let far = field.sample_density(3, far);
    [above, far].map(|density| 1.0 - FAST_SHADOW_OPACITY * density).iter().product()
}

/// Returns the mip level of the sample above the surface: the same size in the stone at either size of the
/// grid.
const fn level_above(grid_side: usize) -> usize {
    if grid_side as f32 > FAST_REFERENCE_SIDE { 3 } else { 2 }
}

const _: () = assert!(LEVELS > 3, "the sun's farthest sample is of level 3");
const _: () = assert!(PAD >= 1, "a ray's first and last voxel lie outside of the grid");
