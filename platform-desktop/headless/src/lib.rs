//! What the desktop's commands and its bench share. It takes volumes and gives pictures, drawn by a
//! Vulkan device without a window, and it has the [`Error`] that a command ends with. It knows neither
//! the commands nor the window.
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
