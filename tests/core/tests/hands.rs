//! Hands, bench and stool: items are taken, dropped and turned, and none of these actions cuts a swept
//! volume.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::{EditReport, Pose};
use paros_core::internals::{BENCH_TOP, BOX_SIDE, STOOL_TOP, ToolPlace};
use paros_core::session::{
    BenchItem, PointerCommand, RawPose, SessionMode, TICK_RATE, Tool, ToolBit,
};
use paros_core::{HandInput, TickInput, WorldEvent};
use paros_models::dense::DenseVolume;
use paros_models::scripted_hand::{
    LEFT, RIGHT, hand_input_at, input_with_hand, squeeze_and_release, start_from_floor,
    step_with_bit_at, take_item, volume_of,
};
use paros_models::world_harness::WorldHarness;
use paros_shell::headset::haptics::TickHaptics;

static HARNESS: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());

fn lock_harness() -> MutexGuard<'static, WorldHarness<64>> {
    HARNESS.lock().unwrap_or_else(PoisonError::into_inner)
}

paros_models::test_with_one_and_two_intervals!(
    the_stool_turns_and_takes_contact_and_edits_along,
    a_tool_at_rest_carves_the_turning_stone,
    a_grab_a_tool_change_and_a_gap_never_sweep,
);

#[test]
fn each_hand_takes_exchanges_and_returns_tools() {
    let mut harness = lock_harness();
    for (hand, other) in [(LEFT, RIGHT), (RIGHT, LEFT)] {
        harness.start_session(SessionMode::FreeForm);
        let (rotary, gun) = (BenchItem::Tool(Tool::Rotary), BenchItem::Tool(Tool::FillGun));
        let events = squeeze_and_release(&mut harness, hand, rotary.home_position());
        assert_eq!(events, [WorldEvent::Took { hand: hand as u8, item: rotary }]);
        assert_eq!(harness.world.held_tool(hand), Some((Tool::Rotary, ToolBit::MediumBall)));
        assert_eq!(harness.world.workbench().pose_of(rotary), None);
        // Another tool is in reach: the first returns to its place.
        squeeze_and_release(&mut harness, hand, gun.home_position());
        assert_eq!(harness.world.held_tool(hand), Some((Tool::FillGun, ToolBit::Nozzle)));
        assert_eq!(harness.world.workbench().place_of(rotary), ToolPlace::Home);
        // A tool in one hand isn't on the bench for the other hand.
        assert_eq!(squeeze_and_release(&mut harness, other, gun.home_position()), []);
        // The pointer moves it to the other hand.
        take_item(&mut harness, other, gun);
        assert_eq!(
            (harness.world.held_tool(hand), harness.world.held_tool(other)),
            (None, Some((Tool::FillGun, ToolBit::Nozzle)))
        );
        // The tool is released at its own place.
        let events = squeeze_and_release(&mut harness, other, gun.home_position());
        assert_eq!(events, [WorldEvent::Released { hand: other as u8, tool: Tool::FillGun }]);
        assert_eq!(harness.world.workbench().place_of(gun), ToolPlace::Home);
        // Out of reach of every item, a squeeze takes nothing.
        assert_eq!(squeeze_and_release(&mut harness, hand, STOOL_TOP), []);
    }
}

#[test]
fn bits_are_mounted_on_their_own_tool() {
    let mut harness = lock_harness();
    harness.start_session(SessionMode::FreeForm);
    let grinder = BenchItem::Bit(ToolBit::Grinder);
    assert_eq!(
        squeeze_and_release(&mut harness, LEFT, grinder.home_position()),
        [],
        "no tool to put it on"
    );
    take_item(&mut harness, LEFT, BenchItem::Tool(Tool::Impact));
    take_item(&mut harness, LEFT, grinder);
    assert_eq!(harness.world.held_tool(LEFT), Some((Tool::Impact, ToolBit::PointChisel)));
    squeeze_and_release(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary).home_position());
    let events = squeeze_and_release(&mut harness, RIGHT, grinder.home_position());
    assert_eq!(events, [WorldEvent::Took { hand: 1, item: grinder }]);
    assert_eq!(harness.world.held_tool(RIGHT), Some((Tool::Rotary, ToolBit::Grinder)));
    assert_eq!(
        harness.world.workbench().place_of(BenchItem::Bit(ToolBit::MediumBall)),
        ToolPlace::Home
    );
    assert_eq!(harness.world.workbench().place_of(grinder), ToolPlace::Mounted);
    // The bit stays mounted while its tool is on the bench.
    harness
        .step(&TickInput { pointer: PointerCommand::Return { hand: 1 }, ..TickInput::default() });
    assert_eq!(harness.world.events(), [WorldEvent::Returned { hand: 1, tool: Tool::Rotary }]);
    assert_eq!(harness.world.held_tool(RIGHT), None);
    take_item(&mut harness, LEFT, BenchItem::Tool(Tool::Rotary));
    assert_eq!(harness.world.held_tool(LEFT), Some((Tool::Rotary, ToolBit::Grinder)));
    for item in 0..=255 {
        harness.step(&TickInput {
            pointer: PointerCommand::Take { hand: 7, item },
            ..TickInput::default()
        });
    }
}

