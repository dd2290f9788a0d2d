//! Cells of texels: which the surface of half density may pass through, and how far the rest is
//! from those.

use super::extent::Extent;
use super::texels::Texels;
use super::{CELL, FAR};

/// The longest row of cells: 264 texels at 256.
const MOST: usize = 66;

/// Cells told for nothing that are cheaper than another box.
const SLACK: usize = 256;

/// Cells and their distances.
#[derive(Debug)]
pub(super) struct Cells {
    /// Cells in or beside which a texel is at least a half: a bit each along x, by z and y.
    solid: Vec<u128>,
    /// The cells that became solid or ceased to be since the distances were measured.
    flipped: Extent,
    distances: Texels,
    /// In each slice of equal z the distances that changed since they were taken.
    changed: Vec<Extent>,
    /// Where distances are measured.
    bench: Texels,
}

impl Cells {
    /// No cell solid.
    pub(super) fn new(side: usize) -> Self {
        Cells {
            solid: vec![0; side * side],
            flipped: Extent::NONE,
            distances: Texels::new(side, FAR),
            changed: vec![Extent::NONE; side],
            bench: Texels::new(side, FAR),
        }
    }

    pub(super) const fn distances(&self) -> &Texels {
        &self.distances
    }

    /// Looks again at the cells that texels of a box belong to or lie beside.
    pub(super) fn follow(&mut self, density: &Texels, texels: Extent) {
        let cells = texels.grown(1, density.side()).coarser(CELL);
        let [first, end] = [cells.lo[0], cells.hi[0]];
        let stretch = u128::MAX >> (128 - (end - first)) << first;
        let side = self.distances.side();
        for (y, z) in cells.rows() {
            let solid = solid_cells(density, (y, z), first..end);
            let row = &mut self.solid[z * side + y];
            let flipped = (*row ^ solid) & stretch;
            if flipped != 0 {
                *row ^= flipped;
                let lo = flipped.trailing_zeros() as usize;
                let hi = 128 - flipped.leading_zeros() as usize;
                let part = Extent { lo: [lo, y, z], hi: [hi, y + 1, z + 1] };
                self.flipped = self.flipped.union(&part);
            }
        }
    }

    /// Measures the distances that cells which flipped can have changed.
    ///
    /// Steps to any of the 26 neighbours have length 1. Half of them lead to a later cell in the
    /// order of memory: one pass forwards and one back find all paths, with those along x gone
    /// first. Around the box distances are right as they are, and count as sources.
    pub(super) fn measure(&mut self) {
        let side = self.distances.side();
        let flipped = std::mem::replace(&mut self.flipped, Extent::NONE);
        if flipped.is_empty() {
            return;
        }
        let inner = flipped.grown(FAR.into(), side);
        let frame = inner.grown(1, side);
        for (y, z) in frame.rows() {
            self.start_row((y, z), inner, frame);
        }
        let Extent { lo, hi } = frame;
        for z in lo[2]..hi[2] {
            for y in lo[1]..hi[1] {
                let behind = (z > lo[2]).then(|| z - 1);
                self.reach_row((y, z), behind, (y > lo[1]).then(|| y - 1), frame);
            }
        }
        for z in (lo[2]..hi[2]).rev() {
            for y in (lo[1]..hi[1]).rev() {
                let behind = (z + 1 < hi[2]).then_some(z + 1);
                self.reach_row((y, z), behind, (y + 1 < hi[1]).then_some(y + 1), frame);
            }
        }
        for (y, z) in inner.rows() {
            let row = &self.bench.row(y, z)[inner.lo[0]..inner.hi[0]];
            self.distances.replace([inner.lo[0], y, z], row, &mut self.changed[z]);
        }
    }

