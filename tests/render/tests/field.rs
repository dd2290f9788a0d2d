//! The textures of the fast path against the naive definition.

use paros_core::RangeMaps;
use paros_models::cases::scaled_cases;
use paros_models::dense::{DenseVolume, any_voxels};
use paros_models::field::{FieldModel, grid_index, grid_points};
use paros_models::layers::LayeredVolume;
use paros_shaders::field::{DensityField, LEVELS, cell_side_texels};
use proptest::prelude::*;

/// Checks the textures of the closure of a set of voxels in columns of K intervals.
fn check_rebuild<const N: usize, const K: usize>(voxels: &DenseVolume) {
    let volume = LayeredVolume::new(voxels, K);
    let mut maps = Box::new(RangeMaps::<N, K>::new());
    volume.write_maps(&mut maps);
    let mut field = DensityField::<N, K>::new();
    field.rebuild_from(&maps);
    let model = FieldModel::from_voxels(volume.voxels());
    for level in 0..LEVELS {
        let side = model.texels_per_side(level);
        assert_eq!(field.level_side(level), side as usize);
        for at in grid_points(side) {
            let texel = field.density_texel(level, at.map(|c| c as usize));
            assert_eq!(
                texel,
                model.density[level][grid_index(at, side)],
                "level {level}, texel {at:?}"
            );
        }
    }
    let side = model.texels_per_side(1);
    for at in grid_points(side) {
        let texel = field.outward_texel(at.map(|c| c as usize));
        assert_eq!(texel, model.outward[grid_index(at, side)], "outwards at {at:?}");
        let texel = field.convexity_texel(at.map(|c| c as usize));
        assert_eq!(texel, model.convexity[grid_index(at, side)], "convexity at {at:?}");
    }
    let side = model.texels_per_side(0) / cell_side_texels(N) as i32;
    assert_eq!(field.cells_per_side(), side as usize);
    for at in grid_points(side) {
        let free = field.free_cells_around(at.map(|c| c as usize));
        assert_eq!(free, model.cells[grid_index(at, side)], "cell {at:?}");
    }
}

/// Checks the textures for K of 1, 2 or 4.
fn check_rebuild_with<const N: usize>(voxels: &DenseVolume, intervals: usize) {
    match intervals {
        1 => check_rebuild::<N, 1>(voxels),
        2 => check_rebuild::<N, 2>(voxels),
        _ => check_rebuild::<N, 4>(voxels),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(scaled_cases(30)))]

    #[test]
    fn a_rebuild_follows_the_definition_on_16(
        dense in any_voxels(16),
        intervals in prop_oneof![Just(1usize), Just(2), Just(4)],
    ) {
        check_rebuild_with::<16>(&dense, intervals);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(scaled_cases(1)))]

    /// A grid with more than one box along each axis.
    #[test]
    fn a_rebuild_follows_the_definition_on_64(dense in any_voxels(64), intervals in 1..3usize) {
        check_rebuild_with::<64>(&dense, intervals);
    }
}
