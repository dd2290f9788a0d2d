//! The window's renderer: frames of the world, with the panels over them.

use glam::Vec3;
use paros_core::World;
use paros_core::limits::INTERVALS;
use paros_core::session::TICK_RATE;
use paros_core::volume::{Grid, Size};
use paros_shaders::Image;
use paros_shaders::gpu::{Error, Eye, FrameTimes, Options, RenderPath, Viewpoint, WorldRenderer};
use paros_shaders::panel::Panel;
use paros_shaders::scene::LatestInput;
use paros_shell::durable;
use paros_shell::file_writer::{FileKind, FileWriter};
use paros_shell::studio_paths::StudioPaths;
use winit::window::Window;

use super::paint::EguiBuffers;
use super::picture_scale::PictureScale;
use super::screen::WindowSwapchain;

/// Samples for each pixel.
const SAMPLES: u32 = 4;

/// A window's renderer and its swapchain.
pub(super) struct WindowRenderer<const N: usize>
where
    Grid<N>: Size,
{
    // Declared before the swapchain so that it drops first.
    show: WorldRenderer<N, INTERVALS>,
    screen: WindowSwapchain,
    scale: PictureScale,
}

/// The parameters of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrameParams<'a> {
    /// The eye.
    pub(super) eye: Eye,
    /// Fraction of the time from the last tick to the next, 0 to 1.
    pub(super) between: f32,
    /// The render path.
    pub(super) path: RenderPath,
    /// Displacement by which the trigger would move the right hand's bit, in metres.
    pub(super) next_bite: Option<Vec3>,
    /// Panels in the room.
    pub(super) panels: &'a [Panel],
}

impl<const N: usize> WindowRenderer<N>
where
    Grid<N>: Size,
{
    /// Creates the device, the swapchain and the renderer of a world.
    ///
    /// # Errors
    /// No Vulkan, no suitable device, or a failed call.
    pub(super) fn new(
        window: &Window,
        world: &World<N, INTERVALS>,
        paths: &StudioPaths,
        options: &Options,
    ) -> Result<Self, Error> {
        let screen = WindowSwapchain::new(window, options)?;
        // Without the pipeline cache the start takes longer, but succeeds.
        let cache = durable::read_regular_file(&paths.pipeline_cache_file()).unwrap_or_default();
        let show = WorldRenderer::new(screen.gpu(), screen.format(SAMPLES), world, &cache)?;
        let scale = PictureScale::new(screen.gpu().is_software());
        Ok(WindowRenderer { show, screen, scale })
    }

    /// Submits the pipeline cache for writing, so that the next start is faster.
    pub(super) fn submit_pipeline_cache(&self, paths: &StudioPaths, file_writer: &mut FileWriter) {
        if let Ok(bytes) = self.show.renderer.pipeline_cache_data() {
            file_writer.submit_file_or_wait(
                FileKind::PipelineCache,
                paths.pipeline_cache_file(),
                bytes,
            );
        }
    }

    /// Notes what a tick changed, for the next frame.
    pub(super) fn note_tick(&mut self, world: &World<N, INTERVALS>) {
        self.show.note_tick(world);
    }

    /// Notes that a save was loaded into the world.
    pub(super) fn note_load(&mut self, world: &World<N, INTERVALS>) {
        self.show.note_load(world);
    }

    /// Sets the picture of a panel cell. Returns `true` if it fits.
    pub(super) fn set_panel_picture(&mut self, cell: u8, picture: &Image) -> bool {
        self.show.renderer.set_panel_picture(cell, picture)
    }

    /// Notes that the window's size has changed.
    pub(super) fn mark_resized(&mut self) {
        self.screen.mark_stale();
    }

    /// Returns the device's name.
    #[must_use]
    pub(super) fn device_name(&self) -> &str {
        &self.screen.gpu().name
    }

    /// Returns the GPU times of the latest finished frame, in nanoseconds.
    #[must_use]
    pub(super) const fn gpu_times(&self) -> FrameTimes {
        self.show.renderer.gpu_frame_times()
    }

    /// Returns the validation layer's messages.
    #[must_use]
    pub(super) fn validation_messages(&self) -> Vec<String> {
        self.screen.gpu().instance.validation_messages()
    }

    /// Draws and presents a frame in a window of `window_size` pixels. Returns `true` if there was an image
    /// to draw into.
    ///
    /// # Errors
    /// A lost device or window.
    pub(super) fn try_draw_frame(
        &mut self,
        window: &Window,
        window_size: [u32; 2],
        world: &World<N, INTERVALS>,
        params: &FrameParams<'_>,
        egui_buffers: &mut EguiBuffers,
    ) -> Result<bool, Error> {
        if window_size.contains(&0) {
            return Ok(false);
        }
        self.show.wait_and_begin_frame(world)?;
        let renderer = &mut self.show.renderer;
        let Some(target) = self.screen.acquire_image(renderer, window_size)? else {
            return Ok(false);
        };
        self.screen.set_drawn_percent(self.scale.after_frame(renderer.gpu_frame_times().total_ns));
        let Some(render_target) = self.screen.render_target() else { return Ok(false) };
        egui_buffers.upload_into_begun_frame(&mut renderer.overlay, render_target.extent);
        let time = (world.tick() as f64 + f64::from(params.between)) / f64::from(TICK_RATE);
        // Hands are not drawn, as the mouse has none.
        let fresh = LatestInput {
            grips: [None; 2],
            show_hands: false,
            tick_fraction: params.between,
            time_seconds: time,
            next_bites: [None, params.next_bite],
            // The panels draw the mirror.
            show_mirror: false,
            // The cursor takes the item that it points at, independent of the hand's position.
            light_targets: false,
        };
        let seen = Viewpoint {
            eyes: &[params.eye],
            latest: fresh,
            render_path: params.path,
            panels: &[params.panels],
        };
        self.show.draw_frame(world, &seen, render_target, target.image, target.sync)?;
        // On Wayland this throttles redraw requests to the compositor's frame callbacks.
        window.pre_present_notify();
        self.screen.present(target)?;
        Ok(true)
    }
}
