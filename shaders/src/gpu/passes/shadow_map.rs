//! The sun's shadow map: an orthographic depth map over the room.

use std::sync::Arc;

use ash::vk;
use glam::{Mat4, Vec3};

use super::render_pass::{RenderPass, create_framebuffer};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::owned::OwnedHandle;
use crate::gpu::memory::image::{GpuImage, ImageSpec};
use crate::scene::SUN_BOUNDS;

/// Side of the map in texels: 9 mm each in the room, the width of the thinnest bit; 2 MiB.
pub(crate) const MAP_SIDE: u32 = 1024;

/// The shadow map with its pass, framebuffer and comparison sampler.
pub(crate) struct ShadowMap {
    pub(crate) pass: RenderPass,
    pub(crate) framebuffer: OwnedHandle<vk::Framebuffer>,
    pub(crate) image: GpuImage,
    /// Comparison sampler (percentage-closer filtering): the lit part of the texels around a point.
    pub(crate) sampler: OwnedHandle<vk::Sampler>,
    /// `true` once the map has been drawn, and so can be sampled.
    pub(crate) is_drawn: bool,
}

impl ShadowMap {
    pub(crate) fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let (format, filter) = choose_format(gpu);
        let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let image =
            GpuImage::new(gpu, ImageSpec::new_2d(format, [MAP_SIDE; 2], 1).with_usage(usage))?;
        let pass = RenderPass::for_shadow_map(gpu, format)?;
        let framebuffer = create_framebuffer(gpu, &pass, [MAP_SIDE; 2], &[image.view])?;
        // Points outside the map are lit.
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
        let raw = unsafe { gpu.device.create_sampler(&info, None) }.could_not("make a sampler")?;
        Ok(ShadowMap {
            pass,
            framebuffer,
            image,
            sampler: OwnedHandle::new(gpu, raw),
            is_drawn: false,
        })
    }
}

/// Returns the orthographic projection from the room to the map's clip space, over [`SUN_BOUNDS`]; depth 0
/// is next to the sun. `to_sun` is the unit vector towards it.
pub(crate) fn shadow_from_room(to_sun: Vec3) -> Mat4 {
    let (middle, radius) = (Vec3::from_array(SUN_BOUNDS.0), SUN_BOUNDS.1);
    let right = Vec3::Y.cross(to_sun).try_normalize().unwrap_or(Vec3::X);
    // The axes of an eye that looks along the rays: right, down, ahead.
    let rows = [right / radius, right.cross(to_sun) / radius, to_sun / (-2.0 * radius)];
    let [x, y, z] = rows.map(|row| row.extend(-row.dot(middle)));
    Mat4::from_cols(x, y, z + glam::Vec4::W * 0.5, glam::Vec4::W).transpose()
}

/// Returns the map's depth per metre away from the sun.
pub(crate) fn shadow_depth_per_metre() -> f32 {
    0.5 / SUN_BOUNDS.1
}

/// Chooses the depth format, with linear filtering where supported. 16 bits resolve 0.14 mm here; every
/// device has D16.
fn choose_format(gpu: &Gpu) -> (vk::Format, vk::Filter) {
    let linear = vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT
        | vk::FormatFeatureFlags::SAMPLED_IMAGE
        | vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR;
    let filters = |format: &vk::Format| {
        // SAFETY: the physical device is one of this instance's.
        let properties = unsafe {
            gpu.instance.raw.get_physical_device_format_properties(gpu.physical_device, *format)
        };
        properties.optimal_tiling_features.contains(linear)
    };
    let formats = [vk::Format::D16_UNORM, vk::Format::D32_SFLOAT];
    match formats.into_iter().find(filters) {
        Some(format) => (format, vk::Filter::LINEAR),
        None => (vk::Format::D16_UNORM, vk::Filter::NEAREST),
    }
}
