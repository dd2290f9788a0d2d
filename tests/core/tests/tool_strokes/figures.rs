//! Measurements of a stroke.

use std::collections::BTreeSet;
use std::fmt;

use glam::Quat;
use paros_core::edit::Pose;
use paros_core::internals::{BitAction, BrushBounds, BrushPiece};
use paros_core::volume::{BitGrid, BitSet, Grid, Size};

/// Measurements of a stroke. Lengths are the maximum over all measured ticks, in millimetres.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub(crate) struct StrokeFigures {
    /// The bit's lag behind its hand, along the stone.
    pub(crate) behind: f32,
    /// The bit's height above its hand's place.
    pub(crate) above: f32,
    /// The bit's sideways distance from its hand's path.
    pub(crate) aside: f32,
    /// Number of measured ticks in which the bit stood.
    pub(crate) stood: u32,
    /// Number of voxels that the tool should change at the bit's place in the hand, and how many of them it
    /// left.
    pub(crate) asked: u32,
    pub(crate) left: u32,
    /// Number of changed voxels outside the bit's own path.
    pub(crate) stray: u32,
    /// Number of measured ticks in which nothing had changed at the hand's place.
    pub(crate) bare: u32,
    /// Number of connected parts of the changed voxels.
    pub(crate) parts: u32,
}

impl StrokeFigures {
    /// Adds a tick's lag.
    pub(crate) fn measure_lag(&mut self, frozen: &Pose, raw: &Pose, grip: Quat, voxel_mm: f32) {
        let to_surface = (raw.rotation * grip.inverse()).inverse();
        let lag = to_surface * (raw.position - frozen.position) * voxel_mm;
        self.behind = self.behind.max(-lag.z);
        self.above = self.above.max(-lag.y);
        self.aside = self.aside.max(lag.x.abs());
    }
}

impl fmt::Display for StrokeFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let StrokeFigures { behind, above, aside, stood, asked, left, stray, bare, parts } = self;
        write!(f, "behind {behind:.1} above {above:.1} aside {aside:.1} mm, stood {stood}; ")?;
        write!(f, "left {left} of {asked}, stray {stray}, bare {bare}, parts {parts}")
    }
}

/// The voxels changed by a stroke.
pub(crate) struct ChangedVoxels<const N: usize>
where
    Grid<N>: Size,
{
    pub(crate) before: BitGrid<N>,
    voxels: BitGrid<N>,
}

impl<const N: usize> ChangedVoxels<N>
where
    Grid<N>: Size,
{
    pub(crate) const fn new() -> Self {
        ChangedVoxels { before: BitGrid::new(), voxels: BitGrid::new() }
    }

    pub(crate) fn set_now(&mut self, now: &BitGrid<N>) {
        for (y, z) in rows::<N>() {
            let (before, after) = (self.before.row(y, z), now.row(y, z));
            *self.voxels.row_mut(y, z) = before & !after | after & !before;
        }
    }

    /// Counts the voxels that a stroke should change, and those it changed outside the bit's path.
    pub(crate) fn count(
        &self,
        action: BitAction,
        swept: &BitGrid<N>,
        asked: &BitGrid<N>,
        now: &BitGrid<N>,
        figures: &mut StrokeFigures,
    ) {
        for (y, z) in rows::<N>() {
            figures.stray += (self.voxels.row(y, z) & !swept.row(y, z)).count_ones();
            let asked = asked.row(y, z);
            if asked.is_empty() {
                continue;
            }
            let to_change = |grid: &BitGrid<N>| match action {
                BitAction::Carve => asked & grid.row(y, z),
                BitAction::Fill => asked & !grid.row(y, z),
                BitAction::Smooth | BitAction::Flatten => asked & odd_ones(grid, (y, z)),
            };
            figures.asked += to_change(&self.before).count_ones();
            figures.left += to_change(now).count_ones();
        }
    }

    /// Returns `true` if a piece contains a changed voxel.
    pub(crate) fn overlaps(&self, piece: &BrushPiece) -> bool {
        let Some(BrushBounds { lo, hi }) = piece.bounds(N) else {
            return false;
        };
        let mut rows = (lo[1]..=hi[1]).flat_map(|y| (lo[2]..=hi[2]).map(move |z| (y, z)));
        rows.any(|(y, z)| {
            let row = self.voxels.row(y, z);
            let range = (!row.is_empty()).then(|| piece.x_range(y, z, N)).flatten();
            range.is_some_and(|range| !(row & range.to_row()).is_empty())
        })
    }

    /// Counts the parts that are connected by faces.
    pub(crate) fn count_parts(&self) -> u32 {
        let voxels = rows::<N>()
            .flat_map(|(y, z)| self.voxels.row(y, z).iter_ones().map(move |x| [x, y, z]));
        let mut left: BTreeSet<[usize; 3]> = voxels.collect();
        let mut parts = 0;
        while let Some(first) = left.pop_first() {
            parts += 1;
            let mut todo = vec![first];
            while let Some(voxel) = todo.pop() {
                for axis in 0..3 {
                    for i in [voxel[axis] + 1, voxel[axis].wrapping_sub(1)] {
                        let mut beside = voxel;
                        beside[axis] = i;
                        todo.extend(left.take(&beside));
                    }
                }
            }
        }
        parts
    }
}

fn rows<const N: usize>() -> impl Iterator<Item = (usize, usize)> {
    (0..N * N).map(|i| (i / N, i % N))
}

/// Returns the voxels of a row that differ from the majority of their 3 x 3 x 3 neighbourhood: bumps, pits
/// and corners.
fn odd_ones<const N: usize>(grid: &BitGrid<N>, (y, z): (usize, usize)) -> <Grid<N> as Size>::Row
where
    Grid<N>: Size,
{
    let mut odd = <Grid<N> as Size>::Row::EMPTY;
    let near: [_; 9] = std::array::from_fn(|i| grid.row(y + i / 3 - 1, z + i % 3 - 1));
    for x in 1..N - 1 {
        let count =
            |row: &<Grid<N> as Size>::Row| (x - 1..x + 2).filter(|&i| row.contains(i)).count();
        let occupied: usize = near.iter().map(count).sum();
        odd.insert_if((occupied > 13) != near[4].contains(x), x);
    }
    odd
}
