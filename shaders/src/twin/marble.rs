//! The paper's path's marble: veins of a plane wave, bent by turbulence.
//!
//! Source: Perlin, "An image synthesizer" (1985).

use glam::Vec3;

use super::noise;
use crate::constants::{
    MARBLE_BASE_COLOR, MARBLE_HAZE_GREY, MARBLE_NOISE_SCALE, MARBLE_OCTAVES, MARBLE_TURBULENCE,
    MARBLE_VEIN_COLOR, MARBLE_VEIN_CONTRAST, MARBLE_VEIN_COUNT, MARBLE_VEIN_FALLOFF,
    MARBLE_VEIN_GREY, MARBLE_VEIN_NORMAL,
};

/// Returns the diffuse reflectance at a point of the unit cube.
#[must_use]
pub fn reflectance(noise_texture: &[i8], cube_point: Vec3) -> Vec3 {
    Vec3::from_array(MARBLE_BASE_COLOR)
        .lerp(Vec3::from_array(MARBLE_VEIN_COLOR), vein_grey(noise_texture, cube_point))
}

/// Returns the greyness of a point of the unit cube, 0 to 1.
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

/// Octaves of noise at a point.
struct NoiseOctaves {
    /// Sum of the octaves, with halving amplitude.
    sum: f32,
    /// The first octave.
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
