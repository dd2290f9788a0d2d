//! Buffers, each with its own memory allocation: a dozen at the start, none later.

use std::sync::Arc;

use ash::vk;

use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::submit::submit_and_wait;

/// A buffer: host-visible and persistently mapped, or device-local.
pub(crate) struct Buffer {
    gpu: Arc<Gpu>,
    pub(crate) raw: vk::Buffer,
    memory: vk::DeviceMemory,
    /// The mapping; null for a device-local buffer.
    mapped: *mut u8,
    pub(crate) size: usize,
}

// SAFETY: the mapping is the buffer's alone, and is written through `&mut self` only.
unsafe impl Send for Buffer {}

impl Buffer {
    /// Creates a host-visible, host-coherent buffer of `size` bytes, persistently mapped.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        size: usize,
        usage: vk::BufferUsageFlags,
    ) -> Result<Self, Error> {
        let visible =
            vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let mut buffer = Self::create_bound(gpu, size, usage, visible)?;
        let whole = vk::MemoryMapFlags::empty();
        // SAFETY: the memory is visible to the host and mapped once, until it is freed.
        buffer.mapped = unsafe { gpu.device.map_memory(buffer.memory, 0, vk::WHOLE_SIZE, whole) }
            .could_not("map a buffer")?
            .cast();
        Ok(buffer)
    }

    /// Creates a device-local buffer with constant contents. Copies through a staging buffer and waits.
    pub(crate) fn new_device_local(
        gpu: &Arc<Gpu>,
        bytes: &[u8],
        usage: vk::BufferUsageFlags,
    ) -> Result<Self, Error> {
        let mut staged = Self::new(gpu, bytes.len(), vk::BufferUsageFlags::TRANSFER_SRC)?;
        staged.write(0, bytes);
        let usage = usage | vk::BufferUsageFlags::TRANSFER_DST;
        let kind = vk::MemoryPropertyFlags::DEVICE_LOCAL;
        let buffer = Self::create_bound(gpu, bytes.len(), usage, kind)?;
        let copy = vk::BufferCopy { size: bytes.len() as u64, ..vk::BufferCopy::default() };
        submit_and_wait(gpu, |device, commands| {
            // SAFETY: both buffers are as long as the bytes, and live until the wait is over.
            unsafe { device.cmd_copy_buffer(commands, staged.raw, buffer.raw, &[copy]) };
        })?;
        Ok(buffer)
    }

    fn create_bound(
        gpu: &Arc<Gpu>,
        size: usize,
        usage: vk::BufferUsageFlags,
        memory: vk::MemoryPropertyFlags,
    ) -> Result<Self, Error> {
        let info = vk::BufferCreateInfo::default().size(size as u64).usage(usage);
        // SAFETY: the device is alive and the info complete.
        let raw = unsafe { gpu.device.create_buffer(&info, None) }.could_not("make a buffer")?;
        let mut buffer = Buffer {
            gpu: gpu.clone(),
            raw,
            memory: vk::DeviceMemory::null(),
            mapped: core::ptr::null_mut(),
            size,
        };
        // SAFETY: the buffer was made on this device.
        let needs = unsafe { gpu.device.get_buffer_memory_requirements(raw) };
        buffer.memory = allocate_memory(gpu, needs, memory)?;
        // SAFETY: the memory fits the buffer's requirements and is bound once.
        unsafe { gpu.device.bind_buffer_memory(raw, buffer.memory, 0) }
            .could_not("bind a buffer")?;
        Ok(buffer)
    }

    /// Writes bytes at an offset in bytes; submitted work must not read them. Panics past the end.
    pub(crate) fn write(&mut self, offset: usize, bytes: &[u8]) {
        assert!(!self.mapped.is_null(), "a buffer that the host can't write");
        assert!(offset + bytes.len() <= self.size, "bytes past the end of a buffer");
        // SAFETY: the range lies in the mapping, which overlaps no slice of ours.
        unsafe {
            core::ptr::copy_nonoverlapping(bytes.as_ptr(), self.mapped.add(offset), bytes.len());
        };
    }

    /// Returns the contents, once the work that writes them is done. Panics for a device-local buffer.
    pub(crate) fn read(&self) -> &[u8] {
        assert!(!self.mapped.is_null(), "a buffer that the host can't read");
        // SAFETY: the mapping is as long as the buffer and lives as long as it.
        unsafe { core::slice::from_raw_parts(self.mapped, self.size) }
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe {
            self.gpu.device.destroy_buffer(self.raw, None);
            self.gpu.device.free_memory(self.memory, None);
        }
    }
}

/// Allocates memory that satisfies requirements and property flags. Lazy allocation is a preference,
/// other flags are required.
pub(crate) fn allocate_memory(
    gpu: &Gpu,
    needs: vk::MemoryRequirements,
    properties: vk::MemoryPropertyFlags,
) -> Result<vk::DeviceMemory, Error> {
    let types = gpu.memory.memory_types_as_slice();
    let fits = |wanted: vk::MemoryPropertyFlags| {
        types.iter().enumerate().position(|(i, one)| {
            needs.memory_type_bits >> i & 1 == 1 && one.property_flags.contains(wanted)
        })
    };
    let lazy = vk::MemoryPropertyFlags::LAZILY_ALLOCATED;
    let index = fits(properties).or_else(|| fits(properties & !lazy));
    let missing = Error::Call {
        action: "find memory of the kind needed",
        result: vk::Result::ERROR_FEATURE_NOT_PRESENT,
    };
    let info = vk::MemoryAllocateInfo::default()
        .allocation_size(needs.size)
        .memory_type_index(index.ok_or(missing)? as u32);
    // SAFETY: the type is one of the device's.
    unsafe { gpu.device.allocate_memory(&info, None) }.could_not("allocate memory")
}
