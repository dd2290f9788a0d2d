//! Incremental update of the textures under a frame budget: a tick notes the columns that changed,
//! a frame compares them, uploads map regions and recomputes stale boxes of texels.

use paros_core::{Axis, Column, ColumnRect, DirtyRects, Range, RangeMaps};

use super::budget::{
    Budget, BudgetMeter, CELL_ROW_WORK, CHANGED_COLUMN_WORK, CHANGED_WORK, COLUMN_WORK,
    COMPARED_WORK, CROSSED_WORK, GROUP_WORK, LINE_WORK, SCAN_WORK, STALE_BOX_WORK, TEXEL_WORK,
    TILE_WORK, UNIFORM_WORK, VOXEL_WORK, WHOLE_MAP_COLUMN_WORK,
};
use super::extent::TexelBox;
use super::mips;
use super::rows::MAX_BOX;
use super::sizes::{LEVELS, MAX_CELL_DISTANCE, REACH, cell_side};
use super::texels::{TexelChanges, TexelCube};
use super::textures::DensityField;
use super::window::MARGIN_X;
use crate::upload::{Region, Texture};

/// Columns along a side of the tiles whose changes share a box of stale texels.
const COMPARE_TILE: usize = 8;

impl<const N: usize> DensityField<N> {
    /// Notes what a tick changed: copies the `dirty` columns of `maps`, which are all that may
    /// differ from what was noted before. The textures follow in [`DensityField::update_textures`].
    pub fn note_changes(&mut self, maps: &RangeMaps<N>, dirty: &DirtyRects) {
        let is_whole_map = |rect: &ColumnRect| {
            rect.first == (0, 0) && [rect.last.0, rect.last.1].map(usize::from) == [N - 1; 2]
        };
        let copied = Axis::ALL.iter().any(|&axis| dirty.rects(axis).iter().any(is_whole_map));
        if copied {
            self.latest.copy_from(maps);
            self.unbilled_work += 3 * N * N / 4;
        }
        for axis in Axis::ALL {
            for &ColumnRect { first, last } in dirty.rects(axis) {
                let places = Range::new(first.1.into(), last.1.into());
                for line in first.0.into()..=last.0.into() {
                    self.uncompared.mark_places(axis, line, places);
                    if copied {
                        continue;
                    }
                    self.latest.copy_columns(maps, axis, line, places);
                    self.unbilled_work += LINE_WORK;
                }
            }
        }
    }

    /// Compares noted columns with those of the textures within the budget; if nothing was done
    /// yet, at least one line of tiles.
    fn compare_columns(&mut self, meter: &mut BudgetMeter, idle: &mut bool) {
        let tiles = COMPARE_TILE * N;
        while let Some((axis, line, end, places)) = self.uncompared.first_run(2 * tiles) {
            let most = SCAN_WORK * N
                + (CHANGED_COLUMN_WORK + COLUMN_WORK) * tiles
                + 2 * TILE_WORK * N / COMPARE_TILE;
            if !*idle && !meter.can_afford(most, 0) {
                return;
            }
            let end = end.min(line + COMPARE_TILE);
            self.uncompared.clear_lines(axis, line, end);
            let whole = places == Range::new(0, N - 1);
            for place in (places.first()..=places.last()).step_by(COMPARE_TILE) {
                let last = [end - 1, (place + COMPARE_TILE - 1).min(places.last())];
                self.compare_tile(axis, ([line, place], last), whole);
            }
            let columns = (end - line) * (places.last() + 1 - places.first());
            let changes = std::mem::take(&mut self.unbilled_work);
            meter.spend(SCAN_WORK * N + COLUMN_WORK * columns + changes, 0);
            *idle = false;
        }
    }

