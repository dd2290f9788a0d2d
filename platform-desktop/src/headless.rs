//! Pictures by Vulkan without a window: a device, and easels that hold a sculpture each.

use std::sync::Arc;

use glam::{Quat, Vec3};
use paros_shaders::field::Field;
use paros_shaders::gpu::{
    Eye, Fov, Gpu, Offscreen, Options, Order, Picture, Renderer, Stand, Sync, Times,
};
use paros_shaders::upload::Region;
use paros_shaders::{Camera, Image};

use crate::error::Error;

/// The light that falls on the middle of the twin's backdrop, as a display shows it. The studio
/// itself is not drawn.
pub const BACKDROP: [f32; 3] = [0.1515, 0.1499, 0.1474];

/// Regions and their bytes, on their way to an easel.
pub type Uploads = Vec<(Region, Vec<u8>)>;

/// Opens the best Vulkan device, or the best of those with `name` in theirs.
///
/// # Errors
/// There is none, or it won't start.
pub fn open(name: Option<&str>) -> Result<Arc<Gpu>, Error> {
    let options = Options { device: name.map(String::from), ..Options::default() };
    Ok(Gpu::headless(&options)?)
}

/// What an easel's pictures are like.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Canvas {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Eyes, 1 or 2, drawn at once.
    pub eyes: u32,
    /// Samples of a pixel, 1 or 4.
    pub samples: u32,
}

/// A renderer with an image of its own to draw into.
#[derive(Debug)]
pub struct Easel {
    // Goes before the renderer that it was made with.
    screen: Offscreen,
    renderer: Renderer,
}

impl Easel {
    /// An easel for sculptures of `n` voxels a side. `cache` is another one's [`Easel::cache`], or
    /// nothing.
    ///
    /// # Errors
    /// A picture larger than the device draws, or a call that failed: out of memory, most likely.
    pub fn new(gpu: &Arc<Gpu>, n: usize, canvas: Canvas, cache: &[u8]) -> Result<Self, Error> {
        let ([width, height], longest) = (canvas.size, gpu.longest_side());
        if width.max(height) > longest {
            let name = &gpu.name;
            return Err(Error::Failure(format!(
                "{name}: draws at most {longest} pixels along a side, not {width}x{height}"
            )));
        }
        let format = Offscreen::format(canvas.samples, canvas.eyes, false);
        let renderer = Renderer::new(gpu, format, n, cache)?;
        let screen = Offscreen::new(gpu, &renderer, canvas.size)?;
        Ok(Easel { screen, renderer })
    }

    /// What makes the next easel of this device sooner ready.
    ///
    /// # Errors
    /// A lost device.
    pub fn cache(&self) -> Result<Vec<u8>, Error> {
        Ok(self.renderer.cache()?)
    }

    /// Takes a sculpture instead of the one it had, of the size it was made for.
    ///
    /// # Errors
    /// A lost device.
    pub fn load<const N: usize>(&mut self, field: &Field<N>) -> Result<(), Error> {
        let mut loaded = Ok(());
        field.whole(|region, bytes| {
            if loaded.is_ok() {
                loaded = self.renderer.load(region, bytes);
            }
        });
        Ok(loaded?)
    }

    /// Takes a region of a sculpture's texture.
    ///
    /// # Errors
    /// A lost device.
    pub fn upload(&mut self, region: Region, bytes: &[u8]) -> Result<(), Error> {
        Ok(self.renderer.load(region, bytes)?)
    }

    /// Draws in another order from now on.
    pub const fn draw_in(&mut self, order: Order) {
        self.renderer.draw_in(order);
    }

    /// Draws a picture of the sculpture after `uploads` were made, and waits for it; how long the
    /// device took for its parts.
    ///
    /// # Errors
    /// More uploads than a frame takes, or a lost device.
    pub fn draw(&mut self, picture: &Picture<'_>, uploads: &Uploads) -> Result<Times, Error> {
        self.renderer.begin()?;
        for (region, bytes) in uploads {
            if !self.renderer.upload(*region, bytes) {
                return Err(Error::Failure("a frame's uploads are more than it takes".into()));
            }
        }
        self.renderer.draw(picture, &self.screen.surface, 0, Sync::default())?;
        Ok(self.renderer.finish()?)
    }

    /// What an eye sees of the latest picture.
    ///
    /// # Errors
    /// A lost device.
    pub fn image(&self, eye: u32) -> Result<Image, Error> {
        let [width, height] = self.screen.surface.extent.map(|side| side as usize);
        let pixels = self.screen.pixels(eye)?;
        let pixels = pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        Ok(Image { width, height, pixels })
    }
}

/// The eye and the stand that see what a camera of the twin does: a side of the cube is a metre, and
/// the stool turns before the eye.
#[must_use]
pub fn seen_by(camera: &Camera, [width, height]: [u32; 2]) -> (Eye, Stand) {
    let (sin, cos) = camera.elevation.sin_cos();
    let up = 0.5 * camera.angle;
    let right = (up.tan() * width as f32 / height as f32).atan();
    let eye = Eye {
        position: Vec3::new(0.0, sin, cos) * camera.distance + Vec3::Y * camera.height,
        rotation: Quat::from_rotation_x(-camera.elevation),
        fov: Fov { left: -right, right, up, down: -up },
    };
    (eye, Stand { foot: Vec3::ZERO, side: 1.0, turn: -camera.azimuth })
}
