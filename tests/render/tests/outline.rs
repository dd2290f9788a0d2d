//! The outline of the stone against the background, in the pictures that `paros render` draws.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `render.rs`: all of a pixel's rays through its corner -> `a_spheres_outline_is_smooth`.

use glam::{Quat, Vec3};
use paros_models::solid::{Solid, SolidShape};
use paros_shaders::render::tone_map_to_srgb;
use paros_shaders::{Camera, Image, Ray, RenderOptions, TwinSettings, fast, render_image};
use paros_tests_render::outline::check_profile;
use paros_tests_render::view::build_maps_and_field;

const SIDE: usize = 240;
const N: usize = 64;
const RADIUS: f32 = 24.0;

fn draw(voxels: &Solid, camera: &Camera) -> Image {
    let settings = TwinSettings { shading: false, ..TwinSettings::default() };
    let size = RenderOptions { width: SIDE, height: SIDE, settings, ..RenderOptions::default() };
    render_image(&build_maps_and_field::<N>(&voxels.to_voxels(N)).0, camera, &size, &|_| {})
}

/// Tests the upper half of a sphere's outline, above the stool.
#[test]
fn a_spheres_outline_is_smooth() {
    let sphere = |radius, centre| {
        let shape = SolidShape::Sphere { radius };
        Solid { shape, centre, rotation: Quat::IDENTITY }
    };
    let camera = Camera::orbiting(0.0, 0.0);
    let middle = Vec3::new(0.0, 0.5 - camera.height, -camera.distance);
    let pixel = 2.0 * (0.5 * camera.angle).tan() / SIDE as f32;
    let ahead = |[x, y]: [f32; 2]| {
        let half = SIDE as f32 / 2.0;
        Vec3::new((x - half) * pixel, (half - y) * pixel, -1.0).normalize()
    };
    let away = |at: [f32; 2]| ahead(at) * middle.dot(ahead(at)) - middle;
    let stone = sphere(RADIUS, Vec3::splat(32.0));
    let (_, field) = build_maps_and_field::<N>(&stone.to_voxels(N));
    let eye = (Vec3::new(0.5, camera.height, 0.5 + camera.distance)) * N as f32;
    let picture = draw(&stone, &camera);
    let without = draw(&sphere(1.0, Vec3::new(32.0, 3.0, 32.0)), &camera);
    let linear = |bytes: [u8; 3]| {
        let decode = |byte: u8| ((f32::from(byte) / 255.0 + 0.055) / 1.055).powf(2.4);
        Vec3::from_array(bytes.map(decode))
    };
    let covered = |i: usize| {
        let (x, y) = (i % SIDE, i / SIDE);
        let [seen, behind] = [&picture, &without].map(|image| linear(image.pixel(x, y)));
        let normal = away([x as f32 + 0.5, y as f32 + 0.5]).normalize();
        let stone = linear(tone_map_to_srgb(normal * 0.5 + Vec3::splat(0.5))) - behind;
        (seen - behind).dot(stone) / stone.length_squared()
    };
    let covered: Vec<f32> = (0..SIDE * SIDE).map(covered).collect();
    let beside = |at: [f32; 2]| {
        let away = away(at);
        let beside = (away.length() - RADIUS / N as f32) / middle.length() / pixel;
        if away.y > 0.02 { beside } else { f32::INFINITY }
    };
    let hits = |at: [f32; 2]| {
        fast::find_surface(&field, &Ray { origin: eye, direction: ahead(at) }).is_some()
    };
    check_profile(&covered, [SIDE as u32; 2], beside, hits);
}
