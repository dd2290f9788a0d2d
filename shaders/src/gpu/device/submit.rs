//! Synchronous one-time submission.

use ash::vk;

use super::context::Gpu;
use super::error::{Error, ErrorContext};

/// Records a one-time command buffer, submits it and waits until the queue is idle.
pub(crate) fn submit_and_wait(
    gpu: &Gpu,
    record: impl FnOnce(&ash::Device, vk::CommandBuffer),
) -> Result<(), Error> {
    let device = &gpu.device;
    let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.queue_family);
    // SAFETY: the family is the device's; the pool is destroyed below, its buffer with it.
    let pool = unsafe { device.create_command_pool(&info, None) }.could_not("make a pool")?;
    let recorded = (|| {
        let info =
            vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: the pool is this device's.
        let commands = unsafe { device.allocate_command_buffers(&info) }
            .could_not("make a command buffer")?[0];
        let begin = vk::CommandBufferBeginInfo::default();
        // SAFETY: the buffer is new.
        unsafe { device.begin_command_buffer(commands, &begin) }.could_not("record")?;
        record(device, commands);
        // SAFETY: the commands are being recorded; the queue is used by one thread.
        unsafe {
            device.end_command_buffer(commands).could_not("record")?;
            let buffers = [commands];
            let info = vk::SubmitInfo::default().command_buffers(&buffers);
            device.queue_submit(gpu.queue, &[info], vk::Fence::null()).could_not("submit")?;
            device.queue_wait_idle(gpu.queue).could_not("wait")
        }
    })();
    // SAFETY: nothing of the pool is under way: the wait passed, or nothing was submitted, or the
    // device is lost.
    unsafe { device.destroy_command_pool(pool, None) };
    recorded
}
