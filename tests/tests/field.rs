//! The textures of the fast path against their definition.

use paros_core::maps::Maps;
use paros_shaders::field::{Field, LEVELS, cell};
use paros_tests::models::dense::{Dense, voxels};
use paros_tests::models::field::{FieldModel, index, places};
use proptest::prelude::*;

fn check<const N: usize>(dense: &Dense) {
    let mut maps = Box::new(Maps::<N>::new());
    dense.write_maps(&mut maps);
    let mut field = Field::<N>::new();
    field.rebuild(&maps);
    let model = FieldModel::new(dense);
    for level in 0..LEVELS {
        let side = model.side(level);
        assert_eq!(field.side(level), side as usize);
        for at in places(side) {
            let texel = field.texel(level, at.map(|c| c as usize));
            assert_eq!(texel, model.density[level][index(at, side)], "level {level}, texel {at:?}");
        }
    }
    let side = model.side(0) / cell(N) as i32;
    assert_eq!(field.cells_side(), side as usize);
    for at in places(side) {
        let free = field.cell(at.map(|c| c as usize));
        assert_eq!(free, model.cells[index(at, side)], "cell {at:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_rebuild_follows_the_definition_on_16(dense in voxels(16)) {
        check::<16>(&dense.closure());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    /// More than one box along each axis.
    #[test]
    fn a_rebuild_follows_the_definition_on_64(dense in voxels(64)) {
        check::<64>(&dense.closure());
    }
}
