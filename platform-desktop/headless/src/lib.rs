//! What the desktop's commands and its bench share. It takes volumes and gives pictures, drawn by a
//! Vulkan device without a window, and it has the [`Error`] that a command ends with. It knows neither
//! the commands nor the window.
#![forbid(unsafe_code)]

mod error;
mod fetches;
mod renderer;

pub use error::Error;
pub use fetches::FetchCounts;
pub use renderer::{
    BACKDROP, HeadlessRenderer, PictureFormat, SculptureView, Uploads, open_gpu, view_of_camera,
};
