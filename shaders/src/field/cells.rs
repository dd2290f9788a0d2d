//! Chebyshev distance transform for empty-space skipping: for each cell of texels, the distance to
//! the nearest cell that the surface of half density may pass through.

use super::extent::TexelBox;
use super::sizes::MAX_CELL_DISTANCE;
use super::texels::{TexelCube, gather_top_bits};

/// The most cells in a row: half of the 136 texels of a side at 128.
const MAX_CELLS: usize = 68;

/// The most unchanged cells in a joined box: uploading them costs less than a further box.
const JOIN_SLACK: usize = 256;

/// The number of bit grids: one for each distance less than [`MAX_CELL_DISTANCE`].
const DISTANCES: usize = MAX_CELL_DISTANCE as usize;

/// Distance transform by repeated dilation of bit rows.
///
/// The cells at most k + 1 from the surface are those at most k from it, dilated by one: shifts and
/// ORs of rows of bits. [`CellDistances::update_distances`] dilates only rows beside one that
/// changed.
#[derive(Debug)]
pub(super) struct CellDistances {
    /// Texels along a side of a cell.
    cell_side_texels: usize,
    /// By distance k, the cells at most k from the surface: bit rows along x, by z and y.
    near: [Vec<u128>; DISTANCES],
    /// By distance, the rows that changed since the last update: bit rows along y, by z.
    touched: [Vec<u128>; DISTANCES],
    /// The cells that changed at any distance: bit rows along x, by z and y.
    flipped: Vec<u128>,
    /// Texels of the last slices that are at least a half: bit rows along x, by y and z, a ring
    /// buffer.
    halves: Vec<[u64; KEPT_SLICES]>,
    free: TexelCube,
    /// By z, the box of the cells that changed since they were drained.
    changed: Vec<TexelBox>,
}

impl CellDistances {
    /// Creates cells of `cell_side_texels` texels a side, all empty, for a density of `density_side` texels
    /// a side.
    pub(super) fn new(density_side: usize, cell_side_texels: usize) -> Self {
        let side = density_side / cell_side_texels;
        CellDistances {
            cell_side_texels,
            near: [0; DISTANCES].map(|_| vec![0; side * side]),
            touched: [0; DISTANCES].map(|_| vec![0; side]),
            flipped: vec![0; side * side],
            halves: vec![[0; KEPT_SLICES]; density_side],
            free: TexelCube::new(side, MAX_CELL_DISTANCE - 1),
            changed: vec![TexelBox::NONE; side],
        }
    }

    /// Returns the distance of each cell to the nearest one with surface, less one: 0 to
    /// [`MAX_CELL_DISTANCE`] - 1.
    pub(super) const fn free_cells_around_each(&self) -> &TexelCube {
        &self.free
    }

    /// Recomputes which of the cells that hold or touch texels of a box have surface.
    pub(super) fn rescan_surface(&mut self, density: &TexelCube, extent: TexelBox) {
        let cells = extent.grown_by(1, density.side()).coarser_by(self.cell_side_texels);
        // As many cells as fit in a word, with one texel more on either side.
        let step = (u64::BITS as usize - 2) / self.cell_side_texels;
        for first in (cells.lo[0]..cells.hi[0]).step_by(step) {
            let end = cells.hi[0].min(first + step);
            let (cell_ys, mut halves_end_z) = (cells.lo[1]..cells.hi[1], 0);
            for cell_z in cells.lo[2]..cells.hi[2] {
                let ys = cell_ys.clone();
                self.rescan_slice(density, &mut halves_end_z, first..end, ys, cell_z);
            }
        }
    }

