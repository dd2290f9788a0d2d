//! Haptics: the vibrations of ticks, merged into one pulse per frame and hand.
//!
//! A dull pulse marks a cut that closure refuses, and a bright one marks each further tenth of the hidden
//! figure that is bared. A cutting pulse lasts longer than its frame, so that a late frame leaves no gap; it
//! is stopped as soon as cutting ends.

use paros_core::session::TICK_RATE;
use paros_core::volume::{Grid, Size};
use paros_core::{World, WorldEvent};

/// A vibration, as `XrHapticVibration` describes it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HapticPulse {
    /// The amplitude, 0 to 1.
    pub amplitude: f32,
    /// The frequency in hertz; 0, OpenXR's `XR_FREQUENCY_UNSPECIFIED`, leaves it to the controller.
    pub frequency_hz: f32,
    /// Duration in nanoseconds.
    pub nanos: i64,
}

/// A change of a hand's vibration at a frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum HapticChange {
    /// No change: silence, or the current pulse continues.
    None,
    /// A pulse begins, and replaces the one before it.
    Begin(HapticPulse),
    /// The cutting pulse is stopped early.
    Stop,
}

/// The length of a cutting pulse in ticks, unless it is stopped or replaced.
const CUT_TICKS: u32 = 3;

/// The length of a refusal pulse in ticks: an eighth of a second.
const REFUSAL_TICKS: u32 = 9;

/// The least number of ticks from one refusal pulse to the next: two pulses a second at most.
const REFUSAL_INTERVAL_TICKS: u32 = TICK_RATE / 2;

/// The refusal pulse: long, and far below the 150 to 300 Hz at which controllers resonate and cutting is
/// felt.
const REFUSAL: HapticPulse =
    HapticPulse { amplitude: 0.7, frequency_hz: 55.0, nanos: ticks_to_nanos(REFUSAL_TICKS) };

/// The length of the pulse for another bared tenth in ticks: a third of a second.
const RING_TICKS: u32 = 24;

/// The pulse for another bared tenth: at the controllers' resonance, to stand out like a bell from the noise
/// of cutting.
const RING: HapticPulse =
    HapticPulse { amplitude: 1.0, frequency_hz: 230.0, nanos: ticks_to_nanos(RING_TICKS) };

/// The haptics of one hand in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct TickHaptics {
    /// The strength of the hand's contact with the stone, 0 to 255.
    pub level: u8,
    /// `true` if closure restored more than the hand's edits removed.
    pub is_refused: bool,
    /// `true` if another part of the hidden figure was reported as bared, by this hand's work or, if neither
    /// hand works, by a piece that fell off.
    pub rings: bool,
}

impl TickHaptics {
    /// Returns the haptics of a world's last tick, left and right.
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

/// The haptics of the ticks since the last frame.
///
/// A new pulse replaces the one before it, so a frame gives each hand at most one pulse, with the strongest
/// level of its ticks. A ring has priority over a refusal, and a refusal over cutting; a pulse never cuts one
/// of higher priority short.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct FrameHaptics {
    hands: [HandHaptics; 2],
}

#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
struct HandHaptics {
    level: u8,
    /// `true` if this frame begins a ring, or a refusal pulse.
    rings: bool,
    is_refused: bool,
    /// Ticks until the last cutting pulse, ring and refusal pulse end.
    cut_ticks_left: u32,
    ring_ticks_left: u32,
    refusal_ticks_left: u32,
    /// Ticks until the next refusal pulse may begin.
    pause_ticks_left: u32,
}

