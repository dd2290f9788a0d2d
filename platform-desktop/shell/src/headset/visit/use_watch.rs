//! Detection of use from the poses of head and hands: a headset that lies on a table with its controllers
//! beside it moves no more than its tracking noise.

use paros_core::session::RawPose;
use paros_core::{HandInput, TickInput};

/// The distance and angle within which a tracked object counts as still.
struct Stillness {
    metres: f32,
    radians: f32,
}

/// The stillness of the headset. A worn one sways farther within seconds, even if its visitor stands and
/// looks; one that lies is tracked to millimetres.
const HEAD_STILLNESS: Stillness = Stillness { metres: 0.01, radians: 0.035 };

/// Controllers are tracked less well than the head, and bare hands worse.
const HAND_STILLNESS: Stillness = Stillness { metres: 0.02, radians: 0.09 };

/// The difference of trigger, squeeze and stick, of 255, within which they count as unmoved: their springs
/// are not exact.
const INPUT_STILLNESS: i32 = 16;

/// Compares inputs with those at the last use.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(super) struct UseWatch {
    head: RawPose,
    hands: [HandInput; 2],
    is_menu_down: bool,
}

impl UseWatch {
    /// Returns `true` if a tick's input shows a use: head, hands or a control have moved. Untracked objects
    /// don't count, nor do objects that are tracked for the first time.
    pub(super) fn observe(&mut self, input: &TickInput, is_menu_down: bool) -> bool {
        let mut is_used = has_strayed(&mut self.head, input.head, &HEAD_STILLNESS);
        for (seen, now) in self.hands.iter_mut().zip(&input.hands) {
            is_used |= now.tracked && has_hand_moved(seen, now);
        }
        is_used | (core::mem::replace(&mut self.is_menu_down, is_menu_down) != is_menu_down)
    }

    /// Forgets the poses of head and hands, because their reference space has changed.
    pub(super) fn forget_poses(&mut self) {
        self.head = RawPose::default();
        self.hands.iter_mut().for_each(|hand| hand.grip = RawPose::default());
    }
}

/// Returns `true` if a tracked hand or its controls have moved.
fn has_hand_moved(seen: &mut HandInput, now: &HandInput) -> bool {
    let has_strayed = has_strayed(&mut seen.grip, now.grip, &HAND_STILLNESS);
    let levers = |hand: &HandInput| {
        let [x, y] = hand.stick.map(i32::from);
        [i32::from(hand.trigger), i32::from(hand.squeeze), x, y]
    };
    let mut pairs = levers(seen).into_iter().zip(levers(now));
    let differs =
        seen.buttons != now.buttons || pairs.any(|(a, b)| (a - b).abs() > INPUT_STILLNESS);
    let is_known = seen.tracked;
    if differs || !is_known {
        *seen = HandInput { grip: seen.grip, ..*now };
    }
    has_strayed || differs && is_known
}

/// Returns `true` if a pose has moved farther from `seen` than `stillness` allows; it then replaces `seen`.
fn has_strayed(seen: &mut RawPose, now: RawPose, stillness: &Stillness) -> bool {
    let Some((position, rotation)) = now.to_clamped_metres() else { return false };
    let strayed = seen.to_clamped_metres().map(|(before, turned)| {
        before.distance(position) > stillness.metres
            || turned.angle_between(rotation) > stillness.radians
    });
    if strayed != Some(false) {
        *seen = now;
    }
    strayed == Some(true)
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};
    use paros_core::session::{RawPose, buttons};
    use paros_core::{HandInput, TickInput};

    use super::UseWatch;

    fn pose(x: f32, yaw: f32) -> RawPose {
        RawPose::quantise(Vec3::new(x, 1.5, 0.0), Quat::from_rotation_y(yaw))
    }

    fn hand(x: f32) -> HandInput {
        HandInput { grip: pose(x, 0.0), aim: pose(x, 0.0), tracked: true, ..HandInput::default() }
    }

    /// Returns the input of a headset and its right controller on a table.
    fn at_rest() -> TickInput {
        let hands = [HandInput::default(), hand(0.3)];
        TickInput { head: pose(0.0, 0.0), hands, ..TickInput::default() }
    }

    /// Returns, for each input after [`at_rest`], whether it shows a use.
    fn watch(inputs: &[TickInput]) -> Vec<bool> {
        let mut watch = UseWatch::default();
        assert!(!watch.observe(&at_rest(), false), "what is there for the first time");
        inputs.iter().map(|input| watch.observe(input, false)).collect()
    }

    #[test]
    fn what_lies_trembles_and_is_not_used() {
        for (x, yaw) in [(0.005, 0.0), (-0.005, 0.02), (0.0, -0.02)] {
            let mut input = at_rest();
            input.head = pose(x, yaw);
            input.hands[1].grip = pose(0.3 + x, yaw);
            input.hands[1].trigger = 9;
            input.hands[1].stick = [5, -5];
            assert_eq!(watch(&[input, at_rest(), input]), [false; 3], "{x} {yaw}");
        }
    }

    #[test]
    fn head_hands_and_controls_show_a_use_by_themselves_and_once() {
        let cases: [fn(&mut TickInput); 8] = [
            |input| input.head = pose(0.02, 0.0),
            |input| input.head = pose(0.0, 0.05),
            |input| input.hands[1].grip = pose(0.33, 0.0),
            |input| input.hands[1].grip = pose(0.3, 0.12),
            |input| input.hands[1].trigger = 40,
            |input| input.hands[1].squeeze = 255,
            |input| input.hands[1].stick = [0, -100],
            |input| input.hands[1].buttons = buttons::LOWER,
        ];
        for (i, change) in cases.into_iter().enumerate() {
            let mut input = at_rest();
            change(&mut input);
            assert_eq!(watch(&[input, input, at_rest()]), [true, false, true], "case {i}");
        }
        let mut menu = UseWatch::default();
        assert_eq!(
            [true, true, false].map(|down| menu.observe(&at_rest(), down)),
            [true, false, true]
        );
    }

    #[test]
    fn slow_motion_adds_up() {
        let creep: Vec<TickInput> = (0..100u8)
            .map(|i| TickInput { head: pose(f32::from(i) * 0.001, 0.0), ..at_rest() })
            .collect();
        assert!((8..=10).contains(&watch(&creep).iter().filter(|used| **used).count()));
    }

    #[test]
    fn what_is_lost_or_found_in_its_place_shows_nothing() {
        let lost = TickInput { head: RawPose::default(), hands: Default::default(), ..at_rest() };
        assert_eq!(watch(&[lost, at_rest(), lost]), [false; 3]);
        let found = TickInput { hands: [hand(-0.3), hand(0.3)], ..at_rest() };
        assert_eq!(watch(&[found, found]), [false; 2]);
    }

    #[test]
    fn another_space_is_no_motion() {
        let mut watch = UseWatch::default();
        watch.observe(&at_rest(), false);
        watch.forget_poses();
        let mut moved = at_rest();
        (moved.head, moved.hands[1].grip) = (pose(2.0, 1.0), pose(2.3, 1.0));
        assert!(!watch.observe(&moved, false));
        assert!(watch.observe(&at_rest(), false));
    }
}
