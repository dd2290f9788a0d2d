//! Light from everywhere as spherical harmonics, here and where the room's is baked.
//!
//! Source: Ramamoorthi and Hanrahan, "An efficient representation for irradiance environment maps"
//! (2001).

use glam::Vec3;

/// The factors of the nine real harmonics of bands 0 to 2, in the order 00, 1-1, 10, 11, 2-2, 2-1,
/// 20, 21, 22 with z as polar axis.
pub const FACTORS: [f32; 9] = [
    0.282_094_8,
    0.488_602_5,
    0.488_602_5,
    0.488_602_5,
    1.092_548_4,
    1.092_548_4,
    0.315_391_57,
    1.092_548_4,
    0.546_274_2,
];

/// What a clamped cosine leaves of each, over pi.
pub const BANDS: [f32; 9] = [1.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25];

/// The harmonics in a direction of length 1.
#[must_use]
pub fn basis(d: Vec3) -> [f32; 9] {
    [
        FACTORS[0],
        FACTORS[1] * d.y,
        FACTORS[2] * d.z,
        FACTORS[3] * d.x,
        FACTORS[4] * d.x * d.y,
        FACTORS[5] * d.y * d.z,
        FACTORS[6] * (3.0 * d.z * d.z - 1.0),
        FACTORS[7] * d.x * d.z,
        FACTORS[8] * (d.x * d.x - d.y * d.y),
    ]
}

/// The light that a surface with this normal receives of a radiance, over pi.
#[must_use]
pub fn ambient(light: &[[f32; 3]; 9], normal: Vec3) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for ((basis, band), color) in basis(normal).into_iter().zip(BANDS).zip(*light) {
        sum += Vec3::from_array(color) * (basis * band);
    }
    sum.max(Vec3::ZERO)
}