    /// Compares a tile of a map's columns, from the first line and place to the last, copies those
    /// that differ, and marks their texels stale. With `whole`, after the change of a whole map,
    /// all voxels of a changed line count as changed, which is faster.
    fn compare_tile(&mut self, axis: Axis, (first, last): ([usize; 2], [usize; 2]), whole: bool) {
        let (mut lines, mut places, mut voxels) = (Range::EMPTY, Range::EMPTY, Range::EMPTY);
        self.unbilled_work += TILE_WORK;
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
                self.unbilled_work += new.len() * WHOLE_MAP_COLUMN_WORK;
            }
            for (place, (old, new)) in old.iter().zip(new).enumerate().filter(|_| !whole) {
                if old != new {
                    differing = differing.hull_with(Range::new(place, place));
                    voxels = voxels.hull_with(differing_voxels(*old, *new));
                    self.unbilled_work += CHANGED_COLUMN_WORK;
                }
            }
            let differing = Range::new(differing.first() + first[1], differing.last() + first[1]);
            self.maps.copy_columns(&self.latest, axis, line, differing);
            self.stale_lines.mark_places(axis, line, differing);
            lines = lines.hull_with(Range::new(line, line));
            places = places.hull_with(differing);
        }
        if !lines.is_empty() {
            let lo = axis.voxel_at((lines.first(), places.first()), voxels.first());
            let hi = axis.voxel_at((lines.last(), places.last()), voxels.last());
            self.backlog.mark_voxels(lo, hi);
            self.unbilled_work += STALE_BOX_WORK;
        }
    }

    /// Updates the textures within the budget and passes each region that changed, with its bytes,
    /// to `sink`, maps first. At least one unit of work is done, so that any budget makes progress.
    /// The cells are conservative after each call: no distance is more than the present density's,
    /// and those that the surface may pass through are 0.
    ///
    /// Returns an estimate of the cost.
    pub fn update_textures(
        &mut self,
        budget: Budget,
        sink: &mut impl FnMut(Region, &[u8]),
    ) -> Budget {
        let mut meter = BudgetMeter { budget, spent: Budget { work: 0, bytes: 0 } };
        meter.spend(std::mem::take(&mut self.unbilled_work), 0);
        let mut idle = true;
        self.compare_columns(&mut meter, &mut idle);
        while let Some((axis, line, end, places)) =
            self.stale_lines.first_run(meter.remaining().bytes)
        {
            let region = map_region(axis, line..end, places);
            let work = SCAN_WORK * N + region.bytes();
            if !meter.can_afford(work, region.bytes()) && !idle {
                return meter.spent;
            }
            self.stale_lines.clear_lines(axis, line, end);
            self.emit_map_region(axis, region, sink);
            meter.spend(work, region.bytes());
            idle = false;
        }
        // Only once all columns are compared, lest boxes be computed twice.
        if self.uncompared.is_empty() {
            self.update_boxes(&mut meter, idle, sink);
        }
        self.cells.update_distances();
        let (cells, stage) = (&mut self.cells, &mut self.staging);
        cells.drain_changed(|free, extent| {
            meter.spend(0, extent.volume());
            emit_box(free, extent, Texture::Cells, stage, sink);
        });
        meter.spent
    }

    /// Recomputes stale boxes within the budget; at least one if nothing was done yet (`idle`).
    fn update_boxes(
        &mut self,
        meter: &mut BudgetMeter,
        mut idle: bool,
        sink: &mut impl FnMut(Region, &[u8]),
    ) {
        let mut crossed = CrossedCells::new(self.level_side(0), cell_side(N));
        while let Some(extent) = self.backlog.take_joined() {
            let (cell_work, cell_bytes) = crossed.with_box(&extent).max_cost();
            let bytes = max_upload_bytes(&extent) + cell_bytes;
            let look = VOXEL_WORK * window_voxels(&extent);
            let mut goes = idle || meter.can_afford(2 * look + cell_work, bytes);
            if goes {
                // The voxels tell how many groups have to be blurred.
                let groups = self.blur.load_voxels(&self.maps, extent);
                meter.spend(look, 0);
                let blur = UNIFORM_WORK * window_voxels(&extent) + GROUP_WORK * groups;
                let texels = TEXEL_WORK * extent.volume();
                goes = idle || meter.can_afford(blur + texels + cell_work, bytes);
                meter.spend(if goes { blur } else { 0 }, 0);
            }
            if !goes {
                self.backlog.mark_texels(&extent);
                break;
            }
            let changed = self.update_box(extent, sink);
            if !changed.crossed.is_empty() {
                crossed = crossed.with_box(&changed.crossed);
            }
            meter.spend(changed.work, changed.bytes);
            idle = false;
        }
        meter.spend(crossed.max_cost().0, 0);
    }

    /// Whether textures are stale or regions wait to be uploaded.
    #[must_use]
    pub fn has_pending(&self) -> bool {
        !self.uncompared.is_empty() || !self.backlog.is_empty() || !self.stale_lines.is_empty()
    }

    /// Recomputes the box of finest texels whose voxels are loaded, and what depends on those that
    /// change: mip levels and cells.
    fn update_box(&mut self, extent: TexelBox, sink: &mut impl FnMut(Region, &[u8])) -> BoxUpdate {
        self.blur.compute_texels();
        let mut changes = TexelChanges::new(extent.lo[0]);
        for (y, z) in extent.rows() {
            self.density[0].replace_row((y, z), self.blur.row(y, z), &mut changes);
        }
        let (mut changed, crossed) = (changes.changed_box(), changes.crossed_box());
        if !crossed.is_empty() {
            self.cells.mark_surface(&self.density[0], crossed);
        }
        let work = COMPARED_WORK * extent.volume()
            + CHANGED_WORK * changed.volume()
            + CROSSED_WORK * crossed.volume();
        let mut bytes = 0;
        for level in 0..LEVELS {
            if level > 0 && !changed.is_empty() {
                let (finer, coarser) = self.density.split_at_mut(level);
                changed =
                    mips::downsample_box(&finer[level - 1], &mut coarser[0], changed.coarser_by(2));
            }
            if changed.is_empty() {
                break;
            }
            let texture = Texture::Density(level as u8);
            emit_box(&self.density[level], changed, texture, &mut self.staging, sink);
            bytes += changed.volume();
        }
        BoxUpdate { crossed, work, bytes }
    }

    fn emit_map_region(
        &mut self,
        axis: Axis,
        region: Region,
        sink: &mut impl FnMut(Region, &[u8]),
    ) {
        let [first, line, _] = region.min.map(|i| i as usize);
        let [places, lines, _] = region.size.map(|i| i as usize);
        self.staging.resize(region.bytes(), 0);
        for (line, row) in (line..line + lines).zip(self.staging.chunks_exact_mut(2 * places)) {
            let columns = &self.maps.line(axis, line)[first..first + places];
            for (bytes, column) in row.as_chunks_mut::<2>().0.iter_mut().zip(columns) {
                *bytes = column.0[0].to_bytes();
            }
        }
        sink(region, &self.staging);
    }

    /// An upper bound of the bytes of any region that passes through the staging buffer.
    pub(super) const fn staging_capacity() -> usize {
        let (most, map) = (MAX_BOX, N * N * 2);
        let chunk = most[0] * most[1] * most[2];
        let cells = (Self::SIDE / cell_side(N)).pow(3);
        let most = if chunk > map { chunk } else { map };
        if cells > most { cells } else { most }
    }
}

