//! Renders a whole picture: supersampled fragments on all cores, tone mapped, encoded as sRGB.

use core::sync::atomic::{AtomicUsize, Ordering};

use glam::Vec3;
use paros_core::RangeMaps;
use rayon::prelude::*;

use super::camera::Camera;
use super::fragment::{TwinScene, TwinSettings, shade_ray};
use super::image::Image;
use super::march::Ray;
use super::panels::{PixelRay, blend_panels};
use super::room::{LitRoom, TwinLight};
use super::{noise, studio};
use crate::constants::{SRGB_EXPONENT, SRGB_LINEAR_SLOPE, SRGB_OFFSET, TONE_WHITE_POINT};
use crate::field::DensityField;
use crate::gpu::{RenderPath, RenderStyle};
use crate::panel::{Panel, PanelPictures};
use crate::scene::{SKY, resting_placement, resting_studio};

/// Size, sampling and path of a picture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RenderOptions {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Rays along a side of each pixel; at least 1.
    pub samples: usize,
    /// The parts of the path that are on.
    pub settings: TwinSettings,
    /// `true` for the fast path, the smooth surface of the blurred volume; `false` for the paper's.
    pub fast: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        let settings = TwinSettings::default();
        RenderOptions { width: 640, height: 480, samples: 2, settings, fast: true }
    }
}

impl RenderOptions {
    /// Returns the defaults with the paper's path.
    #[must_use]
    pub fn paper_path() -> Self {
        RenderOptions { fast: false, ..Self::default() }
    }
}

/// Renders a sculpture in its studio on all cores. `progress` is called with the fraction done, 0
/// to 1, from any of the threads; the picture doesn't depend on their number.
#[must_use]
pub fn render_image<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &(dyn Fn(f32) + Sync),
) -> Image {
    render_scene(maps, camera, options, &Surroundings { room: None, panels: &[] }, progress)
}

/// Renders a sculpture in the lit room, as [`render_image`] does in its studio.
#[must_use]
pub fn render_image_in_room<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    camera: &Camera,
    options: &RenderOptions,
    room: &LitRoom,
    progress: &(dyn Fn(f32) + Sync),
) -> Image {
    render_image_with_panels(maps, camera, options, room, &[], progress)
}

/// Renders a sculpture in the lit room, as [`render_image_in_room`] does, with panels in it.
#[must_use]
pub fn render_image_with_panels<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    camera: &Camera,
    options: &RenderOptions,
    room: &LitRoom,
    panels: &[Panel],
    progress: &(dyn Fn(f32) + Sync),
) -> Image {
    render_scene(maps, camera, options, &Surroundings { room: Some(room), panels }, progress)
}

/// The surroundings of the sculpture in a picture: the room, or else the studio; and panels in the room.
struct Surroundings<'a> {
    room: Option<&'a LitRoom>,
    panels: &'a [Panel],
}

/// Returns the studio at rest, in its light.
#[must_use]
pub fn lit_studio() -> LitRoom {
    let RenderStyle { sun_direction, sun_color, ambient, .. } =
        RenderStyle::in_studio(RenderPath::Fast);
    let light = TwinLight { sun_direction, sun_color, ambient };
    LitRoom::new(&resting_studio(), resting_placement(), light)
}

fn render_scene<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    camera: &Camera,
    options: &RenderOptions,
    &Surroundings { room, panels }: &Surroundings<'_>,
    progress: &(dyn Fn(f32) + Sync),
) -> Image {
    // The camera stands still; the stool turns instead, against the azimuth.
    let field = options.fast.then(|| {
        let mut field = DensityField::new();
        field.rebuild_from(maps);
        field
    });
    let plain = TwinScene::new(maps, -camera.azimuth, options.settings);
    let light = room.map_or(plain.light, |room| room.light);
    let scene = TwinScene { field: field.as_ref(), light, room, ..plain };
    let mut image = Image::filled(options.width, options.height, [0; 3]);
    let done = AtomicUsize::new(0);
    let row_bytes = 3 * options.width.max(1);
    image.pixels.par_chunks_mut(row_bytes).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            pixel.copy_from_slice(&encode_srgb(tone_mapped_pixel(
                &scene,
                camera,
                options,
                panels,
                [x, y],
            )));
        }
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(done as f32 / options.height as f32);
    });
    image
}

/// Pixels across and down of a finished sculpture's picture.
pub const PORTRAIT_SIZE: [usize; 2] = [720; 2];

/// Returns the camera of a finished sculpture's picture.
#[must_use]
pub fn portrait_camera() -> Camera {
    Camera::orbiting(0.4, 0.25)
}

