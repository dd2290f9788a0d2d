//! Grabbing: tools that are swapped between the hands, and the stool, which is turned by its rim.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_6, PI, TAU};
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::internals::{STOOL_RADIUS, STOOL_TOP};
use paros_core::session::{
    BenchItem, GrabTarget, PointerCommand, SessionMode, TICK_RATE, Tool, commands,
};
use paros_core::{HandInput, TickInput, WorldEvent};
use paros_models::random_visitor::RandomSource;
use paros_models::scripted_hand::{
    LEFT, RIGHT, hand_input_at, input_with_hand, start_from_floor, take_item, volume_of,
};
use paros_models::world_harness::WorldHarness;

type Harness = WorldHarness<64, 2>;

fn lock_harness() -> MutexGuard<'static, Harness> {
    static HARNESS: Mutex<Harness> = Mutex::new(WorldHarness::new());
    HARNESS.lock().unwrap_or_else(PoisonError::into_inner)
}

const ROTARY: BenchItem = BenchItem::Tool(Tool::Rotary);
const IMPACT: BenchItem = BenchItem::Tool(Tool::Impact);

fn held(harness: &Harness) -> [Option<Tool>; 2] {
    [LEFT, RIGHT].map(|hand| harness.world.held_tool(hand).map(|(tool, _)| tool))
}

/// Returns the input of both hands with their bits at places of the grid.
fn hands_at(harness: &Harness, places: [Vec3; 2], trigger: u8) -> TickInput {
    let hands = [LEFT, RIGHT].map(|hand| {
        let pose = Pose { position: places[hand], rotation: Quat::IDENTITY };
        HandInput { trigger, ..harness.world.hand_with_bit_at(hand, &pose) }
    });
    TickInput { hands, ..TickInput::default() }
}

/// Returns the input of both hands at rest before the stone, with a command.
fn command(commands: u8) -> TickInput {
    let hands = [-0.3, 0.3].map(|x| hand_input_at(Vec3::new(x, 1.3, 0.1)));
    TickInput { hands, commands, ..TickInput::default() }
}

#[test]
fn a_swap_in_the_middle_of_a_stroke_keeps_nothing_of_it() {
    let harness = &mut *lock_harness();
    start_from_floor(harness, 30);
    take_item(harness, LEFT, IMPACT);
    take_item(harness, RIGHT, ROTARY);
    let pointer = PointerCommand::Steady { string_mm: 20 };
    harness.step(&TickInput { pointer, ..TickInput::default() });
    // Quick motions, so that bits lag behind their hands and the strings are taut.
    let at = |tick: u32| [16.0, 48.0].map(|x| Vec3::new(x, 29.0, 8.0 + 1.5 * tick as f32));
    for tick in 0..12 {
        harness.step(&hands_at(harness, at(tick), 255));
    }
    assert!(harness.world.is_stroke_open());
    let has_way_left = |hand: usize| !harness.world.hand_state(hand).trail.is_empty();
    assert!(has_way_left(LEFT) || has_way_left(RIGHT), "nothing is left to be dropped");
    let carved = volume_of(harness);
    let swap = TickInput { commands: commands::SWAP_HANDS, ..hands_at(harness, at(12), 255) };
    harness.step(&swap);
    assert_eq!(harness.world.events(), [WorldEvent::HandsSwapped]);
    assert_eq!(held(harness), [Some(Tool::Rotary), Some(Tool::Impact)]);
    for (hand, tool) in [(LEFT, Tool::Rotary), (RIGHT, Tool::Impact)] {
        let state = harness.world.hand_state(hand);
        assert!(!state.trigger && state.trail.is_empty() && state.trigger_ticks == 0);
        // The bit is at the hand, without a string.
        let (bit, rotation) = state.bit_centre_pose(tool.length_um() as f32 * 1e-6);
        let own = harness.world.stool_frame().to_grid(bit, rotation).position;
        assert!(state.raw_pose.position.distance(own) < 1e-3, "{hand}: {:?}", state.raw_pose);
    }
    assert!(!harness.world.is_stroke_open());
    // The triggers stay pulled, and are even out of sight for a while.
    for tick in 13..30 {
        let mut input = hands_at(harness, at(tick % 20), 255);
        input.hands[LEFT].tracked = tick % 5 > 0;
        harness.step(&input);
        assert!(!harness.world.is_stroke_open(), "tick {tick}");
    }
    assert_eq!(volume_of(harness), carved);
    assert_eq!(harness.world.undo_counts().undoable, 1);
    // Once released and pulled again, the tools run: a new stroke begins.
    harness.step(&hands_at(harness, at(8), 0));
    for tick in 0..12 {
        harness.step(&hands_at(harness, at(12 + tick / 2), 255));
    }
    assert!(volume_of(harness).count() < carved.count());
    harness.step(&hands_at(harness, at(18), 0));
    for _ in 0..20 {
        harness.step(&command(0));
    }
    assert_eq!(harness.world.undo_counts().undoable, 2);
    harness.step(&command(commands::UNDO));
    assert_eq!(volume_of(harness), carved, "it is undone alone");
}

