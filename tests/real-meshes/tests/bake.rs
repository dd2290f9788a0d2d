//! Meshes that others made, baked against the dense model.

use paros_tests_files::baked::{
    agrees_with_the_model_inside_out_and_not, bakes_alike_with_its_base_closed,
};
use paros_tests_real_meshes::real_mesh;

#[test]
fn bunny_with_its_base_closed_bakes_alike() {
    let Some(bunny) = real_mesh("stanford-bunny.obj") else { return };
    bakes_alike_with_its_base_closed(&bunny);
}

#[test]
fn real_meshes_inside_out_and_not_agree_with_the_model() {
    for name in ["suzanne.obj", "spot.obj"] {
        let Some(mesh) = real_mesh(name) else { return };
        agrees_with_the_model_inside_out_and_not(&mesh);
    }
}
