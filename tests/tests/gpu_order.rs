//! What the order of drawing comes to, in fragments that the device shades: the sculpture between
//! tools and room, as frames have it, against the sculpture first and last. The figures are printed.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::frame::{BOX, STOOL};
use paros_core::input::Mode;
use paros_core::tools::Tool;
use paros_core::workbench::Item;
use paros_shaders::field::Field;
use paros_shaders::gpu::{
    Eye, Fov, Fragments, Gpu, Look, Options, Order, Parts, Path, Picture, Stand,
};
use paros_shaders::scene::{Assembly, Fresh, SKY};
use paros_shell::require::require;
use paros_tests::models::desk::Desk;
use paros_tests::models::puppet::{RIGHT, take};
use paros_tests::models::studio::Studio;

const N: usize = 64;

/// A visitor who leans over the stone, the tool before it: it hides some of the sculpture, and the
/// sculpture some of the room.
#[test]
fn the_order_shades_less_than_the_others() {
    static STUDIO: Mutex<Studio<N>> = Mutex::new(Studio::new());
    let options = Options { validation: true, fragment_counts: true, ..Options::default() };
    let gpu = require(Gpu::headless(&options)).expect("a Vulkan device and its validation");
    let Some(gpu) = gpu else { return };
    let counts = gpu.needs.fragment_counts.then_some(()).ok_or("the device counts no fragments");
    let Some(()) = require(counts).expect("a device that counts fragments") else { return };
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    studio.start(Mode::FreeForm);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    let mut field = Box::new(Field::<N>::new());
    field.rebuild(studio.world.volume().maps());
    let middle = STOOL + Vec3::Y * (0.5 * BOX);
    let grip = (middle + Vec3::new(0.05, 0.05, 0.36), Quat::from_rotation_x(0.3));
    let fresh = Fresh { grips: [None, Some(grip)], hands: true, fraction: 1.0, time: 0.0 };
    let mut scene = Assembly::new();
    scene.assemble(&studio.world, &fresh);
    let pose = scene.sculpture();
    let eye = Eye {
        position: middle + Vec3::new(0.0, 0.15, 0.75),
        rotation: Quat::from_rotation_x(-0.2),
        fov: Fov { left: -0.6, right: 0.6, up: 0.5, down: -0.5 },
    };
    for path in [Path::Fast, Path::Paper(Parts::Whole)] {
        for views in [1, 2] {
            let mut desk = Desk::new(&gpu, N, [1, views], [320, 240]);
            desk.load(&field);
            let picture = Picture {
                eyes: &[eye; 2][..views as usize],
                stand: Stand { foot: pose.foot, side: pose.side, turn: pose.turn },
                look: Look::studio(path),
                backdrop: SKY,
                scene: Some(scene.list()),
            };
            let mut draw = |order: Order| {
                desk.renderer.draw_in(order);
                (desk.draw(&picture), desk.renderer.fragments())
            };
            let [between, first, last] = [Order::Between, Order::First, Order::Last].map(&mut draw);
            for (name, (layers, fragments)) in
                [("between", &between), ("first", &first), ("last", &last)]
            {
                println!("{path:?}, {views} views, {name}: {fragments:?}");
                assert!(*layers == between.0, "{name}: another picture");
            }
            check(between.1, first.1, last.1);
        }
    }
}

fn check(between: Fragments, first: Fragments, last: Fragments) {
    assert!(between.sculpture > 0 && between.standing > 0);
    // What tools hide of the sculpture is not shaded where the device tests the depth of a program
    // that moves it away before it runs; lavapipe doesn't.
    assert!(between.sculpture <= first.sculpture, "{between:?} {first:?}");
    // What stands behind the sculpture is shaded for nothing before it.
    assert!(between.standing < last.standing, "{between:?} {last:?}");
}
