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

/// The light that falls on the middle of the twin's backdrop, as a display shows it. The studio
/// itself is not drawn.
pub const BACKDROP: [f32; 3] = [0.1480, 0.1465, 0.1442];

/// Regions of a sculpture's texture and their bytes, to be uploaded with the next picture.
pub type Uploads = Vec<(Region, Vec<u8>)>;

/// Opens the best Vulkan device, or the best of those whose names contain `name_part`.
///
/// # Errors
/// There is none, or it won't start.
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
    /// A renderer for volumes of that format. `pipeline_cache` is another renderer's
    /// [`HeadlessRenderer::pipeline_cache`], or empty.
    ///
    /// # Errors
    /// A picture larger than the device draws, or a call that failed: out of memory, most likely.
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

    /// The pipeline cache, which makes the next renderer of this device start sooner.
    ///
    /// # Errors
    /// A lost device.
    pub fn pipeline_cache(&self) -> Result<Vec<u8>, Error> {
        Ok(self.renderer.pipeline_cache_data()?)
    }

    /// Loads a whole sculpture, of the format that the renderer was made for.
    ///
    /// # Errors
    /// A lost device.
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
    /// A lost device.
    pub fn upload_region(&mut self, region: Region, bytes: &[u8]) -> Result<(), Error> {
        Ok(self.renderer.submit_upload_between_frames(region, bytes)?)
    }

    /// Puts a picture into a cell of the panels', once one of the next frames has uploaded it: each uploads one. False if
    /// there is no such cell or the picture isn't as large as one.
    pub fn set_panel_picture(&mut self, cell: u8, picture: &Image) -> bool {
        self.renderer.set_panel_picture(cell, picture)
    }

    /// Sets the draw order of all later pictures.
    pub const fn set_draw_order(&mut self, order: SculptureOrder) {
        self.renderer.set_sculpture_order(order);
    }

    /// Draws a frame after `uploads`, and waits for it. Returns the device's times for its parts.
    ///
    /// # Errors
    /// More uploads than a frame takes, or a lost device.
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

    /// Reads one eye's image of the latest picture back.
    ///
    /// # Errors
    /// A lost device.
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
    /// Where the sculpture stands.
    pub placement: SculpturePlacement,
}

impl SculptureView {
    /// The same view of a sculpture where it stands in the room, with its size there.
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

/// The view that shows what a camera of the twin does: a side of the cube is a metre, and the stool
/// turns before the eye.
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
