//! Procedural marble: veins of a plane wave, bent by turbulence.
//!
//! Source: Perlin, "An image synthesizer" (1985).

use std::sync::OnceLock;

use glam::Vec3;
use rayon::prelude::*;

use super::noise;
use crate::constants::{
    MARBLE_BASE_COLOR, MARBLE_HAZE_GREY, MARBLE_NOISE_SCALE, MARBLE_OCTAVES, MARBLE_TURBULENCE,
    MARBLE_VEIN_COLOR, MARBLE_VEIN_CONTRAST, MARBLE_VEIN_COUNT, MARBLE_VEIN_FALLOFF,
    MARBLE_VEIN_GREY, MARBLE_VEIN_NORMAL,
};

/// Diffuse reflectance at a point of the unit cube.
#[must_use]
pub fn reflectance(noise_texture: &[i8], cube_point: Vec3) -> Vec3 {
    Vec3::from_array(MARBLE_BASE_COLOR)
        .lerp(Vec3::from_array(MARBLE_VEIN_COLOR), vein_grey(noise_texture, cube_point))
}

/// Greyness of a point of the unit cube, 0 to 1.
fn vein_grey(noise_texture: &[i8], cube_point: Vec3) -> f32 {
    let NoiseOctaves { sum: turbulence, first: cloud } =
        sum_octaves(noise_texture, cube_point * MARBLE_NOISE_SCALE);
    let across = cube_point.dot(Vec3::from_array(MARBLE_VEIN_NORMAL)) * MARBLE_VEIN_COUNT;
    // Distance to the nearest zero of the wave, 0 on a vein and 1 between two.
    let phase = across + MARBLE_TURBULENCE * turbulence;
    let distance_to_vein = 2.0 * (phase - phase.round()).abs();
    let [low, gain] = MARBLE_VEIN_CONTRAST;
    let vein = (-distance_to_vein * distance_to_vein * MARBLE_VEIN_FALLOFF).exp()
        * (low + gain * (0.5 + cloud).clamp(0.0, 1.0));
    let haze = MARBLE_HAZE_GREY * (0.5 - cloud).clamp(0.0, 1.0) * (1.0 - distance_to_vein);
    (MARBLE_VEIN_GREY * vein + haze).clamp(0.0, 1.0)
}

/// Texels along a side of [`grey_texture_3d`].
pub const TEXTURE_SIDE: usize = 128;

/// Greyness over the unit cube, as bytes of 0 to 255; x fastest, then y, then z. Made once.
#[must_use]
pub fn grey_texture_3d() -> &'static [u8] {
    static TEXTURE: OnceLock<Box<[u8]>> = OnceLock::new();
    TEXTURE.get_or_init(|| {
        let mut texels = vec![0u8; TEXTURE_SIDE * TEXTURE_SIDE * TEXTURE_SIDE].into_boxed_slice();
        texels.par_chunks_mut(TEXTURE_SIDE).enumerate().for_each(|(row, texels)| {
            let at = |i: usize| (i as f32 + 0.5) / TEXTURE_SIDE as f32;
            for (x, texel) in texels.iter_mut().enumerate() {
                let point = Vec3::new(at(x), at(row % TEXTURE_SIDE), at(row / TEXTURE_SIDE));
                *texel = (vein_grey(noise::noise_texture(), point) * 255.0 + 0.5) as u8;
            }
        });
        texels
    })
}

/// Trilinear sample of [`grey_texture_3d`] at a point of the unit cube, 0 to 1, clamped to the edge.
#[must_use]
pub fn sample_grey_clamped(cube_point: Vec3) -> f32 {
    let texels = grey_texture_3d();
    let place =
        (cube_point * TEXTURE_SIDE as f32 - Vec3::splat(0.5)).clamp(Vec3::ZERO, Vec3::splat(LAST));
    let low = place.to_array().map(|c| (c as usize).min(TEXTURE_SIDE - 2));
    let part = place - Vec3::from_array(low.map(|c| c as f32));
    let at = |x: usize, y: usize, z: usize| {
        f32::from(texels[((low[2] + z) * TEXTURE_SIDE + low[1] + y) * TEXTURE_SIDE + low[0] + x])
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let line = |y, z| mix(at(0, y, z), at(1, y, z), part.x);
    let face = |z| mix(line(0, z), line(1, z), part.y);
    mix(face(0), face(1), part.z) / 255.0
}

const LAST: f32 = (TEXTURE_SIDE - 1) as f32;

/// Octaves of noise at a point.
struct NoiseOctaves {
    /// Their sum, with halving amplitude.
    sum: f32,
    /// The first one by itself.
    first: f32,
}

fn sum_octaves(noise_texture: &[i8], lattice_point: Vec3) -> NoiseOctaves {
    let first = noise::sample_noise(noise_texture, lattice_point);
    let mut sum = first * 0.5;
    let (mut scale, mut amplitude) = (1.0, 0.5);
    for _ in 1..MARBLE_OCTAVES {
        scale *= 2.0;
        amplitude *= 0.5;
        sum += amplitude * noise::sample_noise(noise_texture, lattice_point * scale);
    }
    NoiseOctaves { sum, first }
}
