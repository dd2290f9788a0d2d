//! Keeping the textures up to date: what changed is noted each tick, and made good each frame.

use paros_core::dirty::{Dirty, Rect};
use paros_core::maps::{Axis, Column, Maps, Range};

use super::blur::MOST;
use super::extent::Extent;
use super::texels::{Changes, Texels};
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

    /// A frame's, for a volume of `n` voxels a side: less than a million instructions and 256 KiB at
    /// 128, and four times that at 256, as four times as much surface changes. Work may be reckoned
    /// a third too low, hence three quarters of the million.
    #[must_use]
    pub const fn frame(n: usize) -> Self {
        let more = if n > 128 { 4 } else { 1 };
        Budget { work: more * 750_000, bytes: more * 256 * 1024 }
    }
}

/// What of a budget is spent.
struct Purse {
    budget: Budget,
    spent: Budget,
}

impl Purse {
    const fn spend(&mut self, work: usize, bytes: usize) {
        self.spent.work += work;
        self.spent.bytes += bytes;
    }

    fn left(&self) -> Budget {
        let less = |all: usize, spent| all.saturating_sub(spent);
        let work = less(self.budget.work, self.spent.work);
        Budget { work, bytes: less(self.budget.bytes, self.spent.bytes) }
    }

    /// Whether so much is left.
    fn has(&self, work: usize, bytes: usize) -> bool {
        let left = self.left();
        work <= left.work && bytes <= left.bytes
    }
}

/// Work of a voxel that is looked at, of one that is blurred although all around is the same, and
/// of sixteen texels for which it isn't.
const LOOK_WORK: usize = 6;
const PLAIN_WORK: usize = 3;
const GROUP_WORK: usize = 220;
/// Work of a texel that is compared; that changed, all levels included; that the surface may have
/// passed; and of all that.
const SAME_WORK: usize = 5;
const CHANGED_WORK: usize = 6;
const CROSSED_WORK: usize = 6;
const TEXEL_WORK: usize = SAME_WORK + CHANGED_WORK + CROSSED_WORK;
/// Work of a row of cells, all distances included.
const CELL_WORK: usize = 660;
/// Work of a line that is noted; of a search for lines, for each of a map's; of a tile whose columns
/// are compared, of a column among them, of one that changed, and of one in a line where all may
/// have; and of a tile's box of stale texels.
const LINE_WORK: usize = 100;
const SCAN_WORK: usize = 18;
const TILE_WORK: usize = 200;
const COLUMN_WORK: usize = 14;
const CHANGE_WORK: usize = 100;
const WHOLE_WORK: usize = 60;
const STALE_WORK: usize = 800;

/// Columns along a side of the tiles whose changes are taken together.
const TILE: usize = 8;

impl<const N: usize> Field<N> {
    /// Takes in what a tick changed: `maps` as they are now, and the columns in which they may
    /// differ from what was noted before. The textures follow when they [`Field::advance`].
    pub fn note(&mut self, maps: &Maps<N>, dirty: &Dirty) {
        let all =
            |&Rect { lo, hi }: &Rect| lo == (0, 0) && [hi.0, hi.1].map(usize::from) == [N - 1; 2];
        let copied = Axis::ALL.iter().any(|&axis| dirty.rects(axis).iter().any(all));
        if copied {
            self.latest.copy_from(maps);
            self.noted += 3 * N * N / 4;
        }
        for axis in Axis::ALL {
            for &Rect { lo, hi } in dirty.rects(axis) {
                let places = Range::new(lo.1.into(), hi.1.into());
                for line in lo.0.into()..=hi.0.into() {
                    self.unseen.add(axis, line, places);
                    if copied {
                        continue;
                    }
                    self.latest.copy_places(maps, axis, line, places);
                    self.noted += LINE_WORK;
                }
            }
        }
    }

    /// Takes over columns as far as the budget goes; some in any case.
    fn take_over(&mut self, purse: &mut Purse, first: &mut bool) {
        let tiles = TILE * N;
        while let Some((axis, line, end, places)) = self.unseen.first(2 * tiles) {
            let most =
                SCAN_WORK * N + (CHANGE_WORK + COLUMN_WORK) * tiles + 2 * TILE_WORK * N / TILE;
            if !*first && !purse.has(most, 0) {
                return;
            }
            let end = end.min(line + TILE);
            self.unseen.done(axis, line, end);
            let whole = places == Range::new(0, N - 1);
            for place in (places.lo()..=places.hi()).step_by(TILE) {
                let last = [end - 1, (place + TILE - 1).min(places.hi())];
                self.take_over_tile(axis, ([line, place], last), whole);
            }
            let columns = (end - line) * (places.hi() + 1 - places.lo());
            let changes = std::mem::take(&mut self.noted);
            purse.spend(SCAN_WORK * N + COLUMN_WORK * columns + changes, 0);
            *first = false;
        }
    }

    /// Takes over a tile of a map's columns, from the first line and place to the last. After the
    /// change of a whole map all voxels of a line's columns count as changed, as that is quick.
    fn take_over_tile(&mut self, axis: Axis, (first, last): ([usize; 2], [usize; 2]), whole: bool) {
        let (mut lines, mut places, mut voxels) = (Range::EMPTY, Range::EMPTY, Range::EMPTY);
        self.noted += TILE_WORK;
        for line in first[0]..=last[0] {
            let new = &self.latest.line(axis, line)[first[1]..=last[1]];
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
            self.maps.copy_places(&self.latest, axis, line, differing);
            self.lines.add(axis, line, differing);
            lines = lines.hull_with(Range::new(line, line));
            places = places.hull_with(differing);
        }
        if !lines.is_empty() {
            let lo = axis.voxel((lines.lo(), places.lo()), voxels.lo());
            let hi = axis.voxel((lines.hi(), places.hi()), voxels.hi());
            self.backlog.add_voxels(lo, hi);
            self.noted += STALE_WORK;
        }
    }

