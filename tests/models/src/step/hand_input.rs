//! Model of a hand's input.

use paros_core::HandInput;
use paros_core::edit::{HalfSpace, Pose};
use paros_core::internals::RoomPose;
use paros_core::limits::FULL_TRIGGER;
use paros_core::session::{HandState, HandTrail, RawPose, buttons};

use crate::step::{NOWHERE, resize, stool};

/// New presses of a hand in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct HandPresses {
    /// `true` if the trigger was pulled.
    pub pulled: bool,
    /// `true` if the grip was squeezed.
    pub squeezed: bool,
    /// The buttons pressed.
    pub buttons: u8,
    /// The angle by which a hand that holds the stool moved round it, in 65,536ths of a turn.
    pub rim_turn: i32,
    /// Steps by which the stick enlarges a bit.
    pub larger_by: i32,
}

/// Returns the state of a hand that was never tracked.
pub(super) fn untracked_hand() -> HandState {
    let nowhere = Pose { position: NOWHERE.0, rotation: NOWHERE.1 };
    HandState {
        grip: NOWHERE,
        aim: NOWHERE,
        tracked: false,
        trigger: false,
        is_light: false,
        squeeze: false,
        awaits_release: false,
        holds_stool: false,
        buttons: 0,
        trigger_ticks: 0,
        frozen_pose: nowhere,
        raw_pose: nowhere,
        can_sweep: false,
        has_frozen_pose: false,
        haptic: 0,
        resize_push: 0,
        trail: HandTrail::EMPTY,
        above_float: HalfSpace::NOTHING,
    }
}

/// Applies a tick's input: the valid poses, and the presses of a tracked hand.
pub(super) fn apply_input(hand: &mut HandState, input: &HandInput) -> HandPresses {
    hand.haptic = 0;
    let had_a_grip = hand.grip.1.length_squared() > 0.0;
    let place_before = hand.grip.0;
    let valid = |pose: &RawPose| if input.tracked { pose.to_clamped_metres() } else { None };
    let update = |last: &mut RoomPose, pose: Option<RoomPose>| *last = pose.unwrap_or(*last);
    let grip = valid(&input.grip);
    update(&mut hand.grip, grip);
    update(&mut hand.aim, valid(&input.aim));
    hand.tracked = input.tracked && (grip.is_some() || had_a_grip);
    if !hand.tracked {
        (hand.trigger, hand.squeeze, hand.buttons, hand.trigger_ticks) = (false, false, 0, 0);
        (hand.can_sweep, hand.resize_push, hand.holds_stool) = (false, 0, false);
        return HandPresses::default();
    }
    let last = *hand;
    let stays_down = input.trigger >= 96;
    (hand.trigger, hand.awaits_release) = match (last.awaits_release, last.trigger) {
        (true, _) => (false, stays_down),
        (false, true) => (stays_down, false),
        (false, false) => (input.trigger >= 128, false),
    };
    hand.squeeze = input.squeeze >= if last.squeeze { 96 } else { 128 };
    hand.holds_stool = last.holds_stool && hand.squeeze;
    hand.buttons = input.buttons & (buttons::LOWER | buttons::UPPER | buttons::STICK);
    let begins = hand.trigger && !last.trigger;
    hand.is_light = match (hand.trigger, begins) {
        (false, _) => last.is_light,
        (true, true) => input.trigger < FULL_TRIGGER,
        (true, false) => last.is_light && input.trigger < FULL_TRIGGER,
    };
    hand.trigger_ticks =
        if hand.trigger && last.trigger { last.trigger_ticks.wrapping_add(1) } else { 0 };
    HandPresses {
        pulled: hand.trigger && !last.trigger,
        squeezed: hand.squeeze && !last.squeeze,
        buttons: hand.buttons & !last.buttons,
        rim_turn: match hand.holds_stool {
            true => stool::turn_of_way(place_before, hand.grip.0),
            false => 0,
        },
        larger_by: resize::push_stick(hand, input.stick),
    }
}
