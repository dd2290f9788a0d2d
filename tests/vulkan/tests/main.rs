//! Tests of the renderer: one binary, so that the core is instantiated once.

mod gpu_faults;
mod gpu_fetches;
mod gpu_order;
mod gpu_panels;
mod gpu_resolution;
mod gpu_scene;
mod gpu_smooth;
mod gpu_textures;
mod gpu_twin;
