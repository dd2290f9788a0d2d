//! Texture uploads by compute: one dispatch writes all staged boxes of the 3D textures.
//!
//! On some drivers a copy takes two microseconds for each slice of each box, and a stroke's boxes have
//! thirty. Other textures are uploaded by copies: see `textures`.

use core::mem::offset_of;
use std::sync::Arc;

use ash::vk;
use bytemuck::{Pod, Zeroable};

use super::programs;
use super::spec::ShaderModule;
use crate::constants::BINDING_LEVELS;
use crate::field::LEVELS;
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::owned::OwnedHandle;
use crate::gpu::memory::buffer::Buffer;
use crate::gpu::memory::image::GpuImage;
use crate::gpu::memory::staging::{MAX_REGIONS, Staging};
use crate::gpu::memory::textures::SculptureTextures;
use crate::upload::{Region, Texture};

/// Number of storage images: the density's levels, then the cells (`BINDING_CELL_IMAGE`) and the gradient.
const IMAGE_COUNT: usize = LEVELS + 2;
/// Number of storage buffers, the first bindings of the set: patches and staged bytes. The images follow.
const BUFFER_COUNT: usize = BINDING_LEVELS as usize;
/// Workgroups for each patch.
const GROUPS_PER_PATCH: u32 = 16;

/// A box of texels and the offset of its bytes; mirrors `wgsl/scatter.wgsl`, and the build checks the
/// offsets.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Patch {
    texture: u32,
    at: u32,
    min: [u32; 3],
    size: [u32; 3],
}

include!(concat!(env!("OUT_DIR"), "/scatter.rs"));

/// The compute pipeline, with a patch buffer and a descriptor set for each frame of the ring.
pub(crate) struct TexelWriter {
    gpu: Arc<Gpu>,
    pipeline: OwnedHandle<vk::Pipeline>,
    layout: OwnedHandle<vk::PipelineLayout>,
    _set_layout: OwnedHandle<vk::DescriptorSetLayout>,
    _views: Vec<OwnedHandle<vk::ImageView>>,
    _pool: OwnedHandle<vk::DescriptorPool>,
    slots: Vec<(Buffer, vk::DescriptorSet)>,
}

impl TexelWriter {
    /// Creates the writer for a sculpture's textures and the staging buffers of the ring.
    pub(crate) fn new<'a>(
        gpu: &Arc<Gpu>,
        textures: &SculptureTextures,
        staging_ring: impl ExactSizeIterator<Item = &'a Staging>,
        cache: vk::PipelineCache,
    ) -> Result<Self, Error> {
        let set_layout = create_set_layout(gpu)?;
        let layouts = [set_layout.raw];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts);
        // SAFETY: the set's layout is this device's.
        let layout = unsafe { gpu.device.create_pipeline_layout(&info, None) }
            .could_not("lay a pipeline out")?;
        let layout = OwnedHandle::new(gpu, layout);
        let pipeline = create_pipeline(gpu, layout.raw, cache)?;
        let level = |image, level| create_level_view(gpu, image, level);
        let mut views = (0..LEVELS as u32)
            .map(|i| level(&textures.density, i))
            .collect::<Result<Vec<_>, _>>()?;
        views.push(level(&textures.cells, 0)?);
        views.push(level(&textures.gradient, 0)?);
        let pool = create_pool(gpu, staging_ring.len() as u32)?;
        let slot = |staging: &Staging| {
            let size = MAX_REGIONS * size_of::<Patch>();
            let boxes = Buffer::new(gpu, size, vk::BufferUsageFlags::STORAGE_BUFFER)?;
            let info = vk::DescriptorSetAllocateInfo::default()
                .descriptor_pool(pool.raw)
                .set_layouts(&layouts);
            // SAFETY: the pool has room for a set of this layout for each frame of the ring.
            let set =
                unsafe { gpu.device.allocate_descriptor_sets(&info) }.could_not("make a set")?[0];
            write_set(gpu, set, [&boxes, &staging.buffer], &views);
            Ok((boxes, set))
        };
        let slots = staging_ring.map(slot).collect::<Result<_, _>>()?;
        Ok(TexelWriter {
            gpu: gpu.clone(),
            pipeline,
            layout,
            _set_layout: set_layout,
            _views: views,
            _pool: pool,
            slots,
        })
    }

    /// Returns `true` if [`TexelWriter::record_non_overlapping_writes`] writes a region.
    pub(crate) const fn can_write(region: &Region) -> bool {
        image_index(region.texture).is_some()
    }

    /// Records the dispatch that writes the staged regions that it [can write], with a slot of the ring. No
    /// two of these regions may overlap, and their images must be in the layout `GENERAL`.
    ///
    /// [can write]: TexelWriter::can_write
    pub(crate) fn record_non_overlapping_writes(
        &mut self,
        commands: vk::CommandBuffer,
        slot_index: usize,
        staging: &Staging,
    ) {
        let (boxes, set) = &mut self.slots[slot_index];
        let mut count = 0;
        for (region, at) in &staging.regions {
            let Some(texture) = image_index(region.texture) else { continue };
            let (min, size) = (region.min, region.size);
            let one = Patch { texture, at: *at as u32, min, size };
            boxes.write(count as usize * size_of::<Patch>(), bytemuck::bytes_of(&one));
            count += 1;
        }
        let (device, compute) = (&self.gpu.device, vk::PipelineBindPoint::COMPUTE);
        // SAFETY: the set has the layout's bindings and what it names is alive; each box lies within
        // its texture and its bytes within those staged.
        unsafe {
            device.cmd_bind_pipeline(commands, compute, self.pipeline.raw);
            let layout = self.layout.raw;
            device.cmd_bind_descriptor_sets(commands, compute, layout, 0, &[*set], &[]);
            device.cmd_dispatch(commands, count, GROUPS_PER_PATCH, 1);
        }
    }
}

