//! The app's icon: the owl of the hidden figures, seen from the front, on a disc of dusk. It is drawn from a
//! range map alone, which gives the depth of the surface for each line of sight.

use paros_core::RangeMaps;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Axis, BitGrid};
use paros_shell::figures::Figure;

use crate::error::PackageError;

/// The icon's side in pixels: the size of a launcher icon at the highest density.
const SIDE: usize = 192;

/// The figure's grid.
const GRID: usize = 128;

/// The number of samples along a pixel's side that are averaged.
const SAMPLES: usize = 3;

/// The sRGB colours of the disc's top and bottom, and of marble in light and in shade.
const DUSK: [[f32; 3]; 2] = [[58.0, 74.0, 104.0], [24.0, 30.0, 46.0]];
const MARBLE: [[f32; 3]; 2] = [[246.0, 240.0, 229.0], [96.0, 88.0, 92.0]];

/// Draws the icon as PNG, with a transparent rim.
///
/// # Errors
/// The icon can't be encoded.
pub(crate) fn draw_png() -> Result<Vec<u8>, PackageError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIDE as u32, SIDE as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(PackageError::failure)?;
    writer.write_image_data(&draw_pixels()).map_err(PackageError::failure)?;
    writer.finish().map_err(PackageError::failure)?;
    Ok(bytes)
}

/// Returns the pixels as RGBA, row by row from the top.
fn draw_pixels() -> Vec<u8> {
    let depths = FrontDepths::of_owl();
    let mut pixels = Vec::with_capacity(SIDE * SIDE * 4);
    for (y, x) in (0..SIDE * SIDE).map(|i| (i / SIDE, i % SIDE)) {
        let (mut sum, mut covered) = ([0.0; 3], 0.0);
        for (j, i) in (0..SAMPLES * SAMPLES).map(|i| (i / SAMPLES, i % SAMPLES)) {
            let place = |at: usize, sample: usize| {
                (at as f32 + (sample as f32 + 0.5) / SAMPLES as f32) / SIDE as f32
            };
            if let Some(colour) = shade(&depths, place(x, i), place(y, j)) {
                sum = core::array::from_fn(|k| sum[k] + colour[k]);
                covered += 1.0;
            }
        }
        let all = (SAMPLES * SAMPLES) as f32;
        // Avoid a division by zero where no sample is covered.
        pixels.extend(sum.map(|part: f32| (part / f32::max(covered, 1.0)).round() as u8));
        pixels.push((255.0 * covered / all).round() as u8);
    }
    pixels
}

/// Returns the colour at a point of the picture, 0 to 1 from its upper left corner; `None` outside the disc.
fn shade(depths: &FrontDepths, x: f32, y: f32) -> Option<[f32; 3]> {
    let (dx, dy) = (x - 0.5, y - 0.5);
    if dx * dx + dy * dy > 0.25 {
        return None;
    }
    let sky = mix(DUSK[0], DUSK[1], y);
    // The owl's stump stands on the disc's lower part, and its ears are below the upper rim.
    let (column, row) = (0.5 + dx * 1.2, (0.89 - y) * 1.2);
    let at = [column, row].map(|part| part * GRID as f32 - 0.5);
    let Some(normal) = depths.normal(at) else { return Some(sky) };
    // The light comes from the upper left, like a lamp over the shoulder.
    let light = [-0.45, 0.62, 0.64];
    let lit: f32 = normal.iter().zip(light).map(|(n, l)| n * l).sum();
    Some(mix(MARBLE[1], MARBLE[0], (0.18 + 0.82 * lit.max(0.0)).min(1.0)))
}

fn mix(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    core::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}

/// The depth of the figure's front, in voxels towards the viewer, for each line of sight; `None` beside the
/// figure.
struct FrontDepths(Vec<Option<f32>>);

impl FrontDepths {
    fn of_owl() -> Self {
        let (mut maps, mut bits) =
            (Box::new(RangeMaps::<GRID, INTERVALS>::new()), Box::new(BitGrid::new()));
        Figure::Owl.rasterize_into(&mut maps, &mut bits);
        let places = (0..GRID * GRID).map(|i| (i % GRID, i / GRID));
        let depths = places.map(|(x, y)| {
            let column = maps.column(Axis::Z, Axis::Z.column_address([x, y, 0]));
            column.intervals().last().map(|range| range.last() as f32)
        });
        FrontDepths(depths.collect())
    }

    /// Returns the depth at integer coordinates, averaged with its neighbours, so that voxel steps don't
    /// show.
    fn smooth_depth(&self, x: isize, y: isize) -> Option<f32> {
        let at = |x: isize, y: isize| {
            let within = |part: isize| usize::try_from(part).ok().filter(|part| *part < GRID);
            self.0[within(y)? * GRID + within(x)?]
        };
        let middle = at(x, y)?;
        let (mut sum, mut weight) = (0.0, 0.0);
        for (dy, dx) in (0..25).map(|i| (i / 5 - 2, i % 5 - 2)) {
            // A surface far behind belongs to another part of the figure.
            if let Some(depth) = at(x + dx, y + dy).filter(|depth| (depth - middle).abs() < 6.0) {
                let near = 1.0 / (1.0 + (dx * dx + dy * dy) as f32);
                sum += depth * near;
                weight += near;
            }
        }
        Some(sum / weight)
    }

    /// Returns the normal of the visible surface at a point in voxels; `None` beside the figure.
    fn normal(&self, [x, y]: [f32; 2]) -> Option<[f32; 3]> {
        let (x, y) = (x.round() as isize, y.round() as isize);
        let middle = self.smooth_depth(x, y)?;
        let slope = |before: Option<f32>, after: Option<f32>| {
            // Beside the figure the surface falls off steeply.
            let (before, after) = (before.unwrap_or(middle - 4.0), after.unwrap_or(middle - 4.0));
            (0.5 * (before - after)).clamp(-4.0, 4.0)
        };
        let across = slope(self.smooth_depth(x - 1, y), self.smooth_depth(x + 1, y));
        let up = slope(self.smooth_depth(x, y - 1), self.smooth_depth(x, y + 1));
        let length = (across * across + up * up + 1.0).sqrt();
        Some([across / length, up / length, 1.0 / length])
    }
}

#[cfg(test)]
mod tests {
    use super::{SIDE, draw_pixels, draw_png};

    #[test]
    fn the_icon_is_a_light_figure_on_a_dark_disc() {
        // Written for visual inspection.
        let path = std::env::temp_dir().join("paros-icon.png");
        std::fs::write(path, draw_png().expect("a picture")).expect("room on the disk");
        let pixels = draw_pixels();
        let pixel = |x: usize, y: usize| &pixels[4 * (y * SIDE + x)..][..4];
        assert_eq!(pixel(0, 0)[3], 0, "the corners are clear");
        let sky = pixel(SIDE / 10, SIDE / 2);
        assert!(sky[0] < 80 && sky[3] == 255, "{sky:?}");
        let light =
            (0..SIDE * SIDE).filter(|i| pixels[4 * i] > 130 && pixels[4 * i + 3] == 255).count();
        assert!((SIDE * SIDE / 8..SIDE * SIDE / 2).contains(&light), "{light} light pixels");
        assert!(draw_png().expect("a picture") == draw_png().expect("a picture"));
    }
}
