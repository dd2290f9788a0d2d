//! Search of the largest print within a duration, with few slicer runs. The duration is roughly a power of
//! the height, so that two slices predict where to try the third.

use crate::limits::{MAX_SIZE_SLICES, PRINT_TENTHS_MM};

/// The exponent of duration over height, assumed before two slices are known: between that of walls (2) and
/// of volumes (3).
const FIRST_POWER: f64 = 2.2;

/// The share of the allowed duration that counts as large enough.
const GOOD_PART: f64 = 0.95;

/// A search that proposes heights to slice, and receives their durations.
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
    /// The height in tenths of a millimetre.
    pub height: u32,
    /// The duration in minutes.
    pub minutes: u32,
}

impl SizeSearch {
    /// Starts a search for a duration of `most_minutes`, at the height `first` in tenths of a millimetre.
    #[must_use]
    pub fn new(most_minutes: u32, first: u32) -> Self {
        let first = first.clamp(*PRINT_TENTHS_MM.start(), *PRINT_TENTHS_MM.end());
        SizeSearch { most_minutes, first, fits: None, takes_too_long: None, slices: 0 }
    }

    /// Returns the height to slice next; `None` once the search is over.
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
            // Somewhat less than the estimate: from above, a fitting height is worth more than a close one.
            (None, Some(long)) => 0.95 * beyond(long, wanted),
            (Some(fits), None) => beyond(fits, 0.98 * wanted),
        };
        let (least, most) = (*PRINT_TENTHS_MM.start(), *PRINT_TENTHS_MM.end());
        let height = (height as u32).clamp(least, most);
        let is_known = |slice: Option<Sliced>| slice.is_some_and(|slice| slice.height == height);
        if is_known(self.fits) || is_known(self.takes_too_long) { None } else { Some(height) }
    }

    /// Takes the result of a slice.
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

    /// Returns the largest sliced height that fits.
    #[must_use]
    pub const fn result(&self) -> Option<Sliced> {
        self.fits
    }
}

/// Returns the height at which a print takes `wanted` minutes, extrapolated from one slice with
/// [`FIRST_POWER`].
fn beyond(known: Sliced, wanted: f64) -> f64 {
    let part = wanted / f64::from(known.minutes.max(1));
    f64::from(known.height) * part.powf(1.0 / FIRST_POWER)
}

/// Returns the height at which a print takes `wanted` minutes, by the power law through two slices.
fn between(fits: Sliced, long: Sliced, wanted: f64) -> f64 {
    let ln = |slice: Sliced| (f64::from(slice.height).ln(), f64::from(slice.minutes.max(1)).ln());
    let ((low, low_time), (high, high_time)) = (ln(fits), ln(long));
    let part = ((0.98 * wanted).ln() - low_time) / (high_time - low_time);
    // The clamp lets the search converge even if durations jump, such as by a further layer.
    (low + part.clamp(0.1, 0.9) * (high - low)).exp()
}

#[cfg(test)]
mod tests {
    use super::{SizeSearch, Sliced};
    use crate::limits::{MAX_SIZE_SLICES, PRINT_TENTHS_MM};
    use proptest::prelude::*;

    /// Runs a search with a function from height to duration. Returns its result and the number of slices.
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
