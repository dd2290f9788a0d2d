//! Tests of the renderer. All are one binary, so that the core is instantiated only once.

mod gpu_faults;
mod gpu_fetches;
mod gpu_order;
mod gpu_panels;
mod gpu_resolution;
mod gpu_scene;
mod gpu_smooth;
mod gpu_textures;
mod gpu_twin;