impl HandHaptics {
    fn add_tick(&mut self, TickHaptics { level, is_refused, rings }: TickHaptics) {
        self.level = level.max(self.level);
        for left in [
            &mut self.cut_ticks_left,
            &mut self.ring_ticks_left,
            &mut self.refusal_ticks_left,
            &mut self.pause_ticks_left,
        ] {
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

    fn take_change(&mut self) -> HapticChange {
        let level = core::mem::take(&mut self.level);
        let is_refused = core::mem::take(&mut self.is_refused);
        let cut_ticks_left = core::mem::take(&mut self.cut_ticks_left);
        if core::mem::take(&mut self.rings) {
            return HapticChange::Begin(RING);
        }
        if is_refused && self.ring_ticks_left == 0 {
            return HapticChange::Begin(REFUSAL);
        }
        if self.ring_ticks_left > 0 || self.refusal_ticks_left > 0 {
            return HapticChange::None;
        }
        match (level, cut_ticks_left) {
            (0, 0) => HapticChange::None,
            (0, _) => HapticChange::Stop,
            (1.., _) => {
                self.cut_ticks_left = CUT_TICKS;
                HapticChange::Begin(HapticPulse {
                    amplitude: f32::from(level) / 255.0,
                    frequency_hz: 0.0,
                    nanos: ticks_to_nanos(CUT_TICKS),
                })
            }
        }
    }
}

impl FrameHaptics {
    /// Adds the haptics of a tick, left and right.
    pub fn add_tick(&mut self, left_and_right: [TickHaptics; 2]) {
        for (hand, tick) in self.hands.iter_mut().zip(left_and_right) {
            hand.add_tick(tick);
        }
    }

    /// Returns the changes for a frame, left and right, and starts to collect for the next frame.
    #[must_use]
    pub fn take_changes(&mut self) -> [HapticChange; 2] {
        self.hands.each_mut().map(HandHaptics::take_change)
    }
}

const fn ticks_to_nanos(ticks: u32) -> i64 {
    ticks as i64 * 1_000_000_000 / TICK_RATE as i64
}

#[cfg(test)]
mod tests {
    use super::{
        CUT_TICKS, FrameHaptics, HapticChange, HapticPulse, REFUSAL, REFUSAL_INTERVAL_TICKS,
        REFUSAL_TICKS, RING, RING_TICKS, TickHaptics,
    };

    fn level(level: u8) -> TickHaptics {
        TickHaptics { level, ..NOTHING }
    }

    const NOTHING: TickHaptics = TickHaptics { level: 0, is_refused: false, rings: false };
    const REFUSED: TickHaptics = TickHaptics { level: 200, is_refused: true, rings: false };
    const RINGS: TickHaptics = TickHaptics { level: 200, is_refused: true, rings: true };

    /// Returns a cutting pulse of a level.
    fn cut(level: u8) -> HapticChange {
        let amplitude = f32::from(level) / 255.0;
        HapticChange::Begin(HapticPulse { amplitude, frequency_hz: 0.0, nanos: 41_666_666 })
    }

    const SILENT: HapticChange = HapticChange::None;

    #[test]
    fn a_frame_gives_one_pulse_a_hand_the_strongest_of_its_ticks() {
        let mut haptics = FrameHaptics::default();
        assert_eq!(haptics.take_changes(), [SILENT; 2]);
        haptics.add_tick([NOTHING, level(51)]);
        haptics.add_tick([NOTHING, level(204)]);
        haptics.add_tick([NOTHING, level(102)]);
        assert_eq!(haptics.take_changes(), [SILENT, cut(204)]);
    }

    /// Without a stop the pulse would last three ticks.
    #[test]
    fn cutting_that_ends_is_stopped_at_once_and_only_once() {
        let mut haptics = FrameHaptics::default();
        for _ in 0..5 {
            haptics.add_tick([level(80), NOTHING]);
            assert_eq!(haptics.take_changes(), [cut(80), SILENT], "each frame renews it");
        }
        haptics.add_tick([NOTHING; 2]);
        assert_eq!(haptics.take_changes(), [HapticChange::Stop, SILENT]);
        haptics.add_tick([NOTHING; 2]);
        assert_eq!(haptics.take_changes(), [SILENT; 2]);
        // It ends by itself if the next frame is late.
        haptics.add_tick([level(80), NOTHING]);
        assert_eq!(haptics.take_changes(), [cut(80), SILENT]);
        for _ in 0..CUT_TICKS {
            haptics.add_tick([NOTHING; 2]);
        }
        assert_eq!(haptics.take_changes(), [SILENT; 2]);
    }

    /// There is one frame per tick; the left hand only cuts.
    #[test]
    fn a_hand_that_is_refused_feels_it_twice_a_second() {
        let mut haptics = FrameHaptics::default();
        let mut refusals = vec![];
        for tick in 0..4 * REFUSAL_INTERVAL_TICKS {
            haptics.add_tick([level(200), REFUSED]);
            let [left, right] = haptics.take_changes();
            assert_eq!(left, cut(200));
            match right {
                HapticChange::Begin(REFUSAL) => refusals.push(tick),
                HapticChange::None => {
                    let last = *refusals.last().expect("a refusal before");
                    assert!(tick - last < REFUSAL_TICKS, "silent {} ticks after it", tick - last);
                }
                other => assert_eq!(other, left),
            }
        }
        assert_eq!(refusals, [0, 1, 2, 3].map(|i| i * REFUSAL_INTERVAL_TICKS));
    }

    #[test]
    fn a_refusal_is_felt_whole_and_once() {
        let mut haptics = FrameHaptics::default();
        haptics.add_tick([REFUSED, NOTHING]);
        haptics.add_tick([level(255), NOTHING]);
        assert_eq!(haptics.take_changes(), [HapticChange::Begin(REFUSAL), SILENT]);
        // Two ticks of the pulse have passed at that frame.
        for tick in 2..REFUSAL_TICKS {
            haptics.add_tick([level(if tick == 4 { 0 } else { 255 }), level(255)]);
            assert_eq!(haptics.take_changes(), [SILENT, cut(255)], "nothing stops it");
        }
        haptics.add_tick([level(255), NOTHING]);
        assert_eq!(haptics.take_changes(), [cut(255), HapticChange::Stop]);
    }

    #[test]
    fn a_bared_tenth_rings_whole_over_all_else() {
        let mut haptics = FrameHaptics::default();
        haptics.add_tick([REFUSED, level(90)]);
        haptics.add_tick([RINGS, level(90)]);
        assert_eq!(haptics.take_changes(), [HapticChange::Begin(RING), cut(90)]);
        // One tick of the ring has passed at that frame.
        for tick in 1..RING_TICKS {
            haptics.add_tick([REFUSED, NOTHING]);
            let right = if tick == 1 { HapticChange::Stop } else { SILENT };
            assert_eq!(haptics.take_changes(), [SILENT, right]);
        }
        haptics.add_tick([level(255), NOTHING]);
        assert_eq!(haptics.take_changes(), [cut(255), SILENT]);
    }
}
