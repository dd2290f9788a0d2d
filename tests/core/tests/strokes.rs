//! Strokes: the contents of an undo entry, and how bits follow hands through gaps, paste and stone.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL, UndoCounts};
use paros_core::internals::{GridBit, Obstacle, maps_digest};
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit, commands};
use paros_core::volume::{Grid, Size};
use paros_core::{HandInput, TickInput, WorldEvent};
use paros_models::cases::sample_cases;
use paros_models::dense::DenseVolume;
use paros_models::scripted_hand::{
    LEFT, RIGHT, input_with_hand, start_from_floor, step_with_bit_at, take_item, volume_of,
};
use paros_models::world_harness::WorldHarness;

static HARNESS: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());
static HARNESS_128: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());
static HARNESS_256: Mutex<WorldHarness<256>> = Mutex::new(WorldHarness::new());

fn lock<T>(harness: &'static Mutex<T>) -> MutexGuard<'static, T> {
    harness.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the input of two hands with their bits at positions of the grid, and triggers pulled or not.
fn input_with_bits_at(harness: &WorldHarness<64>, bits: [(Vec3, bool); 2]) -> TickInput {
    let mut input = TickInput::default();
    for (hand, (position, trigger_down)) in bits.into_iter().enumerate() {
        let pose = Pose { position, rotation: Quat::IDENTITY };
        let trigger = if trigger_down { 255 } else { 0 };
        input.hands[hand] = HandInput { trigger, ..harness.world.hand_with_bit_at(hand, &pose) };
    }
    input
}

fn grid_bit<const N: usize>(harness: &WorldHarness<N>, bit: ToolBit) -> GridBit
where
    Grid<N>: Size,
{
    bit.to_grid_bit(harness.world.stool_frame().voxel_metres() * 1e6)
}

/// Returns the height of a bit's centre above stone of `thickness` voxels, as deep in it as its bite allows.
fn rest_height(bit: &GridBit, thickness: usize) -> f32 {
    let deep = (bit.inscribed_radius_subunits() - bit.bite) as f32 / SUBUNITS_PER_VOXEL as f32;
    thickness as f32 - 0.47 + deep
}

fn counts(harness: &WorldHarness<64>) -> (usize, usize) {
    let UndoCounts { undoable, redoable } = harness.world.undo_counts();
    (undoable, redoable)
}

fn start_with_two_tools(harness: &mut WorldHarness<64>) {
    start_from_floor(harness, 30);
    take_item(harness, LEFT, BenchItem::Tool(Tool::Impact));
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
}

/// The places where the hands cut.
const CUTS: [Vec3; 2] = [Vec3::new(16.0, 30.5, 30.0), Vec3::new(44.0, 30.5, 30.0)];

/// Runs ticks in which hands cut or not, each tick at another place and a little deeper.
fn cut_for(harness: &mut WorldHarness<64>, ticks: u32, cuts: [bool; 2]) {
    for _ in 0..ticks {
        let tick = harness.world.tick() as f32;
        let way = Vec3::new(0.0, -0.04 * tick, tick % 16.0);
        let bits = [0, 1].map(|hand| (CUTS[hand] + way, cuts[hand]));
        let input = input_with_bits_at(harness, bits);
        harness.step(&input);
    }
}

#[test]
fn what_both_hands_cut_until_neither_does_is_one_stroke() {
    let mut harness = lock(&HARNESS);
    start_with_two_tools(&mut harness);
    let start = maps_digest(harness.world.volume().maps());
    // The second hand's pull and then the first hand's release don't end the stroke.
    for cuts in [[false, true], [true, true], [true, false], [true, true], [false, true]] {
        cut_for(&mut harness, 12, cuts);
        assert!(harness.world.is_stroke_open());
        assert_eq!(counts(&harness), (1, 0), "{cuts:?}");
    }
    let first = maps_digest(harness.world.volume().maps());
    cut_for(&mut harness, 1, [false, false]);
    assert!(!harness.world.is_stroke_open());
    // The stroke passes from one hand to the other in a single tick.
    cut_for(&mut harness, 12, [true, false]);
    assert_eq!(counts(&harness), (2, 0));
    cut_for(&mut harness, 12, [false, true]);
    assert_eq!(counts(&harness), (2, 0));
    cut_for(&mut harness, 1, [false, false]);
    for (expected, counted) in [(first, (1, 1)), (start, (0, 2))] {
        harness.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
        assert_eq!(maps_digest(harness.world.volume().maps()), expected);
        assert_eq!(counts(&harness), counted);
    }
}

#[test]
fn an_undo_ends_the_stroke_that_it_falls_into() {
    let mut harness = lock(&HARNESS);
    start_with_two_tools(&mut harness);
    cut_for(&mut harness, 12, [true, true]);
    let bits = [0, 1].map(|hand| (CUTS[hand], true));
    let input = input_with_bits_at(&harness, bits);
    harness.step(&TickInput { commands: commands::UNDO, ..input });
    let again = harness.world.events().contains(&WorldEvent::Undone);
    cut_for(&mut harness, 12, [true, true]);
    assert!(again && harness.world.is_stroke_open());
    assert_eq!(counts(&harness), (1, 0), "a new entry, in the place of the undone one");
    cut_for(&mut harness, 1, [false, false]);
    // A stroke, and then a pull in the air, during which the first stroke is undone and redone.
    cut_for(&mut harness, 12, [true, false]);
    let before = maps_digest(harness.world.volume().maps());
    let above = |hand: usize| CUTS[hand] + Vec3::Y * 30.0;
    for command in [0, 0, commands::UNDO, commands::REDO] {
        let input =
            input_with_bits_at(&harness, [(above(LEFT), false), (above(RIGHT), command != 0)]);
        harness.step(&TickInput { commands: command, ..input });
    }
    assert_eq!(maps_digest(harness.world.volume().maps()), before);
    cut_for(&mut harness, 12, [false, true]);
    assert_eq!(counts(&harness), (3, 0), "what came after the redo is an entry of its own");
}

/// Starts with a floor and a rotary tool that has just lost tracking at `x` = 20 from the floor's middle.
fn start_with_a_gap(harness: &mut WorldHarness<128>) -> f32 {
    harness.start_from_voxels(|[_, y, _]| y < 20);
    take_item(harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let rest = rest_height(&grid_bit(harness, ToolBit::MediumBall), 20);
    step_with_bit_at(harness, RIGHT, Vec3::new(20.0, 40.0, 64.5), false);
    (0..3).for_each(|_| step_with_bit_at(harness, RIGHT, Vec3::new(20.0, rest, 64.5), true));
    harness.step(&TickInput::default());
    rest
}

/// After a gap the bit walks to its hand in several ticks, and edits only in the last, at its place then.
#[test]
fn after_a_gap_a_bit_cuts_where_it_has_caught_up() {
    let mut harness = lock(&HARNESS_128);
    let rest = start_with_a_gap(&mut harness);
    let there = Vec3::new(110.0, rest, 64.5);
    let mut walked = 0;
    loop {
        let before = DenseVolume::from_bits(harness.world.volume().rows());
        step_with_bit_at(&mut harness, RIGHT, there, true);
        let frozen = harness.world.hand_state(RIGHT).frozen_pose;
        let gone = before.difference(&DenseVolume::from_bits(harness.world.volume().rows()));
        if frozen.position.x < 109.0 {
            assert!(gone.is_empty(), "{} voxels on the way, at {frozen:?}", gone.count());
            walked += 1;
            continue;
        }
        assert!(!gone.is_empty() && walked > 2, "{walked} ticks");
        let piece = grid_bit(&harness, ToolBit::MediumBall).piece_at(&frozen);
        for voxel in gone.occupied() {
            let [x, y, z] = voxel.map(|i| i as usize);
            let is_now = piece.x_range(y, z, 128).is_some_and(|range| range.contains(x));
            assert!(is_now, "{voxel:?} was swept");
        }
        break;
    }
    // From here on the bit sweeps.
    let next = there - Vec3::X * 8.0;
    (0..2).for_each(|_| step_with_bit_at(&mut harness, RIGHT, next, true));
    assert!(!harness.world.volume().rows().contains([106, 19, 64]));
    assert!(harness.world.volume().rows().contains([60, 19, 64]));
}

/// Presses a running tool's bit `pressed_voxels` into a floor and draws it along at 0.1 m/s. Returns the
/// number of ticks in which the bit stood, and its distance from the hand at the end.
fn draw_along_floor<const N: usize>(
    harness: &'static Mutex<WorldHarness<N>>,
    pressed_voxels: f32,
) -> (u32, f32)
where
    Grid<N>: Size,
{
    let mut harness = lock(harness);
    harness.start_from_voxels(|[_, y, _]| y < N / 4);
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::FillGun));
    let radius = grid_bit(&harness, ToolBit::Nozzle).inscribed_radius_subunits();
    let n = N as f32;
    let height = n / 4.0 + radius as f32 / SUBUNITS_PER_VOXEL as f32 - pressed_voxels;
    let voxels_a_tick = 0.1 / 72.0 / harness.world.stool_frame().voxel_metres();
    let at = |tick: u32| Vec3::new(n * 0.2 + voxels_a_tick * tick as f32, height, n / 2.0);
    step_with_bit_at(&mut harness, RIGHT, at(0) + Vec3::Y * 9.0, false);
    step_with_bit_at(&mut harness, RIGHT, at(0), true);
    let mut stood = 0;
    for tick in 1..174 {
        let before = harness.world.hand_state(RIGHT).frozen_pose.position;
        step_with_bit_at(&mut harness, RIGHT, at(tick), true);
        stood += u32::from(harness.world.hand_state(RIGHT).frozen_pose.position == before);
    }
    (stood, harness.world.hand_state(RIGHT).frozen_pose.position.distance(at(173)))
}

/// The fill gun's brush equals its own ball: if its paste stopped it, it would stick.
#[test]
fn a_fill_gun_does_not_stick_in_its_paste() {
    let presses_mm = [0.0, 10.0, 2.0, 6.0];
    for pressed_mm in presses_mm {
        let (stood, lag) = draw_along_floor(&HARNESS_128, pressed_mm * 128.0 / 450.0);
        assert!(stood == 0 && lag < 0.1, "128, {pressed_mm} mm: {stood} ticks, {lag} voxels");
    }
    // The others run in the nightly run.
    for pressed_mm in sample_cases(presses_mm, 3) {
        let (stood, lag) = draw_along_floor(&HARNESS_256, pressed_mm * 256.0 / 450.0);
        assert!(stood == 0 && lag < 0.1, "256, {pressed_mm} mm: {stood} ticks, {lag} voxels");
    }
}

/// The mask stops a running nozzle, as it stops any bit.
#[test]
fn a_nozzle_that_runs_stays_out_of_the_mask() {
    let mut harness = lock(&HARNESS);
    harness.start_session(SessionMode::Constrained { figure: 0 });
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::FillGun));
    let bit = grid_bit(&harness, ToolBit::Nozzle);
    let middle = Vec3::new(32.0, 20.0, 32.0);
    step_with_bit_at(&mut harness, RIGHT, Vec3::new(80.0, 20.0, 32.0), false);
    let mut in_stone = 0;
    for tick in 0..60 {
        let angle = tick as f32 * 0.05;
        let out = Vec3::new(angle.cos(), 0.1, angle.sin()) * (40.0 - tick as f32).max(2.0);
        step_with_bit_at(&mut harness, RIGHT, middle + out, true);
        let mask = Some(harness.world.mask());
        let rows = harness.world.volume().rows();
        let pose = harness.world.hand_state(RIGHT).frozen_pose;
        let of_mask = Obstacle { rows, mask, is_mask_alone: true };
        assert_eq!(of_mask.contact_at(&bit, &pose).depth, 0, "tick {tick}: {pose:?}");
        let of_all = Obstacle { rows, mask, is_mask_alone: false };
        in_stone += u32::from(of_all.contact_at(&bit, &pose).depth > bit.bite);
    }
    assert!(in_stone > 10, "{in_stone} ticks deep in the stone");
}

