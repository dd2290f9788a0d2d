//! Buffers, images and the sculpture's textures on the device, each in memory of its own.
//! Takes sizes, formats and staged bytes, gives handles with their owners and records copies;
//! knows nothing of programs, passes or frames.

pub(crate) mod buffer;
pub(crate) mod image;
pub(crate) mod panel_atlas;
pub(crate) mod panel_pictures;
pub(crate) mod staging;
pub(crate) mod textures;
