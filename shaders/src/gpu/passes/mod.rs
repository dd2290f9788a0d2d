//! The render passes, their attachments and their measurements; panels, and uploads.
//! Takes pipelines and memory, gives framebuffers, descriptor sets and parts of a frame's commands; knows
//! nothing of a frame's order, nor of its ring.

pub(crate) mod fragments;
pub mod overlay;
pub(crate) mod render_pass;
pub(crate) mod scale_up;
pub(crate) mod shadow_map;
pub(crate) mod target;
pub(crate) mod timers;
pub(crate) mod upload;
