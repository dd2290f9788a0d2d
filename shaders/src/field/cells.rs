//! Cells of texels: which the surface of half density may pass through, and how many around the
//! rest are free of it.

use super::FAR;
use super::extent::Extent;
use super::texels::{Texels, tops};

/// The longest row of cells: 136 texels at 128.
const MOST: usize = 68;

/// Cells told for nothing that are cheaper than another box.
const SLACK: usize = 256;

/// Distances less than [`FAR`], and cells at most so far from the surface.
const LEVELS: usize = FAR as usize;

/// Cells, and how many around each are free.
///
/// The cells at most k + 1 from the surface are those at most k from it and their neighbours: rows
/// of bits, moved and joined. Only rows beside one that changed are joined again, so that all is
/// right after each [`Cells::measure`], at the cost of what changed.
#[derive(Debug)]
pub(super) struct Cells {
    /// Texels along a side of a cell.
    cell: usize,
    /// By distance, the cells at most so far from the surface: a bit each along x, by z and y.
    near: [Vec<u128>; LEVELS],
    /// By distance, the rows of those that changed since they were measured: a bit each along y,
    /// by z.
    touched: [Vec<u128>; LEVELS],
    /// The cells that changed at any distance: a bit each along x, by z and y.
    flipped: Vec<u128>,
    /// Which texels of the last few slices looked at are at least a half: by z, wrapping, and y.
    halves: Vec<[u64; SLICES]>,
    free: Texels,
    /// In each slice of equal z the cells that changed since they were taken.
    changed: Vec<Extent>,
}

impl Cells {
    /// Cells of `cell` texels a side, none with surface, for `texels` a side.
    pub(super) fn new(texels: usize, cell: usize) -> Self {
        let side = texels / cell;
        Cells {
            cell,
            near: [0; LEVELS].map(|_| vec![0; side * side]),
            touched: [0; LEVELS].map(|_| vec![0; side]),
            flipped: vec![0; side * side],
            halves: vec![[0; SLICES]; texels],
            free: Texels::new(side, FAR - 1),
            changed: vec![Extent::NONE; side],
        }
    }

    /// How many cells around each are free.
    pub(super) const fn free(&self) -> &Texels {
        &self.free
    }

    /// Looks again at the cells that texels of a box belong to or lie beside.
    pub(super) fn follow(&mut self, density: &Texels, texels: Extent) {
        let cells = texels.grown(1, density.side()).coarser(self.cell);
        // As many as a word holds with a texel beside on either side.
        let step = (u64::BITS as usize - 2) / self.cell;
        for first in (cells.lo[0]..cells.hi[0]).step_by(step) {
            let end = cells.hi[0].min(first + step);
            let mut seen = 0;
            for z in cells.lo[2]..cells.hi[2] {
                self.follow_slice(density, (z, &mut seen), cells.lo[1]..cells.hi[1], first..end);
            }
        }
    }

    /// Looks again at the cells of a slice, no more along x than fit in a word. Slices of texels
    /// before `seen` have been looked at.
    fn follow_slice(
        &mut self,
        density: &Texels,
        (z, seen): (usize, &mut usize),
        along_y: std::ops::Range<usize>,
        along_x: std::ops::Range<usize>,
    ) {
        let (size, texels, side) = (self.cell, density.side(), self.free.side());
        let beside =
            |lo: usize, hi: usize| (lo * size).saturating_sub(1)..(hi * size + 1).min(texels);
        let (xs, ys) = (beside(along_x.start, along_x.end), beside(along_y.start, along_y.end));
        // A few more don't matter, whole words are quicker.
        let xs = xs.start..texels.min(xs.start + xs.len().next_multiple_of(8));
        // The first bit is the texel before the first cell.
        let shift = usize::from(along_x.start == 0);
        let zs = beside(z, z + 1);
        for z in zs.start.max(*seen)..zs.end {
            for y in ys.clone() {
                self.halves[y][z % SLICES] = tops(&density.row(y, z)[xs.clone()]) << shift;
            }
        }
        *seen = zs.end;
        let stretch = u128::MAX >> (128 - along_x.len()) << along_x.start;
        for y in along_y {
            let rows = &self.halves[beside(y, y + 1)];
            let any = rows
                .iter()
                .fold(0, |any, slices| zs.clone().fold(any, |any, z| any | slices[z % SLICES]));
            let bits = u128::from(cell_bits(any, size)) << along_x.start;
            let row = &mut self.near[0][z * side + y];
            let flipped = (*row ^ bits) & stretch;
            if flipped != 0 {
                *row ^= flipped;
                self.touched[0][z] |= 1 << y;
            }
        }
    }

