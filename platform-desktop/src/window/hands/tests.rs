//! Tests of the hands in a world of side 128.

use std::sync::MutexGuard;

use glam::Vec3;
use paros_core::limits::{FULL_TRIGGER, INTERVALS};
use paros_core::session::{
    BenchItem, PointerCommand, SessionMode, SessionState, Tool, ToolBit, commands,
};
use paros_core::volume::{Axis, Grid};
use paros_core::{RangeMaps, TickInput, World};
use paros_shaders::Ray;
use paros_shaders::scene::MeshId;
use paros_shaders::scene::placing::display_pose_unless_held_or_mounted;
use paros_shell::statics::{Resident, WorldWithStarts};
use paros_shell::tick_runner::TickRunner;

use super::bit_guide::ray_from_room_to_grid;
use super::{HandAction, HandButton, InputEvent, LIGHT_TRIGGER, MouseHands, RIGHT};
use crate::window::raycast::cast_ray;

mod newcomer;
mod strokes;

const SIZE: [u32; 2] = [1000, 700];

/// Hands in a world of side 128, locked for one test at a time.
struct HandsFixture {
    hands: MouseHands<128>,
    resident: MutexGuard<'static, WorldWithStarts<128, INTERVALS>>,
}

impl HandsFixture {
    fn new(mode: SessionMode) -> Self {
        let mut resident = Grid::<128>::lock_world();
        resident.generate_starts();
        resident.world.clear();
        let mut hands = MouseHands::new();
        hands.size = SIZE;
        hands.start_session(mode);
        let mut fixture = HandsFixture { hands, resident };
        fixture.ticks(3);
        assert_eq!(fixture.resident.world.session_state(), SessionState::Sculpting);
        fixture
    }

    fn tick(&mut self) -> TickInput {
        let WorldWithStarts { start_volumes, world } = &mut *self.resident;
        let input = self.hands.next_input(world);
        let hidden = start_volumes.hidden_figures();
        TickRunner::new(world, start_volumes.start_volumes(&hidden)).run_tick(&input);
        input
    }

    fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            self.tick();
        }
    }

    fn handle(&mut self, event: InputEvent) {
        self.hands.handle_event(event, &self.resident.world);
    }

    fn tap_key_and_tick(&mut self, key: HandAction) {
        self.handle(InputEvent::Key(key, true));
        self.handle(InputEvent::Key(key, false));
        self.ticks(2);
    }

    fn held(&self) -> (Tool, ToolBit) {
        self.resident.world.held_tool(RIGHT).expect("something is held")
    }

    fn voxel_count(&self) -> u64 {
        self.resident.world.volume().count_voxels()
    }

    fn digest(&self) -> u64 {
        self.resident.world.volume().digest()
    }

    /// Returns the distance from the eye to the stone behind each pixel, in voxels.
    fn surface_depths(&self, pixels: impl Iterator<Item = [f32; 2]>) -> Vec<f32> {
        let hits = pixels.map(|pixel| {
            let room_ray = self.hands.orbit.room_ray_through_pixel(pixel, SIZE);
            let grid_ray = ray_from_room_to_grid(&room_ray, &self.resident.world);
            cast_ray(self.resident.world.volume().maps(), &grid_ray).expect("stone").distance_voxels
        });
        hits.collect()
    }
}

/// Returns the occupied voxels of `a` that are not in `b`.
fn voxels_missing(a: &RangeMaps<128, INTERVALS>, b: &RangeMaps<128, INTERVALS>) -> Vec<Vec3> {
    let mut voxels = Vec::new();
    for y in 0..128 {
        for z in 0..128 {
            let column = a.column(Axis::X, (y, z));
            for x in (0..128).filter(|x| column.contains(*x)) {
                if a.contains([x, y, z]) && !b.contains([x, y, z]) {
                    voxels.push(Vec3::new(x as f32, y as f32, z as f32) + 0.5);
                }
            }
        }
    }
    voxels
}

