//! One frame of the renderer's ring: command buffer, fence, buffers and queries.

use std::sync::Arc;

use ash::vk;

use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::owned::OwnedHandle;
use crate::gpu::memory::buffer::Buffer;
use crate::gpu::memory::staging::Staging;
use crate::gpu::passes::fragments::FragmentQueries;
use crate::gpu::passes::timers::TimestampQueries;
use crate::gpu::pipelines::layout::FrameUniforms;
use crate::gpu::pipelines::panel_instance::PanelInstance;
use crate::limits::{INSTANCES, PANEL_QUADS};
use crate::panel::Panel;
use crate::scene::MeshInstance;

/// One frame of the ring.
pub(crate) struct FrameSlot {
    pub(crate) commands: vk::CommandBuffer,
    /// Signaled when the submitted commands are done.
    pub(crate) fence: OwnedHandle<vk::Fence>,
    pub(crate) is_submitted: bool,
    pub(crate) uniform: Buffer,
    /// The scene's mesh instances.
    pub(crate) instances: Buffer,
    /// Quads of the frame's panels; the first `panel_quad_count` are used.
    panel_quads: Buffer,
    pub(crate) panel_quad_count: u32,
    pub(crate) staging: Staging,
    pub(crate) timers: TimestampQueries,
    pub(crate) counters: FragmentQueries,
    /// `true` if the slot's commands drew a picture, and so wrote every timestamp.
    pub(crate) has_picture: bool,
}

impl FrameSlot {
    /// Creates a slot, with a command buffer from a pool, and queries for a number of views.
    pub(crate) fn new(gpu: &Arc<Gpu>, pool: vk::CommandPool, views: u32) -> Result<Self, Error> {
        let device = &gpu.device;
        let info =
            vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: the pool is this device's.
        let commands = unsafe { device.allocate_command_buffers(&info) }
            .could_not("make a command buffer")?[0];
        let info = vk::FenceCreateInfo::default();
        // SAFETY: the info is complete.
        let fence = unsafe { device.create_fence(&info, None) }.could_not("make a fence")?;
        let uniform = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let vertices = vk::BufferUsageFlags::VERTEX_BUFFER;
        Ok(FrameSlot {
            commands,
            fence: OwnedHandle::new(gpu, fence),
            is_submitted: false,
            uniform: Buffer::new(gpu, size_of::<FrameUniforms>(), uniform)?,
            instances: Buffer::new(gpu, INSTANCES * size_of::<MeshInstance>(), vertices)?,
            panel_quads: Buffer::new(gpu, PANEL_QUADS * size_of::<PanelInstance>(), vertices)?,
            panel_quad_count: 0,
            staging: Staging::new(gpu)?,
            timers: TimestampQueries::new(gpu)?,
            counters: FragmentQueries::new(gpu, views)?,
            has_picture: false,
        })
    }

    /// Writes the quads of panels, at most as many as a frame draws.
    pub(crate) fn write_panels(&mut self, panels: &[&[Panel]]) {
        self.panel_quad_count = 0;
        let panels = panels.iter().copied().flatten();
        for quad in panels.flat_map(PanelInstance::of_panel).take(PANEL_QUADS) {
            let at = self.panel_quad_count as usize * size_of::<PanelInstance>();
            self.panel_quads.write(at, bytemuck::bytes_of(&quad));
            self.panel_quad_count += 1;
        }
    }

    /// Returns the buffer of the panels' quads.
    pub(crate) const fn panel_quads(&self) -> vk::Buffer {
        self.panel_quads.raw
    }
}