#[test]
fn what_is_dropped_falls_lies_and_is_back_within_ten_seconds() {
    let mut harness = lock_harness();
    let item = BenchItem::Tool(Tool::Rasp);
    for (place, rest) in [(Vec3::new(0.0, 1.2, 0.3), 0.03), (Vec3::new(0.5, 1.3, 0.15), BENCH_TOP)]
    {
        harness.start_session(SessionMode::FreeForm);
        take_item(&mut harness, RIGHT, item);
        let events = squeeze_and_release(&mut harness, RIGHT, place);
        assert_eq!(events, [WorldEvent::Released { hand: 1, tool: Tool::Rasp }]);
        let mut height = place.y;
        let mut fell = 0;
        while matches!(harness.world.workbench().place_of(item), ToolPlace::Falling(_)) {
            let (position, _) = harness.world.workbench().pose_of(item).expect("it is in the room");
            assert!(position.y < height);
            height = position.y;
            harness.step(&TickInput::default());
            fell += 1;
        }
        let metres = place.y - rest;
        let seconds = (2.0 * metres / 9.81).sqrt();
        assert!((fell as f32 / TICK_RATE as f32 - seconds).abs() < 0.05, "fell for {fell} ticks");
        let (position, _) = harness.world.workbench().pose_of(item).expect("it lies there");
        assert!(position.distance(Vec3::new(place.x, rest, place.z)) < 1e-4, "{position}");
        // It can be picked up from there, and dropped again.
        let events = squeeze_and_release(&mut harness, LEFT, position);
        assert_eq!(events, [WorldEvent::Took { hand: 0, item }]);
        squeeze_and_release(&mut harness, LEFT, place);
        for _ in 0..10 * TICK_RATE + 60 {
            harness.step(&TickInput::default());
        }
        assert_eq!(harness.world.workbench().place_of(item), ToolPlace::Home);
    }
}

fn the_stool_turns_and_takes_contact_and_edits_along<const K: usize>(
    harness: &mut WorldHarness<64, K>,
) {
    for turn in [0i16, 16_384, -16_384, 5000, i16::MIN] {
        start_from_floor(harness, 30);
        harness.step(&TickInput {
            pointer: PointerCommand::Turn { by: turn },
            ..TickInput::default()
        });
        take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
        let before = volume_of(harness);
        // A fixed place in the room, whatever the stool's rotation.
        let tip = STOOL_TOP + Vec3::new(0.1, 31.0 / 64.0 * BOX_SIDE, -0.05);
        let grip = tip + Vec3::Z * Tool::Rotary.length_um() as f32 * 1e-6;
        // The hand comes from above: the push-out points up in the room.
        harness.step(&input_with_hand(RIGHT, hand_input_at(grip + Vec3::Y * 0.1)));
        harness.step(&input_with_hand(RIGHT, hand_input_at(grip)));
        let out = harness.world.push_out_metres(RIGHT);
        assert!(out.y > 0.001 && out.x.abs() < 1e-4 && out.z.abs() < 1e-4, "{turn}: {out}");
        for _ in 0..3 {
            harness
                .step(&input_with_hand(RIGHT, HandInput { trigger: 255, ..hand_input_at(grip) }));
        }
        let angle = f32::from(turn) / 65_536.0 * std::f32::consts::TAU;
        let expected = Quat::from_rotation_y(-angle) * Vec3::new(0.1, 0.0, -0.05) / BOX_SIDE * 64.0
            + Vec3::new(32.0, 31.0, 32.0);
        let raw = harness.world.hand_state(RIGHT).raw_pose.position;
        assert!(raw.distance(expected) < 0.05, "{turn}: {raw}, not {expected}");
        let gone = before.difference(&volume_of(harness));
        assert!(gone.count() > 5, "{turn}: {} voxels", gone.count());
        for voxel in gone.occupied() {
            let centre = Vec3::from_array(voxel.map(|i| i as f32 + 0.5));
            assert!(centre.distance(expected) < 4.0, "{turn}: {voxel:?} is far from {expected}");
        }
    }
}

