//! The smoothness of the fast path: surface, normals and outline of analytic solids, voxelised by the voxels'
//! centres.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `gradient.rs`: the narrow gradient alone -> `normals_have_no_terraces`; the wide gradient alone ->
//!   `grooves_keep_their_contrast`.
//! - `fast.rs`, `refine_hit`: the first sample inside is the surface -> `a_spheres_surface`.
//! - `fast.rs`: the surface where the density is 0.35 -> `a_spheres_surface`, `a_spheres_outline`.
//! - `blur.rs`: no blur along x -> `normals`.

use glam::{EulerRot, Quat, Vec3};
use paros_models::dense::DenseVolume;
use paros_models::solid::{Solid, SolidShape};
use paros_shaders::field::DensityField;
use paros_shaders::light::tangent_basis;
use paros_shaders::march::march_maps;
use paros_shaders::surface::{SurfacePoint, trace_blobs_or_closest_approach};
use paros_shaders::{Ray, fast};
use paros_tests_render::view::build_maps_and_field;
use rayon::prelude::*;

const N: usize = 128;
/// A centre off the lattice's points and planes.
const MIDDLE: Vec3 = Vec3::new(63.7, 62.2, 64.45);

fn sphere_solid(radius: f32) -> Solid {
    Solid { shape: SolidShape::Sphere { radius }, centre: MIDDLE, rotation: Quat::IDENTITY }
}

/// Returns two rotations: parallel to the axes, and oblique.
fn test_turns() -> [Quat; 2] {
    [Quat::IDENTITY, Quat::from_euler(EulerRot::YXZ, 0.5, 0.4, 0.3)]
}

/// Returns evenly distributed directions (a spiral).
fn sphere_directions(count: u32) -> Vec<Vec3> {
    let way = |i| {
        let y = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
        let (sin, cos) = (i as f32 * 2.399_963_2).sin_cos();
        let radius = (1.0 - y * y).sqrt();
        Vec3::new(radius * cos, y, radius * sin)
    };
    (0..count).map(way).collect()
}

/// Mean errors over views of a solid from all directions.
#[derive(Clone, Copy, Default, Debug)]
struct SmoothErrors {
    hits: f32,
    /// Errors of the fast surface's position in voxels: mean and maximum.
    off: f32,
    farthest: f32,
    /// Errors of the normals in degrees: of the fast path and of the paper's.
    fast: f32,
    paper: f32,
}

fn measure_errors(solid: &Solid) -> SmoothErrors {
    let (maps, field) = build_maps_and_field::<N>(&solid.to_voxels(N));
    let degrees = |at: &SurfacePoint| {
        let cos = at.normal.dot(solid.nearest_normal(at.position));
        cos.clamp(-1.0, 1.0).acos().to_degrees()
    };
    let from = |way: Vec3| {
        let ((u, v), mut sum) = (tangent_basis(way), SmoothErrors::default());
        for i in 0..60 * 60 {
            let [x, y] = [i % 60, i / 60].map(|i| 2.0 * (i as f32 - 29.5));
            let eye = MIDDLE - way * 300.0;
            let ray = Ray { origin: eye, direction: (MIDDLE + u * x + v * y - eye).normalize() };
            let both = (fast::find_surface(&field, &ray), march_maps(&maps, &ray));
            let (Some(at), Some(sample)) = both else { continue };
            let off = solid.signed_distance(at.position).abs();
            sum.hits += 1.0;
            sum.off += off;
            sum.farthest = sum.farthest.max(off);
            sum.fast += degrees(&at);
            sum.paper += degrees(&trace_blobs_or_closest_approach(&maps, &ray, &sample));
        }
        sum
    };
    let sums: Vec<SmoothErrors> = sphere_directions(16).into_par_iter().map(from).collect();
    let all = sums.iter().fold(SmoothErrors::default(), |a, b| SmoothErrors {
        hits: a.hits + b.hits,
        off: a.off + b.off,
        farthest: a.farthest.max(b.farthest),
        fast: a.fast + b.fast,
        paper: a.paper + b.paper,
    });
    let mean = |sum: f32| sum / all.hits;
    let mean =
        SmoothErrors { off: mean(all.off), fast: mean(all.fast), paper: mean(all.paper), ..all };
    println!("{solid:?}: {mean:?}");
    assert!(mean.hits > 5000.0);
    mean
}

/// Holds for the mean over views from all directions; no single hit is off by much more than half a voxel.
#[test]
fn a_spheres_surface_is_within_a_quarter_of_a_voxel() {
    for radius in [30.0, 43.3, 50.0] {
        let errors = measure_errors(&sphere_solid(radius));
        assert!(errors.off <= 0.25 && errors.farthest <= 0.55, "{errors:?}");
    }
}

#[test]
fn normals_err_a_quarter_as_much_as_the_papers() {
    for radius in [30.0, 50.0] {
        let errors = measure_errors(&sphere_solid(radius));
        assert!(errors.fast < 3.0 && errors.fast <= 0.25 * errors.paper, "{errors:?}");
    }
    let torus = SolidShape::Torus { ring: 38.0, tube: 16.0 };
    let rounded = SolidShape::Rounded { half: Vec3::new(45.0, 38.0, 30.0), radius: 12.0 };
    for shape in [torus, rounded] {
        for turn in test_turns() {
            let errors = measure_errors(&Solid { shape, centre: MIDDLE, rotation: turn });
            assert!(errors.fast <= 0.25 * errors.paper, "{errors:?}");
        }
    }
}

/// Returns the mean and the 95th percentile of angles in degrees.
fn mean_and_p95(mut degrees: Vec<f32>) -> [f32; 2] {
    assert!(degrees.len() > 3000);
    degrees.sort_by(f32::total_cmp);
    [degrees.iter().sum::<f32>() / degrees.len() as f32, degrees[degrees.len() * 95 / 100]]
}

