//! What is fuzzed, and what must hold of it.

mod files;
mod meshes;
mod saves;
mod steps;

use crate::engine::FuzzTarget;

/// All targets.
pub const ALL: [FuzzTarget; 9] = [
    meshes::OBJ,
    meshes::STL,
    meshes::PLY,
    meshes::GLTF,
    files::RMAP,
    files::TRACE,
    files::INPUT,
    saves::SAVE,
    steps::STEP,
];
