//! The lump: a convex polyhedron with wear (value noise) and furrows of a point chisel.

use std::sync::LazyLock;

use glam::Vec3;

use super::sdf::{clamp_to_unit, max, signed_value_noise, v};

/// A flat cut: what lies beyond `height` along `normal` is gone.
struct Facet {
    normal: Vec3,
    height: f32,
    /// Across its furrows, in furrows a unit.
    across: Vec3,
    /// Half the depth of its furrows.
    bite: f32,
}

/// Normals (of any length) and the heights of the cuts over the middle of the box.
const CUTS: [([f32; 3], f32); 29] = [
    ([1.0, 0.1, 0.13], 58.0),
    ([1.0, -0.14, -0.2], 59.5),
    ([-1.0, 0.12, 0.16], 57.0),
    ([-1.0, -0.1, -0.22], 59.5),
    ([0.14, 0.1, 1.0], 57.0),
    ([-0.2, -0.1, 1.0], 59.0),
    ([-0.13, 0.14, -1.0], 58.5),
    ([0.24, -0.09, -1.0], 60.0),
    ([0.12, 1.0, -0.14], 57.0),
    ([-0.33, 1.0, 0.3], 62.0),
    ([0.4, 1.0, 0.35], 66.0),
    ([1.0, 0.12, 0.9], 70.0),
    ([-0.8, 0.1, 1.0], 71.5),
    ([-1.0, 0.15, -0.9], 70.0),
    ([1.0, -0.1, -0.75], 72.0),
    ([0.9, 0.9, 0.15], 73.0),
    ([-1.0, 0.8, 0.15], 71.5),
    ([0.13, 0.85, 1.0], 71.0),
    ([-0.15, 0.9, -1.0], 70.0),
    ([0.9, 0.8, 0.9], 79.0),
    ([-0.9, 1.0, 0.8], 78.0),
    ([-0.8, 0.9, -1.0], 77.0),
    ([1.0, 0.7, -0.9], 81.0),
    ([1.0, -0.8, 0.2], 80.5),
    ([-1.0, -0.9, 0.3], 82.0),
    ([0.2, -0.9, 1.0], 82.0),
    ([-0.1, -0.8, -1.0], 81.0),
    ([1.0, 0.45, 0.35], 63.5),
    ([-0.45, 0.35, 1.0], 64.0),
];

static FACETS: LazyLock<[Facet; CUTS.len()]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let (normal, height) = CUTS[i];
        let normal = Vec3::from(normal).normalize();
        // Any direction that is not the normal's, differing from facet to facet.
        let aside = v(0.3 + 0.1 * (i % 7) as f32, 0.5, 0.9 - 0.2 * (i % 5) as f32);
        let across = normal.cross(aside).normalize() * (0.09 + 0.012 * (i % 3) as f32);
        Facet { normal, height, across, bite: [1.1, 0.7, 1.0, 0.3][i % 4] }
    })
});

/// The most by which chisel and wear move the surface.
const RELIEF: f32 = 5.0;

pub(super) fn signed_distance(p: Vec3) -> f32 {
    let middle = p - v(0.0, 64.0, 0.0);
    let beyond = |facet: &Facet| middle.dot(facet.normal) - facet.height;
    let flat = FACETS.iter().map(beyond).fold(f32::MIN, max);
    if flat.abs() > RELIEF {
        return if flat > 0.0 { flat - RELIEF } else { flat + RELIEF };
    }
    let worn = wear(p);
    // The chisel skips where the stone was split cleanly.
    let strength = clamp_to_unit(0.8 + 1.5 * signed_value_noise(p * (1.0 / 23.0), 3));
    let chiselled = |facet: &Facet| {
        let beyond = beyond(facet);
        // Furrows are shallower than this, so farther facets stay behind.
        if beyond < flat - 3.0 {
            return beyond;
        }
        let furrow = middle.dot(facet.across) + 0.35 * worn;
        beyond + facet.bite * strength * chisel_wave(furrow)
    };
    let rough = FACETS.iter().map(chiselled).fold(f32::MIN, max);
    (rough + worn + 1.2) * 0.75
}

/// How far a worn surface lies from an even one: within 2.6 units.
pub(super) fn wear(p: Vec3) -> f32 {
    1.9 * signed_value_noise(p * (1.0 / 21.0), 1) + 0.7 * signed_value_noise(p * (1.0 / 9.0), 2)
}

/// A wave of period 1 within -1..=1, its crests sharp as between two strokes.
fn chisel_wave(t: f32) -> f32 {
    let t = t - t.floor() - 0.5;
    1.0 - 8.0 * t * t
}
