//! Foveation, which Monado lacks: foveation profiles, the levels of swapchains, and the density maps of
//! their images.

use std::collections::HashMap;
use std::sync::{LazyLock, Mutex, MutexGuard};

use ash::vk::{self, Handle as _};
use openxr::sys;
use sys::{Handle, Result as Status, pfn};

use super::chain::call_next;
use super::density_maps::{self, DensityMap};
use super::folder::{layer_folder, log_line};

/// The foveation objects that the shell has created.
#[derive(Default)]
struct FoveationState {
    /// The levels of profiles that are not destroyed yet.
    profiles: HashMap<u64, sys::FoveationLevelFB>,
    made: u64,
    /// The swapchains that were created with density maps.
    chains: HashMap<u64, MappedSwapchain>,
}

struct MappedSwapchain {
    extent: [u32; 2],
    maps: Vec<DensityMap>,
}

static STATE: LazyLock<Mutex<FoveationState>> = LazyLock::new(Mutex::default);

fn lock_state() -> MutexGuard<'static, FoveationState> {
    STATE.lock().expect("no holder panics")
}

fn check_rule(rule: &str, holds: bool) {
    if !holds {
        log_line(&format!("violation: {rule}"));
    }
}

/// Stores a session's device.
///
/// # Safety
/// The structure is valid.
pub(crate) unsafe fn remember_device(info: *const sys::SessionCreateInfo) {
    // SAFETY: the caller's; what it points to says of which type it is.
    unsafe {
        let binding = (*info).next.cast::<sys::GraphicsBindingVulkanKHR>();
        if (*binding).ty == sys::GraphicsBindingVulkanKHR::TYPE {
            density_maps::remember_device(&*binding);
        }
    }
}

/// Lets the runtime create a swapchain without the foveation structure, which it doesn't know, and stores the
/// swapchain.
///
/// # Safety
/// The shell's structures are valid.
pub(crate) unsafe fn create_swapchain(
    session: sys::Session,
    info: *const sys::SwapchainCreateInfo,
    swapchain: *mut sys::Swapchain,
) -> Status {
    // SAFETY: the caller's.
    let info = unsafe { *info };
    let foveation = info.next.cast::<sys::SwapchainCreateInfoFoveationFB>();
    // SAFETY: what it points to, if anything, says of which type it is.
    let mapped = unsafe { foveation.as_ref() }.is_some_and(|foveation| {
        check_rule("a swapchain's chain", {
            foveation.ty == sys::SwapchainCreateInfoFoveationFB::TYPE
                && foveation.flags == sys::SwapchainCreateFoveationFlagsFB::FRAGMENT_DENSITY_MAP
        });
        true
    });
    // SAFETY: as above.
    if let Some(wish) = unsafe { foveation.as_ref() }
        && is_subsampling_asked(wish, &info)
    {
        if layer_folder().join("no-subsampling").exists() {
            log_line("subsampled swapchain refused");
            return Status::ERROR_FEATURE_UNSUPPORTED;
        }
        log_line("subsampled swapchain");
    }
    let plain = sys::SwapchainCreateInfo { next: core::ptr::null_mut(), ..info };
    let made =
        call_next!(c"xrCreateSwapchain": CreateSwapchain, session, &raw const plain, swapchain);
    if made == Status::SUCCESS {
        // SAFETY: the call has succeeded.
        let (handle, mut state) = (unsafe { (*swapchain).into_raw() }, lock_state());
        if mapped {
            let chain = MappedSwapchain { extent: [info.width, info.height], maps: Vec::new() };
            state.chains.insert(handle, chain);
            log_line("mapped swapchain");
        }
    }
    made
}

/// `XrVulkanSwapchainCreateInfoMETA` as in the specification.
#[repr(C)]
struct MoreImageFlags {
    ty: sys::StructureType,
    next: *const core::ffi::c_void,
    create_flags: u32,
    usage_flags: u32,
}

/// Returns `true` if the structure after the foveation structure requests subsampled images
/// (`XR_META_vulkan_swapchain_create_info`).
fn is_subsampling_asked(
    foveation: &sys::SwapchainCreateInfoFoveationFB,
    info: &sys::SwapchainCreateInfo,
) -> bool {
    let extra = foveation.next.cast::<MoreImageFlags>();
    // SAFETY: what it points to, if anything, says of which type it is.
    let Some(extra) = (unsafe { extra.as_ref() }) else { return false };
    check_rule("subsampled images", {
        extra.ty == sys::VulkanSwapchainCreateInfoMETA::TYPE
            && extra.next.is_null()
            && extra.create_flags == vk::ImageCreateFlags::SUBSAMPLED_EXT.as_raw()
            && extra.usage_flags == 0
            && !info.usage_flags.contains(sys::SwapchainUsageFlags::TRANSFER_SRC)
    });
    true
}

