//! Renders a world: its volume's textures and its scene, updated each tick, drawn each frame.

use std::sync::Arc;

use glam::Vec3;
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};

use super::compiled::CompiledRenderer;
use super::renderer::{FrameSemaphores, Renderer};
use super::request::{Eye, FrameRequest, RenderStyle};
use crate::field::{Budget, DensityField, FigureShares};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::gpu::device::format::TargetFormat;
use crate::gpu::passes::target::RenderTarget;
use crate::gpu::pipelines::paths::RenderPath;
use crate::panel::Panel;
use crate::scene::{LatestInput, SKY, SceneAssembler};
use crate::twin::render::tone_map;
use crate::upload::VolumeFormat;

/// A renderer with the textures and the scene of a world, of one interval a column or two.
#[derive(Debug)]
pub struct WorldRenderer<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The renderer, with its overlay.
    pub renderer: Renderer,
    field: Box<DensityField<N, K>>,
    figure: FigureShares,
    /// `true` if the volume was replaced: all textures are rebuilt before the next frame.
    anew: bool,
    /// Ticks that no frame has shown yet.
    ticks: u32,
    scene: Box<SceneAssembler>,
}

/// The viewpoint from which a frame shows the world, and the way in which it does.
#[derive(Clone, Copy, Debug)]
pub struct Viewpoint<'a> {
    /// One eye for each view of the format.
    pub eyes: &'a [Eye],
    /// Input that is newer than the last tick.
    pub latest: LatestInput,
    /// The sculpture's render path.
    pub render_path: RenderPath,
    /// Panels in the room.
    pub panels: &'a [&'a [Panel]],
}

impl<const N: usize, const K: usize> WorldRenderer<N, K>
where
    Grid<N>: Size,
{
    /// Creates the renderer and uploads a world's volume. `cache` is the result of
    /// [`Renderer::pipeline_cache_data`] at an earlier start, or empty.
    ///
    /// # Errors
    /// A call that failed; out of memory, most likely.
    pub fn new(
        gpu: &Arc<Gpu>,
        format: TargetFormat,
        world: &World<N, K>,
        cache: &[u8],
    ) -> Result<Self, Error> {
        let volume = VolumeFormat::of::<N, K>();
        Self::from_compiled(CompiledRenderer::compile(gpu, format, volume, cache)?, world)
    }

    /// Makes the renderer from its compiled programs, for volumes of this size, and uploads a world's
    /// volume.
    ///
    /// # Errors
    /// A call that failed; out of memory, most likely.
    pub fn from_compiled(compiled: CompiledRenderer, world: &World<N, K>) -> Result<Self, Error> {
        let renderer = Renderer::from_compiled(compiled)?;
        let mut scene = Box::new(SceneAssembler::new());
        scene.follow_tick(world);
        let (field, figure) = (Box::new(DensityField::new()), FigureShares::new());
        let mut show = WorldRenderer { renderer, field, figure, anew: false, ticks: 0, scene };
        show.upload_volume(world)?;
        Ok(show)
    }

    /// Records a tick's changes; call it after each tick.
    pub fn note_tick(&mut self, world: &World<N, K>) {
        self.ticks = self.ticks.saturating_add(1);
        self.field.note_dirty_columns(world.volume().maps(), world.dirty_rects());
        self.anew |= world.events().iter().any(|event| matches!(event, WorldEvent::Started(_)));
        self.scene.follow_tick(world);
    }

    /// Records that a save was loaded into the world: all textures are rebuilt before the next frame, and
    /// the scene starts afresh.
    pub fn note_load(&mut self, world: &World<N, K>) {
        self.anew = true;
        *self.scene = SceneAssembler::new();
        self.scene.follow_tick(world);
    }

    /// Begins a frame: waits for the fence of the frame before the last. Uploads the whole volume first if
    /// a session has begun or a save was loaded since.
    ///
    /// # Errors
    /// A lost device.
    pub fn wait_and_begin_frame(&mut self, world: &World<N, K>) -> Result<(), Error> {
        if core::mem::take(&mut self.anew) {
            self.upload_volume(world)?;
        }
        self.renderer.wait_and_begin_frame()
    }

    /// Draws the current frame into an image of a render target.
    ///
    /// # Errors
    /// A lost device.
    pub fn draw_frame(
        &mut self,
        world: &World<N, K>,
        viewpoint: &Viewpoint<'_>,
        target: &RenderTarget,
        image_index: usize,
        semaphores: FrameSemaphores,
    ) -> Result<(), Error> {
        let renderer = &mut self.renderer;
        let budget = Budget::of_frame_after(N, core::mem::take(&mut self.ticks));
        self.field.update_textures(budget, &mut |region, bytes| {
            let fits = renderer.try_stage_upload(region, bytes);
            debug_assert!(fits, "a frame's budget is within what it can upload");
        });
        self.scene.assemble_frame(world, &viewpoint.latest);
        let request = FrameRequest {
            eyes: viewpoint.eyes,
            placement: self.scene.sculpture_placement(),
            style: RenderStyle::in_studio(viewpoint.render_path)
                .lighting_a_find(self.scene.found_part()),
            backdrop: tone_map(Vec3::from_array(SKY)).to_array(),
            scene: Some(self.scene.draw_list()),
            panels: viewpoint.panels,
        };
        self.renderer.draw_frame(&request, target, image_index, semaphores)
    }

    /// Rebuilds and uploads all textures of a world's volume, and of its hidden figure.
    fn upload_volume(&mut self, world: &World<N, K>) -> Result<(), Error> {
        self.field.rebuild_from(world.volume().maps());
        let mut loaded = Ok(());
        self.field.emit_all_regions(|region, bytes| {
            if loaded.is_ok() {
                loaded = self.renderer.submit_upload_between_frames(region, bytes);
            }
        });
        loaded?;
        let had_none = self.figure.is_empty();
        self.figure.rebuild_from(world.mask());
        if had_none && self.figure.is_empty() {
            return Ok(());
        }
        self.renderer.submit_figure_between_frames(&self.figure)
    }
}
