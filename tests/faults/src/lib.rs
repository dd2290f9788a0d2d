//! Fault injection into Vulkan calls, for tests and scripted windows: out of memory, device loss.
//!
//! [`wrap_device`], passed as the renderer's device hook, replaces the calls of the function table that
//! can fail. State is global: it serves one device of a process at a time, the latest.

use std::sync::{Mutex, MutexGuard, PoisonError};

use ash::vk;

/// The groups of calls that a fault can hit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CallGroup {
    /// Memory allocations.
    Memory,
    /// Object creation and command recording, and memory allocations.
    Making,
    /// Queue submissions.
    Submit,
}

/// A planned fault.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PlannedFault {
    /// The calls that fail.
    pub calls: CallGroup,
    /// Number of such calls that succeed first.
    pub skipped_calls: u32,
    /// Number of such calls that then fail.
    pub failing_calls: u32,
    /// The result that they fail with.
    pub cause: FailureCause,
}

/// Causes of failure.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FailureCause {
    /// Out of device memory.
    DeviceMemory,
    /// Out of host memory.
    HostMemory,
    /// Device lost, for good: all later submissions and waits fail.
    Lost,
}

impl FailureCause {
    const fn vk_result(self) -> vk::Result {
        match self {
            FailureCause::DeviceMemory => vk::Result::ERROR_OUT_OF_DEVICE_MEMORY,
            FailureCause::HostMemory => vk::Result::ERROR_OUT_OF_HOST_MEMORY,
            FailureCause::Lost => vk::Result::ERROR_DEVICE_LOST,
        }
    }
}

struct FaultState {
    real: Option<ash::DeviceFnV1_0>,
    fault: Option<PlannedFault>,
    /// Calls failed by the current plan.
    failed: u32,
    lost: bool,
}

static FAULT_STATE: Mutex<FaultState> =
    Mutex::new(FaultState { real: None, fault: None, failed: 0, lost: false });

fn lock_state() -> MutexGuard<'static, FaultState> {
    FAULT_STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets or clears the fault of the latest device, and resets the count of injected failures.
pub fn set_planned_fault(fault: Option<PlannedFault>) {
    let mut state = lock_state();
    (state.fault, state.failed) = (fault, 0);
}

/// Returns the number of calls failed by the latest plan.
#[must_use]
pub fn injected_failure_count() -> u32 {
    lock_state().failed
}

/// Returns the device with a function table whose calls can fail.
#[must_use]
#[allow(clippy::needless_pass_by_value)] // as the hook hands it over
pub fn wrap_device(device: ash::Device) -> ash::Device {
    let mut state = lock_state();
    let real = device.fp_v1_0().clone();
    let mut table = real.clone();
    replace_calls(&mut table);
    (state.real, state.lost) = (Some(real), false);
    let (first, second, third) = (device.fp_v1_1(), device.fp_v1_2(), device.fp_v1_3());
    let handle = device.handle();
    ash::Device::from_parts_1_3(handle, table, first.clone(), second.clone(), third.clone())
}

/// The kind of a call.
#[derive(Clone, Copy, PartialEq, Eq)]
enum CallKind {
    Memory,
    Making,
    Submit,
    /// Waits for a fence.
    Fence,
    /// Waits for a queue or device to be idle; carried out even if lost.
    Idle,
}

impl FaultState {
    /// Returns the result to report instead of carrying a call out, or `None` to carry it out.
    fn injected_result(&mut self, kind: CallKind) -> Option<vk::Result> {
        if self.lost {
            let reaches_device =
                matches!(kind, CallKind::Submit | CallKind::Fence | CallKind::Idle);
            return reaches_device.then_some(vk::Result::ERROR_DEVICE_LOST);
        }
        let fault = self.fault.as_mut()?;
        let is_meant = match fault.calls {
            CallGroup::Memory => kind == CallKind::Memory,
            CallGroup::Making => matches!(kind, CallKind::Memory | CallKind::Making),
            CallGroup::Submit => kind == CallKind::Submit,
        };
        if !is_meant || fault.failing_calls == 0 {
            return None;
        }
        if fault.skipped_calls > 0 {
            fault.skipped_calls -= 1;
            return None;
        }
        fault.failing_calls -= 1;
        self.failed += 1;
        self.lost = fault.cause == FailureCause::Lost;
        Some(fault.cause.vk_result())
    }
}

/// Returns the driver's own function table.
///
/// # Panics
/// [`wrap_device`] hasn't been called yet.
fn driver_table() -> ash::DeviceFnV1_0 {
    lock_state().real.clone().expect("a device with these functions was made")
}

