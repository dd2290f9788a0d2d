//! The renderer: a ring of two frames in flight, each with its command buffer, buffers and queries.

use std::sync::Arc;

use ash::vk;

use super::compiled::CompiledRenderer;
use super::mesh_buffers::MeshBuffers;
use super::request::{FrameRequest, SculptureOrder};
use super::slot::FrameSlot;
use super::uniforms;
use crate::constants::NOISE_TEXELS;
use crate::field::FigureShares;
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::format::TargetFormat;
use crate::gpu::device::owned::OwnedHandle;
use crate::gpu::memory::image::GpuImage;
use crate::gpu::memory::panel_atlas::create_panel_atlas;
use crate::gpu::memory::panel_pictures::PanelPictureLayers;
use crate::gpu::memory::staging::FRAME_UPLOAD_BYTES;
use crate::gpu::memory::textures::SculptureTextures;
use crate::gpu::passes::fragments::FragmentCounts;
use crate::gpu::passes::overlay::Overlay;
use crate::gpu::passes::render_pass::RenderPass;
use crate::gpu::passes::shadow_map::ShadowMap;
use crate::gpu::passes::target::{RenderTarget, TargetResources, TargetViews};
use crate::gpu::passes::timers::{FrameTimes, Timestamp};
use crate::gpu::passes::upload::record_uploads;
use crate::gpu::pipelines::graphics::Pipelines;
use crate::gpu::pipelines::paths::RenderPath;
use crate::gpu::pipelines::scatter::TexelWriter;
use crate::twin::image::Image;
use crate::twin::{carrara, noise};
use crate::upload::{Region, Texture, VolumeFormat};

/// Frames in flight.
pub(super) const RING: usize = 2;

/// The semaphores of a frame's submission, for a swapchain.
#[derive(Clone, Copy, Default, Debug)]
pub struct FrameSemaphores {
    /// Waited for before colour output: the image is available.
    pub wait: Option<vk::Semaphore>,
    /// Signaled when the frame is done.
    pub signal: Option<vk::Semaphore>,
}

/// Draws sculptures of one volume format, for one target format.
///
/// A failed call may lose staged uploads: drop the renderer then and create another one, on another
/// device if this one [is lost].
///
/// [is lost]: Error::is_lost
pub struct Renderer {
    pub(crate) gpu: Arc<Gpu>,
    format: TargetFormat,
    volume: VolumeFormat,
    /// The overlay of the current frame.
    pub overlay: Overlay,
    /// The passes of the march starts: of tiles, and of beams.
    pub(crate) march_starts: [RenderPass; 2],
    pub(crate) shadow: ShadowMap,
    pub(crate) frame: RenderPass,
    /// The pass that draws the overlay after the frame's pass; `None` unless the picture is scaled up.
    pub(crate) overlay_pass: Option<RenderPass>,
    pub(crate) pipelines: Pipelines,
    pub(crate) textures: SculptureTextures,
    panel_atlas: GpuImage,
    panel_pictures: PanelPictureLayers,
    /// `None` without compute writes.
    writer: Option<TexelWriter>,
    pub(crate) meshes: MeshBuffers,
    pub(crate) ring: Vec<FrameSlot>,
    /// Pool of the ring's command buffers.
    _pool: OwnedHandle<vk::CommandPool>,
    pub(crate) slot_index: usize,
    gpu_frame_times: FrameTimes,
    fragment_counts: FragmentCounts,
    pub(crate) order: SculptureOrder,
    pub(crate) times_sculpture: bool,
}

impl core::fmt::Debug for Renderer {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Renderer")
            .field("format", &self.format)
            .field("volume", &self.volume)
            .finish()
    }
}

impl Renderer {
    /// Creates a renderer for volumes of the format `volume`. `cache_data` is the result of
    /// [`Renderer::pipeline_cache_data`] at an earlier start, or empty. The renderer does without density
    /// maps if the device has none: see [`Gpu::missing_features`].
    ///
    /// # Errors
    /// A call that failed; out of memory, most likely.
    pub fn new(
        gpu: &Arc<Gpu>,
        format: TargetFormat,
        volume: VolumeFormat,
        cache_data: &[u8],
    ) -> Result<Self, Error> {
        Self::from_compiled(CompiledRenderer::compile(gpu, format, volume, cache_data)?)
    }

