//! Presses of rays, triggers and fingers on a panel.

use core::f32::consts::FRAC_PI_2;

use glam::{Quat, Vec3};
use paros_shaders::panel::layout::welcome_buttons;
use paros_shaders::panel::{Panel, PanelPose};
use paros_shell::headset::hand_sample::HandSample;

use crate::screen::point_in_room;

use super::{
    GRIP_REACH, HOVER_TAP, PRESS_TAP, PanelRay, Pointer, Pointing, ShownButton, UNAIMED_TICKS,
};

const PLACE: Vec3 = Vec3::new(0.9, 1.5, -1.0);

fn shown() -> (Vec<Panel>, Vec<ShownButton>) {
    let mut panel = Panel::new([1080.0, 720.0]);
    panel.pose = PanelPose::facing(PLACE, Vec3::new(0.0, 1.6, 0.0));
    let buttons = welcome_buttons(10, 3).map(|button| ShownButton { panel: 0, button });
    (vec![panel], buttons.to_vec())
}

/// Returns a point in the room in front of a button's centre.
fn before(panel: &Panel, button: &ShownButton, metres: f32) -> Vec3 {
    let middle = point_in_room(panel, button.button.rect.middle());
    middle + panel.pose.rotation * Vec3::Z * metres
}

fn ray_to(target: Vec3, is_pressed: bool) -> Pointer {
    let origin = Vec3::new(0.25, 1.1, 0.2);
    Pointer { origin, direction: target - origin, is_pressed, fingertip: None }
}

#[test]
fn a_ray_presses_once_and_only_where_it_is_pulled_upon() {
    let (panels, buttons) = shown();
    let mut pointing = Pointing::default();
    let at = |k: usize| before(&panels[0], &buttons[k], 0.0);
    let mut follow = |target, is_pressed| {
        let pointers = [None, Some(ray_to(target, is_pressed)), None];
        let pressed = pointing.follow(&pointers, &panels, &buttons, false);
        (pressed, pointing.is_on_button(1))
    };
    assert_eq!(follow(at(2), false), (None, true));
    assert_eq!(follow(at(2), true), (Some(12), true));
    assert_eq!(follow(at(2), true), (None, true), "held down");
    assert_eq!(follow(at(3), true), (None, true), "drawn over another");
    assert_eq!(follow(Vec3::NEG_Z * 9.0, true), (None, true), "still the button's press");
    assert_eq!(follow(Vec3::NEG_Z * 9.0, false), (None, false));
    assert_eq!(follow(Vec3::NEG_Z * 9.0, true), (None, false));
    assert_eq!(follow(at(6), true), (None, true), "pulled elsewhere");
}

#[test]
fn a_hand_points_where_it_aims_and_touches_with_its_foremost_point() {
    let turn = Quat::from_rotation_y(FRAC_PI_2);
    let sample = HandSample {
        aim: Some((Vec3::X, turn)),
        grip: Some((Vec3::Y, turn)),
        trigger: 0.5,
        ..HandSample::default()
    };
    let pointer = Pointer::of_hand(&sample).expect("it aims");
    assert_eq!(pointer.origin, Vec3::X);
    assert!(pointer.direction.distance(Vec3::NEG_X) < 1e-6 && !pointer.is_pressed);
    let foremost = Vec3::new(-GRIP_REACH, 1.0, 0.0);
    assert!(pointer.fingertip.is_some_and(|tip| tip.distance(foremost) < 1e-6));
    let bare = HandSample { fingertip: Some(Vec3::Z), trigger: 0.51, grip: None, ..sample };
    let pointer = Pointer::of_hand(&bare).expect("it aims");
    assert_eq!((pointer.fingertip, pointer.is_pressed), (Some(Vec3::Z), true));
    assert_eq!(Pointer::of_hand(&HandSample { aim: None, ..sample }), None);
}

#[test]
fn a_button_is_felt_when_a_hand_comes_onto_it_and_when_it_is_pressed() {
    let (panels, buttons) = shown();
    let mut pointing = Pointing::default();
    let at = |k: usize| before(&panels[0], &buttons[k], 0.0);
    let mut feel = |target, is_pressed| {
        pointing.follow(&[None, Some(ray_to(target, is_pressed)), None], &panels, &buttons, false);
        assert_eq!(pointing.tap(0), 0, "of the other hand");
        pointing.tap(1)
    };
    let away = Vec3::NEG_Z * 9.0;
    let felt = [
        feel(away, false),
        feel(at(2), false),
        feel(at(2), false),
        feel(at(2), true),
        feel(at(2), true),
        feel(at(3), true),
        feel(away, false),
    ];
    assert_eq!(felt, [0, HOVER_TAP, 0, PRESS_TAP, 0, HOVER_TAP, 0]);
}