/// Asserts that a tick changed only voxels within the bit's pose.
fn assert_changed_at_bit(harness: &WorldHarness<64>, bit: ToolBit, before: &DenseVolume) {
    let piece = grid_bit(harness, bit).piece_at(&harness.world.hand_state(RIGHT).frozen_pose);
    let after = volume_of(harness);
    let changed = before.difference(&after).union(&after.difference(before));
    assert!(!changed.is_empty(), "nothing changed");
    for voxel in changed.occupied() {
        let [x, y, z] = voxel.map(|i| i as usize);
        let is_now = piece.x_range(y, z, 64).is_some_and(|range| range.contains(x));
        assert!(is_now, "{voxel:?} is off the bit");
    }
}

/// With the trigger released, the nozzle stays in its paste while its hand is in the stone; once the trigger
/// is pulled again, the nozzle is at its hand.
#[test]
fn a_nozzle_that_begins_buried_lays_no_paste_on_the_way() {
    let mut harness = lock(&HARNESS);
    start_from_floor(&mut harness, 30);
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::FillGun));
    let here = Vec3::new(16.0, 30.0, 32.0);
    step_with_bit_at(&mut harness, RIGHT, here + Vec3::Y * 9.0, false);
    (0..6).for_each(|_| step_with_bit_at(&mut harness, RIGHT, here, true));
    let there = Vec3::new(48.0, 30.0, 32.0);
    for _ in 0..4 {
        step_with_bit_at(&mut harness, RIGHT, there, false);
        let frozen = harness.world.hand_state(RIGHT).frozen_pose.position;
        assert!(frozen.distance(here) < 0.1, "{frozen}: it stands");
    }
    let before = volume_of(&harness);
    step_with_bit_at(&mut harness, RIGHT, there, true);
    let frozen = harness.world.hand_state(RIGHT).frozen_pose.position;
    assert!(frozen.distance(there) < 0.1, "{frozen}: it is there");
    assert_changed_at_bit(&harness, ToolBit::Nozzle, &before);
}

