//! Boxes of the solid textures, written by one dispatch where a program may do so.
//!
//! A copy takes some drivers two microseconds for each slice of each box, and a stroke's boxes have
//! thirty. What can't be written so is copied: see `textures`.

use std::sync::Arc;

use ash::vk;
use bytemuck::{Pod, Zeroable};

use super::buffer::Buffer;
use super::context::Gpu;
use super::error::{Doing, Error};
use super::image::Image;
use super::owned::Owned;
use super::programs;
use super::recipe::Module;
use super::staging::{REGIONS, Staging};
use super::textures::{LEVELS, Textures};
use crate::upload::{Region, Texture};

/// The density's levels, and the cells.
const IMAGES: usize = LEVELS as usize + 1;
/// A frame's boxes and its staged bytes, the set's first bindings; the textures follow.
const BUFFERS: usize = 2;
/// Groups of threads that share a box.
const SHARES: u32 = 16;

/// A box of texels, as `wgsl/scatter.wgsl` has it.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Patch {
    texture: u32,
    at: u32,
    min: [u32; 3],
    size: [u32; 3],
}

/// The program, and what it reads and writes in each frame of the ring.
pub(super) struct Scatter {
    gpu: Arc<Gpu>,
    pipeline: Owned<vk::Pipeline>,
    layout: Owned<vk::PipelineLayout>,
    _set_layout: Owned<vk::DescriptorSetLayout>,
    _views: Vec<Owned<vk::ImageView>>,
    _pool: Owned<vk::DescriptorPool>,
    slots: Vec<(Buffer, vk::DescriptorSet)>,
}

impl Scatter {
    /// For a sculpture's textures and the ring's staged bytes.
    pub(super) fn new<'a>(
        gpu: &Arc<Gpu>,
        textures: &Textures,
        ring: impl ExactSizeIterator<Item = &'a Staging>,
        cache: vk::PipelineCache,
    ) -> Result<Self, Error> {
        let set_layout = set_layout(gpu)?;
        let layouts = [set_layout.raw];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts);
        // SAFETY: the set's layout is this device's.
        let layout = unsafe { gpu.device.create_pipeline_layout(&info, None) }
            .doing("lay a pipeline out")?;
        let layout = Owned::new(gpu, layout);
        let pipeline = pipeline(gpu, layout.raw, cache)?;
        let level = |image, level| view(gpu, image, level);
        let mut views =
            (0..LEVELS).map(|i| level(&textures.density, i)).collect::<Result<Vec<_>, _>>()?;
        views.push(level(&textures.cells, 0)?);
        let pool = pool(gpu, ring.len() as u32)?;
        let slot = |staging: &Staging| {
            let size = REGIONS * size_of::<Patch>();
            let boxes = Buffer::new(gpu, size, vk::BufferUsageFlags::STORAGE_BUFFER)?;
            let info = vk::DescriptorSetAllocateInfo::default()
                .descriptor_pool(pool.raw)
                .set_layouts(&layouts);
            // SAFETY: the pool has room for a set of this layout for each frame of the ring.
            let set = unsafe { gpu.device.allocate_descriptor_sets(&info) }.doing("make a set")?[0];
            write(gpu, set, [&boxes, &staging.buffer], &views);
            Ok((boxes, set))
        };
        let slots = ring.map(slot).collect::<Result<_, _>>()?;
        Ok(Scatter {
            gpu: gpu.clone(),
            pipeline,
            layout,
            _set_layout: set_layout,
            _views: views,
            _pool: pool,
            slots,
        })
    }

    /// Whether a region is one of those that [`Scatter::record`] writes.
    pub(super) const fn takes(region: &Region) -> bool {
        number(region.texture).is_some()
    }

    /// Records what writes the regions it [takes], no two of which overlap, in a frame of the ring;
    /// their images are in the layout `GENERAL`.
    ///
    /// [takes]: Scatter::takes
    pub(super) fn record(&mut self, commands: vk::CommandBuffer, frame: usize, staging: &Staging) {
        let (boxes, set) = &mut self.slots[frame];
        let mut count = 0;
        for (region, at) in &staging.regions {
            let Some(texture) = number(region.texture) else { continue };
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
            device.cmd_dispatch(commands, count, SHARES, 1);
        }
    }
}

