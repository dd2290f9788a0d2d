//! The operator's own hidden figures, which a headset's package adds to the built-in ones.

use paros_core::RangeMaps;
use paros_core::session::SessionMode;
use paros_core::volume::{BitGrid, BitSet, Grid, Size};

use super::HiddenStart;
use crate::modes::parse_mode;

/// The most figures of the operator's own: twice the number of built-in ones, and 12 MiB of maps at 256.
pub const MAX_OWN_FIGURES: usize = 8;

/// The most bytes of a figure's name.
pub const MAX_FIGURE_NAME_BYTES: usize = 32;

/// The thickness of the stone around such a figure, as for newcomers, and the box's edge, both in
/// millimetres.
const COAT_MM: usize = 20;
const BOX_MM: usize = 450;

/// Returns the mode that starts with the figure at an index of the operator's own.
#[must_use]
pub const fn own_figure_mode(place: usize) -> SessionMode {
    debug_assert!(place < MAX_OWN_FIGURES);
    SessionMode::Constrained { figure: (HiddenStart::ALL.len() + place) as u8 }
}

/// Checks the operator's own figure names: at most [`MAX_OWN_FIGURES`], unique among all modes, of small
/// letters, digits and hyphens.
///
/// # Errors
/// Returns a text with the name and what was expected.
pub fn check_own_figure_names(names: &[String]) -> Result<(), String> {
    if names.len() > MAX_OWN_FIGURES {
        return Err(format!("{} figures, expected at most {MAX_OWN_FIGURES}", names.len()));
    }
    for (place, name) in names.iter().enumerate() {
        let is_name_byte = |c: u8| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'-';
        let shown = name.escape_debug();
        if name.is_empty() || name.len() > MAX_FIGURE_NAME_BYTES || !name.bytes().all(is_name_byte)
        {
            return Err(format!(
                "{shown}: no name of a figure, expected 1 to {MAX_FIGURE_NAME_BYTES} small letters, digits and hyphens"
            ));
        }
        if parse_mode(name).is_ok() || name == "own" || names[..place].contains(name) {
            return Err(format!("{shown}: there is one of this name already, expected another"));
        }
    }
    Ok(())
}

/// Returns the number of voxels to leave empty on every side of a figure: the stone's thickness and one more.
#[must_use]
pub const fn coat_margin(grid_side: usize) -> usize {
    coat_reach_subunits(grid_side).div_ceil(256) + 1
}

/// Writes the stone around a figure: the closure of all voxels whose centres are within the stone's thickness
/// of the centre of a voxel of the figure. The stone contains the figure.
pub fn write_coat_into<const N: usize, const K: usize>(
    figure: &BitGrid<N>,
    stone: &mut RangeMaps<N, K>,
    scratch: &mut BitGrid<N>,
) where
    Grid<N>: Size,
{
    let reach = coat_reach_subunits(N);
    let offsets = list_ball_rows(reach);
    scratch.clear();
    for y in 0..N {
        for z in 0..N {
            let row = figure.row(y, z);
            let runs: Vec<_> = row.iter_runs_within_words().collect();
            for BallRow { dy, dz, half_width } in offsets.iter().filter(|_| !runs.is_empty()) {
                let at = (y.checked_add_signed(*dy), z.checked_add_signed(*dz));
                let (Some(y), Some(z)) = at else { continue };
                if y >= N || z >= N {
                    continue;
                }
                for run in &runs {
                    let first = run.first().saturating_sub(*half_width);
                    let last = (run.last() + half_width).min(N - 1);
                    *scratch.row_mut(y, z) |= BitSet::span(first, last);
                }
            }
        }
    }
    scratch.write_closure(stone);
}

/// A row of a ball's voxels, by its offset from the middle row.
struct BallRow {
    dy: isize,
    dz: isize,
    half_width: usize,
}

