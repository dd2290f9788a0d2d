//! Placement of meshes: scale, rotation and winding.

use paros_core::convert::{MeshPlacement, UpAxis};
use paros_core::internals::BAKE_UNITS_PER_VOXEL;
use paros_core::volume::BitGrid;
use paros_core::{Baker, RangeMaps};
use paros_tests_files::shapes::vase;
use std::sync::Mutex;

#[test]
fn a_fitted_mesh_stands_on_the_ground_with_a_voxel_free_around_it() {
    static BAKER: Mutex<Baker<64>> = Mutex::new(Baker::new());
    static MAPS: Mutex<RangeMaps<64>> = Mutex::new(RangeMaps::new());
    static PLANE: Mutex<BitGrid<64>> = Mutex::new(BitGrid::new());
    for stretch in [[1.0, 1.0, 1.0], [9.0, 1.0, 1.0], [1.0, 1e8, 1.0], [1e-30, 1e-30, 3e-30]] {
        let mut mesh = vase();
        for p in &mut mesh.positions {
            *p = [0, 1, 2].map(|k| p[k] * stretch[k]);
        }
        let mut maps = MAPS.lock().unwrap();
        let (mut baker, mut plane) = (BAKER.lock().unwrap(), PLANE.lock().unwrap());
        mesh.bake_into_maps(UpAxis::Y, &mut baker, &mut maps, &mut plane).unwrap();
        let voxels = (0..64 * 64 * 64).map(|i| [i % 64, i / 64 % 64, i / 4096]);
        let set: Vec<_> = voxels.filter(|&v| maps.contains(v)).collect();
        let low = [0, 1, 2].map(|k| set.iter().map(|v| v[k]).min().unwrap());
        let high = [0, 1, 2].map(|k| set.iter().map(|v| v[k]).max().unwrap());
        assert_eq!(low[1], 0);
        assert!(low[0] >= 1 && low[2] >= 1 && high.iter().all(|&h| h <= 62), "{low:?} {high:?}");
        assert!((0..3).any(|k| high[k] - low[k] >= 61), "{low:?} {high:?}");
        assert!(low[0].abs_diff(63 - high[0]) <= 1 && low[2].abs_diff(63 - high[2]) <= 1);
    }
}

#[test]
fn z_up_is_a_turn_and_not_a_mirror() {
    let placement =
        MeshPlacement::stand_bounds_on_floor([0.0; 3], [1.0, 2.0, 4.0], UpAxis::Z, 64).unwrap();
    let [o, x, y, z] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]]
        .map(|p| placement.snap_point(p));
    assert!((x - o).x > 0 && (z - o).y > 0 && (y - o).z < 0);
    assert_eq!((o.y, z.y), (0, 63 * BAKE_UNITS_PER_VOXEL - 1));
}

/// Up is z, so the mesh's y becomes the grid's -z, and its ends are swapped.
#[test]
fn a_mesh_longest_along_the_axis_that_turns_over_fits_too() {
    let placement =
        MeshPlacement::stand_bounds_on_floor([0.0; 3], [1.0, 4.0, 2.0], UpAxis::Z, 64).unwrap();
    let [front, back] = [[0.0; 3], [0.0, 4.0, 0.0]].map(|p| placement.snap_point(p).z);
    let margin = BAKE_UNITS_PER_VOXEL + 1;
    assert_eq!((back, front), (margin, 64 * BAKE_UNITS_PER_VOXEL - margin));
}

#[test]
fn a_mesh_away_from_the_origin_stands_in_the_middle() {
    let (min, max) = ([10.0, 20.0, 30.0], [12.0, 21.0, 31.0]);
    let placement = MeshPlacement::stand_bounds_on_floor(min, max, UpAxis::Y, 64).unwrap();
    let (unit, side) = (BAKE_UNITS_PER_VOXEL, 64 * BAKE_UNITS_PER_VOXEL);
    let [low, high, beyond] = [min, max, [100.0; 3]].map(|p| placement.snap_point(p));
    assert_eq!((low.x, high.x, low.y), (unit + 1, side - unit - 1, 0));
    assert!((low.z + high.z - side).abs() <= 1, "{low} {high}");
    assert_eq!((beyond.x, beyond.y, beyond.z), (side, side, side));
    let voxels = f64::from(high.x - low.x) / f64::from(unit);
    assert!((placement.voxels_per_unit() * 2.0 - voxels).abs() < 1e-9);
}

#[test]
fn a_flat_mesh_is_fitted() {
    let flat = MeshPlacement::stand_bounds_on_floor([0.0; 3], [1.0, 0.0, 1.0], UpAxis::Y, 64);
    assert!(flat.is_some());
}

#[test]
fn bounds_that_can_not_be_fitted_are_refused() {
    for (min, max) in [
        ([0.0; 3], [0.0; 3]),
        ([f32::NAN, 0.0, 0.0], [1.0; 3]),
        ([0.0; 3], [f32::INFINITY, 1.0, 1.0]),
        ([2.0; 3], [1.0; 3]),
    ] {
        assert_eq!(MeshPlacement::stand_bounds_on_floor(min, max, UpAxis::Y, 64), None);
    }
}
