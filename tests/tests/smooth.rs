//! How smooth the fast path is: surface, normals and outline of solids that are known exactly,
//! voxelised by the voxels' centres.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `fast.rs`, `fall`: samples of level 0, or 2, for 1 -> `normals`.
//! - `fast.rs`, `meet`: the first sample inside is the surface -> `a_spheres_surface`.
//! - `fast.rs`: the surface where the density is 0.35 -> `a_spheres_surface`, `a_spheres_outline`.
//! - `blur.rs`: no blur along x -> `normals`.
//! - `pipelines.rs`: alpha is no coverage; `fast.wgsl`: a margin of 0.01 -> `an_outline_has`.

use glam::{EulerRot, Quat, Vec3};
use paros_shaders::gpu::{
    Eye, Fov, Gpu, Look, Offscreen, Options, Path, Picture, Renderer, Stand, Sync,
};
use paros_shaders::light::across;
use paros_shaders::march::march;
use paros_shaders::surface::{Surface, blobs};
use paros_shaders::{Ray, fast};
use paros_shell::require::require;
use paros_tests::models::solid::{Shape, Solid};
use paros_tests::models::view::textures;
use rayon::prelude::*;

const N: usize = 128;
/// Off the lattice's points and planes.
const MIDDLE: Vec3 = Vec3::new(63.7, 62.2, 64.45);

fn sphere(radius: f32) -> Solid {
    Solid { shape: Shape::Sphere { radius }, middle: MIDDLE, turn: Quat::IDENTITY }
}

/// As the axes lie, and askew.
fn turns() -> [Quat; 2] {
    [Quat::IDENTITY, Quat::from_euler(EulerRot::YXZ, 0.5, 0.4, 0.3)]
}

/// Evenly spread directions (a spiral).
fn ways(count: u32) -> Vec<Vec3> {
    let way = |i| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * 2.399_963_2).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        Vec3::new(radius * cos, y, radius * sin)
    };
    (0..count).map(way).collect()
}

/// Mean errors on what is seen of a solid from all around.
#[derive(Clone, Copy, Default, Debug)]
struct Errors {
    hits: f32,
    /// Of the fast surface's place, in voxels; the farthest.
    off: f32,
    farthest: f32,
    /// Of the normals, in degrees.
    fast: f32,
    paper: f32,
}

fn errors(solid: &Solid) -> Errors {
    let (maps, field) = textures::<N>(&solid.voxels(N));
    let degrees = |at: &Surface| {
        let cos = at.normal.dot(solid.normal(at.position));
        cos.clamp(-1.0, 1.0).acos().to_degrees()
    };
    let from = |way: Vec3| {
        let ((u, v), mut sum) = (across(way), Errors::default());
        for i in 0..60 * 60 {
            let [x, y] = [i % 60, i / 60].map(|i| 2.0 * (i as f32 - 29.5));
            let eye = MIDDLE - way * 300.0;
            let ray = Ray { origin: eye, direction: (MIDDLE + u * x + v * y - eye).normalize() };
            let both = (fast::surface(&field, &ray), march(&maps, &ray, false));
            let (Some(at), Some(sample)) = both else { continue };
            let off = solid.distance(at.position).abs();
            sum.hits += 1.0;
            sum.off += off;
            sum.farthest = sum.farthest.max(off);
            sum.fast += degrees(&at);
            sum.paper += degrees(&blobs(&maps, &ray, &sample));
        }
        sum
    };
    let sums: Vec<Errors> = ways(16).into_par_iter().map(from).collect();
    let all = sums.iter().fold(Errors::default(), |a, b| Errors {
        hits: a.hits + b.hits,
        off: a.off + b.off,
        farthest: a.farthest.max(b.farthest),
        fast: a.fast + b.fast,
        paper: a.paper + b.paper,
    });
    let mean = |sum: f32| sum / all.hits;
    let mean = Errors { off: mean(all.off), fast: mean(all.fast), paper: mean(all.paper), ..all };
    println!("{solid:?}: {mean:?}");
    assert!(mean.hits > 5000.0);
    mean
}

/// In the mean of what is seen from all around; and nowhere off by much more than half a voxel.
#[test]
fn a_spheres_surface_is_within_a_quarter_of_a_voxel() {
    for radius in [30.0, 43.3, 50.0] {
        let errors = errors(&sphere(radius));
        assert!(errors.off <= 0.25 && errors.farthest <= 0.55, "{errors:?}");
    }
}

#[test]
fn normals_err_a_quarter_as_much_as_the_papers() {
    for radius in [30.0, 50.0] {
        let errors = errors(&sphere(radius));
        assert!(errors.fast < 3.0 && errors.fast <= 0.25 * errors.paper, "{errors:?}");
    }
    let torus = Shape::Torus { ring: 38.0, tube: 16.0 };
    let rounded = Shape::Rounded { half: Vec3::new(45.0, 38.0, 30.0), radius: 12.0 };
    for shape in [torus, rounded] {
        for turn in turns() {
            let errors = errors(&Solid { shape, middle: MIDDLE, turn });
            assert!(errors.fast <= 0.25 * errors.paper, "{errors:?}");
        }
    }
}

