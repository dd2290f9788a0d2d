//! Incremental update of the textures under a frame budget: a tick notes the columns that changed,
//! a frame compares them, uploads map regions and recomputes stale boxes of texels.

use paros_core::RangeMaps;
use paros_core::volume::{Axis, Column, ColumnRect, DirtyRects, Range};

use super::backlog::LineRun;
use super::budget::{
    Budget, BudgetMeter, CELL_ROW_WORK, CHANGED_COLUMN_WORK, CHANGED_WORK, COLUMN_WORK,
    COMPARED_WORK, CROSSED_WORK, Cost, GROUP_WORK, LINE_WORK, SCAN_WORK, STALE_BOX_WORK,
    TEXEL_WORK, TILE_WORK, UNIFORM_WORK, VOXEL_WORK, WHOLE_MAP_COLUMN_WORK, work_on_intervals,
};
use super::extent::TexelBox;
use super::gradient::{GRADIENT_LEVEL, MAX_GRADIENT_BYTES};
use super::mips;
use super::rows::MAX_BOX;
use super::sizes::{LEVELS, MAX_CELL_DISTANCE, REACH, cell_side_texels};
use super::texels::{TexelChanges, TexelCube};
use super::textures::DensityField;
use super::window::MARGIN_X;
use crate::upload::{Region, Texture};

/// Granularity of the changes recorded for a line with a differing column.
#[derive(Clone, Copy)]
enum ChangeDetail {
    /// The hull of the voxels that differ.
    DifferingVoxels,
    /// All voxels of the line: faster, for the change of a whole map.
    WholeLines,
}

/// Columns along a side of the tiles whose changes share a box of stale texels.
const COMPARE_TILE: usize = 8;

impl<const N: usize, const K: usize> DensityField<N, K> {
    /// Records a tick's changes: copies the `dirty` columns of `maps`. No other column may differ from the
    /// maps noted before. The textures follow in [`DensityField::update_textures`].
    pub fn note_dirty_columns(&mut self, maps: &RangeMaps<N, K>, dirty: &DirtyRects) {
        let is_whole_map = |rect: &ColumnRect| {
            rect.first == (0, 0) && [rect.last.0, rect.last.1].map(usize::from) == [N - 1; 2]
        };
        let copied = Axis::ALL.iter().any(|&axis| dirty.rects(axis).iter().any(is_whole_map));
        if copied {
            self.noted.copy_from(maps);
            self.unbilled_work += 3 * N * N / 4;
        }
        for axis in Axis::ALL {
            for &ColumnRect { first, last } in dirty.rects(axis) {
                let places = Range::new(first.1.into(), last.1.into());
                for line in first.0.into()..=last.0.into() {
                    self.uncompared.mark_stale(axis, line, places);
                    if copied {
                        continue;
                    }
                    self.noted.copy_columns(maps, axis, line, places);
                    self.unbilled_work += LINE_WORK;
                }
            }
        }
    }

    /// Compares noted columns with those of the textures within the budget; if nothing was done
    /// yet, at least one line of tiles.
    fn compare_noted_columns(&mut self, meter: &mut BudgetMeter) {
        let tiles = COMPARE_TILE * N;
        while let Some(LineRun { axis, lines, places }) = self.uncompared.next_run(tiles) {
            let most = SCAN_WORK * N
                + work_on_intervals(CHANGED_COLUMN_WORK + COLUMN_WORK, K) * tiles
                + 2 * TILE_WORK * N / COMPARE_TILE;
            if !meter.allows_unit_of_work(Cost::of_work(most)) {
                return;
            }
            let lines = lines.start..lines.end.min(lines.start + COMPARE_TILE);
            self.uncompared.clear_lines(axis, lines.clone());
            let detail = match places == Range::new(0, N - 1) {
                true => ChangeDetail::WholeLines,
                false => ChangeDetail::DifferingVoxels,
            };
            let tile_lines = Range::new(lines.start, lines.end - 1);
            for place in (places.first()..=places.last()).step_by(COMPARE_TILE) {
                let last = (place + COMPARE_TILE - 1).min(places.last());
                self.compare_tile(axis, tile_lines, Range::new(place, last), detail);
            }
            let columns = lines.len() * (places.last() + 1 - places.first());
            let changes = std::mem::take(&mut self.unbilled_work);
            meter.finish_unit_of_work(Cost::of_work(
                SCAN_WORK * N + work_on_intervals(COLUMN_WORK, K) * columns + changes,
            ));
        }
    }

