//! The GPU's picture of the sculpture against the CPU twin's, on both paths.
//!
//! Percentages refer to the pixels inside the box's outline, at one sample.

use glam::{Quat, Vec3};
use paros_core::RangeMaps;
use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_models::dense::DenseVolume;
use paros_models::layers::LayeredVolume;
use paros_models::voxel_traversal;
use paros_shaders::field::{DensityField, FigureShares};
use paros_shaders::gpu::{
    Eye, Fov, FrameRequest, FrameSemaphores, Gpu, OffscreenTarget, Options, PaperVariant,
    RenderPath, RenderStyle, Renderer, SculpturePlacement, SharedGpu,
};
use paros_shaders::march::clip_to_cube;
use paros_shaders::upload::VolumeFormat;
use paros_shaders::{Image, Ray, TwinScene, TwinSettings, shade_ray};
use paros_shell::require::require_or_skip;
use paros_tests_render::view::{build_layered_maps_and_field, build_maps_and_field};
use paros_tests_vulkan::test_renderer::metre_wide_sculpture_at_origin;

const EXTENT: [u32; 2] = [200, 168];
const N: usize = 64;
const NEAR: f32 = 0.04;
const FAR: f32 = 60.0;
/// The stool's rotation for each of the three eyes.
const TURNS: [f32; 3] = [0.4, 1.9, 3.6];

/// Counts of agreement between two pictures, over the pixels inside the box's outline.
#[derive(Default)]
struct Agreement {
    pixels: u32,
    hits: u32,
    same_hit: u32,
    same_depth: u32,
    same_color: u32,
}

/// A picture's pixels and their depths.
type Picture = (Vec<[u8; 4]>, Vec<f32>);

/// A renderer with its target.
struct TwinRig {
    gpu: SharedGpu,
    renderer: Renderer,
    screen: OffscreenTarget,
}

impl TwinRig {
    /// Creates the rig, or returns `None` if there is no device. The fast path computes in half precision
    /// unless `single`; returns `None` if the device doesn't support half precision.
    fn new(single: bool, volume: VolumeFormat) -> Option<Self> {
        let options = Options { validation: true, single_precision: single, ..Options::default() };
        let gpu = require_or_skip(Gpu::headless(&options)).expect("Vulkan")?;
        let precision =
            (single || gpu.features.half_precision).then_some(()).ok_or("no half precision");
        require_or_skip(precision).expect("half precision")?;
        let format = OffscreenTarget::readback_format(1, 1, true);
        let renderer = Renderer::new(&gpu, format, volume, &[]).expect("a renderer");
        let screen = OffscreenTarget::new(&gpu, &renderer, EXTENT).expect("images");
        Some(TwinRig { gpu, renderer, screen })
    }

    fn load<const N: usize, const K: usize>(&mut self, field: &DensityField<N, K>) {
        field.emit_all_regions(|region, bytes| {
            self.renderer.submit_upload_between_frames(region, bytes).expect("a device");
        });
    }

    fn draw(&mut self, eye: Eye, turn: f32, path: RenderPath) -> Picture {
        let picture = FrameRequest {
            eyes: &[eye],
            placement: SculpturePlacement { foot: Vec3::ZERO, side: 1.0, turn_radians: turn },
            style: RenderStyle { path, ..RenderStyle::default() },
            ..metre_wide_sculpture_at_origin(&[])
        };
        self.renderer.wait_and_begin_frame().expect("a device");
        self.renderer
            .draw_frame(&picture, &self.screen.target, 0, FrameSemaphores::default())
            .expect("a device");
        self.gpu.wait_idle().expect("a device");
        let depths = self.screen.read_depths(0).expect("a device").expect("depth in floats");
        (self.screen.read_pixels(0).expect("a device"), depths)
    }

    fn check_validation(&self) {
        let messages = self.gpu.instance.validation_messages();
        assert!(messages.is_empty(), "validation: {}", messages.join("\n"));
    }
}

