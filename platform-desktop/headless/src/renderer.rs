//! Offscreen rendering with Vulkan: a device without a window, and renderers that each hold one
//! sculpture and an image to draw into.

use std::sync::Arc;

use glam::{Quat, Vec3};
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{
    Eye, Fov, FrameRequest, FrameSemaphores, FrameTimes, Gpu, OffscreenTarget, Options, Renderer,
    SculptureOrder, SculpturePlacement,
};
use paros_shaders::upload::{Region, VolumeFormat};
use paros_shaders::{Camera, Image};

use crate::Error;

/// The colour of the middle of the twin's backdrop as a display shows it, used as the background. The studio
/// itself is not drawn.
pub const BACKDROP: [f32; 3] = [0.1480, 0.1465, 0.1442];

/// Regions of a sculpture's texture and their bytes, to be uploaded with the next picture.
pub type Uploads = Vec<(Region, Vec<u8>)>;

/// Opens the best Vulkan device, or the best one whose name contains `name_part`.
///
/// # Errors
/// Returns an error if there is no such device, or it fails to start.
pub fn open_gpu(name_part: Option<&str>) -> Result<Arc<Gpu>, Error> {
    let options = Options { device_name: name_part.map(String::from), ..Options::default() };
    Ok(Gpu::headless(&options)?)
}

/// The format of a renderer's pictures.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PictureFormat {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Eyes, 1 or 2, drawn at once.
    pub eyes: u32,
    /// Samples per pixel, 1 or 4.
    pub samples: u32,
}

/// A renderer of one sculpture with an offscreen image to draw into.
#[derive(Debug)]
pub struct HeadlessRenderer {
    // Dropped before the renderer that it was made with.
    screen: OffscreenTarget,
    renderer: Renderer,
}

impl HeadlessRenderer {
    /// Creates a renderer for volumes of the format `volume`. `pipeline_cache` is another renderer's
    /// [`HeadlessRenderer::pipeline_cache`], or empty.
    ///
    /// # Errors
    /// Returns an error if the picture is larger than the device can draw, or if a Vulkan call failed, most
    /// likely because memory ran out.
    pub fn new(
        gpu: &Arc<Gpu>,
        volume: VolumeFormat,
        picture_format: PictureFormat,
        pipeline_cache: &[u8],
    ) -> Result<Self, Error> {
        let ([width, height], longest) = (picture_format.size, gpu.max_image_side());
        if width.max(height) > longest {
            let name = &gpu.name;
            return Err(Error::Failure(format!(
                "{name}: draws at most {longest} pixels along a side, not {width}x{height}"
            )));
        }
        let target_format =
            OffscreenTarget::readback_format(picture_format.samples, picture_format.eyes, false);
        let mut renderer = Renderer::new(gpu, target_format, volume, pipeline_cache)?;
        renderer.set_timing_of_sculpture(true);
        let screen = OffscreenTarget::new(gpu, &renderer, picture_format.size)?;
        Ok(HeadlessRenderer { screen, renderer })
    }

    /// Returns the pipeline cache, with which the next renderer of this device starts sooner.
    ///
    /// # Errors
    /// Returns an error if the device is lost.
    pub fn pipeline_cache(&self) -> Result<Vec<u8>, Error> {
        Ok(self.renderer.pipeline_cache_data()?)
    }

    /// Loads a whole sculpture. It must have the format that the renderer was created for.
    ///
    /// # Errors
    /// Returns an error if the device is lost.
    pub fn load_field<const N: usize, const K: usize>(
        &mut self,
        field: &DensityField<N, K>,
    ) -> Result<(), Error> {
        let mut loaded = Ok(());
        field.emit_all_regions(|region, bytes| {
            if loaded.is_ok() {
                loaded = self.renderer.submit_upload_between_frames(region, bytes);
            }
        });
        Ok(loaded?)
    }

    /// Uploads a region of the sculpture's texture.
    ///
    /// # Errors
    /// Returns an error if the device is lost.
    pub fn upload_region(&mut self, region: Region, bytes: &[u8]) -> Result<(), Error> {
        Ok(self.renderer.submit_upload_between_frames(region, bytes)?)
    }

    /// Queues a picture for a cell of the panels' picture atlas; each of the next frames uploads one queued
    /// picture. Returns `false` if there is no such cell or the picture hasn't the size of a cell.
    pub fn set_panel_picture(&mut self, cell: u8, picture: &Image) -> bool {
        self.renderer.set_panel_picture(cell, picture)
    }

    /// Sets the draw order of all later pictures.
    pub const fn set_draw_order(&mut self, order: SculptureOrder) {
        self.renderer.set_sculpture_order(order);
    }

    /// Applies `uploads`, draws a frame, and waits for it. Returns the GPU times of its parts.
    ///
    /// # Errors
    /// Returns an error if there are more uploads than a frame can hold, or if the device is lost.
    pub fn draw_frame(
        &mut self,
        request: &FrameRequest<'_>,
        uploads: &Uploads,
    ) -> Result<FrameTimes, Error> {
        self.renderer.wait_and_begin_frame()?;
        for (region, bytes) in uploads {
            if !self.renderer.try_stage_upload(*region, bytes) {
                return Err(Error::Failure("a frame's uploads are more than it takes".into()));
            }
        }
        self.renderer.draw_frame(request, &self.screen.target, 0, FrameSemaphores::default())?;
        Ok(self.renderer.wait_for_frames()?)
    }

    /// Reads back one eye's image of the latest picture.
    ///
    /// # Errors
    /// Returns an error if the device is lost.
    pub fn read_image(&self, eye: u32) -> Result<Image, Error> {
        let [width, height] = self.screen.target.extent.map(|side| side as usize);
        let pixels = self.screen.read_pixels(eye)?;
        let pixels = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        Ok(Image { width, height, pixels })
    }
}

/// An eye and the sculpture that it looks at.
#[derive(Clone, Copy, Debug)]
pub struct SculptureView {
    /// The eye.
    pub eye: Eye,
    /// The position, size and rotation of the sculpture.
    pub placement: SculpturePlacement,
}

impl SculptureView {
    /// Returns the same view of a sculpture that stands in the room, scaled to its size there.
    #[must_use]
    pub fn moved_onto(&self, stand: &SculpturePlacement) -> Self {
        let position = stand.foot + self.eye.position * (stand.side / self.placement.side);
        let turn_radians = self.placement.turn_radians;
        SculptureView {
            eye: Eye { position, ..self.eye },
            placement: SculpturePlacement { turn_radians, ..*stand },
        }
    }
}

/// Returns the view of a camera of the twin. A side of the cube is 1 m, and the stool turns in front of the
/// eye.
#[must_use]
pub fn view_of_camera(camera: &Camera, [width, height]: [u32; 2]) -> SculptureView {
    let (sin, cos) = camera.elevation.sin_cos();
    let up = 0.5 * camera.angle;
    let right = (up.tan() * width as f32 / height as f32).atan();
    let eye = Eye {
        position: Vec3::new(0.0, sin, cos) * camera.distance + Vec3::Y * camera.height,
        rotation: Quat::from_rotation_x(-camera.elevation),
        fov: Fov { left: -right, right, up, down: -up },
    };
    let placement =
        SculpturePlacement { foot: Vec3::ZERO, side: 1.0, turn_radians: -camera.azimuth };
    SculptureView { eye, placement }
}
