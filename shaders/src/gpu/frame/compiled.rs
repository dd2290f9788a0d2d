//! The part of a renderer that takes long to make: its programs, which the driver compiles.

use std::sync::Arc;

use ash::vk;

use super::renderer::RING;
use super::slot::FrameSlot;
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::format::TargetFormat;
use crate::gpu::device::owned::OwnedHandle;
use crate::gpu::memory::textures::SculptureTextures;
use crate::gpu::passes::overlay::Overlay;
use crate::gpu::passes::render_pass::RenderPass;
use crate::gpu::passes::shadow_map::ShadowMap;
use crate::gpu::pipelines::graphics::{PassHandles, Pipelines};
use crate::gpu::pipelines::scatter::TexelWriter;
use crate::twin::{carrara, noise};
use crate::upload::VolumeFormat;

/// A renderer whose programs are compiled and whose textures are empty. Making it submits nothing, so that
/// one thread can make it while another uses the device's queue.
pub struct CompiledRenderer {
    pub(super) gpu: Arc<Gpu>,
    pub(super) format: TargetFormat,
    pub(super) volume: VolumeFormat,
    pub(super) overlay: Overlay,
    pub(super) march_starts: [RenderPass; 2],
    pub(super) shadow: ShadowMap,
    pub(super) frame: RenderPass,
    pub(super) overlay_pass: Option<RenderPass>,
    pub(super) pipelines: Pipelines,
    pub(super) textures: SculptureTextures,
    pub(super) writer: Option<TexelWriter>,
    pub(super) ring: Vec<FrameSlot>,
    pub(super) pool: OwnedHandle<vk::CommandPool>,
}

impl core::fmt::Debug for CompiledRenderer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("CompiledRenderer")
            .field("format", &self.format)
            .field("volume", &self.volume)
            .finish()
    }
}

impl CompiledRenderer {
    /// Compiles the programs, with the arguments of [`Renderer::new`](super::renderer::Renderer::new), and
    /// computes the textures that are the same for all renderers.
    ///
    /// # Errors
    /// A call that failed; out of memory, most likely.
    pub fn compile(
        gpu: &Arc<Gpu>,
        format: TargetFormat,
        volume: VolumeFormat,
        cache_data: &[u8],
    ) -> Result<Self, Error> {
        let density_map = format.density_map && gpu.features.density_map;
        let format = TargetFormat { density_map, ..format };
        let march_starts = RenderPass::for_march_starts(gpu, &format)?;
        let [frame_format, overlay_format] = format.pass_formats();
        let frame = RenderPass::for_frame(gpu, &frame_format)?;
        let overlay_pass = match format.scales_up {
            true => Some(RenderPass::for_overlay(gpu, &overlay_format)?),
            false => None,
        };
        let draws_overlay = overlay_pass.as_ref().unwrap_or(&frame).raw;
        let shadow = ShadowMap::new(gpu)?;
        let passes = PassHandles {
            march_starts: march_starts.each_ref().map(|pass| pass.raw),
            shadow: shadow.pass.raw,
            frame: frame.raw,
            overlay: draws_overlay,
        };
        let pipelines = Pipelines::new(gpu, &format, volume, &passes, cache_data)?;
        let textures = SculptureTextures::new(gpu, volume, carrara::TEXTURE_SIDE as u32)?;
        let pool = create_command_pool(gpu)?;
        let overlay = Overlay::new(gpu, &overlay_format, draws_overlay, RING, pipelines.cache)?;
        let ring = (0..RING)
            .map(|_| FrameSlot::new(gpu, pool.raw, format.views))
            .collect::<Result<Vec<_>, _>>()?;
        let staged = ring.iter().map(|slot| &slot.staging);
        let writer = match gpu.features.storage_writes {
            true => Some(TexelWriter::new(gpu, &textures, staged, pipelines.cache)?),
            false => None,
        };
        // Computed now; both are cached.
        let (_, _) = (noise::noise_texture(), carrara::grey_texture_3d());
        let gpu = gpu.clone();
        Ok(CompiledRenderer {
            gpu,
            format,
            volume,
            overlay,
            march_starts,
            shadow,
            frame,
            overlay_pass,
            pipelines,
            textures,
            writer,
            ring,
            pool,
        })
    }
}

/// Creates a pool of command buffers that are re-recorded each frame.
fn create_command_pool(gpu: &Arc<Gpu>) -> Result<OwnedHandle<vk::CommandPool>, Error> {
    let info = vk::CommandPoolCreateInfo::default()
        .queue_family_index(gpu.queue_family)
        .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
    // SAFETY: the family is the device's.
    let pool = unsafe { gpu.device.create_command_pool(&info, None) }.could_not("make a pool")?;
    Ok(OwnedHandle::new(gpu, pool))
}

const _: () = {
    const fn assert_send<T: Send>() {}
    assert_send::<CompiledRenderer>();
};