    /// Makes a renderer from its compiled programs: uploads its meshes and textures.
    ///
    /// # Errors
    /// A call that failed; out of memory, most likely.
    pub fn from_compiled(compiled: CompiledRenderer) -> Result<Self, Error> {
        let meshes = MeshBuffers::new(&compiled.gpu)?;
        let panel_atlas = create_panel_atlas(&compiled.gpu)?;
        let panel_pictures = PanelPictureLayers::new(&compiled.gpu, RING)?;
        let mut renderer = Renderer {
            gpu: compiled.gpu,
            format: compiled.format,
            volume: compiled.volume,
            overlay: compiled.overlay,
            march_starts: compiled.march_starts,
            shadow: compiled.shadow,
            frame: compiled.frame,
            overlay_pass: compiled.overlay_pass,
            pipelines: compiled.pipelines,
            textures: compiled.textures,
            panel_atlas,
            panel_pictures,
            writer: compiled.writer,
            meshes,
            ring: compiled.ring,
            _pool: compiled.pool,
            slot_index: 0,
            gpu_frame_times: FrameTimes::default(),
            fragment_counts: FragmentCounts::default(),
            order: SculptureOrder::default(),
            times_sculpture: false,
        };
        let cube = |texture, side: usize| Region { texture, min: [0; 3], size: [side as u32; 3] };
        let bytes: Vec<u8> =
            noise::noise_texture().iter().map(|noise| noise.cast_unsigned()).collect();
        renderer.submit_upload_between_frames(cube(Texture::Noise, NOISE_TEXELS), &bytes)?;
        renderer.submit_figure_between_frames(&FigureShares::new())?;
        Ok(renderer)
    }

    /// Returns the target format: as requested, as far as the device supports it.
    #[must_use]
    pub const fn format(&self) -> &TargetFormat {
        &self.format
    }

    /// Returns the GPU times of the latest frame known to be done.
    #[must_use]
    pub const fn gpu_frame_times(&self) -> FrameTimes {
        self.gpu_frame_times
    }

    /// Returns the fragment counts of the latest frame known to be done.
    #[must_use]
    pub const fn fragment_counts(&self) -> FragmentCounts {
        self.fragment_counts
    }

    /// Sets the draw order of later frames, for benchmarks.
    pub const fn set_sculpture_order(&mut self, order: SculptureOrder) {
        self.order = order;
    }

    /// Returns the serialised pipeline cache of this device and driver, which speeds up the next start.
    ///
    /// # Errors
    /// A lost device.
    pub fn pipeline_cache_data(&self) -> Result<Vec<u8>, Error> {
        self.pipelines.cache_data()
    }

    /// Sets whether later frames have a timestamp before and after the sculpture, for benchmarks.
    pub const fn set_timing_of_sculpture(&mut self, is_on: bool) {
        self.times_sculpture = is_on;
    }

    /// Creates a render target for the shell's image views.
    ///
    /// # Errors
    /// A call that failed.
    pub fn create_target_without_density_maps(
        &self,
        extent: [u32; 2],
        colors: &[vk::ImageView],
        depths: &[vk::ImageView],
    ) -> Result<RenderTarget, Error> {
        self.create_target_with_density_maps(extent, colors, depths, &[])
    }

    /// Creates a render target with a density map for each image; the maps are ignored if
    /// [`Renderer::format`] has no density maps.
    ///
    /// # Errors
    /// [`Error::NoDensityMap`], or a call that failed.
    pub fn create_target_with_density_maps(
        &self,
        extent: [u32; 2],
        colors: &[vk::ImageView],
        depths: &[vk::ImageView],
        density_maps: &[vk::ImageView],
    ) -> Result<RenderTarget, Error> {
        self.create_target(extent, &TargetViews { colors, depths, density_maps, images: &[] })
    }

    /// Creates a render target for a renderer whose format [`scales_up`](TargetFormat::scales_up), from the
    /// shell's images and a view of each.
    ///
    /// # Errors
    /// A call that failed.
    pub fn create_target_that_scales_up(
        &self,
        extent: [u32; 2],
        images: &[vk::Image],
        colors: &[vk::ImageView],
    ) -> Result<RenderTarget, Error> {
        self.create_target(extent, &TargetViews { colors, depths: &[], density_maps: &[], images })
    }

