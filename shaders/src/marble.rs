//! White marble: grey veins where a plane wave, bent by turbulence, crosses zero.
//!
//! Source: the marble of Perlin, "An image synthesizer" (1985).

use std::sync::OnceLock;

use glam::Vec3;
use rayon::prelude::*;

use crate::constants::{
    MARBLE_ACROSS, MARBLE_BEND, MARBLE_GREY, MARBLE_OCTAVES, MARBLE_SCALE, MARBLE_VEINS,
    MARBLE_WHITE,
};
use crate::noise;

/// Reflectance at a point of the unit cube.
#[must_use]
pub fn reflectance(texture: &[i8], point: Vec3) -> Vec3 {
    Vec3::from_array(MARBLE_WHITE).lerp(Vec3::from_array(MARBLE_GREY), grey(texture, point))
}

/// How grey a point of the unit cube is, 0 to 1.
fn grey(texture: &[i8], point: Vec3) -> f32 {
    let (turbulence, cloud) = turbulence(texture, point * MARBLE_SCALE);
    let across = point.dot(Vec3::from_array(MARBLE_ACROSS)) * MARBLE_VEINS;
    // Distance to the nearest zero of the wave, 0 on a vein and 1 between two.
    let phase = across + MARBLE_BEND * turbulence;
    let away = 2.0 * (phase - phase.round()).abs();
    let vein = (-away * away * 60.0).exp() * (0.35 + 0.65 * (0.5 + cloud).clamp(0.0, 1.0));
    let haze = 0.16 * (0.5 - cloud).clamp(0.0, 1.0) * (1.0 - away);
    (0.8 * vein + haze).clamp(0.0, 1.0)
}

/// Texels along a side of [`texture`].
pub const SIDE: usize = 128;

/// How grey the marble is all over the unit cube, 255 where it is all grey; x fastest, then y,
/// then z.
#[must_use]
pub fn texture() -> &'static [u8] {
    static TEXTURE: OnceLock<Box<[u8]>> = OnceLock::new();
    TEXTURE.get_or_init(|| {
        let mut texels = vec![0u8; SIDE * SIDE * SIDE].into_boxed_slice();
        texels.par_chunks_mut(SIDE).enumerate().for_each(|(row, texels)| {
            let at = |i: usize| (i as f32 + 0.5) / SIDE as f32;
            for (x, texel) in texels.iter_mut().enumerate() {
                let point = Vec3::new(at(x), at(row % SIDE), at(row / SIDE));
                *texel = (grey(noise::texture(), point) * 255.0 + 0.5) as u8;
            }
        });
        texels
    })
}

/// [`texture`] at a point of the unit cube, 0 to 1, filtered trilinearly; beyond the outermost
/// texels as they are.
#[must_use]
pub fn sample(point: Vec3) -> f32 {
    let texels = texture();
    let place = (point * SIDE as f32 - Vec3::splat(0.5)).clamp(Vec3::ZERO, Vec3::splat(LAST));
    let low = place.to_array().map(|c| (c as usize).min(SIDE - 2));
    let part = place - Vec3::from_array(low.map(|c| c as f32));
    let at = |x: usize, y: usize, z: usize| {
        f32::from(texels[((low[2] + z) * SIDE + low[1] + y) * SIDE + low[0] + x])
    };
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let line = |y, z| mix(at(0, y, z), at(1, y, z), part.x);
    let face = |z| mix(line(0, z), line(1, z), part.y);
    mix(face(0), face(1), part.z) / 255.0
}

const LAST: f32 = (SIDE - 1) as f32;

/// Octaves of noise with halving amplitude, and the first one by itself.
fn turbulence(texture: &[i8], point: Vec3) -> (f32, f32) {
    let cloud = noise::sample(texture, point);
    let mut sum = cloud * 0.5;
    let (mut scale, mut amplitude) = (1.0, 0.5);
    for _ in 1..MARBLE_OCTAVES {
        scale *= 2.0;
        amplitude *= 0.5;
        sum += amplitude * noise::sample(texture, point * scale);
    }
    (sum, cloud)
}