/// Returns the texture's index in the program; `None` if the program can't write it.
const fn image_index(texture: Texture) -> Option<u32> {
    match texture {
        Texture::Density(level) => Some(level as u32),
        Texture::Cells => Some(LEVELS as u32),
        Texture::Gradient => Some(LEVELS as u32 + 1),
        Texture::Maps(_) | Texture::Noise | Texture::Marble => None,
    }
}

fn create_set_layout(gpu: &Arc<Gpu>) -> Result<OwnedHandle<vk::DescriptorSetLayout>, Error> {
    let mut bindings = [vk::DescriptorSetLayoutBinding::default(); BUFFER_COUNT + IMAGE_COUNT];
    for (i, binding) in bindings.iter_mut().enumerate() {
        let kind = match i < BUFFER_COUNT {
            true => vk::DescriptorType::STORAGE_BUFFER,
            false => vk::DescriptorType::STORAGE_IMAGE,
        };
        *binding = binding
            .binding(i as u32)
            .descriptor_type(kind)
            .descriptor_count(1)
            .stage_flags(vk::ShaderStageFlags::COMPUTE);
    }
    let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
    // SAFETY: the info is complete.
    let raw = unsafe { gpu.device.create_descriptor_set_layout(&info, None) }
        .could_not("lay a set out")?;
    Ok(OwnedHandle::new(gpu, raw))
}

fn create_pipeline(
    gpu: &Arc<Gpu>,
    layout: vk::PipelineLayout,
    cache: vk::PipelineCache,
) -> Result<OwnedHandle<vk::Pipeline>, Error> {
    let module = ShaderModule::new(gpu, programs::SCATTER)?;
    let stage = vk::PipelineShaderStageCreateInfo::default()
        .stage(vk::ShaderStageFlags::COMPUTE)
        .module(module.raw)
        .name(c"compute");
    let infos = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout)];
    // SAFETY: the program reads and writes what the layout has.
    let made = unsafe { gpu.device.create_compute_pipelines(cache, &infos, None) };
    let raw = made.map_err(|(_, result)| result).could_not("make a pipeline")?[0];
    Ok(OwnedHandle::new(gpu, raw))
}

fn create_level_view(
    gpu: &Arc<Gpu>,
    image: &GpuImage,
    mip_level: u32,
) -> Result<OwnedHandle<vk::ImageView>, Error> {
    let range = vk::ImageSubresourceRange {
        base_mip_level: mip_level,
        level_count: 1,
        ..image.full_range()
    };
    let info = vk::ImageViewCreateInfo::default()
        .image(image.raw)
        .view_type(vk::ImageViewType::TYPE_3D)
        .format(image.spec.format)
        .subresource_range(range);
    // SAFETY: the image is bound, and outlives the view.
    let raw = unsafe { gpu.device.create_image_view(&info, None) }.could_not("view a level")?;
    Ok(OwnedHandle::new(gpu, raw))
}

fn create_pool(gpu: &Arc<Gpu>, set_count: u32) -> Result<OwnedHandle<vk::DescriptorPool>, Error> {
    let size =
        |ty, each: usize| vk::DescriptorPoolSize { ty, descriptor_count: set_count * each as u32 };
    let sizes = [
        size(vk::DescriptorType::STORAGE_BUFFER, BUFFER_COUNT),
        size(vk::DescriptorType::STORAGE_IMAGE, IMAGE_COUNT),
    ];
    let info = vk::DescriptorPoolCreateInfo::default().max_sets(set_count).pool_sizes(&sizes);
    // SAFETY: the info is complete.
    let raw = unsafe { gpu.device.create_descriptor_pool(&info, None) }.could_not("make a pool")?;
    Ok(OwnedHandle::new(gpu, raw))
}

fn write_set(
    gpu: &Gpu,
    set: vk::DescriptorSet,
    buffers: [&Buffer; BUFFER_COUNT],
    views: &[OwnedHandle<vk::ImageView>],
) {
    let buffers = buffers.map(|buffer| vk::DescriptorBufferInfo {
        buffer: buffer.raw,
        offset: 0,
        range: vk::WHOLE_SIZE,
    });
    let images: Vec<_> = views
        .iter()
        .map(|view| {
            let layout = vk::ImageLayout::GENERAL;
            vk::DescriptorImageInfo::default().image_view(view.raw).image_layout(layout)
        })
        .collect();
    let one =
        |binding: usize| vk::WriteDescriptorSet::default().dst_set(set).dst_binding(binding as u32);
    let mut writes = Vec::with_capacity(BUFFER_COUNT + IMAGE_COUNT);
    for (i, info) in buffers.chunks(1).enumerate() {
        let kind = vk::DescriptorType::STORAGE_BUFFER;
        writes.push(one(i).descriptor_type(kind).buffer_info(info));
    }
    for (i, info) in images.chunks(1).enumerate() {
        let kind = vk::DescriptorType::STORAGE_IMAGE;
        writes.push(one(BUFFER_COUNT + i).descriptor_type(kind).image_info(info));
    }
    // SAFETY: the set is new, and what is named lives as long as it.
    unsafe { gpu.device.update_descriptor_sets(&writes, &[]) };
}
