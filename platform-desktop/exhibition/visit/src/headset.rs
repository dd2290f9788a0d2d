//! Visits on a headset: the menu button and its bare-hand gesture, pauses of the headset, and the eyes that
//! panels face.

use std::time::Duration;

use glam::Vec3;
use paros_core::session::TICK_RATE;
use paros_core::visit::{PlanSetting, Presence, Visit, VisitPhase, VisitPlan};
use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, World};
use paros_shell::headset::hand_reader::HandSource;
use paros_shell::headset::hand_sample::HandSample;
use paros_shell::headset::haptics::TickHaptics;

use crate::export_state::ExportState;
use crate::host::VisitHost;
use crate::options::Controls;
use crate::pointing::{PRESSED_FROM, Pointer};
use crate::standing::room_pose;

/// Ticks for which the menu button is held, or bare hands are held up, to ask for the staff's panel: two
/// seconds, so that visitors don't open it by accident.
const STAFF_HOLD_TICKS: u32 = 2 * TICK_RATE;

/// Gap between ticks that counts as time away: the device slept, the runtime lost its session, or the program
/// showed nothing. Slow frames are shorter. A shorter absence limit in the settings counts instead.
const LEAST_AWAY: Duration = Duration::from_secs(3);

/// The height of eyes that were never tracked, in metres.
const EYE_HEIGHT: f32 = 1.6;

/// The readings of a headset in a tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HeadsetTick<'a> {
    /// The time since boot, including sleep.
    pub now: Duration,
    /// The position of the head in metres of the room; `None` while it isn't tracked.
    pub head: Option<Vec3>,
    /// The left and the right hand, in metres of the room.
    pub hands: &'a [HandSample; 2],
    /// The sources of the hands' readings.
    pub sources: [HandSource; 2],
    /// `true` while the menu button is down.
    pub is_menu_down: bool,
    /// The state of the headset: worn, off, or unknown.
    pub presence: Presence,
    /// `true` if the headset is used in this tick.
    pub is_used: bool,
}

/// The kind of a press of the menu button.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum MenuPress {
    /// The button was released early.
    Short,
    /// The button has been held for [`STAFF_HOLD_TICKS`].
    Long,
}

/// The state of a headset from tick to tick.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub(crate) struct HeadsetWatch {
    /// The time of the last tick, since boot.
    last_tick: Option<Duration>,
    /// Number of ticks for which the menu button has been down.
    menu_ticks: u32,
    /// Number of ticks for which both bare hands have been held up.
    raised_ticks: u32,
    /// The last tracked position of the head.
    head: Option<Vec3>,
    /// The position of the head at the last change of the screen. Panels face it, and don't follow the head.
    eyes: Option<Vec3>,
}

impl HeadsetWatch {
    /// Makes panels face the position of the head from the next tick on.
    pub(crate) const fn take_eyes_anew(&mut self) {
        self.eyes = None;
    }

    /// Returns the whole seconds since the previous tick, if the gap counts as time away.
    fn note_tick(&mut self, now: Duration, plan: &VisitPlan) -> Option<u16> {
        let last = self.last_tick.replace(now)?;
        let soonest = Duration::from_secs(plan.value(PlanSetting::OffAfter).max(1).into());
        let away = now.checked_sub(last).filter(|away| *away >= LEAST_AWAY.min(soonest))?;
        Some(u16::try_from(away.as_secs()).unwrap_or(u16::MAX))
    }

    /// Returns the press of the menu button: short when it is released, long while it is still held.
    fn follow_menu(&mut self, is_down: bool) -> Option<MenuPress> {
        let held = self.menu_ticks;
        self.menu_ticks = if is_down { held.saturating_add(1) } else { 0 };
        match is_down {
            true => (self.menu_ticks == STAFF_HOLD_TICKS).then_some(MenuPress::Long),
            false => (1..STAFF_HOLD_TICKS).contains(&held).then_some(MenuPress::Short),
        }
    }

