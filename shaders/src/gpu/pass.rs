//! The render passes: where rays start, what the sun sees, and the frame itself.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;
use super::error::{Doing, Error};

/// What a renderer draws into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Format {
    /// Of the colour images; an sRGB one, as the programs give linear light.
    pub color: vk::Format,
    /// Samples of a pixel, 1 or 4; the shell's image has one, resolved within the pass.
    pub samples: u32,
    /// Layers of an image, 1 or 2: eyes.
    pub views: u32,
    /// The layout that the shell wants its colour image in afterwards.
    pub final_layout: vk::ImageLayout,
    /// Whether depth is kept, in an image of the shell's of format [`Format::depth`].
    pub keep_depth: bool,
    /// Whether the shell has a density map for each image, which tells how densely the picture's
    /// parts are shaded: a view of format [`Format::DENSITY`], made with
    /// `VK_IMAGE_USAGE_FRAGMENT_DENSITY_MAP_BIT_EXT`, in the layout for that use, a layer for each
    /// eye or one for both; the shell's images are not subsampled. A device that was not asked for
    /// [`Options::density_map`], or lacks it, draws without. No tiler has run this yet, and no
    /// software driver has the extension: what was checked is what the calls are given.
    ///
    /// [`Options::density_map`]: super::Options::density_map
    pub density_map: bool,
}

impl Format {
    /// Of density maps: how densely along x and along y.
    pub const DENSITY: vk::Format = vk::Format::R8G8_UNORM;

    /// The depth format of a device: floats if it has them.
    #[must_use]
    pub fn depth(gpu: &Gpu) -> vk::Format {
        let wanted = vk::FormatFeatureFlags::DEPTH_STENCIL_ATTACHMENT;
        let has = |format: &vk::Format| {
            // SAFETY: the physical device is one of this instance's.
            let properties = unsafe {
                gpu.instance.raw.get_physical_device_format_properties(gpu.physical, *format)
            };
            properties.optimal_tiling_features.contains(wanted)
        };
        let formats = [vk::Format::D32_SFLOAT, vk::Format::X8_D24_UNORM_PACK32];
        formats.into_iter().find(has).unwrap_or(vk::Format::D16_UNORM)
    }

    pub(super) const fn count(&self) -> vk::SampleCountFlags {
        if self.samples == 4 { vk::SampleCountFlags::TYPE_4 } else { vk::SampleCountFlags::TYPE_1 }
    }

    /// Bits of the views.
    pub(super) const fn mask(&self) -> u32 {
        (1 << self.views) - 1
    }
}

/// A render pass.
pub(super) struct Pass {
    gpu: Arc<Gpu>,
    pub(super) raw: vk::RenderPass,
}

impl Pass {
    /// The frame's pass: colour, depth, the resolved colour where there are several samples, and the
    /// density map where there is one. Nothing else is loaded, and only what the shell keeps is
    /// stored.
    pub(super) fn frame(gpu: &Arc<Gpu>, format: &Format) -> Result<Self, Error> {
        let depth = Format::depth(gpu);
        with_frame_info(format, depth, |info| Self::new(gpu, info))
    }

    /// A pass that finds where beams of rays start, for other programs to read.
    pub(super) fn starts(gpu: &Arc<Gpu>, format: &Format) -> Result<Self, Error> {
        let attachments = [vk::AttachmentDescription::default()
            .format(STARTS)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .final_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
        let colors = [vk::AttachmentReference {
            attachment: 0,
            layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
        }];
        let subpass = vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&colors);
        with_info(&attachments, subpass, format.mask(), None, |info| Self::new(gpu, info))
    }

