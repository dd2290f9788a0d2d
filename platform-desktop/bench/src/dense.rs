//! The rival of `bench edit`: a grid of bytes, carved voxel by voxel, and the three range maps recomputed
//! from it in one pass, sixteen or more voxels at a time.

use std::ops::RangeInclusive;

use paros_core::RangeMaps;
use paros_core::volume::{Axis, Range};

/// N^3 voxels as bytes, 1 for occupied, in the order y, z, x; and the range maps computed from them.
pub struct DenseGrid {
    grid_side: usize,
    voxels: Vec<u8>,
    lo: [Vec<u8>; 3],
    hi: [Vec<u8>; 3],
    doomed: Vec<usize>,
}

impl DenseGrid {
    /// Creates the grid with the voxels of these maps.
    pub fn new<const N: usize>(maps: &RangeMaps<N>) -> Self {
        let mut voxels = vec![0; N * N * N];
        for (i, voxel) in voxels.iter_mut().enumerate() {
            *voxel = u8::from(maps.contains([i % N, i / N / N, i / N % N]));
        }
        let empty = || [vec![0; N * N], vec![0; N * N], vec![0; N * N]];
        let mut grid = DenseGrid { grid_side: N, voxels, lo: empty(), hi: empty(), doomed: vec![] };
        grid.recompute_maps();
        grid
    }

    /// Empties the voxels within `radius_voxels` of `centre_voxels` (a voxel's centre is at a
    /// half) that have an empty voxel within `shell_steps` six-neighbour steps, then recomputes the
    /// maps.
    pub fn carve_sphere(
        &mut self,
        centre_voxels: [f32; 3],
        radius_voxels: f32,
        shell_steps: usize,
    ) {
        let (grid_side, centre, radius) = (self.grid_side, centre_voxels, radius_voxels);
        self.doomed.clear();
        let first = |c: f32| (c - radius).floor().max(0.0) as usize;
        let last = |c: f32| ((c + radius).ceil().max(0.0) as usize).min(grid_side);
        for y in first(centre[1])..last(centre[1]) {
            let dy = y as f32 + 0.5 - centre[1];
            for z in first(centre[2])..last(centre[2]) {
                let dz = z as f32 + 0.5 - centre[2];
                for x in first(centre[0])..last(centre[0]) {
                    let dx = x as f32 + 0.5 - centre[0];
                    let i = (y * grid_side + z) * grid_side + x;
                    let inside = dx * dx + dy * dy + dz * dz <= radius * radius;
                    if inside && self.voxels[i] != 0 && self.is_near_empty([x, y, z], shell_steps) {
                        self.doomed.push(i);
                    }
                }
            }
        }
        for &i in &self.doomed {
            self.voxels[i] = 0;
        }
        self.recompute_maps();
    }

    /// Returns the range of a column of the recomputed maps.
    pub fn column_range(&self, axis: Axis, (line, place): (usize, usize)) -> Range {
        let i = line * self.grid_side + place;
        Range::new(self.lo[axis as usize][i].into(), self.hi[axis as usize][i].into())
    }

    /// Returns `true` if an empty voxel, or the outside of the grid, is within `steps` six-neighbour steps.
    fn is_near_empty(&self, [x, y, z]: [usize; 3], steps: usize) -> bool {
        let grid_side = self.grid_side;
        let edge = [x, y, z].iter().any(|&i| i < steps || i + steps >= grid_side);
        if edge {
            return true;
        }
        (y - steps..=y + steps).any(|j| {
            let left = steps - j.abs_diff(y);
            (z - left..=z + left).any(|k| {
                let left = left - k.abs_diff(z);
                let row = (j * grid_side + k) * grid_side + x;
                self.voxels[row - left..=row + left].contains(&0)
            })
        })
    }

    fn recompute_maps(&mut self) {
        let grid_side = self.grid_side;
        self.lo.iter_mut().for_each(|lo| lo.fill(u8::MAX));
        self.hi.iter_mut().for_each(|hi| hi.fill(0));
        let [lo_x, lo_y, lo_z] = &mut self.lo;
        let [hi_x, hi_y, hi_z] = &mut self.hi;
        for (y, layer) in self.voxels.chunks_exact(grid_side * grid_side).enumerate() {
            widen_columns(lo_y, hi_y, layer, y as u8);
            let line = y * grid_side..(y + 1) * grid_side;
            let (lo_z, hi_z) = (&mut lo_z[line.clone()], &mut hi_z[line]);
            for (z, row) in layer.chunks_exact(grid_side).enumerate() {
                widen_columns(lo_z, hi_z, row, z as u8);
                if let Some(ends) = occupied_ends(row) {
                    let i = y * grid_side + z;
                    (lo_x[i], hi_x[i]) = (*ends.start(), *ends.end());
                }
            }
        }
    }
}

/// Extends the columns' ranges by their occupied voxels at `coordinate`, along the columns' axis.
/// Branchless, for vector code.
#[inline]
fn widen_columns(lo: &mut [u8], hi: &mut [u8], voxels: &[u8], coordinate: u8) {
    for ((lo, hi), voxel) in lo.iter_mut().zip(hi).zip(voxels) {
        *lo = (*lo).min(coordinate | voxel.wrapping_sub(1));
        *hi = (*hi).max(coordinate & voxel.wrapping_neg());
    }
}

/// Returns the first and last occupied voxel of a row. Reads eight at a time.
#[inline]
fn occupied_ends(row: &[u8]) -> Option<RangeInclusive<u8>> {
    let (eights, _) = row.as_chunks::<8>();
    let first = eights.iter().position(|eight| u64::from_le_bytes(*eight) != 0)?;
    let last = eights.iter().rposition(|eight| u64::from_le_bytes(*eight) != 0)?;
    let lo = 8 * first + u64::from_le_bytes(eights[first]).trailing_zeros() as usize / 8;
    let hi = 8 * last + 7 - u64::from_le_bytes(eights[last]).leading_zeros() as usize / 8;
    Some(lo as u8..=hi as u8)
}
