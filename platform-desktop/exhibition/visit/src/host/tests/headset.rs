//! Visits on a headset: hands, menu button, sleep, and restarts of the program.

use std::time::Duration;

use glam::{Quat, Vec3};
use paros_core::TickInput;
use paros_core::session::TICK_RATE;
use paros_core::visit::{PlanSetting, Presence, VisitPhase};
use paros_shell::headset::hand_reader::HandSource;
use paros_shell::headset::hand_sample::HandSample;
use paros_shell::headset::haptics::TickHaptics;

use super::{HostRig, Press, begin_sculpting, cut, with_rig};
use crate::headset::HeadsetTick;
use crate::host::{Question, VisitHost};
use crate::pointing::UNAIMED_TICKS;
use crate::screen::ButtonAction;

const SOURCES: [HandSource; 2] = [HandSource::Controller; 2];

impl HostRig<'_, '_> {
    /// Runs a tick of a headset with this right hand, at a time since boot.
    fn headset_tick(&mut self, seconds: f32, hand: HandSample, is_menu_down: bool) {
        let hands = [HandSample::default(), hand];
        let tick = HeadsetTick {
            now: Duration::from_secs_f32(seconds),
            head: Some(Vec3::Y * 1.5),
            hands: &hands,
            sources: SOURCES,
            is_menu_down,
            presence: self.presence,
            is_used: self.presence == Presence::Worn,
        };
        let mut input = TickInput::default();
        input.hands[1] = hand.to_hand_input();
        self.host.fill_headset_input(self.runner.world(), &tick, &mut input);
        self.runner.run_tick(&input);
        self.host.follow_headset_tick(self.runner.world(), &self.export);
    }

    /// Aims at a button with a hand, and pulls its trigger.
    fn press_by_hand(&mut self, action: ButtonAction) {
        let name = format!("{action:?}");
        let button = self.host.buttons().find(|(named, _)| *named == name);
        let (_, target) = button.unwrap_or_else(|| panic!("no {name}"));
        let from = Vec3::new(0.3, 1.3, 0.1);
        let aim = (from, Quat::from_rotation_arc(Vec3::NEG_Z, (target - from).normalize()));
        for trigger in [[0.0; UNAIMED_TICKS as usize].as_slice(), &[1.0, 0.0]].concat() {
            let hand =
                HandSample { aim: Some(aim), grip: Some(aim), trigger, ..HandSample::default() };
            self.headset_tick(0.0, hand, false);
        }
        (0..3).for_each(|_| self.headset_tick(0.0, HandSample::default(), false));
    }
}

#[test]
fn a_hand_presses_what_it_aims_at_and_the_room_is_placed_for_who_is_welcome() {
    with_rig(|rig| {
        assert!(!rig.host.take_recentring(), "nobody is there");
        rig.presence = Presence::Worn;
        (0..3).for_each(|_| rig.headset_tick(0.0, HandSample::default(), false));
        assert_eq!(rig.phase(), VisitPhase::Welcome);
        assert!(rig.host.take_recentring() && !rig.host.take_recentring());
        let main = rig.host.panels()[0].pose;
        assert!(main.middle.z < -1.0 && (main.rotation * Vec3::Z).z > 0.9, "{main:?}");
        rig.press_by_hand(ButtonAction::Press(Press::WorkingHand(0)));
        assert_eq!(rig.world().visit().working_hand(), 0);
        rig.press_by_hand(ButtonAction::Press(Press::Confirm));
        assert_eq!(rig.phase(), VisitPhase::Choice);
    });
}

#[test]
fn the_menu_button_asks_for_the_end_and_held_for_the_staff() {
    with_rig(|rig| {
        begin_sculpting(rig);
        let mut hold = |ticks: u32| {
            (0..ticks).for_each(|_| rig.headset_tick(0.0, HandSample::default(), true));
            rig.headset_tick(0.0, HandSample::default(), false);
            rig.host.question
        };
        assert_eq!(hold(5), Question::Finish);
        assert_eq!(hold(5), Question::None);
        assert_eq!(hold(2 * TICK_RATE), Question::Pin);
        assert_eq!(hold(2 * TICK_RATE), Question::None, "shut again");
        assert_eq!(hold(2 * TICK_RATE - 1), Question::Finish);
    });
}

