//! A running bit follows its hand's own path, bite by bite, and finishes it after the trigger is released.
//! Tested with a chisel, which stands between two blows.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::limits::max_trail_ticks;
use paros_core::session::{
    BenchItem, PointerCommand, SessionMode, Tool, ToolBit, buttons, commands,
};
use paros_core::{HandInput, TickInput};
use paros_models::dense::DenseVolume;
use paros_models::scripted_hand::{
    LEFT, RIGHT, input_with_hand, start_from_floor, take_item, volume_of,
};
use paros_models::world_harness::WorldHarness;

const N: usize = 128;
type Harness = WorldHarness<N, 2>;

/// Starts with half the stone, and a chisel or a burr in the right hand.
fn start(bit: ToolBit) -> MutexGuard<'static, Harness> {
    static WORLD: Mutex<Harness> = Mutex::new(WorldHarness::new());
    let mut harness = WORLD.lock().unwrap_or_else(PoisonError::into_inner);
    start_from_floor(&mut harness, N / 2);
    take_item(&mut harness, RIGHT, BenchItem::Tool(bit.spec().tool));
    take_item(&mut harness, RIGHT, BenchItem::Bit(bit));
    harness
}

/// Returns the place of a chisel pressed three voxels into the face, `along` and `aside` voxels along x and z
/// from the path's start.
fn place(along: f32, aside: f32) -> Vec3 {
    Vec3::new(40.3 + along, N as f32 / 2.0 - 1.0, 40.3 + aside)
}

fn input_at(harness: &Harness, position: Vec3, is_trigger_down: bool) -> TickInput {
    let pose = Pose { position, rotation: Quat::IDENTITY };
    let trigger = if is_trigger_down { 255 } else { 0 };
    input_with_hand(RIGHT, HandInput { trigger, ..harness.world.hand_with_bit_at(RIGHT, &pose) })
}

fn step_at(harness: &mut Harness, position: Vec3, is_trigger_down: bool) {
    let input = input_at(harness, position, is_trigger_down);
    harness.step(&input);
}

/// Presses the point chisel for a blow's three ticks, and moves it in the three ticks until the next blow.
fn strike_and_move_on(harness: &mut Harness) {
    step_at(harness, place(0.0, 0.0) + Vec3::Y * 20.0, false);
    step_at(harness, place(0.0, 0.0), false);
    for along in [0.0, 0.0, 0.0, 5.0, 10.0, 16.0] {
        step_at(harness, place(along, 0.0), true);
    }
    assert!(trail_length(harness) >= 3, "the chisel waits for its next blow");
}

fn trail_length(harness: &Harness) -> usize {
    harness.world.hand_state(RIGHT).trail.poses().len()
}

/// Rests for some ticks at the path's end. Returns the number of voxels removed meanwhile.
fn rest_and_count(harness: &mut Harness, ticks: u32) -> u32 {
    let before = volume_of(harness).count();
    (0..ticks).for_each(|_| step_at(harness, place(16.0, 0.0), false));
    before - volume_of(harness).count()
}

#[test]
fn what_is_left_is_cut_after_the_release_and_undone_with_the_stroke() {
    let harness = &mut *start(ToolBit::PointChisel);
    let whole = volume_of(harness);
    strike_and_move_on(harness);
    assert!(rest_and_count(harness, 12) > 100, "the way to the place of the release");
    assert_eq!((trail_length(harness), harness.world.is_stroke_open()), (0, false));
    let cut = whole.difference(&volume_of(harness));
    for along in [4, 8, 12, 16] {
        let at = [40 + along, N as i32 / 2 - 1, 40];
        assert!(cut.contains(at), "{along} voxels on");
    }
    assert_eq!(harness.world.undo_counts().undoable, 1, "one stroke");
    harness.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
    assert!(whole.difference(&volume_of(harness)).is_empty(), "all of it is undone");
}

/// Undo, redo, finish, a gap in tracking, another bit, and putting the tool back all leave the rest of a path
/// uncut.
#[test]
fn the_rest_of_a_way_is_left_uncut_by_all_that_ends_it() {
    let command = |commands| TickInput { commands, ..TickInput::default() };
    let point = |pointer| TickInput { pointer, ..TickInput::default() };
    let take =
        |bit| PointerCommand::Take { hand: RIGHT as u8, item: BenchItem::Bit(bit).number() as u8 };
    let pressed = |button| {
        input_with_hand(LEFT, HandInput { buttons: button, tracked: true, ..HandInput::default() })
    };
    let endings = [
        ("undo", command(commands::UNDO)),
        ("redo", command(commands::REDO)),
        ("finish", command(commands::FINISH)),
        ("a button", pressed(buttons::UPPER)),
        ("a bit", point(take(ToolBit::FlatChisel))),
        ("the tool", point(PointerCommand::Return { hand: RIGHT as u8 })),
    ];
    for (what, ending) in endings {
        let harness = &mut *start(ToolBit::PointChisel);
        strike_and_move_on(harness);
        let mut input = input_at(harness, place(16.0, 0.0), false);
        (input.commands, input.pointer) = (ending.commands, ending.pointer);
        if ending.hands[LEFT].buttons != 0 {
            input.hands[LEFT] = harness.world.hand_with_bit_at(LEFT, &Pose::ZERO);
            input.hands[LEFT].buttons = ending.hands[LEFT].buttons;
        }
        harness.step(&input);
        assert_eq!(trail_length(harness), 0, "{what}");
        assert!(!harness.world.is_stroke_open(), "{what}");
        assert_eq!(rest_and_count(harness, 12), 0, "{what}");
    }
    let harness = &mut *start(ToolBit::PointChisel);
    strike_and_move_on(harness);
    harness.step(&TickInput::default());
    assert_eq!(trail_length(harness), 0, "a gap in tracking");
}

