//! Presses of the sticks: a short press mirrors, a long one swaps the hands. The core receives the result.

use paros_core::TickInput;
use paros_core::session::{TICK_RATE, buttons, commands};

/// The number of ticks for which a stick is held down to swap the hands: half a second.
const LONG_PRESS_TICKS: u32 = TICK_RATE / 2;

/// The deflection of a stick, of 127, from which it turns or resizes, so that its press isn't a long one.
const LEANS_FROM: u8 = 48;

/// The number of ticks for which each hand's stick has been held down in its middle.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct StickPresses {
    held_ticks: [u32; 2],
}

impl StickPresses {
    /// Replaces the sticks' presses in a tick's input. The button is down in the tick in which a short press
    /// ends. A long press gives the command to swap the hands while the stick is still held. A press that
    /// ends while the hand isn't tracked is ignored.
    pub fn replace_in_input(&mut self, input: &mut TickInput) {
        for (hand, held) in input.hands.iter_mut().zip(&mut self.held_ticks) {
            let is_down = hand.tracked && hand.buttons & buttons::STICK != 0;
            let leans = hand.stick.iter().any(|part| part.unsigned_abs() >= LEANS_FROM);
            hand.buttons &= !buttons::STICK;
            if is_down {
                let counts = *held == 0 || !leans || *held >= LONG_PRESS_TICKS;
                *held = held.saturating_add(counts.into());
                if *held == LONG_PRESS_TICKS && counts {
                    input.commands |= commands::SWAP_HANDS;
                }
            } else {
                let was_short = (1..LONG_PRESS_TICKS).contains(held);
                hand.buttons |= if was_short && hand.tracked { buttons::STICK } else { 0 };
                *held = 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use paros_core::session::{buttons, commands};
    use paros_core::{HandInput, TickInput};

    use super::{LONG_PRESS_TICKS, StickPresses};

    /// Holds one hand's stick down for `ticks` and releases it. Returns the ticks in which the core receives
    /// a press, and the ticks in which it receives the command to swap.
    fn press(
        hand: usize,
        ticks: u32,
        mut change: impl FnMut(u32, &mut HandInput),
    ) -> [Vec<u32>; 2] {
        let mut presses = StickPresses::default();
        let mut told = [Vec::new(), Vec::new()];
        for tick in 0..ticks + 3 {
            let mut input = TickInput::default();
            let down = if tick < ticks { buttons::STICK } else { 0 };
            input.hands[hand] =
                HandInput { tracked: true, buttons: buttons::UPPER | down, ..HandInput::default() };
            change(tick, &mut input.hands[hand]);
            presses.replace_in_input(&mut input);
            assert_ne!(
                input.hands[hand].buttons & buttons::UPPER,
                0,
                "the others are as they were"
            );
            if input.hands[hand].buttons & buttons::STICK != 0 {
                told[0].push(tick);
            }
            if input.commands & commands::SWAP_HANDS != 0 {
                told[1].push(tick);
            }
        }
        told
    }

    const NEVER: Vec<u32> = Vec::new();

    #[test]
    fn a_short_press_mirrors_and_a_long_one_swaps() {
        for hand in 0..2 {
            let held = |ticks| press(hand, ticks, |_, _| {});
            assert_eq!(held(0), [NEVER; 2]);
            assert_eq!(held(1), [vec![1], vec![]]);
            let almost = LONG_PRESS_TICKS - 1;
            assert_eq!(held(almost), [vec![almost], vec![]]);
            assert_eq!(held(LONG_PRESS_TICKS), [vec![], vec![almost]]);
            assert_eq!(held(9 * LONG_PRESS_TICKS), [vec![], vec![almost]], "once");
        }
    }

    #[test]
    fn a_stick_that_turns_or_resizes_is_not_held_for_long() {
        let ticks = 3 * LONG_PRESS_TICKS;
        for stick in [[100, 0], [0, -100], [-128, 127]] {
            let leaning = press(1, ticks, |_, hand| hand.stick = stick);
            assert_eq!(leaning, [vec![ticks], vec![]], "{stick:?}");
        }
        // First: the stick leans, but then stays straight for long enough. Second: it leans just before the
        // press becomes long.
        let late = press(0, ticks, |tick, hand| hand.stick[0] = if tick < 20 { 90 } else { 5 });
        assert_eq!(late, [vec![], vec![LONG_PRESS_TICKS + 18]]);
        let at_last = press(0, ticks, |tick, hand| {
            hand.stick[0] = if tick + 1 >= LONG_PRESS_TICKS { 90 } else { 0 };
        });
        assert_eq!(at_last, [vec![ticks], vec![]]);
    }

    #[test]
    fn a_press_that_ends_out_of_sight_is_none() {
        let lost = press(1, 10, |tick, hand| hand.tracked = tick < 5);
        assert_eq!(lost, [NEVER; 2]);
    }
}
