//! Gradient noise (Perlin), computed once into a repeating 3D texture of signed bytes.
//!
//! Source: Perlin, "An image synthesizer" (1985), with the quintic fade and the twelve edge
//! directions of "Improving noise" (2002). The lattice is hashed instead of permuted by a table.

use std::sync::OnceLock;

use glam::Vec3;

use crate::constants::{NOISE_CELLS, NOISE_TEXELS};

/// Returns the noise texture, x fastest, then y, then z; a byte is 127 times the noise. Computed once.
#[must_use]
pub fn noise_texture() -> &'static [i8] {
    static TEXTURE: OnceLock<Box<[i8]>> = OnceLock::new();
    TEXTURE.get_or_init(|| {
        let cell = NOISE_CELLS as f32 / NOISE_TEXELS as f32;
        (0..NOISE_TEXELS.pow(3))
            .map(|i| {
                let texel = [i, i / NOISE_TEXELS, i / (NOISE_TEXELS * NOISE_TEXELS)];
                let point = texel.map(|c| ((c % NOISE_TEXELS) as f32 + 0.5) * cell);
                (gradient_noise(Vec3::from_array(point)) * 127.0).round() as i8
            })
            .collect()
    })
}

/// Returns a trilinear sample of the texture at a point in lattice cells, repeating; about -1 to 1.
#[must_use]
pub fn sample_noise(noise_texture: &[i8], lattice_point: Vec3) -> f32 {
    let texels = NOISE_TEXELS as f32 / NOISE_CELLS as f32;
    let CellPoint { low, part } = split_at_cell(lattice_point * texels - Vec3::splat(0.5));
    let at = |dx: i32, dy: i32, dz: i32| {
        let wrap = |c: i32| (c & (NOISE_TEXELS as i32 - 1)) as usize;
        let [x, y, z] = [
            wrap(low[0].wrapping_add(dx)),
            wrap(low[1].wrapping_add(dy)),
            wrap(low[2].wrapping_add(dz)),
        ];
        f32::from(noise_texture[(z * NOISE_TEXELS + y) * NOISE_TEXELS + x])
    };
    mix_trilinear(at, part) / 127.0
}

/// Returns gradient noise at a point in lattice cells, repeating after [`NOISE_CELLS`].
#[must_use]
pub fn gradient_noise(lattice_point: Vec3) -> f32 {
    let CellPoint { low, part } = split_at_cell(lattice_point);
    let corner = |dx: i32, dy: i32, dz: i32| {
        let away = part - Vec3::new(dx as f32, dy as f32, dz as f32);
        edge_midpoint_gradient([low[0] + dx, low[1] + dy, low[2] + dz]).dot(away)
    };
    let fade = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    mix_trilinear(corner, Vec3::new(fade(part.x), fade(part.y), fade(part.z)))
}

/// A point of the lattice by its cell.
struct CellPoint {
    /// The cell's lowest corner.
    low: [i32; 3],
    /// Coordinates within the cell, 0 to 1.
    part: Vec3,
}

fn split_at_cell(point: Vec3) -> CellPoint {
    let low = point.to_array().map(|c| (c as i32).saturating_sub(i32::from(c < 0.0)));
    CellPoint { low, part: point - Vec3::from_array(low.map(|c| c as f32)) }
}

/// Interpolates trilinearly the values at the corners (0 or 1 along each axis) of a cell.
fn mix_trilinear(value_at_corner: impl Fn(i32, i32, i32) -> f32, part: Vec3) -> f32 {
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let line = |dy, dz| mix(value_at_corner(0, dy, dz), value_at_corner(1, dy, dz), part.x);
    let face = |dz| mix(line(0, dz), line(1, dz), part.y);
    mix(face(0), face(1), part.z)
}

/// Returns the gradient at a lattice point: one of the twelve directions from a cube's centre to its edges.
fn edge_midpoint_gradient(lattice_point: [i32; 3]) -> Vec3 {
    let [x, y, z] = lattice_point.map(|c| c.rem_euclid(NOISE_CELLS as i32) as u32);
    let hash = hash_u32(x | y << 8 | z << 16) % 12;
    let sign = |bit: u32| if hash >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let mut gradient = Vec3::ZERO;
    let zero = (hash / 4) as usize;
    gradient[(zero + 1) % 3] = sign(0);
    gradient[(zero + 2) % 3] = sign(1);
    gradient
}

/// Hashes an integer: a permutation of 32-bit numbers (Wellons's "lowbias32" constants).
#[must_use]
pub fn hash_u32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}