    /// Returns `true` once if bare hands, which have no menu button, ask for the staff's panel: both pinch
    /// above the eyes for [`STAFF_HOLD_TICKS`]. Visitors neither work there nor use two-handed gestures.
    fn follow_bare_hands(&mut self, tick: &HeadsetTick<'_>) -> bool {
        let is_raised = |head: Vec3| {
            let mut hands = tick.hands.iter().zip(tick.sources);
            hands.all(|(hand, source)| {
                let is_bare = matches!(source, HandSource::Joints | HandSource::HandInteraction);
                let is_above = hand.grip.is_some_and(|(place, _)| place.y > head.y);
                is_bare && is_above && hand.trigger >= PRESSED_FROM
            })
        };
        let is_held = tick.head.is_some_and(is_raised);
        self.raised_ticks = if is_held { self.raised_ticks.saturating_add(1) } else { 0 };
        self.raised_ticks == STAFF_HOLD_TICKS
    }

    /// Returns the position that panels face.
    fn eyes(&mut self) -> Vec3 {
        let head = self.head.filter(|head| head.is_finite());
        *self.eyes.get_or_insert(head.unwrap_or(Vec3::Y * EYE_HEIGHT))
    }
}

impl VisitHost {
    /// Handles a visit that was found on the disk. `unused` is the time without use, and the idle time that
    /// the visit has already counted is subtracted from it. If `unused` is `None`, the visit counts as a
    /// former visitor's.
    pub fn note_found(&mut self, visit: &Visit, unused: Option<Duration>) {
        let counted = u64::from(visit.idle_ticks() / TICK_RATE);
        let away = unused.map(|unused| unused.as_secs().saturating_sub(counted));
        self.note_away(away.and_then(|seconds| u16::try_from(seconds).ok()).unwrap_or(u16::MAX));
    }

    /// Handles a move of the room: panels face the head's position in the new room.
    pub const fn note_room_moved(&mut self) {
        self.headset.take_eyes_anew();
    }

