//! CPU renderer: section 4 of the paper and the fast path in plain Rust on `f32`, a function call for each
//! fragment; the reference for the GPU's pictures. Takes range maps or a
//! [`DensityField`](crate::field::DensityField), a camera and optionally the scene's meshes, gives an
//! [`Image`](image::Image); knows nothing of Vulkan.

mod bvh;
pub mod camera;
pub mod carrara;
pub mod fast;
pub mod fragment;
pub mod harmonics;
pub mod image;
pub mod light;
pub mod marble;
pub mod march;
pub mod noise;
pub mod panels;
pub mod render;
pub mod room;
pub mod studio;
pub mod surface;
