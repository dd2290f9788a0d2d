//! Compares the fast path's hits with those of an exact voxel traversal, in both directions.

use glam::Vec3;
use paros_models::dense::DenseVolume;
use paros_models::voxel_traversal;
use paros_shaders::fast;
use paros_shaders::field::DensityField;
use rayon::prelude::*;

use crate::picture_side;
use crate::view::{PinholeView, TracedPicture, build_maps_and_field};

/// Number of voxels along a side.
pub const N: usize = 128;
/// Hits of neighbouring pixels whose depths differ by more than this, in voxels, have an outline between
/// them.
const JUMP: f64 = 3.0;
/// Maximum number of occupied voxels, of the 125 around a voxel, at a convex corner, and of empty voxels in a
/// crease. On a flat face the number is 75, along a straight edge 45.
const FEW: usize = 60;
/// Maximum distance of an exact hit from the fast surface, and of a fast hit from the voxels, in voxels.
const OFF: f32 = 1.0;

/// Asserts that both pictures of a volume agree from four viewpoints.
///
/// # Panics
/// Hits lie farther apart than allowed.
pub fn assert_hits_agree(name: &str, dense: &DenseVolume) {
    let (_, field) = build_maps_and_field::<N>(dense);
    let (at, side) = (Vec3::new(64.0, 60.0, 64.0), picture_side(144, 256));
    for (i, (way, from)) in [
        ([0.4, 0.2, 1.0], [300.0, 150.0]),
        ([-0.7, 0.8, 0.5], [400.0, 150.0]),
        ([0.0, 0.0, -1.0], [400.0, 140.0]),
        ([0.9, 0.1, -0.6], [110.0, 50.0]),
    ]
    .into_iter()
    .enumerate()
    {
        let picture = TracedPicture::new(dense, &field, PinholeView::new(at, way, from, side));
        check_view(&format!("{name}-{i}"), dense, &field, &picture);
    }
}

/// The shape of the surface around a hit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum HitSurroundings {
    Open,
    Convex,
    Crease,
}

impl HitSurroundings {
    /// Returns the maximum distance of an exact hit from the fast surface, in voxels.
    const fn max_distance(self) -> f32 {
        match self {
            HitSurroundings::Open | HitSurroundings::Crease => OFF,
            HitSurroundings::Convex => 2.0,
        }
    }
}

fn classify_hit(dense: &DenseVolume, entry: &voxel_traversal::VoxelEntry) -> HitSurroundings {
    let around = |[x, y, z]: [i32; 3], full: bool| {
        let all = (0..125).map(|i| [x + i % 5 - 2, y + i / 5 % 5 - 2, z + i / 25 - 2]);
        // The ground layer repeats below the grid.
        all.filter(|&[x, y, z]| dense.contains([x, y.max(0), z]) == full).count()
    };
    if around(entry.voxel, true) <= FEW {
        HitSurroundings::Convex
    } else if around(entry.before, false) <= FEW {
        HitSurroundings::Crease
    } else {
        HitSurroundings::Open
    }
}

/// A hit of the exact traversal.
struct ExactHit {
    pixel: usize,
    place: HitSurroundings,
    /// `near`: at most [`OFF`] from the fast surface. `right`: at most as far from it as the hit's
    /// surroundings allow.
    near: bool,
    right: bool,
}

