//! A driver that fails on demand, for tests and for scripts in place of a visitor: memory that runs
//! out, a device that is lost. No shell calls this in earnest.
//!
//! Once this is [`arm`]ed, devices are made with a table of functions in which those that can fail
//! ask here first. It serves one device of a process at a time, the latest.

use std::sync::{Mutex, MutexGuard, PoisonError};

use ash::vk;

/// Kinds of calls.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Calls {
    /// Those that give memory.
    Memory,
    /// Those that make something or record, and those that give memory.
    Making,
    /// Those that hand work to the device.
    Submit,
}

/// What is to go wrong.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Fault {
    /// Which calls fail.
    pub calls: Calls,
    /// So many of them succeed before.
    pub after: u32,
    /// So many fail.
    pub times: u32,
    /// Why.
    pub why: Why,
}

/// Why calls fail.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Why {
    /// The device has no memory left.
    DeviceMemory,
    /// The driver has none of the host's.
    HostMemory,
    /// The device is lost, and stays so: all that hands work to it or waits for it fails from then
    /// on.
    Lost,
}

impl Why {
    const fn result(self) -> vk::Result {
        match self {
            Why::DeviceMemory => vk::Result::ERROR_OUT_OF_DEVICE_MEMORY,
            Why::HostMemory => vk::Result::ERROR_OUT_OF_HOST_MEMORY,
            Why::Lost => vk::Result::ERROR_DEVICE_LOST,
        }
    }
}

struct State {
    armed: bool,
    real: Option<ash::DeviceFnV1_0>,
    fault: Option<Fault>,
    /// Calls that a fault has made fail.
    failed: u32,
    lost: bool,
}

static STATE: Mutex<State> =
    Mutex::new(State { armed: false, real: None, fault: None, failed: 0, lost: false });

fn state() -> MutexGuard<'static, State> {
    STATE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on devices are made so that they can fail.
pub fn arm() {
    state().armed = true;
}

/// Has calls of the latest device fail, or none.
pub fn plan(fault: Option<Fault>) {
    let mut state = state();
    (state.fault, state.failed) = (fault, 0);
}

/// How many calls the latest plan has made fail.
#[must_use]
pub fn failed() -> u32 {
    state().failed
}

/// The device as it is, or with calls that can fail.
pub(super) fn wrapped(device: ash::Device) -> ash::Device {
    let mut state = state();
    if !state.armed {
        return device;
    }
    let real = device.fp_v1_0().clone();
    let mut table = real.clone();
    replace(&mut table);
    (state.real, state.lost) = (Some(real), false);
    let (first, second, third) = (device.fp_v1_1(), device.fp_v1_2(), device.fp_v1_3());
    let handle = device.handle();
    ash::Device::from_parts_1_3(handle, table, first.clone(), second.clone(), third.clone())
}

/// What a call is to the plan.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Memory,
    Making,
    Submit,
    /// Waits for a fence, which may never come.
    Fence,
    /// Waits for all that is under way, which comes to its end on a lost device too.
    Idle,
}

impl State {
    /// What a call of a kind is to come back with instead of being carried out.
    fn fault(&mut self, kind: Kind) -> Option<vk::Result> {
        if self.lost {
            let reaches_device = matches!(kind, Kind::Submit | Kind::Fence | Kind::Idle);
            return reaches_device.then_some(vk::Result::ERROR_DEVICE_LOST);
        }
        let fault = self.fault.as_mut()?;
        let is_meant = match fault.calls {
            Calls::Memory => kind == Kind::Memory,
            Calls::Making => matches!(kind, Kind::Memory | Kind::Making),
            Calls::Submit => kind == Kind::Submit,
        };
        if !is_meant || fault.times == 0 {
            return None;
        }
        if fault.after > 0 {
            fault.after -= 1;
            return None;
        }
        fault.times -= 1;
        self.failed += 1;
        self.lost = fault.why == Why::Lost;
        Some(fault.why.result())
    }
}

/// The driver's own table. It is only asked for by functions that a device has of `wrapped`.
fn real() -> ash::DeviceFnV1_0 {
    state().real.clone().expect("a device with these functions was made")
}

macro_rules! faulty {
    ($($kind:ident $name:ident($($argument:ident: $type:ty),*);)*) => {
        $(
            unsafe extern "system" fn $name($($argument: $type),*) -> vk::Result {
                let fault = state().fault(Kind::$kind);
                let carry_out = || {
                    // SAFETY: as the caller has it.
                    unsafe { (real().$name)($($argument),*) }
                };
                match (fault, Kind::$kind) {
                    (Some(result), Kind::Idle) => {
                        let _ = carry_out();
                        result
                    }
                    (Some(result), _) => result,
                    (None, _) => carry_out(),
                }
            }
        )*

        fn replace(table: &mut ash::DeviceFnV1_0) {
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
