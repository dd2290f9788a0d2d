//! The studio's colours, as linear reflectances, and the small differences that make them natural.

use glam::Vec3;

pub(crate) const PLASTER: Vec3 = Vec3::new(0.74, 0.69, 0.61);
pub(crate) const DADO: Vec3 = Vec3::new(0.50, 0.465, 0.39);
pub(crate) const CAST: Vec3 = Vec3::new(0.76, 0.735, 0.69);
pub(crate) const OAK: Vec3 = Vec3::new(0.335, 0.205, 0.112);
pub(crate) const BEAM: Vec3 = Vec3::new(0.17, 0.102, 0.056);
pub(crate) const BEECH: Vec3 = Vec3::new(0.50, 0.325, 0.18);
pub(crate) const WALNUT: Vec3 = Vec3::new(0.20, 0.112, 0.06);
pub(crate) const FRAME: Vec3 = Vec3::new(0.15, 0.19, 0.18);
pub(crate) const IRON: Vec3 = Vec3::new(0.06, 0.06, 0.065);
pub(crate) const STEEL: Vec3 = Vec3::new(0.44, 0.45, 0.47);
pub(crate) const BRASS: Vec3 = Vec3::new(0.56, 0.38, 0.13);
pub(crate) const GRAPHITE: Vec3 = Vec3::new(0.075, 0.08, 0.088);
pub(crate) const TEAL: Vec3 = Vec3::new(0.045, 0.16, 0.165);
pub(crate) const RUST: Vec3 = Vec3::new(0.42, 0.115, 0.045);
pub(crate) const PASTE: Vec3 = Vec3::new(0.74, 0.68, 0.58);
pub(crate) const LEATHER: Vec3 = Vec3::new(0.43, 0.26, 0.135);
pub(crate) const STONE: Vec3 = Vec3::new(0.60, 0.585, 0.56);
pub(crate) const CLAY: Vec3 = Vec3::new(0.45, 0.205, 0.115);
pub(crate) const LEAF: Vec3 = Vec3::new(0.09, 0.18, 0.05);

/// Returns the integer hash of a seed, as a number in 0..1.
pub(crate) fn hash_fraction(seed: u32) -> f32 {
    let mut h = seed.wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
    for shift in [16, 13, 16] {
        h = (h ^ (h >> shift)).wrapping_mul(0x7feb_352d);
    }
    (h >> 8) as f32 / (1 << 24) as f32
}

/// Returns a colour scaled by a factor in 1 - `max_change` to 1 + `max_change`.
pub(crate) fn vary_colour(colour: Vec3, max_change: f32, seed: u32) -> Vec3 {
    colour * (1.0 + max_change * (2.0 * hash_fraction(seed) - 1.0))
}