/// Passes a box of texels to `sink`, as contiguous rows.
fn emit_box(
    texels: &TexelCube,
    extent: TexelBox,
    texture: Texture,
    stage: &mut Vec<u8>,
    sink: &mut impl FnMut(Region, &[u8]),
) {
    stage.clear();
    for (y, z) in extent.rows() {
        stage.extend_from_slice(&texels.row(y, z)[extent.lo[0]..extent.hi[0]]);
    }
    sink(extent.to_region(texture), stage);
}

fn map_region(axis: Axis, lines: std::ops::Range<usize>, places: Range) -> Region {
    let min = [places.first() as u32, lines.start as u32, axis as u32];
    let size = [(places.last() + 1 - places.first()) as u32, lines.len() as u32, 1];
    Region { texture: Texture::Maps, min, size }
}

/// The hull of the symmetric difference of two columns' voxels. The columns differ.
fn differing_voxels(old: Column, new: Column) -> Range {
    let (old, new) = (old.hull(), new.hull());
    if old.is_empty() || new.is_empty() {
        return old.hull_with(new);
    }
    let both = old.hull_with(new);
    let first =
        if old.first() == new.first() { old.last().min(new.last()) + 1 } else { both.first() };
    let last =
        if old.last() == new.last() { old.first().max(new.first()) - 1 } else { both.last() };
    Range::new(first, last)
}

/// Bounds of the cells whose distances a frame's boxes may change.
#[derive(Clone, Copy)]
struct CrossedCells {
    side: usize,
    cell: usize,
    bounds: TexelBox,
    /// Rows of all boxes together, overlaps counted again.
    rows: usize,
}

impl CrossedCells {
    const fn new(side: usize, cell: usize) -> Self {
        CrossedCells { side, cell, bounds: TexelBox::NONE, rows: 0 }
    }

    /// Extended by the cells that one more box of texels may change.
    fn with_box(&self, texels: &TexelBox) -> Self {
        let cells = texels.grown_by(1, self.side).coarser_by(self.cell);
        let cells = cells.grown_by(MAX_CELL_DISTANCE as usize - 1, self.side / self.cell);
        CrossedCells {
            bounds: self.bounds.union(&cells),
            rows: self.rows + cells.rows().count(),
            ..*self
        }
    }

    /// Upper bounds of the work and of the bytes uploaded.
    fn max_cost(&self) -> (usize, usize) {
        if self.rows == 0 {
            return (0, 0);
        }
        let [_, y, z] = self.bounds.size();
        (CELL_ROW_WORK * self.rows.min(y * z), self.bounds.volume())
    }
}

/// The outcome of a recomputed box: its cost, and what crossed a half.
struct BoxUpdate {
    /// The box of the texels that crossed a half.
    crossed: TexelBox,
    work: usize,
    bytes: usize,
}

/// Voxels that a box of texels depends on, as they are loaded.
fn window_voxels(extent: &TexelBox) -> usize {
    let [x, y, z] = extent.size();
    (x + 2 * MARGIN_X) * (y + 2 * REACH) * (z + 2 * REACH)
}

/// Upper bound of the bytes to upload for a box of the finest texels, all mip levels included.
fn max_upload_bytes(extent: &TexelBox) -> usize {
    (0..LEVELS).map(|level| extent.coarser_by(1 << level).volume()).sum()
}