#[test]
fn a_stick_turns_the_stool_a_quarter_turn_a_second() {
    let mut harness = lock_harness();
    harness.start_session(SessionMode::FreeForm);
    let zero = harness.world.stool_frame();
    for _ in 0..TICK_RATE {
        harness.step(&input_with_hand(
            LEFT,
            HandInput { stick: [127, 0], ..hand_input_at(STOOL_TOP) },
        ));
    }
    let quarter = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
    let (_, turned) = harness.world.stool_frame().to_room(&Pose::ZERO);
    assert!(turned.angle_between(quarter) < 0.02, "{turned}");
    // Neither an untracked hand nor a stick at rest turns the stool.
    let still = harness.world.stool_frame();
    harness.step(&input_with_hand(
        LEFT,
        HandInput { stick: [127, 0], tracked: false, ..hand_input_at(STOOL_TOP) },
    ));
    harness
        .step(&input_with_hand(LEFT, HandInput { stick: [20, 127], ..hand_input_at(STOOL_TOP) }));
    assert_eq!(harness.world.stool_frame(), still);
    assert_ne!(still, zero);
}

/// A stone that turns against a resting tool is cut as on a lathe: the tool stands, and the edit sweeps.
fn a_tool_at_rest_carves_the_turning_stone<const K: usize>(harness: &mut WorldHarness<64, K>) {
    start_from_floor(harness, 30);
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let tip = STOOL_TOP + Vec3::new(0.15, 31.0 / 64.0 * BOX_SIDE, 0.0);
    let grip = tip + Vec3::Z * Tool::Rotary.length_um() as f32 * 1e-6;
    let full = harness.world.volume().count_voxels();
    for _ in 0..5 * TICK_RATE {
        let hand = HandInput { trigger: 255, stick: [127, 0], ..hand_input_at(grip) };
        harness.step(&input_with_hand(RIGHT, hand));
        harness.check_invariants();
    }
    let ring = volume_of(harness);
    let radius = 0.15 / BOX_SIDE * 64.0;
    for i in 0..64 {
        let angle = i as f32 / 64.0 * std::f32::consts::TAU;
        let place = [32.0 + radius * angle.cos(), 29.5, 32.0 + radius * angle.sin()];
        assert!(!ring.contains(place.map(|v| v as i32)), "nothing carved at {place:?}");
    }
    assert!(harness.world.volume().count_voxels() < full);
}

/// Asserts that a tick removed only voxels within the bit's current pose, not along its path.
fn assert_no_sweep<const K: usize>(
    harness: &WorldHarness<64, K>,
    hand: usize,
    bit: ToolBit,
    before: &DenseVolume,
    what: &str,
) {
    let grid = bit.to_grid_bit(harness.world.stool_frame().voxel_metres() * 1e6);
    let piece = grid.piece_at(&harness.world.hand_state(hand).frozen_pose);
    let gone = before.difference(&volume_of(harness));
    assert!(!gone.is_empty(), "{what}: nothing carved");
    for voxel in gone.occupied() {
        let [x, y, z] = voxel.map(|i| i as usize);
        let is_now = piece.x_range(y, z, 64).is_some_and(|range| range.contains(x));
        assert!(is_now, "{what}: {voxel:?} was swept");
    }
}

