//! What a device of this machine offers, and whether that is enough.

use ash::vk;

use super::context::API;

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
    speaks(properties.api_version)?;
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

fn speaks(version: u32) -> Result<(), String> {
    if version < API {
        let (major, minor) = (vk::api_version_major(version), vk::api_version_minor(version));
        return Err(format!("speaks Vulkan {major}.{minor}, not 1.1"));
    }
    Ok(())
}

/// Its name, for people.
pub(super) fn name_of(properties: &vk::PhysicalDeviceProperties) -> String {
    let name = properties.device_name_as_c_str();
    name.map_or_else(|_| "unnamed".into(), |name| name.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_old_driver_is_told_as_such() {
        let old = vk::make_api_version(0, 1, 0, 999);
        assert_eq!(speaks(old), Err("speaks Vulkan 1.0, not 1.1".into()));
        assert_eq!(speaks(API), Ok(()));
        assert_eq!(speaks(vk::make_api_version(0, 1, 4, 305)), Ok(()));
    }
}
