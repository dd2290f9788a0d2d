//! Haptics: the vibrations of ticks, merged into one pulse a frame for each hand, a dull pulse of its own for
//! what closure refuses, and a bright one where another tenth of the hidden figure is bared.

use paros_core::session::TICK_RATE;
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};

/// A vibration, as `XrHapticVibration` describes it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HapticPulse {
    /// 0 to 1.
    pub amplitude: f32,
    /// In hertz; 0, as OpenXR's `XR_FREQUENCY_UNSPECIFIED`, leaves it to the controller.
    pub frequency_hz: f32,
    /// Duration in nanoseconds.
    pub nanos: i64,
}

/// Ticks that a refusal is felt for, an eighth of a second. A pulse of cutting is as long as its frame.
const REFUSAL_TICKS: u32 = 9;

/// Ticks from one refusal that is felt to the next, at least: two a second.
const REFUSAL_INTERVAL_TICKS: u32 = TICK_RATE / 2;

/// A refusal: long, and far below the 150 to 300 Hz at which controllers resonate and cutting is felt.
const REFUSAL: HapticPulse =
    HapticPulse { amplitude: 0.7, frequency_hz: 55.0, nanos: ticks_to_nanos(REFUSAL_TICKS) };

/// Ticks that another bared tenth rings, a third of a second.
const RING_TICKS: u32 = 24;

/// Another tenth is bared: at what controllers resonate to, as a bell among the noise of cutting.
const RING: HapticPulse =
    HapticPulse { amplitude: 1.0, frequency_hz: 230.0, nanos: ticks_to_nanos(RING_TICKS) };

/// What one hand is to feel of a tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct TickHaptics {
    /// Strength of its contact with the stone, 0 to 255.
    pub level: u8,
    /// Whether closure brought back more than its edits removed.
    pub is_refused: bool,
    /// Whether more of the hidden figure was told to be bared, by this hand's work or, where neither works, by what
    /// fell.
    pub rings: bool,
}

impl TickHaptics {
    /// Of the last tick of a world, left and right.
    #[must_use]
    pub fn of_last_tick<const N: usize, const K: usize>(world: &World<N, K>) -> [Self; 2]
    where
        Grid<N>: Size,
    {
        let tells_more =
            |event: &WorldEvent| matches!(event, WorldEvent::Bared { .. } | WorldEvent::Found);
        let told_more = world.events().iter().any(tells_more);
        let works = [0, 1].map(|hand| world.edit_report(hand).removed > 0);
        [0, 1].map(|hand| TickHaptics {
            level: world.hand_state(hand).haptic,
            is_refused: world.edit_report(hand).is_mostly_refused_by_closure(),
            rings: told_more && (works[hand] || works == [false; 2]),
        })
    }
}

/// The haptics of the ticks since the last frame. A new pulse replaces the one before it, so a frame
/// gives each hand at most one: with the strongest level of its ticks, for the duration of all. A ring goes before, then
/// a refusal, and no lesser pulse of its hand cuts either short.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct FrameHaptics {
    hands: [HandHaptics; 2],
    ticks: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
struct HandHaptics {
    level: u8,
    /// A ring is to be felt in this frame, or a refusal.
    rings: bool,
    is_refused: bool,
    /// Ticks until the last ring is over, and the last refusal.
    ring_ticks_left: u32,
    refusal_ticks_left: u32,
    /// Ticks until another may be felt.
    pause_ticks_left: u32,
}

impl HandHaptics {
    fn add_tick(&mut self, TickHaptics { level, is_refused, rings }: TickHaptics) {
        self.level = level.max(self.level);
        for left in
            [&mut self.ring_ticks_left, &mut self.refusal_ticks_left, &mut self.pause_ticks_left]
        {
            *left = left.saturating_sub(1);
        }
        if rings {
            self.rings = true;
            self.ring_ticks_left = RING_TICKS;
        }
        if is_refused && self.pause_ticks_left == 0 && self.ring_ticks_left == 0 {
            self.is_refused = true;
            (self.refusal_ticks_left, self.pause_ticks_left) =
                (REFUSAL_TICKS, REFUSAL_INTERVAL_TICKS);
        }
    }

    fn take_pulse(&mut self, ticks: u32) -> Option<HapticPulse> {
        let level = core::mem::take(&mut self.level);
        let is_refused = core::mem::take(&mut self.is_refused);
        if core::mem::take(&mut self.rings) {
            return Some(RING);
        }
        if is_refused && self.ring_ticks_left == 0 {
            return Some(REFUSAL);
        }
        let is_free = self.ring_ticks_left == 0 && self.refusal_ticks_left == 0;
        (level > 0 && is_free).then_some(HapticPulse {
            amplitude: f32::from(level) / 255.0,
            frequency_hz: 0.0,
            nanos: ticks_to_nanos(ticks),
        })
    }
}

