//! Ambient light in spherical harmonics, for the twin and for the room's baked light.
//!
//! Source: Ramamoorthi and Hanrahan, "An efficient representation for irradiance environment maps"
//! (2001).

use glam::Vec3;

/// Normalisation of the nine real harmonics of bands 0 to 2, in the order 00, 1-1, 10, 11, 2-2,
/// 2-1, 20, 21, 22 with z as polar axis.
pub const BASIS_FACTORS: [f32; 9] = [
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

/// Factors of the convolution with the clamped cosine, one for each harmonic, over pi.
pub const COSINE_FACTORS: [f32; 9] =
    [1.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 0.25, 0.25, 0.25, 0.25, 0.25];

/// Returns the nine harmonics in a direction of length 1.
#[must_use]
pub fn sh_basis(direction: Vec3) -> [f32; 9] {
    let d = direction;
    [
        BASIS_FACTORS[0],
        BASIS_FACTORS[1] * d.y,
        BASIS_FACTORS[2] * d.z,
        BASIS_FACTORS[3] * d.x,
        BASIS_FACTORS[4] * d.x * d.y,
        BASIS_FACTORS[5] * d.y * d.z,
        BASIS_FACTORS[6] * (3.0 * d.z * d.z - 1.0),
        BASIS_FACTORS[7] * d.x * d.z,
        BASIS_FACTORS[8] * (d.x * d.x - d.y * d.y),
    ]
}

/// Returns the irradiance over pi of a surface with this normal under a radiance in harmonics.
#[must_use]
pub fn irradiance_over_pi(radiance_sh: &[[f32; 3]; 9], normal: Vec3) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for ((basis, band), color) in sh_basis(normal).into_iter().zip(COSINE_FACTORS).zip(*radiance_sh)
    {
        sum += Vec3::from_array(color) * (basis * band);
    }
    sum.max(Vec3::ZERO)
}
