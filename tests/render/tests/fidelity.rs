//! The fast path against an exact voxel traversal, in both directions, and the visibility of thin features.
//! `tests/real-meshes` does the same with a third-party mesh.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `constants.rs`, `FAST_STEP_NEAR`: 1.75 made 2.2 -> `exact_hits_and_fast_hits`, plates, rods.
//! - `thin.rs`: `PLATE` made 0 -> plates; `ROD` made 230 -> rods.
//! - `fast.rs`: the surface where the density is 0.35 -> grooves, `exact_hits_and_fast_hits`.
//! - `fast.rs`, `refine_hit`: the first sample inside is the surface -> `exact_hits_and_fast_hits`.
//! - `field/textures.rs`, `free_distance_voxels`: a cell more -> all.
//! - `texels.rs`, `sample_trilinear`: places off by 0.3 -> all but rods.

use std::sync::Mutex;

use glam::Vec3;
use paros_core::RangeMaps;
use paros_core::volume::BitGrid;
use paros_models::dense::{DenseVolume, closed_volumes as small};
use paros_models::voxel_traversal;
use paros_shell::figures::Figure;
use paros_tests_render::fidelity::{N, assert_hits_agree};
use paros_tests_render::picture_side;
use paros_tests_render::view::{PinholeView, TracedPicture, build_maps_and_field};
use proptest::prelude::*;

proptest! {
    /// Tests the model itself against small steps.
    #[test]
    fn the_exact_walk_misses_nothing(
        dense in small(16),
        from in proptest::array::uniform3(-30.0..46.0f64),
        to in proptest::array::uniform3(0.0..16.0f64),
    ) {
        let way: [f64; 3] = std::array::from_fn(|i| to[i] - from[i]);
        let length = way.iter().map(|c| c * c).sum::<f64>().sqrt();
        prop_assume!(length > 1.0 && from.iter().any(|c| !(0.0..16.0).contains(c)));
        let way = way.map(|c| c / length);
        let place = |distance: f64| std::array::from_fn(|i| from[i] + way[i] * distance);
        let voxel = |at: [f64; 3]| at.map(|c| c.floor() as i32);
        let entry = voxel_traversal::find_first_occupied(&dense, from, way);
        let end = entry.as_ref().map_or(100.0, |entry| entry.distance - 1e-6);
        for i in 0..(end.max(0.0) * 100.0) as usize {
            prop_assert!(!dense.contains(voxel(place(i as f64 * 0.01))), "{entry:?}");
        }
        if let Some(entry) = entry {
            prop_assert!(dense.contains(entry.voxel) && !dense.contains(entry.before));
            let off = |at: f64, low: i32| (f64::from(low) - at).max(at - f64::from(low) - 1.0);
            for voxel in [entry.voxel, entry.before] {
                let at: [f64; 3] = place(entry.distance);
                prop_assert!((0..3).all(|i| off(at[i], voxel[i]) < 1e-6), "{entry:?}");
            }
        }
    }
}

/// Compares pixels away from outlines. The blur cuts convex corners, where two voxels are allowed. It would
/// fill creases as much, but creases are opened.
#[test]
fn exact_hits_and_fast_hits_lie_together() {
    for (name, dense) in test_volumes() {
        assert_hits_agree(name, &dense);
    }
}

fn test_volumes() -> Vec<(&'static str, DenseVolume)> {
    static MAPS: Mutex<RangeMaps<N>> = Mutex::new(RangeMaps::new());
    static PLANE: Mutex<BitGrid<N>> = Mutex::new(BitGrid::new());
    let (mut maps, mut plane) = (MAPS.lock().unwrap(), PLANE.lock().unwrap());
    let from = |[x, y, z]: [i32; 3], c: [f32; 3]| {
        Vec3::new(x as f32, y as f32, z as f32).distance(Vec3::from_array(c) - 0.5)
    };
    let pair = DenseVolume::from_fn(N, |at| {
        from(at, [40.0, 36.0, 44.0]) < 34.0 || from(at, [84.0, 72.0, 80.0]) < 40.0 || at[1] < 10
    });
    let steps = DenseVolume::from_fn(N, |[x, y, z]| y < 16 + 12 * (x / 18) && (z + y) % 128 > 18);
    let mut volumes = vec![("pair", pair.closure()), ("steps", steps.closure())];
    for figure in [Figure::Owl, Figure::Cat, Figure::Amphora] {
        figure.rasterize_into(&mut *maps, &mut *plane);
        volumes.push((figure.name(), DenseVolume::from_maps(&maps)));
    }
    volumes
}

/// View directions: along the axes or nearly, along the diagonals of the faces and of the cube, and between.
const WAYS: [[f32; 3]; 14] = [
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.02, 0.03, 1.0],
    [1.0, 0.02, 0.03],
    [0.03, 1.0, 0.02],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.7, 0.4, -0.6],
    [0.2, 0.9, 0.3],
    [-0.9, 0.15, 0.3],
    [0.3, 0.1, -0.9],
];

