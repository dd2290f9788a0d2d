//! The shader programs, and the pipelines made of them and of fixed-function state.
//! Takes a device, formats and render passes, gives pipelines and the layouts of their inputs; knows
//! nothing of framebuffers, nor of when something is drawn.

pub(crate) mod graphics;
pub mod layout;
pub(crate) mod overlay_pipeline;
pub(crate) mod panel;
pub(crate) mod panel_instance;
pub(crate) mod paths;
pub mod programs;
pub(crate) mod scatter;
pub(crate) mod spec;
pub(crate) mod vertex_input;
