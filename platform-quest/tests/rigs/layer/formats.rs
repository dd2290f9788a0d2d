//! Swapchain formats: the depth formats are hidden if the file `no-depth` exists in the layer's folder.

use ash::vk;
use openxr::sys;
use sys::{Result as Status, pfn};

use super::chain::call_next;
use super::folder::layer_folder;

const DEPTHS: [vk::Format; 3] =
    [vk::Format::D32_SFLOAT, vk::Format::X8_D24_UNORM_PACK32, vk::Format::D16_UNORM];

pub(crate) unsafe extern "system" fn enumerate_swapchain_formats(
    session: sys::Session,
    capacity: u32,
    count: *mut u32,
    formats: *mut i64,
) -> Status {
    let done = call_next!(
        c"xrEnumerateSwapchainFormats": EnumerateSwapchainFormats, session, capacity, count, formats
    );
    if done == Status::SUCCESS && capacity > 0 && layer_folder().join("no-depth").exists() {
        // SAFETY: the call has succeeded, and so many formats stand there.
        let all = unsafe { core::slice::from_raw_parts_mut(formats, *count as usize) };
        let is_color =
            |format: &i64| DEPTHS.iter().all(|depth| i64::from(depth.as_raw()) != *format);
        let colors: Vec<i64> = all.iter().copied().filter(is_color).collect();
        all[..colors.len()].copy_from_slice(&colors);
        // SAFETY: as above.
        unsafe { *count = colors.len() as u32 };
    }
    done
}
