//! Things of a device that go with their owner, so that none is left where a later call fails.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;

/// A thing that its owner has waited for before it is dropped.
pub(super) struct Owned<T: Destroy> {
    gpu: Arc<Gpu>,
    pub(super) raw: T,
}

impl<T: Destroy> Owned<T> {
    /// For a thing that was made on this device, and that nobody else destroys.
    pub(super) fn new(gpu: &Arc<Gpu>, raw: T) -> Self {
        Owned { gpu: gpu.clone(), raw }
    }
}

impl<T: Destroy> Drop for Owned<T> {
    fn drop(&mut self) {
        // SAFETY: it is this device's, destroyed once, and its owner has waited for the device.
        unsafe { self.raw.destroy(&self.gpu.device) };
    }
}

/// What a device destroys by a call of its own.
pub(super) trait Destroy: Copy {
    /// Destroys it.
    ///
    /// # Safety
    /// It is this device's, and nothing uses it any more.
    unsafe fn destroy(self, device: &ash::Device);
}

macro_rules! destroyed {
    ($($kind:ty: $call:ident),*) => {$(
        impl Destroy for $kind {
            unsafe fn destroy(self, device: &ash::Device) {
                // SAFETY: as the caller has it.
                unsafe { device.$call(self, None) };
            }
        }
    )*};
}

destroyed! {
    vk::CommandPool: destroy_command_pool,
    vk::DescriptorPool: destroy_descriptor_pool,
    vk::DescriptorSetLayout: destroy_descriptor_set_layout,
    vk::Fence: destroy_fence,
    vk::Framebuffer: destroy_framebuffer,
    vk::ImageView: destroy_image_view,
    vk::Pipeline: destroy_pipeline,
    vk::PipelineLayout: destroy_pipeline_layout,
    vk::Sampler: destroy_sampler
}
