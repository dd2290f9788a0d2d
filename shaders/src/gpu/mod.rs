//! The Vulkan renderer that both shells drive: commands for a frame, recorded into whatever images
//! the shell names. It draws a sculpture, the studio around it and panels of text. It makes no window,
//! no session and no decision.
//!
//! Five layers, each of which imports from those before it alone: `device`, `memory`, `pipelines`,
//! `passes`, `frame`. The renderer never reads a picture back, and waits for nothing but the frame
//! that used the same part of its ring before.

mod device;
mod frame;
mod memory;
mod passes;
mod pipelines;

pub use crate::scene::SculpturePlacement;
pub use device::context::{Gpu, Instance, SharedGpu};
pub use device::error::Error;
pub use device::features::DeviceFeatures;
pub use device::format::TargetFormat;
pub use device::options::Options;
pub use frame::compiled::CompiledRenderer;
pub use frame::offscreen::{ImageLayer, OffscreenTarget, read_layer, write_layer};
pub use frame::renderer::{FrameSemaphores, Renderer};
pub use frame::request::{Eye, Fov, FrameRequest, RenderStyle, SculptureOrder};
pub use frame::world_renderer::{Viewpoint, WorldRenderer};
pub use passes::fragments::FragmentCounts;
pub use passes::overlay;
pub use passes::target::RenderTarget;
pub use passes::timers::FrameTimes;
pub use pipelines::paths::{Drawn, PaperVariant, PixelCounts, RenderPath};
pub use pipelines::{layout, programs};
