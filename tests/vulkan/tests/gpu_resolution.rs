//! Dynamic resolution: a part of the images is drawn like a picture of that size, and looks like the whole. A
//! window's picture is scaled up under its panels.

use std::sync::LazyLock;

use glam::Vec3;
use paros_core::RangeMaps;
use paros_core::volume::BitGrid;
use paros_shaders::field::DensityField;
use paros_shaders::gpu::overlay::{ClippedRun, PanelVertex};
use paros_shaders::gpu::{
    Eye, FrameRequest, OffscreenTarget, PaperVariant, RenderPath, SharedGpu, TargetFormat,
};
use paros_shaders::upload::VolumeFormat;
use paros_shell::figures::Figure;
use paros_shell::headset::resolution::ResolutionPolicy;
use paros_tests_vulkan::test_renderer::{
    AHEAD, Layers, TestRenderer, metre_wide_sculpture_at_origin, test_device,
};

const N: usize = 128;
const FULL: [u32; 2] = [398, 441];

static OWL: LazyLock<Box<DensityField<N>>> = LazyLock::new(|| {
    let (mut maps, mut plane) = (Box::new(RangeMaps::new()), Box::new(BitGrid::new()));
    Figure::Owl.rasterize_into(&mut maps, &mut plane);
    let mut field = Box::new(DensityField::new());
    field.rebuild_from(&maps);
    field
});

/// Returns a pair of eyes.
fn eyes() -> [Eye; 2] {
    [AHEAD, Eye { position: AHEAD.position + Vec3::X * 0.063, ..AHEAD }]
}

fn renderer(gpu: &SharedGpu, [samples, views]: [u32; 2], extent: [u32; 2]) -> TestRenderer {
    let mut made = TestRenderer::new(gpu, VolumeFormat::of::<N, 1>(), [samples, views], extent);
    made.upload_field(&OWL);
    made
}

/// Draws the owl in the first `drawn` pixels of the images. Returns only the pixels of this part.
fn draw(renderer: &mut TestRenderer, path: RenderPath, drawn: [u32; 2]) -> Layers {
    renderer.screen.target.set_drawn_extent(drawn);
    let views = renderer.renderer.format().views as usize;
    let eyes = &eyes()[..views];
    let mut request = metre_wide_sculpture_at_origin(eyes);
    request.style.path = path;
    let across = renderer.screen.target.extent[0] as usize;
    let [width, height] = drawn.map(|pixels| pixels as usize);
    let cut = |layer: Vec<[u8; 4]>| {
        layer.chunks_exact(across).take(height).flat_map(|row| &row[..width]).copied().collect()
    };
    renderer.draw_picture(&request).into_iter().map(cut).collect()
}

/// Resamples a picture to another size by linear interpolation at the pixels' centres.
fn resample(pixels: &[[u8; 4]], from: [u32; 2], to: [u32; 2]) -> Vec<[f32; 3]> {
    let at = |x: u32, y: u32| pixels[(y * from[0] + x) as usize];
    let place = |i: u32, k: usize| {
        let place = (i as f32 + 0.5) * from[k] as f32 / to[k] as f32 - 0.5;
        let low = place.clamp(0.0, (from[k] - 1) as f32);
        (low as u32, (low as u32 + 1).min(from[k] - 1), low.fract())
    };
    let mut out = Vec::new();
    for y in 0..to[1] {
        for x in 0..to[0] {
            let ((x0, x1, fx), (y0, y1, fy)) = (place(x, 0), place(y, 1));
            out.push(std::array::from_fn(|c| {
                let mix =
                    |a: [u8; 4], b: [u8; 4]| f32::from(a[c]) * (1.0 - fx) + f32::from(b[c]) * fx;
                mix(at(x0, y0), at(x1, y0)) * (1.0 - fy) + mix(at(x0, y1), at(x1, y1)) * fy
            }));
        }
    }
    out
}

#[test]
fn a_part_is_drawn_as_a_picture_of_its_size() {
    let Some(gpu) = test_device() else { return };
    for kind in [[1, 1], [4, 1], [4, 2]] {
        for path in [RenderPath::Fast, RenderPath::Paper(PaperVariant::Whole)] {
            let mut large = renderer(&gpu, kind, FULL);
            for drawn in [[339, 375], [120, 128], FULL] {
                let part = draw(&mut large, path, drawn);
                let whole = draw(&mut renderer(&gpu, kind, drawn), path, drawn);
                assert!(part == whole, "{kind:?} {path:?} {drawn:?}");
            }
        }
    }
}

