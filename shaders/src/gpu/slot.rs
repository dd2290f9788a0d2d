//! A frame of the renderer's ring: its commands, its bytes and its clock.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::context::Gpu;
use super::error::{Doing, Error};
use super::fragments::Counters;
use super::layout::Frame;
use super::owned::Owned;
use super::staging::Staging;
use super::timers::Timers;
use crate::limits::INSTANCES;
use crate::scene::Instance;

/// A frame of the ring.
pub(super) struct Slot {
    pub(super) commands: vk::CommandBuffer,
    /// Told by the commands, if they were handed over.
    pub(super) done: Owned<vk::Fence>,
    pub(super) under_way: bool,
    pub(super) uniform: Buffer,
    /// The scene's.
    pub(super) instances: Buffer,
    pub(super) staging: Staging,
    pub(super) timers: Timers,
    pub(super) counters: Counters,
    /// Whether its commands drew a picture, and so set every mark.
    pub(super) drew: bool,
}

impl Slot {
    /// With commands from a pool, for pictures of so many views.
    pub(super) fn new(gpu: &Arc<Gpu>, pool: vk::CommandPool, views: u32) -> Result<Self, Error> {
        let device = &gpu.device;
        let info =
            vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: the pool is this device's.
        let commands =
            unsafe { device.allocate_command_buffers(&info) }.doing("make a command buffer")?[0];
        let info = vk::FenceCreateInfo::default();
        // SAFETY: the info is complete.
        let done = unsafe { device.create_fence(&info, None) }.doing("make a fence")?;
        let uniform = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let vertices = vk::BufferUsageFlags::VERTEX_BUFFER;
        Ok(Slot {
            commands,
            done: Owned::new(gpu, done),
            under_way: false,
            uniform: Buffer::new(gpu, size_of::<Frame>(), uniform)?,
            instances: Buffer::new(gpu, INSTANCES * size_of::<Instance>(), vertices)?,
            staging: Staging::new(gpu)?,
            timers: Timers::new(gpu)?,
            counters: Counters::new(gpu, views)?,
            drew: false,
        })
    }
}
