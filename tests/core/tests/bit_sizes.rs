//! Sizes of bits: how sticks and pointer change them, how long they are kept, and that each size respects the
//! tick's work limit and the voxel size.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::internals::{BOX_SIDE, BitShape, SizeRange};
use paros_core::limits::{bit_side_voxels, bite_work, island_reserve, smoothing_work, tick_work};
use paros_core::session::{BenchItem, BitSize, PointerCommand, SessionMode, Tool, ToolBit};
use paros_core::{HandInput, TickInput};
use paros_models::save_layout::save_to_vec;
use paros_models::scripted_hand::{
    LEFT, RIGHT, input_with_hand, start_from_floor, step_with_bit_at, take_item, volume_of,
};
use paros_models::world_harness::WorldHarness;

const N: usize = 128;
type Harness = WorldHarness<N, 2>;

/// Starts with half the stone, and the medium ball in the right hand.
fn start() -> MutexGuard<'static, Harness> {
    static WORLD: Mutex<Harness> = Mutex::new(WorldHarness::new());
    let mut harness = WORLD.lock().unwrap_or_else(PoisonError::into_inner);
    start_from_floor(&mut harness, N / 2);
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    harness
}

fn steps_of(harness: &Harness, bit: ToolBit) -> i8 {
    harness.world.workbench().size_of(bit).steps()
}

/// Runs ticks with the stick of a hand pushed. Returns each tick in which a bit's size changed, with the new
/// size.
fn push_stick(
    harness: &mut Harness,
    hand: usize,
    bit: ToolBit,
    ys: &[[i8; 2]],
) -> Vec<(usize, i8)> {
    let mut changes = Vec::new();
    for (tick, &stick) in ys.iter().enumerate() {
        let before = steps_of(harness, bit);
        let above = Pose { position: Vec3::new(64.0, 110.0, 64.0), rotation: Quat::IDENTITY };
        let at = harness.world.hand_with_bit_at(hand, &above);
        harness.step(&input_with_hand(hand, HandInput { stick, ..at }));
        let after = steps_of(harness, bit);
        if after != before {
            changes.push((tick, after));
        }
    }
    changes
}

fn resize(harness: &mut Harness, hand: usize, by: i8) {
    let pointer = PointerCommand::Resize { hand: hand as u8, by };
    harness.step(&TickInput { pointer, ..TickInput::default() });
}

#[test]
fn a_pushed_stick_resizes_at_once_and_again_while_it_is_held() {
    let harness = &mut *start();
    let ball = ToolBit::MediumBall;
    let up = push_stick(harness, RIGHT, ball, &[[0, 127]; 60]);
    assert_eq!(up, [(0, 1), (18, 2), (36, 3)], "a quarter of a second apart, to its end");
    // A push lasts until the stick falls below half, and begins at three quarters.
    let ys = [0, 95, 96, 64, 63, 64, 95, -96, -127, 0, -100].map(|y| [0, y]);
    let down = push_stick(harness, RIGHT, ball, &ys);
    assert_eq!(down, [(7, 2), (10, 1)], "up at tick 2 changes nothing at the end");
    // The x axis turns the stool: a stick pushed mostly along x resizes nothing.
    assert_eq!(push_stick(harness, RIGHT, ball, &[[100, 100], [-120, 110], [0, 0]]), []);
    let turned = harness.world.stool_frame();
    assert_eq!(push_stick(harness, RIGHT, ball, &[[99, 100]; 3]), [(0, 2)]);
    assert_ne!(harness.world.stool_frame(), turned, "it turns beside");
}

#[test]
fn a_hand_resizes_what_it_holds_while_it_is_tracked() {
    let harness = &mut *start();
    take_item(harness, LEFT, BenchItem::Tool(Tool::Impact));
    assert_eq!(push_stick(harness, LEFT, ToolBit::PointChisel, &[[0, -127]; 2]), [(0, -1)]);
    assert_eq!(steps_of(harness, ToolBit::MediumBall), 0);
    resize(harness, RIGHT, 2);
    resize(harness, LEFT, i8::MIN);
    assert_eq!(steps_of(harness, ToolBit::MediumBall), 2);
    assert_eq!(steps_of(harness, ToolBit::PointChisel), -3, "to its end");
    // A lost hand's stick counts as at rest, so a new push begins.
    push_stick(harness, RIGHT, ToolBit::MediumBall, &[[0, 127]]);
    let lost = HandInput { stick: [0, 127], ..HandInput::default() };
    (0..40).for_each(|_| harness.step(&input_with_hand(RIGHT, lost)));
    assert_eq!(steps_of(harness, ToolBit::MediumBall), 3);
    assert_eq!(harness.world.hand_state(RIGHT).resize_push, 0);
    // An empty hand has no bit to resize.
    harness
        .step(&TickInput { pointer: PointerCommand::Return { hand: 1 }, ..TickInput::default() });
    resize(harness, RIGHT, -1);
    assert_eq!(steps_of(harness, ToolBit::MediumBall), 3);
}

#[test]
fn a_size_stays_with_its_bit_until_the_next_start() {
    let harness = &mut *start();
    resize(harness, RIGHT, 3);
    take_item(harness, RIGHT, BenchItem::Bit(ToolBit::SmallBall));
    assert_eq!(harness.world.held_bit_spec(RIGHT), Some(*ToolBit::SmallBall.spec()));
    let before = harness.world.digest();
    let saved = save_to_vec(&harness.world);
    resize(harness, RIGHT, -2);
    assert_ne!(harness.world.digest(), before);
    harness.world.load(&saved).expect("a save");
    assert_eq!(steps_of(harness, ToolBit::SmallBall), 0);
    assert_eq!(steps_of(harness, ToolBit::MediumBall), 3);
    take_item(harness, RIGHT, BenchItem::Bit(ToolBit::MediumBall));
    let spec = harness.world.held_bit_spec(RIGHT).expect("a bit");
    assert_eq!(spec.shape, BitShape::Ball { radius_um: 25_230 });
    harness.step(&TickInput { start: SessionMode::Own, ..TickInput::default() });
    assert_eq!(steps_of(harness, ToolBit::MediumBall), 0);
}

