//! The sizes of sculptures in the shells, and the intervals of their columns. They are chosen at run time,
//! from a file or a command line, and are const generics in the core; the macros here convert one into the
//! other.

use paros_core::limits::INTERVALS;

/// Voxels along an edge of a sculpture, the usual number first.
pub const GRID_SIDES: [usize; 2] = [128, 256];

/// The sizes as texts for command lines.
pub const GRID_SIDE_NAMES: [&str; 2] = ["128", "256"];

/// The numbers of intervals per column that a sculpture may have, the usual number first. Older traces and
/// volumes have one.
pub const INTERVAL_COUNTS: [usize; 2] = [INTERVALS, 1];

/// The interval counts as texts for command lines.
pub const INTERVAL_COUNT_NAMES: [&str; 2] = ["2", "1"];

/// Returns the grid side for a text of [`GRID_SIDE_NAMES`], or the usual one for any other text.
#[must_use]
pub fn grid_side_or_default(name: &str) -> usize {
    let found = GRID_SIDE_NAMES.into_iter().zip(GRID_SIDES).find(|(named, _)| *named == name);
    found.map_or(GRID_SIDES[0], |(_, size)| size)
}

/// Returns the interval count for a text of [`INTERVAL_COUNT_NAMES`], or the usual number for any other text.
#[must_use]
pub fn interval_count_or_default(name: &str) -> usize {
    let mut named = INTERVAL_COUNT_NAMES.into_iter().zip(INTERVAL_COUNTS);
    named.find(|(known, _)| *known == name).map_or(INTERVALS, |(_, count)| count)
}

/// Evaluates an expression that is generic in the size N, at a size known only at run time:
/// `with_size!(size, N => bake::<N>(mesh))`. A size other than 256 counts as 128, or gives the expression
/// after `else`:
/// `with_size!(size, N => bake::<N>(mesh), else Err(Unusable))`.
#[macro_export]
macro_rules! with_size {
    ($size:expr, $N:ident => $at:expr $(,)?) => {
        match $size {
            256 => {
                const $N: usize = 256;
                $at
            }
            _ => {
                const $N: usize = 128;
                $at
            }
        }
    };
    ($size:expr, $N:ident => $at:expr, else $other:expr $(,)?) => {
        match $size {
            size if $crate::sizes::GRID_SIDES.contains(&size) => $crate::with_size!(size, $N => $at),
            _ => $other,
        }
    };
}

/// Evaluates an expression that is generic in the intervals per column K, at a number known only at run time:
/// `with_intervals!(count, K => play::<128, K>(trace))`. A number other than 1 counts as the usual number, or
/// gives the expression after `else`.
#[macro_export]
macro_rules! with_intervals {
    ($count:expr, $K:ident => $at:expr $(,)?) => {
        match $count {
            1 => {
                const $K: usize = 1;
                $at
            }
            _ => {
                const $K: usize = $crate::sizes::INTERVAL_COUNTS[0];
                $at
            }
        }
    };
    ($count:expr, $K:ident => $at:expr, else $other:expr $(,)?) => {
        match $count {
            count if $crate::sizes::INTERVAL_COUNTS.contains(&count) => {
                $crate::with_intervals!(count, $K => $at)
            }
            _ => $other,
        }
    };
}

#[cfg(test)]
mod tests {
    use super::{
        GRID_SIDE_NAMES, GRID_SIDES, INTERVAL_COUNT_NAMES, INTERVAL_COUNTS, grid_side_or_default,
        interval_count_or_default,
    };

    const fn twice<const N: usize>() -> usize {
        2 * N
    }

    #[test]
    fn names_are_the_sizes_in_digits() {
        assert_eq!(GRID_SIDE_NAMES.map(grid_side_or_default), GRID_SIDES);
        assert_eq!(GRID_SIDE_NAMES.map(String::from), GRID_SIDES.map(|size| size.to_string()));
        assert_eq!(INTERVAL_COUNT_NAMES.map(interval_count_or_default), INTERVAL_COUNTS);
        assert_eq!(
            INTERVAL_COUNT_NAMES.map(String::from),
            INTERVAL_COUNTS.map(|count| count.to_string())
        );
    }

    #[test]
    fn each_size_is_its_own_constant() {
        assert_eq!(
            GRID_SIDES.map(|size| with_size!(size, N => twice::<N>())),
            GRID_SIDES.map(|n| 2 * n)
        );
        let strict = [64, 128, 256].map(|size| with_size!(size, N => twice::<N>(), else 0));
        assert_eq!((strict, with_size!(7, N => twice::<N>())), ([0, 256, 512], 256));
        let counts = [0, 1, 2, 3].map(|count| with_intervals!(count, K => twice::<K>(), else 0));
        assert_eq!((counts, INTERVAL_COUNTS), ([0, 2, 4, 0], [2, 1]));
    }
}
