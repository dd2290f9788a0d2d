//! Images with their views, each in memory of its own.

use std::sync::Arc;

use ash::vk;

use super::buffer::allocate;
use super::context::Gpu;
use super::error::{Doing, Error};

/// What an image is to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) format: vk::Format,
    pub(super) extent: [u32; 3],
    pub(super) layers: u32,
    pub(super) levels: u32,
    pub(super) samples: vk::SampleCountFlags,
    pub(super) usage: vk::ImageUsageFlags,
}

impl Shape {
    pub(super) const fn flat(format: vk::Format, [w, h]: [u32; 2], layers: u32) -> Self {
        Shape {
            format,
            extent: [w, h, 1],
            layers,
            levels: 1,
            samples: vk::SampleCountFlags::TYPE_1,
            usage: vk::ImageUsageFlags::empty(),
        }
    }

    pub(super) const fn usage(self, usage: vk::ImageUsageFlags) -> Self {
        Shape { usage, ..self }
    }

    const fn is_solid(&self) -> bool {
        self.extent[2] > 1
    }
}

/// An image of the device's own memory with a view of all of it.
pub(super) struct Image {
    gpu: Arc<Gpu>,
    pub(super) raw: vk::Image,
    pub(super) view: vk::ImageView,
    memory: vk::DeviceMemory,
    pub(super) shape: Shape,
}

impl Image {
    pub(super) fn new(gpu: &Arc<Gpu>, shape: Shape) -> Result<Self, Error> {
        let solid = shape.is_solid();
        let [width, height, depth] = shape.extent;
        let info = vk::ImageCreateInfo::default()
            .image_type(if solid { vk::ImageType::TYPE_3D } else { vk::ImageType::TYPE_2D })
            .format(shape.format)
            .extent(vk::Extent3D { width, height, depth })
            .mip_levels(shape.levels)
            .array_layers(shape.layers)
            .samples(shape.samples)
            .usage(shape.usage);
        // SAFETY: the device is alive and the info complete.
        let raw = unsafe { gpu.device.create_image(&info, None) }.doing("make an image")?;
        let mut image = Image {
            gpu: gpu.clone(),
            raw,
            view: vk::ImageView::null(),
            memory: vk::DeviceMemory::null(),
            shape,
        };
        // SAFETY: the image was made on this device.
        let needs = unsafe { gpu.device.get_image_memory_requirements(raw) };
        let mut kind = vk::MemoryPropertyFlags::DEVICE_LOCAL;
        if shape.usage.contains(vk::ImageUsageFlags::TRANSIENT_ATTACHMENT) {
            kind |= vk::MemoryPropertyFlags::LAZILY_ALLOCATED;
        }
        image.memory = allocate(gpu, needs, kind)?;
        // SAFETY: the memory fits the image's requirements and is bound once.
        unsafe { gpu.device.bind_image_memory(raw, image.memory, 0) }.doing("bind an image")?;
        let kind =
            if solid { vk::ImageViewType::TYPE_3D } else { vk::ImageViewType::TYPE_2D_ARRAY };
        let info = vk::ImageViewCreateInfo::default()
            .image(raw)
            .view_type(kind)
            .format(shape.format)
            .subresource_range(image.range());
        // SAFETY: the image is bound.
        image.view = unsafe { gpu.device.create_image_view(&info, None) }.doing("view an image")?;
        Ok(image)
    }

    /// All of the image.
    pub(super) fn range(&self) -> vk::ImageSubresourceRange {
        vk::ImageSubresourceRange {
            aspect_mask: aspect(self.shape.format),
            base_mip_level: 0,
            level_count: self.shape.levels,
            base_array_layer: 0,
            layer_count: self.shape.layers,
        }
    }
}

impl Image {
    /// From one layout to another, after what used it in the first.
    pub(super) fn barrier(
        &self,
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) -> vk::ImageMemoryBarrier<'static> {
        vk::ImageMemoryBarrier::default()
            .image(self.raw)
            .subresource_range(self.range())
            .old_layout(from)
            .new_layout(to)
            .src_access_mask(use_of(from).1)
            .dst_access_mask(use_of(to).1)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe {
            self.gpu.device.destroy_image_view(self.view, None);
            self.gpu.device.destroy_image(self.raw, None);
            self.gpu.device.free_memory(self.memory, None);
        }
    }
}

pub(super) const fn aspect(format: vk::Format) -> vk::ImageAspectFlags {
    match format {
        vk::Format::D16_UNORM | vk::Format::D32_SFLOAT | vk::Format::X8_D24_UNORM_PACK32 => {
            vk::ImageAspectFlags::DEPTH
        }
        _ => vk::ImageAspectFlags::COLOR,
    }
}

/// The stages and accesses that use an image in a layout.
pub(super) fn use_of(layout: vk::ImageLayout) -> (vk::PipelineStageFlags, vk::AccessFlags) {
    match layout {
        vk::ImageLayout::TRANSFER_DST_OPTIMAL => {
            (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_WRITE)
        }
        vk::ImageLayout::TRANSFER_SRC_OPTIMAL => {
            (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_READ)
        }
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL => (
            vk::PipelineStageFlags::VERTEX_SHADER | vk::PipelineStageFlags::FRAGMENT_SHADER,
            vk::AccessFlags::SHADER_READ,
        ),
        vk::ImageLayout::GENERAL => {
            (vk::PipelineStageFlags::COMPUTE_SHADER, vk::AccessFlags::SHADER_WRITE)
        }
        _ => (vk::PipelineStageFlags::TOP_OF_PIPE, vk::AccessFlags::empty()),
    }
}
