//! Hands, bench and stool: what is taken, dropped and turned, and that none of it sweeps.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::events::Event;
use paros_core::frame::{BOX, STOOL};
use paros_core::input::{HandInput, Input, Mode, Pointer, RawPose, TICK_RATE};
use paros_core::pose::Pose;
use paros_core::tools::{Bit, Tool};
use paros_core::workbench::{BENCH_TOP, Item, Place};
use paros_tests::models::dense::Dense;
use paros_tests::models::puppet::{
    LEFT, RIGHT, floor, hand_at, reach, squeeze, take, voxels, with,
};
use paros_tests::models::studio::Studio;
use paros_tests::models::visitor::at;

static STUDIO: Mutex<Studio<64>> = Mutex::new(Studio::new());

fn studio() -> MutexGuard<'static, Studio<64>> {
    STUDIO.lock().unwrap_or_else(PoisonError::into_inner)
}

#[test]
fn each_hand_takes_exchanges_and_returns_tools() {
    let mut studio = studio();
    for (hand, other) in [(LEFT, RIGHT), (RIGHT, LEFT)] {
        studio.start(Mode::FreeForm);
        let (rotary, gun) = (Item::Tool(Tool::Rotary), Item::Tool(Tool::FillGun));
        let events = squeeze(&mut studio, hand, rotary.home());
        assert_eq!(events, [Event::Took { hand: hand as u8, item: rotary }]);
        assert_eq!(studio.world.held(hand), Some((Tool::Rotary, Bit::MediumBall)));
        assert_eq!(studio.world.bench().pose(rotary), None);
        // Another tool in reach: the first goes home.
        squeeze(&mut studio, hand, gun.home());
        assert_eq!(studio.world.held(hand), Some((Tool::FillGun, Bit::Nozzle)));
        assert_eq!(studio.world.bench().place(rotary), Place::Home);
        // What one hand holds, the other can't find on the bench.
        assert_eq!(squeeze(&mut studio, other, gun.home()), []);
        // By the pointer it changes hands.
        take(&mut studio, other, gun);
        assert_eq!(
            (studio.world.held(hand), studio.world.held(other)),
            (None, Some((Tool::FillGun, Bit::Nozzle)))
        );
        // Let go at its own place.
        let events = squeeze(&mut studio, other, gun.home());
        assert_eq!(events, [Event::Released { hand: other as u8, tool: Tool::FillGun }]);
        assert_eq!(studio.world.bench().place(gun), Place::Home);
        // Out of reach of everything, nothing is taken.
        assert_eq!(squeeze(&mut studio, hand, STOOL), []);
    }
}

#[test]
fn bits_are_mounted_on_their_own_tool() {
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    let grinder = Item::Bit(Bit::Grinder);
    assert_eq!(squeeze(&mut studio, LEFT, grinder.home()), [], "no tool to put it on");
    take(&mut studio, LEFT, Item::Tool(Tool::Impact));
    take(&mut studio, LEFT, grinder);
    assert_eq!(studio.world.held(LEFT), Some((Tool::Impact, Bit::PointChisel)));
    squeeze(&mut studio, RIGHT, Item::Tool(Tool::Rotary).home());
    let events = squeeze(&mut studio, RIGHT, grinder.home());
    assert_eq!(events, [Event::Took { hand: 1, item: grinder }]);
    assert_eq!(studio.world.held(RIGHT), Some((Tool::Rotary, Bit::Grinder)));
    assert_eq!(studio.world.bench().place(Item::Bit(Bit::MediumBall)), Place::Home);
    assert_eq!(studio.world.bench().place(grinder), Place::Mounted);
    // It stays mounted on the bench.
    studio.step(&Input { pointer: Pointer::Return { hand: 1 }, ..Input::default() });
    assert_eq!(studio.world.events(), [Event::Returned { hand: 1, tool: Tool::Rotary }]);
    assert_eq!(studio.world.held(RIGHT), None);
    take(&mut studio, LEFT, Item::Tool(Tool::Rotary));
    assert_eq!(studio.world.held(LEFT), Some((Tool::Rotary, Bit::Grinder)));
    for item in 0..=255 {
        studio.step(&Input { pointer: Pointer::Take { hand: 7, item }, ..Input::default() });
    }
}

