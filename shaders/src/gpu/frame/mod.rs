//! Frames: a shell's request, and the renderer that records and submits it.
//! Takes a request (eyes, the sculpture's placement, light, scene) and regions to upload, and draws into a
//! render target; knows nothing of windows, sessions or the pictures' destination.

pub(crate) mod compiled;
mod mesh_buffers;
pub(crate) mod offscreen;
pub(crate) mod record;
pub(crate) mod renderer;
pub(crate) mod request;
pub(crate) mod slot;
pub(crate) mod uniforms;
pub(crate) mod world_renderer;
