//! The wishes for a print, and their bounds.

use crate::limits::{MAX_FILAMENT_CHARS, MAX_NOTE_CHARS, PRINT_MINUTES, PRINT_TENTHS_MM};
use crate::reason::Expected;
use crate::refusal::Refusal;

/// The wishes for a print.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PrintWish {
    /// The size of the print.
    pub size: PrintSize,
    /// The filament's colour, for people.
    pub filament: String,
    /// A note for people.
    pub note: String,
}

/// The size of a print.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PrintSize {
    /// A height in tenths of a millimetre.
    Height(u32),
    /// The largest size that prints within this many minutes.
    Minutes(u32),
}

impl PrintWish {
    /// Checks the bounds of all wishes. `can_slice` is `true` if there is a slicer.
    ///
    /// # Errors
    /// [`Refusal::Unfit`] with the expected value.
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

/// Checks that a size can be found for a duration.
///
/// # Errors
/// [`Refusal::Unfit`] if there is no slicer.
pub(crate) fn check_minutes_can_be_found(can_slice: bool) -> Result<(), Refusal> {
    if can_slice { Ok(()) } else { Err(Refusal::Unfit(Expected::HeightAlone)) }
}
