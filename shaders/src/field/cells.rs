//! Cells of texels: which the surface of half density may pass through, and how far the rest is
//! from those.

use super::FAR;
use super::extent::Extent;
use super::texels::Texels;

/// The longest row of cells: 136 texels at 128.
const MOST: usize = 68;

/// The longest row of texels: at 256.
const TEXELS: usize = 264;

/// Cells told for nothing that are cheaper than another box.
const SLACK: usize = 256;

/// Cells and their distances.
#[derive(Debug)]
pub(super) struct Cells {
    /// Texels along a side of a cell.
    cell: usize,
    /// Cells in or beside which a texel is at least a half: a bit each along x, by z and y.
    solid: Vec<u128>,
    /// The cells that became solid or ceased to be since the distances were measured.
    flipped: Extent,
    /// Those of them that became solid, and that distances don't tell yet.
    risen: Extent,
    distances: Texels,
    /// In each slice of equal z the distances that changed since they were taken.
    changed: Vec<Extent>,
    /// Where distances are measured.
    bench: Vec<Line>,
}

impl Cells {
    /// Cells of `cell` texels a side, none solid, for `texels` a side.
    pub(super) fn new(texels: usize, cell: usize) -> Self {
        let side = texels / cell;
        Cells {
            cell,
            solid: vec![0; side * side],
            flipped: Extent::NONE,
            risen: Extent::NONE,
            distances: Texels::new(side, FAR),
            changed: vec![Extent::NONE; side],
            bench: vec![[FAR; LINE]; side * side],
        }
    }

    pub(super) const fn distances(&self) -> &Texels {
        &self.distances
    }

    /// Looks again at the cells that texels of a box belong to or lie beside.
    pub(super) fn follow(&mut self, density: &Texels, texels: Extent) {
        let cells = texels.grown(1, density.side()).coarser(self.cell);
        let [first, end] = [cells.lo[0], cells.hi[0]];
        let stretch = u128::MAX >> (128 - (end - first)) << first;
        let side = self.distances.side();
        for (y, z) in cells.rows() {
            let solid = solid_cells(density, self.cell, (y, z), first..end);
            let row = &mut self.solid[z * side + y];
            let flipped = (*row ^ solid) & stretch;
            if flipped != 0 {
                *row ^= flipped;
                let lo = flipped.trailing_zeros() as usize;
                let hi = 128 - flipped.leading_zeros() as usize;
                let part = Extent { lo: [lo, y, z], hi: [hi, y + 1, z + 1] };
                self.flipped = self.flipped.union(&part);
                if flipped & solid != 0 {
                    self.risen = self.risen.union(&part);
                }
            }
        }
    }

    /// Cells whose distances are to be measured again, with sixteen more for each row's overhead.
    pub(super) fn unmeasured(&self) -> usize {
        let [x, y, z] = self.flipped.grown(FAR.into(), self.distances.side()).size();
        (x + 16) * y * z
    }