    /// Processes a headset's tick: performs button presses, and adds the visit's part to the tick's input,
    /// which has the same hands.
    pub fn fill_headset_input<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        tick: &HeadsetTick<'_>,
        input: &mut TickInput,
    ) where
        Grid<N>: Size,
    {
        let visit = world.visit();
        if let Some(seconds) = self.headset.note_tick(tick.now, visit.plan()) {
            self.note_away(seconds);
        }
        self.headset.head = tick.head.or(self.headset.head);
        match self.headset.follow_menu(tick.is_menu_down) {
            None => {}
            Some(MenuPress::Short) => self.toggle_finish_question(visit),
            Some(MenuPress::Long) => self.toggle_staff_panel(),
        }
        if self.headset.follow_bare_hands(tick) {
            self.toggle_staff_panel();
        }
        if let Some(controls) = Controls::of_hands(tick.sources) {
            self.set_controls(controls);
        }
        let [left, right] = tick.hands.each_ref().map(Pointer::of_hand);
        self.follow_pointers(visit, &[left, right, None]);
        self.fill_input(world, (tick.presence, tick.is_used), input);
    }

    /// Applies the results of a headset's tick, and places panels and rays in the room.
    pub fn follow_headset_tick<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        export: &ExportState,
    ) where
        Grid<N>: Size,
    {
        self.follow_tick(world, export);
        let eyes = self.headset.eyes();
        self.place_panels(|spot, size_mm| room_pose(spot, size_mm, eyes.y));
        let seen_from = self.headset.head.unwrap_or(eyes);
        self.screen.draw_rays(&self.pointing.rays(), seen_from);
    }

    /// Returns `true` if the host moves the hands in the world, and the visitor's hands are hidden.
    #[must_use]
    pub fn moves_hands(visit: &Visit) -> bool {
        visit.phase() == VisitPhase::Attract
    }

    /// Adds the haptics of buttons to those of a tick. A hand that the host moves has no other haptics.
    pub fn adapt_haptics(&self, visit: &Visit, felt: &mut [TickHaptics; 2]) {
        for (hand, felt) in felt.iter_mut().enumerate() {
            if Self::moves_hands(visit) {
                *felt = TickHaptics::default();
            }
            felt.level = felt.level.max(self.pointing.tap(hand));
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    #[test]
    fn a_pause_between_ticks_is_time_away_and_a_slow_frame_is_none() {
        let mut watch = HeadsetWatch::default();
        let mut plan = VisitPlan::new();
        let mut note = |millis| watch.note_tick(Duration::from_millis(millis), &plan);
        assert_eq!(note(500_000), None, "the first one");
        assert_eq!(note(500_014), None);
        assert_eq!(note(502_900), None, "slow");
        assert_eq!(note(506_000), Some(3));
        assert_eq!(note(506_000), None, "of the same frame");
        assert_eq!(note(551_999), Some(45));
        assert_eq!(note(551_000), None, "a clock that goes back");
        assert_eq!(note(551_000 + 1000 * 86_400), Some(u16::MAX), "a night");
        plan.set_value(PlanSetting::OffAfter, 1);
        let mut watch = HeadsetWatch::default();
        let mut note = |millis| watch.note_tick(Duration::from_millis(millis), &plan);
        assert_eq!([10_000, 10_900, 12_000].map(&mut note), [None, None, Some(1)]);
    }

    #[test]
    fn the_menu_button_asks_when_let_go_or_after_two_seconds() {
        let mut watch = HeadsetWatch::default();
        let mut hold = |ticks: u32| -> Vec<(u32, MenuPress)> {
            let pressed = |tick| watch.follow_menu(tick < ticks).map(|press| (tick, press));
            (0..ticks + 5).filter_map(pressed).collect()
        };
        assert_eq!(hold(1), [(1, MenuPress::Short)]);
        let almost = STAFF_HOLD_TICKS - 1;
        assert_eq!(hold(almost), [(almost, MenuPress::Short)]);
        assert_eq!(hold(STAFF_HOLD_TICKS), [(almost, MenuPress::Long)]);
        assert_eq!(hold(3 * STAFF_HOLD_TICKS), [(almost, MenuPress::Long)], "once");
        assert_eq!(hold(0), []);
    }

    #[test]
    fn bare_hands_ask_by_pinching_above_the_eyes_for_two_seconds() {
        use HandSource::{Controller, HandInteraction, Joints};
        let pinch = |height: f32, trigger: f32| HandSample {
            grip: Some((Vec3::new(0.1, height, -0.3), Quat::IDENTITY)),
            trigger,
            ..HandSample::default()
        };
        let (up, down, open) = (pinch(1.7, 1.0), pinch(1.4, 1.0), pinch(1.7, 0.2));
        let head = Some(Vec3::Y * 1.6);
        let asked = |hands: [HandSample; 2], sources, head, ticks: u32| {
            let mut watch = HeadsetWatch::default();
            let tick = HeadsetTick {
                now: Duration::ZERO,
                head,
                hands: &hands,
                sources,
                is_menu_down: false,
                presence: Presence::Worn,
                is_used: true,
            };
            (0..ticks).filter(|_| watch.follow_bare_hands(&tick)).count()
        };
        let long = 3 * STAFF_HOLD_TICKS;
        for sources in [[Joints; 2], [HandInteraction; 2], [Joints, HandInteraction]] {
            assert_eq!(asked([up; 2], sources, head, long), 1, "once: {sources:?}");
            assert_eq!(asked([up; 2], sources, head, STAFF_HOLD_TICKS - 1), 0);
        }
        for hands in [[up, down], [down, up], [up, open], [open, up], [down; 2]] {
            assert_eq!(asked(hands, [Joints; 2], head, long), 0, "{hands:?}");
        }
        // A controller has its menu button. A single hand, or hands without a tracked head, ask for nothing.
        assert_eq!(asked([up; 2], [Joints, Controller], head, long), 0);
        assert_eq!(asked([up, HandSample::default()], [Joints, HandSource::None], head, long), 0);
        assert_eq!(asked([up; 2], [Joints; 2], None, long), 0);
    }

    #[test]
    fn panels_turn_to_where_the_head_was_when_the_screen_changed() {
        let mut watch = HeadsetWatch::default();
        assert_eq!(watch.eyes(), Vec3::Y * EYE_HEIGHT, "nobody was seen");
        watch.head = Some(Vec3::Y * 1.2);
        assert_eq!(watch.eyes(), Vec3::Y * EYE_HEIGHT);
        watch.take_eyes_anew();
        assert_eq!(watch.eyes(), Vec3::Y * 1.2);
        watch.head = Some(Vec3::NAN);
        watch.take_eyes_anew();
        assert_eq!(watch.eyes(), Vec3::Y * EYE_HEIGHT);
    }
}