    /// Tells the boxes of distances that changed, and forgets them.
    pub(super) fn take_changed(&mut self, mut tell: impl FnMut(&Texels, Extent)) {
        let mut open = Extent::NONE;
        for slice in &mut self.changed {
            let slice = std::mem::replace(slice, Extent::NONE);
            let both = open.union(&slice);
            // Slices go together while that takes little more than each by itself.
            if both.volume() > open.volume() + slice.volume() + SLACK {
                tell(&self.distances, open);
                open = slice;
            } else {
                open = both;
            }
        }
        if !open.is_empty() {
            tell(&self.distances, open);
        }
    }

    /// A row of the bench with what is known, and the steps along it.
    fn start_row(&mut self, (y, z): (usize, usize), inner: Extent, frame: Extent) {
        let side = self.distances.side();
        let row = self.bench.row_mut(y, z);
        let ends = frame.lo[0]..frame.hi[0];
        row[ends.clone()].copy_from_slice(&self.distances.row(y, z)[ends.clone()]);
        let inside = |axis: usize, at: usize| inner.lo[axis] <= at && at < inner.hi[axis];
        if inside(1, y) && inside(2, z) {
            let solid = self.solid[z * side + y];
            let inner = inner.lo[0]..inner.hi[0];
            for (x, distance) in inner.clone().zip(&mut row[inner]) {
                *distance = if solid >> x & 1 == 1 { 0 } else { FAR };
            }
        }
        if row[ends.clone()].iter().fold(FAR, |least, distance| least.min(*distance)) == FAR {
            return;
        }
        let mut last = FAR;
        for distance in &mut row[ends.clone()] {
            last = (*distance).min(last + 1);
            *distance = last;
        }
        for distance in row[ends].iter_mut().rev() {
            last = (*distance).min(last + 1);
            *distance = last;
        }
    }

    /// Steps into a row from the three rows of the slice behind it and from the row beside it.
    fn reach_row(
        &mut self,
        (y, z): (usize, usize),
        behind: Option<usize>,
        beside: Option<usize>,
        frame: Extent,
    ) {
        let [lo, hi] = [frame.lo[0], frame.hi[0]];
        let width = hi - lo;
        // One more on either side, so that each has two neighbours.
        let mut least = [FAR; MOST + 2];
        let mut meet = |row: &[u8]| {
            for (least, distance) in least[1..=width].iter_mut().zip(&row[lo..hi]) {
                *least = (*least).min(*distance);
            }
        };
        if let Some(z) = behind {
            let [first, last] =
                [y.saturating_sub(1).max(frame.lo[1]), (y + 1).min(frame.hi[1] - 1)];
            meet(self.bench.row(first, z));
            meet(self.bench.row(y, z));
            meet(self.bench.row(last, z));
        }
        if let Some(y) = beside {
            meet(self.bench.row(y, z));
        }
        let row = &mut self.bench.row_mut(y, z)[lo..hi];
        let three = least[..width].iter().zip(&least[1..=width]).zip(&least[2..width + 2]);
        for (distance, ((a, b), c)) in row.iter_mut().zip(three) {
            *distance = (*distance).min((*a).min(*b).min(*c) + 1);
        }
    }
}

/// Of the cells of a row, those in or beside which a texel is at least a half.
fn solid_cells(density: &Texels, (y, z): (usize, usize), cells: std::ops::Range<usize>) -> u128 {
    let side = density.side();
    let beside = |cell: usize| (cell * CELL).saturating_sub(1)..(cell * CELL + CELL + 1).min(side);
    // With one more texel on either side.
    let mut any = [0u8; MOST * CELL + 2];
    let ends = beside(cells.start).start..beside(cells.end - 1).end;
    for z in beside(z) {
        for y in beside(y) {
            let row = &density.row(y, z)[ends.clone()];
            for (any, texel) in any[ends.start + 1..].iter_mut().zip(row) {
                *any |= texel;
            }
        }
    }
    let mut solid = 0;
    for cell in cells {
        let six = any[cell * CELL..][..CELL + 2].iter().fold(0, |all, texel| all | texel);
        solid |= u128::from(six >> 7) << cell;
    }
    solid
}