    /// Recomputes which cells of a slice have surface; `cell_xs` must fit in a word. Slices of texels
    /// before `halves_end_z` are in the ring buffer already.
    fn rescan_slice(
        &mut self,
        density: &TexelCube,
        halves_end_z: &mut usize,
        cell_xs: std::ops::Range<usize>,
        cell_ys: std::ops::Range<usize>,
        cell_z: usize,
    ) {
        let (size, texels, side) = (self.cell_side_texels, density.side(), self.free.side());
        let beside =
            |lo: usize, hi: usize| (lo * size).saturating_sub(1)..(hi * size + 1).min(texels);
        let (xs, ys) = (beside(cell_xs.start, cell_xs.end), beside(cell_ys.start, cell_ys.end));
        // Rounded up to whole words, which is faster.
        let xs = xs.start..texels.min(xs.start + xs.len().next_multiple_of(8));
        // The first bit is the texel before the first cell.
        let shift = usize::from(cell_xs.start == 0);
        let zs = beside(cell_z, cell_z + 1);
        for z in zs.start.max(*halves_end_z)..zs.end {
            for y in ys.clone() {
                self.halves[y][z % KEPT_SLICES] =
                    gather_top_bits(&density.row(y, z)[xs.clone()]) << shift;
            }
        }
        *halves_end_z = zs.end;
        let scanned = u128::MAX >> (128 - cell_xs.len()) << cell_xs.start;
        for y in cell_ys {
            let rows = &self.halves[beside(y, y + 1)];
            let any = rows.iter().fold(0, |any, slices| {
                zs.clone().fold(any, |any, z| any | slices[z % KEPT_SLICES])
            });
            let bits = u128::from(cells_with_any_bit(any, size)) << cell_xs.start;
            let row = &mut self.near[0][cell_z * side + y];
            let flipped = (*row ^ bits) & scanned;
            if flipped != 0 {
                *row ^= flipped;
                self.touched[0][cell_z] |= 1 << y;
            }
        }
    }

    /// Updates the distances around the cells that gained or lost surface since the last call.
    pub(super) fn update_distances(&mut self) {
        let is_touched = |rows: &u128| *rows != 0;
        let Some(first) = self.touched[0].iter().position(is_touched) else { return };
        let last = self.touched[0].iter().rposition(is_touched).unwrap_or(first);
        let side = self.free.side();
        let reach = |by: usize| first.saturating_sub(by)..(last + 1 + by).min(side);
        for distance in 1..DISTANCES {
            for z in reach(distance) {
                let touched = &self.touched[distance - 1];
                let around = &touched[z.saturating_sub(1)..(z + 2).min(side)];
                let rows = around.iter().fold(0, |all, rows| all | rows);
                if rows != 0 {
                    let rows = (rows | rows << 1 | rows >> 1) & low_bits(side);
                    self.dilate_rows(distance, z, rows);
                }
            }
        }
        for z in reach(DISTANCES) {
            let mut rows = 0;
            for touched in &mut self.touched[1..] {
                rows |= std::mem::take(&mut touched[z]);
            }
            self.touched[0][z] = 0;
            for y in bit_positions(rows) {
                self.write_distances_row(y, z);
            }
        }
    }

    /// Dilates the rows of a slice that are set in `row_bits`, from the bit grid of the next smaller
    /// distance.
    fn dilate_rows(&mut self, distance: usize, z: usize, row_bits: u128) {
        let side = self.free.side();
        let (nearer, here) = self.near.split_at_mut(distance);
        let slice = |z: usize| &nearer[distance - 1][z * side..(z + 1) * side];
        let (before, this, behind) =
            (slice(z.saturating_sub(1)), slice(z), slice((z + 1).min(side - 1)));
        let first = row_bits.trailing_zeros() as usize;
        let last = 127 - row_bits.leading_zeros() as usize;
        // One more at either end.
        let mut column = [0u128; MAX_CELLS + 2];
        for y in first.saturating_sub(1)..(last + 2).min(side) {
            column[y + 1] = before[y] | this[y] | behind[y];
        }
        let mut touched = 0;
        for y in bit_positions(row_bits) {
            let all = column[y] | column[y + 1] | column[y + 2];
            let grown = (all | all << 1 | all >> 1) & low_bits(side);
            let row = &mut here[0][z * side + y];
            if *row != grown {
                self.flipped[z * side + y] |= *row ^ grown;
                *row = grown;
                touched |= 1 << y;
            }
        }
        self.touched[distance][z] = touched;
    }

