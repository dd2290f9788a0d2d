//! The cost of the drawing order, in fragments that the device shades: the sculpture between tools and room,
//! as in real frames, against the sculpture first and last. The test prints the numbers.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_core::session::{BenchItem, SessionMode, Tool};
use paros_models::scripted_hand::{RIGHT, take_item};
use paros_models::world_harness::WorldHarness;
use paros_shaders::field::DensityField;
use paros_shaders::gpu::{
    Eye, Fov, FragmentCounts, FrameRequest, Gpu, Options, PaperVariant, RenderPath, RenderStyle,
    SculptureOrder,
};
use paros_shaders::scene::{LatestInput, SKY, SceneAssembler};
use paros_shaders::upload::VolumeFormat;
use paros_shell::require::require_or_skip;
use paros_tests_vulkan::test_renderer::TestRenderer;

const N: usize = 64;

/// A visitor leans over the stone with the tool before it: the tool hides part of the sculpture, and the
/// sculpture part of the room.
#[test]
fn the_order_shades_less_than_the_others() {
    static STUDIO: Mutex<WorldHarness<N>> = Mutex::new(WorldHarness::new());
    let options = Options { validation: true, fragment_counts: true, ..Options::default() };
    let gpu = require_or_skip(Gpu::headless(&options)).expect("a Vulkan device and its validation");
    let Some(gpu) = gpu else { return };
    let counts = gpu.features.fragment_counts.then_some(()).ok_or("the device counts no fragments");
    let Some(()) = require_or_skip(counts).expect("a device that counts fragments") else { return };
    let mut studio = STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
    studio.start_session(SessionMode::FreeForm);
    take_item(&mut studio, RIGHT, BenchItem::Tool(Tool::Rotary));
    let mut field = Box::new(DensityField::<N>::new());
    field.rebuild_from(studio.world.volume().maps());
    let middle = STOOL_TOP + Vec3::Y * (0.5 * BOX_SIDE);
    let mut assemble_with_tool_at = |place: Vec3| {
        let grip = (middle + place, Quat::from_rotation_x(0.3));
        let fresh = LatestInput {
            grips: [None, Some(grip)],
            show_hands: true,
            tick_fraction: 1.0,
            ..LatestInput::default()
        };
        let mut scene = SceneAssembler::new();
        scene.assemble_frame(&studio.world, &fresh);
        scene
    };
    let [scene, tool_out_of_view] =
        [Vec3::new(0.05, 0.05, 0.36), 3.0 * Vec3::Z].map(&mut assemble_with_tool_at);
    let placement = scene.sculpture_placement();
    let eye = Eye {
        position: middle + Vec3::new(0.0, 0.15, 0.75),
        rotation: Quat::from_rotation_x(-0.2),
        fov: Fov { left: -0.6, right: 0.6, up: 0.5, down: -0.5 },
    };
    for path in [RenderPath::Fast, RenderPath::Paper(PaperVariant::Whole)] {
        for views in [1, 2] {
            let mut test_renderer =
                TestRenderer::new(&gpu, VolumeFormat::of::<N, 1>(), [1, views], [320, 240]);
            test_renderer.upload_field(&field);
            let picture = FrameRequest {
                eyes: &[eye; 2][..views as usize],
                placement,
                style: RenderStyle::in_studio(path),
                backdrop: SKY,
                scene: Some(scene.draw_list()),
                panels: &[],
            };
            let mut draw = |picture: &FrameRequest<'_>, order: SculptureOrder| {
                test_renderer.renderer.set_sculpture_order(order);
                (test_renderer.draw_picture(picture), test_renderer.renderer.fragment_counts())
            };
            let without_tool =
                FrameRequest { scene: Some(tool_out_of_view.draw_list()), ..picture };
            let tests_depth_first = draw(&without_tool, SculptureOrder::Last).1.surroundings
                > draw(&picture, SculptureOrder::Last).1.surroundings;
            let counts = tests_depth_first
                .then_some(())
                .ok_or("the device counts fragments before it tests their depth");
            let counts = require_or_skip(counts).expect("a device that tests depth early");
            let Some(()) = counts else { return };
            let [between, first, last] =
                [SculptureOrder::Between, SculptureOrder::First, SculptureOrder::Last]
                    .map(|order| draw(&picture, order));
            for (name, (layers, fragments)) in
                [("between", &between), ("first", &first), ("last", &last)]
            {
                println!("{path:?}, {views} views, {name}: {fragments:?}");
                assert!(*layers == between.0, "{name}: another picture");
            }
            check_counts(between.1, first.1, last.1);
        }
    }
}

fn check_counts(between: FragmentCounts, first: FragmentCounts, last: FragmentCounts) {
    assert!(between.sculpture > 0 && between.surroundings > 0);
    // Parts of the sculpture hidden by tools aren't shaded if the device tests the depth before it runs a
    // program that only moves the depth away; lavapipe tests it afterwards.
    assert!(between.sculpture <= first.sculpture, "{between:?} {first:?}");
    // If the room is drawn before the sculpture, the parts behind the sculpture are shaded for nothing.
    assert!(between.surroundings < last.surroundings, "{between:?} {last:?}");
}
