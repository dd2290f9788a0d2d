//! The lit room of the CPU's pictures.

use glam::Vec3;
use paros_core::RangeMaps;
use paros_models::twin::with_maps_of_ball;
use paros_shaders::constants::SUN_DIRECTION;
use paros_shaders::scene::{resting_placement, resting_studio};
use paros_shaders::{Camera, Image, LitRoom, Ray, RenderOptions, TwinScene, TwinSettings};
use paros_shaders::{lit_studio, render_image, render_image_in_room};

/// Returns a ray straight down from the top of the cube over the stool.
fn down(x: f32, z: f32) -> Ray {
    Ray { origin: Vec3::new(x, 1.0, z), direction: Vec3::NEG_Y }
}

#[test]
fn rays_meet_the_stool_and_the_floor() {
    let room = lit_studio();
    let depth = |x: f32, z: f32| room.cast_ray(&down(x, z)).expect("a floor").depth;
    let floor = 1.0 + room.stand.foot.y / room.stand.side;
    for (found, expected) in [(depth(0.57, 0.03), 1.0), (depth(-1.2, 0.8), floor)] {
        assert!((found - expected).abs() < 0.02, "{found}, not {expected}");
    }
}

/// Returns the sum of the stool's radiance under a place.
fn stool_light(room: &LitRoom, maps: &RangeMaps<64>, at: Vec3) -> f32 {
    let plain = TwinScene::new(maps, 0.0, TwinSettings::default());
    let scene = TwinScene { light: room.light, room: Some(room), ..plain };
    let hit = room.cast_ray(&down(at.x, at.z)).expect("the stool");
    room.shade(&scene, &hit).element_sum()
}

#[test]
fn the_sun_comes_through_the_window_and_the_sculpture_hides_it() {
    let (room, mut dark_room) = (lit_studio(), lit_studio());
    dark_room.light.sun_color = Vec3::ZERO;
    let sun = Vec3::from_array(SUN_DIRECTION);
    // The place of the shadow of a point over the stool's middle; for a negative height, a place towards the
    // sun, without shadow.
    let shadow = |height: f32| -Vec3::new(sun.x, 0.0, sun.z) * (height / sun.y);
    let empty = RangeMaps::<64>::new();
    with_maps_of_ball(|ball| {
        for (height, hides) in [(0.5, true), (-0.5, false)] {
            let at = shadow(height);
            let light = |room, maps| stool_light(room, maps, at);
            let [lit, with_ball] = [&empty, ball].map(|maps| light(&room, maps));
            let dark = light(&dark_room, &empty);
            assert!(lit > 1.5 * dark, "the sun shines on the stool: {lit}, {dark} without it");
            let expected = if hides { dark } else { lit };
            assert!((with_ball - expected).abs() < 0.02 * lit, "{with_ball} at {height}");
        }
    });
}

/// The room replaces the background, and the sculpture is drawn in the same place in other light.
#[test]
fn the_same_sculpture_is_drawn_in_the_room() {
    let options = RenderOptions { width: 48, height: 36, samples: 1, ..RenderOptions::default() };
    let camera = Camera::orbiting(0.4, 0.25);
    let [alone, in_room] = with_maps_of_ball(|maps| {
        [
            render_image(maps, &camera, &options, &|_| {}),
            render_image_in_room(maps, &camera, &options, &lit_studio(), &|_| {}),
        ]
    });
    assert!((0..48).all(|x| alone.pixel(x, 0) != in_room.pixel(x, 0)), "another background");
    let middle = in_room.pixel(24, 16);
    assert!(middle != alone.pixel(24, 16) && middle.iter().all(|part| *part > 90), "{middle:?}");
}

/// Hands and tools alone are drawn in the plain studio, which stays the same wherever none of them is
/// visible.
#[test]
fn hands_are_drawn_in_the_plain_studio() {
    let options = RenderOptions { width: 96, height: 72, samples: 1, ..RenderOptions::default() };
    let differing = |camera: &Camera, hands: &LitRoom| {
        with_maps_of_ball(|maps| {
            let plain = render_image(maps, camera, &options, &|_| {});
            let with_hands = render_image_in_room(maps, camera, &options, hands, &|_| {});
            let pixels = |image: Image| image.pixels.as_chunks::<3>().0.to_vec();
            let (plain, with_hands) = (pixels(plain), pixels(with_hands));
            plain.iter().zip(&with_hands).filter(|(a, b)| a != b).count()
        })
    };
    let hands = LitRoom::of_hands_in_studio(&resting_studio(), resting_placement());
    // The tools lie on the bench beside the stool.
    let near = Camera::orbiting(0.4, 0.25);
    assert!(differing(&near, &hands) < 96 * 72 / 100);
    let wide = Camera { angle: 1.2, ..near };
    assert!((20..96 * 72 / 5).contains(&differing(&wide, &hands)), "{}", differing(&wide, &hands));
}
