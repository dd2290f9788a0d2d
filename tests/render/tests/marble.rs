//! The components of the fast path's marble look: veins, highlights, edges and cavities.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `convexity.rs`: the means exchanged -> `edges_are_convex_and_creases_are_not`.
//! - `carrara.rs`: no hair lines and no veins -> `veins_run_in_one_direction`.
//! - `fast.rs`: a roughness of 0 -> `highlights_are_broad_where_the_stone_is_rough`.

use glam::Vec3;
use paros_models::dense::DenseVolume;
use paros_shaders::Ray;
use paros_shaders::carrara::{TEXTURE_SIDE, grey_texture_3d};
use paros_shaders::fast::{self, SunLight};
use paros_shaders::field::DensityField;
use paros_shaders::surface::SurfacePoint;
use paros_tests_render::view::build_maps_and_field;

fn field_of(occupied: impl Fn([i32; 3]) -> bool) -> Box<DensityField<128>> {
    build_maps_and_field::<128>(&DenseVolume::from_fn(128, occupied)).1
}

/// Tests the edge and the crease of a step, in a flight of steps up along x.
#[test]
fn edges_are_convex_and_creases_are_not() {
    let field = field_of(|[x, y, z]| y < 20 + 20 * (x / 40) && (10..110).contains(&z));
    let at = |x: f32, y: f32| field.sample_convexity(Vec3::new(x, y, 64.0));
    let (edge, crease, plane) = (at(40.5, 39.5), at(39.5, 20.5), at(60.0, 40.0));
    println!("edge {edge}, crease {crease}, plane {plane}");
    assert!(edge > 0.2 && crease < -0.2 && plane.abs() < 0.02, "{edge}, {crease}, {plane}");
}

/// Mostly white, with grey veins: the grey changes more across them than along them.
#[test]
fn veins_run_in_one_direction() {
    let grey = |[x, y, z]: [usize; 3]| {
        f32::from(grey_texture_3d()[(z * TEXTURE_SIDE + y) * TEXTURE_SIDE + x]) / 255.0
    };
    let places = || (0..20usize.pow(3)).map(|i| [i % 20, i / 20 % 20, i / 400].map(|c| 10 + 5 * c));
    let count = 20f32.powi(3);
    let mean = places().map(grey).sum::<f32>() / count;
    let veins = places().filter(|at| grey(*at) > 0.5).count() as f32 / count;
    assert!((0.05..0.3).contains(&mean) && (0.005..0.1).contains(&veins), "{mean}, {veins}");
    let change = |way: [i32; 3]| {
        let moved = |at: [usize; 3]| [0, 1, 2].map(|i| (at[i] as i32 + way[i]) as usize);
        places().map(|at| (grey(at) - grey(moved(at))).abs()).sum::<f32>() / count
    };
    // Distances of seven texels each: across the veins, and in two directions at right angles to that.
    let across = change([4, 4, -4]);
    let along = change([5, -5, 0]).max(change([3, 3, 6]));
    println!("{mean} grey, {veins} veins; {across} across and {along} along");
    assert!(across > 1.3 * along, "{across} across and {along} along");
}

/// Compares the sun's highlight of a plane with that of a plane with grooves three voxels wide, directly
/// under the sun and 30 degrees off.
#[test]
fn highlights_are_broad_where_the_stone_is_rough() {
    let smooth = field_of(|[_, y, _]| y < 64);
    let rough = field_of(|[x, y, _]| y < 64 - 3 * i32::from(x % 6 < 3));
    let (sin, cos) = 30f32.to_radians().sin_cos();
    // The highlight's addition to the light of places that all face upwards.
    let highlight = |field: &DensityField<128>, halfway: Vec3| {
        let shade = |position, halfway| {
            let at = SurfacePoint { position, normal: Vec3::Y, distance: 0.0 };
            let sun = SunLight { direction: Vec3::Y, color: Vec3::ONE, halfway };
            fast::shade_surface(field, &at, &sun, Vec3::ZERO).x
        };
        let place = |i: u16| {
            let [x, z] = [i % 20, i / 20].map(|c| 44.0 + 2.03 * f32::from(c));
            let ray = Ray { origin: Vec3::new(x, 90.0, z), direction: Vec3::NEG_Y };
            fast::find_surface(field, &ray).expect("a plane").position
        };
        let lights = (0..400).map(place).map(|at| shade(at, halfway) - shade(at, Vec3::NEG_Y));
        lights.sum::<f32>() / 400.0
    };
    let aside = |field: &DensityField<128>| {
        highlight(field, Vec3::new(sin, cos, 0.0)) / highlight(field, Vec3::Y)
    };
    let (smooth, rough) = (aside(&smooth), aside(&rough));
    println!("smooth {smooth}, rough {rough}");
    assert!(smooth < 0.15 && rough > 2.0 * smooth, "smooth {smooth}, rough {rough}");
}
