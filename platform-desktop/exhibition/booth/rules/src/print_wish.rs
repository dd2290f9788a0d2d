//! What somebody wants of a print, and its bounds.

use crate::limits::{MAX_FILAMENT_CHARS, MAX_NOTE_CHARS, PRINT_MINUTES, PRINT_TENTHS_MM};
use crate::reason::Expected;
use crate::refusal::Refusal;

/// What somebody wants printed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PrintWish {
    /// How large.
    pub size: PrintSize,
    /// The filament's colour, for people.
    pub filament: String,
    /// What else there is to say, for people.
    pub note: String,
}

/// How large a print is to be.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PrintSize {
    /// So high, in tenths of a millimetre.
    Height(u32),
    /// As large as it can be within so many minutes.
    Minutes(u32),
}

impl PrintWish {
    /// Checks that all of it is within its bounds. `can_slice` is whether there is a slicer.
    ///
    /// # Errors
    /// [`Refusal::Unfit`] with what was expected.
    pub(crate) fn check(&self, can_slice: bool) -> Result<(), Refusal> {
        let bad = |expected| Err(Refusal::Unfit(expected));
        match self.size {
            PrintSize::Height(height) if !PRINT_TENTHS_MM.contains(&height) => {
                let (least, most) = (PRINT_TENTHS_MM.start() / 10, PRINT_TENTHS_MM.end() / 10);
                return bad(Expected::HeightWithin(least, most));
            }
            PrintSize::Minutes(minutes) if !PRINT_MINUTES.contains(&minutes) => {
                let (least, most) = (*PRINT_MINUTES.start(), *PRINT_MINUTES.end());
                return bad(Expected::MinutesWithin(least, most));
            }
            PrintSize::Minutes(_) => check_minutes_can_be_found(can_slice)?,
            PrintSize::Height(_) => {}
        }
        let is_text = |text: &str, most: usize, is_one_line: bool| {
            let is_fine =
                |letter: char| !letter.is_control() || !is_one_line && "\r\n".contains(letter);
            text.chars().count() <= most && text.chars().all(is_fine)
        };
        if !is_text(&self.filament, MAX_FILAMENT_CHARS, true) {
            return bad(Expected::Filament(MAX_FILAMENT_CHARS));
        }
        if !is_text(&self.note, MAX_NOTE_CHARS, false) {
            return bad(Expected::Note(MAX_NOTE_CHARS));
        }
        Ok(())
    }
}

/// Checks that a size can be found by time.
///
/// # Errors
/// [`Refusal::Unfit`] where there is no slicer.
pub(crate) fn check_minutes_can_be_found(can_slice: bool) -> Result<(), Refusal> {
    if can_slice { Ok(()) } else { Err(Refusal::Unfit(Expected::HeightAlone)) }
}
