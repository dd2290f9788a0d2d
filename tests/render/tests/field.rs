//! The textures of the fast path against their definition.

use paros_core::RangeMaps;
use paros_models::dense::{DenseVolume, any_voxels};
use paros_models::field::{FieldModel, grid_index, grid_points};
use paros_shaders::field::{DensityField, LEVELS, cell_side_texels};
use proptest::prelude::*;

fn check_rebuild<const N: usize>(dense: &DenseVolume) {
    let mut maps = Box::new(RangeMaps::<N>::new());
    dense.write_maps(&mut maps);
    let mut field = DensityField::<N>::new();
    field.rebuild_from(&maps);
    let model = FieldModel::from_voxels(dense);
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
    let side = model.texels_per_side(0) / cell_side_texels(N) as i32;
    assert_eq!(field.cells_per_side(), side as usize);
    for at in grid_points(side) {
        let free = field.free_distance_cells(at.map(|c| c as usize));
        assert_eq!(free, model.cells[grid_index(at, side)], "cell {at:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_rebuild_follows_the_definition_on_16(dense in any_voxels(16)) {
        check_rebuild::<16>(&dense.closure());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    /// More than one box along each axis.
    #[test]
    fn a_rebuild_follows_the_definition_on_64(dense in any_voxels(64)) {
        check_rebuild::<64>(&dense.closure());
    }
}
