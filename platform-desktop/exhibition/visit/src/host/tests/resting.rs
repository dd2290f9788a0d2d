//! A window's idle visitor, whose only sign is the mouse.

use paros_core::session::{SessionState, TICK_RATE};
use paros_core::visit::{GuideStep, Presence, VisitPhase};

use super::guide::begin_guide;
use super::{HostRig, Press, begin_sculpting, cut, go_to_badge, options, with_rig};
use crate::options::Controls;
use crate::screen::ButtonAction;

/// Returns the seconds of the shown countdown after each idle second, until another phase begins.
fn countdown(rig: &mut HostRig<'_, '_>) -> Vec<Option<u32>> {
    let phase = rig.phase();
    rig.presence = Presence::Unknown;
    let mut shown = Vec::new();
    while rig.phase() == phase {
        rig.wait(1);
        let told = rig.host.screen.told_rest();
        if shown.last() != Some(&told) {
            shown.push(told);
        }
    }
    shown
}

#[test]
fn before_a_window_gives_a_visitor_up_it_counts_down_and_any_motion_ends_that() {
    with_rig(|rig| {
        rig.host.set_controls(Controls::Mouse);
        rig.presence = Presence::Worn;
        rig.wait(2);
        rig.presence = Presence::Unknown;
        rig.wait(TICK_RATE);
        assert_eq!(rig.host.screen.told_rest(), Some(14));
        assert_eq!(rig.host.buttons().count(), 0, "it covers them");
        rig.presence = Presence::Worn;
        rig.wait(1);
        assert_eq!((rig.phase(), rig.host.screen.told_rest()), (VisitPhase::Welcome, None));
        assert!(rig.host.buttons().count() > 0);
        let told = countdown(rig);
        let expected: Vec<_> = (0..=15).rev().filter(|left| *left > 0).map(Some).collect();
        assert_eq!(told[..15], expected);
        assert_eq!(rig.phase(), VisitPhase::Attract);
    });
}

#[test]
fn who_sculpts_may_rest_for_long_and_is_told_for_twenty_seconds_at_most() {
    with_rig(|rig| {
        rig.host.set_controls(Controls::Mouse);
        begin_sculpting(rig);
        cut(rig);
        // The countdown replaces any question.
        assert!(rig.press(ButtonAction::Ask(super::super::Question::Finish)));
        let told = countdown(rig);
        let expected: Vec<_> = core::iter::once(None).chain((1..=20).rev().map(Some)).collect();
        assert_eq!(told[..21], expected);
        assert_eq!(rig.phase(), VisitPhase::HandsOff);
    });
}

/// The runtime reports that a headset is worn, or how it moves. Its visitor may stand and look.
#[test]
fn a_headsets_visitor_is_not_counted_down() {
    with_rig(|rig| {
        rig.presence = Presence::Worn;
        rig.wait(2);
        assert!(countdown(rig).iter().all(Option::is_none));
    });
}

/// The staff's panel stays open, whatever happens to the visitor.
#[test]
fn the_staff_is_asked_on_while_a_visitor_is_counted_down() {
    with_rig(|rig| {
        rig.host.set_controls(Controls::Mouse);
        begin_sculpting(rig);
        rig.host.toggle_staff_panel();
        rig.presence = Presence::Unknown;
        rig.wait(2 * TICK_RATE);
        assert!(rig.press(ButtonAction::Digit(2)));
        assert!(!rig.press(ButtonAction::Press(Press::Finish)));
    });
}

/// Goes to the thanks of a visitor who made nothing.
fn go_to_thanks(rig: &mut HostRig<'_, '_>) {
    begin_sculpting(rig);
    rig.host.perform(ButtonAction::Press(Press::Finish));
    while rig.phase() != VisitPhase::Thanks {
        rig.tick(None);
    }
    // The host places its panel in the next tick.
    rig.wait(1);
}