macro_rules! faulty {
    ($($kind:ident $name:ident($($argument:ident: $type:ty),*);)*) => {
        $(
            unsafe extern "system" fn $name($($argument: $type),*) -> vk::Result {
                let fault = lock_state().injected_result(CallKind::$kind);
                let carry_out = || {
                    // SAFETY: as the caller has it.
                    unsafe { (driver_table().$name)($($argument),*) }
                };
                match (fault, CallKind::$kind) {
                    (Some(result), CallKind::Idle) => {
                        let _ = carry_out();
                        result
                    }
                    (Some(result), _) => result,
                    (None, _) => carry_out(),
                }
            }
        )*

        fn replace_calls(table: &mut ash::DeviceFnV1_0) {
            $(table.$name = $name;)*
        }
    };
}

type Allocator<'a> = *const vk::AllocationCallbacks<'a>;

faulty! {
    Memory allocate_memory(device: vk::Device, info: *const vk::MemoryAllocateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::DeviceMemory);
    Making bind_buffer_memory(device: vk::Device, buffer: vk::Buffer, memory: vk::DeviceMemory,
        offset: vk::DeviceSize);
    Making bind_image_memory(device: vk::Device, image: vk::Image, memory: vk::DeviceMemory,
        offset: vk::DeviceSize);
    Making map_memory(device: vk::Device, memory: vk::DeviceMemory, offset: vk::DeviceSize,
        size: vk::DeviceSize, flags: vk::MemoryMapFlags, made: *mut *mut core::ffi::c_void);
    Making create_buffer(device: vk::Device, info: *const vk::BufferCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::Buffer);
    Making create_image(device: vk::Device, info: *const vk::ImageCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::Image);
    Making create_image_view(device: vk::Device, info: *const vk::ImageViewCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::ImageView);
    Making create_sampler(device: vk::Device, info: *const vk::SamplerCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::Sampler);
    Making create_descriptor_set_layout(device: vk::Device,
        info: *const vk::DescriptorSetLayoutCreateInfo<'_>, allocator: Allocator<'_>,
        made: *mut vk::DescriptorSetLayout);
    Making create_pipeline_layout(device: vk::Device,
        info: *const vk::PipelineLayoutCreateInfo<'_>, allocator: Allocator<'_>,
        made: *mut vk::PipelineLayout);
    Making create_descriptor_pool(device: vk::Device,
        info: *const vk::DescriptorPoolCreateInfo<'_>, allocator: Allocator<'_>,
        made: *mut vk::DescriptorPool);
    Making allocate_descriptor_sets(device: vk::Device,
        info: *const vk::DescriptorSetAllocateInfo<'_>, made: *mut vk::DescriptorSet);
    Making create_render_pass(device: vk::Device, info: *const vk::RenderPassCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::RenderPass);
    Making create_framebuffer(device: vk::Device, info: *const vk::FramebufferCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::Framebuffer);
    Making create_shader_module(device: vk::Device, info: *const vk::ShaderModuleCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::ShaderModule);
    Making create_pipeline_cache(device: vk::Device,
        info: *const vk::PipelineCacheCreateInfo<'_>, allocator: Allocator<'_>,
        made: *mut vk::PipelineCache);
    Making create_graphics_pipelines(device: vk::Device, cache: vk::PipelineCache, count: u32,
        infos: *const vk::GraphicsPipelineCreateInfo<'_>, allocator: Allocator<'_>,
        made: *mut vk::Pipeline);
    Making create_compute_pipelines(device: vk::Device, cache: vk::PipelineCache, count: u32,
        infos: *const vk::ComputePipelineCreateInfo<'_>, allocator: Allocator<'_>,
        made: *mut vk::Pipeline);
    Making create_command_pool(device: vk::Device, info: *const vk::CommandPoolCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::CommandPool);
    Making allocate_command_buffers(device: vk::Device,
        info: *const vk::CommandBufferAllocateInfo<'_>, made: *mut vk::CommandBuffer);
    Making create_fence(device: vk::Device, info: *const vk::FenceCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::Fence);
    Making create_semaphore(device: vk::Device, info: *const vk::SemaphoreCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::Semaphore);
    Making create_query_pool(device: vk::Device, info: *const vk::QueryPoolCreateInfo<'_>,
        allocator: Allocator<'_>, made: *mut vk::QueryPool);
    Making begin_command_buffer(commands: vk::CommandBuffer,
        info: *const vk::CommandBufferBeginInfo<'_>);
    Making end_command_buffer(commands: vk::CommandBuffer);
    Submit queue_submit(queue: vk::Queue, count: u32, infos: *const vk::SubmitInfo<'_>,
        fence: vk::Fence);
    Idle queue_wait_idle(queue: vk::Queue);
    Idle device_wait_idle(device: vk::Device);
    Fence wait_for_fences(device: vk::Device, count: u32, fences: *const vk::Fence, all: vk::Bool32,
        timeout: u64);
}
