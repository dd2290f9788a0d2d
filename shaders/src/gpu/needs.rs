//! What a device offers of what the renderer can use, and the structures that ask for it.

use std::ffi::{CStr, c_char};

use ash::{ext, vk};

use super::context::Options;

/// What a device offers of what the renderer can use.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Needs {
    /// Arithmetic of half precision. A discrete GPU has no use for it: it is no quicker there, and
    /// registers are many.
    pub half: bool,
    /// Maps that tell how densely a picture's parts are shaded (`VK_EXT_fragment_density_map`), for
    /// images that are not subsampled themselves; false unless it was asked for.
    pub density_map: bool,
    /// Programs that write bytes of textures (`shaderStorageImageExtendedFormats`). An integrated GPU
    /// may pack textures less well that can be written so, and is left to copies.
    pub scatter: bool,
    /// Counting shaded fragments; false unless it was asked for.
    pub fragment_counts: bool,
    /// Nanoseconds in a tick of its timestamps, in millionths; 0 if it has none.
    pub timestamp_period: u64,
}

/// What is told of a device that was asked for density maps and has none.
const NO_DENSITY_MAP: &str = "density maps (VK_EXT_fragment_density_map with images that are not \
                              subsampled): every part of a picture is shaded alike";

impl Needs {
    /// What is both offered and wanted, and what is wanted and not offered.
    pub(super) fn agreed(
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        family: u32,
        options: &Options,
    ) -> (Needs, Vec<&'static str>) {
        let mut needs = Needs::offered(instance, physical, family);
        needs.half &= !options.single;
        needs.scatter &= !options.copies;
        let lacks = options.density_map && !needs.density_map;
        needs.density_map &= options.density_map;
        needs.fragment_counts &= options.fragment_counts;
        (needs, lacks.then_some(NO_DENSITY_MAP).into_iter().collect())
    }

    fn offered(instance: &ash::Instance, physical: vk::PhysicalDevice, family: u32) -> Needs {
        let has = |name| has_extension(instance, physical, name);
        let mut half = vk::PhysicalDeviceShaderFloat16Int8Features::default();
        let mut density = vk::PhysicalDeviceFragmentDensityMapFeaturesEXT::default();
        let mut features = vk::PhysicalDeviceFeatures2::default();
        let (has_half, has_density) =
            (has(vk::KHR_SHADER_FLOAT16_INT8_NAME), has(ext::fragment_density_map::NAME));
        if has_half {
            features = features.push_next(&mut half);
        }
        if has_density {
            features = features.push_next(&mut density);
        }
        // SAFETY: the physical device is one of this instance's, and speaks 1.1.
        unsafe { instance.get_physical_device_features2(physical, &mut features) };
        let counts = features.features.pipeline_statistics_query;
        let writes = features.features.shader_storage_image_extended_formats;
        // SAFETY: as above.
        let properties = unsafe { instance.get_physical_device_properties(physical) };
        // SAFETY: as above.
        let families = unsafe { instance.get_physical_device_queue_family_properties(physical) };
        let family = &families[family as usize];
        let bits = family.timestamp_valid_bits;
        let period = (f64::from(properties.limits.timestamp_period) * 1e6) as u64;
        Needs {
            half: has_half
                && half.shader_float16 == vk::TRUE
                && properties.device_type != vk::PhysicalDeviceType::DISCRETE_GPU,
            density_map: has_density
                && density.fragment_density_map == vk::TRUE
                && density.fragment_density_map_non_subsampled_images == vk::TRUE,
            scatter: writes == vk::TRUE
                && family.queue_flags.contains(vk::QueueFlags::COMPUTE)
                && properties.device_type != vk::PhysicalDeviceType::INTEGRATED_GPU,
            fragment_counts: counts == vk::TRUE,
            timestamp_period: if bits == 0 { 0 } else { period },
        }
    }

    /// Hands over what a device with one queue of a family is made by.
    pub(super) fn with_device_info<T>(
        &self,
        family: u32,
        options: &Options,
        make: impl FnOnce(&vk::DeviceCreateInfo<'_>) -> T,
    ) -> T {
        let queues = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(family)
            .queue_priorities(&[1.0])];
        let mut extensions: Vec<*const c_char> =
            options.device_extensions.iter().map(|name| name.as_ptr()).collect();
        let mut multiview = vk::PhysicalDeviceMultiviewFeatures::default().multiview(true);
        let mut half = vk::PhysicalDeviceShaderFloat16Int8Features::default().shader_float16(true);
        let mut density = vk::PhysicalDeviceFragmentDensityMapFeaturesEXT::default()
            .fragment_density_map(true)
            .fragment_density_map_non_subsampled_images(true);
        let mut info = vk::DeviceCreateInfo::default().push_next(&mut multiview);
        if self.half {
            extensions.push(vk::KHR_SHADER_FLOAT16_INT8_NAME.as_ptr());
            info = info.push_next(&mut half);
        }
        if self.density_map {
            extensions.push(ext::fragment_density_map::NAME.as_ptr());
            info = info.push_next(&mut density);
        }
        let features = vk::PhysicalDeviceFeatures::default()
            .pipeline_statistics_query(self.fragment_counts)
            .shader_storage_image_extended_formats(self.scatter);
        let info = info.queue_create_infos(&queues).enabled_extension_names(&extensions);
        make(&info.enabled_features(&features))
    }
}

fn has_extension(instance: &ash::Instance, physical: vk::PhysicalDevice, name: &CStr) -> bool {
    // SAFETY: the physical device is one of this instance's.
    let all = unsafe { instance.enumerate_device_extension_properties(physical) };
    all.is_ok_and(|all| all.iter().any(|one| one.extension_name_as_c_str() == Ok(name)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The extensions and the structures that a device is made by.
    fn asked(needs: Needs) -> (Vec<&'static CStr>, Vec<vk::StructureType>) {
        needs.with_device_info(0, &Options::default(), |info| {
            let (names, count) = (info.pp_enabled_extension_names, info.enabled_extension_count);
            let name = |i| {
                // SAFETY: so many names stand there, each a constant of ash.
                unsafe { CStr::from_ptr(*names.add(i)) }
            };
            let names = (0..count as usize).map(name).collect();
            let (mut chain, mut next) = (Vec::new(), info.p_next.cast::<vk::BaseInStructure>());
            // SAFETY: each structure of the chain is alive, and begins with its type and the next.
            while let Some(structure) = unsafe { next.as_ref() } {
                chain.push(structure.s_type);
                next = structure.p_next;
            }
            (names, chain)
        })
    }

    #[test]
    fn a_device_is_asked_for_what_was_agreed() {
        let multiview = vk::StructureType::PHYSICAL_DEVICE_MULTIVIEW_FEATURES;
        let density = vk::StructureType::PHYSICAL_DEVICE_FRAGMENT_DENSITY_MAP_FEATURES_EXT;
        let needs = Needs {
            half: false,
            density_map: false,
            scatter: false,
            fragment_counts: false,
            timestamp_period: 0,
        };
        assert_eq!(asked(needs), (vec![], vec![multiview]));
        let (names, chain) = asked(Needs { density_map: true, ..needs });
        assert_eq!(names, [ext::fragment_density_map::NAME]);
        assert_eq!(chain.len(), 2);
        assert!(chain.contains(&multiview) && chain.contains(&density));
    }
}
