//! Fragment density maps, as a runtime would provide them: images on the shell's device, with an array layer
//! for each eye and full density everywhere.

use std::sync::Mutex;

use ash::vk::{self, Handle};
use openxr::sys;

/// The width and height in pixels that a texel of a density map covers; those of an Adreno.
pub(crate) const TEXEL: u32 = 32;

/// The shell's device.
struct SessionDevice {
    instance: ash::Instance,
    physical: vk::PhysicalDevice,
    raw: ash::Device,
    family: u32,
    queue: u32,
}

static DEVICE: Mutex<Option<SessionDevice>> = Mutex::new(None);

/// Stores the device of a session.
///
/// # Safety
/// The binding is valid, and its device is alive until the session's end.
pub(crate) unsafe fn remember_device(binding: &sys::GraphicsBindingVulkanKHR) {
    let instance = vk::Instance::from_raw(binding.instance as u64);
    let device = vk::Device::from_raw(binding.device as u64);
    // SAFETY: the loader is the one that the shell has open, and the handles are its own.
    let device = unsafe {
        let entry = ash::Entry::load().expect("the loader is open");
        let instance = ash::Instance::load(entry.static_fn(), instance);
        let raw = ash::Device::load(instance.fp_v1_0(), device);
        let physical = vk::PhysicalDevice::from_raw(binding.physical_device as u64);
        let (family, queue) = (binding.queue_family_index, binding.queue_index);
        // The loader must stay open, as it owns the functions.
        core::mem::forget(entry);
        SessionDevice { instance, physical, raw, family, queue }
    };
    *DEVICE.lock().expect("no holder panics") = Some(device);
}

/// A density map, and its memory.
#[derive(Clone, Copy)]
pub(crate) struct DensityMap {
    pub(crate) image: vk::Image,
    memory: vk::DeviceMemory,
}

/// Creates a density map for pictures of an extent in pixels.
pub(crate) fn create_density_map(picture_extent: [u32; 2]) -> DensityMap {
    let device = DEVICE.lock().expect("no holder panics");
    let device = device.as_ref().expect("there is a session");
    let [width, height] = picture_extent.map(|pixels| pixels.div_ceil(TEXEL));
    let info = vk::ImageCreateInfo::default()
        .image_type(vk::ImageType::TYPE_2D)
        .format(vk::Format::R8G8_UNORM)
        .extent(vk::Extent3D { width, height, depth: 1 })
        .mip_levels(1)
        .array_layers(2)
        .samples(vk::SampleCountFlags::TYPE_1)
        .tiling(vk::ImageTiling::OPTIMAL)
        .usage(vk::ImageUsageFlags::FRAGMENT_DENSITY_MAP_EXT | vk::ImageUsageFlags::TRANSFER_DST);
    // SAFETY: the device is alive; all is used as it was made.
    unsafe {
        let image = device.raw.create_image(&info, None).expect("an image");
        let needs = device.raw.get_image_memory_requirements(image);
        let types = device.instance.get_physical_device_memory_properties(device.physical);
        let fits = |kind: &u32| {
            let local = vk::MemoryPropertyFlags::DEVICE_LOCAL;
            needs.memory_type_bits & 1 << kind != 0
                && types.memory_types[*kind as usize].property_flags.contains(local)
        };
        let kind = (0..types.memory_type_count).find(fits).expect("memory");
        let info =
            vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(kind);
        let memory = device.raw.allocate_memory(&info, None).expect("memory");
        device.raw.bind_image_memory(image, memory, 0).expect("bound");
        fill_with_full_density(device, image);
        DensityMap { image, memory }
    }
}

/// Destroys a density map, which must not be in use any more.
pub(crate) fn destroy_density_map(map: DensityMap) {
    let device = DEVICE.lock().expect("no holder panics");
    let device = device.as_ref().expect("there was a session");
    // SAFETY: the session's device outlives its swapchains.
    unsafe {
        device.raw.destroy_image(map.image, None);
        device.raw.free_memory(map.memory, None);
    }
}

/// Fills a density map with full density, and leaves it in the layout in which it is read.
///
/// # Safety
/// The image was just made on the device.
unsafe fn fill_with_full_density(device: &SessionDevice, image: vk::Image) {
    let raw = &device.raw;
    let all = vk::ImageSubresourceRange {
        aspect_mask: vk::ImageAspectFlags::COLOR,
        level_count: 1,
        layer_count: 2,
        ..Default::default()
    };
    let barrier = |from, to| {
        vk::ImageMemoryBarrier::default()
            .old_layout(from)
            .new_layout(to)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .image(image)
            .subresource_range(all)
    };
    let cleared = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
    let turns = [
        barrier(vk::ImageLayout::UNDEFINED, cleared),
        barrier(cleared, vk::ImageLayout::FRAGMENT_DENSITY_MAP_OPTIMAL_EXT),
    ];
    let stage = vk::PipelineStageFlags::TRANSFER;
    let none = vk::DependencyFlags::empty();
    let dense = vk::ClearColorValue { float32: [1.0; 4] };
    // SAFETY: the caller's, and nobody else uses the queue while the shell waits for this.
    unsafe {
        let info = vk::CommandPoolCreateInfo::default().queue_family_index(device.family);
        let pool = raw.create_command_pool(&info, None).expect("a pool");
        let info =
            vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        let buffers = raw.allocate_command_buffers(&info).expect("a buffer");
        let to = buffers[0];
        raw.begin_command_buffer(to, &vk::CommandBufferBeginInfo::default()).expect("begun");
        raw.cmd_pipeline_barrier(to, stage, stage, none, &[], &[], &turns[..1]);
        raw.cmd_clear_color_image(to, image, cleared, &dense, &[all]);
        raw.cmd_pipeline_barrier(to, stage, stage, none, &[], &[], &turns[1..]);
        raw.end_command_buffer(to).expect("ended");
        let queue = raw.get_device_queue(device.family, device.queue);
        let submits = [vk::SubmitInfo::default().command_buffers(&buffers)];
        raw.queue_submit(queue, &submits, vk::Fence::null()).expect("submitted");
        raw.queue_wait_idle(queue).expect("done");
        raw.destroy_command_pool(pool, None);
    }
}