#[test]
fn the_gpu_draws_what_its_twin_draws() {
    check_agreement(true, &[RenderPath::Fast, RenderPath::Paper(PaperVariant::Whole)], eye);
}

/// Tests the half-precision variant, which runs on a headset's GPU. The paper's path has no such variant.
#[test]
fn the_gpu_draws_in_halves_what_its_twin_draws() {
    check_agreement(false, &[RenderPath::Fast], eye);
}

/// Tests eyes inside the box, as visitors lean in. The paper's path draws the box's front faces, and shows
/// nothing from inside.
#[test]
fn from_inside_the_box_the_gpu_draws_what_its_twin_draws() {
    for single in [true, false] {
        check_agreement(single, &[RenderPath::Fast], eye_inside);
    }
}

/// Both intervals of a column are drawn, also voxels that only a second interval can represent.
#[test]
fn the_gpu_draws_two_intervals_as_its_twin_does() {
    let Some(mut rig) = TwinRig::new(true, VolumeFormat::of::<N, 2>()) else { return };
    for (name, volume) in hollow_volumes() {
        let (maps, field) = build_layered_maps_and_field::<N, 2>(&volume);
        let paths = [RenderPath::Fast, RenderPath::Paper(PaperVariant::Whole)];
        check_volume(&mut rig, name, (&maps, &field, None), &paths, &eye);
    }
    rig.check_validation();
}

/// The same voxels in columns of one interval and of two, up to the largest coordinate of a byte.
#[test]
fn two_intervals_draw_what_one_draws_at_256() {
    let mut bits = Box::new(BitGrid::<256>::new());
    let edge = |c: usize| !(20..236).contains(&c);
    for (y, z) in (0..256 * 256).map(|i| (i / 256, i % 256)) {
        let whole = edge(y) && edge(z);
        let ends = (0..256).filter(|&x| whole || edge(x) && (edge(y) || edge(z)));
        ends.for_each(|x| bits.row_mut(y, z).insert(x));
    }
    let Some(one) = draw_bits::<256, 1>(&bits) else { return };
    let two = draw_bits::<256, 2>(&bits).expect("the same device");
    for (view, (one, two)) in one.iter().zip(&two).enumerate() {
        let hits = one.1.iter().filter(|depth| **depth > 0.0).count();
        let differ = one.1.iter().zip(&two.1).filter(|(a, b)| a != b).count();
        assert!(hits > 1000 && differ == 0, "view {view}: {differ} of {hits}");
        assert!(one.0 == two.0, "view {view}: other colours");
    }
}

/// Draws the paper path's pictures of the closure of a set of voxels in columns of K intervals. Returns the
/// pictures with their depths.
fn draw_bits<const N: usize, const K: usize>(bits: &BitGrid<N>) -> Option<Vec<Picture>>
where
    Grid<N>: Size,
{
    let mut rig = TwinRig::new(true, VolumeFormat::of::<N, K>())?;
    let (mut maps, mut field) = (Box::new(RangeMaps::<N, K>::new()), DensityField::new());
    bits.write_closure(&mut maps);
    field.rebuild_from(&maps);
    rig.load(&field);
    let path = RenderPath::Paper(PaperVariant::Whole);
    let views = TURNS.into_iter().enumerate();
    let pictures = views.map(|(view, turn)| rig.draw(eye(view), turn, path)).collect();
    rig.check_validation();
    Some(pictures)
}

fn check_agreement(single: bool, paths: &[RenderPath], eye: impl Fn(usize) -> Eye) {
    let Some(mut rig) = TwinRig::new(single, VolumeFormat::of::<N, 1>()) else { return };
    for (name, volume) in test_volumes() {
        let (maps, field) = build_maps_and_field::<N>(&volume);
        let name = format!("{name}-single-{single}");
        check_volume(&mut rig, &name, (&maps, &field, None), paths, &eye);
    }
    rig.check_validation();
}

