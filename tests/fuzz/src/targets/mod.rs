//! The fuzz targets and their invariants.

mod enrolments;
mod files;
mod manifests;
mod meshes;
mod outbox;
mod saves;
mod settings;
mod steps;
mod visits;
mod words;

use crate::engine::FuzzTarget;

/// All targets.
pub const ALL: [FuzzTarget; 16] = [
    meshes::OBJ,
    meshes::STL,
    meshes::PLY,
    meshes::GLTF,
    files::RMAP,
    files::TRACE,
    files::INPUT,
    settings::SETTINGS_FILE,
    manifests::MANIFEST,
    saves::SAVE,
    outbox::MESSAGE,
    outbox::PARCEL,
    enrolments::ENROLMENT,
    visits::LAST_USE,
    steps::STEP,
    words::WORDS,
];
