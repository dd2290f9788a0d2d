//! The Vulkan renderer that both shells drive: commands for a frame, recorded into whatever images
//! the shell names.
//!
//! It draws a sculpture, the studio around it and panels of text. It makes no window, no session
//! and no decision; it never reads a picture back, and waits for nothing but the frame that used
//! the same part of its ring before.

mod buffer;
mod context;
mod error;
pub mod faults;
mod fragments;
mod frame;
mod image;
pub mod layout;
mod needs;
mod offer;
mod offscreen;
pub mod overlay;
mod owned;
mod pass;
mod pipelines;
pub mod programs;
mod recipe;
mod record;
mod renderer;
mod scatter;
mod shadow;
mod show;
mod slot;
mod staging;
mod surface;
mod textures;
mod timers;

pub use context::{Context, Gpu, Instance, Options};
pub use error::Error;
pub use fragments::Fragments;
pub use frame::{Eye, Fov, Look, Order, Parts, Path, Picture, Stand};
pub use needs::Needs;
pub use offscreen::{Layer, Offscreen, read_layer};
pub use pass::Format;
pub use renderer::{Renderer, Sync};
pub use show::{Seen, Show};
pub use surface::Surface;
pub use timers::Times;
