//! Attachment formats: colour, depth, samples and views of a render target.

use ash::vk;

use super::context::Gpu;

/// The format of the images that a renderer draws into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TargetFormat {
    /// Colour format; an sRGB one, as the programs output linear light.
    pub color: vk::Format,
    /// Samples per pixel: 1, 2 or 4, if [`TargetFormat::has_samples`]. Several samples are resolved
    /// within the pass, into the shell's single-sampled image.
    pub samples: u32,
    /// Multiview: layers of an image, one for each eye, 1 or 2.
    pub views: u32,
    /// Image layout of the shell's colour image after the pass.
    pub final_layout: vk::ImageLayout,
    /// `true` if depth is stored, in an image of the shell's, of format [`TargetFormat::choose_depth`].
    pub keep_depth: bool,
    /// `true` if the shell has a fragment density map for each image, which sets how densely its parts are
    /// shaded: a view of format [`TargetFormat::DENSITY`], made with
    /// `VK_IMAGE_USAGE_FRAGMENT_DENSITY_MAP_BIT_EXT`, in the layout for that use, with a layer for each eye
    /// or one for both. A device created without [`Options::density_map`], or without the feature, draws
    /// without maps. No tiler has run this yet, and no software driver has the extension: tests only check
    /// the arguments of the calls.
    ///
    /// [`Options::density_map`]: crate::gpu::Options::density_map
    pub density_map: bool,
    /// `true` if the shell's images are subsampled (`VK_IMAGE_CREATE_SUBSAMPLED_BIT_EXT`), which requires
    /// density maps: the renderer's own attachments are then subsampled too.
    pub is_subsampled: bool,
    /// `true` if the picture is drawn into an image of the renderer's own and then scaled up into the
    /// shell's. The picture can have fewer pixels ([`RenderTarget::set_drawn_extent`]). The overlay and the
    /// panels in the room are drawn after that, in full resolution and without depth test. The shell's
    /// images need `VK_IMAGE_USAGE_TRANSFER_DST_BIT`.
    ///
    /// [`RenderTarget::set_drawn_extent`]: crate::gpu::RenderTarget::set_drawn_extent
    pub scales_up: bool,
}

impl TargetFormat {
    /// Format of density maps: shading density along x and y.
    pub const DENSITY: vk::Format = vk::Format::R8G8_UNORM;

    /// Returns the depth format of a device: 32-bit float if supported, else 24 or 16 bits.
    #[must_use]
    pub fn choose_depth(gpu: &Gpu) -> vk::Format {
        let wanted = vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT;
        let has = |format: &vk::Format| {
            // SAFETY: the physical device is one of this instance's.
            let properties = unsafe {
                gpu.instance.raw.get_physical_device_format_properties(gpu.physical_device, *format)
            };
            properties.optimal_tiling_features.contains(wanted)
        };
        let formats = [vk::Format::D32_SFLOAT, vk::Format::X8_D24_UNORM_PACK32];
        formats.into_iter().find(has).unwrap_or(vk::Format::D16_UNORM)
    }

    /// Returns `true` if a device supports this many samples a pixel: each device supports 1 and 4, most
    /// support 2.
    #[must_use]
    pub fn has_samples(gpu: &Gpu, samples: u32) -> bool {
        // SAFETY: the physical device is one of this instance's.
        let properties =
            unsafe { gpu.instance.raw.get_physical_device_properties(gpu.physical_device) };
        let limits = properties.limits;
        let both = limits.framebuffer_color_sample_counts & limits.framebuffer_depth_sample_counts;
        both.contains(sample_count(samples))
    }

    /// Returns the formats of the frame's pass, and of the pass that draws the overlay.
    pub(crate) const fn pass_formats(&self) -> [Self; 2] {
        if self.scales_up {
            let aside = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
            [TargetFormat { final_layout: aside, ..*self }, TargetFormat { samples: 1, ..*self }]
        } else {
            [*self; 2]
        }
    }

    pub(crate) const fn sample_count(&self) -> vk::SampleCountFlags {
        sample_count(self.samples)
    }

    /// Returns the view mask: one bit for each view.
    pub(crate) const fn multiview_mask(&self) -> u32 {
        (1 << self.views) - 1
    }
}

const fn sample_count(samples: u32) -> vk::SampleCountFlags {
    match samples {
        4 => vk::SampleCountFlags::TYPE_4,
        2 => vk::SampleCountFlags::TYPE_2,
        _ => vk::SampleCountFlags::TYPE_1,
    }
}
