//! Optional device features: which of them are supported and requested, and the create info that
//! enables them.

use std::ffi::{CStr, c_char};

use ash::{ext, vk};

use super::options::Options;

/// Optional device features that are enabled.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DeviceFeatures {
    /// 16-bit float arithmetic (`shaderFloat16`). Off on discrete GPUs, where it is no faster.
    pub half_precision: bool,
    /// Fragment density maps (`VK_EXT_fragment_density_map`) for images that are not subsampled;
    /// false unless requested.
    pub density_map: bool,
    /// Compute writes to 8-bit storage images (`shaderStorageImageExtendedFormats`). Off on integrated
    /// GPUs, which may compress storage images less well; those upload by copies.
    pub storage_writes: bool,
    /// Pipeline statistics queries of fragment invocations; false unless requested.
    pub fragment_counts: bool,
    /// Duration of a timestamp tick, in femtoseconds; 0 without timestamp queries.
    pub timestamp_period_fs: u64,
}

/// The requested features, as far as the device supports them.
pub(crate) struct NegotiatedFeatures {
    pub(crate) enabled: DeviceFeatures,
    /// Texts for the user about requested features that are missing.
    pub(crate) missing: Vec<&'static str>,
}

/// Text for the user when density maps are requested and not supported.
const NO_DENSITY_MAP: &str = "density maps (VK_EXT_fragment_density_map with images that are not \
                              subsampled): every part of a picture is shaded alike";

impl DeviceFeatures {
    /// Intersects supported with requested features.
    pub(crate) fn negotiate(
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        queue_family: u32,
        options: &Options,
    ) -> NegotiatedFeatures {
        let mut enabled = DeviceFeatures::query_device(instance, physical, queue_family);
        enabled.half_precision &= !options.single_precision;
        enabled.storage_writes &= !options.copies_only;
        let lacks = options.density_map && !enabled.density_map;
        enabled.density_map &= options.density_map;
        enabled.fragment_counts &= options.fragment_counts;
        let missing = lacks.then_some(NO_DENSITY_MAP).into_iter().collect();
        NegotiatedFeatures { enabled, missing }
    }

    /// Queries the features that a physical device and its queue family support.
    fn query_device(
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        queue_family: u32,
    ) -> DeviceFeatures {
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
        let family = &families[queue_family as usize];
        let bits = family.timestamp_valid_bits;
        let period = (f64::from(properties.limits.timestamp_period) * 1e6) as u64;
        DeviceFeatures {
            half_precision: has_half
                && half.shader_float16 == vk::TRUE
                && properties.device_type != vk::PhysicalDeviceType::DISCRETE_GPU,
            density_map: has_density
                && density.fragment_density_map == vk::TRUE
                && density.fragment_density_map_non_subsampled_images == vk::TRUE,
            storage_writes: writes == vk::TRUE
                && family.queue_flags.contains(vk::QueueFlags::COMPUTE)
                && properties.device_type != vk::PhysicalDeviceType::INTEGRATED_GPU,
            fragment_counts: counts == vk::TRUE,
            timestamp_period_fs: if bits == 0 { 0 } else { period },
        }
    }

    /// Calls `make` with the create info of a device with one queue of a family.
    pub(crate) fn with_create_info<T>(
        &self,
        queue_family: u32,
        options: &Options,
        make: impl FnOnce(&vk::DeviceCreateInfo<'_>) -> T,
    ) -> T {
        let queues = [vk::DeviceQueueCreateInfo::default()
            .queue_family_index(queue_family)
            .queue_priorities(&[1.0])];
        let mut extensions: Vec<*const c_char> =
            options.device_extensions.iter().map(|name| name.as_ptr()).collect();
        let mut multiview = vk::PhysicalDeviceMultiviewFeatures::default().multiview(true);
        let mut half = vk::PhysicalDeviceShaderFloat16Int8Features::default().shader_float16(true);
        let mut density = vk::PhysicalDeviceFragmentDensityMapFeaturesEXT::default()
            .fragment_density_map(true)
            .fragment_density_map_non_subsampled_images(true);
        let mut info = vk::DeviceCreateInfo::default().push_next(&mut multiview);
        if self.half_precision {
            extensions.push(vk::KHR_SHADER_FLOAT16_INT8_NAME.as_ptr());
            info = info.push_next(&mut half);
        }
        if self.density_map {
            extensions.push(ext::fragment_density_map::NAME.as_ptr());
            info = info.push_next(&mut density);
        }
        let features = vk::PhysicalDeviceFeatures::default()
            .pipeline_statistics_query(self.fragment_counts)
            .shader_storage_image_extended_formats(self.storage_writes);
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

    /// Returns the extensions and the `pNext` chain of the create info.
    fn requested_structures(needs: DeviceFeatures) -> (Vec<&'static CStr>, Vec<vk::StructureType>) {
        needs.with_create_info(0, &Options::default(), |info| {
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
        let needs = DeviceFeatures {
            half_precision: false,
            density_map: false,
            storage_writes: false,
            fragment_counts: false,
            timestamp_period_fs: 0,
        };
        assert_eq!(requested_structures(needs), (vec![], vec![multiview]));
        let (names, chain) = requested_structures(DeviceFeatures { density_map: true, ..needs });
        assert_eq!(names, [ext::fragment_density_map::NAME]);
        assert_eq!(chain.len(), 2);
        assert!(chain.contains(&multiview) && chain.contains(&density));
    }
}
