//! Owned handles (RAII): Vulkan objects destroyed on drop, so that none leaks where a later call fails.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;

/// A handle destroyed on drop. Its owner must wait for the device first.
pub(crate) struct OwnedHandle<T: Destroy> {
    gpu: Arc<Gpu>,
    pub(crate) raw: T,
}

impl<T: Destroy> OwnedHandle<T> {
    /// Takes ownership of a handle of this device.
    pub(crate) fn new(gpu: &Arc<Gpu>, raw: T) -> Self {
        OwnedHandle { gpu: gpu.clone(), raw }
    }
}

impl<T: Destroy> Drop for OwnedHandle<T> {
    fn drop(&mut self) {
        // SAFETY: it is this device's, destroyed once, and its owner has waited for the device.
        unsafe { self.raw.destroy(&self.gpu.device) };
    }
}

/// A handle type with a `vkDestroy` call.
pub(crate) trait Destroy: Copy {
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