    /// Brings the textures nearer to the maps, and hands out each region that changed with its
    /// bytes, maps first. It costs no more than the budget, but does one thing at least, so that
    /// any budget gets there. Afterwards no cell tells more than its distance in the density as it is,
    /// and each that the surface may pass through tells 0.
    /// About what it cost comes back.
    pub fn advance(&mut self, budget: Budget, sink: &mut impl FnMut(Region, &[u8])) -> Budget {
        let mut purse = Purse { budget, spent: Budget { work: 0, bytes: 0 } };
        purse.spend(std::mem::take(&mut self.noted), 0);
        let mut first = true;
        self.take_over(&mut purse, &mut first);
        while let Some((axis, line, end, places)) = self.lines.first(purse.left().bytes) {
            let region = map_region(axis, line..end, places);
            let work = SCAN_WORK * N + region.bytes();
            if !purse.has(work, region.bytes()) && !first {
                return purse.spent;
            }
            self.lines.done(axis, line, end);
            self.hand_out_map(axis, region, sink);
            purse.spend(work, region.bytes());
            first = false;
        }
        // Boxes wait for all columns: they would be computed once more.
        if self.unseen.is_empty() {
            self.refresh_boxes(&mut purse, first, sink);
        }
        self.cells.measure();
        let (cells, stage) = (&mut self.cells, &mut self.stage);
        cells.take_changed(|free, extent| {
            purse.spend(0, extent.volume());
            hand_out(free, extent, Texture::Cells, stage, sink);
        });
        purse.spent
    }

    /// Computes boxes as far as the budget goes; one at least if it is the `first` thing done.
    fn refresh_boxes(
        &mut self,
        purse: &mut Purse,
        mut first: bool,
        sink: &mut impl FnMut(Region, &[u8]),
    ) {
        let mut crossed = Crossed::new(self.side(0), cell(N));
        while let Some(extent) = self.backlog.take() {
            let (cell_work, cell_bytes) = crossed.with(&extent).cost();
            let bytes = most_bytes(&extent) + cell_bytes;
            let look = LOOK_WORK * window_of(&extent);
            let mut goes = first || purse.has(2 * look + cell_work, bytes);
            if goes {
                // A look tells how much the rest may be.
                let groups = self.blur.look(&self.maps, extent);
                purse.spend(look, 0);
                let blur = PLAIN_WORK * window_of(&extent) + GROUP_WORK * groups;
                let texels = TEXEL_WORK * extent.volume();
                goes = first || purse.has(blur + texels + cell_work, bytes);
                purse.spend(if goes { blur } else { 0 }, 0);
            }
            if !goes {
                self.backlog.add(&extent);
                break;
            }
            let changed = self.refresh(extent, sink);
            if !changed.crossed.is_empty() {
                crossed = crossed.with(&changed.crossed);
            }
            purse.spend(changed.work, changed.bytes);
            first = false;
        }
        purse.spend(crossed.cost().0, 0);
    }

    /// Whether the textures are behind the maps, or something is still to be handed out.
    #[must_use]
    pub fn pending(&self) -> bool {
        !self.unseen.is_empty() || !self.backlog.is_empty() || !self.lines.is_empty()
    }

    /// Computes the box of the finest texels that was looked at, and what follows from those that
    /// change.
    fn refresh(&mut self, extent: Extent, sink: &mut impl FnMut(Region, &[u8])) -> Changed {
        self.blur.compute();
        let mut changes = Changes::new(extent.lo[0]);
        for (y, z) in extent.rows() {
            self.density[0].replace((y, z), self.blur.row(y, z), &mut changes);
        }
        let (mut changed, crossed) = (changes.all(), changes.crossed());
        if !crossed.is_empty() {
            self.cells.follow(&self.density[0], crossed);
        }
        let work = SAME_WORK * extent.volume()
            + CHANGED_WORK * changed.volume()
            + CROSSED_WORK * crossed.volume();
        let mut bytes = 0;
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
            bytes += changed.volume();
        }
        Changed { crossed, work, bytes }
    }

    fn hand_out_map(&mut self, axis: Axis, region: Region, sink: &mut impl FnMut(Region, &[u8])) {
        let [first, line, _] = region.min.map(|i| i as usize);
        let [places, lines, _] = region.size.map(|i| i as usize);
        self.stage.resize(region.bytes(), 0);
        for (line, row) in (line..line + lines).zip(self.stage.chunks_exact_mut(2 * places)) {
            let columns = &self.maps.line(axis, line)[first..first + places];
            for (bytes, column) in row.as_chunks_mut::<2>().0.iter_mut().zip(columns) {
                *bytes = column.0[0].to_bytes();
            }
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
        if self.rows == 0 {
            return (0, 0);
        }
        let [_, y, z] = self.all.size();
        (CELL_WORK * self.rows.min(y * z), self.all.volume())
    }
}

/// What a box that was computed came to.
struct Changed {
    /// The texels that the surface may have passed.
    crossed: Extent,
    work: usize,
    bytes: usize,
}

/// Voxels that a box looks at.
fn window_of(extent: &Extent) -> usize {
    let [x, y, z] = extent.size();
    (x + 2 * LEFT) * (y + 2 * REACH) * (z + 2 * REACH)
}

/// At most the bytes of a box of the finest texels.
fn most_bytes(extent: &Extent) -> usize {
    (0..LEVELS).map(|level| extent.coarser(1 << level).volume()).sum()
}