fn a_grab_a_tool_change_and_a_gap_never_sweep<const K: usize>(harness: &mut WorldHarness<64, K>) {
    let (a, b) = (Vec3::new(12.0, 30.2, 20.0), Vec3::new(52.0, 30.2, 44.0));
    let start = |harness: &mut WorldHarness<64, K>| {
        start_from_floor(harness, 30);
        take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
        (0..3).for_each(|_| step_with_bit_at(harness, RIGHT, a, true));
    };
    // For comparison, a plain stroke does sweep.
    start(harness);
    let just_touching = |place: Vec3| Vec3::new(place.x, 31.4, place.z);
    step_with_bit_at(harness, RIGHT, just_touching(a), true);
    (0..4).for_each(|_| step_with_bit_at(harness, RIGHT, just_touching(b), true));
    let middle = [32, 29, 32];
    assert!(!volume_of(harness).contains(middle), "a fast stroke leaves no dots");
    // Tracking is lost for a tick while the trigger stays pulled.
    start(harness);
    step_with_bit_at(harness, RIGHT, just_touching(a), true);
    harness.step(&input_with_hand(
        RIGHT,
        HandInput { trigger: 255, tracked: false, ..HandInput::default() },
    ));
    let before = volume_of(harness);
    step_with_bit_at(harness, RIGHT, just_touching(b), true);
    assert_no_sweep(harness, RIGHT, ToolBit::MediumBall, &before, "gap");
    // Another bit, another tool, or put back and taken again, all in the tick of the jump.
    let jumps: [(&str, BenchItem, ToolBit); 3] = [
        ("bit", BenchItem::Bit(ToolBit::LargeBall), ToolBit::LargeBall),
        ("tool", BenchItem::Tool(Tool::Impact), ToolBit::PointChisel),
        ("grab", BenchItem::Tool(Tool::Rotary), ToolBit::MediumBall),
    ];
    for (what, item, bit) in jumps {
        start(harness);
        if what == "grab" {
            harness.step(&TickInput {
                pointer: PointerCommand::Return { hand: 1 },
                ..TickInput::default()
            });
        }
        let before = volume_of(harness);
        let pose = Pose { position: b, rotation: Quat::IDENTITY };
        let mut input = input_with_hand(
            RIGHT,
            HandInput { trigger: 255, ..harness.world.hand_with_bit_at(RIGHT, &pose) },
        );
        // At the place where the new tool's length puts the bit.
        let tool = match item {
            BenchItem::Tool(tool) => tool,
            BenchItem::Bit(bit) => bit.spec().tool,
        };
        let (tip, rotation) = harness.world.stool_frame().to_room(&pose);
        let grip =
            RawPose::quantise(tip + rotation * Vec3::Z * tool.length_um() as f32 * 1e-6, rotation);
        (input.hands[RIGHT].grip, input.hands[RIGHT].aim) = (grip, grip);
        input.pointer = PointerCommand::Take { hand: 1, item: item.number() as u8 };
        harness.step(&input);
        assert_eq!(harness.world.held_tool(RIGHT).map(|held| held.1), Some(bit));
        assert_no_sweep(harness, RIGHT, bit, &before, what);
    }
}

/// Both hands cut sideways from inside tunnels, where a column of one interval can't keep anything empty.
#[test]
fn each_hand_is_told_what_closure_brought_back() {
    let mut harness = lock_harness();
    harness.start_from_voxels(|[_, y, z]| {
        y < 40 && !((10..22).contains(&y) && ((8..20).contains(&z) || (44..56).contains(&z)))
    });
    take_item(&mut harness, LEFT, BenchItem::Tool(Tool::Impact));
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let before = volume_of(&harness);
    let mut refused_together = 0;
    for tick in 0..40 {
        let aside = 0.25 * tick as f32;
        let mut input = TickInput::default();
        for (hand, z) in [(LEFT, 14.0 + aside), (RIGHT, 50.0 - aside)] {
            let pose = Pose { position: Vec3::new(32.0, 16.0, z), rotation: Quat::IDENTITY };
            let at = harness.world.hand_with_bit_at(hand, &pose);
            input.hands[hand] = HandInput { trigger: 255, ..at };
        }
        harness.step(&input);
        let reports = [LEFT, RIGHT].map(|hand| harness.world.edit_report(hand));
        for (report, walls) in reports.iter().zip([20..32, 32..44]) {
            assert_eq!(report.removed, 0);
            assert_eq!(report.closure_box.is_empty(), report.refused_by_closure == 0);
            let [x, y, z] = report.closure_box.ranges();
            let is_at_bit = walls.contains(&z.first()) && walls.contains(&z.last());
            assert!(report.closure_box.is_empty() || is_at_bit, "{z:?}");
            assert!(x.is_empty() || x.contains(32) && y.contains(16));
        }
        let felt = TickHaptics::of_last_tick(&harness.world).map(|hand| hand.is_refused);
        assert_eq!(felt, reports.map(|report| report.refused_by_closure > 0));
        refused_together += u32::from(reports.iter().all(|report| report.refused_by_closure > 0));
        let sum = reports[0].sum_with(reports[1]);
        let [.., z] = sum.closure_box.ranges();
        assert_eq!(
            sum.refused_by_closure,
            reports[0].refused_by_closure + reports[1].refused_by_closure
        );
        assert!(
            reports
                .iter()
                .all(|report| sum.closure_box.hull_with(report.closure_box) == sum.closure_box)
        );
        assert!(reports.iter().any(|report| report.closure_box.is_empty()) || z.contains(31));
    }
    assert!(refused_together > 2, "{refused_together} ticks");
    assert_eq!(volume_of(&harness), before);
    harness.step(&TickInput::default());
    assert_eq!(harness.world.edit_report(RIGHT), EditReport::default());
}