/// The mouse may not rest between two visitors: only the next visitor's press distinguishes them.
#[test]
fn a_windows_next_visitor_begins_from_the_thanks_of_the_last_one() {
    with_rig(|rig| {
        rig.host.set_controls(Controls::Mouse);
        go_to_badge(rig);
        rig.wait(10 * TICK_RATE);
        assert!(!rig.press(ButtonAction::NewVisit), "the badge first");
        assert!(rig.press(ButtonAction::Press(Press::Confirm)));
        assert_eq!(rig.phase(), VisitPhase::Thanks);
        assert_eq!(rig.world().session_state(), SessionState::Finished);
        rig.wait(TICK_RATE);
        assert_eq!(rig.phase(), VisitPhase::Thanks, "who looks is not hurried");
        assert!(rig.press(ButtonAction::NewVisit));
        assert_eq!(rig.phase(), VisitPhase::Welcome);
        let visit = rig.world().visit();
        assert_eq!((visit.badge(), visit.is_sculpted()), (None, false));
        assert_eq!(rig.world().session_state(), SessionState::Sculpting, "a stone of their own");
    });
}

#[test]
fn thanks_are_counted_down_in_their_place_with_the_button_where_it_was() {
    with_rig(|rig| {
        rig.host.set_controls(Controls::Mouse);
        go_to_thanks(rig);
        let places = |rig: &HostRig<'_, '_>| rig.host.buttons().collect::<Vec<_>>();
        let before = places(rig);
        assert_eq!(before.len(), 1);
        rig.presence = Presence::Unknown;
        rig.wait(TICK_RATE);
        assert!(rig.host.screen.told_rest().is_some());
        assert_eq!(places(rig), before);
        rig.presence = Presence::Worn;
        assert!(rig.press(ButtonAction::NewVisit));
        assert_eq!(rig.phase(), VisitPhase::Welcome);
    });
}

#[test]
fn a_window_is_handed_over_by_its_next_visitor_and_a_headset_by_who_cleaned_it() {
    for (controls, button, other) in [
        (Controls::Mouse, ButtonAction::NewVisit, ButtonAction::Cleaned),
        (Controls::Controllers, ButtonAction::Cleaned, ButtonAction::NewVisit),
    ] {
        with_rig(|rig| {
            rig.host.set_controls(controls);
            go_to_thanks(rig);
            rig.wait(60 * TICK_RATE);
            assert_eq!(rig.phase(), VisitPhase::Handover);
            assert!(!rig.press(other), "{controls:?}");
            assert!(rig.press(button), "{controls:?}");
            assert_eq!(rig.phase(), VisitPhase::Welcome);
        });
    }
}

/// A headset detects that it is taken off, and its wearer can't be another visitor.
#[test]
fn a_headsets_thanks_have_no_button() {
    with_rig(|rig| {
        go_to_thanks(rig);
        assert_eq!(rig.host.buttons().count(), 0);
    });
}

/// The welcome is shown in the tick after visits begin, before the whole plan was sent.
#[test]
fn who_begins_at_once_begins_as_the_settings_say() {
    with_rig(|rig| {
        let owl = options().starts[1];
        rig.host.options.plan.set_start(owl);
        rig.presence = Presence::Worn;
        rig.host.begin_anew();
        rig.wait(6);
        assert_eq!((rig.phase(), rig.world().mode()), (VisitPhase::Welcome, owl));
    });
}

/// A window detects what no tick shows. The step is completed once, however often it is detected.
#[test]
fn a_window_tells_that_a_step_is_done_and_ends_that_one_alone() {
    with_rig(|rig| {
        rig.host.set_controls(Controls::Mouse);
        begin_guide(rig);
        for (number, step) in GuideStep::ALL.into_iter().take(6).enumerate() {
            let visit = *rig.world().visit();
            assert_eq!(visit.guide_step(), step);
            for other in GuideStep::ALL.into_iter().filter(|other| *other != step) {
                rig.host.note_step_done(&visit, other);
            }
            rig.wait(2);
            assert_eq!(rig.world().visit().guide_step(), step, "another is not asked for");
            (0..3).for_each(|_| rig.host.note_step_done(&visit, step));
            rig.wait(3);
            assert_eq!(rig.world().visit().guide_step() as usize, number + 1);
        }
        assert_eq!(rig.phase(), VisitPhase::Sculpting);
    });
}