    /// Follows the cells that the surface came to or left since the last time.
    pub(super) fn measure(&mut self) {
        let is_touched = |rows: &u128| *rows != 0;
        let Some(first) = self.touched[0].iter().position(is_touched) else { return };
        let last = self.touched[0].iter().rposition(is_touched).unwrap_or(first);
        let side = self.free.side();
        let reach = |by: usize| first.saturating_sub(by)..(last + 1 + by).min(side);
        for level in 1..LEVELS {
            for z in reach(level) {
                let touched = &self.touched[level - 1];
                let around = &touched[z.saturating_sub(1)..(z + 2).min(side)];
                let rows = around.iter().fold(0, |all, rows| all | rows);
                if rows != 0 {
                    self.grow(level, z, (rows | rows << 1 | rows >> 1) & ones(side));
                }
            }
        }
        for z in reach(LEVELS) {
            let mut rows = 0;
            for touched in &mut self.touched[1..] {
                rows |= std::mem::take(&mut touched[z]);
            }
            self.touched[0][z] = 0;
            for y in bits_of(rows) {
                self.tell_row(y, z);
            }
        }
    }

    /// Joins rows of a slice anew from those a cell nearer.
    fn grow(&mut self, level: usize, z: usize, rows: u128) {
        let side = self.free.side();
        let (nearer, here) = self.near.split_at_mut(level);
        let slice = |z: usize| &nearer[level - 1][z * side..(z + 1) * side];
        let (before, this, behind) =
            (slice(z.saturating_sub(1)), slice(z), slice((z + 1).min(side - 1)));
        let (first, last) = (rows.trailing_zeros() as usize, 127 - rows.leading_zeros() as usize);
        // One more at either end.
        let mut column = [0u128; MOST + 2];
        for y in first.saturating_sub(1)..(last + 2).min(side) {
            column[y + 1] = before[y] | this[y] | behind[y];
        }
        let mut touched = 0;
        for y in bits_of(rows) {
            let all = column[y] | column[y + 1] | column[y + 2];
            let grown = (all | all << 1 | all >> 1) & ones(side);
            let row = &mut here[0][z * side + y];
            if *row != grown {
                self.flipped[z * side + y] |= *row ^ grown;
                *row = grown;
                touched |= 1 << y;
            }
        }
        self.touched[level][z] = touched;
    }

    /// Counts for a row's cells that changed how many around them are free.
    fn tell_row(&mut self, y: usize, z: usize) {
        let i = z * self.free.side() + y;
        let flipped = std::mem::take(&mut self.flipped[i]);
        let (lo, hi) = (flipped.trailing_zeros() as usize, 128 - flipped.leading_zeros() as usize);
        // A cell has k free around it if it is further than k, k from 1 to 6: bits of that count.
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
        let part = Extent { lo: [lo, y, z], hi: [hi, y + 1, z + 1] };
        self.changed[z] = self.changed[z].union(&part);
    }

    /// Tells the boxes of cells that changed, and forgets them.
    pub(super) fn take_changed(&mut self, mut tell: impl FnMut(&Texels, Extent)) {
        let mut open = Extent::NONE;
        for slice in &mut self.changed {
            let slice = std::mem::replace(slice, Extent::NONE);
            let both = open.union(&slice);
            // Slices go together while that takes little more than each by itself.
            if both.volume() > open.volume() + slice.volume() + SLACK {
                tell(&self.free, open);
                open = slice;
            } else {
                open = both;
            }
        }
        if !open.is_empty() {
            tell(&self.free, open);
        }
    }
}

/// Slices of texels kept: at least those of a cell and beside it.
const SLICES: usize = 8;

const _: () = assert!(LEVELS == 7, "`tell_row` counts to 6");

const fn ones(bits: usize) -> u128 {
    u128::MAX >> (128 - bits)
}

/// The places of the bits, least first.
fn bits_of(mut bits: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            bit
        })
    })
}

/// A bit for each cell, from those of its texels and the ones beside; the lowest is the texel before
/// the first cell. Cells of 2 texels, or of 4.
const fn cell_bits(texels: u64, size: usize) -> u64 {
    let mut any = texels | texels >> 1;
    any |= any >> 2;
    if size == 2 {
        return every_other(any);
    }
    any |= any >> 2;
    every_other(every_other(any))
}

/// The even bits, moved together.
const fn every_other(bits: u64) -> u64 {
    let bits = bits & 0x5555_5555_5555_5555;
    let bits = (bits | bits >> 1) & 0x3333_3333_3333_3333;
    let bits = (bits | bits >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    let bits = (bits | bits >> 4) & 0x00ff_00ff_00ff_00ff;
    let bits = (bits | bits >> 8) & 0x0000_ffff_0000_ffff;
    (bits | bits >> 16) & 0xffff_ffff
}

/// Each bit of eight as a byte.
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