/// A trigger pulled in the tick of a swap doesn't count, because its tool is now in the other hand.
#[test]
fn a_pull_in_the_tick_of_a_swap_waits_too() {
    let harness = &mut *lock_harness();
    start_from_floor(harness, 30);
    take_item(harness, RIGHT, ROTARY);
    let places = [16.0, 48.0].map(|x| Vec3::new(x, 28.0, 30.0));
    harness.step(&hands_at(harness, places, 0));
    let before = volume_of(harness);
    let pulled = hands_at(harness, places, 255);
    harness.step(&TickInput { commands: commands::SWAP_HANDS, ..pulled });
    for _ in 0..10 {
        harness.step(&hands_at(harness, places, 255));
    }
    assert_eq!(held(harness), [Some(Tool::Rotary), None]);
    assert_eq!(volume_of(harness), before);
}

#[test]
fn one_tool_goes_to_the_empty_hand_and_back_and_to_none_out_of_sight() {
    let harness = &mut *lock_harness();
    harness.start_session(SessionMode::FreeForm);
    let swap = command(commands::SWAP_HANDS);
    harness.step(&swap);
    assert_eq!((harness.world.events(), held(harness)), (&[][..], [None; 2]));
    take_item(harness, RIGHT, ROTARY);
    for expected in [[Some(Tool::Rotary), None], [None, Some(Tool::Rotary)]] {
        harness.step(&swap);
        assert_eq!(harness.world.events(), [WorldEvent::HandsSwapped]);
        assert_eq!(held(harness), expected);
    }
    // The tool keeps its size and mounting.
    harness.step(&TickInput {
        pointer: PointerCommand::Resize { hand: 1, by: 2 },
        ..TickInput::default()
    });
    let spec = harness.world.held_bit_spec(RIGHT);
    let mut unseen = swap;
    unseen.hands[LEFT].tracked = false;
    harness.step(&unseen);
    assert_eq!((harness.world.events(), held(harness)[RIGHT]), (&[][..], Some(Tool::Rotary)));
    harness.step(&swap);
    assert_eq!(harness.world.held_bit_spec(LEFT), spec);
    // The empty hand needn't be tracked.
    unseen.hands.swap(LEFT, RIGHT);
    unseen.hands[LEFT].tracked = false;
    unseen.hands[RIGHT].tracked = true;
    harness.step(&unseen);
    assert_eq!(held(harness), [None, Some(Tool::Rotary)]);
    // After a finish, tools can't be swapped.
    harness.step(&command(commands::FINISH));
    harness.step(&swap);
    assert_eq!(held(harness), [None, Some(Tool::Rotary)]);
}

/// Returns the point of the stool's rim at a bearing, counter-clockwise from x.
fn at_rim(bearing: f32) -> Vec3 {
    STOOL_TOP + Quat::from_rotation_y(bearing) * Vec3::X * STOOL_RADIUS
}

fn squeezed_at(place: Vec3) -> HandInput {
    HandInput { squeeze: 255, ..hand_input_at(place) }
}

/// Returns the stool's rotation in radians, from -PI to PI.
fn stool_turn(harness: &Harness) -> f32 {
    let (_, turn) = harness.world.stool_frame().to_room(&Pose::ZERO);
    let radians = 2.0 * turn.y.atan2(turn.w);
    (radians + PI).rem_euclid(TAU) - PI
}

fn start_unturned() -> MutexGuard<'static, Harness> {
    let mut harness = lock_harness();
    harness.start_session(SessionMode::FreeForm);
    harness
}

/// Starts a new session, so that the stool is back at its initial rotation.
fn turn_back(harness: &mut Harness) {
    harness.start_session(SessionMode::FreeForm);
}

