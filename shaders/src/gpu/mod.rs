//! The Vulkan renderer that both shells drive: it records a frame's commands into images that the shell
//! gives. It draws a sculpture, the studio around it and panels of text. It creates no window and no
//! session, and decides nothing.
//!
//! Five layers, each of which imports only from those before it: `device`, `memory`, `pipelines`, `passes`,
//! `frame`. The renderer never reads a picture back, and waits only for the earlier frame that used the
//! same slot of its ring.

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