pub(crate) unsafe extern "system" fn destroy_swapchain(swapchain: sys::Swapchain) -> Status {
    let handle = swapchain.into_raw();
    let chain = lock_state().chains.remove(&handle);
    let done = call_next!(c"xrDestroySwapchain": DestroySwapchain, swapchain);
    chain.into_iter().flat_map(|chain| chain.maps).for_each(density_maps::destroy_density_map);
    done
}

pub(crate) unsafe extern "system" fn enumerate_swapchain_images(
    swapchain: sys::Swapchain,
    capacity: u32,
    count: *mut u32,
    images: *mut sys::SwapchainImageBaseHeader,
) -> Status {
    let done = call_next!(c"xrEnumerateSwapchainImages": EnumerateSwapchainImages, swapchain, capacity, count, images);
    if done != Status::SUCCESS || capacity == 0 {
        return done;
    }
    let mut state = lock_state();
    let chain = state.chains.get_mut(&swapchain.into_raw());
    // SAFETY: the call has succeeded, and so many images stand there.
    let listed = unsafe {
        let images = images.cast::<sys::SwapchainImageVulkanKHR>();
        core::slice::from_raw_parts(images, *count as usize)
    };
    let Some(chain) = chain else {
        check_rule("images without maps", listed.iter().all(|image| image.next.is_null()));
        return done;
    };
    for image in listed {
        let map = image.next.cast::<sys::SwapchainImageFoveationVulkanFB>();
        // SAFETY: what it points to, if anything, says of which type it is.
        let Some(map) = (unsafe { map.as_mut() }) else {
            check_rule("an image has no place for its map", false);
            continue;
        };
        let ty = sys::SwapchainImageFoveationVulkanFB::TYPE;
        check_rule("an image's chain", map.ty == ty && map.next.is_null());
        let made = density_maps::create_density_map(chain.extent);
        map.image = made.image.as_raw();
        chain.maps.push(made);
        [map.width, map.height] = chain.extent.map(|pixels| pixels.div_ceil(density_maps::TEXEL));
    }
    done
}

pub(crate) unsafe extern "system" fn create_profile(
    _: sys::Session,
    info: *const sys::FoveationProfileCreateInfoFB,
    profile: *mut sys::FoveationProfileFB,
) -> Status {
    // SAFETY: the shell's structures are valid during the call, and say of which type they are.
    let (info, level) = unsafe {
        let level = (*info).next.cast::<sys::FoveationLevelProfileCreateInfoFB>();
        (*info, *level)
    };
    check_rule("a profile", info.ty == sys::FoveationProfileCreateInfoFB::TYPE);
    check_rule("a profile's level", {
        level.ty == sys::FoveationLevelProfileCreateInfoFB::TYPE
            && level.next.is_null()
            && (0..=3).contains(&level.level.into_raw())
            && level.vertical_offset == 0.0
    });
    let mut state = lock_state();
    state.made += 1;
    let handle = state.made;
    state.profiles.insert(handle, level.level);
    // SAFETY: there is room for a handle.
    unsafe { *profile = sys::FoveationProfileFB::from_raw(handle) };
    Status::SUCCESS
}

pub(crate) unsafe extern "system" fn destroy_profile(profile: sys::FoveationProfileFB) -> Status {
    let gone = lock_state().profiles.remove(&profile.into_raw());
    check_rule("a profile's end", gone.is_some());
    Status::SUCCESS
}

pub(crate) unsafe extern "system" fn update_swapchain(
    swapchain: sys::Swapchain,
    new_state: *const sys::SwapchainStateBaseHeaderFB,
) -> Status {
    // SAFETY: the shell's structure is valid during the call, and says of which type it is.
    let new_state = unsafe { *new_state.cast::<sys::SwapchainStateFoveationFB>() };
    let state = lock_state();
    check_rule("an update", {
        new_state.ty == sys::SwapchainStateFoveationFB::TYPE
            && new_state.next.is_null()
            && new_state.flags == sys::SwapchainStateFoveationFlagsFB::EMPTY
    });
    let chain = state.chains.get(&swapchain.into_raw());
    check_rule(
        "an update is of a swapchain with maps",
        chain.is_some_and(|chain| !chain.maps.is_empty()),
    );
    match state.profiles.get(&new_state.profile.into_raw()) {
        Some(level) => log_line(&format!("foveation {level:?}")),
        None => check_rule("an update's profile", false),
    }
    check_rule("profiles are not piled up", state.profiles.len() == 1);
    Status::SUCCESS
}

/// Implements a function that the shell must never call.
pub(crate) unsafe extern "system" fn get_swapchain_state(
    _: sys::Swapchain,
    _: *mut sys::SwapchainStateBaseHeaderFB,
) -> Status {
    log_line("violation: a swapchain's state is asked for");
    Status::ERROR_FUNCTION_UNSUPPORTED
}
