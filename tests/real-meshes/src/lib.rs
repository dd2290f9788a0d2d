//! The meshes beside the checkout, in `../shared/meshes`, which are no part of the project.
//! It takes a file's name and gives the mesh, or says that the test is skipped.
//! Nothing stands in for a mesh that is missing: `tests/files` bakes meshes of the project's own.

use std::path::Path;

use paros_shell::mesh::{self, Mesh};
use paros_shell::require::require_or_skip;

/// A mesh from the folder beside the checkout, or none after `skipped: why` where it is missing.
///
/// # Panics
/// It is missing and `PAROS_REQUIRE` is `all`; it is no mesh.
#[must_use]
pub fn real_mesh(name: &str) -> Option<Mesh> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/meshes").join(name);
    let found = path.is_file().then_some(()).ok_or_else(|| format!("no ../shared/meshes/{name}"));
    require_or_skip(found).expect("the meshes beside the checkout")?;
    Some(mesh::read(&path).expect("a mesh"))
}
