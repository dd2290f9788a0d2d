//! Meshes, pictures and files for other programs, made from a kept sculpture.

pub(crate) mod exporter;
pub(crate) mod glb;
pub(crate) mod mesh_check;
pub(crate) mod model;
pub(crate) mod parcel_decode;
pub(crate) mod picture;
pub(crate) mod threemf;