    /// Compares a tile of a map's columns, copies those that differ, and marks their texels stale.
    fn compare_tile(
        &mut self,
        axis: Axis,
        tile_lines: Range,
        tile_places: Range,
        detail: ChangeDetail,
    ) {
        let (first, last) = (tile_places.first(), tile_places.last());
        let (mut lines, mut places, mut voxels) = (Range::EMPTY, Range::EMPTY, Range::EMPTY);
        self.unbilled_work += TILE_WORK;
        for line in tile_lines.first()..=tile_lines.last() {
            let new = &self.noted.line(axis, line)[first..=last];
            let old = &self.maps.line(axis, line)[first..=last];
            if old == new {
                continue;
            }
            let mut differing = Range::EMPTY;
            let whole = matches!(detail, ChangeDetail::WholeLines);
            if whole {
                let hull = old.iter().zip(new).map(|(old, new)| old.hull().hull_with(new.hull()));
                voxels = hull.fold(voxels, Range::hull_with);
                differing = Range::new(0, new.len() - 1);
                self.unbilled_work += work_on_intervals(WHOLE_MAP_COLUMN_WORK, K) * new.len();
            }
            for (place, (old, new)) in old.iter().zip(new).enumerate().filter(|_| !whole) {
                if old != new {
                    differing = differing.hull_with(Range::new(place, place));
                    voxels = voxels.hull_with(difference_hull(*old, *new));
                    self.unbilled_work += work_on_intervals(CHANGED_COLUMN_WORK, K);
                }
            }
            let differing = Range::new(differing.first() + first, differing.last() + first);
            self.maps.copy_columns(&self.noted, axis, line, differing);
            self.stale_lines.mark_stale(axis, line, differing);
            lines = lines.hull_with(Range::new(line, line));
            places = places.hull_with(differing);
        }
        if !lines.is_empty() {
            let first_voxel = axis.voxel_at((lines.first(), places.first()), voxels.first());
            let last_voxel = axis.voxel_at((lines.last(), places.last()), voxels.last());
            self.backlog.mark_texels_around_voxels(first_voxel, last_voxel);
            self.unbilled_work += STALE_BOX_WORK;
        }
    }

    /// Updates the textures within the budget and passes each region that changed, with its bytes, to
    /// `sink`, maps first. At least one unit of work is done, so that any budget makes progress. The cells
    /// are conservative after each call: no distance is more than the present density's, and cells that the
    /// surface may pass through are 0.
    ///
    /// Returns an estimate of the cost.
    pub fn update_textures(
        &mut self,
        budget: Budget,
        sink: &mut impl FnMut(Region, &[u8]),
    ) -> Cost {
        let mut meter = BudgetMeter::new(budget);
        meter.spend(Cost::of_work(std::mem::take(&mut self.unbilled_work)));
        self.compare_noted_columns(&mut meter);
        let column_bytes = size_of::<Column<K>>();
        while let Some(run) = self.stale_lines.next_run(meter.remaining().bytes / column_bytes) {
            let region = map_region::<K>(&run);
            let cost =
                Cost { work: SCAN_WORK * N + region.byte_count(), bytes: region.byte_count() };
            if !meter.allows_unit_of_work(cost) {
                return meter.spent();
            }
            self.stale_lines.clear_lines(run.axis, run.lines);
            self.emit_map_region(run.axis, region, sink);
            meter.finish_unit_of_work(cost);
        }
        if self.gradients.waits_long() {
            self.recompute_gradients(&mut meter, sink);
        }
        // Waits until all columns are compared, so that no box is computed twice.
        if self.uncompared.is_empty() {
            self.recompute_stale_boxes(&mut meter, sink);
            self.recompute_gradients(&mut meter, sink);
        }
        self.gradients.count_frame();
        self.cells.update_distances();
        let (cells, stage) = (&mut self.cells, &mut self.staging);
        cells.drain_changed_boxes(|distances, changed| {
            meter.spend(Cost { work: 0, bytes: changed.volume() });
            emit_box(distances, changed, Texture::Cells, stage, sink);
        });
        meter.spent()
    }