    /// The sun's map: depth alone, for other programs to read.
    pub(super) fn shadow(gpu: &Arc<Gpu>, format: vk::Format) -> Result<Self, Error> {
        let attachments = [vk::AttachmentDescription::default()
            .format(format)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .final_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
        let depth = vk::AttachmentReference {
            attachment: 0,
            layout: vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
        };
        let subpass = vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .depth_stencil_attachment(&depth);
        with_info(&attachments, subpass, 0, None, |info| Self::new(gpu, info))
    }

    fn new(gpu: &Arc<Gpu>, info: &vk::RenderPassCreateInfo<'_>) -> Result<Self, Error> {
        // SAFETY: all that `info` points to lives until the call returns.
        let raw =
            unsafe { gpu.device.create_render_pass(info, None) }.doing("make a render pass")?;
        Ok(Pass { gpu: gpu.clone(), raw })
    }
}

/// Format of the beams' images: a depth in voxels.
pub(super) const STARTS: vk::Format = vk::Format::R32_SFLOAT;

impl Drop for Pass {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe { self.gpu.device.destroy_render_pass(self.raw, None) };
    }
}

/// Hands over what the frame's pass is made by, for a format of depth.
fn with_frame_info<T>(
    format: &Format,
    depth: vk::Format,
    make: impl FnOnce(&vk::RenderPassCreateInfo<'_>) -> T,
) -> T {
    let multisampled = format.samples > 1;
    let keep = |stored: bool| match stored {
        true => vk::AttachmentStoreOp::STORE,
        false => vk::AttachmentStoreOp::DONT_CARE,
    };
    let attachment = |of: vk::Format, samples, stored: bool, layout| {
        vk::AttachmentDescription::default()
            .format(of)
            .samples(samples)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(keep(stored))
            .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
            .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
            .final_layout(layout)
    };
    let color_layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
    let depth_layout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    let drawn = if multisampled { color_layout } else { format.final_layout };
    let mut attachments = vec![
        attachment(format.color, format.count(), !multisampled, drawn),
        attachment(depth, format.count(), format.keep_depth, depth_layout),
    ];
    if multisampled {
        let one = vk::SampleCountFlags::TYPE_1;
        let resolved = attachment(format.color, one, true, format.final_layout);
        attachments.push(resolved.load_op(vk::AttachmentLoadOp::DONT_CARE));
    }
    let reference = |attachment, layout| vk::AttachmentReference { attachment, layout };
    let density = format.density_map.then(|| {
        attachments.push(density_map());
        reference(attachments.len() as u32 - 1, DENSITY_LAYOUT)
    });
    let colors = [reference(0, color_layout)];
    let depth_reference = reference(1, depth_layout);
    let resolves = [reference(2, color_layout)];
    let mut subpass = vk::SubpassDescription::default()
        .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
        .color_attachments(&colors)
        .depth_stencil_attachment(&depth_reference);
    if multisampled {
        subpass = subpass.resolve_attachments(&resolves);
    }
    with_info(&attachments, subpass, format.mask(), density, make)
}

/// Hands over what a pass of one subpass is made by; `mask` has a bit for each view.
fn with_info<T>(
    attachments: &[vk::AttachmentDescription],
    subpass: vk::SubpassDescription<'_>,
    mask: u32,
    density: Option<vk::AttachmentReference>,
    make: impl FnOnce(&vk::RenderPassCreateInfo<'_>) -> T,
) -> T {
    let subpasses = [subpass];
    let drawn = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT
        | vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
    let read = vk::PipelineStageFlags::VERTEX_SHADER | vk::PipelineStageFlags::FRAGMENT_SHADER;
    let written =
        vk::AccessFlags::COLOR_ATTACHMENT_WRITE | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE;
    // What the frame before drew or read comes first; what comes after may read.
    let dependencies = [
        vk::SubpassDependency::default()
            .src_subpass(vk::SUBPASS_EXTERNAL)
            .src_stage_mask(drawn | read | vk::PipelineStageFlags::TRANSFER)
            .dst_stage_mask(drawn)
            .src_access_mask(written)
            .dst_access_mask(
                written
                    | vk::AccessFlags::COLOR_ATTACHMENT_READ
                    | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_READ,
            ),
        vk::SubpassDependency::default()
            .dst_subpass(vk::SUBPASS_EXTERNAL)
            .src_stage_mask(drawn)
            .dst_stage_mask(read | vk::PipelineStageFlags::TRANSFER)
            .src_access_mask(written)
            .dst_access_mask(vk::AccessFlags::SHADER_READ | vk::AccessFlags::TRANSFER_READ),
    ];
    let masks = [mask];
    // The sun's view is one, not one for each eye.
    let views = if mask == 0 { &masks[..0] } else { &masks[..] };
    let mut multiview =
        vk::RenderPassMultiviewCreateInfo::default().view_masks(views).correlation_masks(views);
    let mut mapped = vk::RenderPassFragmentDensityMapCreateInfoEXT::default();
    let mut info = vk::RenderPassCreateInfo::default()
        .attachments(attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies)
        .push_next(&mut multiview);
    if let Some(density) = density {
        mapped.fragment_density_map_attachment = density;
        info = info.push_next(&mut mapped);
    }
    make(&info)
}

const DENSITY_LAYOUT: vk::ImageLayout = vk::ImageLayout::FRAGMENT_DENSITY_MAP_OPTIMAL_EXT;

/// A density map as it comes from the shell, and stays.
fn density_map() -> vk::AttachmentDescription {
    vk::AttachmentDescription::default()
        .format(Format::DENSITY)
        .samples(vk::SampleCountFlags::TYPE_1)
        .load_op(vk::AttachmentLoadOp::LOAD)
        .store_op(vk::AttachmentStoreOp::DONT_CARE)
        .stencil_load_op(vk::AttachmentLoadOp::DONT_CARE)
        .stencil_store_op(vk::AttachmentStoreOp::DONT_CARE)
        .initial_layout(DENSITY_LAYOUT)
        .final_layout(DENSITY_LAYOUT)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pass's attachments, and which of them it names as its density map.
    fn asked(format: &Format) -> (Vec<vk::AttachmentDescription>, Option<vk::AttachmentReference>) {
        with_frame_info(format, vk::Format::D32_SFLOAT, |info| {
            let count = info.attachment_count as usize;
            // SAFETY: so many attachments stand there.
            let all = unsafe { core::slice::from_raw_parts(info.p_attachments, count) };
            let mut density = None;
            let mut next = info.p_next.cast::<vk::BaseInStructure>();
            // SAFETY: each structure of the chain is alive, and begins with its type and the next.
            while let Some(structure) = unsafe { next.as_ref() } {
                if structure.s_type
                    == vk::StructureType::RENDER_PASS_FRAGMENT_DENSITY_MAP_CREATE_INFO_EXT
                {
                    let mapped = next.cast::<vk::RenderPassFragmentDensityMapCreateInfoEXT<'_>>();
                    // SAFETY: its type says what it is.
                    density = Some(unsafe { (*mapped).fragment_density_map_attachment });
                }
                next = structure.p_next;
            }
            (all.to_vec(), density)
        })
    }

    /// The rules of VkRenderPassFragmentDensityMapCreateInfoEXT: an attachment of one sample that
    /// nothing else names, loaded, not stored, in the one layout.
    #[test]
    fn a_density_map_is_the_last_attachment() {
        for (samples, count) in [(1, 2), (4, 3)] {
            let format = Format {
                color: vk::Format::R8G8B8A8_SRGB,
                samples,
                views: 2,
                final_layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
                keep_depth: false,
                density_map: false,
            };
            let (all, density) = asked(&format);
            assert_eq!((all.len(), density.is_none()), (count, true));
            let (all, density) = asked(&Format { density_map: true, ..format });
            let density = density.expect("a density map");
            assert_eq!((all.len(), density.attachment as usize), (count + 1, count));
            assert_eq!(density.layout, vk::ImageLayout::FRAGMENT_DENSITY_MAP_OPTIMAL_EXT);
            let map = all[count];
            assert_eq!(map.format, vk::Format::R8G8_UNORM);
            assert_eq!(map.samples, vk::SampleCountFlags::TYPE_1);
            assert_eq!(map.load_op, vk::AttachmentLoadOp::LOAD);
            assert_eq!(map.store_op, vk::AttachmentStoreOp::DONT_CARE);
            assert_eq!([map.initial_layout, map.final_layout], [density.layout; 2]);
            let loaded =
                |one: &&vk::AttachmentDescription| one.load_op == vk::AttachmentLoadOp::LOAD;
            assert_eq!(all.iter().filter(loaded).count(), 1);
        }
    }
}