/// Takes pictures of a volume of 64 voxels a side from everywhere. A voxel is about two and a half pixels
/// wide; in the nightly run about four.
fn take_pictures(dense: &DenseVolume) -> impl Iterator<Item = (usize, TracedPicture)> + use<> {
    let (_, field) = build_maps_and_field::<64>(dense);
    let dense = dense.clone();
    WAYS.into_iter().enumerate().map(move |(i, way)| {
        let view = PinholeView::new(Vec3::splat(32.0), way, [150.0, 56.0], picture_side(140, 200));
        (i, TracedPicture::new(&dense, &field, view))
    })
}

/// Asserts that the fast path shows at least the share `least` of the pixels that show a thin shape exactly,
/// from every direction. No missing pixel may be two voxels' width from a shown pixel, as at a plate's
/// corners, so that nothing breaks.
fn assert_stays_whole(name: &str, dense: &DenseVolume, least: f32) {
    for (i, picture) in take_pictures(dense) {
        let shown: Vec<usize> =
            (0..picture.exact.len()).filter(|&pixel| picture.exact[pixel].is_some()).collect();
        let kept = shown.iter().filter(|&&pixel| picture.fast[pixel].is_some()).count();
        let voxel = picture.view.focal / picture.view.eye.distance(Vec3::splat(32.0));
        let lost = |&pixel: &usize| {
            let side = picture.view.side;
            let at = [(pixel % side) as f32, (pixel / side) as f32];
            !picture.view.pixels_within(at, 2.0 * voxel).any(|near| picture.fast[near].is_some())
        };
        let part = kept as f32 / shown.len() as f32;
        let lost: Vec<usize> = shown.into_iter().filter(lost).collect();
        if part < least || !lost.is_empty() {
            let path = picture.write_png(&format!("{name}-{i}"), &lost);
            panic!("{name}, view {i}: {part} stays, {} gaps; see {}", lost.len(), path.display());
        }
    }
}

#[test]
fn plates_of_one_voxel_stay_visible() {
    for axis in 0..3 {
        let across = |v: [i32; 3]| (0..3).filter(|&i| i != axis).all(|i| (10..54).contains(&v[i]));
        let plate = DenseVolume::from_fn(64, |v| v[axis] == 31 && across(v));
        assert_stays_whole(&format!("plate-{axis}"), &plate, 0.88);
    }
}

/// The rods' edges are rounded off, so that they look thinner along a diagonal.
#[test]
fn rods_of_one_voxel_stay_visible() {
    for axis in 0..3 {
        let across = |v: [i32; 3]| (0..3).filter(|&i| i != axis).all(|i| v[i] == 31);
        let rod = DenseVolume::from_fn(64, |v| (10..54).contains(&v[axis]) && across(v));
        assert_stays_whole(&format!("rod-{axis}"), &rod, 0.45);
    }
}

/// Tests grooves across each face of a block, along both axes. Of the pixels that show the inside of a groove
/// at least a voxel deep, the fast path shows 85 % at least half a voxel deep from every direction, and 97 %
/// overall. The grooves look at least 0.7 times as deep as they are.
#[test]
fn grooves_of_two_voxels_stay_visible() {
    let (mut all, mut all_kept) = (0, 0);
    for (face, across) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
        let groove = |v: [i32; 3]| v[face] >= 44 && [20, 21, 28, 29, 36, 37].contains(&v[across]);
        let block =
            DenseVolume::from_fn(64, |v| v.iter().all(|c| (10..50).contains(c)) && !groove(v));
        let depth = |at: Vec3| 50.0 - at[face];
        for (i, picture) in take_pictures(&block) {
            let shown: Vec<usize> = (0..picture.exact.len())
                .filter(|&pixel| {
                    let before = picture.exact[pixel].is_some_and(|entry| groove(entry.before));
                    before && picture.exact_point(pixel).is_some_and(|at| depth(at) >= 1.0)
                })
                .collect();
            let deep = |pixel: usize| picture.fast[pixel].map_or(0.0, |at| depth(at.position));
            let lost: Vec<usize> = shown.iter().copied().filter(|&i| deep(i) < 0.5).collect();
            let kept = shown.len() - lost.len();
            (all, all_kept) = (all + shown.len(), all_kept + kept);
            if shown.len() < picture.exact.len() / 200 {
                continue;
            }
            let exact: f32 = shown.iter().filter_map(|&i| picture.exact_point(i)).map(depth).sum();
            let look: f32 = shown.iter().map(|&i| deep(i)).sum();
            let (part, look) = (kept as f32 / shown.len() as f32, look / exact);
            if part < 0.85 || look < 0.7 {
                let path = picture.write_png(&format!("groove-{face}-{across}-{i}"), &lost);
                panic!("face {face}: {part} stay, {look} as deep; see {}", path.display());
            }
        }
    }
    println!("{all_kept} of {all} pixels show a groove");
    assert!(all_kept as f32 >= 0.97 * all as f32);
}