impl FrameHaptics {
    /// Adds what the left and the right hand are to feel of a tick.
    pub fn add_tick(&mut self, left_and_right: [TickHaptics; 2]) {
        for (hand, tick) in self.hands.iter_mut().zip(left_and_right) {
            hand.add_tick(tick);
        }
        self.ticks += 1;
    }

    /// Takes the pulses for a frame, left and right; the next frame begins with none.
    #[must_use]
    pub fn take_pulses(&mut self) -> [Option<HapticPulse>; 2] {
        let ticks = core::mem::take(&mut self.ticks);
        self.hands.each_mut().map(|hand| hand.take_pulse(ticks))
    }
}

const fn ticks_to_nanos(ticks: u32) -> i64 {
    ticks as i64 * 1_000_000_000 / TICK_RATE as i64
}

#[cfg(test)]
mod tests {
    use super::{
        FrameHaptics, HapticPulse, REFUSAL, REFUSAL_INTERVAL_TICKS, REFUSAL_TICKS, RING,
        RING_TICKS, TickHaptics,
    };

    fn level(level: u8) -> TickHaptics {
        TickHaptics { level, ..NOTHING }
    }

    const NOTHING: TickHaptics = TickHaptics { level: 0, is_refused: false, rings: false };
    const REFUSED: TickHaptics = TickHaptics { level: 200, is_refused: true, rings: false };
    const RINGS: TickHaptics = TickHaptics { level: 200, is_refused: true, rings: true };

    #[test]
    fn a_frame_gives_one_pulse_a_hand_the_strongest_of_its_ticks() {
        let mut haptics = FrameHaptics::default();
        assert_eq!(haptics.take_pulses(), [None, None]);
        haptics.add_tick([NOTHING, level(51)]);
        haptics.add_tick([NOTHING, level(204)]);
        haptics.add_tick([NOTHING, level(102)]);
        let pulse = HapticPulse { amplitude: 0.8, frequency_hz: 0.0, nanos: 41_666_666 };
        assert_eq!(haptics.take_pulses(), [None, Some(pulse)]);
        assert_eq!(haptics.take_pulses(), [None, None], "each tick is felt once");
    }

    /// One frame a tick; the left hand only cuts.
    #[test]
    fn a_hand_that_is_refused_feels_it_twice_a_second() {
        let mut haptics = FrameHaptics::default();
        let mut refusals = vec![];
        for tick in 0..4 * REFUSAL_INTERVAL_TICKS {
            haptics.add_tick([level(200), REFUSED]);
            let [left, right] = haptics.take_pulses();
            assert!(left.is_some_and(|pulse| pulse.frequency_hz == 0.0));
            match right {
                Some(REFUSAL) => refusals.push(tick),
                Some(pulse) => assert_eq!(Some(pulse), left),
                None => {
                    let last = *refusals.last().expect("a refusal before");
                    assert!(tick - last < REFUSAL_TICKS, "silent {} ticks after it", tick - last);
                }
            }
        }
        assert_eq!(refusals, [0, 1, 2, 3].map(|i| i * REFUSAL_INTERVAL_TICKS));
    }

    #[test]
    fn a_refusal_is_felt_whole_and_once() {
        let mut haptics = FrameHaptics::default();
        haptics.add_tick([REFUSED, NOTHING]);
        haptics.add_tick([level(255), NOTHING]);
        assert_eq!(haptics.take_pulses(), [Some(REFUSAL), None]);
        // Two of its ticks are over with that frame.
        for _ in 2..REFUSAL_TICKS {
            haptics.add_tick([level(255), level(255)]);
            let [left, right] = haptics.take_pulses();
            assert!(left.is_none() && right.is_some());
        }
        haptics.add_tick([level(255), NOTHING]);
        assert!(matches!(haptics.take_pulses(), [Some(HapticPulse { amplitude: 1.0, .. }), None]));
    }

    #[test]
    fn a_bared_tenth_rings_whole_over_all_else() {
        let mut haptics = FrameHaptics::default();
        haptics.add_tick([REFUSED, level(90)]);
        haptics.add_tick([RINGS, level(90)]);
        let [left, right] = haptics.take_pulses();
        assert!(left == Some(RING) && right.is_some_and(|pulse| pulse != RING));
        // A tick of it is over with that frame.
        for _ in 1..RING_TICKS {
            haptics.add_tick([REFUSED, NOTHING]);
            assert_eq!(haptics.take_pulses(), [None, None]);
        }
        haptics.add_tick([level(255), NOTHING]);
        assert!(matches!(haptics.take_pulses(), [Some(HapticPulse { amplitude: 1.0, .. }), None]));
    }
}
