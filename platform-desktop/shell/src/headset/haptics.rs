//! Haptics: the vibration levels of ticks, merged into one pulse a frame for each hand.

use paros_core::TICK_RATE;

/// A vibration, as `XrHapticVibration` describes it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HapticPulse {
    /// 0 to 1.
    pub amplitude: f32,
    /// Duration in nanoseconds.
    pub nanos: i64,
}

/// The haptics of the ticks since the last frame. A new pulse replaces the one before it, so a frame
/// gives each hand at most one: with the strongest level of its ticks, for the duration of all.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct FrameHaptics {
    levels: [u8; 2],
    ticks: u32,
}

impl FrameHaptics {
    /// Adds a tick's levels, 0 to 255, of the left and the right hand.
    pub fn add_tick_levels(&mut self, left_and_right: [u8; 2]) {
        for (most, level) in self.levels.iter_mut().zip(left_and_right) {
            *most = level.max(*most);
        }
        self.ticks += 1;
    }

    /// Takes the pulses for a frame, left and right; the next frame begins with none.
    #[must_use]
    pub fn take_pulses(&mut self) -> [Option<HapticPulse>; 2] {
        let FrameHaptics { levels, ticks } = core::mem::take(self);
        let nanos = i64::from(ticks) * 1_000_000_000 / i64::from(TICK_RATE);
        levels.map(|level| {
            (level > 0).then_some(HapticPulse { amplitude: f32::from(level) / 255.0, nanos })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{FrameHaptics, HapticPulse};

    #[test]
    fn a_frame_gives_one_pulse_a_hand_the_strongest_of_its_ticks() {
        let mut haptics = FrameHaptics::default();
        assert_eq!(haptics.take_pulses(), [None, None]);
        haptics.add_tick_levels([0, 51]);
        haptics.add_tick_levels([0, 204]);
        haptics.add_tick_levels([0, 102]);
        let pulse = HapticPulse { amplitude: 0.8, nanos: 41_666_666 };
        assert_eq!(haptics.take_pulses(), [None, Some(pulse)]);
        assert_eq!(haptics.take_pulses(), [None, None], "each tick is felt once");
    }
}
