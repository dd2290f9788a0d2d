//! The meshes beside the checkout, in `../shared/meshes` and `../shared/cases`, which aren't part of the
//! project. A test gets a mesh by its file name, or is skipped. There is no substitute for a missing mesh;
//! `tests/files` bakes the project's own meshes.

use std::fs;
use std::io::Read;
use std::path::Path;

use paros_shell::mesh::{self, Mesh, MeshFault, MeshFormat};
use paros_shell::require::require_or_skip;

/// Returns a mesh from the folder beside the checkout. If it is missing, prints `skipped: why` and returns
/// `None`.
///
/// # Panics
/// The mesh is missing and `PAROS_REQUIRE` is `all`, or the file isn't a mesh.
#[must_use]
pub fn real_mesh(name: &str) -> Option<Mesh> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/meshes").join(name);
    let found = path.is_file().then_some(()).ok_or_else(|| format!("no ../shared/meshes/{name}"));
    require_or_skip(found).expect("the meshes beside the checkout")?;
    Some(mesh::read(&path).expect("a mesh"))
}

/// Returns the mesh of an example, or the error of reading it. If the folder is missing, prints `skipped:
/// why` and returns `None`. The example may be compressed, with `.gz` appended to its name.
///
/// # Panics
/// The folder is missing and `PAROS_REQUIRE` is `all`, or the example is missing in the folder.
#[must_use]
pub fn read_case(name: &str) -> Option<Result<Mesh, MeshFault>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases");
    let found = folder.is_dir().then_some(()).ok_or("no ../shared/cases");
    require_or_skip(found).expect("the examples beside the checkout")?;
    let bytes = fs::read(folder.join(name)).unwrap_or_else(|_| {
        let packed = fs::File::open(folder.join(format!("{name}.gz"))).expect("an example");
        let mut bytes = Vec::new();
        flate2::read::GzDecoder::new(packed).read_to_end(&mut bytes).expect("a compressed example");
        bytes
    });
    let kind = MeshFormat::from_extension(Path::new(name)).expect("a mesh's name");
    Some(Mesh::from_bytes(kind, &bytes, &folder))
}
