//! Offscreen rendering and errors shared by the desktop's commands and its bench.
//!
//! The crate takes volumes and returns pictures, drawn by a Vulkan device without a window, and defines the
//! [`Error`] that a command ends with. It depends neither on the commands nor on the window.
#![forbid(unsafe_code)]

mod error;
mod fetches;
mod picture_size;
mod progress;
mod renderer;

pub use error::{Error, end_program};
pub use fetches::FetchCounts;
pub use picture_size::parse_width_x_height;
pub use progress::{ProgressDisplay, show_progress};
pub use renderer::{
    BACKDROP, HeadlessRenderer, PictureFormat, SculptureView, Uploads, open_gpu, view_of_camera,
};