#[test]
fn a_picture_of_less_resolution_looks_like_the_full_one() {
    let Some(gpu) = test_device() else { return };
    let mut renderer = renderer(&gpu, [4, 1], FULL);
    let full = draw(&mut renderer, RenderPath::Fast, FULL).remove(0);
    for percent in [100, 95, 90, 85] {
        let mut policy = ResolutionPolicy::new(85);
        while policy.percent() > percent {
            policy.observe_frame(20_000_000, std::time::Duration::from_millis(13));
        }
        let drawn = policy.drawn_extent(FULL, None);
        let small = draw(&mut renderer, RenderPath::Fast, drawn).remove(0);
        let shown = resample(&small, drawn, FULL);
        let off = |(a, b): (&[f32; 3], &[u8; 4])| {
            (0..3).map(|c| (a[c] - f32::from(b[c])).abs()).fold(0.0, f32::max)
        };
        let offs: Vec<f32> = shown.iter().zip(&full).map(off).collect();
        let mean = offs.iter().sum::<f32>() / offs.len() as f32;
        let far = offs.iter().filter(|off| **off > 32.0).count() as f32 / offs.len() as f32;
        println!("{percent}: mean {mean:.3} of 255, beyond 32: {:.3} %", far * 100.0);
        assert!(mean <= 0.5 && far <= 0.005, "{percent}: {mean} {far}");
        assert!(percent == 100 || mean > 0.0, "nothing else was drawn");
    }
}

/// The picture equals the separately drawn part, scaled up; the overlay keeps full resolution.
#[test]
fn a_picture_is_scaled_up_under_the_overlay() {
    let Some(gpu) = test_device() else { return };
    let format = OffscreenTarget::readback_format(4, 1, false);
    let (volume, scaling) =
        (VolumeFormat::of::<N, 1>(), TargetFormat { scales_up: true, ..format });
    let mut window = TestRenderer::with_format(&gpu, volume, scaling, FULL);
    window.upload_field(&OWL);
    let mut whole = renderer(&gpu, [4, 1], FULL);
    for drawn in [[140, 155], [339, 375], FULL] {
        let part = draw(&mut whole, RenderPath::Fast, drawn).remove(0);
        window.screen.target.set_drawn_extent(drawn);
        let mut request = metre_wide_sculpture_at_origin(&[AHEAD]);
        request.style.path = RenderPath::Fast;
        let shown = draw_under_a_square(&mut window, &request);
        let is_in_square = |i: usize| {
            [i % FULL[0] as usize, i / FULL[0] as usize].map(|k| SQUARE.contains(&k)) == [true; 2]
        };
        let expected = resample(&part, drawn, FULL);
        let mut sum = 0.0;
        for (i, (pixel, expected)) in shown.iter().zip(&expected).enumerate() {
            if is_in_square(i) {
                assert_eq!(pixel[..3], [255; 3], "pixel {i} of {drawn:?}");
            } else {
                sum += (f32::from(pixel[1]) - expected[1]).abs();
            }
        }
        // The device interpolates linear light, this test encoded values.
        let mean = sum / shown.len() as f32;
        assert!(mean < 0.5, "{drawn:?}: {mean} of 255");
    }
}

/// Range of the overlay's square across and down, in pixels.
const SQUARE: std::ops::Range<usize> = 31..64;

/// Draws a picture with a white square over it.
fn draw_under_a_square(window: &mut TestRenderer, request: &FrameRequest<'_>) -> Vec<[u8; 4]> {
    let [low, high] = [SQUARE.start as f32, SQUARE.end as f32];
    let corner = |position| PanelVertex { position, texel: [0.5; 2], color: [255; 4] };
    let corners = [[low, low], [high, low], [high, high], [low, high]].map(corner);
    let run = ClippedRun { indices: 0..6, clip: [0, 0, FULL[0], FULL[1]] };
    window.renderer.wait_and_begin_frame().expect("a frame");
    let overlay = &mut window.renderer.overlay;
    assert!(overlay.try_stage_atlas_patch([0, 0], [1, 1], &[[255; 4]]));
    assert!(overlay.try_set_triangles(&corners, &[0, 1, 2, 0, 2, 3], &[run], FULL));
    window.draw_begun_picture(request).remove(0)
}
