//! Convexity of the surface around a texel of level 1: a difference of Gaussians (Marr and Hildreth 1980).
//!
//! On a plane a wide and a narrow mean of the density are both a half. At an edge the wide mean takes in
//! more empty space, in a cavity more stone. Both vanish with roughness finer than a texel.

use super::gradient::LANES;

/// The difference of the means that maps to a byte of 127: a density of 0.16, at the means' scale of 128.
const FULL: f32 = 0.16 * 255.0 * 128.0;
/// Noise of a smooth surface's voxels, as a share of `FULL`: differences up to it count as zero.
const NOISE: f32 = 0.12;

/// Returns the convexity by a wide and a narrow mean, both 128 times the density: a signed byte for each
/// texel, positive at edges and negative in cavities.
#[inline]
pub(super) fn convexity_bytes([wide, narrow]: [[i16; LANES]; 2]) -> [u32; LANES] {
    let mut bytes = [0; LANES];
    for (i, byte) in bytes.iter_mut().enumerate() {
        let differ = f32::from(narrow[i].wrapping_sub(wide[i])) * (1.0 / FULL);
        // A dead zone removes the noise.
        let clear = differ - at_most(at_least(differ, -NOISE), NOISE);
        // Adding a large float rounds the value to an integer, in the lowest bits of the sum.
        *byte = (at_most(at_least(clear, -1.0), 1.0) * 127.0 + 12_582_912.0).to_bits() & 0xff;
    }
    bytes
}

/// Returns the greater of two numbers: one instruction, as neither is NaN.
#[inline]
pub(super) fn at_least(a: f32, least: f32) -> f32 {
    if a > least { a } else { least }
}

/// Returns the lesser of two numbers.
#[inline]
pub(super) fn at_most(a: f32, most: f32) -> f32 {
    if a < most { a } else { most }
}
