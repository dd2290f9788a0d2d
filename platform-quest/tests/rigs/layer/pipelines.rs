//! A driver that compiles slowly, or not at all. The file `slow-pipelines` in the layer's folder has the
//! delay of the process's first pipeline in milliseconds. If the file `no-pipelines` exists, no pipeline is
//! created.

use std::ffi::CStr;
use std::fs;
use std::sync::Once;
use std::thread;
use std::time::Duration;

use ash::vk;

use super::folder::{layer_folder, log_line};
use super::vulkan::next_device_function;

const NAME: &CStr = c"vkCreateGraphicsPipelines";

/// Returns the hook for a function's name, if there is one.
pub(crate) fn find_hook(name: &CStr) -> vk::PFN_vkVoidFunction {
    if name != NAME {
        return None;
    }
    let function: vk::PFN_vkCreateGraphicsPipelines = create_pipelines;
    // SAFETY: it is called by the type that goes with the name.
    Some(unsafe {
        core::mem::transmute::<vk::PFN_vkCreateGraphicsPipelines, unsafe extern "system" fn()>(
            function,
        )
    })
}

unsafe extern "system" fn create_pipelines(
    device: vk::Device,
    cache: vk::PipelineCache,
    count: u32,
    infos: *const vk::GraphicsPipelineCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    pipelines: *mut vk::Pipeline,
) -> vk::Result {
    static FIRST: Once = Once::new();

    FIRST.call_once(|| {
        let slow = fs::read_to_string(layer_folder().join("slow-pipelines")).unwrap_or_default();
        if let Ok(millis) = slow.parse() {
            thread::sleep(Duration::from_millis(millis));
            log_line("compiled");
        }
    });
    if layer_folder().join("no-pipelines").exists() {
        for i in 0..count as usize {
            // SAFETY: there is room for so many.
            unsafe { *pipelines.add(i) = vk::Pipeline::null() };
        }
        return vk::Result::ERROR_OUT_OF_DEVICE_MEMORY;
    }
    // SAFETY: the device is alive, as one of its functions is being called.
    let next = unsafe { next_device_function(device, NAME.as_ptr()) }.expect("a driver has it");
    // SAFETY: this is the type that goes with the name.
    let next: vk::PFN_vkCreateGraphicsPipelines = unsafe { core::mem::transmute(next) };
    // SAFETY: handed on as it came.
    unsafe { next(device, cache, count, infos, allocator, pipelines) }
}