#[test]
fn a_drag_looks_around_what_is_finished_and_cuts_nothing() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    fixture.hands.queue_commands(commands::FINISH);
    fixture.ticks(200);
    assert_eq!(fixture.resident.world.session_state(), SessionState::Finished);
    let (digest, from) = (fixture.digest(), fixture.hands.orbit);
    fixture.handle(InputEvent::Moved([500.0, 350.0]));
    fixture.handle(InputEvent::Pressed(HandButton::Left));
    fixture.handle(InputEvent::Moved([600.0, 350.0]));
    fixture.ticks(3);
    let turned = fixture.hands.orbit;
    assert!(turned.azimuth != from.azimuth && fixture.digest() == digest);
    fixture.handle(InputEvent::Released(HandButton::Left));
    fixture.handle(InputEvent::Moved([700.0, 350.0]));
    assert_eq!(fixture.hands.orbit, turned, "the button is up");
    let depth_mm = fixture.hands.depth_mm(&fixture.resident.world);
    fixture.handle(InputEvent::Wheel(2.0));
    assert!(fixture.hands.orbit.distance < turned.distance, "there is no depth to choose");
    assert_eq!(fixture.hands.depth_mm(&fixture.resident.world), depth_mm);
    fixture.handle(InputEvent::Pressed(HandButton::Middle));
    fixture.handle(InputEvent::Moved([600.0, 350.0]));
    assert!(fixture.hands.orbit.azimuth != turned.azimuth, "the stool stands still");
}

#[test]
fn a_press_carves_under_the_cursor_and_undo_brings_it_back() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    fixture.handle(InputEvent::Moved([480.0, 330.0]));
    fixture.ticks(10);
    let (before, untouched) = (Box::new(copy_maps(&fixture)), fixture.digest());
    fixture.handle(InputEvent::Pressed(HandButton::Left));
    fixture.ticks(20);
    fixture.handle(InputEvent::Released(HandButton::Left));
    fixture.ticks(2);
    let removed = voxels_missing(&before, fixture.resident.world.volume().maps());
    assert!(removed.len() > 50, "{} voxels", removed.len());
    let Ray { origin, direction } =
        fixture.hands.orbit.room_ray_through_pixel([480.0, 330.0], SIZE);
    let frame = fixture.resident.world.stool_frame();
    for voxel in removed {
        let pose = paros_core::edit::Pose { position: voxel, ..paros_core::edit::Pose::ZERO };
        let (point, _) = frame.to_room(&pose);
        let aside = (point - origin).cross(direction).length();
        assert!(aside < 0.02, "{aside} m beside the cursor");
    }
    fixture.tap_key_and_tick(HandAction::Undo);
    assert_eq!(fixture.digest(), untouched);
    fixture.tap_key_and_tick(HandAction::Redo);
    assert_ne!(fixture.digest(), untouched);
}

fn copy_maps(fixture: &HandsFixture) -> RangeMaps<128, INTERVALS> {
    let mut maps = RangeMaps::new();
    maps.copy_from(fixture.resident.world.volume().maps());
    maps
}

#[test]
fn the_wheel_up_makes_a_stroke_deeper() {
    let removed = |notches: f32| {
        let mut fixture = HandsFixture::new(SessionMode::FreeForm);
        fixture.handle(InputEvent::Moved([480.0, 330.0]));
        fixture.handle(InputEvent::Wheel(notches));
        fixture.ticks(10);
        let before = fixture.voxel_count();
        fixture.handle(InputEvent::Pressed(HandButton::Left));
        fixture.ticks(60);
        before - fixture.voxel_count()
    };
    let (off, usual, deep) = (removed(-18.0), removed(0.0), removed(8.0));
    assert_eq!(off, 0, "held off the surface it carves nothing");
    assert!(usual > 50 && deep > usual * 3 / 2, "{usual} and {deep}");
}

#[test]
fn a_tool_at_rest_touches_nothing_and_never_stays_behind() {
    let mut fixture = HandsFixture::new(SessionMode::Creative);
    let untouched = fixture.digest();
    let mut seed = 11u32;
    let mut random = |below: f32| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 24) as f32 * below
    };
    for round in 0..60 {
        fixture.handle(InputEvent::Moved([300.0 + random(400.0), 100.0 + random(500.0)]));
        if round % 6 == 0 {
            fixture.handle(InputEvent::Pressed(HandButton::Right));
            fixture.handle(InputEvent::Moved([random(1000.0), 100.0 + random(500.0)]));
            fixture.handle(InputEvent::Released(HandButton::Right));
            fixture.handle(InputEvent::Moved([300.0 + random(400.0), 100.0 + random(500.0)]));
        }
        fixture.ticks(45);
        let hand = fixture.resident.world.hand_state(RIGHT);
        let behind = (hand.raw_pose.position - hand.frozen_pose.position).length();
        assert!(behind < 8.0, "{behind} voxels behind in round {round}");
    }
    assert_eq!(fixture.digest(), untouched);
}

