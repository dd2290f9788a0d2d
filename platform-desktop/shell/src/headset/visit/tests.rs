//! Visits on a headset with a clock that stops during sleep: which breaks end a visit and which don't.

use std::time::Duration;

use glam::{Quat, Vec3};
use paros_core::TickInput;
use paros_core::session::{RawPose, SessionMode, SessionState, TICK_RATE, commands};
use paros_core::visit::Presence;

use super::{
    BootId, DEFAULT_HANDOVER, FINISH_HOLD_TICKS, LEAST_IDLENESS, LastUse, VisitPolicy,
    VisitorChange,
};

const NOTHING: (SessionMode, u8) = (SessionMode::None, 0);
const FINISH: (SessionMode, u8) = (SessionMode::None, commands::FINISH);
const START: (SessionMode, u8) = (SessionMode::FreeForm, 0);

fn apply(policy: &mut VisitPolicy, session: SessionState, is_menu_down: bool) -> (SessionMode, u8) {
    let mut input = TickInput::default();
    policy.add_session_start_or_finish(session, true, is_menu_down, &mut input);
    (input.start, input.commands)
}

/// The motion of head and hands.
#[derive(Clone, Copy, PartialEq)]
enum Motion {
    /// Head and hands lie still.
    Still,
    /// The headset is worn, and sways.
    Head,
    /// The hand works, and the head is perfectly still.
    Hand,
    /// A trigger is pulled and released.
    Trigger,
}

/// A headset with its policy and two clocks: `since_boot` runs during sleep, `awake` stops.
struct Headset {
    since_boot: Duration,
    awake: Duration,
    boot: BootId,
    policy: VisitPolicy,
    /// The time of the last use on the disk.
    stamp: Option<Duration>,
    ticks: u32,
}

impl Headset {
    fn new() -> Self {
        Headset {
            since_boot: Duration::from_secs(600),
            awake: Duration::from_secs(300),
            boot: boot(1),
            policy: VisitPolicy::new(SessionMode::FreeForm, DEFAULT_HANDOVER),
            stamp: None,
            ticks: 0,
        }
    }

    /// Runs ticks for some seconds. Returns the change of visitor; more than one fails the test.
    fn run(&mut self, seconds: u64, motion: Motion) -> VisitorChange {
        let mut came = VisitorChange::None;
        for _ in 0..seconds * u64::from(TICK_RATE) {
            let change = self.policy.observe_tick(&self.input(motion), false, self.since_boot);
            if change != VisitorChange::None {
                assert_eq!(came, VisitorChange::None, "twice");
                came = change;
            }
            self.ticks += 1;
            self.pass(Duration::from_secs(1) / TICK_RATE);
        }
        came
    }

    fn input(&self, motion: Motion) -> TickInput {
        let mut input = TickInput::default();
        let sway = (self.ticks as f32 * 0.05).sin() * 0.05;
        let pose = |x| RawPose::quantise(Vec3::new(x, 1.5, 0.0), Quat::IDENTITY);
        let hand = &mut input.hands[1];
        hand.tracked = true;
        (input.head, hand.grip) = (pose(0.0), pose(0.3));
        match motion {
            Motion::Still => {}
            Motion::Head => input.head = pose(sway),
            Motion::Hand => hand.grip = pose(0.3 + sway),
            Motion::Trigger => hand.trigger = if self.ticks / TICK_RATE % 2 == 1 { 255 } else { 0 },
        }
        input
    }

    fn pass(&mut self, time: Duration) {
        self.since_boot += time;
        self.awake += time;
    }

    /// Lets the device sleep.
    fn sleep(&mut self, seconds: u64) {
        self.since_boot += Duration::from_secs(seconds);
    }

    fn presence(&mut self, is_worn: bool) -> VisitorChange {
        self.policy.observe_presence(is_worn, self.since_boot)
    }

    /// Kills the program and starts it again after some seconds in a boot. Returns the change of visitor.
    fn kill_and_start(&mut self, seconds: u64, boot: BootId) -> VisitorChange {
        let last = self.stamp.map(|since_boot| LastUse { boot: self.boot, since_boot });
        self.sleep(seconds);
        self.boot = boot;
        self.policy = VisitPolicy::new(SessionMode::FreeForm, DEFAULT_HANDOVER);
        self.policy.resume_session(last, Some(boot), self.since_boot)
    }