fn check_volume<const K: usize>(
    rig: &mut TwinRig,
    name: &str,
    (maps, field, figure): (&RangeMaps<N, K>, &DensityField<N, K>, Option<&FigureShares>),
    paths: &[RenderPath],
    eye: &impl Fn(usize) -> Eye,
) {
    rig.load(field);
    for (view, turn) in TURNS.into_iter().enumerate() {
        for &path in paths {
            let eye = eye(view);
            let (pixels, depths) = rig.draw(eye, turn, path);
            let scene = TwinScene {
                field: (path == RenderPath::Fast).then_some(field),
                figure,
                ..TwinScene::new(maps, turn, TwinSettings::default())
            };
            check_picture(&format!("{name}-{view}-{path:?}"), &scene, &eye, &pixels, &depths);
        }
    }
}

/// Tests a figure that is partly covered by stone.
#[test]
fn a_bared_figure_shines_as_its_twin_does() {
    for single in [true, false] {
        let Some(mut rig) = TwinRig::new(single, VolumeFormat::of::<N, 1>()) else { return };
        let (maps, field) = build_maps_and_field::<N>(&test_volumes()[1].1);
        let mut figure = FigureShares::new();
        figure.rebuild_from(&build_maps_and_field::<N>(&test_volumes()[0].1).0);
        rig.renderer.submit_figure_between_frames(&figure).expect("a device");
        let shown = (&*maps, &*field, Some(&figure));
        check_volume(&mut rig, "figure", shown, &[RenderPath::Fast], &eye);
        rig.check_validation();
    }
}

/// The full march reads the maps more often and finds the same voxels.
#[test]
fn a_full_march_draws_what_the_quick_one_draws() {
    let Some(mut rig) = TwinRig::new(true, VolumeFormat::of::<N, 1>()) else { return };
    for (name, volume) in test_volumes() {
        rig.load(&build_maps_and_field::<N>(&volume).1);
        check_full_march(&mut rig, name);
    }
    rig.check_validation();
}

#[test]
fn a_full_march_draws_two_intervals_as_the_quick_one_does() {
    let Some(mut rig) = TwinRig::new(true, VolumeFormat::of::<N, 2>()) else { return };
    for (name, volume) in hollow_volumes() {
        rig.load(&build_layered_maps_and_field::<N, 2>(&volume).1);
        check_full_march(&mut rig, name);
    }
    rig.check_validation();
}

fn check_full_march(rig: &mut TwinRig, name: &str) {
    for (view, turn) in TURNS.into_iter().enumerate() {
        let [quick, full] = [PaperVariant::Whole, PaperVariant::FullMarch]
            .map(|parts| rig.draw(eye(view), turn, RenderPath::Paper(parts)));
        let differ = quick.1.iter().zip(&full.1).filter(|(a, b)| a != b).count();
        let hits = quick.1.iter().filter(|depth| **depth > 0.0).count();
        assert!(hits > 1000 && differ == 0, "{name}, view {view}: {differ} of {hits}");
    }
}

/// Unlike the twin's rays, the GPU's may start where their beams start, and so step over other parts of
/// features thinner than a step.
#[test]
fn the_gpu_keeps_what_is_thin() {
    let Some(mut rig) = TwinRig::new(true, VolumeFormat::of::<N, 1>()) else { return };
    let plates = |[x, y, z]: [i32; 3]| y == 9 || x == 50 || z == 31 && y < 30;
    let rods = |[x, y, z]: [i32; 3]| x % 6 == 2 && z == 40 || y % 6 == 3 && z == 20;
    for (name, volume, least) in [
        ("plates", DenseVolume::from_fn(N, plates).closure(), 0.9),
        ("rods", DenseVolume::from_fn(N, rods).closure(), 0.6),
    ] {
        let (maps, field) = build_maps_and_field::<N>(&volume);
        rig.load(&field);
        for (view, turn) in TURNS.into_iter().enumerate() {
            let scene = TwinScene::new(&maps, turn, TwinSettings::default());
            let (pixels, depths) = rig.draw(eye(view), turn, RenderPath::Fast);
            let width = EXTENT[0] as usize;
            let shows = |i: &usize| {
                let ray = scene.ray_to_grid(&pixel_ray(&eye(view), i % width, i / width).0);
                let [from, way] = [ray.origin, ray.direction].map(|v| v.to_array().map(f64::from));
                voxel_traversal::find_first_occupied(&volume, from, way).is_some()
            };
            let shown: Vec<usize> = (0..pixels.len()).filter(shows).collect();
            let kept = shown.iter().filter(|&&i| depths[i] > 0.0).count();
            let part = kept as f32 / shown.len() as f32;
            assert!(part >= least, "{name}, view {view}: {part} of {} stay", shown.len());
        }
    }
    rig.check_validation();
}

