//! Presses on buttons that have just appeared.

use glam::Vec3;
use paros_core::visit::{Presence, StaffCommand, VisitPhase};

use super::{HostRig, Press, begin_sculpting, with_rig};
use crate::host::Question;
use crate::pointing::{Pointer, UNAIMED_TICKS};
use crate::screen::ButtonAction;
use crate::standing::room_pose;

/// In the attract phase, the first touch of a screen or press of a mouse button opens the welcome.
#[test]
fn the_first_touch_presses_nothing_that_appears_under_it() {
    with_rig(|rig| {
        rig.presence = Presence::Worn;
        rig.tick(None);
        let confirm = format!("{:?}", ButtonAction::Press(Press::Confirm));
        let begin = |rig: &HostRig<'_, '_>| rig.host.buttons().find(|(name, _)| *name == confirm);
        rig.host.place_panels(|spot, size| room_pose(spot, size, 1.6));
        let (_, target) = begin(rig).expect("the welcome");
        let origin = Vec3::new(0.35, 1.35, 0.1);
        let touch = |is_pressed| {
            Some(Pointer { origin, direction: target - origin, is_pressed, fingertip: None })
        };
        // A window receives a finger's position a frame before its press, which takes some ticks.
        for is_pressed in [false, false, true, true, true, false, true, false] {
            rig.tick(touch(is_pressed));
        }
        rig.wait(UNAIMED_TICKS);
        assert_eq!(rig.phase(), VisitPhase::Welcome, "nobody has read it");
        [true, false].into_iter().for_each(|is_pressed| rig.tick(touch(is_pressed)));
        rig.wait(2);
        assert_eq!(rig.phase(), VisitPhase::Choice);
    });
}

#[test]
fn a_button_that_a_warning_moves_is_not_pressed_at_once() {
    with_rig(|rig| {
        begin_sculpting(rig);
        let finish = ButtonAction::Ask(Question::Finish);
        let find = |rig: &HostRig<'_, '_>| {
            let mut buttons = rig.host.buttons();
            buttons.find(|(name, _)| *name == format!("{finish:?}")).expect("a clock").1
        };
        let before = find(rig);
        rig.host.perform(ButtonAction::Staff(StaffCommand::Extend));
        rig.tick(None);
        rig.host.place_panels(|spot, size| room_pose(spot, size, 1.6));
        let target = find(rig);
        assert!(target.distance(before) > 0.05, "what is told moves it");
        let origin = Vec3::new(0.35, 1.35, 0.1);
        let mut press = |is_pressed| {
            let direction = target - origin;
            rig.tick(Some(Pointer { origin, direction, is_pressed, fingertip: None }));
            rig.host.question
        };
        assert_eq!([false, true, false].map(&mut press), [Question::None; 3]);
        (0..UNAIMED_TICKS).for_each(|_| _ = press(false));
        assert_eq!(press(true), Question::Finish);
    });
}
