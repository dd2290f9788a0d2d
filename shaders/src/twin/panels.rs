//! Panels in the CPU's pictures: rays through their planes, their quads blended one over the other.
//!
//! The twin of `wgsl/panel.wgsl`. A pixel's width on a panel comes from the rays of its neighbours, as in
//! the program.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::image::Image;
use super::render::encode_srgb;
use crate::gpu::Eye;
use crate::panel::{Panel, PanelPictures, PanelRect, linear_color};

/// The farthest that a panel's shadow reaches beyond the panel, in millimetres.
const BEYOND: f32 = 100.0;

/// A pixel's ray in the room.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PixelRay {
    /// Origin, in metres.
    pub(crate) origin: Vec3,
    /// Direction, of any length.
    pub(crate) direction: Vec3,
    /// The directions of the pixels to the right and below, less this one's.
    pub(crate) to_next: [Vec3; 2],
}

/// Renders panels alone before a linear colour, as an eye sees them, with `samples` rays along a side of
/// each pixel. Picture cells stay empty.
#[must_use]
pub fn render_panels(
    panels: &[Panel],
    eye: &Eye,
    size: [usize; 2],
    samples: usize,
    backdrop: Vec3,
) -> Image {
    render_panels_with_pictures(panels, &PanelPictures::EMPTY, eye, size, samples, backdrop)
}

/// Does the same as [`render_panels`], with pictures in the panels' cells.
#[must_use]
pub fn render_panels_with_pictures(
    panels: &[Panel],
    pictures: &PanelPictures,
    eye: &Eye,
    [width, height]: [usize; 2],
    samples: usize,
    backdrop: Vec3,
) -> Image {
    let tangents = eye.fov_tangents();
    let turned = |x: f32, y: f32| eye.rotation * Vec3::new(x, y, 0.0);
    let side = samples.max(1);
    let columns = (width * side).max(1) as f32;
    let rows = (height * side).max(1) as f32;
    let right = turned((tangents.right - tangents.left) / columns, 0.0);
    let down = turned(0.0, (tangents.down - tangents.up) / rows);
    let corner = eye.rotation * Vec3::new(tangents.left, tangents.up, -1.0);
    let color = |x: usize, y: usize| {
        let direction = corner + right * (x as f32 + 0.5) + down * (y as f32 + 0.5);
        let ray = PixelRay { origin: eye.position, direction, to_next: [right, down] };
        blend_panels(panels, pictures, &ray, f32::INFINITY, backdrop)
    };
    let mut image = Image::filled(width, height, [0; 3]);
    image.pixels.par_chunks_mut(3 * width.max(1)).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.chunks_exact_mut(3).enumerate() {
            let rays = (0..side * side).map(|i| color(x * side + i % side, y * side + i / side));
            let mean = rays.sum::<Vec3>() / (side * side) as f32;
            pixel.copy_from_slice(&encode_srgb(mean));
        }
    });
    image
}

/// Draws a panel straight on, as wide as the picture, over a colour in sRGB: quad by quad, fast enough for
/// a headset's processor to show a panel before the GPU's programs are compiled. Picture cells stay empty.
#[must_use]
pub fn render_panel_flat(panel: &Panel, ground: [u8; 3], [width, height]: [usize; 2]) -> Image {
    let pixel_mm = panel.size_mm()[0] / width.max(1) as f32;
    let [red, green, blue] = ground;
    let ground_color = linear_color([red, green, blue, 255]).rgb;
    let mut colors = vec![ground_color; width * height];
    // The pixels whose middles lie between.
    let pixels = |low: f32, high: f32, count: usize| {
        let first = (low / pixel_mm - 0.5).ceil().max(0.0) as usize;
        first..((high / pixel_mm + 0.5).floor().max(0.0) as usize).min(count)
    };
    for quad in panel.quads() {
        let (middle, half) = (Vec2::from_array(quad.middle), quad.drawn_half());
        let (low, high) = (middle - half, middle + half);
        for y in pixels(low.y, high.y, height) {
            for x in pixels(low.x, high.x, width) {
                let at = (Vec2::new(x as f32, y as f32) + 0.5) * pixel_mm - middle;
                let color = quad.color_at(at, pixel_mm, &PanelPictures::EMPTY);
                let under = &mut colors[y * width + x];
                *under = under.lerp(color.rgb, color.alpha);
            }
        }
    }
    let encode = |color: Vec3| if color == ground_color { ground } else { encode_srgb(color) };
    Image { width, height, pixels: colors.into_iter().flat_map(encode).collect() }
}

/// Returns the linear colour along a ray: the panels over `under`, which is `depth_limit` metres away.
pub(crate) fn blend_panels(
    panels: &[Panel],
    pictures: &PanelPictures,
    ray: &PixelRay,
    depth_limit: f32,
    under: Vec3,
) -> Vec3 {
    let blend = |under, panel| blend_panel(panel, pictures, ray, depth_limit, under);
    panels.iter().fold(under, blend)
}

fn blend_panel(
    panel: &Panel,
    pictures: &PanelPictures,
    ray: &PixelRay,
    depth_limit: f32,
    under: Vec3,
) -> Vec3 {
    let meet = |direction| panel.pose.intersect_plane(panel.size_mm(), ray.origin, direction);
    let Some(hit) = meet(ray.direction) else { return under };
    let near = PanelRect::grown(&panel.rect(), BEYOND);
    if hit.distance > depth_limit || !near.contains(hit.at_mm) {
        return under;
    }
    let [right, down] = ray
        .to_next
        .map(|step| meet(ray.direction + step).map_or(Vec2::ZERO, |next| next.at_mm - hit.at_mm));
    let pixel_mm = (0.5 * (right.length_squared() + down.length_squared())).sqrt();
    panel.quads().iter().fold(under, |under, quad| {
        let at = hit.at_mm - Vec2::from_array(quad.middle);
        if at.abs().cmpgt(quad.drawn_half()).any() {
            return under;
        }
        let color = quad.color_at(at, pixel_mm.max(1e-6), pictures);
        under.lerp(color.rgb, color.alpha)
    })
}
