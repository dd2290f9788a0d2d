//! The sun's map: how far its light reaches, as depths that it sees.

use std::sync::Arc;

use ash::vk;
use glam::{Mat4, Vec3};

use super::context::Gpu;
use super::error::{Doing, Error};
use super::image::{Image, Shape};
use super::owned::Owned;
use super::pass::Pass;
use super::surface::framebuffer;
use crate::scene::SUN_BOUNDS;

/// Texels along a side: 9 mm each in the room, as wide as the thinnest bit is, in 2 MiB.
pub(super) const SIDE: u32 = 1024;

/// The map, what draws it and what looks into it.
pub(super) struct ShadowMap {
    pub(super) pass: Pass,
    pub(super) framebuffer: Owned<vk::Framebuffer>,
    pub(super) image: Image,
    /// Tells which part of the samples about a place are lit.
    pub(super) sampler: Owned<vk::Sampler>,
    /// Whether it was drawn since it was made, and so can be looked into.
    pub(super) drawn: bool,
}

impl ShadowMap {
    pub(super) fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let (format, filter) = format(gpu);
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let image = Image::new(gpu, Shape::flat(format, [SIDE; 2], 1).usage(usage))?;
        let pass = Pass::shadow(gpu, format)?;
        let framebuffer = framebuffer(gpu, &pass, [SIDE; 2], &[image.view])?;
        // What the map doesn't show is lit.
        let border = vk::SamplerAddressMode::CLAMP_TO_BORDER;
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .address_mode_u(border)
            .address_mode_v(border)
            .address_mode_w(border)
            .border_color(vk::BorderColor::FLOAT_OPAQUE_WHITE)
            .compare_enable(true)
            .compare_op(vk::CompareOp::LESS_OR_EQUAL);
        // SAFETY: the device is alive and the info complete.
        let raw = unsafe { gpu.device.create_sampler(&info, None) }.doing("make a sampler")?;
        Ok(ShadowMap { pass, framebuffer, image, sampler: Owned::new(gpu, raw), drawn: false })
    }
}

/// Clip space of the map from the room: parallel rays, all that casts within, depth 0 next to the
/// sun.
pub(super) fn shadow_from_room(sun: Vec3) -> Mat4 {
    let (middle, radius) = (Vec3::from_array(SUN_BOUNDS.0), SUN_BOUNDS.1);
    let right = Vec3::Y.cross(sun).try_normalize().unwrap_or(Vec3::X);
    // As an eye that looks along the rays has them: right, down, ahead.
    let rows = [right / radius, right.cross(sun) / radius, sun / (-2.0 * radius)];
    let [x, y, z] = rows.map(|row| row.extend(-row.dot(middle)));
    Mat4::from_cols(x, y, z + glam::Vec4::W * 0.5, glam::Vec4::W).transpose()
}

/// Depth of the map that a metre is.
pub(super) fn depth_per_metre() -> f32 {
    0.5 / SUN_BOUNDS.1
}

/// 16 bits are 0.14 mm here. Filtered if a format is; a map of D16 every device has.
fn format(gpu: &Gpu) -> (vk::Format, vk::Filter) {
    let linear = vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT
        | vk::FormatFeatureFlags::SAMPLED_IMAGE
        | vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR;
    let filters = |format: &vk::Format| {
        // SAFETY: the physical device is one of this instance's.
        let properties = unsafe {
            gpu.instance.raw.get_physical_device_format_properties(gpu.physical, *format)
        };
        properties.optimal_tiling_features.contains(linear)
    };
    let formats = [vk::Format::D16_UNORM, vk::Format::D32_SFLOAT];
    match formats.into_iter().find(filters) {
        Some(format) => (format, vk::Filter::LINEAR),
        None => (vk::Format::D16_UNORM, vk::Filter::NEAREST),
    }
}
