//! The fast path's marble, after Carrara's: a cool white ground with soft grey clouds, and grey veins of one
//! direction at two scales, blurred on one side, from which hair lines branch.
//!
//! Source: Perlin, "An image synthesizer" (1985); positions are warped by noise (Quilez, "Domain warping").

use std::sync::OnceLock;

use glam::Vec3;
use rayon::prelude::*;

use super::noise;

/// Directions across the great veins, and across the hair lines.
const ACROSS: Vec3 = Vec3::new(0.62, 0.55, -0.56);
const ACROSS_HAIR: Vec3 = Vec3::new(0.30, 0.78, -0.55);
/// Number of great veins along the cube's side, and of hair lines.
const VEINS: f32 = 2.9;
const HAIRS: f32 = 6.1;
/// Widths of a vein on its sharp side and on its blurred side, and of a hair line, as parts of the distance
/// between two such lines.
const SHARP: f32 = 0.030;
const BLURRED: f32 = 0.17;
const HAIR: f32 = 0.040;

/// Returns the greyness of a point of the unit cube, 0 to 1.
fn grey_at(point: Vec3) -> f32 {
    let wave = |scale: f32, offset: f32| {
        noise::sample_noise(noise::noise_texture(), point * scale + Vec3::splat(offset))
    };
    let bent = Vec3::new(wave(1.9, 0.0), wave(1.9, 5.3), wave(1.9, 9.1)) * 0.16;
    let frayed = wave(6.1, 2.7) * 0.030 + wave(15.0, 11.9) * 0.010;
    let at = point + bent;
    // Signed distance to the nearest vein, -0.5 to 0.5 of the distance between two veins.
    let vein = nearest_line(at.dot(ACROSS) * VEINS + frayed * VEINS + 0.31);
    let width = if vein < 0.0 { SHARP } else { BLURRED };
    let strength = 0.25 + 0.75 * smoothstep(wave(2.3, 7.7) * 1.8 + 0.6);
    let core = 0.60 * falloff(vein / width) + 0.40 * falloff(vein / (0.5 * SHARP));
    // Hair lines branch off the veins, and fade away from them.
    let hair = nearest_line((point + bent * 1.5).dot(ACROSS_HAIR) * HAIRS + frayed * 9.0);
    let near = 0.25 + 0.75 * falloff(vein / 0.22);
    let fades = smoothstep(wave(3.4, 13.1) * 2.2 + 0.55);
    let hair = 0.60 * falloff(hair / HAIR) * near * fades;
    let cloud = 0.20 * smoothstep(0.45 + 0.9 * wave(2.8, 3.9) + 0.5 * wave(7.0, 1.3));
    (core * strength + hair + cloud).clamp(0.0, 1.0)
}

/// Returns the signed distance to the nearest whole number.
fn nearest_line(phase: f32) -> f32 {
    phase - phase.round()
}

/// Returns 1 at 0, and falls to both sides with longer tails than a Gaussian.
fn falloff(distance: f32) -> f32 {
    1.0 / (1.0 + distance * distance).powi(2)
}

fn smoothstep(t: f32) -> f32 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Texels along a side of [`grey_texture_3d`].
pub const TEXTURE_SIDE: usize = 128;

/// Returns the greyness over the unit cube, as bytes of 0 to 255; x fastest, then y, then z. Computed once.
#[must_use]
pub fn grey_texture_3d() -> &'static [u8] {
    static TEXTURE: OnceLock<Box<[u8]>> = OnceLock::new();
    TEXTURE.get_or_init(|| {
        let mut texels = vec![0u8; TEXTURE_SIDE * TEXTURE_SIDE * TEXTURE_SIDE].into_boxed_slice();
        texels.par_chunks_mut(TEXTURE_SIDE).enumerate().for_each(|(row, texels)| {
            let at = |i: usize| (i as f32 + 0.5) / TEXTURE_SIDE as f32;
            for (x, texel) in texels.iter_mut().enumerate() {
                let point = Vec3::new(at(x), at(row % TEXTURE_SIDE), at(row / TEXTURE_SIDE));
                *texel = (grey_at(point) * 255.0 + 0.5) as u8;
            }
        });
        texels
    })
}

/// Returns a trilinear sample of [`grey_texture_3d`] at a point of the unit cube, 0 to 1, clamped to the
/// edge.
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
