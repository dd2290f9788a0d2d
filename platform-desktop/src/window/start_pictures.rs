//! Pictures of the starts, for the start panel.

use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shaders::{Camera, Image, RenderOptions, render_image};
use paros_shell::figures::Figure;
use paros_shell::start_volume_store::StartVolumeStore;

/// Width and height of a picture in pixels.
pub(super) const PICTURE_SIZE: [usize; 2] = [120, 96];

/// Returns the figures that have a picture, from left to right: the lump to carve, the toy to shape, and the
/// hidden figures.
pub(super) fn pictured_figures() -> impl Iterator<Item = Figure> {
    [Figure::Lump, Figure::Toy].into_iter().chain(Figure::HIDDEN)
}

/// Renders the pictures of [`pictured_figures`] side by side, by the paper's path: it needs no density field,
/// whose computation takes longer than all pictures.
#[must_use]
pub(super) fn render_start_pictures<const N: usize>(
    volumes: &StartVolumeStore<N, INTERVALS>,
) -> Image
where
    Grid<N>: Size,
{
    let [width, height] = PICTURE_SIZE;
    let options = RenderOptions { width, height, ..RenderOptions::paper_path() };
    let camera = Camera::orbiting(0.35, 0.2);
    let pictures: Vec<_> = pictured_figures()
        .map(|figure| render_image(volumes.figure(figure), &camera, &options, &|_| {}))
        .collect();
    let rows = (0..height).flat_map(|y| pictures.iter().map(move |picture| (picture, y)));
    let pixels = rows.flat_map(|(picture, y)| &picture.pixels[3 * width * y..][..3 * width]);
    let pixels = pixels.copied().collect();
    Image { width: width * pictures.len(), height, pixels }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use paros_shell::statics::Resident;

    use super::*;

    #[test]
    fn each_start_has_a_picture_of_its_own_at_once() {
        let mut resident = <Grid<128> as Resident<128, INTERVALS>>::lock_world();
        resident.generate_starts();
        let begun = Instant::now();
        let strip = render_start_pictures(&resident.start_volumes);
        let taken = begun.elapsed();
        // A debug build beside other tests is several times slower.
        assert!(taken < Duration::from_secs(6), "{taken:?}");
        let [width, height] = PICTURE_SIZE;
        let count = pictured_figures().count();
        assert_eq!([strip.width, strip.height], [count * width, height]);
        let picture = |number: usize| -> Vec<[u8; 3]> {
            let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            places.map(|(x, y)| strip.pixel(number * width + x, y)).collect()
        };
        for number in 0..count {
            let marble = picture(number).iter().filter(|pixel| pixel[2] > 150).count();
            assert!(marble * 20 > width * height, "{marble} bright pixels in picture {number}");
            for other in 0..number {
                let (a, b) = (picture(number), picture(other));
                let far = a.iter().zip(&b).filter(|(a, b)| a[0].abs_diff(b[0]) > 40).count();
                assert!(far * 30 > width * height, "{number} is as {other}");
            }
        }
    }
}
