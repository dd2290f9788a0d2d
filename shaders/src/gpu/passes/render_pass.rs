//! The render passes: march starts, shadow map, and the frame's pass.

use std::sync::Arc;

use ash::vk;

use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::format::TargetFormat;
use crate::gpu::device::owned::OwnedHandle;

/// A render pass.
pub(crate) struct RenderPass {
    gpu: Arc<Gpu>,
    pub(crate) raw: vk::RenderPass,
}

impl RenderPass {
    /// Creates the frame's pass. Attachments: colour, depth, resolved colour if multisampled, density map
    /// if enabled. Only the density map is loaded, and only the shell's images are stored.
    pub(crate) fn for_frame(gpu: &Arc<Gpu>, format: &TargetFormat) -> Result<Self, Error> {
        let depth = TargetFormat::choose_depth(gpu);
        with_frame_pass_info(format, depth, |info| Self::new(gpu, info))
    }

    /// Creates the pass that draws the overlay over a picture that was scaled up: one colour attachment,
    /// loaded.
    pub(crate) fn for_overlay(gpu: &Arc<Gpu>, format: &TargetFormat) -> Result<Self, Error> {
        let attachment = vk::AttachmentDescription::default()
            .format(format.color)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::LOAD)
            .store_op(vk::AttachmentStoreOp::STORE)
            .initial_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
            .final_layout(format.final_layout);
        Self::for_color_alone(gpu, format, attachment, vk::PipelineStageFlags::TRANSFER)
    }

    /// Creates the passes that write the depths at which marches start: of tiles, which vertex shaders of
    /// the next passes read too, and of beams, which only fragment shaders read, so that a tiler's binning
    /// doesn't wait for them.
    pub(crate) fn for_march_starts(
        gpu: &Arc<Gpu>,
        format: &TargetFormat,
    ) -> Result<[Self; 2], Error> {
        let fragments = vk::PipelineStageFlags::FRAGMENT_SHADER;
        Ok([
            Self::for_march_starts_read_by(
                gpu,
                format,
                fragments | vk::PipelineStageFlags::VERTEX_SHADER,
            )?,
            Self::for_march_starts_read_by(gpu, format, fragments)?,
        ])
    }

    fn for_march_starts_read_by(
        gpu: &Arc<Gpu>,
        format: &TargetFormat,
        readers: vk::PipelineStageFlags,
    ) -> Result<Self, Error> {
        let attachment = vk::AttachmentDescription::default()
            .format(MARCH_START_FORMAT)
            .samples(vk::SampleCountFlags::TYPE_1)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .store_op(vk::AttachmentStoreOp::STORE)
            .final_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
        Self::for_color_alone(gpu, format, attachment, readers)
    }

    /// Creates a pass of one colour attachment, with the views of the format.
    fn for_color_alone(
        gpu: &Arc<Gpu>,
        format: &TargetFormat,
        attachment: vk::AttachmentDescription,
        readers: vk::PipelineStageFlags,
    ) -> Result<Self, Error> {
        let layout = vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL;
        let colors = [vk::AttachmentReference { attachment: 0, layout }];
        let subpass = vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&colors);
        with_pass_info(&[attachment], subpass, format.multiview_mask(), (None, readers), |info| {
            Self::new(gpu, info)
        })
    }

    /// Creates the shadow map's pass: depth alone, to be sampled later.
    pub(crate) fn for_shadow_map(gpu: &Arc<Gpu>, format: vk::Format) -> Result<Self, Error> {
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
        let readers = vk::PipelineStageFlags::FRAGMENT_SHADER;
        with_pass_info(&attachments, subpass, 0, (None, readers), |info| Self::new(gpu, info))
    }

    fn new(gpu: &Arc<Gpu>, info: &vk::RenderPassCreateInfo<'_>) -> Result<Self, Error> {
        // SAFETY: all that `info` points to lives until the call returns.
        let raw =
            unsafe { gpu.device.create_render_pass(info, None) }.could_not("make a render pass")?;
        Ok(RenderPass { gpu: gpu.clone(), raw })
    }
}

/// Format of the march starts: a depth in voxels.
pub(crate) const MARCH_START_FORMAT: vk::Format = vk::Format::R32_SFLOAT;

impl Drop for RenderPass {
    fn drop(&mut self) {
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe { self.gpu.device.destroy_render_pass(self.raw, None) };
    }
}

/// Creates a framebuffer for a pass; image views in the order of the pass's attachments.
pub(crate) fn create_framebuffer(
    gpu: &Arc<Gpu>,
    pass: &RenderPass,
    [width, height]: [u32; 2],
    views: &[vk::ImageView],
) -> Result<OwnedHandle<vk::Framebuffer>, Error> {
    let info = vk::FramebufferCreateInfo::default()
        .render_pass(pass.raw)
        .attachments(views)
        .width(width)
        .height(height)
        .layers(1);
    // SAFETY: the views and the pass are this device's, and fit each other.
    let raw =
        unsafe { gpu.device.create_framebuffer(&info, None) }.could_not("make a framebuffer")?;
    Ok(OwnedHandle::new(gpu, raw))
}