/// The texture's number in the program.
const fn number(texture: Texture) -> Option<u32> {
    match texture {
        Texture::Density(level) => Some(level as u32),
        Texture::Cells => Some(LEVELS),
        Texture::Maps | Texture::Noise | Texture::Marble => None,
    }
}

fn set_layout(gpu: &Arc<Gpu>) -> Result<Owned<vk::DescriptorSetLayout>, Error> {
    let mut bindings = [vk::DescriptorSetLayoutBinding::default(); BUFFERS + IMAGES];
    for (i, binding) in bindings.iter_mut().enumerate() {
        let kind = match i < BUFFERS {
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
    let raw =
        unsafe { gpu.device.create_descriptor_set_layout(&info, None) }.doing("lay a set out")?;
    Ok(Owned::new(gpu, raw))
}

fn pipeline(
    gpu: &Arc<Gpu>,
    layout: vk::PipelineLayout,
    cache: vk::PipelineCache,
) -> Result<Owned<vk::Pipeline>, Error> {
    let module = Module::new(gpu, programs::SCATTER)?;
    let stage = vk::PipelineShaderStageCreateInfo::default()
        .stage(vk::ShaderStageFlags::COMPUTE)
        .module(module.raw)
        .name(c"compute");
    let infos = [vk::ComputePipelineCreateInfo::default().stage(stage).layout(layout)];
    // SAFETY: the program reads and writes what the layout has.
    let made = unsafe { gpu.device.create_compute_pipelines(cache, &infos, None) };
    let raw = made.map_err(|(_, result)| result).doing("make a pipeline")?[0];
    Ok(Owned::new(gpu, raw))
}

fn view(gpu: &Arc<Gpu>, image: &Image, level: u32) -> Result<Owned<vk::ImageView>, Error> {
    let range =
        vk::ImageSubresourceRange { base_mip_level: level, level_count: 1, ..image.range() };
    let info = vk::ImageViewCreateInfo::default()
        .image(image.raw)
        .view_type(vk::ImageViewType::TYPE_3D)
        .format(image.shape.format)
        .subresource_range(range);
    // SAFETY: the image is bound, and outlives the view.
    let raw = unsafe { gpu.device.create_image_view(&info, None) }.doing("view a level")?;
    Ok(Owned::new(gpu, raw))
}

fn pool(gpu: &Arc<Gpu>, sets: u32) -> Result<Owned<vk::DescriptorPool>, Error> {
    let size =
        |ty, each: usize| vk::DescriptorPoolSize { ty, descriptor_count: sets * each as u32 };
    let sizes = [
        size(vk::DescriptorType::STORAGE_BUFFER, BUFFERS),
        size(vk::DescriptorType::STORAGE_IMAGE, IMAGES),
    ];
    let info = vk::DescriptorPoolCreateInfo::default().max_sets(sets).pool_sizes(&sizes);
    // SAFETY: the info is complete.
    let raw = unsafe { gpu.device.create_descriptor_pool(&info, None) }.doing("make a pool")?;
    Ok(Owned::new(gpu, raw))
}

fn write(
    gpu: &Gpu,
    set: vk::DescriptorSet,
    buffers: [&Buffer; BUFFERS],
    views: &[Owned<vk::ImageView>],
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
    let mut writes = Vec::with_capacity(BUFFERS + IMAGES);
    for (i, info) in buffers.chunks(1).enumerate() {
        let kind = vk::DescriptorType::STORAGE_BUFFER;
        writes.push(one(i).descriptor_type(kind).buffer_info(info));
    }
    for (i, info) in images.chunks(1).enumerate() {
        let kind = vk::DescriptorType::STORAGE_IMAGE;
        writes.push(one(BUFFERS + i).descriptor_type(kind).image_info(info));
    }
    // SAFETY: the set is new, and what is named lives as long as it.
    unsafe { gpu.device.update_descriptor_sets(&writes, &[]) };
}
