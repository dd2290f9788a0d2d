//! The sculpture's picture by marching rays through its range maps: the GPU half and its CPU twin.
//!
//! The twin is section 4 of the paper as plain Rust on `f32`, one function for one fragment, so
//! that it can stand in where there is no GPU and be the reference a GPU's picture is compared
//! with. Inside the volume lengths are voxels; outside, the studio measures in sides of the cube.

pub mod camera;
pub mod constants;
pub mod fast;
pub mod field;
pub mod fragment;
pub mod gpu;
pub mod harmonics;
pub mod image;
pub mod light;
pub mod limits;
pub mod marble;
pub mod march;
pub mod noise;
pub mod render;
pub mod scene;
pub mod studio;
pub mod surface;
pub mod upload;

pub use camera::Camera;
pub use fragment::{Hit, Scene, Settings, shade};
pub use image::{Image, contact_sheet};
pub use march::Ray;
pub use render::{RenderOptions, portrait, render};