    /// Asserts that the session is finished and the next one started, once.
    fn assert_handed_over(&mut self) {
        assert_eq!(apply(&mut self.policy, SessionState::Sculpting, false), FINISH);
        assert_eq!(apply(&mut self.policy, SessionState::Finished, false), START);
        self.assert_goes_on();
    }

    fn assert_goes_on(&mut self) {
        assert_eq!(apply(&mut self.policy, SessionState::Sculpting, false), NOTHING);
        assert_eq!(apply(&mut self.policy, SessionState::Finished, false), NOTHING);
    }
}

fn boot(number: u8) -> BootId {
    BootId::parse_uuid(&format!("{number:032x}")).expect("32 digits")
}

#[test]
fn a_session_starts_where_there_is_none() {
    let mut policy = VisitPolicy::new(SessionMode::Creative, DEFAULT_HANDOVER);
    assert_eq!(apply(&mut policy, SessionState::Waiting, false), (SessionMode::Creative, 0));
    assert_eq!(apply(&mut policy, SessionState::Sculpting, false), NOTHING);
}

#[test]
fn the_menu_button_held_finishes_once_and_pressed_again_starts_anew() {
    let mut policy = VisitPolicy::new(SessionMode::FreeForm, DEFAULT_HANDOVER);
    for _ in 1..FINISH_HOLD_TICKS {
        assert_eq!(apply(&mut policy, SessionState::Sculpting, true), NOTHING);
    }
    assert_eq!(apply(&mut policy, SessionState::Sculpting, true), FINISH);
    assert_eq!(apply(&mut policy, SessionState::Finished, true), NOTHING, "it is still held");
    assert_eq!(apply(&mut policy, SessionState::Finished, false), NOTHING);
    assert_eq!(apply(&mut policy, SessionState::Finished, true), START);
    assert_eq!(apply(&mut policy, SessionState::Sculpting, true), NOTHING);
    // A short press does nothing during a session.
    assert_eq!(apply(&mut policy, SessionState::Sculpting, false), NOTHING);
}

#[test]
fn a_headset_off_for_long_is_handed_over_and_off_for_short_is_not() {
    let mut headset = Headset::new();
    assert_eq!(headset.presence(true), VisitorChange::None);
    assert_eq!(headset.run(20, Motion::Head), VisitorChange::None);
    headset.presence(false);
    // Somebody carries it about.
    assert_eq!(headset.run(40, Motion::Head), VisitorChange::None);
    assert_eq!(headset.presence(true), VisitorChange::PutOnAgain);
    headset.assert_goes_on();
    headset.run(20, Motion::Head);
    headset.presence(false);
    headset.presence(false);
    assert_eq!(headset.run(44, Motion::Head), VisitorChange::None);
    headset.pass(Duration::from_secs(1));
    assert_eq!(headset.presence(true), VisitorChange::NextVisitor);
    headset.assert_handed_over();
}

/// Somebody who carries the headset for long ends the session; the visitor who then puts it on counts as the
/// same person.
#[test]
fn a_headset_that_is_carried_about_for_long_is_put_on_after_it() {
    let mut headset = Headset::new();
    assert_eq!(headset.presence(true), VisitorChange::None);
    headset.run(20, Motion::Head);
    headset.presence(false);
    assert_eq!(headset.policy.presence(), Presence::Off);
    assert_eq!(headset.run(60, Motion::Head), VisitorChange::NextVisitor);
    assert_eq!(headset.policy.presence(), Presence::Unknown, "its sensor may be stuck");
    headset.assert_handed_over();
    headset.presence(false);
    assert_eq!(headset.presence(true), VisitorChange::PutOnAgain);
    headset.assert_goes_on();
}

#[test]
fn a_break_of_no_time_hands_over_where_that_is_wanted() {
    let mut policy = VisitPolicy::new(SessionMode::FreeForm, Duration::ZERO);
    let mut headset = Headset::new();
    assert_eq!(headset.run(60, Motion::Head), VisitorChange::None);
    for is_worn in [true, false] {
        assert_eq!(policy.observe_presence(is_worn, headset.since_boot), VisitorChange::None);
    }
    assert_eq!(policy.observe_presence(true, headset.since_boot), VisitorChange::NextVisitor);
    // But a visitor who stands and looks is not another visitor.
    assert!(policy.idleness_before_handover() >= LEAST_IDLENESS);
}