#[test]
fn a_ray_ends_on_the_panel_that_has_buttons() {
    let (panels, buttons) = shown();
    let mut pointing = Pointing::default();
    let target = panels[0].pose.middle;
    let mut ray = |target, buttons: &[ShownButton]| {
        pointing.follow(&[Some(ray_to(target, false)), None, None], &panels, buttons, false);
        pointing.rays()[0]
    };
    let PanelRay { panel, ends } = ray(target, &buttons).expect("a ray");
    assert_eq!((panel, ends[0]), (0, ray_to(target, false).origin));
    assert!(ends[1].distance(target) < 1e-4, "{ends:?}");
    assert_eq!(ray(target, &[]), None, "there is nothing to press");
    assert_eq!(ray(Vec3::NEG_Z * 9.0, &buttons), None);
}

#[test]
fn a_finger_presses_by_touch() {
    let (panels, buttons) = shown();
    let mut pointing = Pointing::default();
    let mut touch = |metres| {
        let tip = before(&panels[0], &buttons[4], metres);
        let away = Pointer { fingertip: Some(tip), ..ray_to(Vec3::Z * 9.0, false) };
        pointing.follow(&[Some(away), None, None], &panels, &buttons, true)
    };
    assert_eq!(touch(0.05), None);
    assert_eq!(touch(0.01), Some(14));
    assert_eq!(touch(-0.01), None, "still touching");
    assert_eq!(touch(0.05), None);
    assert_eq!(touch(0.0), Some(14));
}

#[test]
fn a_hand_that_was_lost_for_a_while_presses_nothing_again() {
    let (panels, buttons) = shown();
    let mut pointing = Pointing::default();
    let on_button = ray_to(before(&panels[0], &buttons[2], 0.0), true);
    let mut follow = |pointer| {
        let pressed = pointing.follow(&[None, pointer, None], &panels, &buttons, false);
        (pressed, pointing.is_on_button(1))
    };
    assert_eq!(follow(Some(on_button)), (Some(12), true));
    follow(None);
    assert_eq!(follow(Some(on_button)), (None, true), "held down all the while");
    let mut pointing = Pointing::default();
    let mut touch = |is_seen: bool| {
        let tip = before(&panels[0], &buttons[4], 0.0);
        let pointer = Pointer { fingertip: Some(tip), ..ray_to(Vec3::Z * 9.0, false) };
        pointing.follow(&[is_seen.then_some(pointer), None, None], &panels, &buttons, false)
    };
    assert_eq!([true, false, true].map(&mut touch), [Some(14), None, None]);
}

#[test]
fn a_hand_at_work_on_the_stone_presses_nothing_behind_it() {
    let (mut panels, buttons) = shown();
    panels[0].pose = PanelPose::facing(Vec3::new(0.0, 1.3, -1.2), Vec3::new(0.0, 1.4, 0.0));
    let mut pointing = Pointing::default();
    let target = before(&panels[0], &buttons[6], 0.0);
    for is_stone_between in [true, false] {
        let at_work = Pointer { origin: Vec3::new(0.0, 1.05, -0.2), ..ray_to(target, false) };
        let at_work = Pointer { direction: target - at_work.origin, ..at_work };
        pointing.follow(&[Some(at_work), None, None], &panels, &buttons, is_stone_between);
        assert_eq!(pointing.is_on_button(0), !is_stone_between);
    }
}

#[test]
fn what_is_held_down_presses_nothing_of_the_next_screen() {
    let (panels, buttons) = shown();
    let mut pointing = Pointing::default();
    let pointers = [Some(ray_to(before(&panels[0], &buttons[6], 0.0), true)), None, None];
    assert_eq!(pointing.follow(&pointers, &panels, &buttons, false), Some(16));
    pointing.forget_buttons();
    assert_eq!(pointing.hot_buttons(), [None; 3]);
    assert_eq!(pointing.follow(&pointers, &panels, &buttons, false), None);
}

/// A press when buttons appear was meant for what was there before: by trigger, finger or mouse.
#[test]
fn what_has_just_appeared_is_pressed_only_by_who_can_have_seen_it() {
    let (panels, buttons) = shown();
    let on_button = before(&panels[0], &buttons[2], 0.0);
    let by_ray = |is_pressed| ray_to(on_button, is_pressed);
    let by_finger = |touches: bool| {
        let tip = if touches { on_button } else { on_button + Vec3::Z };
        Pointer { fingertip: Some(tip), ..ray_to(Vec3::NEG_Z * 9.0, false) }
    };
    for press in [&by_ray as &dyn Fn(bool) -> Pointer, &by_finger] {
        let mut pointing = Pointing::default();
        let follow = |pointing: &mut Pointing, is_down| {
            pointing.follow(&[None, None, Some(press(is_down))], &panels, &buttons, false)
        };
        pointing.forget_buttons();
        for tick in 0..UNAIMED_TICKS {
            // Press and release repeatedly.
            assert_eq!(follow(&mut pointing, tick % 3 == 1), None, "tick {tick}");
        }
        follow(&mut pointing, false);
        assert_eq!(follow(&mut pointing, true), Some(12));
        // A press that began too soon doesn't count later.
        pointing.forget_buttons();
        follow(&mut pointing, false);
        let held = (0..2 * UNAIMED_TICKS).find_map(|_| follow(&mut pointing, true));
        assert_eq!(held, None);
    }
}
