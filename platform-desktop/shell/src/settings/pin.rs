//! The staff's PIN, which is never printed.

use std::fmt;

/// The number of digits of a PIN.
pub const PIN_DIGITS: usize = 4;

/// Four digits that open the staff's panel: a lock against visitors who try things, not against thieves.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct StaffPin([u8; PIN_DIGITS]);

impl StaffPin {
    /// Parses a PIN: exactly four digits.
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        let digits: [u8; PIN_DIGITS] = text.as_bytes().try_into().ok()?;
        let is_pin = digits.iter().all(u8::is_ascii_digit);
        is_pin.then(|| StaffPin(digits.map(|digit| digit - b'0')))
    }

    /// Returns `true` if these digits, each 0 to 9, are the PIN.
    #[must_use]
    pub fn matches(&self, digits: &[u8]) -> bool {
        self.0 == digits
    }
}

/// Hides the digits.
impl fmt::Debug for StaffPin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("StaffPin(set)")
    }
}

#[cfg(test)]
mod tests {
    use super::StaffPin;

    #[test]
    fn a_pin_is_four_digits_and_none_is_printed() {
        let pin = StaffPin::from_text("0420").expect("four digits");
        assert!(pin.matches(&[0, 4, 2, 0]) && StaffPin::from_text("0000").is_some());
        for digits in [&[0, 4, 2, 1][..], &[0, 4, 2], &[0, 4, 2, 0, 0], b"0420", &[]] {
            assert!(!pin.matches(digits), "{digits:?}");
        }
        for text in ["", "420", "04200", "042a", "+420", " 420", "٤٢", "0x42"] {
            assert_eq!(StaffPin::from_text(text), None, "{text}");
        }
        assert_eq!(format!("{pin:?} {pin:#?}"), "StaffPin(set) StaffPin(set)");
    }
}
