//! The lump of stone from a quarry: a convex polyhedron of split faces. Some faces are tooled in furrows by a
//! point chisel, some show the halves of the holes for splitting, and corners are chipped.

use std::sync::LazyLock;

use glam::Vec3;

use crate::sdf::{clamp_to_unit, faceted_noise, max, min, signed_value_noise, v};

/// A plane cut that removes everything beyond `height` along `normal`.
struct Facet {
    normal: Vec3,
    height: f32,
    /// The direction across its furrows, with the furrows per unit as its length.
    across: Vec3,
    /// Half the depth of its furrows; 0 for a face without furrows.
    bite: f32,
}

/// The cuts: normals of any length, and heights from the middle of the box.
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

/// Holes in a face for the wedges that split the block.
struct Holes {
    /// The upper end of each hole's axis, which lies in the face, and the hole's length.
    tops: &'static [([f32; 3], f32)],
    /// The direction down the face.
    down: [f32; 3],
}

const HOLES: [Holes; 2] = [
    Holes {
        tops: &[
            ([-36.0, 112.0, 58.1], 52.0),
            ([-22.0, 112.0, 60.9], 47.0),
            ([-8.0, 112.0, 63.7], 54.0),
            ([6.0, 112.0, 66.5], 45.0),
            ([20.0, 112.0, 69.3], 50.0),
        ],
        down: [0.019, -0.995, -0.097],
    },
    Holes {
        tops: &[
            ([58.1, 110.0, -30.0], 42.0),
            ([56.1, 110.0, -15.0], 48.0),
            ([54.2, 110.0, 0.0], 43.0),
            ([52.4, 110.0, 14.0], 47.0),
        ],
        down: [0.097, -0.995, 0.013],
    },
];
const HOLE_RADIUS: f32 = 2.7;

/// Chips off corners and edges: centres and radii of the balls that are removed.
const CHIPS: [([f32; 3], f32); 11] = [
    ([62.0, 118.0, 54.0], 22.0),
    ([-66.0, 112.0, -50.0], 21.0),
    ([64.0, 122.0, -58.0], 24.0),
    ([-54.0, 124.0, 62.0], 25.0),
    ([66.0, 66.0, 62.0], 19.0),
    ([-68.0, 52.0, 60.0], 20.0),
    ([-62.0, 40.0, -66.0], 18.0),
    ([66.0, 24.0, -60.0], 17.0),
    ([70.0, 8.0, 52.0], 18.0),
    ([-6.0, 130.0, -66.0], 21.0),
    ([-70.0, 6.0, -10.0], 16.0),
];

static FACETS: LazyLock<[Facet; CUTS.len()]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let (normal, height) = CUTS[i];
        let normal = Vec3::from(normal).normalize();
        // Any direction other than the normal's, varying between facets.
        let aside = v(0.3 + 0.1 * (i % 7) as f32, 0.5, 0.9 - 0.2 * (i % 5) as f32);
        let across = normal.cross(aside).normalize() * (0.135 + 0.012 * (i % 3) as f32);
        // Two of three faces are split, without furrows.
        Facet { normal, height, across, bite: [0.0, 0.0, 0.85][i % 3] }
    })
});

/// The greatest displacement of the surface by chisel and fracture.
const RELIEF: f32 = 5.0;

/// Returns the signed distance to the surface.
#[must_use]
pub fn signed_distance(p: Vec3) -> f32 {
    let middle = p - v(0.0, 64.0, 0.0);
    let beyond = |facet: &Facet| middle.dot(facet.normal) - facet.height;
    let cut = FACETS.iter().map(beyond).fold(f32::MIN, max);
    if cut > RELIEF {
        return cut - RELIEF;
    }
    let taken = max(chips(p), holes(p));
    let flat = max(cut, taken);
    if flat.abs() > RELIEF {
        return if flat > 0.0 { flat - RELIEF } else { flat + RELIEF };
    }
    let broken = fracture(p);
    // The chisel worked in patches.
    let strength = clamp_to_unit(0.6 + 2.0 * signed_value_noise(p * (1.0 / 23.0), 3));
    let tooled = |facet: &Facet| {
        let beyond = beyond(facet);
        // Furrows are shallower than 3 units, so farther facets need none.
        if facet.bite == 0.0 || beyond < flat - 3.0 {
            return beyond + broken;
        }
        let furrow = middle.dot(facet.across) + 0.12 * broken;
        // Where the chisel worked, little of the fracture is left.
        beyond + broken * (1.0 - 0.7 * strength) + facet.bite * strength * chisel_wave(furrow)
    };
    let rough = FACETS.iter().map(tooled).fold(f32::MIN, max);
    (max(rough, taken + 0.4 * broken) + 1.0) * 0.7
}

/// The greatest displacement of a surface by a fracture.
pub const MAX_FRACTURE: f32 = 2.5;

/// Returns the displacement of a fractured surface from an even one, within [`MAX_FRACTURE`], in flat facets
/// that meet in creases.
#[must_use]
pub fn fracture(p: Vec3) -> f32 {
    // An arbitrary rotation, so that no crease lies along an axis.
    let turned =
        v(p.dot(v(0.64, 0.48, 0.6)), p.dot(v(-0.6, 0.8, 0.0)), p.dot(v(-0.48, -0.36, 0.8)));
    let bent = turned + Vec3::splat(2.5 * signed_value_noise(p * (1.0 / 37.0), 5));
    1.5 * faceted_noise(bent * (1.0 / 27.0), 11)
        + 0.7 * faceted_noise(bent * (1.0 / 11.0), 12)
        + 0.25 * faceted_noise(bent * (1.0 / 4.7), 13)
}

/// Returns the signed distance to what remains outside the chips.
fn chips(p: Vec3) -> f32 {
    let left = |&(centre, radius): &([f32; 3], f32)| radius - (p - Vec3::from(centre)).length();
    CHIPS.iter().map(left).fold(f32::MIN, max)
}

/// Returns the signed distance to what remains outside the holes, whose lower ends are round.
fn holes(p: Vec3) -> f32 {
    let mut left = f32::MIN;
    for face in HOLES {
        let down = Vec3::from(face.down);
        for &(top, length) in face.tops {
            let from = p - Vec3::from(top);
            let along = max(-30.0, min(from.dot(down), length));
            left = max(left, HOLE_RADIUS - (from - down * along).length());
        }
    }
    left
}

/// Returns a wave of period 1 within -1..=1, with sharp crests as between two chisel strokes.
fn chisel_wave(t: f32) -> f32 {
    let t = t - t.floor() - 0.5;
    1.0 - 8.0 * t * t
}