/// Returns the errors of normals where rays that start at the distance `start` from a middle meet the surface
/// around it; the rays point outwards if they start inside.
fn normal_errors(
    field: &DensityField<N>,
    middle: Vec3,
    [start, outwards]: [f32; 2],
    ways: impl Iterator<Item = Vec3>,
) -> [f32; 2] {
    let error = |way: Vec3| {
        let ray = Ray { origin: middle + way * start, direction: way * outwards };
        let at = fast::find_surface(field, &ray).expect("a surface");
        at.normal.dot(way * -outwards).clamp(-1.0, 1.0).acos().to_degrees()
    };
    mean_and_p95(ways.map(error).collect())
}

#[test]
fn normals_have_no_terraces() {
    for radius in [12.0, 20.0, 28.0, 40.0, 56.0] {
        let (_, field) = build_maps_and_field::<N>(&sphere_solid(radius).to_voxels(N));
        let ways = sphere_directions(4000).into_iter();
        let [mean, most] = normal_errors(&field, MIDDLE, [radius + 5.0, -1.0], ways);
        println!(
            "a sphere of {radius}: {mean:.2} degrees in the mean, {most:.2} at the 95th percentile"
        );
        assert!(mean <= 0.9 && most <= 2.2, "{radius}: {mean}, {most}");
    }
    // A bowl in a block, seen from its centre, without its rim.
    let (radius, middle) = (70.0f32, Vec3::new(63.7, 130.2, 64.45));
    let bowl = DenseVolume::from_fn(N, |at| {
        let voxel = Vec3::from_array(at.map(|c| c as f32 + 0.5));
        at[1] < 120 && voxel.distance(middle) > radius
    });
    let (_, field) = build_maps_and_field::<N>(&bowl);
    let ways = sphere_directions(16000).into_iter().filter(|way| way.y < -0.6);
    let [mean, most] = normal_errors(&field, middle, [radius - 5.0, 1.0], ways);
    println!("a bowl of {radius}: {mean:.2} degrees in the mean, {most:.2} at the 95th percentile");
    assert!(mean <= 0.9 && most <= 2.2, "{mean}, {most}");
}

/// Compares the contrast of grooves two voxels wide in oblique light with the contrast of the four samples of
/// level 1 that a narrow normal uses.
#[test]
fn grooves_keep_their_contrast() {
    let light = Vec3::new(-0.68, 0.6, 0.42).normalize();
    let mut ratios = Vec::new();
    for (depth, first, turn) in
        [(2.0, 3.0, 0.0f32), (2.0, 4.0, 0.0), (3.0, 3.0, 0.0), (2.0, 3.0, 0.5), (3.0, 3.0, 0.785)]
    {
        let (sin, cos) = turn.sin_cos();
        let cut = DenseVolume::from_fn(N, |at| {
            let [x, y, z] = at.map(|c| c as f32 + 0.5);
            let across = (cos * x + sin * z - first).rem_euclid(12.0);
            y < if across < 2.0 { 64.0 - depth } else { 64.0 }
        });
        let (_, field) = build_maps_and_field::<N>(&cut);
        let (mut lit, mut narrow) = (Vec::new(), Vec::new());
        for i in 0..4000 {
            let [x, z] = [i % 80, i / 80].map(|i| 40.0 + 0.61 * i as f32);
            let ray = Ray { origin: Vec3::new(x, 80.0, z), direction: Vec3::NEG_Y };
            let at = fast::find_surface(&field, &ray).expect("the plane");
            lit.push(at.normal.dot(light));
            narrow.push(gradient_of_four(&field, at.position).dot(light));
        }
        let [lit, narrow] = [lit, narrow].map(|mut all| {
            all.sort_by(f32::total_cmp);
            all[all.len() * 98 / 100] - all[all.len() * 2 / 100]
        });
        ratios.push(lit / narrow);
        println!("{depth} deep from {first}, turned by {turn}: {lit:.3} for {narrow:.3}");
    }
    println!("{ratios:.2?}");
    assert!(ratios.iter().all(|ratio| (0.8..1.3).contains(ratio)), "{ratios:?}");
}

/// Returns the normal from four samples of level 1, at the corners of a tetrahedron.
fn gradient_of_four(field: &DensityField<N>, at: Vec3) -> Vec3 {
    let corners = [[1.0, -1.0, -1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0]];
    let sum: Vec3 = corners
        .map(Vec3::from_array)
        .map(|corner| -corner * field.sample_density(1, at + corner))
        .into_iter()
        .sum();
    sum.normalize()
}

/// Finds from every side, near and far, where a ray that swings outwards last meets the fast surface.
#[test]
fn a_spheres_outline_is_a_circle() {
    for radius in [30.0, 50.0] {
        let (_, field) = build_maps_and_field::<N>(&sphere_solid(radius).to_voxels(N));
        let views = sphere_directions(26)
            .into_iter()
            .flat_map(|way| [110.0, 300.0, 900.0].map(|far| (way, far)));
        let worst = views.par_bridge().map(|(way, far)| {
            let (u, v) = tangent_basis(way);
            let squares = (0..180).map(|i| {
                let (sin, cos) = (2.0 * i as f32).to_radians().sin_cos();
                let off = |from_middle: f32| {
                    let slope = from_middle / far;
                    let ahead = way * (1.0 - slope * slope).sqrt();
                    let direction = ahead + (u * cos + v * sin) * slope;
                    fast::find_surface(&field, &Ray { origin: MIDDLE - way * far, direction })
                        .is_none()
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