#[test]
fn what_is_dropped_falls_lies_and_is_back_within_ten_seconds() {
    let mut studio = studio();
    let item = Item::Tool(Tool::Rasp);
    for (place, rest) in [(Vec3::new(0.0, 1.2, 0.3), 0.03), (Vec3::new(0.5, 1.3, 0.15), BENCH_TOP)]
    {
        studio.start(Mode::FreeForm);
        take(&mut studio, RIGHT, item);
        let events = squeeze(&mut studio, RIGHT, place);
        assert_eq!(events, [Event::Released { hand: 1, tool: Tool::Rasp }]);
        let mut height = place.y;
        let mut fell = 0;
        while matches!(studio.world.bench().place(item), Place::Falling(_)) {
            let (position, _) = studio.world.bench().pose(item).expect("it is in the room");
            assert!(position.y < height);
            height = position.y;
            studio.step(&Input::default());
            fell += 1;
        }
        let metres = place.y - rest;
        let seconds = (2.0 * metres / 9.81).sqrt();
        assert!((fell as f32 / TICK_RATE as f32 - seconds).abs() < 0.05, "fell for {fell} ticks");
        let (position, _) = studio.world.bench().pose(item).expect("it lies there");
        assert!(position.distance(Vec3::new(place.x, rest, place.z)) < 1e-4, "{position}");
        // It can be picked up from there, and dropped again.
        let events = squeeze(&mut studio, LEFT, position);
        assert_eq!(events, [Event::Took { hand: 0, item }]);
        squeeze(&mut studio, LEFT, place);
        for _ in 0..10 * TICK_RATE + 60 {
            studio.step(&Input::default());
        }
        assert_eq!(studio.world.bench().place(item), Place::Home);
    }
}

#[test]
fn the_stool_turns_and_takes_contact_and_edits_along() {
    let mut studio = studio();
    for turn in [0i16, 16_384, -16_384, 5000, i16::MIN] {
        floor(&mut studio, 30);
        studio.step(&Input { pointer: Pointer::Turn { by: turn }, ..Input::default() });
        take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
        let before = voxels(&studio);
        // A place in the room, the same for every turn.
        let tip = STOOL + Vec3::new(0.1, 31.0 / 64.0 * BOX, -0.05);
        let grip = tip + Vec3::Z * Tool::Rotary.length() as f32 * 1e-6;
        // From above: the push-out is in the room, up.
        studio.step(&with(RIGHT, hand_at(grip + Vec3::Y * 0.1)));
        studio.step(&with(RIGHT, hand_at(grip)));
        let out = studio.world.push_out(RIGHT);
        assert!(out.y > 0.001 && out.x.abs() < 1e-4 && out.z.abs() < 1e-4, "{turn}: {out}");
        for _ in 0..3 {
            studio.step(&with(RIGHT, HandInput { trigger: 255, ..hand_at(grip) }));
        }
        let angle = f32::from(turn) / 65_536.0 * std::f32::consts::TAU;
        let expected = Quat::from_rotation_y(-angle) * Vec3::new(0.1, 0.0, -0.05) / BOX * 64.0
            + Vec3::new(32.0, 31.0, 32.0);
        let raw = studio.world.hand(RIGHT).raw.position;
        assert!(raw.distance(expected) < 0.05, "{turn}: {raw}, not {expected}");
        let gone = before.without(&voxels(&studio));
        assert!(gone.count() > 5, "{turn}: {} voxels", gone.count());
        for voxel in gone.occupied() {
            let centre = Vec3::from_array(voxel.map(|i| i as f32 + 0.5));
            assert!(centre.distance(expected) < 4.0, "{turn}: {voxel:?} is far from {expected}");
        }
    }
}

#[test]
fn a_stick_turns_the_stool_a_quarter_turn_a_second() {
    let mut studio = studio();
    studio.start(Mode::FreeForm);
    let zero = studio.world.frame();
    for _ in 0..TICK_RATE {
        studio.step(&with(LEFT, HandInput { stick: [127, 0], ..hand_at(STOOL) }));
    }
    let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let (_, turned) = studio.world.frame().to_room(&Pose::ZERO);
    assert!(turned.angle_between(quarter) < 0.02, "{turned}");
    // Not by a hand that is out of sight, nor by a stick at rest.
    let still = studio.world.frame();
    studio.step(&with(LEFT, HandInput { stick: [127, 0], tracked: false, ..hand_at(STOOL) }));
    studio.step(&with(LEFT, HandInput { stick: [20, 127], ..hand_at(STOOL) }));
    assert_eq!(studio.world.frame(), still);
    assert_ne!(still, zero);
}

