//! The largest print within a time, by few slices: a print's time is about a power of its height, so that two slices
//! tell where the third is worth it.

use crate::limits::{MAX_SIZE_SLICES, PRINT_TENTHS_MM};

/// By which power of the height the time grows, before two slices tell: between that of walls and that of what they
/// enclose.
const FIRST_POWER: f64 = 2.2;

/// A print of this part of the time is as large as one may hope for.
const GOOD_PART: f64 = 0.95;

/// A search that is asked for a height to slice, and told how long that takes.
#[derive(Clone, Debug)]
pub struct SizeSearch {
    most_minutes: u32,
    first: u32,
    fits: Option<Sliced>,
    takes_too_long: Option<Sliced>,
    slices: u32,
}

/// A height in tenths of a millimetre, and the minutes that a print of it takes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Sliced {
    /// Tenths of a millimetre.
    pub height: u32,
    /// Minutes.
    pub minutes: u32,
}

impl SizeSearch {
    /// For so many minutes, beginning at a height in tenths of a millimetre.
    #[must_use]
    pub fn new(most_minutes: u32, first: u32) -> Self {
        let first = first.clamp(*PRINT_TENTHS_MM.start(), *PRINT_TENTHS_MM.end());
        SizeSearch { most_minutes, first, fits: None, takes_too_long: None, slices: 0 }
    }

    /// The height that is to be sliced next; `None` once the search is over.
    #[must_use]
    pub fn next_height(&self) -> Option<u32> {
        if self.slices >= MAX_SIZE_SLICES {
            return None;
        }
        let wanted = f64::from(self.most_minutes);
        let height = match (self.fits, self.takes_too_long) {
            (None, None) => return Some(self.first),
            (Some(fits), _) if f64::from(fits.minutes) >= GOOD_PART * wanted => return None,
            (Some(fits), Some(long)) => between(fits, long, wanted),
            // Somewhat less than the guess: from above, one that fits is worth more than one that is near.
            (None, Some(long)) => 0.95 * beyond(long, wanted),
            (Some(fits), None) => beyond(fits, 0.98 * wanted),
        };
        let (least, most) = (*PRINT_TENTHS_MM.start(), *PRINT_TENTHS_MM.end());
        let height = (height as u32).clamp(least, most);
        let is_known = |slice: Option<Sliced>| slice.is_some_and(|slice| slice.height == height);
        if is_known(self.fits) || is_known(self.takes_too_long) { None } else { Some(height) }
    }

    /// Takes what a slice told.
    pub fn note(&mut self, slice: Sliced) {
        self.slices += 1;
        let (known, is_better) = if slice.minutes <= self.most_minutes {
            let known = &mut self.fits;
            let is_better = known.is_none_or(|known| slice.height > known.height);
            (known, is_better)
        } else {
            let known = &mut self.takes_too_long;
            let is_better = known.is_none_or(|known| slice.height < known.height);
            (known, is_better)
        };
        if is_better {
            *known = Some(slice);
        }
    }

    /// The largest height that was sliced and fits.
    #[must_use]
    pub const fn result(&self) -> Option<Sliced> {
        self.fits
    }
}

/// The height at which a print would take so long, by what one takes and the usual power.
fn beyond(known: Sliced, wanted: f64) -> f64 {
    let part = wanted / f64::from(known.minutes.max(1));
    f64::from(known.height) * part.powf(1.0 / FIRST_POWER)
}

/// The height at which a print would take so long, by two others and the power that they follow; well between them.
fn between(fits: Sliced, long: Sliced, wanted: f64) -> f64 {
    let ln = |slice: Sliced| (f64::from(slice.height).ln(), f64::from(slice.minutes.max(1)).ln());
    let ((low, low_time), (high, high_time)) = (ln(fits), ln(long));
    let part = ((0.98 * wanted).ln() - low_time) / (high_time - low_time);
    // Where times jump, as by a layer more, it closes in all the same.
    (low + part.clamp(0.1, 0.9) * (high - low)).exp()
}

#[cfg(test)]
mod tests {
    use super::{SizeSearch, Sliced};
    use crate::limits::{MAX_SIZE_SLICES, PRINT_TENTHS_MM};
    use proptest::prelude::*;

    /// What is found where a print of a height takes so long, and how many slices it took.
    fn search(minutes: u32, first: u32, time: impl Fn(u32) -> u32) -> (Option<Sliced>, u32) {
        let (mut search, mut slices) = (SizeSearch::new(minutes, first), 0);
        while let Some(height) = search.next_height() {
            assert!(PRINT_TENTHS_MM.contains(&height));
            slices += 1;
            search.note(Sliced { height, minutes: time(height) });
        }
        (search.result(), slices)
    }

    #[test]
    fn what_never_fits_is_not_found_and_what_always_does_is_as_large_as_may_be() {
        assert_eq!(search(10, 1200, |_| 11).0, None);
        let (found, _) = search(10, 1200, |_| 1);
        assert_eq!(found.map(|found| found.height), Some(*PRINT_TENTHS_MM.end()));
    }

    proptest! {
        #[test]
        fn it_fits_and_is_nearly_as_large_as_can_be(
            minutes in 20u32..2000, first in 100u32..5000, power in 1.6f64..2.9,
            minutes_of_first in 10f64..1500.0, ground in 0f64..5.0,
        ) {
            let time = |height: u32| {
                (ground + minutes_of_first * (f64::from(height) / 1200.0).powf(power)).ceil() as u32
            };
            let (found, slices) = search(minutes, first, time);
            prop_assert!(slices <= MAX_SIZE_SLICES);
            let best = PRINT_TENTHS_MM.rev().step_by(5).find(|height| time(*height) <= minutes);
            if let Some(best) = best {
                let found = found.expect("one that fits");
                prop_assert!(time(found.height) <= minutes);
                prop_assert!(f64::from(found.height) > 0.9 * f64::from(best), "{found:?}, best {best}");
            }
        }
    }
}