/// From every side, near and far: where a ray that swings outwards last meets the fast surface.
#[test]
fn a_spheres_outline_is_a_circle() {
    for radius in [30.0, 50.0] {
        let (_, field) = textures::<N>(&sphere(radius).voxels(N));
        let views =
            ways(26).into_iter().flat_map(|way| [110.0, 300.0, 900.0].map(|far| (way, far)));
        let worst = views.par_bridge().map(|(way, far)| {
            let (u, v) = across(way);
            let squares = (0..180).map(|i| {
                let (sin, cos) = (2.0 * i as f32).to_radians().sin_cos();
                let off = |from_middle: f32| {
                    let slope = from_middle / far;
                    let ahead = way * (1.0 - slope * slope).sqrt();
                    let direction = ahead + (u * cos + v * sin) * slope;
                    fast::surface(&field, &Ray { origin: MIDDLE - way * far, direction }).is_none()
                };
                let (mut on_it, mut beside) = (radius - 2.0, radius + 2.0);
                assert!(!off(on_it) && off(beside));
                while beside - on_it > 0.002 {
                    let middle = 0.5 * (on_it + beside);
                    *(if off(middle) { &mut beside } else { &mut on_it }) = middle;
                }
                (on_it - radius).powi(2)
            });
            (squares.sum::<f32>() / 180.0).sqrt()
        });
        let worst = worst.reduce(|| 0.0, f32::max);
        println!("radius {radius}: {worst:.3} voxels in the worst view");
        assert!(worst < 0.15, "{worst}");
    }
}

const EXTENT: [u32; 2] = [240, 240];
/// What the picture shows on each side of its middle, in radians.
const FIELD: f32 = 0.35;

/// What part of each pixel a sphere covers at 4 samples, of radius 24 in 64 voxels, a voxel about
/// two and a half pixels wide: told by what shines through of two backdrops.
fn coverage(gpu: &paros_shaders::gpu::Context, eye: &Eye) -> Vec<f32> {
    let solid = Solid { middle: Vec3::splat(32.0), ..sphere(24.0) };
    let (_, field) = textures::<64>(&solid.voxels(64));
    let mut renderer =
        Renderer::new(gpu, Offscreen::format(4, 1, false), 64, &[]).expect("a renderer");
    let screen = Offscreen::new(gpu, &renderer, EXTENT).expect("images");
    field.whole(|region, bytes| renderer.load(region, bytes).expect("a device"));
    let [black, white] = [0.0, 1.0].map(|backdrop| {
        let picture = Picture {
            eyes: &[*eye],
            stand: Stand { foot: Vec3::ZERO, side: 1.0, turn: 0.3 },
            look: Look { path: Path::Fast, ..Look::default() },
            backdrop: [backdrop; 3],
            scene: None,
        };
        renderer.begin().expect("a device");
        renderer.draw(&picture, &screen.surface, 0, Sync::default()).expect("a device");
        gpu.wait().expect("a device");
        screen.pixels(0).expect("a device")
    });
    let linear = |byte: u8| {
        let c = f32::from(byte) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    black.iter().zip(&white).map(|(b, w)| 1.0 - (linear(w[1]) - linear(b[1]))).collect()
}

/// In single precision, and in halves as on a headset.
#[test]
fn an_outline_has_three_levels_of_coverage() {
    [true, false].into_iter().for_each(check_outline);
}

fn check_outline(single: bool) {
    let options = Options { validation: true, single, ..Options::default() };
    let Some(gpu) = require(Gpu::headless(&options)).expect("Vulkan") else { return };
    for (position, down) in [(Vec3::new(0.1, 0.5, 2.0), 0.0f32), (Vec3::new(0.0, 1.7, 1.6), 0.64)] {
        let fov = Fov { left: -FIELD, right: FIELD, up: FIELD, down: -FIELD };
        let eye = Eye { position, rotation: Quat::from_rotation_x(-down), fov };
        let middle = eye.rotation.inverse() * (Vec3::new(0.0, 0.5, 0.0) - position);
        // Pixels by eighths of the outline and quarters of coverage; what covers more than a pixel
        // whose middle the sphere covers, in pixels along the outline.
        let (mut levels, mut more) = ([[0; 5]; 8], 0.0);
        for (i, covered) in coverage(&gpu, &eye).into_iter().enumerate() {
            let level = 4.0 * covered;
            assert!((level - level.round()).abs() < 0.06, "{covered} of a pixel");
            let (beside, angle) = beside(middle, i as u32);
            more += covered - if beside < 0.0 { 1.0 } else { 0.0 };
            if beside.abs() > 1.5 {
                assert_eq!(level.round(), if beside < 0.0 { 4.0 } else { 0.0 }, "{beside} pixels");
            } else {
                levels[(8.0 * angle) as usize % 8][level.round() as usize] += 1;
            }
        }
        let round = std::f32::consts::TAU * (24.0 / 64.0) / middle.length() / pixel();
        println!("{levels:?}, {:.2} pixels out", more / round);
        for levels in levels {
            assert!(levels.iter().all(|&pixels| pixels > 0), "{levels:?}");
        }
        assert!((more / round).abs() < 0.4, "the outline is {} pixels off", more / round);
    }
    let messages = gpu.instance.messages();
    assert!(messages.is_empty(), "validation: {}", messages.join("\n"));
}

/// A pixel's width at a distance of one.
fn pixel() -> f32 {
    2.0 * FIELD.tan() / EXTENT[0] as f32
}

/// How far outside of the sphere's outline a pixel's middle lies, in pixels, and at which part of
/// the way around it; of a sphere whose middle the eye sees there.
fn beside(middle: Vec3, i: u32) -> (f32, f32) {
    let [x, y] = [i % EXTENT[0], i / EXTENT[0]].map(|c| c as f32 + 0.5);
    let [width, height] = EXTENT.map(|pixels| pixels as f32 / 2.0);
    let ray = Vec3::new((x - width) * pixel(), (height - y) * pixel(), -1.0).normalize();
    let away = ray * middle.dot(ray) - middle;
    let angle = away.y.atan2(away.x) / std::f32::consts::TAU + 0.5;
    ((away.length() - 24.0 / 64.0) / middle.length() / pixel(), angle)
}