/// A stone held against a turning stool is turned as on a lathe: the tool stands, the edit sweeps.
#[test]
fn a_tool_at_rest_carves_the_turning_stone() {
    let mut studio = studio();
    floor(&mut studio, 30);
    take(&mut studio, RIGHT, Item::Tool(Tool::Rotary));
    let tip = STOOL + Vec3::new(0.15, 31.0 / 64.0 * BOX, 0.0);
    let grip = tip + Vec3::Z * Tool::Rotary.length() as f32 * 1e-6;
    let full = studio.world.volume().count();
    for _ in 0..5 * TICK_RATE {
        let hand = HandInput { trigger: 255, stick: [127, 0], ..hand_at(grip) };
        studio.step(&with(RIGHT, hand));
        studio.check();
    }
    let ring = voxels(&studio);
    let radius = 0.15 / BOX * 64.0;
    for i in 0..64 {
        let angle = i as f32 / 64.0 * std::f32::consts::TAU;
        let place = [32.0 + radius * angle.cos(), 29.5, 32.0 + radius * angle.sin()];
        assert!(!ring.contains(place.map(|v| v as i32)), "nothing carved at {place:?}");
    }
    assert!(studio.world.volume().count() < full);
}

/// What a tick removes lies within the bit as it is now, not on the way there.
fn assert_no_sweep(studio: &Studio<64>, hand: usize, bit: Bit, before: &Dense, what: &str) {
    let grid = bit.on_grid(studio.world.frame().voxel() * 1e6);
    let piece = grid.piece(&studio.world.hand(hand).frozen);
    let gone = before.without(&voxels(studio));
    assert!(!gone.is_empty(), "{what}: nothing carved");
    for voxel in gone.occupied() {
        let [x, y, z] = voxel.map(|i| i as usize);
        let is_now = piece.span(y, z, 64).is_some_and(|(lo, hi)| (lo..=hi).contains(&x));
        assert!(is_now, "{what}: {voxel:?} was swept");
    }
}

#[test]
fn a_grab_a_tool_change_and_a_gap_never_sweep() {
    let mut studio = studio();
    let (a, b) = (Vec3::new(12.0, 30.2, 20.0), Vec3::new(52.0, 30.2, 44.0));
    let start = |studio: &mut Studio<64>| {
        floor(studio, 30);
        take(studio, RIGHT, Item::Tool(Tool::Rotary));
        (0..3).for_each(|_| reach(studio, RIGHT, a, true));
    };
    // The other way round: a plain stroke does sweep.
    start(&mut studio);
    let just_touching = |place: Vec3| Vec3::new(place.x, 31.4, place.z);
    reach(&mut studio, RIGHT, just_touching(a), true);
    (0..4).for_each(|_| reach(&mut studio, RIGHT, just_touching(b), true));
    let middle = [32, 29, 32];
    assert!(!voxels(&studio).contains(middle), "a fast stroke leaves no dots");
    // Tracking is lost for a tick; trigger held all the while.
    start(&mut studio);
    reach(&mut studio, RIGHT, just_touching(a), true);
    studio.step(&with(RIGHT, HandInput { trigger: 255, tracked: false, ..HandInput::default() }));
    let before = voxels(&studio);
    reach(&mut studio, RIGHT, just_touching(b), true);
    assert_no_sweep(&studio, RIGHT, Bit::MediumBall, &before, "gap");
    // Another bit, another tool, put back and taken again: in the tick of the jump.
    let jumps: [(&str, Item, Bit); 3] = [
        ("bit", Item::Bit(Bit::LargeBall), Bit::LargeBall),
        ("tool", Item::Tool(Tool::Impact), Bit::PointChisel),
        ("grab", Item::Tool(Tool::Rotary), Bit::MediumBall),
    ];
    for (what, item, bit) in jumps {
        start(&mut studio);
        if what == "grab" {
            studio.step(&Input { pointer: Pointer::Return { hand: 1 }, ..Input::default() });
        }
        let before = voxels(&studio);
        let pose = Pose { position: b, rotation: Quat::IDENTITY };
        let mut input = with(RIGHT, HandInput { trigger: 255, ..at(&studio.world, RIGHT, &pose) });
        // Where the new tool's length has the bit.
        let tool = match item {
            Item::Tool(tool) => tool,
            Item::Bit(bit) => bit.data().tool,
        };
        let (tip, rotation) = studio.world.frame().to_room(&pose);
        let grip = RawPose::new(tip + rotation * Vec3::Z * tool.length() as f32 * 1e-6, rotation);
        (input.hands[RIGHT].grip, input.hands[RIGHT].aim) = (grip, grip);
        input.pointer = Pointer::Take { hand: 1, item: item.number() as u8 };
        studio.step(&input);
        assert_eq!(studio.world.held(RIGHT).map(|held| held.1), Some(bit));
        assert_no_sweep(&studio, RIGHT, bit, &before, what);
    }
}