/// Calls `make` with the create info of the frame's pass.
fn with_frame_pass_info<T>(
    format: &TargetFormat,
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
        attachment(format.color, format.sample_count(), !multisampled, drawn),
        attachment(depth, format.sample_count(), format.keep_depth, depth_layout),
    ];
    if multisampled {
        let one = vk::SampleCountFlags::TYPE_1;
        let resolved = attachment(format.color, one, true, format.final_layout);
        attachments.push(resolved.load_op(vk::AttachmentLoadOp::DONT_CARE));
    }
    let reference = |attachment, layout| vk::AttachmentReference { attachment, layout };
    let density = format.density_map.then(|| {
        attachments.push(density_map_attachment());
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
    let readers = vk::PipelineStageFlags::TRANSFER;
    with_pass_info(&attachments, subpass, format.multiview_mask(), (density, readers), make)
}

/// Calls `make` with the create info of a pass of one subpass. `view_mask` is the multiview mask, 0 without
/// multiview. Only the stages of `readers` wait for what the pass writes, and the next such pass waits for
/// them. On a GPU that draws in tiles, a vertex stage that waits for no fragment lets the next pass be
/// binned meanwhile.
fn with_pass_info<T>(
    attachments: &[vk::AttachmentDescription],
    subpass: vk::SubpassDescription<'_>,
    view_mask: u32,
    (density_map, readers): (Option<vk::AttachmentReference>, vk::PipelineStageFlags),
    make: impl FnOnce(&vk::RenderPassCreateInfo<'_>) -> T,
) -> T {
    let subpasses = [subpass];
    let drawn = vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT
        | vk::PipelineStageFlags::EARLY_FRAGMENT_TESTS
        | vk::PipelineStageFlags::LATE_FRAGMENT_TESTS;
    let written =
        vk::AccessFlags::COLOR_ATTACHMENT_WRITE | vk::AccessFlags::DEPTH_STENCIL_ATTACHMENT_WRITE;
    let dependencies = [
        vk::SubpassDependency::default()
            .src_subpass(vk::SUBPASS_EXTERNAL)
            .src_stage_mask(drawn | readers)
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
            .dst_stage_mask(readers)
            .src_access_mask(written)
            .dst_access_mask(match readers {
                vk::PipelineStageFlags::TRANSFER => vk::AccessFlags::TRANSFER_READ,
                _ => vk::AccessFlags::SHADER_READ,
            }),
    ];
    let masks = [view_mask];
    // The sun has one view, not one for each eye.
    let views = if view_mask == 0 { &masks[..0] } else { &masks[..] };
    let mut multiview =
        vk::RenderPassMultiviewCreateInfo::default().view_masks(views).correlation_masks(views);
    let mut mapped = vk::RenderPassFragmentDensityMapCreateInfoEXT::default();
    let mut info = vk::RenderPassCreateInfo::default()
        .attachments(attachments)
        .subpasses(&subpasses)
        .dependencies(&dependencies)
        .push_next(&mut multiview);
    if let Some(density) = density_map {
        mapped.fragment_density_map_attachment = density;
        info = info.push_next(&mut mapped);
    }
    make(&info)
}

const DENSITY_LAYOUT: vk::ImageLayout = vk::ImageLayout::FRAGMENT_DENSITY_MAP_OPTIMAL_EXT;

/// Returns the density map's attachment: loaded, with the same layout before and after.
fn density_map_attachment() -> vk::AttachmentDescription {
    vk::AttachmentDescription::default()
        .format(TargetFormat::DENSITY)
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

    /// Returns the attachments of the create info, and its reference to the density map.
    fn requested_attachments(
        format: &TargetFormat,
    ) -> (Vec<vk::AttachmentDescription>, Option<vk::AttachmentReference>) {
        with_frame_pass_info(format, vk::Format::D32_SFLOAT, |info| {
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

    /// The rules of VkRenderPassFragmentDensityMapCreateInfoEXT: an attachment of one sample that nothing
    /// else refers to, loaded, not stored, with the same layout before and after.
    #[test]
    fn a_density_map_is_the_last_attachment() {
        for (samples, count) in [(1, 2), (4, 3)] {
            let format = TargetFormat {
                color: vk::Format::R8G8B8A8_SRGB,
                samples,
                views: 2,
                final_layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
                keep_depth: false,
                density_map: false,
                is_subsampled: false,
                scales_up: false,
            };
            let (all, density) = requested_attachments(&format);
            assert_eq!((all.len(), density.is_none()), (count, true));
            let (all, density) =
                requested_attachments(&TargetFormat { density_map: true, ..format });
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

    /// Only transfers (readback) wait for a frame's picture, and no vertex stage is part of its
    /// dependencies.
    #[test]
    fn no_vertex_waits_for_a_picture_and_none_for_a_vertex() {
        let format = TargetFormat {
            color: vk::Format::R8G8B8A8_SRGB,
            samples: 4,
            views: 2,
            final_layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
            keep_depth: false,
            density_map: false,
            is_subsampled: false,
            scales_up: false,
        };
        with_frame_pass_info(&format, vk::Format::D32_SFLOAT, |info| {
            let count = info.dependency_count as usize;
            // SAFETY: so many dependencies stand there.
            let all = unsafe { core::slice::from_raw_parts(info.p_dependencies, count) };
            let stages = all.iter().fold(vk::PipelineStageFlags::empty(), |stages, one| {
                stages | one.src_stage_mask | one.dst_stage_mask
            });
            assert!(!stages.contains(vk::PipelineStageFlags::VERTEX_SHADER), "{stages:?}");
            assert_eq!(all[1].dst_stage_mask, vk::PipelineStageFlags::TRANSFER);
        });
    }
}