/// Moves a squeezed hand round the stool's axis within a number of ticks.
fn go_round(harness: &mut Harness, hand: usize, from: f32, by: f32, ticks: u32) {
    for tick in 0..=ticks {
        let bearing = from + by * tick as f32 / ticks as f32;
        harness.step(&input_with_hand(hand, squeezed_at(at_rim(bearing))));
    }
}

#[test]
fn each_hand_turns_the_stool_by_its_way_until_it_lets_go() {
    for hand in [LEFT, RIGHT] {
        for by in [FRAC_PI_6, -FRAC_PI_6, 2.0, -2.5] {
            let harness = &mut *start_unturned();
            // Starts near the bearing at which the angle wraps.
            go_round(harness, hand, -3.0, by, 2 * TICK_RATE);
            assert!(
                (stool_turn(harness) - by).abs() < 1e-3,
                "{hand} {by}: {}",
                stool_turn(harness)
            );
            let still = harness.world.stool_frame();
            harness.step(&input_with_hand(hand, hand_input_at(at_rim(by + 0.1))));
            harness.step(&input_with_hand(hand, hand_input_at(at_rim(by + 0.2))));
            assert_eq!(harness.world.stool_frame(), still, "it has let go");
            // A hand squeezed away from the rim doesn't grab it on its way past.
            for step in 0..20 {
                let place = at_rim(by) + Vec3::Y * (0.3 - 0.015 * step as f32);
                harness.step(&input_with_hand(hand, squeezed_at(place)));
            }
            go_round(harness, hand, by, 0.5, 30);
            assert_eq!(harness.world.stool_frame(), still);
        }
    }
}

/// A hand slower than one unit of the stool's angle a tick still keeps its place on the rim.
#[test]
fn a_slow_hand_keeps_its_place_on_the_rim() {
    let harness = &mut *start_unturned();
    go_round(harness, LEFT, 1.0, 0.05, 20 * TICK_RATE);
    assert!((stool_turn(harness) - 0.05).abs() < 2e-4, "{}", stool_turn(harness));
}

#[test]
fn a_hand_that_jumps_or_hurries_turns_it_no_faster_than_a_stick() {
    let a_tick = FRAC_PI_2 / TICK_RATE as f32;
    let harness = &mut *start_unturned();
    for jump in [FRAC_PI_2, -FRAC_PI_2, 3.0] {
        turn_back(harness);
        harness.step(&input_with_hand(RIGHT, squeezed_at(at_rim(0.0))));
        harness.step(&input_with_hand(RIGHT, squeezed_at(at_rim(jump))));
        let turned = stool_turn(harness);
        assert!((turned.abs() - a_tick).abs() < 1e-3 && turned * jump > 0.0, "{jump}: {turned}");
    }
    turn_back(harness);
    go_round(harness, RIGHT, 0.0, PI, TICK_RATE);
    assert!((stool_turn(harness) - FRAC_PI_2).abs() < 0.02, "{}", stool_turn(harness));
    // Over the axis the hand has no bearing; beyond it the turn resumes.
    turn_back(harness);
    for step in -20..=20 {
        let place = STOOL_TOP + Vec3::X * (STOOL_RADIUS * step as f32 / 20.0);
        harness.step(&input_with_hand(RIGHT, squeezed_at(place)));
    }
    assert!(stool_turn(harness).abs() < 1e-4, "{}", stool_turn(harness));
    // A hand that is lost from sight lets go; a new squeeze grabs again.
    go_round(harness, RIGHT, 0.0, 0.3, 30);
    let turned = stool_turn(harness);
    harness.step(&input_with_hand(RIGHT, HandInput { tracked: false, ..squeezed_at(at_rim(0.4)) }));
    harness.step(&input_with_hand(RIGHT, squeezed_at(at_rim(0.5))));
    assert!((stool_turn(harness) - turned).abs() < 1e-4);
    harness.step(&input_with_hand(RIGHT, squeezed_at(at_rim(0.51))));
    assert!((stool_turn(harness) - turned - 0.01).abs() < 1e-3);
}