#[test]
fn a_sleep_counts_though_one_clock_stops() {
    for (seconds, expected) in [(10, VisitorChange::PutOnAgain), (60, VisitorChange::NextVisitor)] {
        let mut headset = Headset::new();
        headset.presence(true);
        headset.run(20, Motion::Head);
        let awake = headset.awake;
        headset.presence(false);
        headset.sleep(seconds);
        assert!(headset.awake - awake < DEFAULT_HANDOVER);
        assert_eq!(headset.presence(true), expected, "{seconds} s");
        // The same holds without presence events.
        let mut headset = Headset::new();
        headset.run(20, Motion::Head);
        headset.sleep(seconds);
        assert_eq!(headset.run(20, Motion::Head), expected, "{seconds} s");
    }
}

#[test]
fn without_presence_events_and_with_one_that_is_stuck_idleness_decides() {
    for stuck in [None, Some(true), Some(false)] {
        for motion in [Motion::Head, Motion::Hand, Motion::Trigger] {
            let mut headset = Headset::new();
            if let Some(is_worn) = stuck {
                headset.presence(is_worn);
                headset.pass(DEFAULT_HANDOVER);
                headset.run(3, motion);
                // Ends the handover that the use before the sensor was known to be stuck may have caused.
                apply(&mut headset.policy, SessionState::Waiting, false);
            }
            // A visitor who moves is the same one, however long it takes.
            assert_eq!(headset.run(120, motion), VisitorChange::None);
            assert_eq!(headset.run(30, Motion::Still), VisitorChange::None);
            assert_eq!(headset.run(10, motion), VisitorChange::PutOnAgain);
            headset.assert_goes_on();
            assert_eq!(headset.run(46, Motion::Still), VisitorChange::None, "nobody is there yet");
            assert_eq!(headset.run(10, motion), VisitorChange::NextVisitor);
            headset.assert_handed_over();
            assert_eq!(headset.run(60, motion), VisitorChange::None);
        }
    }
}

#[test]
fn who_takes_a_headset_off_that_lay_idle_is_no_visitor() {
    let mut headset = Headset::new();
    headset.presence(true);
    headset.run(20, Motion::Head);
    // The sensor was covered.
    headset.run(60, Motion::Still);
    headset.presence(false);
    headset.run(5, Motion::Head);
    assert_eq!(headset.presence(true), VisitorChange::NextVisitor);
}

#[test]
fn a_killed_program_goes_on_soon_and_hands_over_later() {
    for (seconds, number, expected) in [
        (10, 1, VisitorChange::None),
        (38, 1, VisitorChange::None),
        (46, 1, VisitorChange::NextVisitor),
        (10, 2, VisitorChange::NextVisitor),
        (100_000, 2, VisitorChange::NextVisitor),
    ] {
        let mut headset = Headset::new();
        for _ in 0..30 {
            headset.run(1, Motion::Head);
            headset.stamp = headset.policy.take_due_stamp().or(headset.stamp);
        }
        assert_eq!(headset.kill_and_start(seconds, boot(number)), expected, "{seconds} s");
        match expected {
            VisitorChange::NextVisitor => headset.assert_handed_over(),
            _ => headset.assert_goes_on(),
        }
        assert_ne!(headset.run(20, Motion::Head), VisitorChange::NextVisitor, "that was told");
        assert_eq!(headset.run(60, Motion::Head), VisitorChange::None);
    }
}

#[test]
fn a_break_goes_on_across_a_kill() {
    let mut headset = Headset::new();
    headset.run(20, Motion::Head);
    headset.presence(false);
    headset.stamp = headset.policy.take_last_stamp();
    assert_eq!(headset.kill_and_start(30, boot(1)), VisitorChange::None);
    assert_eq!(headset.run(20, Motion::Still), VisitorChange::None);
    assert_eq!(headset.presence(true), VisitorChange::NextVisitor);
    headset.assert_handed_over();
}