fn check_picture<const K: usize>(
    name: &str,
    scene: &TwinScene<'_, N, K>,
    eye: &Eye,
    pixels: &[[u8; 4]],
    depths: &[f32],
) {
    let [width, height] = EXTENT.map(|pixels| pixels as usize);
    let mut all = Agreement::default();
    let mut twin = Image::filled(width, height, [0; 3]);
    let mut drawn = Image::filled(width, height, [0; 3]);
    for (i, (pixel, depth)) in pixels.iter().zip(depths).enumerate() {
        let (x, y) = (i % width, i / width);
        let (ray, along) = pixel_ray(eye, x, y);
        drawn.pixels[3 * i..3 * i + 3].copy_from_slice(&pixel[..3]);
        if clip_to_cube(&scene.ray_to_grid(&ray), N as f32).is_none() {
            continue;
        }
        all.pixels += 1;
        let hit = shade_ray(scene, &ray, dither(x, y));
        // Depth is 1 on the near plane and 0 on the far one.
        let scale = NEAR * FAR / (FAR - NEAR);
        let distance = scale / (depth + NEAR / (FAR - NEAR)) / along;
        all.same_hit += u32::from(hit.is_some() == (*depth > 0.0));
        let Some(hit) = hit else { continue };
        let color = paros_shaders::render::tone_map_to_srgb(hit.color);
        twin.pixels[3 * i..3 * i + 3].copy_from_slice(&color);
        if *depth == 0.0 {
            continue;
        }
        all.hits += 1;
        all.same_depth += u32::from((hit.depth - distance).abs() * N as f32 <= 0.5);
        let off = (0..3).map(|c| color[c].abs_diff(pixel[c])).max().unwrap_or(0);
        all.same_color += u32::from(off <= 3);
    }
    let part = |some: u32, of: u32| f64::from(some) / f64::from(of.max(1));
    let hit = part(all.same_hit, all.pixels);
    let (depth, color) = (part(all.same_depth, all.hits), part(all.same_color, all.hits));
    println!("{name}: hit {hit:.5} depth {depth:.5} color {color:.5} of {}", all.hits);
    if all.hits < 500 || hit < 0.998 || depth < 0.998 || color < 0.99 {
        let file = std::env::temp_dir().join(format!("paros-{name}.png"));
        let sheet = paros_shaders::contact_sheet(&[twin, drawn], 2);
        let png = std::fs::File::create(&file).expect("a temporary folder");
        sheet.write_png(png).expect("a temporary folder");
        panic!("{name}: hit {hit:.4} depth {depth:.4} color {color:.4}; see {}", file.display());
    }
}

fn eye(view: usize) -> Eye {
    let (position, down) = [
        (Vec3::new(0.1, 0.9, 1.7), 0.27f32),
        (Vec3::new(-0.1, 1.6, 1.4), 0.75),
        (Vec3::new(0.0, 0.45, 1.5), 0.0),
    ][view];
    eye_at(position, down)
}