    /// Lowers distances to what they are at least from the box of the cells that became solid:
    /// never too great from then on, and right once measured.
    pub(super) fn lower(&mut self) {
        let risen = std::mem::replace(&mut self.risen, Extent::NONE);
        if risen.is_empty() {
            return;
        }
        let away = |axis: usize, at: usize| {
            let (before, behind) = (risen.lo[axis].saturating_sub(at), at + 1);
            before.max(behind.saturating_sub(risen.hi[axis])) as u8
        };
        let around = risen.grown(FAR.into(), self.distances.side());
        let [lo, hi] = [around.lo[0], around.hi[0]];
        let mut along_x = [0; MOST];
        (lo..hi).for_each(|x| along_x[x - lo] = away(0, x));
        let mut row = [0; MOST];
        for (y, z) in around.rows() {
            let least = away(1, y).max(away(2, z));
            let row = &mut row[..hi - lo];
            row.copy_from_slice(&self.distances.row(y, z)[lo..hi]);
            for (distance, along_x) in row.iter_mut().zip(&along_x) {
                *distance = (*distance).min(least.max(*along_x));
            }
            self.distances.replace([lo, y, z], row, &mut self.changed[z]);
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
        self.risen = Extent::NONE;
        if flipped.is_empty() {
            return;
        }
        let inner = flipped.grown(FAR.into(), side);
        let frame = inner.grown(1, side);
        let [_, rows, slices] = frame.size();
        let groups = (frame.hi[0] - frame.lo[0]).div_ceil(LANES);
        for (i, at) in frame.rows().enumerate() {
            self.start_row(i, at, inner, frame);
        }
        // The row beside, and the three in the slice behind: forwards, then from the other end.
        for (i, (z, y)) in (0..slices).flat_map(|z| (0..rows).map(move |y| (z, y))).enumerate() {
            let (before, row) = self.bench.split_at_mut(i);
            let at = |back: usize, there: bool| if there { &before[i - back] } else { &NOWHERE };
            let near = [
                at(rows + 1, z > 0 && y > 0),
                at(rows, z > 0),
                at(rows.wrapping_sub(1), z > 0 && y + 1 < rows),
                at(1, y > 0),
            ];
            reach(&mut row[0], near, groups);
        }
        for (i, (z, y)) in (0..slices).flat_map(|z| (0..rows).map(move |y| (z, y))).enumerate() {
            // The same rows, counted from the end.
            let i = slices * rows - 1 - i;
            let (row, after) = self.bench[i..slices * rows].split_at_mut(1);
            let at = |on: usize, there: bool| if there { &after[on - 1] } else { &NOWHERE };
            let near = [
                at(rows + 1, z > 0 && y > 0),
                at(rows, z > 0),
                at(rows.wrapping_sub(1), z > 0 && y + 1 < rows),
                at(1, y > 0),
            ];
            reach(&mut row[0], near, groups);
        }
        for (i, (y, z)) in frame.rows().enumerate().filter(|(_, at)| inner.has_row(*at)) {
            let skip = MARGIN + inner.lo[0] - frame.lo[0];
            let row = &self.bench[i][skip..skip + inner.hi[0] - inner.lo[0]];
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

    /// Line i of the bench, with what is known and the steps along it.
    fn start_row(&mut self, i: usize, (y, z): (usize, usize), inner: Extent, frame: Extent) {
        let side = self.distances.side();
        let line = &mut self.bench[i];
        line.fill(FAR);
        let width = frame.hi[0] - frame.lo[0];
        let known = &self.distances.row(y, z)[frame.lo[0]..frame.hi[0]];
        line[MARGIN..MARGIN + width].copy_from_slice(known);
        // Around the box all is known, steps along x too.
        if !inner.has_row((y, z)) {
            return;
        }
        let inside = inner.hi[0] - inner.lo[0];
        let all = u128::MAX >> (128 - inside);
        let solid = self.solid[z * side + y] >> inner.lo[0] & all;
        let first = MARGIN + inner.lo[0] - frame.lo[0];
        line[first..first + inside].fill(if solid == all { 0 } else { FAR });
        if solid == all || solid == 0 && [line[MARGIN], line[MARGIN + width - 1]] == [FAR; 2] {
            return;
        }
        let mut left = solid;
        while left != 0 {
            line[first + left.trailing_zeros() as usize] = 0;
            left &= left - 1;
        }
        let mut last = FAR;
        for distance in &mut line[MARGIN..MARGIN + width] {
            last = (last + 1).min(*distance);
            *distance = last;
        }
        for distance in line[MARGIN..MARGIN + width].iter_mut().rev() {
            last = (last + 1).min(*distance);
            *distance = last;
        }
    }
}

/// Distances along x on the bench: from `MARGIN` on, and room around for steps out of it.
type Line = [u8; LINE];
const LANES: usize = 16;
const MARGIN: usize = 16;
const LINE: usize = MOST.next_multiple_of(LANES) + 2 * MARGIN;
static NOWHERE: Line = [FAR; LINE];

#[inline]
fn lanes(line: &Line, at: usize) -> &[u8; LANES] {
    line[at..].first_chunk().unwrap_or(&[FAR; LANES])
}

/// The distance here, or a step from beside.
#[inline]
fn closer(here: &[u8; LANES], beside: &[u8; LANES]) -> [u8; LANES] {
    let mut least = *here;
    for (least, beside) in least.iter_mut().zip(beside) {
        *least = (*least).min(beside + 1);
    }
    least
}

#[inline(never)]
fn least([a, b, c, d]: [&[u8; LANES]; 4]) -> [u8; LANES] {
    let mut least = [0; LANES];
    for (k, least) in least.iter_mut().enumerate() {
        *least = a[k].min(b[k]).min(c[k].min(d[k]));
    }
    least
}

/// Steps into a line from four others. By itself the compiler makes vectors of it.
#[inline(never)]
fn reach(line: &mut Line, [a, b, c, d]: [&Line; 4], groups: usize) {
    let mut all = [FAR; LINE];
    for at in (MARGIN..).step_by(LANES).take(groups) {
        if let Some(all) = all[at..].first_chunk_mut() {
            *all = least([lanes(a, at), lanes(b, at), lanes(c, at), lanes(d, at)]);
        }
    }
    for at in (MARGIN..).step_by(LANES).take(groups) {
        let side =
            least([lanes(&all, at - 1), lanes(&all, at), lanes(&all, at + 1), &[FAR; LANES]]);
        if let Some(line) = line[at..].first_chunk_mut() {
            *line = closer(line, &side);
        }
    }
}

/// Of the cells of a row, those in or beside which a texel is at least a half.
fn solid_cells(
    density: &Texels,
    size: usize,
    (y, z): (usize, usize),
    cells: std::ops::Range<usize>,
) -> u128 {
    let side = density.side();
    let beside = |cell: usize| (cell * size).saturating_sub(1)..(cell * size + size + 1).min(side);
    // With one more texel on either side.
    let mut any = [0u8; TEXELS + 2];
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
        let near = any[cell * size..][..size + 2].iter().fold(0, |all, texel| all | texel);
        solid |= u128::from(near >> 7) << cell;
    }
    solid
}
