//! Keeping the textures up to date: what changed is noted each tick, and made good each frame.

use paros_core::dirty::{Dirty, Rect};
use paros_core::maps::{Axis, Column, Maps, Range};

use super::blur::MOST;
use super::extent::Extent;
use super::texels::Texels;
use super::window::LEFT;
use super::{FAR, Field, LEVELS, REACH, cell, mips};
use crate::upload::{Region, Texture};

/// What a frame may spend.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Budget {
    /// Work, in units of about an instruction (of x86-64 with SSE2, counted by Callgrind).
    pub work: usize,
    /// Bytes handed out.
    pub bytes: usize,
}

impl Budget {
    /// All that is to be done.
    pub const UNLIMITED: Budget = Budget { work: usize::MAX, bytes: usize::MAX };

    /// A frame's, for a volume of `n` voxels a side: a million instructions and 256 KiB at 128, and
    /// four times that at 256, as four times as much surface changes.
    #[must_use]
    pub const fn frame(n: usize) -> Self {
        let more = if n > 128 { 4 } else { 1 };
        Budget { work: more * 1_000_000, bytes: more * 256 * 1024 }
    }

    const fn less(self, work: usize, bytes: usize) -> Self {
        let (work, bytes) = (self.work.saturating_sub(work), self.bytes.saturating_sub(bytes));
        Budget { work, bytes }
    }
}

/// Work of a voxel that a box of texels looks at, all levels included.
const VOXEL_WORK: usize = 22;
/// Work of a row of cells, all distances included.
const CELL_WORK: usize = 350;
/// Work of a column that is compared, and of one that changed.
const COLUMN_WORK: usize = 1;
const CHANGE_WORK: usize = 60;
const WHOLE_WORK: usize = 20;

/// Columns along a side of the tiles whose changes are taken together.
const TILE: usize = 8;

impl<const N: usize> Field<N> {
    /// Takes over what a tick changed: `maps` as they are now, and the columns in which they may
    /// differ from what was noted before. The textures follow when they [`Field::advance`].
    pub fn note(&mut self, maps: &Maps<N>, dirty: &Dirty) {
        let mut copy = false;
        for axis in Axis::ALL {
            for &Rect { lo, hi } in dirty.rects(axis) {
                let [lo, hi] = [lo, hi].map(|(line, place)| [usize::from(line), place.into()]);
                self.noted += COLUMN_WORK * (hi[0] + 1 - lo[0]) * (hi[1] + 1 - lo[1]);
                let whole = hi[0] - lo[0] == N - 1 && hi[1] - lo[1] == N - 1;
                copy |= whole;
                for line in (lo[0]..=hi[0]).step_by(TILE) {
                    for place in (lo[1]..=hi[1]).step_by(TILE) {
                        let end = [(line + TILE - 1).min(hi[0]), (place + TILE - 1).min(hi[1])];
                        self.note_tile(maps, axis, ([line, place], end), whole);
                    }
                }
            }
        }
        if copy {
            self.maps.copy_from(maps);
        }
    }

