//! Number of texels that a pixel of the fast path fetches: the fetches for its light are compared with the
//! twin's, and the total is limited in a view filled by the sculpture, as during work.
//!
//! The instrumented programs count the fetches; `paros-bench render` reports them for real sculptures.

use glam::{Quat, Vec3};
use paros_core::volume::{Grid, Size};
use paros_models::dense::DenseVolume;
use paros_shaders::Ray;
use paros_shaders::fast::{self, RayFetches, SunLight};
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{Drawn, Eye, Fov, FrameRequest, PixelCounts, RenderPath, RenderStyle};
use paros_shaders::upload::VolumeFormat;
use paros_tests_render::view::build_maps_and_field;
use paros_tests_vulkan::test_renderer::{
    TestRenderer, metre_wide_sculpture_at_origin, test_device,
};

/// Maximum mean number of texels for the pixels that show the sculpture: what a headset's texture units can
/// deliver.
const BUDGET: f64 = 12.0;
/// Size of a headset's eye image, in pixels.
const EYE_PIXELS: [u32; 2] = [1440, 1584];

/// Returns a ball in an arch: it has outlines, hollows, and stone in the sun and in shadow.
fn arch_with_ball<const N: usize>() -> Box<DensityField<N>>
where
    Grid<N>: Size,
{
    let side = N as f32;
    let round = |at: Vec3, middle: Vec3, radius: f32| at.distance(middle * side) < radius * side;
    let holds = |at: Vec3| {
        let outside = round(at, Vec3::new(0.5, 0.4, 0.5), 0.46);
        let hollow = round(at, Vec3::new(0.55, 0.55, 0.8), 0.33);
        outside && !hollow || round(at, Vec3::new(0.5, 0.42, 0.62), 0.14)
    };
    let volume = DenseVolume::from_fn(N, |at| holds(Vec3::from_array(at.map(|c| c as f32 + 0.5))));
    build_maps_and_field::<N>(&volume.closure()).1
}

fn eye(distance: f32, half_angle: f32) -> Eye {
    let tilt = -0.2;
    let rotation = Quat::from_rotation_x(tilt);
    let position = Vec3::new(0.0, 0.45, 0.0) - rotation * Vec3::NEG_Z * distance;
    let fov = Fov { left: -half_angle, right: half_angle, up: half_angle, down: -half_angle };
    Eye { position, rotation, fov }
}

fn count<const N: usize>(
    field: &DensityField<N>,
    drawn: Drawn,
    extent: [u32; 2],
    eye: Eye,
) -> Option<Vec<PixelCounts>>
where
    Grid<N>: Size,
{
    let gpu = test_device()?;
    let mut drawing = TestRenderer::new(&gpu, VolumeFormat::of::<N, 1>(), [1, 1], extent);
    drawing.upload_field(field);
    let eyes = [eye];
    let plain = metre_wide_sculpture_at_origin(&eyes);
    let style = RenderStyle { path: RenderPath::Fast, drawn, ..plain.style };
    let picture = drawing.draw_picture(&FrameRequest { style, ..plain }).remove(0);
    Some(picture.iter().map(|&[r, g, b, _]| PixelCounts::from_srgb([r, g, b])).collect())
}

/// Besides its march, one texel a step, a pixel fetches texels for its ray's start, the surface and the
/// light. These are as many as the twin's, whose rays start at the box and whose room blocks no sun.
#[test]
fn a_pixel_fetches_what_its_twin_does() {
    const N: usize = 64;
    let extent = [120, 120];
    let (field, eye) = (arch_with_ball::<N>(), eye(1.4, 0.5));
    let Some(counts) = count(&field, Drawn::Counts, extent, eye) else { return };
    let style = RenderStyle::default();
    let (mut hits, mut same, mut kinds) = (0, 0, std::collections::BTreeSet::new());
    for (i, pixel) in counts.iter().enumerate().filter(|(_, pixel)| pixel.hit) {
        let ray = ray_through(&eye, extent, i, N);
        let mut twin = RayFetches::default();
        let Some(at) = fast::find_surface_counting(&field, &ray, &mut twin) else { continue };
        let halfway = fast::halfway_to_eye(style.sun_direction, ray.origin, N);
        let sun = SunLight { direction: style.sun_direction, color: style.sun_color, halfway };
        let _ = fast::shade_surface_counting(&field, &at, &sun, Vec3::ZERO, 0.0, &mut twin);
        let shadow_map = u32::from(at.normal.dot(sun.direction) > 0.0);
        let expected = 1 + twin.shading + shadow_map;
        hits += 1;
        same += usize::from(pixel.fetches - pixel.turns == expected);
        kinds.insert(expected);
        assert!(pixel.turns <= twin.march + 4, "{pixel:?} starts no earlier than {twin:?}");
    }
    assert!(hits > 4000 && same * 100 > hits * 99, "{same} of {hits}");
    assert_eq!(kinds.into_iter().collect::<Vec<_>>(), [5, 6, 7], "in shade, in the sun, sparkling");
}

#[test]
fn a_view_that_the_sculpture_fills_is_within_the_budget() {
    check_budget(&arch_with_ball::<128>());
    check_budget(&arch_with_ball::<256>());
}

fn check_budget<const N: usize>(field: &DensityField<N>)
where
    Grid<N>: Size,
{
    let counts = count(field, Drawn::CoverageCounts, EYE_PIXELS, eye(0.9, 0.5));
    let Some(counts) = counts else { return };
    let pixels = counts.iter().filter(|pixel| pixel.hit).count();
    let filled = pixels as f64 / counts.len() as f64;
    assert!((0.75..0.95).contains(&filled), "{filled} of the view");
    let fetches: u32 = counts.iter().map(|pixel| pixel.fetches).sum();
    let mean = f64::from(fetches) / pixels as f64;
    let turns = f64::from(counts.iter().map(|pixel| pixel.turns).sum::<u32>()) / pixels as f64;
    println!(
        "{N}: {mean:.2} texels and {turns:.2} turns a pixel, {:.0} % of the view",
        100.0 * filled
    );
    assert!(mean <= BUDGET, "{N}: {mean} texels a pixel");
}

/// Returns the ray through a pixel's centre, in voxels.
fn ray_through(eye: &Eye, [width, height]: [u32; 2], pixel: usize, grid_side: usize) -> Ray {
    let (x, y) = (pixel as u32 % width, pixel as u32 / width);
    let across = |at: u32, of: u32| 2.0 * (at as f32 + 0.5) / of as f32 - 1.0;
    let view = Vec3::new(
        across(x, width) * eye.fov.right.tan(),
        -across(y, height) * eye.fov.up.tan(),
        -1.0,
    );
    let origin = (eye.position + Vec3::new(0.5, 0.0, 0.5)) * grid_side as f32;
    Ray { origin, direction: (eye.rotation * view).normalize() }
}