/// Returns an eye in the box and outside the stone, or an eye before the box with the near plane inside it.
/// None of them looks along a long inner outline: there, two rays that start half a voxel apart may end far
/// apart, and only the GPU's rays may start where their beams start.
fn eye_inside(view: usize) -> Eye {
    let (position, down) = [
        (Vec3::new(0.1, 0.8, 0.45), 0.5f32),
        (Vec3::new(0.02, 0.93, 0.03), 1.2),
        (Vec3::new(0.0, 0.75, 0.575), 0.35),
    ][view];
    eye_at(position, down)
}

fn eye_at(position: Vec3, down: f32) -> Eye {
    let fov = Fov { left: -0.45, right: 0.44, up: 0.4, down: -0.36 };
    Eye { position, rotation: Quat::from_rotation_x(-down), fov }
}

/// Returns the ray through a pixel's centre, and the component of its unit direction along the eye's axis.
fn pixel_ray(eye: &Eye, x: usize, y: usize) -> (Ray, f32) {
    let [l, r, u, d] = [eye.fov.left, eye.fov.right, eye.fov.up, eye.fov.down].map(f32::tan);
    let [width, height] = EXTENT.map(|pixels| pixels as f32);
    let (px, py) = ((x as f32 + 0.5) / width, (y as f32 + 0.5) / height);
    let view = Vec3::new(l + (r - l) * px, u + (d - u) * py, -1.0);
    let direction = (eye.rotation * view).normalize();
    (Ray { origin: eye.position, direction }, 1.0 / view.length())
}

/// Equals `light::dither` of the shaders.
fn dither(x: usize, y: usize) -> f32 {
    let dot = x as f32 * 0.067_110_56 + y as f32 * 0.005_837_15;
    (52.982_92 * dot.fract()).fract()
}

fn test_volumes() -> Vec<(&'static str, DenseVolume)> {
    let far = |[x, y, z]: [i32; 3], c: [f32; 3]| {
        let d = [x as f32 + 0.5 - c[0], y as f32 + 0.5 - c[1], z as f32 + 0.5 - c[2]];
        (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
    };
    let ball = DenseVolume::from_fn(N, |at| far(at, [31.5, 30.0, 33.0]) < 25.0);
    let pair = DenseVolume::from_fn(N, |at| {
        far(at, [20.0, 18.0, 22.0]) < 17.0 || far(at, [42.0, 36.0, 40.0]) < 20.0 || at[1] < 5
    });
    let steps = DenseVolume::from_fn(N, |[x, y, z]| y < 8 + 6 * (x / 9) && (z + y) % 64 > 9);
    vec![("ball", ball), ("pair", pair.closure()), ("steps", steps.closure())]
}

/// Returns volumes that columns of one interval can't represent.
fn hollow_volumes() -> Vec<(&'static str, DenseVolume)> {
    let middle = |[x, y, z]: [i32; 3]| [x - 32, y - 30, z - 32];
    let square = |at: [i32; 3]| middle(at).map(|c| c * c);
    // A post in a room with a window in each wall and a hole in the roof.
    let lantern = DenseVolume::from_fn(N, |at| {
        let [x, y, z] = square(at);
        let wall = x.max(z) < 26 * 26 && at[1] < 58;
        let room = x.max(z) < 21 * 21 && (6..52).contains(&at[1]);
        let holes = x + y < 13 * 13 || y + z < 13 * 13 || x + z < 9 * 9;
        wall && !room && !holes || x + z < 6 * 6 && at[1] < 40 || at[1] < 4
    });
    // Holes drilled crosswise through a block.
    let drilled = DenseVolume::from_fn(N, |at| {
        let [x, y, z] = square(at);
        let [dx, dy, dz] = middle(at);
        x.max(y).max(z) < 26 * 26
            && x + y > 81
            && (dx - dz - 12).pow(2) + 2 * (dy - 12).pow(2) > 90
            && (dy + dz).pow(2) + 2 * (dx + 14).pow(2) > 60
    });
    vec![("lantern", close(&lantern)), ("drilled", close(&drilled))]
}

/// Returns the closure in columns of two intervals.
fn close(voxels: &DenseVolume) -> DenseVolume {
    LayeredVolume::new(voxels, 2).voxels().clone()
}