#[test]
fn two_hands_turn_it_by_the_mean_of_their_ways() {
    let harness = &mut *start_unturned();
    for (ways, expected) in [([0.5, 0.5], 0.5), ([0.5, 0.0], 0.25), ([0.5, -0.5], 0.0)] {
        turn_back(harness);
        for tick in 0..=TICK_RATE {
            let part = tick as f32 / TICK_RATE as f32;
            let bearings = [PI + ways[0] * part, ways[1] * part];
            let hands = bearings.map(|bearing| squeezed_at(at_rim(bearing)));
            harness.step(&TickInput { hands, ..TickInput::default() });
        }
        let turned = stool_turn(harness);
        assert!((turned - expected).abs() < 0.01, "{ways:?}: {turned}");
    }
    // The grab combines with a stick and the pointer.
    turn_back(harness);
    harness.step(&input_with_hand(LEFT, squeezed_at(at_rim(PI))));
    let mut input = input_with_hand(LEFT, squeezed_at(at_rim(PI + 0.01)));
    input.hands[RIGHT] = HandInput { stick: [127, 0], ..hand_input_at(Vec3::Y) };
    input.pointer = PointerCommand::Turn { by: 1000 };
    harness.step(&input);
    let expected = 0.01 + (227.0 + 1000.0) / 65_536.0 * TAU;
    assert!((stool_turn(harness) - expected).abs() < 2e-4);
}

/// A squeeze takes exactly the target that the world announced, wherever the hand is and whatever it holds. A
/// hand with a tool grabs no stool.
#[test]
fn a_squeeze_takes_what_is_told_before() {
    let harness = &mut *lock_harness();
    let mut dice = RandomSource::new(5);
    let mut counts = [0; 4];
    for round in 0..3000u32 {
        if round % 50 == 0 {
            harness.start_session(SessionMode::FreeForm);
        }
        let mut part = |least: f32, most: f32| {
            least + (most - least) * (dice.next_bits() as u32 as f32 / u32::MAX as f32)
        };
        let near_rim = at_rim(part(-PI, PI));
        let aside = Vec3::new(part(-0.15, 0.15), part(-0.15, 0.15), part(-0.15, 0.15));
        let at_bench = Vec3::new(part(0.4, 0.9), 0.86, part(-0.6, 0.3));
        let place = if round % 3 == 0 { at_bench + aside * 0.3 } else { near_rim + aside };
        let hand = (round / 2 % 2) as usize;
        harness.step(&input_with_hand(hand, hand_input_at(place)));
        let told = harness.world.grab_target(hand);
        assert_eq!(harness.world.grab_target(1 - hand), None, "a hand that isn't tracked");
        let had_tool = harness.world.held_tool(hand).is_some();
        harness.step(&input_with_hand(hand, squeezed_at(place)));
        let (events, state) = (harness.world.events(), harness.world.hand_state(hand));
        match told {
            Some(GrabTarget::Item(item)) => {
                assert_eq!(events, [WorldEvent::Took { hand: hand as u8, item }]);
            }
            Some(GrabTarget::Stool) => assert!(events.is_empty() && !had_tool),
            None if had_tool => assert!(matches!(events, [WorldEvent::Released { .. }])),
            None => assert!(events.is_empty()),
        }
        assert_eq!(state.holds_stool, told == Some(GrabTarget::Stool));
        counts[match told {
            Some(GrabTarget::Item(_)) => 0,
            Some(GrabTarget::Stool) => 1,
            None if had_tool => 2,
            None => 3,
        }] += 1;
        harness.step(&input_with_hand(hand, hand_input_at(place)));
    }
    assert!(counts.iter().all(|count| *count > 60), "{counts:?}");
    harness.step(&command(commands::FINISH));
    harness.step(&input_with_hand(LEFT, hand_input_at(at_rim(0.0))));
    assert_eq!(harness.world.grab_target(LEFT), None, "the sculpture is final");
}

#[test]
fn a_hand_that_is_given_a_tool_lets_go_of_the_stool() {
    let harness = &mut *start_unturned();
    harness.step(&input_with_hand(LEFT, squeezed_at(at_rim(PI))));
    let pointer = PointerCommand::Take { hand: 0, item: ROTARY.number() as u8 };
    harness.step(&TickInput { pointer, ..input_with_hand(LEFT, squeezed_at(at_rim(PI))) });
    assert!(!harness.world.hand_state(LEFT).holds_stool);
    harness.step(&input_with_hand(LEFT, squeezed_at(at_rim(PI + 0.01))));
    assert_eq!(stool_turn(harness), 0.0);
    // A swap, too, makes a hand let go.
    turn_back(harness);
    take_item(harness, RIGHT, ROTARY);
    let mut input = command(0);
    input.hands[LEFT] = squeezed_at(at_rim(PI));
    harness.step(&input);
    assert!(harness.world.hand_state(LEFT).holds_stool);
    input.commands = commands::SWAP_HANDS;
    harness.step(&input);
    assert!(!harness.world.hand_state(LEFT).holds_stool);
}
