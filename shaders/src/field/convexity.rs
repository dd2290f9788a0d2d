//! How convex the surface is around a texel of level 1: a difference of Gaussians (Marr and Hildreth 1980).
//!
//! On a plane a wide and a narrow mean are both a half; at an edge the wide one takes in more of what is empty,
//! in a cavity more of the stone. Both vanish with roughness finer than a texel.

use super::gradient::LANES;

/// 128 times the density, as both means are given, for a byte of 127.
const FULL: f32 = 0.16 * 255.0 * 128.0;
/// What the voxels of a smooth surface come to, of that.
const NOISE: f32 = 0.12;

/// The convexity by a wide and a narrow mean, both 128 times the density: a signed byte for each texel, positive
/// at edges and negative in cavities.
#[inline]
pub(super) fn convexity_bytes([wide, narrow]: [[i16; LANES]; 2]) -> [u32; LANES] {
    let mut bytes = [0; LANES];
    for (i, byte) in bytes.iter_mut().enumerate() {
        let differ = f32::from(narrow[i].wrapping_sub(wide[i])) * (1.0 / FULL);
        // Clear of the noise, and within a byte.
        let clear = differ - at_most(at_least(differ, -NOISE), NOISE);
        // Rounded by the sum with a large float, whose last bits it becomes.
        *byte = (at_most(at_least(clear, -1.0), 1.0) * 127.0 + 12_582_912.0).to_bits() & 0xff;
    }
    bytes
}

/// The greater of two numbers: one instruction, as neither is NaN.
#[inline]
pub(super) fn at_least(a: f32, least: f32) -> f32 {
    if a > least { a } else { least }
}

/// The lesser of two.
#[inline]
pub(super) fn at_most(a: f32, most: f32) -> f32 {
    if a < most { a } else { most }
}
