//! The smoothness of the fast path's outline with four samples a pixel.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `pipelines.rs`: alpha isn't coverage; `fast.wgsl`: a margin of 0.01; whole coverage of all rays that
//!   hit -> `an_outline_has`.

use glam::{Quat, Vec3};
use paros_models::solid::{Solid, SolidShape};
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{
    Eye, Fov, FrameRequest, FrameSemaphores, Gpu, OffscreenTarget, Options, RenderPath,
    RenderStyle, Renderer, SculpturePlacement,
};
use paros_shaders::upload::VolumeFormat;
use paros_shaders::{Ray, fast};
use paros_shell::require::require_or_skip;
use paros_tests_render::outline::check_profile;
use paros_tests_render::view::build_maps_and_field;

const EXTENT: [u32; 2] = [240, 240];
/// Half of the picture's field of view, in radians.
const FIELD: f32 = 0.35;

/// Measures the coverage of each pixel by a sphere at 4 samples. The radius is 24 in 64 voxels, and a voxel
/// is about two and a half pixels wide. Coverage follows from how much of two backdrops shines through.
fn measure_coverage(
    gpu: &paros_shaders::gpu::SharedGpu,
    eye: &Eye,
    field: &DensityField<64>,
) -> Vec<f32> {
    let mut renderer = Renderer::new(
        gpu,
        OffscreenTarget::readback_format(4, 1, false),
        VolumeFormat::of::<64, 1>(),
        &[],
    )
    .expect("a renderer");
    let screen = OffscreenTarget::new(gpu, &renderer, EXTENT).expect("images");
    field.emit_all_regions(|region, bytes| {
        renderer.submit_upload_between_frames(region, bytes).expect("a device");
    });
    let [black, white] = [0.0, 1.0].map(|backdrop| {
        let picture = FrameRequest {
            eyes: &[*eye],
            placement: SculpturePlacement { foot: Vec3::ZERO, side: 1.0, turn_radians: 0.0 },
            style: RenderStyle { path: RenderPath::Fast, ..RenderStyle::default() },
            backdrop: [backdrop; 3],
            scene: None,
            panels: &[],
        };
        renderer.wait_and_begin_frame().expect("a device");
        renderer
            .draw_frame(&picture, &screen.target, 0, FrameSemaphores::default())
            .expect("a device");
        gpu.wait_idle().expect("a device");
        screen.read_pixels(0).expect("a device")
    });
    let linear = |byte: u8| {
        let c = f32::from(byte) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    black.iter().zip(&white).map(|(b, w)| 1.0 - (linear(w[1]) - linear(b[1]))).collect()
}

/// Tests single precision, and half precision as on a headset.
#[test]
fn an_outline_has_three_levels_of_coverage() {
    [true, false].into_iter().for_each(check_outline);
}

fn check_outline(single: bool) {
    let options = Options { validation: true, single_precision: single, ..Options::default() };
    let Some(gpu) = require_or_skip(Gpu::headless(&options)).expect("Vulkan") else { return };
    let shape = SolidShape::Sphere { radius: 24.0 };
    let solid = Solid { shape, centre: Vec3::splat(32.0), rotation: Quat::IDENTITY };
    let (_, field) = build_maps_and_field::<64>(&solid.to_voxels(64));
    for (position, down) in [(Vec3::new(0.1, 0.5, 2.0), 0.0f32), (Vec3::new(0.0, 1.7, 1.6), 0.64)] {
        let fov = Fov { left: -FIELD, right: FIELD, up: FIELD, down: -FIELD };
        let eye = Eye { position, rotation: Quat::from_rotation_x(-down), fov };
        let middle = eye.rotation.inverse() * (Vec3::new(0.0, 0.5, 0.0) - position);
        // Counts pixels by eighths of the outline and quarters of coverage, and the area covered beyond the
        // pixels whose centres the sphere covers, which the outline's length turns into a width.
        let (mut levels, mut more) = ([[0; 5]; 8], 0.0);
        let covered = measure_coverage(&gpu, &eye, &field);
        let origin = (position + Vec3::new(0.5, 0.0, 0.5)) * 64.0;
        let hits = |at| {
            let direction = eye.rotation * ray_ahead(at);
            fast::find_surface(&field, &Ray { origin, direction }).is_some()
        };
        check_profile(&covered, EXTENT, |at| outline_offset(middle, at).0, hits);
        for (i, covered) in covered.into_iter().enumerate() {
            let level = 4.0 * covered;
            assert!((level - level.round()).abs() < 0.06, "{covered} of a pixel");
            let (beside, angle) = outline_offset(middle, pixel_middle(i));
            more += covered - if beside < 0.0 { 1.0 } else { 0.0 };
            if beside.abs() > 1.5 {
                assert_eq!(level.round(), if beside < 0.0 { 4.0 } else { 0.0 }, "{beside} pixels");
            } else {
                levels[(8.0 * angle) as usize % 8][level.round() as usize] += 1;
            }
        }
        let round = std::f32::consts::TAU * (24.0 / 64.0) / middle.length() / pixel_width();
        println!("{levels:?}, {:.2} pixels out", more / round);
        for levels in levels {
            assert!(levels.iter().all(|&pixels| pixels > 0), "{levels:?}");
        }
        // Devices round coverage up to whole samples differently, by up to an eighth of a pixel.
        assert!((more / round).abs() < 0.2, "the outline is {} pixels off", more / round);
    }
    let messages = gpu.instance.validation_messages();
    assert!(messages.is_empty(), "validation: {}", messages.join("\n"));
}

/// Returns a pixel's width at a distance of one.
fn pixel_width() -> f32 {
    2.0 * FIELD.tan() / EXTENT[0] as f32
}

/// Returns the unit direction through a place of the picture, in the eye's frame.
fn ray_ahead([x, y]: [f32; 2]) -> Vec3 {
    let [width, height] = EXTENT.map(|pixels| pixels as f32 / 2.0);
    Vec3::new((x - width) * pixel_width(), (height - y) * pixel_width(), -1.0).normalize()
}

fn pixel_middle(i: usize) -> [f32; 2] {
    [i % EXTENT[0] as usize, i / EXTENT[0] as usize].map(|c| c as f32 + 0.5)
}

/// Returns the distance in pixels of a place outside the outline of a sphere with centre `middle` in the
/// eye's frame, and the place's position around the outline.
fn outline_offset(middle: Vec3, at: [f32; 2]) -> (f32, f32) {
    let ray = ray_ahead(at);
    let away = ray * middle.dot(ray) - middle;
    let angle = away.y.atan2(away.x) / std::f32::consts::TAU + 0.5;
    ((away.length() - 24.0 / 64.0) / middle.length() / pixel_width(), angle)
}