#[test]
fn a_new_pull_begins_a_new_way() {
    let harness = &mut *start(ToolBit::PointChisel);
    strike_and_move_on(harness);
    step_at(harness, place(16.0, 0.0), false);
    assert!(trail_length(harness) > 0, "it takes more than a tick to finish");
    let before = volume_of(harness);
    (0..12).for_each(|_| step_at(harness, place(16.0, 0.0) + Vec3::Y * 20.0, true));
    let cut = before.difference(&volume_of(harness));
    let last = [56, N as i32 / 2 - 1, 40];
    assert!(before.contains(last) && !cut.contains(last), "where the old way ended");
}

/// A path round a corner is cut along the path, not along its chord.
#[test]
fn the_way_is_the_hands_own() {
    let harness = &mut *start(ToolBit::PointChisel);
    let whole = volume_of(harness);
    step_at(harness, place(0.0, 0.0) + Vec3::Y * 20.0, false);
    step_at(harness, place(0.0, 0.0), false);
    (0..3).for_each(|_| step_at(harness, place(0.0, 0.0), true));
    for [along, aside] in [[10.0, 0.0], [10.0, 5.0], [10.0, 10.0]] {
        step_at(harness, place(along, aside), true);
    }
    (0..12).for_each(|_| step_at(harness, place(10.0, 10.0), false));
    let cut = whole.difference(&volume_of(harness));
    let top = N as i32 / 2 - 1;
    assert!(cut.contains([50, top, 41]), "the corner");
    assert!(!cut.contains([43, top, 47]), "beside the chord");
}

/// A hand at 10 m/s through stone: the oldest part of a path that is too long is left uncut, and reported.
#[test]
fn a_way_that_is_too_long_is_shortened_and_told() {
    for bit in [ToolBit::LargeBall, ToolBit::FlatChisel] {
        let harness = &mut *start(bit);
        step_at(harness, place(0.0, 0.0) + Vec3::Y * 20.0, false);
        let mut dropped = 0;
        for tick in 0..60 {
            let to = [0.0, 40.0][tick / 2 % 2];
            let deep = Vec3::NEG_Y * 30.0;
            step_at(harness, place(to, 30.0 * (tick % 2) as f32) + deep, true);
            dropped += harness.world.edit_report(RIGHT).dropped_ticks;
            assert!(trail_length(harness) <= max_trail_ticks(bit.spec().bite_period));
        }
        assert!(dropped > 0, "{bit:?}: {dropped} ticks");
    }
}

/// Burrs that press on a hidden figure slide along it and keep up.
#[test]
fn on_the_mask_a_bit_keeps_up_with_its_hand() {
    let harness = &mut *start(ToolBit::MediumBall);
    let [stone, figure] = [64, 60].map(|height| DenseVolume::from_fn(N, |[_, y, _]| y < height));
    let start = SessionMode::Constrained { figure: 0 };
    harness.reset_to_voxels(&stone, &figure);
    for (bit, reach) in [(ToolBit::MediumBall, 4.3), (ToolBit::LargeBall, 6.8)] {
        for pressed in [1.0, 3.0, 8.0] {
            harness.step(&TickInput { start, ..TickInput::default() });
            take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
            take_item(harness, RIGHT, BenchItem::Bit(bit));
            let down = |along: f32| Vec3::new(30.3 + along, 60.0 + reach - pressed, 60.3);
            step_at(harness, down(0.0) + Vec3::Y * 30.0, false);
            (0..40).for_each(|_| step_at(harness, down(0.0), true));
            let (mut most_behind, mut stood) = (0.0f32, 0);
            for tick in 0..40 {
                let before = harness.world.hand_state(RIGHT).frozen_pose;
                step_at(harness, down(1.5 * tick as f32), true);
                let hand = harness.world.hand_state(RIGHT);
                most_behind =
                    most_behind.max(hand.raw_pose.position.x - hand.frozen_pose.position.x);
                stood += u32::from(before == hand.frozen_pose);
            }
            // The bit stands in the same tick as its hand, and lags by about the depth to which it is
            // pressed.
            let does_keep_up = most_behind < pressed + 2.0 && stood <= 1;
            assert!(
                does_keep_up,
                "{bit:?} pressed {pressed}: {most_behind} voxels behind, stood in {stood} ticks"
            );
            assert!(figure.difference(&volume_of(harness)).is_empty(), "the figure is whole");
        }
    }
}