fn check_view(name: &str, dense: &DenseVolume, field: &DensityField<N>, picture: &TracedPicture) {
    let away = flag_pixels_away_from_outlines(picture);
    let tested: Vec<usize> = (0..away.len()).filter(|&pixel| away[pixel]).collect();
    let seen = |&pixel: &usize| {
        let place = classify_hit(dense, picture.exact[pixel].as_ref()?);
        let near = is_exact_hit_near_fast_surface(field, picture, pixel, OFF);
        let right = near
            || place != HitSurroundings::Open
                && is_exact_hit_near_fast_surface(field, picture, pixel, place.max_distance());
        Some(ExactHit { pixel, place, near, right })
    };
    let seen: Vec<ExactHit> = tested.par_iter().filter_map(seen).collect();
    let astray = |&pixel: &usize| {
        picture.fast[pixel].is_some_and(|at| !is_near_occupied_voxel(dense, at.position, OFF))
    };
    let stray = tested.iter().copied().filter(astray);
    let wrong = seen.iter().filter(|seen| !seen.right).map(|seen| seen.pixel);
    let red: Vec<usize> = stray.chain(wrong).collect();
    let off = |place| seen.iter().filter(|seen| seen.place == place && !seen.near).count();
    let (convex, creases) = (off(HitSurroundings::Convex), off(HitSurroundings::Crease));
    let hits = picture.exact.iter().flatten().count();
    println!(
        "{name}: {} of {hits} hits lie away from outlines; farther than a voxel from the fast \
         surface are {convex} at convex corners, {creases} in creases",
        seen.len()
    );
    let few = |some: usize| some * 200 <= seen.len();
    if !red.is_empty() || !few(convex) || !few(creases) || seen.len() * 2 < hits {
        let path = picture.write_png(&format!("fidelity-{name}"), &red);
        panic!("{name}: {} pixels are wrong: see {}", red.len(), path.display());
    }
}

/// Returns the pixels that are farther than two voxels' projected width from any outline.
fn flag_pixels_away_from_outlines(picture: &TracedPicture) -> Vec<bool> {
    let side = picture.view.side;
    let mut away = vec![true; side * side];
    let distance = |i: usize| picture.exact[i].map(|entry| entry.distance);
    for i in 0..side * side {
        let (x, y) = (i % side, i / side);
        for (right, down) in [(1, 0), (0, 1)] {
            if x + right == side || y + down == side {
                continue;
            }
            let near = match (distance(i), distance(i + right + down * side)) {
                (None, None) => continue,
                (Some(a), Some(b)) if (a - b).abs() <= JUMP => continue,
                (Some(a), Some(b)) => a.min(b),
                (Some(a), None) | (None, Some(a)) => a,
            };
            let between = [x as f32 + 0.5 * right as f32, y as f32 + 0.5 * down as f32];
            let radius = 2.0 * picture.view.focal / near as f32;
            picture.view.pixels_within(between, radius).for_each(|i| away[i] = false);
        }
    }
    away
}

/// Returns `true` if a pixel's exact hit lies within a distance of a point that the fast path shows.
fn is_exact_hit_near_fast_surface(
    field: &DensityField<N>,
    picture: &TracedPicture,
    pixel: usize,
    max_distance: f32,
) -> bool {
    let at = picture.exact_point(pixel).expect("a hit");
    let close = |to: Vec3| to.distance(at) <= max_distance;
    if picture.fast[pixel].is_some_and(|fast| close(fast.position)) {
        return true;
    }
    let [right, up, _] = picture.view.axes;
    let steps = || (-20..=20).map(|i| i as f32 * max_distance / 20.0);
    steps().any(|x| {
        steps().any(|y| {
            let ray = picture.view.ray_towards(at + right * x + up * y);
            x * x + y * y <= max_distance * max_distance
                && fast::find_surface(field, &ray).is_some_and(|fast| close(fast.position))
        })
    })
}

/// Returns `true` if an occupied voxel lies within a distance of a point.
fn is_near_occupied_voxel(dense: &DenseVolume, point: Vec3, max_distance: f32) -> bool {
    let [x, y, z] = point.to_array().map(|c| c.floor() as i32);
    (0..125).any(|i| {
        let voxel = [x + i % 5 - 2, y + i / 5 % 5 - 2, z + i / 25 - 2];
        let low = Vec3::from_array(voxel.map(|c| c as f32));
        dense.contains(voxel) && point.distance(point.clamp(low, low + 1.0)) <= max_distance
    })
}
