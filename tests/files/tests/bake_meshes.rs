//! The project's own meshes, baked against the dense model. Other meshes are baked in `tests/real-meshes`.

use std::sync::Mutex;

use glam::IVec3;
use paros_core::convert::{MeshPlacement, UpAxis};
use paros_core::volume::BitGrid;
use paros_core::{Baker, RangeMaps};
use paros_models::bake::{TouchedVoxels, Triangle};
use paros_models::bake_harness::{N, check_bake_moved_into_two_word_rows};
use paros_models::cases::scaled_cases;
use paros_shell::mesh::{Mesh, MeshBounds};
use paros_tests_files::baked::{
    assert_bakes_as_model_also_inside_out, assert_open_base_bakes_alike, bake,
};
use paros_tests_files::shapes::{vase, vase_of_quads, with_holes_closed};

/// Returns a vase for the dense model, whose time grows with the number of triangles. Its quads are smaller
/// than a voxel; in the nightly run they are as small as those of [`vase`].
fn vase_for_model() -> Mesh {
    if scaled_cases(1) > 1 { vase() } else { vase_of_quads(48, 36) }
}

#[test]
fn a_finely_divided_shape_in_rows_of_two_words() {
    let vase = with_holes_closed(&vase_for_model());
    let MeshBounds { min, max } = vase.bounding_box().unwrap();
    let placement = MeshPlacement::stand_bounds_on_floor(min, max, UpAxis::Y, N).unwrap();
    let place =
        |i: u32| (placement.snap_point(vase.positions[i as usize]) + IVec3::Y * 5).to_array();
    let triangles: Vec<Triangle> = vase.triangles.iter().map(|t| t.map(place)).collect();
    let touched = TouchedVoxels::new(N, &triangles);
    let [one, two] = [1, 2].map(|layers| touched.bake(layers));
    assert_eq!(one.opened, 0);
    check_bake_moved_into_two_word_rows::<1>(&triangles, &one).unwrap();
    check_bake_moved_into_two_word_rows::<2>(&triangles, &two).unwrap();
}

#[test]
fn a_vase_with_its_base_closed_bakes_alike() {
    assert_open_base_bakes_alike(&vase());
}

#[test]
fn a_vase_inside_out_and_not_agrees_with_the_model() {
    assert_bakes_as_model_also_inside_out(&vase_for_model());
}

#[test]
fn an_inside_out_mesh_bakes_as_if_it_were_not() {
    static BAKER: Mutex<Baker<64>> = Mutex::new(Baker::new());
    static MAPS: [Mutex<RangeMaps<64>>; 2] = [const { Mutex::new(RangeMaps::new()) }; 2];
    static PLANE: Mutex<BitGrid<64>> = Mutex::new(BitGrid::new());
    let mesh = vase();
    let mut turned = mesh.clone();
    for t in &mut turned.triangles {
        t.swap(1, 2);
    }
    let right = bake(&mesh, &BAKER, &MAPS[0], &PLANE);
    let wrong = bake(&turned, &BAKER, &MAPS[1], &PLANE);
    assert!(!right.flipped && wrong.flipped);
    assert_eq!(right.opened_columns, wrong.opened_columns);
    assert!(*MAPS[0].lock().unwrap() == *MAPS[1].lock().unwrap());
}
