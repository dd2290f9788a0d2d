//! Selection of the physical device and its queue family.

use ash::vk;

/// The Vulkan version required: 1.1, which has multiview in its core.
pub(crate) const API_VERSION: u32 = vk::API_VERSION_1_1;

/// Returns the rank of a device type: the lower, the better.
pub(crate) const fn rank_device_type_best_first(kind: vk::PhysicalDeviceType) -> u8 {
    match kind {
        vk::PhysicalDeviceType::DISCRETE_GPU => 0,
        vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
        vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
        vk::PhysicalDeviceType::CPU => 3,
        _ => 4,
    }
}

/// A device's shortcoming, as text for the user after the device's name.
type Lack = String;

/// Returns the index of a queue family that supports graphics and presentation, or what the device lacks.
pub(crate) fn find_graphics_queue_family(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    properties: &vk::PhysicalDeviceProperties,
    can_present: &impl Fn(vk::PhysicalDevice, u32) -> bool,
) -> Result<u32, Lack> {
    check_api_version(properties.api_version)?;
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
            && can_present(physical, *i)
    };
    (0..families.len() as u32)
        .find(draws)
        .ok_or_else(|| "has no queue that draws into the window".into())
}

/// Fails with a text for the user if the version is below the required one.
fn check_api_version(version: u32) -> Result<(), Lack> {
    if version < API_VERSION {
        let (major, minor) = (vk::api_version_major(version), vk::api_version_minor(version));
        return Err(format!("speaks Vulkan {major}.{minor}, not 1.1"));
    }
    Ok(())
}

/// Returns the device's name, for display.
pub(crate) fn device_name(properties: &vk::PhysicalDeviceProperties) -> String {
    let name = properties.device_name_as_c_str();
    name.map_or_else(|_| "unnamed".into(), |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_old_driver_is_told_as_such() {
        let old = vk::make_api_version(0, 1, 0, 999);
        assert_eq!(check_api_version(old), Err("speaks Vulkan 1.0, not 1.1".into()));
        assert_eq!(check_api_version(API_VERSION), Ok(()));
        assert_eq!(check_api_version(vk::make_api_version(0, 1, 4, 305)), Ok(()));
    }
}