/// The device slept, or its program was killed and restarted.
#[test]
fn who_was_away_for_long_has_gone() {
    for (away, phase) in [(44.0, VisitPhase::Sculpting), (46.0, VisitPhase::HandsOff)] {
        with_rig(|rig| {
            begin_sculpting(rig);
            cut(rig);
            rig.headset_tick(100.0, HandSample::default(), false);
            rig.headset_tick(100.0 + away, HandSample::default(), false);
            assert_eq!(rig.phase(), phase, "slept for {away} s");
        });
    }
    let minute = Duration::from_secs(60);
    for (unused, counted, phase) in [
        (Some(minute), 0, VisitPhase::HandsOff),
        (Some(minute - Duration::from_secs(20)), 0, VisitPhase::Sculpting),
        // The visit had counted twenty seconds of this minute when it was saved: the total is a minute.
        (Some(minute), 20, VisitPhase::HandsOff),
        (Some(minute - Duration::from_secs(20)), 20, VisitPhase::Sculpting),
        (None, 0, VisitPhase::HandsOff),
    ] {
        with_rig(|rig| {
            begin_sculpting(rig);
            cut(rig);
            rig.presence = Presence::Off;
            (0..counted * TICK_RATE).for_each(|_| rig.tick(None));
            // Another process loads the visit.
            let visit = rig.runner.world().visit();
            rig.host = VisitHost::new(super::options(), visit);
            rig.host.note_found(visit, unused);
            rig.headset_tick(9.0, HandSample::default(), false);
            assert_eq!(rig.phase(), phase, "{unused:?}, of which {counted} s were counted");
        });
    }
}

/// The runtime lost its session, and has a new one. The badge is shown again, unless the gap was longer than
/// the settings allow a visitor to be away in this phase.
#[test]
fn a_lost_session_is_time_away_by_the_settings_of_its_phase() {
    for (away, phase) in [(7.0, VisitPhase::Badge), (9.0, VisitPhase::Attract)] {
        with_rig(|rig| {
            rig.host.options.plan.set_value(PlanSetting::OffAfter, 8);
            rig.host.begin_anew();
            rig.wait(4);
            begin_sculpting(rig);
            cut(rig);
            rig.host.perform(ButtonAction::Press(Press::Finish));
            rig.export.is_kept = true;
            while rig.phase() != VisitPhase::Badge {
                rig.headset_tick(100.0, HandSample::default(), false);
            }
            rig.headset_tick(100.0 + away, HandSample::default(), false);
            assert_eq!(rig.phase(), phase, "lost for {away} s");
        });
    }
}

#[test]
fn a_recording_begins_with_visits_that_begin() {
    with_rig(|rig| {
        begin_sculpting(rig);
        rig.host = VisitHost::new(super::options(), rig.runner.world().visit());
        rig.host.begin_anew();
        rig.presence = Presence::Off;
        rig.wait(1);
        assert_eq!(rig.phase(), VisitPhase::Attract);
    });
}

#[test]
fn buttons_are_felt_and_the_hand_of_nobody_is_not() {
    with_rig(|rig| {
        let at_work = TickHaptics { level: 200, ..TickHaptics::default() };
        let feel = |rig: &HostRig<'_, '_>| {
            let mut felt = [at_work; 2];
            rig.host.adapt_haptics(rig.world().visit(), &mut felt);
            felt.map(|hand| hand.level)
        };
        assert_eq!(feel(rig), [0, 0], "the host's own hand");
        rig.presence = Presence::Worn;
        rig.wait(3);
        assert_eq!(feel(rig), [200, 200]);
    });
}