#[test]
fn keys_choose_tools_and_bits() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    assert_eq!(fixture.held(), (Tool::Rotary, ToolBit::MediumBall));
    fixture.tap_key_and_tick(HandAction::NextBit);
    assert_eq!(fixture.held().1, ToolBit::LargeBall);
    fixture.tap_key_and_tick(HandAction::PreviousBit);
    fixture.tap_key_and_tick(HandAction::PreviousBit);
    fixture.tap_key_and_tick(HandAction::PreviousBit);
    assert_eq!(fixture.held().1, ToolBit::DiscSaw, "they go round");
    fixture.tap_key_and_tick(HandAction::Bit(3));
    assert_eq!(fixture.held().1, ToolBit::Cylinder);
    fixture.tap_key_and_tick(HandAction::Bit(8));
    assert_eq!(fixture.held().1, ToolBit::Cylinder, "there is no ninth");
    let size = |fixture: &HandsFixture| {
        fixture.resident.world.workbench().size_of(ToolBit::Cylinder).steps()
    };
    fixture.tap_key_and_tick(HandAction::Smaller);
    fixture.tap_key_and_tick(HandAction::Smaller);
    assert_eq!(size(&fixture), -2);
    assert_eq!(
        fixture.hands.depth_mm(&fixture.resident.world),
        6.0,
        "as a smaller bit goes less deep"
    );
    fixture.tap_key_and_tick(HandAction::Larger);
    assert_eq!(size(&fixture), -1);
    for (number, tool) in Tool::ALL.into_iter().enumerate().rev() {
        fixture.tap_key_and_tick(HandAction::Tool(number as u8));
        assert_eq!(fixture.held().0, tool);
    }
    fixture.tap_key_and_tick(HandAction::Mirror);
    assert!(fixture.resident.world.is_mirrored());
    for string_mm in [20, 0] {
        fixture.tap_key_and_tick(HandAction::Steady);
        assert_eq!(fixture.resident.world.string_mm(), string_mm);
    }
}

/// Returns the vertices of a tool or bit by the scene's meshes and poses, without a mounted bit.
fn drawn_tool_vertices(world: &World<128, INTERVALS>, item: BenchItem) -> Vec<Vec3> {
    let pose = display_pose_unless_held_or_mounted(world.workbench(), item);
    let (position, rotation) = pose.expect("it rests");
    let mesh = match item {
        BenchItem::Tool(tool) => MeshId::of_tool(tool),
        BenchItem::Bit(bit) => MeshId::of_bit(bit),
    };
    let vertices = mesh.vertices().iter();
    vertices.map(|vertex| position + rotation * Vec3::from_array(vertex.position)).collect()
}

/// Turns the camera to the bench and moves the cursor to the middle of an item's drawn body.
fn point_at_item(fixture: &mut HandsFixture, item: BenchItem) {
    fixture.hands.orbit.azimuth = 0.6;
    fixture.hands.orbit.distance = 2.0;
    let body = drawn_tool_vertices(&fixture.resident.world, item);
    let middle = body.iter().sum::<Vec3>() / body.len() as f32;
    let point = fixture.hands.orbit.project_point(middle, SIZE).expect("it is before the eye");
    fixture.handle(InputEvent::Moved(point.pixel));
}

#[test]
fn a_click_on_the_bench_takes_what_is_drawn_there() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    let untouched = fixture.digest();
    for tool in [Tool::Impact, Tool::FillGun, Tool::Rasp, Tool::Rotary] {
        point_at_item(&mut fixture, BenchItem::Tool(tool));
        assert_eq!(
            fixture.hands.pointed_item(&fixture.resident.world),
            Some(BenchItem::Tool(tool))
        );
        fixture.handle(InputEvent::Pressed(HandButton::Left));
        assert!(!fixture.hands.running, "a click on the bench is no stroke");
        fixture.handle(InputEvent::Released(HandButton::Left));
        fixture.ticks(30);
        assert_eq!(fixture.held().0, tool);
    }
    assert_eq!(fixture.digest(), untouched);
}