    /// Recomputes stale boxes within the budget; at least one if nothing was done yet.
    fn recompute_stale_boxes(
        &mut self,
        meter: &mut BudgetMeter,
        sink: &mut impl FnMut(Region, &[u8]),
    ) {
        let mut affected = AffectedCells::new(self.level_side(0), cell_side_texels(N));
        while let Some(extent) = self.backlog.take_merged_box() {
            let cells = affected.including_texels(&extent).max_cost();
            let bytes = max_upload_bytes(&extent) + cells.bytes;
            let look = (VOXEL_WORK + 2 * (K - 1)) * count_window_voxels(&extent);
            let mut goes = meter.allows_unit_of_work(Cost { work: 2 * look + cells.work, bytes });
            if goes {
                // The loaded voxels give the number of groups to blur.
                self.blur.load_voxels(&self.maps, extent);
                meter.spend(Cost::of_work(look));
                let blur = UNIFORM_WORK * count_window_voxels(&extent)
                    + GROUP_WORK * self.blur.mixed_sixteen_count();
                let texels = TEXEL_WORK * extent.volume();
                goes = meter.allows_unit_of_work(Cost { work: blur + texels + cells.work, bytes });
                meter.spend(Cost::of_work(if goes { blur } else { 0 }));
            }
            if !goes {
                self.backlog.mark_texels(&extent);
                break;
            }
            let update = self.recompute_loaded_box(extent, sink);
            if !update.half_crossed.is_empty() {
                affected = affected.including_texels(&update.half_crossed);
            }
            meter.finish_unit_of_work(update.cost);
        }
        meter.spend(Cost::of_work(affected.max_cost().work));
    }

    /// Returns `true` if textures are stale or regions wait to be uploaded.
    #[must_use]
    pub fn has_pending(&self) -> bool {
        let boxes = !self.backlog.is_empty() || !self.gradients.stale.is_empty();
        boxes || !self.uncompared.is_empty() || !self.stale_lines.is_empty()
    }

    /// Recomputes the box of finest texels whose voxels are loaded, and what depends on those that
    /// change: mip levels and cells.
    fn recompute_loaded_box(
        &mut self,
        extent: TexelBox,
        sink: &mut impl FnMut(Region, &[u8]),
    ) -> BoxUpdate {
        self.blur.compute_texels();
        let mut changes = TexelChanges::new(extent.lo[0]);
        for (y, z) in extent.rows() {
            self.density[0].replace_row(y, z, self.blur.texel_row(y, z), &mut changes);
        }
        let (mut changed, half_crossed) = (changes.changed_box(), changes.half_crossed_box());
        if !half_crossed.is_empty() {
            self.cells.rescan_surface(&self.density[0], half_crossed);
        }
        let work = COMPARED_WORK * extent.volume()
            + CHANGED_WORK * changed.volume()
            + CROSSED_WORK * half_crossed.volume();
        let mut bytes = 0;
        for level in 0..LEVELS {
            if level > 0 && !changed.is_empty() {
                let (finer, coarser) = self.density.split_at_mut(level);
                let extent = changed.coarser_by(2);
                let changes = mips::downsample_box(&finer[level - 1], &mut coarser[0], extent);
                changed = changes.changed_box();
            }
            if changed.is_empty() {
                break;
            }
            if level == GRADIENT_LEVEL {
                self.gradients.mark_stale_around(&changed);
            }
            let texture = Texture::Density(level as u8);
            emit_box(&self.density[level], changed, texture, &mut self.staging, sink);
            bytes += changed.volume();
        }
        BoxUpdate { half_crossed, cost: Cost { work, bytes } }
    }

    fn emit_map_region(
        &mut self,
        axis: Axis,
        region: Region,
        sink: &mut impl FnMut(Region, &[u8]),
    ) {
        let [first, line, _] = region.min.map(|i| i as usize);
        let [places, lines, _] = region.size.map(|i| i as usize);
        self.staging.resize(region.byte_count(), 0);
        let texel = size_of::<Column<K>>();
        let rows = self.staging.chunks_exact_mut(texel * places);
        for (line, row) in (line..line + lines).zip(rows) {
            let columns = &self.maps.line(axis, line)[first..first + places];
            for (bytes, column) in row.chunks_exact_mut(texel).zip(columns) {
                bytes.copy_from_slice(column.to_bytes().as_flattened());
            }
        }
        sink(region, &self.staging);
    }