    /// Takes over a tile of a map's columns, from the first line and place to the last. After the
    /// change of a whole map all voxels of a line's columns count as changed, as that is quick.
    fn note_tile(
        &mut self,
        maps: &Maps<N>,
        axis: Axis,
        (first, last): ([usize; 2], [usize; 2]),
        whole: bool,
    ) {
        let (mut lines, mut places, mut voxels) = (Range::EMPTY, Range::EMPTY, Range::EMPTY);
        for line in first[0]..=last[0] {
            let new = &maps.line(axis, line)[first[1]..=last[1]];
            let old = &self.maps.line(axis, line)[first[1]..=last[1]];
            if old == new {
                continue;
            }
            let mut differing = Range::EMPTY;
            if whole {
                let hull = old.iter().zip(new).map(|(old, new)| old.hull().hull_with(new.hull()));
                voxels = hull.fold(voxels, Range::hull_with);
                differing = Range::new(0, new.len() - 1);
                self.noted += new.len() * WHOLE_WORK;
            }
            for (place, (old, new)) in old.iter().zip(new).enumerate().filter(|_| !whole) {
                if old != new {
                    differing = differing.hull_with(Range::new(place, place));
                    voxels = voxels.hull_with(difference(*old, *new));
                    self.noted += CHANGE_WORK;
                }
            }
            let differing = Range::new(differing.lo() + first[1], differing.hi() + first[1]);
            for place in (differing.lo()..=differing.hi()).filter(|_| !whole) {
                self.maps.set_column(axis, (line, place), maps.column(axis, (line, place)));
            }
            self.lines.add(axis, line, differing);
            lines = lines.hull_with(Range::new(line, line));
            places = places.hull_with(differing);
        }
        if !lines.is_empty() {
            let lo = axis.voxel((lines.lo(), places.lo()), voxels.lo());
            let hi = axis.voxel((lines.hi(), places.hi()), voxels.hi());
            self.backlog.add_voxels(lo, hi);
        }
    }

    /// Brings the textures nearer to the maps, and hands out each region that changed with its
    /// bytes, maps first. It costs no more than the budget, but does one thing at least, so that
    /// any budget gets there. Afterwards no cell tells more than its distance in the density as it is,
    /// and each that the surface may pass through tells 0.
    pub fn advance(&mut self, budget: Budget, sink: &mut impl FnMut(Region, &[u8])) {
        let mut left = budget.less(std::mem::take(&mut self.noted), 0);
        let mut first = true;
        while let Some((axis, line, end, places)) = self.lines.first(left.bytes) {
            let region = map_region(axis, line..end, places);
            if region.bytes() > left.bytes && !first {
                return;
            }
            self.lines.done(axis, line, end);
            self.hand_out_map(axis, region, sink);
            left = left.less(region.bytes(), region.bytes());
            first = false;
        }
        let mut crossed = Crossed::new(self.side(0), cell(N));
        while let Some(extent) = self.backlog.take() {
            let (work, bytes) = cost(&extent);
            let after = crossed.with(&extent);
            let (cell_work, cell_bytes) = after.cost();
            let fits = work + cell_work <= left.work && bytes + cell_bytes <= left.bytes;
            if !fits && !first {
                self.backlog.add(&extent);
                break;
            }
            if self.refresh(extent, sink) {
                crossed = after;
            }
            left = left.less(work, bytes);
            first = false;
        }
        self.cells.measure();
        let (cells, stage) = (&mut self.cells, &mut self.stage);
        cells.take_changed(|free, extent| hand_out(free, extent, Texture::Cells, stage, sink));
    }

    /// Whether the textures are behind the maps, or something is still to be handed out.
    #[must_use]
    pub fn pending(&self) -> bool {
        !self.backlog.is_empty() || !self.lines.is_empty()
    }

    /// Computes a box of the finest texels, and what follows from those that changed; whether the
    /// surface moved comes back.
    fn refresh(&mut self, extent: Extent, sink: &mut impl FnMut(Region, &[u8])) -> bool {
        self.blur.compute(&self.maps, extent);
        let (mut changed, mut crossed) = (Extent::NONE, Extent::NONE);
        for (y, z) in extent.rows() {
            let at = [extent.lo[0], y, z];
            let mut part = Extent::NONE;
            let flipped = self.density[0].replace(at, self.blur.row(y, z), &mut part);
            changed = changed.union(&part);
            // The top bit tells whether a texel is at least a half.
            if flipped >= 128 {
                crossed = crossed.union(&part);
            }
        }
        if !crossed.is_empty() {
            self.cells.follow(&self.density[0], crossed);
        }
        for level in 0..LEVELS {
            if level > 0 && !changed.is_empty() {
                let (finer, coarser) = self.density.split_at_mut(level);
                changed = mips::halve(&finer[level - 1], &mut coarser[0], changed.coarser(2));
            }
            if changed.is_empty() {
                break;
            }
            let texture = Texture::Density(level as u8);
            hand_out(&self.density[level], changed, texture, &mut self.stage, sink);
        }
        !crossed.is_empty()
    }

