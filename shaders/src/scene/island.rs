//! Positions of removed islands: a subsampled copy of the volume, updated in its dirty rectangles.

use glam::Vec3;
use paros_core::World;
use paros_core::volume::{Axis, BitSet, Grid, Size};

use crate::limits::{ISLAND_MOTES, LATTICE};

/// A subsampled bit grid: bit x of row (y, z).
#[derive(Debug)]
pub(super) struct IslandLattice {
    rows: [[u32; LATTICE]; LATTICE],
    /// Samples cleared by the last update.
    removed: [[u32; LATTICE]; LATTICE],
}

impl IslandLattice {
    pub(super) const fn new() -> Self {
        IslandLattice { rows: [[0; LATTICE]; LATTICE], removed: [[0; LATTICE]; LATTICE] }
    }

    /// Updates the rows that the last tick changed.
    pub(super) fn follow_tick<const N: usize, const K: usize>(&mut self, world: &World<N, K>)
    where
        Grid<N>: Size,
    {
        self.removed = [[0; LATTICE]; LATTICE];
        let step = N.div_ceil(LATTICE);
        let volume = world.volume().rows();
        for rect in world.dirty_rects().rects(Axis::X) {
            for y in centred_sample_indices_between(rect.first.0, rect.last.0, step) {
                for z in centred_sample_indices_between(rect.first.1, rect.last.1, step) {
                    let row = volume.row(y * step + step / 2, z * step + step / 2);
                    let mut now = 0u32;
                    for x in 0..N / step {
                        now |= u32::from(row.contains(x * step + step / 2)) << x;
                    }
                    let old = core::mem::replace(&mut self.rows[y][z], now);
                    self.removed[y][z] |= old & !now;
                }
            }
        }
    }

    /// Returns `true` if the sample nearest to a point, in voxels of the grid, is occupied.
    pub(super) fn holds(&self, grid_side: usize, point: Vec3) -> bool {
        let step = grid_side.div_ceil(LATTICE) as f32;
        let at = (point / step).floor();
        let is_in = at.cmpge(Vec3::ZERO).all() && at.cmplt(Vec3::splat(LATTICE as f32)).all();
        let [x, y, z] = at.to_array().map(|c| c as usize);
        is_in && self.rows[y][z] >> x & 1 != 0
    }

    /// Calls `visit_grid_point` with the positions, in voxels, of samples that the last tick removed and
    /// that have a neighbour which it didn't remove: the surface of what was removed. Visits at most `most`
    /// samples. Returns the width, in voxels, at which the visited samples cover that surface.
    pub(super) fn for_removed_outer_samples(
        &self,
        grid_side: usize,
        most: usize,
        mut visit_grid_point: impl FnMut(Vec3),
    ) -> f32 {
        let step = grid_side.div_ceil(LATTICE);
        let row = |y: usize, z: usize| {
            if y < LATTICE && z < LATTICE { self.removed[y][z] } else { 0 }
        };
        let outer = |y: usize, z: usize| {
            let around = row(y.wrapping_sub(1), z)
                & row(y + 1, z)
                & row(y, z.wrapping_sub(1))
                & row(y, z + 1);
            let here = self.removed[y][z];
            here & !(around & here << 1 & here >> 1)
        };
        let places = (0..LATTICE).flat_map(|y| (0..LATTICE).map(move |z| (y, z)));
        let total: u32 = places.clone().map(|(y, z)| outer(y, z).count_ones()).sum();
        let stride = (total as usize).div_ceil(most).max(1);
        let mut count = 0;
        for (y, z) in places {
            let outer = outer(y, z);
            for x in (0..LATTICE).filter(|x| outer >> x & 1 != 0) {
                if count % stride == 0 {
                    let at = [x, y, z].map(|i| (i * step + step / 2) as f32 + 0.5);
                    visit_grid_point(Vec3::from_array(at));
                }
                count += 1;
            }
        }
        // The fewer the samples, the more surface each covers.
        step as f32 * (stride as f32).sqrt()
    }

    /// Calls `visit_grid_point` with the positions, in voxels, of samples that the last tick removed,
    /// at most [`ISLAND_MOTES`] of them; `grid_side` is in voxels.
    pub(super) fn for_some_removed_samples(
        &self,
        grid_side: usize,
        mut visit_grid_point: impl FnMut(Vec3),
    ) {
        let step = grid_side.div_ceil(LATTICE);
        let total: u32 = self.removed.iter().flatten().map(|row| row.count_ones()).sum();
        let stride = (total as usize).div_ceil(ISLAND_MOTES).max(1);
        let mut count = 0;
        for (y, line) in self.removed.iter().enumerate() {
            for (z, row) in line.iter().enumerate() {
                for x in (0..LATTICE).filter(|x| row >> x & 1 != 0) {
                    if count % stride == 0 {
                        let at = [x, y, z].map(|i| (i * step + step / 2) as f32 + 0.5);
                        visit_grid_point(Vec3::from_array(at));
                    }
                    count += 1;
                }
            }
        }
    }
}

/// Returns the indices of the samples, one for every `sample_step` voxels, from the first voxel to the
/// last.
fn centred_sample_indices_between(
    first_voxel: u8,
    last_voxel: u8,
    sample_step: usize,
) -> impl Iterator<Item = usize> {
    let step = sample_step;
    let first = (usize::from(first_voxel) + step - 1).saturating_sub(step / 2) / step;
    let end = (usize::from(last_voxel) + step - step / 2) / step;
    first..end.min(LATTICE)
}
