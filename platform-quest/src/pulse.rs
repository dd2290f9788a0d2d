//! Haptics: what the core's ticks let a hand feel, as pulses of the runtime's.

use paros_core::input::TICK_RATE;

/// A vibration.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pulse {
    /// 0 to 1.
    pub amplitude: f32,
    /// How long, in nanoseconds.
    pub nanos: i64,
}

/// What the hands are to feel of the ticks since the last frame. A pulse takes the place of the one
/// before it, so that a frame gives each hand one at the most: the strongest of its ticks', as long
/// as they all.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Pulses {
    levels: [u8; 2],
    ticks: u32,
}

impl Pulses {
    /// Takes in a tick's levels, 0 to 255, of the left and the right hand.
    pub fn note(&mut self, levels: [u8; 2]) {
        for (most, level) in self.levels.iter_mut().zip(levels) {
            *most = level.max(*most);
        }
        self.ticks += 1;
    }

    /// The pulses for a frame, left and right.
    #[must_use]
    pub fn take(&mut self) -> [Option<Pulse>; 2] {
        let Pulses { levels, ticks } = core::mem::take(self);
        let nanos = i64::from(ticks) * 1_000_000_000 / i64::from(TICK_RATE);
        levels.map(|level| {
            (level > 0).then_some(Pulse { amplitude: f32::from(level) / 255.0, nanos })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Pulse, Pulses};

    #[test]
    fn a_frame_gives_one_pulse_a_hand_the_strongest_of_its_ticks() {
        let mut pulses = Pulses::default();
        assert_eq!(pulses.take(), [None, None]);
        pulses.note([0, 51]);
        pulses.note([0, 204]);
        pulses.note([0, 102]);
        let pulse = Pulse { amplitude: 0.8, nanos: 41_666_666 };
        assert_eq!(pulses.take(), [None, Some(pulse)]);
        assert_eq!(pulses.take(), [None, None], "each tick is felt once");
    }
}
