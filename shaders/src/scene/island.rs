//! Where a removed island was: a coarse copy of the volume, kept up with what is dirty.

use glam::Vec3;
use paros_core::maps::Axis;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::world::World;

use crate::limits::{ISLAND_MOTES, LATTICE};

/// Every so-many-th voxel: bit x of row (y, z).
#[derive(Debug)]
pub(super) struct Lattice {
    rows: [[u32; LATTICE]; LATTICE],
    /// What the last look found gone.
    gone: [[u32; LATTICE]; LATTICE],
}

impl Lattice {
    pub(super) const fn new() -> Self {
        Lattice { rows: [[0; LATTICE]; LATTICE], gone: [[0; LATTICE]; LATTICE] }
    }

    /// Looks at the rows that the last tick changed.
    pub(super) fn follow<const N: usize>(&mut self, world: &World<N>)
    where
        Grid<N>: Size,
    {
        self.gone = [[0; LATTICE]; LATTICE];
        let step = N.div_ceil(LATTICE);
        let volume = world.volume().rows();
        for rect in world.dirty().rects(Axis::X) {
            for y in sampled(rect.lo.0, rect.hi.0, step) {
                for z in sampled(rect.lo.1, rect.hi.1, step) {
                    let row = volume.row(y * step + step / 2, z * step + step / 2);
                    let mut now = 0u32;
                    for x in 0..N / step {
                        now |= u32::from(row.contains(x * step + step / 2)) << x;
                    }
                    let old = core::mem::replace(&mut self.rows[y][z], now);
                    self.gone[y][z] |= old & !now;
                }
            }
        }
    }

    /// The places, in voxels, of what went in the last tick; every few only, where it was large.
    pub(super) fn gone(&self, n: usize, mut each: impl FnMut(Vec3)) {
        let step = n.div_ceil(LATTICE);
        let total: u32 = self.gone.iter().flatten().map(|row| row.count_ones()).sum();
        let stride = (total as usize).div_ceil(ISLAND_MOTES).max(1);
        let mut count = 0;
        for (y, line) in self.gone.iter().enumerate() {
            for (z, row) in line.iter().enumerate() {
                for x in (0..LATTICE).filter(|x| row >> x & 1 != 0) {
                    if count % stride == 0 {
                        let at = [x, y, z].map(|i| (i * step + step / 2) as f32 + 0.5);
                        each(Vec3::from_array(at));
                    }
                    count += 1;
                }
            }
        }
    }
}

/// The samples between two places.
fn sampled(lo: u8, hi: u8, step: usize) -> impl Iterator<Item = usize> {
    let first = (usize::from(lo) + step - 1).saturating_sub(step / 2) / step;
    let end = (usize::from(hi) + step - step / 2) / step;
    first..end.min(LATTICE)
}