#[test]
fn a_last_use_that_can_not_be_told_is_a_former_visitors() {
    let (here, now) = (boot(1), Duration::from_secs(100));
    let used = |number, seconds| {
        Some(LastUse { boot: boot(number), since_boot: Duration::from_secs(seconds) })
    };
    for (last_use, boot, expected) in [
        (used(1, 99), Some(here), VisitorChange::None),
        (None, Some(here), VisitorChange::NextVisitor),
        (used(1, 99), None, VisitorChange::NextVisitor),
        (used(2, 99), Some(here), VisitorChange::NextVisitor),
        // A time in the future.
        (used(1, 101), Some(here), VisitorChange::NextVisitor),
    ] {
        let mut policy = VisitPolicy::new(SessionMode::FreeForm, DEFAULT_HANDOVER);
        assert_eq!(policy.resume_session(last_use, boot, now), expected, "{last_use:?}");
    }
}

#[test]
fn the_last_use_is_not_stamped_for_the_one_before() {
    let mut headset = Headset::new();
    headset.run(20, Motion::Head);
    assert!(headset.policy.take_due_stamp().is_some());
    headset.run(50, Motion::Still);
    assert_eq!(headset.run(20, Motion::Head), VisitorChange::NextVisitor);
    assert_eq!((headset.policy.take_due_stamp(), headset.policy.take_last_stamp()), (None, None));
    headset.assert_handed_over();
    assert!(headset.policy.take_due_stamp().is_some());
}

#[test]
fn a_stone_that_nobody_touched_is_replaced_and_not_kept() {
    let mut headset = Headset::new();
    headset.run(20, Motion::Head);
    headset.sleep(60);
    assert_eq!(headset.run(1, Motion::Head), VisitorChange::NextVisitor);
    let mut input = TickInput::default();
    headset.policy.add_session_start_or_finish(SessionState::Sculpting, false, false, &mut input);
    assert_eq!((input.start, input.commands), START);
    headset.assert_goes_on();
}

/// In visit mode the policy ends no sessions, and still stamps the last use.
#[test]
fn with_visits_wearing_and_use_are_told_and_nothing_is_handed_over() {
    let mut headset = Headset::new();
    headset.policy = VisitPolicy::new(SessionMode::None, DEFAULT_HANDOVER);
    let told = |headset: &Headset| (headset.policy.presence(), headset.policy.is_used());
    assert_eq!(told(&headset), (Presence::Unknown, false));
    headset.policy.observe_presence(true, headset.since_boot);
    let mut uses = 0;
    for _ in 0..TICK_RATE {
        let input = headset.input(Motion::Head);
        headset.policy.observe_tick(&input, false, headset.since_boot);
        assert_eq!(headset.policy.presence(), Presence::Worn);
        uses += u32::from(headset.policy.is_used());
        headset.ticks += 1;
    }
    assert!((1..TICK_RATE).contains(&uses), "{uses} ticks with a use: it strays from time to time");
    assert!(headset.policy.take_due_stamp().is_some());
    // While it is off, being carried is no use, until it has been off for so long that the sensor must be
    // stuck.
    headset.policy.observe_presence(false, headset.since_boot);
    for _ in 0..10 * TICK_RATE {
        let input = headset.input(Motion::Head);
        headset.policy.observe_tick(&input, false, headset.since_boot);
        assert_eq!(told(&headset), (Presence::Off, false));
        headset.ticks += 1;
    }
    headset.pass(DEFAULT_HANDOVER);
    let input = TickInput { head: pose_aside(), ..headset.input(Motion::Still) };
    let change = headset.policy.observe_tick(&input, false, headset.since_boot);
    assert_eq!(change, VisitorChange::PutOnAgain, "the room is placed anew at the most");
    assert_eq!(told(&headset), (Presence::Unknown, true));
    headset.policy.observe_presence(true, headset.since_boot);
    assert_eq!(headset.policy.presence(), Presence::Worn);
    assert!(headset.policy.take_last_stamp().is_some(), "it is nobody's to be handed over");
    for session in [SessionState::Sculpting, SessionState::Finished] {
        assert_eq!(apply(&mut headset.policy, session, false), NOTHING);
    }
}

/// Returns a pose of the head at another place.
fn pose_aside() -> RawPose {
    RawPose::quantise(Vec3::new(0.7, 1.5, 0.0), Quat::IDENTITY)
}
