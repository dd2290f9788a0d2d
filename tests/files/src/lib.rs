//! Shared parts of the tests of mesh files: the project's own meshes, and the invariants of a baked mesh.
//! They need no file from outside the project; tests that do are in `tests/real-meshes`.
pub mod baked;
pub mod mesh_samples;
pub mod shapes;
