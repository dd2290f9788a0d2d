//! The fast path's picture of a third-party mesh, against an exact voxel traversal.

use std::sync::Mutex;

use paros_core::volume::BitGrid;
use paros_core::{Baker, RangeMaps};
use paros_models::dense::DenseVolume;
use paros_tests_files::baked::bake;
use paros_tests_real_meshes::real_mesh;
use paros_tests_render::fidelity::{N, assert_hits_agree};

#[test]
fn exact_hits_and_fast_hits_of_the_bunny_lie_together() {
    static BAKER: Mutex<Baker<N>> = Mutex::new(Baker::new());
    static MAPS: Mutex<RangeMaps<N>> = Mutex::new(RangeMaps::new());
    static PLANE: Mutex<BitGrid<N>> = Mutex::new(BitGrid::new());
    let Some(bunny) = real_mesh("stanford-bunny.obj") else { return };
    bake(&bunny, &BAKER, &MAPS, &PLANE);
    assert_hits_agree("bunny", &DenseVolume::from_maps(&MAPS.lock().unwrap()));
}