/// Renders a sculpture's picture in the lit room, of [`PORTRAIT_SIZE`], as the bytes of a PNG file.
///
/// # Errors
/// The PNG encoder's error, as text.
pub fn render_portrait_png<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
) -> Result<Vec<u8>, String> {
    let [width, height] = PORTRAIT_SIZE;
    let options = RenderOptions { width, height, ..RenderOptions::default() };
    let image = render_image_in_room(maps, &portrait_camera(), &options, &lit_studio(), &|_| {});
    let mut png = Vec::new();
    image.write_png(&mut png).map_err(|error| error.to_string())?;
    Ok(png)
}

/// Supersampling: returns the mean tone-mapped colour of a pixel's rays.
fn tone_mapped_pixel<const N: usize, const K: usize>(
    scene: &TwinScene<'_, N, K>,
    camera: &Camera,
    options: &RenderOptions,
    panels: &[Panel],
    [x, y]: [usize; 2],
) -> Vec3 {
    let samples = options.samples.max(1);
    let side = samples as f32;
    let (width, height) = (options.width as f32, options.height as f32);
    let turn = noise::hash_u32(x as u32 | (y as u32) << 16) as f32 / 4_294_967_296.0;
    let mut sum = Vec3::ZERO;
    for i in 0..samples * samples {
        let px = x as f32 + ((i % samples) as f32 + 0.5) / side;
        let py = y as f32 + ((i / samples) as f32 + 0.5) / side;
        let through = |px: f32, py: f32| {
            camera.ray_through((2.0 * px - width) / height, 1.0 - 2.0 * py / height)
        };
        let ray = through(px, py);
        let dither = (turn + i as f32 / (side * side)).fract();
        let RayColor { radiance, depth } = trace_ray(scene, &ray, dither);
        let mut color = tone_map(radiance);
        if let (Some(room), false) = (scene.room, panels.is_empty()) {
            let next = [through(px + 1.0 / side, py), through(px, py + 1.0 / side)];
            let ray = PixelRay {
                origin: room.stand.foot + ray.origin * room.stand.side,
                direction: ray.direction,
                to_next: next.map(|next| next.direction - ray.direction),
            };
            color =
                blend_panels(panels, &PanelPictures::EMPTY, &ray, depth * room.stand.side, color);
        }
        sum += color;
    }
    sum / (side * side)
}

/// The result of a ray: its radiance, and the distance of what it met, in sides of the cube.
struct RayColor {
    radiance: Vec3,
    depth: f32,
}

/// Returns the radiance along a ray: that of the sculpture, or of its surroundings.
fn trace_ray<const N: usize, const K: usize>(
    scene: &TwinScene<'_, N, K>,
    ray: &Ray,
    dither: f32,
) -> RayColor {
    let far = |radiance| RayColor { radiance, depth: f32::INFINITY };
    let stone =
        shade_ray(scene, ray, dither).map(|hit| RayColor { radiance: hit.color, depth: hit.depth });
    let studio = || far(studio::shade_background(scene, ray, dither));
    let Some(room) = scene.room else {
        return stone.unwrap_or_else(studio);
    };
    match (stone, room.cast_ray(ray)) {
        (Some(stone), Some(wall)) if stone.depth <= wall.depth => stone,
        (_, Some(wall)) => RayColor { radiance: room.shade(scene, &wall), depth: wall.depth },
        (Some(stone), None) => stone,
        (None, None) if room.is_in_studio => studio(),
        (None, None) => far(Vec3::from_array(SKY)),
    }
}

/// Converts radiance to sRGB bytes, through the tone curve.
#[must_use]
pub fn tone_map_to_srgb(radiance: Vec3) -> [u8; 3] {
    encode_srgb(tone_map(radiance))
}

/// Reinhard's tone curve: maps radiance to display intensity, and `TONE_WHITE_POINT` to 1.
pub(crate) fn tone_map(radiance: Vec3) -> Vec3 {
    radiance * (Vec3::ONE + radiance / (TONE_WHITE_POINT * TONE_WHITE_POINT))
        / (Vec3::ONE + radiance)
}

/// Converts linear intensity to sRGB bytes (IEC 61966-2-1).
pub(crate) fn encode_srgb(intensity: Vec3) -> [u8; 3] {
    intensity.to_array().map(|c| {
        let c = c.clamp(0.0, 1.0);
        let encoded = if c <= 0.003_130_8 {
            SRGB_LINEAR_SLOPE * c
        } else {
            (1.0 + SRGB_OFFSET) * c.powf(1.0 / SRGB_EXPONENT) - SRGB_OFFSET
        };
        (encoded * 255.0 + 0.5) as u8
    })
}