    fn create_target(
        &self,
        extent: [u32; 2],
        views: &TargetViews<'_>,
    ) -> Result<RenderTarget, Error> {
        let resources = TargetResources {
            gpu: &self.gpu,
            format: &self.format,
            march_starts: &self.march_starts,
            frame: &self.frame,
            overlay_pass: self.overlay_pass.as_ref(),
            pipelines: &self.pipelines,
            textures: &self.textures,
            panel_atlas: &self.panel_atlas,
            panel_pictures: &self.panel_pictures.image,
            shadow: &self.shadow,
        };
        RenderTarget::new(&resources, extent, views, self.ring.iter().map(|slot| &slot.uniform))
    }

    /// Begins a frame: waits for the fence of the frame before the last.
    ///
    /// # Errors
    /// A lost device.
    pub fn wait_and_begin_frame(&mut self) -> Result<(), Error> {
        let slot = &mut self.ring[self.slot_index];
        if slot.is_submitted {
            let fences = [slot.fence.raw];
            // SAFETY: the fence is this device's.
            unsafe { self.gpu.device.wait_for_fences(&fences, true, u64::MAX) }
                .could_not("wait for a frame")?;
            slot.is_submitted = false;
        }
        if slot.has_picture {
            (self.gpu_frame_times, self.fragment_counts) =
                (slot.timers.read(), slot.counters.read());
        }
        slot.has_picture = false;
        slot.staging.clear();
        self.overlay.begin_frame(self.slot_index);
        Ok(())
    }

    /// Sets the picture of a panel cell. One of the next frames uploads it; each frame uploads at most one.
    /// Returns `false`, without effect, if there is no such cell or the picture doesn't have a cell's size.
    pub fn set_panel_picture(&mut self, cell: u8, picture: &Image) -> bool {
        self.panel_pictures.set(cell, picture)
    }

    /// Stages a region's bytes for upload in the current frame. Returns `false`, without effect, if there
    /// is no room.
    #[must_use]
    pub fn try_stage_upload(&mut self, region: Region, bytes: &[u8]) -> bool {
        debug_assert_eq!(region.byte_count(), bytes.len(), "a region's bytes");
        debug_assert!(region.has_intervals_of(self.volume), "{region:?} of {:?}", self.volume);
        self.ring[self.slot_index].staging.try_push(region, bytes)
    }

    /// Uploads a region of any size now, in as many submissions as it takes, without drawing.
    ///
    /// # Errors
    /// A lost device.
    pub fn submit_upload_between_frames(
        &mut self,
        region: Region,
        bytes: &[u8],
    ) -> Result<(), Error> {
        let layer = bytes.len() / region.size[2] as usize;
        let layers = (FRAME_UPLOAD_BYTES / layer).max(1);
        for (i, part) in bytes.chunks(layers * layer).enumerate() {
            let mut piece = region;
            piece.min[2] += (i * layers) as u32;
            piece.size[2] = (part.len() / layer) as u32;
            self.wait_and_begin_frame()?;
            let fits = self.try_stage_upload(piece, part);
            assert!(fits, "a layer of a texture is larger than a frame's staging memory");
            self.submit_frame(FrameSemaphores::default(), |_, _| ())?;
        }
        Ok(())
    }

    /// Uploads the marble with another hidden figure's shares.
    ///
    /// # Errors
    /// A lost device.
    pub fn submit_figure_between_frames(&mut self, figure: &FigureShares) -> Result<(), Error> {
        let grey_and_share = carrara::grey_texture_3d().iter().zip(figure.bytes());
        let bytes: Vec<u8> = grey_and_share.flat_map(|(&grey, &share)| [grey, share]).collect();
        self.submit_upload_between_frames(Region::whole_marble(), &bytes)
    }

