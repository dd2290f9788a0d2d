//! The stone's brightness in the room's light, in the window and in the headset.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `constants.rs`: a white point of 2; `request.rs`: a tenth of the ambient light ->
//!   `the_stone_is_neither_`.

use glam::Vec3;
use paros_core::RangeMaps;
use paros_core::volume::BitGrid;
use paros_shaders::fast::{self, SunLight};
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{RenderPath, RenderStyle};
use paros_shaders::harmonics::irradiance_over_pi;
use paros_shaders::render::tone_map_to_srgb;
use paros_shell::figures::Figure;
use paros_tests_render::picture_side;
use paros_tests_render::view::PinholeView;

const N: usize = 128;

/// Returns the bytes of the pixels that show a stone in the room's light, to an eye on one of eight sides.
fn stone_pixels(field: &DensityField<N>, side: usize) -> Vec<[u8; 3]> {
    let style = RenderStyle::in_studio(RenderPath::Fast);
    let (sin, cos) = (std::f32::consts::FRAC_PI_4 * side as f32).sin_cos();
    let middle = Vec3::new(64.0, 60.0, 64.0);
    let view = PinholeView::new(middle, [cos, 0.45, sin], [300.0, 170.0], picture_side(112, 160));
    let direction = style.sun_direction;
    let halfway = fast::halfway_to_eye(direction, view.eye, N);
    let sun = SunLight { direction, color: style.sun_color, halfway };
    let shade = |pixel: usize| {
        let at = fast::find_surface(field, &view.ray_through(pixel))?;
        let ambient = irradiance_over_pi(&style.ambient, at.normal);
        Some(tone_map_to_srgb(fast::shade_surface(field, &at, &sun, ambient)))
    };
    (0..view.side * view.side).filter_map(shade).collect()
}

#[test]
fn the_stone_is_neither_blown_out_nor_dim() {
    for figure in [Figure::Owl, Figure::Cat, Figure::Lump] {
        let mut maps = Box::new(RangeMaps::<N>::new());
        let mut bits = BitGrid::new();
        figure.rasterize_into(&mut maps, &mut bits);
        let mut field = DensityField::new();
        field.rebuild_from(&maps);
        let mut greens = Vec::new();
        for side in 0..8 {
            let pixels = stone_pixels(&field, side);
            let bright = pixels.iter().filter(|pixel| pixel.iter().any(|&c| c >= 250)).count();
            let part = bright as f32 / pixels.len() as f32;
            println!("{figure:?}, side {side}: {:.1} % bright", 100.0 * part);
            assert!(
                pixels.len() > picture_side(1000, 2000) && part < 0.02,
                "{figure:?}, side {side}: {part}"
            );
            greens.extend(pixels.iter().map(|pixel| pixel[1]));
        }
        greens.sort_unstable();
        let median = greens[greens.len() / 2];
        println!("{figure:?}: median {median}");
        assert!((130..=200).contains(&median), "{figure:?}: {median}");
    }
}
