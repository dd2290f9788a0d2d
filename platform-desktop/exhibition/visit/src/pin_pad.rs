//! The PIN pad of the staff.
//!
//! Digits aren't recorded: a trace holds what the PIN opened, not what was pressed.

use paros_core::session::TICK_RATE;
use paros_shaders::panel::layout::PinEntry;
use paros_shell::settings::StaffPin;

/// Number of consecutive wrong PINs after which the pad is locked.
const TRIES: u8 = 5;

/// Ticks for which the pad is locked: a minute.
const LOCKED_TICKS: u32 = 60 * TICK_RATE;

/// Idle timeout of the staff's panel in ticks, so that no visitor finds it open.
pub(crate) const LEFT_TICKS: u32 = 45 * TICK_RATE;

/// The entered digits, and the number of failed tries.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct PinPad {
    pin: StaffPin,
    entered: [u8; 4],
    count: usize,
    is_wrong: bool,
    failed: u8,
    locked_ticks: u32,
    /// Ticks since the last press.
    quiet_ticks: u32,
}

impl PinPad {
    /// Makes an empty pad for a PIN.
    pub(crate) const fn new(pin: StaffPin) -> Self {
        PinPad {
            pin,
            entered: [0; 4],
            count: 0,
            is_wrong: false,
            failed: 0,
            locked_ticks: 0,
            quiet_ticks: 0,
        }
    }

    /// Advances the pad by one tick. Returns `true` once it has timed out.
    pub(crate) const fn is_left_after_tick(&mut self) -> bool {
        self.locked_ticks = self.locked_ticks.saturating_sub(1);
        self.quiet_ticks = self.quiet_ticks.saturating_add(1);
        self.quiet_ticks >= LEFT_TICKS && self.locked_ticks == 0
    }

    /// Enters a digit. Returns `true` if it completes the right PIN.
    pub(crate) fn press_digit(&mut self, digit: u8) -> bool {
        self.quiet_ticks = 0;
        if self.locked_ticks > 0 {
            return false;
        }
        self.is_wrong = false;
        self.entered[self.count] = digit;
        self.count += 1;
        if self.count < self.entered.len() {
            return false;
        }
        let is_right = self.pin.matches(&self.entered);
        self.forget();
        self.failed = if is_right { 0 } else { self.failed + 1 };
        self.is_wrong = !is_right;
        if self.failed == TRIES {
            (self.failed, self.locked_ticks) = (0, LOCKED_TICKS);
        }
        is_right
    }

    /// Removes the last digit.
    pub(crate) const fn erase(&mut self) {
        (self.count, self.quiet_ticks) = (self.count.saturating_sub(1), 0);
    }

    /// Clears the entered digits. The number of failed tries stays.
    pub(crate) fn forget(&mut self) {
        (self.entered, self.count, self.is_wrong) = ([0; 4], 0, false);
        self.quiet_ticks = 0;
    }

    /// Returns what the pad shows.
    pub(crate) const fn entry(&self) -> PinEntry {
        match self.count {
            _ if self.locked_ticks > 0 => PinEntry::Locked,
            0 if self.is_wrong => PinEntry::Wrong,
            count => PinEntry::Entered(count as u32),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{LOCKED_TICKS, PinEntry, PinPad, StaffPin, TRIES};

    fn pad(pin: &str) -> PinPad {
        PinPad::new(StaffPin::from_text(pin).expect("four digits"))
    }

    fn enter(pad: &mut PinPad, pin: [u8; 4]) -> bool {
        pin.map(|digit| pad.press_digit(digit))[3]
    }

    #[test]
    fn the_pin_opens_and_nothing_else() {
        let mut pad = pad("1234");
        assert!(!enter(&mut pad, [1, 2, 3, 5]));
        assert_eq!(pad.entry(), PinEntry::Wrong);
        pad.press_digit(1);
        pad.press_digit(9);
        pad.erase();
        assert_eq!(pad.entry(), PinEntry::Entered(1));
        assert!(![2, 3].map(|digit| pad.press_digit(digit)).contains(&true));
        assert!(pad.press_digit(4));
        assert_eq!(pad.entry(), PinEntry::Entered(0));
    }

    #[test]
    fn after_five_wrong_ones_even_the_right_one_waits_a_minute() {
        let mut pad = pad("0000");
        for _ in 0..TRIES {
            assert!(!enter(&mut pad, [9; 4]));
            // Closing the panel doesn't reset the failed tries.
            pad.forget();
        }
        assert_eq!(pad.entry(), PinEntry::Locked);
        for _ in 1..LOCKED_TICKS {
            pad.is_left_after_tick();
        }
        assert!(!enter(&mut pad, [0; 4]), "a tick too early");
        pad.is_left_after_tick();
        assert!(enter(&mut pad, [0; 4]));
    }

    #[test]
    fn a_right_one_forgives_those_before() {
        let mut pad = pad("5555");
        for _ in 0..4 {
            for _ in 1..TRIES {
                assert!(!enter(&mut pad, [1; 4]));
            }
            assert!(enter(&mut pad, [5; 4]));
        }
    }
}