    /// Returns an upper bound of the bytes of any region that passes through the staging buffer.
    pub(super) const fn staging_capacity() -> usize {
        let (most, map) = (MAX_BOX, N * N * size_of::<Column<K>>());
        let chunk = most[0] * most[1] * most[2];
        let cells = (Self::SIDE / cell_side_texels(N)).pow(3);
        let most = if chunk > map { chunk } else { map };
        let most = if cells > most { cells } else { most };
        if MAX_GRADIENT_BYTES > most { MAX_GRADIENT_BYTES } else { most }
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

/// Returns the region of a map's texture that holds a run of lines.
fn map_region<const K: usize>(run: &LineRun) -> Region {
    let LineRun { axis, lines, places } = run;
    let min = [places.first() as u32, lines.start as u32, *axis as u32];
    let size = [(places.last() + 1 - places.first()) as u32, lines.len() as u32, 1];
    Region { texture: Texture::Maps(K as u8), min, size }
}

/// Returns the hull of the symmetric difference of two columns' voxels. The columns must differ.
fn difference_hull<const K: usize>(old: Column<K>, new: Column<K>) -> Range {
    let ranges = |column: Column<K>| column.ranges().into_iter().filter(|range| !range.is_empty());
    let first = match first_unequal(ranges(old), ranges(new)) {
        [Some(a), Some(b)] if a.first() == b.first() => a.last().min(b.last()) + 1,
        [a, b] => a.into_iter().chain(b).fold(255, |first, range| first.min(range.first())),
    };
    let last = match first_unequal(ranges(old).rev(), ranges(new).rev()) {
        [Some(a), Some(b)] if a.last() == b.last() => a.first().max(b.first()) - 1,
        [a, b] => a.into_iter().chain(b).fold(0, |last, range| last.max(range.last())),
    };
    Range::new(first, last)
}

/// Returns the first pair of ranges in which two columns differ; `None` for a column that has no more
/// ranges.
fn first_unequal(
    mut old: impl Iterator<Item = Range>,
    mut new: impl Iterator<Item = Range>,
) -> [Option<Range>; 2] {
    loop {
        let pair = [old.next(), new.next()];
        if pair[0] != pair[1] || pair[0].is_none() {
            return pair;
        }
    }
}

/// Bounds of the cells whose distances a frame's boxes may change.
#[derive(Clone, Copy)]
struct AffectedCells {
    density_side: usize,
    cell_side_texels: usize,
    bounds: TexelBox,
    /// Sum of the boxes' rows, overlaps included.
    rows: usize,
}

impl AffectedCells {
    const fn new(density_side: usize, cell_side_texels: usize) -> Self {
        AffectedCells { density_side, cell_side_texels, bounds: TexelBox::NONE, rows: 0 }
    }

    /// Returns the bounds, extended by the cells whose distances one more box of texels may change.
    fn including_texels(&self, extent: &TexelBox) -> Self {
        let cells = extent.grown_by(1, self.density_side).coarser_by(self.cell_side_texels);
        let cells_per_side = self.density_side / self.cell_side_texels;
        let cells = cells.grown_by(MAX_CELL_DISTANCE as usize - 1, cells_per_side);
        AffectedCells {
            bounds: self.bounds.union(&cells),
            rows: self.rows + cells.rows().count(),
            ..*self
        }
    }

    /// Returns upper bounds of the work and of the bytes uploaded.
    fn max_cost(&self) -> Cost {
        if self.rows == 0 {
            return Cost::NONE;
        }
        let [_, y, z] = self.bounds.size();
        Cost { work: CELL_ROW_WORK * self.rows.min(y * z), bytes: self.bounds.volume() }
    }
}

/// The outcome of a recomputed box: its cost, and what crossed a half.
struct BoxUpdate {
    /// The box of the texels that crossed a half.
    half_crossed: TexelBox,
    cost: Cost,
}

/// Counts the voxels that are loaded for a box of texels.
fn count_window_voxels(extent: &TexelBox) -> usize {
    let [x, y, z] = extent.size();
    (x + 2 * MARGIN_X) * (y + 2 * REACH) * (z + 2 * REACH)
}

/// Returns an upper bound of the bytes to upload for a box of the finest texels, all mip levels included.
fn max_upload_bytes(extent: &TexelBox) -> usize {
    (0..LEVELS).map(|level| extent.coarser_by(1 << level).volume()).sum()
}
