//! Images with a view each, each with its own memory allocation; layout transitions.

use std::sync::Arc;

use ash::vk;

use super::buffer::allocate_memory;
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};

/// The parameters of an image.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ImageSpec {
    pub(crate) format: vk::Format,
    pub(crate) extent: [u32; 3],
    pub(crate) layers: u32,
    pub(crate) levels: u32,
    pub(crate) samples: vk::SampleCountFlags,
    pub(crate) usage: vk::ImageUsageFlags,
    /// `true` if memory has fewer texels where a density map makes a pass shade more coarsely. Then only
    /// passes write the image, and only samplers made for it read it.
    pub(crate) is_subsampled: bool,
}

impl ImageSpec {
    /// Returns the spec of a 2D array image of one level and one sample, without usage flags.
    pub(crate) const fn new_2d(format: vk::Format, [w, h]: [u32; 2], layers: u32) -> Self {
        ImageSpec {
            format,
            extent: [w, h, 1],
            layers,
            levels: 1,
            samples: vk::SampleCountFlags::TYPE_1,
            usage: vk::ImageUsageFlags::empty(),
            is_subsampled: false,
        }
    }

    pub(crate) const fn with_usage(self, usage: vk::ImageUsageFlags) -> Self {
        ImageSpec { usage, ..self }
    }

    const fn is_3d(&self) -> bool {
        self.extent[2] > 1
    }
}

/// A device-local image with a view of all levels and layers.
pub(crate) struct GpuImage {
    gpu: Arc<Gpu>,
    pub(crate) raw: vk::Image,
    pub(crate) view: vk::ImageView,
    memory: vk::DeviceMemory,
    pub(crate) spec: ImageSpec,
}

impl GpuImage {
    pub(crate) fn new(gpu: &Arc<Gpu>, spec: ImageSpec) -> Result<Self, Error> {
        let solid = spec.is_3d();
        let [width, height, depth] = spec.extent;
        let flags = match spec.is_subsampled {
            true => vk::ImageCreateFlags::SUBSAMPLED_EXT,
            false => vk::ImageCreateFlags::empty(),
        };
        let info = vk::ImageCreateInfo::default()
            .flags(flags)
            .image_type(if solid { vk::ImageType::TYPE_3D } else { vk::ImageType::TYPE_2D })
            .format(spec.format)
            .extent(vk::Extent3D { width, height, depth })
            .mip_levels(spec.levels)
            .array_layers(spec.layers)
            .samples(spec.samples)
            .usage(spec.usage);
        // SAFETY: the device is alive and the info complete.
        let raw = unsafe { gpu.device.create_image(&info, None) }.could_not("make an image")?;
        let mut image = GpuImage {
            gpu: gpu.clone(),
            raw,
            view: vk::ImageView::null(),
            memory: vk::DeviceMemory::null(),
            spec,
        };
        // SAFETY: the image was made on this device.
        let needs = unsafe { gpu.device.get_image_memory_requirements(raw) };
        let mut kind = vk::MemoryPropertyFlags::DEVICE_LOCAL;
        if spec.usage.contains(vk::ImageUsageFlags::TRANSIENT_ATTACHMENT) {
            kind |= vk::MemoryPropertyFlags::LAZILY_ALLOCATED;
        }
        image.memory = allocate_memory(gpu, needs, kind)?;
        // SAFETY: the memory fits the image's requirements and is bound once.
        unsafe { gpu.device.bind_image_memory(raw, image.memory, 0) }.could_not("bind an image")?;
        let kind =
            if solid { vk::ImageViewType::TYPE_3D } else { vk::ImageViewType::TYPE_2D_ARRAY };
        let info = vk::ImageViewCreateInfo::default()
            .image(raw)
            .view_type(kind)
            .format(spec.format)
            .subresource_range(image.full_range());
        // SAFETY: the image is bound.
        image.view =
            unsafe { gpu.device.create_image_view(&info, None) }.could_not("view an image")?;
        Ok(image)
    }

    /// Returns the subresource range of the whole image.
    pub(crate) fn full_range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange {
            aspect_mask: aspect_of(self.spec.format),
            base_mip_level: 0,
            level_count: self.spec.levels,
            base_array_layer: 0,
            layer_count: self.spec.layers,
        }
    }
}

impl GpuImage {
    /// Returns the barrier of a layout transition of the whole image; accesses are derived from the
    /// layouts.
    pub(crate) fn layout_barrier(
        &self,
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) -> vk::ImageMemoryBarrier<'static> {
        vk::ImageMemoryBarrier::default()
            .image(self.raw)
            .subresource_range(self.full_range())
            .old_layout(from)
            .new_layout(to)
            .src_access_mask(stage_and_access(from).1)
            .dst_access_mask(stage_and_access(to).1)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
    }

    /// Records a transition of the whole image, after its uses in the first layout.
    pub(crate) fn record_transition(
        &self,
        commands: vk::CommandBuffer,
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) {
        let (from_stage, to_stage) = (stage_and_access(from).0, stage_and_access(to).0);
        let barrier = [self.layout_barrier(from, to)];
        let none = vk::DependencyFlags::empty();
        let device = &self.gpu.device;
        // SAFETY: the image is in the layout `from` at this point.
        unsafe {
            device.cmd_pipeline_barrier(commands, from_stage, to_stage, none, &[], &[], &barrier);
        }
    }
}

impl Drop for GpuImage {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe {
            self.gpu.device.destroy_image_view(self.view, None);
            self.gpu.device.destroy_image(self.raw, None);
            self.gpu.device.free_memory(self.memory, None);
        }
    }
}

/// Returns the aspect of a format: depth or colour.
pub(crate) const fn aspect_of(format: vk::Format) -> vk::ImageAspectFlags {
    match format {
        vk::Format::D16_UNORM | vk::Format::D32_SFLOAT | vk::Format::X8_D24_UNORM_PACK32 => {
            vk::ImageAspectFlags::DEPTH
        }
        _ => vk::ImageAspectFlags::COLOR,
    }
}

/// Returns the pipeline stages and accesses that use an image in a layout.
pub(crate) fn stage_and_access(
    layout: vk::ImageLayout,
) -> (vk::PipelineStageFlags, vk::AccessFlags) {
    match layout {
        vk::ImageLayout::TRANSFER_DST_OPTIMAL => {
            (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_WRITE)
        }
        vk::ImageLayout::TRANSFER_SRC_OPTIMAL => {
            (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_READ)
        }
        // Vertex shaders read no texture, so that a tiler's binning doesn't wait for uploads.
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL => {
            (vk::PipelineStageFlags::FRAGMENT_SHADER, vk::AccessFlags::SHADER_READ)
        }
        vk::ImageLayout::GENERAL => {
            (vk::PipelineStageFlags::COMPUTE_SHADER, vk::AccessFlags::SHADER_WRITE)
        }
        _ => (vk::PipelineStageFlags::TOP_OF_PIPE, vk::AccessFlags::empty()),
    }
}