/// The ball of 15 mm radius cuts 30 mm wide; at half its size 15 mm, and at 1.68 times its size 50.5 mm.
#[test]
fn a_groove_is_as_wide_as_its_bit() {
    for (by, width_mm) in [(-4, 15.0), (0, 30.0), (3, 50.5)] {
        let harness = &mut *start();
        resize(harness, RIGHT, by);
        let face = N as f32 / 2.0;
        for tick in 0..120 {
            let at = Vec3::new(64.3, face, 40.0 + 0.4 * tick as f32);
            step_with_bit_at(harness, RIGHT, at, tick > 0);
        }
        let left = volume_of(harness);
        let open = (0..N as i32).filter(|&x| !left.contains([x, N as i32 / 2 - 1, 60])).count();
        let width = open as f32 * BOX_SIDE * 1e3 / N as f32;
        assert!((width - width_mm).abs() < 4.0, "{by}: {width} mm");
    }
}

/// A bit that is enlarged inside the stone keeps its place and cuts itself free.
#[test]
fn a_bit_that_grows_in_the_stone_stays_there_and_cuts_itself_free() {
    let harness = &mut *start();
    let at = Vec3::new(64.3, N as f32 / 2.0 - 2.0, 64.3);
    (0..40).for_each(|tick| step_with_bit_at(harness, RIGHT, at, tick > 0));
    let before = volume_of(harness);
    let pose = Pose { position: at, rotation: Quat::IDENTITY };
    let mut input = input_with_hand(RIGHT, harness.world.hand_with_bit_at(RIGHT, &pose));
    input.hands[RIGHT].trigger = 255;
    input.pointer = PointerCommand::Resize { hand: RIGHT as u8, by: 3 };
    harness.step(&input);
    (0..12).for_each(|_| step_with_bit_at(harness, RIGHT, at, true));
    let state = harness.world.hand_state(RIGHT);
    assert!(state.frozen_pose.position.distance(at) < 0.05, "{:?}", state.frozen_pose);
    let radius = 0.02523 * N as f32 / BOX_SIDE;
    let cut = before.difference(&volume_of(harness));
    assert!(cut.count() > 500, "{} voxels", cut.count());
    for voxel in before.occupied() {
        let middle = Vec3::from_array(voxel.map(|i| i as f32 + 0.5));
        let distance = middle.distance(at);
        assert!(!cut.contains(voxel) || distance < radius + 0.1, "{voxel:?} is outside");
        assert!(cut.contains(voxel) || distance > radius - 0.1, "{voxel:?} is left");
    }
}

/// The largest size is the last whose bite fits a hand's share of a tick with both hands and the mirror in
/// use, at most twice the standard size. The smallest size is the last whose bite is at least a millimetre,
/// at least half the standard size.
#[test]
fn bits_come_in_all_sizes_that_a_tick_and_the_voxels_allow() {
    let wall_mm = 3.1;
    for bit in ToolBit::ALL {
        let (spec, SizeRange { smallest, largest }) = (bit.spec(), bit.spec().sizes);
        let (half_mm, is_ball) = match spec.shape {
            BitShape::Ball { radius_um } => ([radius_um; 3], true),
            BitShape::Box { half_extents_um } => (half_extents_um, false),
            BitShape::Disc { .. } => {
                assert_eq!((smallest, largest), (0, 0), "a blade is two voxels thick");
                continue;
            }
        };
        let half_mm = Vec3::from_array(half_mm.map(|um| um as f32 * 1e-3));
        let reach_mm = Vec3::from_array(spec.reach_um.map(|um| um as f32 * 1e-3));
        let scale = |steps: i8| 2f32.powf(f32::from(steps) / 4.0);
        let fits = |steps: i8| {
            [128, 256].into_iter().all(|n: usize| {
                let brush_mm = (half_mm + reach_mm) * scale(steps);
                let radius_mm = if is_ball { brush_mm.x } else { brush_mm.length() };
                let radius = radius_mm * 1e-3 / BOX_SIDE * n as f32 * 256.0;
                let side = bit_side_voxels(radius.round() as i32);
                let smooths = spec.reach_um != [0; 3];
                let work = if smooths { smoothing_work(n, side) } else { bite_work(side) };
                2 * work <= (tick_work(n) - island_reserve(n)) / 2
            })
        };
        let bite_mm = |steps: i8| half_mm.min_element() * scale(steps) - wall_mm;
        assert!(largest == 0 || fits(largest), "{bit:?} is too large");
        assert!(largest == 4 || !fits(largest + 1), "{bit:?} may be larger");
        assert!(bite_mm(smallest) >= 1.0, "{bit:?} is too small");
        assert!(smallest == -4 || bite_mm(smallest - 1) < 1.0, "{bit:?} may be smaller");
        for steps in smallest..=largest {
            let size = BitSize::of_bit(bit, steps).expect("it comes in this size");
            let percent = (scale(steps) * 100.0).round() as u32;
            assert!(size.percent().abs_diff(percent) <= 1, "{bit:?}, {steps}");
        }
        assert!(
            BitSize::of_bit(bit, largest + 1).is_none()
                && BitSize::of_bit(bit, smallest - 1).is_none()
        );
    }
}