    /// Recomputes the distances of a row's changed cells from the bit rows.
    fn write_distances_row(&mut self, y: usize, z: usize) {
        let i = z * self.free.side() + y;
        let flipped = std::mem::take(&mut self.flipped[i]);
        let (lo, hi) = (flipped.trailing_zeros() as usize, 128 - flipped.leading_zeros() as usize);
        // The distance less one is the count of k from 1 to 6 with no surface within k. Its three bits:
        let near = |k: usize| self.near[k][i];
        let ones = near(2) & !near(1) | near(4) & !near(3) | near(6) & !near(5);
        let twos = near(4) & !near(2) | !near(6);
        let fours = !near(4);
        let row = self.free.row_mut(y, z);
        for (group, bytes) in row.chunks_mut(8).enumerate().take(hi.div_ceil(8)).skip(lo / 8) {
            let spread = |bits: u128| SPREAD[(bits >> (8 * group) & 255) as usize];
            let counts = spread(ones) | spread(twos) << 1 | spread(fours) << 2;
            match bytes.first_chunk_mut::<8>() {
                Some(bytes) => *bytes = counts.to_le_bytes(),
                None => bytes.copy_from_slice(&counts.to_le_bytes()[..bytes.len()]),
            }
        }
        let part = TexelBox { lo: [lo, y, z], hi: [hi, y + 1, z + 1] };
        self.changed[z] = self.changed[z].union(&part);
    }

    /// Passes to `sink` each box of cells that changed since the last call, and all distances.
    pub(super) fn drain_changed_boxes(&mut self, mut sink: impl FnMut(&TexelCube, TexelBox)) {
        let mut open = TexelBox::NONE;
        for slice in &mut self.changed {
            let slice = std::mem::replace(slice, TexelBox::NONE);
            let both = open.union(&slice);
            // Slices are joined while their hull is little larger than both.
            if both.volume() > open.volume() + slice.volume() + JOIN_SLACK {
                sink(&self.free, open);
                open = slice;
            } else {
                open = both;
            }
        }
        if !open.is_empty() {
            sink(&self.free, open);
        }
    }
}

/// Slices of texels kept: at least a cell's and one on either side.
const KEPT_SLICES: usize = 8;

const _: () = assert!(DISTANCES == 7, "`write_distances_row` counts to 6");

const fn low_bits(count: usize) -> u128 {
    u128::MAX >> (128 - count)
}

/// Returns the positions of the set bits, ascending.
fn bit_positions(mut bits: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            bit
        })
    })
}

/// Returns a bit for each cell: set if any of its texels, or a texel beside them, has its bit set. The
/// lowest bit of `texel_bits` is the texel before the first cell. Cells have 2 texels or 4.
const fn cells_with_any_bit(texel_bits: u64, cell_side_texels: usize) -> u64 {
    let mut any = texel_bits | texel_bits >> 1;
    any |= any >> 2;
    if cell_side_texels == 2 {
        return compact_even_bits(any);
    }
    any |= any >> 2;
    compact_even_bits(compact_even_bits(any))
}

/// Compacts the even bits into the lower half (the inverse of Morton spreading).
const fn compact_even_bits(bits: u64) -> u64 {
    let bits = bits & 0x5555_5555_5555_5555;
    let bits = (bits | bits >> 1) & 0x3333_3333_3333_3333;
    let bits = (bits | bits >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    let bits = (bits | bits >> 4) & 0x00ff_00ff_00ff_00ff;
    let bits = (bits | bits >> 8) & 0x0000_ffff_0000_ffff;
    (bits | bits >> 16) & 0xffff_ffff
}

/// A table that spreads eight bits to a byte each.
static SPREAD: [u64; 256] = {
    let mut table = [0; 256];
    let mut bits = 0;
    while bits < 256 {
        let mut bit = 0;
        while bit < 8 {
            table[bits] |= (bits as u64 >> bit & 1) << (8 * bit);
            bit += 1;
        }
        bits += 1;
    }
    table
};
