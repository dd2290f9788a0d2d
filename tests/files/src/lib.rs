//! What the tests of mesh files share: meshes of the project's own, and what must hold of one that is baked.
//! They take and give meshes.
//! They know no file outside the project: `tests/real-meshes` has the tests that need one.
pub mod baked;
pub mod mesh_samples;
pub mod shapes;