/// Returns the rows of a ball with a radius in 1/256 voxels.
fn list_ball_rows(radius: usize) -> Vec<BallRow> {
    let most = (radius / 256) as isize;
    let rows = (-most..=most).flat_map(|dy| (-most..=most).map(move |dz| (dy, dz)));
    let half_width = |(dy, dz): (isize, isize)| {
        let beside = (dy * dy + dz * dz) as usize * 256 * 256;
        let left = (radius * radius).checked_sub(beside)?;
        Some(BallRow { dy, dz, half_width: left.isqrt() / 256 })
    };
    rows.filter_map(half_width).collect()
}

/// Returns the stone's thickness in 1/256 voxels.
const fn coat_reach_subunits(grid_side: usize) -> usize {
    256 * grid_side * COAT_MM / BOX_MM
}

#[cfg(test)]
mod tests {
    use paros_core::RangeMaps;
    use paros_core::limits::INTERVALS;
    use paros_core::volume::{BitGrid, BitSet};

    use super::{
        MAX_OWN_FIGURES, check_own_figure_names, coat_margin, coat_reach_subunits, own_figure_mode,
        write_coat_into,
    };
    use crate::figures::HiddenStart;
    use crate::modes::parse_mode_among;

    #[test]
    fn own_figures_follow_the_others_by_their_numbers() {
        let own = ["lion", "hand-2"].map(String::from);
        assert_eq!(check_own_figure_names(&own), Ok(()));
        assert_eq!(parse_mode_among("hand-2", &own), Ok(own_figure_mode(1)));
        assert_eq!(parse_mode_among("owl", &own), parse_mode_among("owl", &[]));
        for place in 0..MAX_OWN_FIGURES {
            let mode = own_figure_mode(place);
            assert!(HiddenStart::ALL.into_iter().all(|start| start.mode() != mode));
        }
    }

    /// Compares the stone with every voxel's distance to each voxel of the figure, on the ground, at a side
    /// and in the middle.
    #[test]
    fn the_coat_is_what_is_near_the_figure() {
        let figure = [[20, 0, 31], [21, 0, 31], [40, 22, 30], [1, 30, 63]];
        let [mut bits, mut scratch] = [const { BitGrid::<64>::new() }; 2].map(Box::new);
        for [x, y, z] in figure {
            bits.row_mut(y, z).insert(x);
        }
        let mut stone = Box::new(RangeMaps::<64, INTERVALS>::new());
        write_coat_into(&bits, &mut stone, &mut scratch);
        let reach = coat_reach_subunits(64) as i64;
        let is_near = |at: [usize; 3]| {
            figure.into_iter().any(|voxel| {
                let square = |axis: usize| (at[axis] as i64 - voxel[axis] as i64).pow(2);
                (square(0) + square(1) + square(2)) * 256 * 256 <= reach * reach
            })
        };
        let voxels = (0..64 * 64 * 64).map(|i| [i % 64, i / 64 % 64, i / 4096]);
        for voxel in voxels {
            assert_eq!(scratch.contains(voxel), is_near(voxel), "{voxel:?}");
        }
        // Closure only adds voxels.
        bits.set_from_maps(&stone);
        assert!(bits.count_voxels() >= scratch.count_voxels());
        // 20 mm of 450 are 5.7 voxels of 128.
        assert_eq!((coat_margin(128), coat_margin(256)), (7, 13));
    }

    #[test]
    fn a_name_that_another_has_or_none_could_have_is_refused() {
        for (names, why) in [
            (&["owl"][..], "owl: there is one"),
            (&["lion", "lion"], "lion: there is one"),
            (&["cat-half"], "cat-half: there is one"),
            (&["own"], "own: there is one"),
            (&["Lion"], "Lion: no name"),
            (&["a/b"], "a/b: no name"),
            (&[""], ": no name"),
            (&["a\nb"], "a\\nb: no name"),
            (&["a"; 9], "9 figures, expected at most 8"),
        ] {
            let names: Vec<_> = names.iter().map(ToString::to_string).collect();
            let told = check_own_figure_names(&names).expect_err(why);
            assert!(told.starts_with(why), "{told}");
        }
        let long = [str::repeat("a", 33)];
        assert!(check_own_figure_names(&long).is_err());
    }
}