#[test]
fn both_ends_of_a_drawn_body_are_its_own_and_the_bench_beside_it_is_nobodys() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    let item = BenchItem::Tool(Tool::Rasp);
    point_at_item(&mut fixture, item);
    let body = drawn_tool_vertices(&fixture.resident.world, item);
    let end = |sign: f32| {
        let far = body.iter().copied().max_by(|a, b| (sign * a.x).total_cmp(&(sign * b.x)));
        far.expect("it has vertices")
    };
    for point in [end(1.0), end(-1.0)] {
        let seen = fixture.hands.orbit.project_point(point, SIZE).expect("it is before the eye");
        fixture.handle(InputEvent::Moved(seen.pixel));
        assert_eq!(fixture.hands.pointed_item(&fixture.resident.world), Some(item), "{point}");
    }
    // A point beyond the end that has no bit.
    let beside = end(-1.0) - Vec3::new(0.05, 0.0, 0.0);
    let seen = fixture.hands.orbit.project_point(beside, SIZE).expect("it is before the eye");
    fixture.handle(InputEvent::Moved(seen.pixel));
    assert_eq!(fixture.hands.pointed_item(&fixture.resident.world), None);
}

#[test]
fn a_click_on_another_tools_bit_takes_the_tool_with_it() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    assert_eq!(fixture.held().0, Tool::Rotary);
    point_at_item(&mut fixture, BenchItem::Bit(ToolBit::FlatChisel));
    fixture.handle(InputEvent::Pressed(HandButton::Left));
    fixture.handle(InputEvent::Released(HandButton::Left));
    fixture.ticks(30);
    assert_eq!(fixture.held(), (Tool::Impact, ToolBit::FlatChisel));
}

#[test]
fn drags_and_keys_turn_the_eye_and_the_stool() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    let eye = fixture.hands.orbit;
    fixture.handle(InputEvent::Moved([500.0, 300.0]));
    fixture.handle(InputEvent::Pressed(HandButton::Right));
    fixture.handle(InputEvent::Moved([560.0, 330.0]));
    fixture.handle(InputEvent::Released(HandButton::Right));
    assert!(
        fixture.hands.orbit.azimuth < eye.azimuth && fixture.hands.orbit.elevation > eye.elevation
    );
    let turned = |input: TickInput| match input.pointer {
        PointerCommand::Turn { by } => i32::from(by),
        _ => 0,
    };
    fixture.handle(InputEvent::Moved([100.0, 300.0]));
    fixture.handle(InputEvent::Pressed(HandButton::Middle));
    fixture.handle(InputEvent::Moved([600.0, 300.0]));
    fixture.handle(InputEvent::Released(HandButton::Middle));
    fixture.handle(InputEvent::Moved([300.0, 300.0]));
    // A drag over half the picture is half a turn, spread over several ticks.
    assert_eq!((0..8).map(|_| turned(fixture.tick())).sum::<i32>(), 32_768);
    fixture.handle(InputEvent::Key(HandAction::Turn { left: true }, true));
    assert_eq!((0..72).map(|_| turned(fixture.tick())).sum::<i32>(), -72 * 227);
    fixture.handle(InputEvent::LetGo);
    assert_eq!(turned(fixture.tick()), 0);
    let near = fixture.hands.orbit.distance;
    fixture.handle(InputEvent::Key(HandAction::Nearer, true));
    assert!(fixture.hands.orbit.distance < near);
}

#[test]
fn a_start_comes_alone_and_commands_act_once() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    fixture.hands.queue_commands(commands::SYMMETRY);
    fixture.hands.start_session(SessionMode::Creative);
    let input = fixture.tick();
    assert_eq!((input.start, input.commands), (SessionMode::Creative, 0));
    fixture.hands.queue_commands(commands::SYMMETRY);
    assert_eq!(fixture.tick().commands, commands::SYMMETRY);
    assert_eq!(fixture.tick().commands, 0);
    assert_eq!(fixture.held().0, Tool::Rotary);
    // Without a cursor the hand rests and the tool does nothing.
    fixture.handle(InputEvent::Pressed(HandButton::Left));
    assert_eq!(fixture.tick().hands[RIGHT].trigger, 0);
}

/// Shift pulls the trigger only partly, until the stroke's end.
#[test]
fn shift_pulls_the_trigger_lightly() {
    let mut fixture = HandsFixture::new(SessionMode::FreeForm);
    fixture.handle(InputEvent::Moved([400.0, 300.0]));
    for (is_light, pulled) in [(false, 255), (true, LIGHT_TRIGGER), (false, 255)] {
        fixture.handle(InputEvent::Lightly(is_light));
        fixture.handle(InputEvent::Pressed(HandButton::Left));
        assert_eq!(fixture.tick().hands[RIGHT].trigger, pulled);
    }
    assert!((128..FULL_TRIGGER).contains(&LIGHT_TRIGGER));
}