    fn hand_out_map(&mut self, axis: Axis, region: Region, sink: &mut impl FnMut(Region, &[u8])) {
        let [first, line, _] = region.min.map(|i| i as usize);
        let [places, lines, _] = region.size.map(|i| i as usize);
        self.stage.clear();
        for line in line..line + lines {
            let columns = &self.maps.line(axis, line)[first..first + places];
            self.stage.extend(columns.iter().flat_map(|column| column.0[0].to_bytes()));
        }
        sink(region, &self.stage);
    }

    /// The most bytes of a region that is handed out, from what is collected in between.
    pub(super) const fn stage_bytes() -> usize {
        let (most, map) = (MOST, N * N * 2);
        let chunk = most[0] * most[1] * most[2];
        let cells = (Self::SIDE / cell(N)).pow(3);
        let most = if chunk > map { chunk } else { map };
        if cells > most { cells } else { most }
    }
}

/// Hands out a box of a cube of texels.
fn hand_out(
    texels: &Texels,
    extent: Extent,
    texture: Texture,
    stage: &mut Vec<u8>,
    sink: &mut impl FnMut(Region, &[u8]),
) {
    stage.clear();
    for (y, z) in extent.rows() {
        stage.extend_from_slice(&texels.row(y, z)[extent.lo[0]..extent.hi[0]]);
    }
    sink(extent.region(texture), stage);
}

fn map_region(axis: Axis, lines: std::ops::Range<usize>, places: Range) -> Region {
    let min = [places.lo() as u32, lines.start as u32, axis as u32];
    let size = [(places.hi() + 1 - places.lo()) as u32, lines.len() as u32, 1];
    Region { texture: Texture::Maps, min, size }
}

/// The voxels, from the first to the last, that are in one of two ranges only. The ranges differ.
fn difference(old: Column, new: Column) -> Range {
    let (old, new) = (old.hull(), new.hull());
    if old.is_empty() || new.is_empty() {
        return old.hull_with(new);
    }
    let both = old.hull_with(new);
    let first = if old.lo() == new.lo() { old.hi().min(new.hi()) + 1 } else { both.lo() };
    let last = if old.hi() == new.hi() { old.lo().max(new.lo()) - 1 } else { both.hi() };
    Range::new(first, last)
}

/// The cells that a frame's boxes may change.
#[derive(Clone, Copy)]
struct Crossed {
    side: usize,
    cell: usize,
    all: Extent,
    /// Rows of each, together.
    rows: usize,
}

impl Crossed {
    const fn new(side: usize, cell: usize) -> Self {
        Crossed { side, cell, all: Extent::NONE, rows: 0 }
    }

    /// With those of one more box of texels.
    fn with(&self, texels: &Extent) -> Self {
        let cells = texels.grown(1, self.side).coarser(self.cell);
        let cells = cells.grown(FAR as usize - 1, self.side / self.cell);
        Crossed { all: self.all.union(&cells), rows: self.rows + cells.rows().count(), ..*self }
    }

    /// At most the work and the bytes.
    fn cost(&self) -> (usize, usize) {
        let [_, y, z] = self.all.size();
        (CELL_WORK * self.rows.min(y * z), self.all.volume())
    }
}

/// At most the work, and the bytes, of a box of the finest texels.
fn cost(extent: &Extent) -> (usize, usize) {
    let [x, y, z] = extent.size();
    let work = VOXEL_WORK * (x + 2 * LEFT) * (y + 2 * REACH) * (z + 2 * REACH);
    let level = |level: usize| extent.coarser(1 << level).size().iter().product::<usize>();
    (work, (0..LEVELS).map(level).sum())
}
