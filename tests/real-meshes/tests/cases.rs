//! Small files in the dialects of other programs. `tests/files` has a directed test for each dialect.

use paros_core::convert::UpAxis;
use paros_core::volume::{Grid, Size};
use paros_shell::mesh::Mesh;
use paros_shell::statics::Resident;
use paros_tests_files::baked::{bake_voxels, share_in_common};
use paros_tests_real_meshes::read_case;

/// Returns the mesh of an example, which must be readable.
fn case(name: &str) -> Option<Mesh> {
    Some(read_case(name)?.unwrap_or_else(|fault| panic!("{name}: {fault}")))
}

/// Returns the up axis of an example: its format's default, or z for the two examples read with `--up z`.
fn up_of(name: &str) -> UpAxis {
    let is_z_up = name.ends_with(".stl") || ["cad-z-up.obj", "utm.obj"].contains(&name);
    if is_z_up { UpAxis::Z } else { UpAxis::Y }
}

fn assert_all_bake_as<const N: usize>(reference: &str, names: &[&str])
where
    Grid<N>: Size + Resident<N, 2>,
{
    let Some(mesh) = case(reference) else { return };
    let expected = bake_voxels::<N>(&mesh, UpAxis::Y);
    for name in names {
        let Some(mesh) = case(name) else { return };
        let common = share_in_common(&expected, &bake_voxels::<N>(&mesh, up_of(name)));
        assert!(common >= 0.99, "{name} at {N}: {common:.4} in common with {reference}");
    }
}

const SAME: [&str; 18] = [
    "upper.stl",
    "endsolid-missing.stl",
    "nan-normal.stl",
    "continued-faces.obj",
    "nan-ind-normals.obj",
    "vt-one.obj",
    "rgba.obj",
    "strips.ply",
    "blank-line.ply",
    "nan-column.ply",
    "quantized.glb",
    "texture-transform-required.glb",
    "no-minmax.glb",
    "skin-mesh-at-root.glb",
    "utm.obj",
    "cad-z-up.obj",
    "stray-facet.obj",
    "arm-inverted.obj",
];

#[test]
fn the_figure_is_the_same_in_every_dialect() {
    assert_all_bake_as::<128>("ref.obj", &SAME);
    assert_all_bake_as::<256>("ref.obj", &SAME);
}

#[test]
fn turned_shells_bake_as_if_they_were_not() {
    assert_all_bake_as::<128>("all-out.obj", &["arm-inverted.obj"]);
    assert_all_bake_as::<256>("all-out.obj", &["arm-inverted.obj"]);
    let Some(mesh) = case("three-two-inverted.obj") else { return };
    let found = &mesh.findings;
    assert_eq!((found.closed_shells, found.turned_shells, found.cavities), (3, 2, 0));
    assert!(!found.is_inside_out && found.open_edges == 0, "{found:?}");
}

#[test]
fn instances_are_three_figures() {
    let (Some(one), Some(three)) = (case("ref.obj"), case("instancing.glb")) else { return };
    assert_eq!(three.triangles.len(), 3 * one.triangles.len());
}

#[test]
fn a_compressed_mesh_is_refused_in_one_sentence() {
    let Some(read) = read_case("draco.glb") else { return };
    let said = read.expect_err("it is compressed").to_string();
    assert!(said.contains("KHR_draco_mesh_compression is not supported"), "{said}");
    assert!(said.contains("Export the file without compression"), "{said}");
}

#[test]
fn a_facet_without_area_is_dropped_and_reported() {
    let Some(mesh) = case("stray-facet.obj") else { return };
    assert_eq!(mesh.findings.dropped_facets, 1);
}
