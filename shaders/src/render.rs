//! A whole picture: fragments on all cores, averaged, tone-mapped and stored as sRGB.

use core::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use paros_core::maps::Maps;
use rayon::prelude::*;

use crate::camera::Camera;
use crate::field::Field;
use crate::fragment::{Scene, Settings, shade};
use crate::image::Image;
use crate::{noise, studio};

/// How a picture is made.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RenderOptions {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Rays along a side of each pixel; at least 1.
    pub samples: usize,
    /// The parts of the path that are on.
    pub settings: Settings,
    /// The fast path, the smooth surface of the blurred volume, instead of the paper's.
    pub fast: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        let settings = Settings::default();
        RenderOptions { width: 640, height: 480, samples: 2, settings, fast: true }
    }
}

impl RenderOptions {
    /// The paper's path and nothing else.
    #[must_use]
    pub fn paper() -> Self {
        RenderOptions { fast: false, ..Self::default() }
    }
}

/// Renders a sculpture in its studio on all cores. `progress` is called with the part done, 0 to 1,
/// from any of the threads; the picture doesn't depend on their number.
#[must_use]
pub fn render<const N: usize>(
    maps: &Maps<N>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Image {
    // The camera stands still, so that the stool turns against the azimuth.
    let field = options.fast.then(|| {
        let mut field = Field::new();
        field.rebuild(maps);
        field
    });
    let scene =
        Scene { field: field.as_ref(), ..Scene::new(maps, -camera.azimuth, options.settings) };
    let mut image = Image::filled(options.width, options.height, [0; 3]);
    let done = AtomicUsize::new(0);
    let row_bytes = 3 * options.width.max(1);
    image.pixels.par_chunks_mut(row_bytes).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            pixel.copy_from_slice(&srgb(pixel_color(&scene, camera, options, [x, y])));
        }
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(done as f32 / options.height as f32);
    });
    image
}

/// The bytes of a PNG file with a sculpture's picture, 720 pixels a side.
///
/// # Errors
/// What keeps a picture from being encoded.
pub fn portrait<const N: usize>(maps: &Maps<N>) -> Result<Vec<u8>, String> {
    let options = RenderOptions { width: 720, height: 720, ..RenderOptions::default() };
    let image = render(maps, &Camera::ring(0.4, 0.25), &options, &|_| {});
    let mut png = Vec::new();
    image.write_png(&mut png).map_err(|error| error.to_string())?;
    Ok(png)
}

/// The mean tone-mapped colour of a pixel's rays.
fn pixel_color<const N: usize>(
    scene: &Scene<'_, N>,
    camera: &Camera,
    options: &RenderOptions,
    [x, y]: [usize; 2],
) -> Vec3 {
    let samples = options.samples.max(1);
    let side = samples as f32;
    let (width, height) = (options.width as f32, options.height as f32);
    let turn = noise::hash(x as u32 | (y as u32) << 16) as f32 / 4_294_967_296.0;
    let mut sum = Vec3::ZERO;
    for i in 0..samples * samples {
        let px = x as f32 + ((i % samples) as f32 + 0.5) / side;
        let py = y as f32 + ((i / samples) as f32 + 0.5) / side;
        let ray = camera.ray((2.0 * px - width) / height, 1.0 - 2.0 * py / height);
        let dither = (turn + i as f32 / (side * side)).fract();
        let color = match shade(scene, &ray, dither) {
            Some(hit) => hit.color,
            None => studio::background(scene, &ray, dither),
        };
        sum += tone_mapped(color);
    }
    sum / (side * side)
}

/// What a display shows of a radiance: the tone curve, then sRGB bytes.
#[must_use]
pub fn shown(color: Vec3) -> [u8; 3] {
    srgb(tone_mapped(color))
}

/// Radiance to display intensity: Reinhard's curve, in which WHITE comes out as 1.
fn tone_mapped(color: Vec3) -> Vec3 {
    const WHITE: f32 = 2.0;
    const EXPOSURE: f32 = 1.0;
    let c = color * EXPOSURE;
    c * (Vec3::ONE + c / (WHITE * WHITE)) / (Vec3::ONE + c)
}

/// Linear intensity to sRGB bytes (IEC 61966-2-1).
fn srgb(color: Vec3) -> [u8; 3] {
    color.to_array().map(|c| {
        let c = c.clamp(0.0, 1.0);
        let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0 + 0.5) as u8
    })
}
