//! Third-party meshes, baked against the dense model.

use paros_tests_files::baked::{
    assert_bakes_as_model_also_inside_out, assert_open_base_bakes_alike,
};
use paros_tests_real_meshes::real_mesh;

#[test]
fn bunny_with_its_base_closed_bakes_alike() {
    let Some(bunny) = real_mesh("stanford-bunny.obj") else { return };
    assert_open_base_bakes_alike(&bunny);
}

#[test]
fn real_meshes_inside_out_and_not_agree_with_the_model() {
    for name in ["suzanne.obj", "spot.obj"] {
        let Some(mesh) = real_mesh(name) else { return };
        assert_bakes_as_model_also_inside_out(&mesh);
    }
}