/// An undo puts stone around the bit. The bit stays while its hand is in the stone, and joins the hand
/// outside, where it cuts without a sweep.
#[test]
fn a_bit_that_an_undo_buried_stands_and_then_jumps() {
    let mut harness = lock(&HARNESS);
    start_from_floor(&mut harness, 30);
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let here = |depth: f32| Vec3::new(16.0, 32.0 - depth, 32.0);
    (0..60).for_each(|tick| {
        step_with_bit_at(&mut harness, RIGHT, here(0.2 * tick as f32), true);
    });
    let deep = harness.world.hand_state(RIGHT).frozen_pose;
    assert!(deep.position.y < 24.0, "{deep:?}");
    step_with_bit_at(&mut harness, RIGHT, here(12.0), false);
    let deep = harness.world.hand_state(RIGHT).frozen_pose;
    harness.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
    for x in [16.0, 30.0, 48.0] {
        step_with_bit_at(&mut harness, RIGHT, Vec3::new(x, 20.0, 32.0), false);
        assert_eq!(harness.world.hand_state(RIGHT).frozen_pose, deep);
    }
    let before = volume_of(&harness);
    let rest = rest_height(&grid_bit(&harness, ToolBit::MediumBall), 30);
    step_with_bit_at(&mut harness, RIGHT, Vec3::new(48.0, rest, 32.0), true);
    let frozen = harness.world.hand_state(RIGHT).frozen_pose.position;
    assert!((frozen.x - 48.0).abs() < 0.1, "{frozen}");
    assert_changed_at_bit(&harness, ToolBit::MediumBall, &before);
}

/// A hand that is untracked for a tick doesn't edit while its bit stays buried either.
#[test]
fn a_hand_in_the_stone_moves_no_bit() {
    let mut harness = lock(&HARNESS);
    start_from_floor(&mut harness, 30);
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    let inside = |x: f32| Pose { position: Vec3::new(x, 15.0, 32.0), rotation: Quat::IDENTITY };
    let before = volume_of(&harness);
    for x in 0..30 {
        let hand = harness.world.hand_with_bit_at(RIGHT, &inside(10.0 + x as f32));
        harness.step(&input_with_hand(RIGHT, HandInput { trigger: 255, ..hand }));
        let frozen = harness.world.hand_state(RIGHT).frozen_pose.position;
        assert!((frozen.x - 10.0).abs() < 0.1, "{frozen}");
    }
    assert_eq!(volume_of(&harness), before);
}
