//! What a device of this machine offers, and whether that is enough.

use std::ffi::CStr;

use ash::vk;

use super::context::{API, Needs};

/// Which device is the better one: the lower.
pub(super) const fn rank(kind: vk::PhysicalDeviceType) -> u8 {
    match kind {
        vk::PhysicalDeviceType::DISCRETE_GPU => 0,
        vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
        vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
        vk::PhysicalDeviceType::CPU => 3,
        _ => 4,
    }
}

/// A family of queues that draws and serves the shell, or what the device lacks.
pub(super) fn family(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    properties: &vk::PhysicalDeviceProperties,
    presents: &impl Fn(vk::PhysicalDevice, u32) -> bool,
) -> Result<u32, String> {
    let version = properties.api_version;
    if version < API {
        let (major, minor) = (vk::api_version_major(version), vk::api_version_minor(version));
        return Err(format!("speaks Vulkan {major}.{minor}, not 1.1"));
    }
    let mut multiview = vk::PhysicalDeviceMultiviewFeatures::default();
    let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut multiview);
    // SAFETY: the physical device is one of this instance's and speaks 1.1.
    unsafe { instance.get_physical_device_features2(physical, &mut features) };
    if multiview.multiview == vk::FALSE {
        return Err("has no multiview".into());
    }
    // SAFETY: as above.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
    let draws = |i: &u32| {
        families[*i as usize].queue_flags.contains(vk::QueueFlags::GRAPHICS)
            && presents(physical, *i)
    };
    (0..families.len() as u32)
        .find(draws)
        .ok_or_else(|| "has no queue that draws into the window".into())
}

/// What the renderer can use of a device.
pub(super) fn offered(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    family: u32,
) -> Needs {
    let mut half = vk::PhysicalDeviceShaderFloat16Int8Features::default();
    let has_half = has_extension(instance, physical, vk::KHR_SHADER_FLOAT16_INT8_NAME);
    let mut features = vk::PhysicalDeviceFeatures2::default();
    if has_half {
        features = features.push_next(&mut half);
    }
    // SAFETY: the physical device is one of this instance's, and speaks 1.1.
    unsafe { instance.get_physical_device_features2(physical, &mut features) };
    // SAFETY: as above.
    let properties = unsafe { instance.get_physical_device_properties(physical) };
    // SAFETY: as above.
    let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
    let bits = families[family as usize].timestamp_valid_bits;
    let period = (f64::from(properties.limits.timestamp_period) * 1e6) as u64;
    Needs {
        half: has_half && half.shader_float16 == vk::TRUE,
        timestamp_period: if bits == 0 { 0 } else { period },
    }
}

/// Its name, for people.
pub(super) fn name_of(properties: &vk::PhysicalDeviceProperties) -> String {
    let name = properties.device_name_as_c_str();
    name.map_or_else(|_| "unnamed".into(), |name| name.to_string_lossy().into_owned())
}

fn has_extension(instance: &ash::Instance, physical: vk::PhysicalDevice, name: &CStr) -> bool {
    // SAFETY: the physical device is one of this instance's.
    let all = unsafe { instance.enumerate_device_extension_properties(physical) };
    all.is_ok_and(|all| all.iter().any(|one| one.extension_name_as_c_str() == Ok(name)))
}
