//! Buffers, each in memory of its own: a dozen are made at the start, none after.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;
use super::error::{Doing, Error};
use super::offscreen::once;

/// A buffer that the host writes or reads, mapped for good, or one of the device's own.
pub(super) struct Buffer {
    gpu: Arc<Gpu>,
    pub(super) raw: vk::Buffer,
    memory: vk::DeviceMemory,
    /// Null for the device's own.
    mapped: *mut u8,
    pub(super) size: usize,
}

impl Buffer {
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        size: usize,
        usage: vk::BufferUsageFlags,
    ) -> Result<Self, Error> {
        let visible =
            vk::MemoryPropertyFlags::HOST_VISIBLE | vk::MemoryPropertyFlags::HOST_COHERENT;
        let mut buffer = Self::bound(gpu, size, usage, visible)?;
        let whole = vk::MemoryMapFlags::empty();
        // SAFETY: the memory is visible to the host and mapped once, until it is freed.
        buffer.mapped = unsafe { gpu.device.map_memory(buffer.memory, 0, vk::WHOLE_SIZE, whole) }
            .doing("map a buffer")?
            .cast();
        Ok(buffer)
    }

    /// A buffer in the device's own memory that holds these bytes for good. Waits for their copy.
    pub(super) fn constant(
        gpu: &Arc<Gpu>,
        bytes: &[u8],
        usage: vk::BufferUsageFlags,
    ) -> Result<Self, Error> {
        let mut staged = Self::new(gpu, bytes.len(), vk::BufferUsageFlags::TRANSFER_SRC)?;
        staged.write(0, bytes);
        let usage = usage | vk::BufferUsageFlags::TRANSFER_DST;
        let kind = vk::MemoryPropertyFlags::DEVICE_LOCAL;
        let buffer = Self::bound(gpu, bytes.len(), usage, kind)?;
        let copy = vk::BufferCopy { size: bytes.len() as u64, ..vk::BufferCopy::default() };
        once(gpu, |device, commands| {
            // SAFETY: both buffers are as long as the bytes, and live until the wait is over.
            unsafe { device.cmd_copy_buffer(commands, staged.raw, buffer.raw, &[copy]) };
        })?;
        Ok(buffer)
    }

    fn bound(
        gpu: &Arc<Gpu>,
        size: usize,
        usage: vk::BufferUsageFlags,
        kind: vk::MemoryPropertyFlags,
    ) -> Result<Self, Error> {
        let info = vk::BufferCreateInfo::default().size(size as u64).usage(usage);
        // SAFETY: the device is alive and the info complete.
        let raw = unsafe { gpu.device.create_buffer(&info, None) }.doing("make a buffer")?;
        let mut buffer = Buffer {
            gpu: gpu.clone(),
            raw,
            memory: vk::DeviceMemory::null(),
            mapped: core::ptr::null_mut(),
            size,
        };
        // SAFETY: the buffer was made on this device.
        let needs = unsafe { gpu.device.get_buffer_memory_requirements(raw) };
        buffer.memory = allocate(gpu, needs, kind)?;
        // SAFETY: the memory fits the buffer's requirements and is bound once.
        unsafe { gpu.device.bind_buffer_memory(raw, buffer.memory, 0) }.doing("bind a buffer")?;
        Ok(buffer)
    }

    /// Copies bytes to a place in the buffer, which no submitted work may be reading.
    pub(super) fn write(&mut self, at: usize, bytes: &[u8]) {
        assert!(!self.mapped.is_null(), "a buffer that the host can't write");
        assert!(at + bytes.len() <= self.size, "bytes past the end of a buffer");
        // SAFETY: the range lies in the mapping, which overlaps no slice of ours.
        unsafe { core::ptr::copy_nonoverlapping(bytes.as_ptr(), self.mapped.add(at), bytes.len()) };
    }

    /// What the buffer holds, once the work that writes it is done.
    pub(super) fn read(&self) -> &[u8] {
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

/// Memory of a kind for something's requirements.
pub(super) fn allocate(
    gpu: &Gpu,
    needs: vk::MemoryRequirements,
    kind: vk::MemoryPropertyFlags,
) -> Result<vk::DeviceMemory, Error> {
    let types = gpu.memory.memory_types_as_slice();
    let fits = |wanted: vk::MemoryPropertyFlags| {
        types.iter().enumerate().position(|(i, one)| {
            needs.memory_type_bits >> i & 1 == 1 && one.property_flags.contains(wanted)
        })
    };
    // Lazily allocated memory is a wish, any other kind a need.
    let lazy = vk::MemoryPropertyFlags::LAZILY_ALLOCATED;
    let index = fits(kind).or_else(|| fits(kind & !lazy));
    let missing = Error::Call {
        doing: "find memory of the kind needed",
        result: vk::Result::ERROR_FEATURE_NOT_PRESENT,
    };
    let info = vk::MemoryAllocateInfo::default()
        .allocation_size(needs.size)
        .memory_type_index(index.ok_or(missing)? as u32);
    // SAFETY: the type is one of the device's.
    unsafe { gpu.device.allocate_memory(&info, None) }.doing("allocate memory")
}