    /// Records and submits the current frame, with the uploads staged since [`wait_and_begin_frame`], into an
    /// image of the target.
    ///
    /// [`wait_and_begin_frame`]: Renderer::wait_and_begin_frame
    ///
    /// # Errors
    /// A lost device.
    pub fn draw_frame(
        &mut self,
        request: &FrameRequest<'_>,
        target: &RenderTarget,
        image_index: usize,
        semaphores: FrameSemaphores,
    ) -> Result<(), Error> {
        self.pipelines.ensure_sculpture_pipeline(request.style.path, request.style.drawn)?;
        let (side, pixels) = (self.volume.grid_side(), target.drawn_extent());
        let bytes = uniforms::frame_uniforms(request, side, pixels);
        let slot = &mut self.ring[self.slot_index];
        slot.uniform.write(0, bytemuck::bytes_of(&bytes));
        if let Some(scene) = request.scene {
            slot.instances.write(0, bytemuck::cast_slice(scene.instances()));
        }
        slot.write_panels(request.panels);
        let at = self.slot_index;
        self.submit_frame(semaphores, |renderer, commands| {
            renderer.record_shadow_map(commands, request.scene, target.sets[at]);
            renderer.ring[at].timers.write_timestamp(commands, Timestamp::Shadowed);
            if request.style.path == RenderPath::Fast {
                renderer.record_march_starts(commands, target);
            }
            renderer.ring[at].timers.write_timestamp(commands, Timestamp::Tiled);
            renderer.record_frame_pass(commands, request, target, image_index);
            renderer.ring[at].has_picture = true;
        })
    }

    /// Waits for all frames, until the device is idle; returns the GPU times of the latest frame.
    ///
    /// # Errors
    /// A lost device.
    pub fn wait_for_frames(&mut self) -> Result<FrameTimes, Error> {
        self.gpu.wait_idle()?;
        let slot = &self.ring[(self.slot_index + RING - 1) % RING];
        if slot.has_picture {
            (self.gpu_frame_times, self.fragment_counts) =
                (slot.timers.read(), slot.counters.read());
        }
        Ok(self.gpu_frame_times)
    }

    /// Records the uploads and the commands of `record`, submits them, and advances the ring.
    fn submit_frame(
        &mut self,
        semaphores: FrameSemaphores,
        record: impl FnOnce(&mut Self, vk::CommandBuffer),
    ) -> Result<(), Error> {
        let gpu = self.gpu.clone();
        let slot = &mut self.ring[self.slot_index];
        let (commands, fence) = (slot.commands, slot.fence.raw);
        let info = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the frame's fence has passed, so its commands are free.
        unsafe { gpu.device.begin_command_buffer(commands, &info) }.could_not("record")?;
        slot.timers.reset(commands);
        slot.counters.reset(commands);
        slot.timers.write_timestamp(commands, Timestamp::Begin);
        let writer = self.writer.as_mut();
        record_uploads(&mut self.textures, commands, &slot.staging, writer, self.slot_index);
        self.overlay.record_atlas_copies(commands);
        self.panel_pictures.record_upload(&gpu.device, commands, self.slot_index);
        slot.timers.write_timestamp(commands, Timestamp::Uploaded);
        record(self, commands);
        self.ring[self.slot_index].timers.write_timestamp(commands, Timestamp::End);
        // SAFETY: the commands are being recorded.
        unsafe { gpu.device.end_command_buffer(commands) }.could_not("record")?;
        let buffers = [commands];
        let (waits, signals) = (semaphores.wait.as_slice(), semaphores.signal.as_slice());
        let stages = [vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT];
        let info = vk::SubmitInfo::default()
            .command_buffers(&buffers)
            .wait_semaphores(waits)
            .wait_dst_stage_mask(&stages[..waits.len()])
            .signal_semaphores(signals);
        // SAFETY: the fence has passed, and the queue is used by one thread.
        unsafe {
            gpu.device.reset_fences(&[fence]).could_not("reset a fence")?;
            gpu.device.queue_submit(gpu.queue, &[info], fence).could_not("submit a frame")?;
        }
        self.ring[self.slot_index].is_submitted = true;
        self.slot_index = (self.slot_index + 1) % RING;
        Ok(())
    }
}

impl Drop for Renderer {
    fn drop(&mut self) {
        // A lost device has no work under way.
        let _ = self.gpu.wait_idle();
    }
}
