//! The roughness of a worked patch of a surface: the variation of its height relative to its neighbourhood.

use paros_core::internals::BOX_SIDE;
use paros_core::volume::{BitGrid, BitSet, Grid, Size};

/// The reach of a voxel's neighbourhood, in millimetres.
const REACH_MM: f32 = 10.6;

/// The distance from changed voxels to which the patch reaches, in voxels.
const RIM: usize = 2;

/// The root mean square of a patch's height relative to its neighbourhood, in millimetres.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Roughness {
    /// Before the work.
    pub before_mm: f32,
    /// After it.
    pub after_mm: f32,
}

/// Returns the roughness of the patch that was changed from `before` to `after`; `None` if nothing changed.
#[must_use]
pub fn measure_roughness<const N: usize>(
    before: &BitGrid<N>,
    after: &BitGrid<N>,
) -> Option<Roughness>
where
    Grid<N>: Size,
{
    let is_changed = |y: usize, z: usize| before.row(y, z) ^ after.row(y, z);
    // The voxels of a row that are near a changed one.
    let near_changed = |y: usize, z: usize| {
        let near = |i: usize| i.saturating_sub(RIM)..(i + RIM + 1).min(N);
        let rows = near(y).flat_map(|y| near(z).map(move |z| (y, z)));
        let row = rows.fold(<Grid<N> as Size>::Row::EMPTY, |all, (y, z)| all | is_changed(y, z));
        (0..RIM).fold(row, |row, _| row | row.shifted_up() | row.shifted_down())
    };
    let [mut heights_before, mut heights_after] = [Vec::new(), Vec::new()];
    for (y, z) in (0..N * N).map(|i| (i / N, i % N)) {
        let patch = near_changed(y, z);
        if patch.is_empty() {
            continue;
        }
        for (stone, heights) in [(before, &mut heights_before), (after, &mut heights_after)] {
            let surface = patch & surface_of_row(stone, (y, z));
            heights.extend(surface.iter_ones().map(|x| height_mm(stone, [x, y, z])));
        }
    }
    let [before_mm, after_mm] = [heights_before, heights_after].map(|all| deviation(&all));
    Some(Roughness { before_mm: before_mm?, after_mm: after_mm? })
}

/// Returns the occupied voxels of a row that have an empty neighbour. Below the ground nothing counts as
/// empty.
fn surface_of_row<const N: usize>(
    stone: &BitGrid<N>,
    (y, z): (usize, usize),
) -> <Grid<N> as Size>::Row
where
    Grid<N>: Size,
{
    type Row<const N: usize> = <Grid<N> as Size>::Row;
    let at = |y: usize, z: usize| if y < N && z < N { stone.row(y, z) } else { Row::<N>::EMPTY };
    let here = stone.row(y, z);
    let below = if y == 0 { !Row::<N>::EMPTY } else { at(y - 1, z) };
    let inner = here.shifted_up() & here.shifted_down() & at(y + 1, z) & below;
    here & !(inner & at(y, z.wrapping_sub(1)) & at(y, z + 1))
}

/// Returns the height of a surface voxel above the mean of the surface around it, from how much less stone
/// its cube contains than that of a voxel in a flat face.
fn height_mm<const N: usize>(stone: &BitGrid<N>, [x, y, z]: [usize; 3]) -> f32
where
    Grid<N>: Size,
{
    let voxel_mm = BOX_SIDE * 1e3 / N as f32;
    let reach = (REACH_MM / voxel_mm).round() as usize;
    let side = 2 * reach + 1;
    let within: <Grid<N> as Size>::Row =
        BitSet::span(x.saturating_sub(reach), (x + reach).min(N - 1));
    let near = |i: usize| i.saturating_sub(reach)..(i + reach + 1).min(N);
    let ground = reach.saturating_sub(y) * side * side;
    let rows = near(y).flat_map(|y| near(z).map(move |z| (y, z)));
    let count: usize =
        rows.map(|(y, z)| (stone.row(y, z) & within).count_ones() as usize).sum::<usize>() + ground;
    ((side + 1) as f32 / 2.0 - count as f32 / (side * side) as f32) * voxel_mm
}

/// Returns the root mean square deviation from the mean; `None` without values.
fn deviation(values: &[f32]) -> Option<f32> {
    let count = values.len() as f32;
    let mean = values.iter().sum::<f32>() / count;
    let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / count;
    (!values.is_empty()).then(|| variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stone(height: impl Fn(f32, f32) -> f32) -> Box<BitGrid<64>> {
        let mut bits: Box<BitGrid<64>> = Box::new(BitGrid::new());
        for (y, z) in (0..64 * 64).map(|i| (i / 64, i % 64)) {
            let row = bits.row_mut(y, z);
            (0..64)
                .filter(|&x| (y as f32) < height(x as f32, z as f32))
                .for_each(|x| row.insert(x));
        }
        bits
    }

    #[test]
    fn what_ripples_is_rough_and_what_is_flat_is_not() {
        // Keeps away from the block's own edges.
        let is_worked = |x: f32, z: f32| [x, z].iter().all(|at| (16.0..48.0).contains(at));
        let ripple = |x: f32, z: f32| 1.6 * (x * 0.9).sin() * (z * 0.9).sin();
        let rippled = stone(|x, z| 30.0 + if is_worked(x, z) { ripple(x, z) } else { 0.0 });
        let flat = stone(|_, _| 30.0);
        let rough = measure_roughness(&rippled, &flat).expect("it was changed");
        assert!(rough.before_mm > 1.5, "{rough:?}");
        assert_eq!(rough.after_mm, 0.0);
        assert_eq!(measure_roughness(&flat, &flat), None, "nothing was changed");
    }
}
