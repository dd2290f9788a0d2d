//! The studio's meshes, written as tables of vertices and indices.

use std::path::Path;

/// Writes the meshes into the folder `out`.
pub(crate) fn write(_out: &Path) {}
