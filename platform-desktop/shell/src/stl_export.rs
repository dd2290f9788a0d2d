//! Incremental STL export: a bounded step after each tick turns a finished sculpture into the bytes of an STL
//! file. The exporter does not access files.

use paros_core::convert::{ExportPhase, HEIGHT_RANGE_MM, HeightOutOfRange};
use paros_core::volume::{BitGrid, BitSet, Grid, Size};
use paros_core::{Exporter, RangeMaps, World, WorldEvent};

/// The default height of an export, in millimetres.
pub const DEFAULT_HEIGHT_MM: f32 = 120.0;

/// Work units of the exporter in one [`StlExporter::advance_export_step`]: 0.2 ms of a desktop's thread on
/// average and 0.4 ms at most, so that a headset's thread can do it within a tick. The exports of the demo at
/// 128 and of a bunny at 256 take 20 and 120 steps.
pub const UNITS_PER_STEP: u32 = 2048;

/// The most bytes of one [`StlExporter::advance_export_step`], above what its units usually make.
pub const MAX_BYTES_PER_STEP: usize = 1 << 20;

/// Returns the scale of a print that is `model_height_mm` high, measured from its sculpture's lowest voxel to
/// the highest: millimetres of the print per millimetre of the room. Returns `None` without a voxel.
#[must_use]
#[inline(never)]
pub fn print_scale<const N: usize, const K: usize>(
    world: &World<N, K>,
    model_height_mm: f32,
) -> Option<f32>
where
    Grid<N>: Size,
{
    let rows = world.volume().rows();
    let is_occupied = |y: &usize| rows.layer(*y).iter().any(|row| row.first().is_some());
    let (lowest, highest) = ((0..N).find(is_occupied)?, (0..N).rev().find(is_occupied)?);
    let room_mm = (highest + 1 - lowest) as f32 * world.stool_frame().voxel_metres() * 1e3;
    Some(model_height_mm / room_mm)
}

/// The exporter and a copy of the voxels that it exports. It starts as all zero bytes, to live in a static.
pub struct StlBuffers<const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    /// Turns voxels into the bytes of an STL file.
    pub exporter: Exporter<N>,
    bit_grid: BitGrid<N>,
    mask: RangeMaps<N, K>,
}

/// A finished export.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FinishedStl {
    /// The bytes of the file.
    pub bytes: Vec<u8>,
    /// The number of triangles in the file; 0 if there were no voxels to print.
    pub triangle_count: u32,
}

/// Makes STL files, one at a time. It works on a copy of the voxels, so that a new session may begin during
/// the export of the last one's sculpture.
pub struct StlExporter<'a, const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    buffers: &'a mut StlBuffers<N, K>,
    model_height_mm: f32,
    /// The bytes so far of the current export; `None` if there is none.
    stl: Option<Vec<u8>>,
}

impl<const N: usize, const K: usize> StlBuffers<N, K>
where
    Grid<N>: Size,
{
    /// Creates empty buffers. For static initialisers only, as they are large.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the buffers about by value
    pub const fn new() -> Self {
        StlBuffers { exporter: Exporter::new(), bit_grid: BitGrid::new(), mask: RangeMaps::new() }
    }
}

impl<'a, const N: usize, const K: usize> StlExporter<'a, N, K>
where
    Grid<N>: Size,
{
    /// Creates an exporter for models `model_height_mm` millimetres high.
    ///
    /// # Errors
    /// Returns an error for a height outside [`HEIGHT_RANGE_MM`].
    pub fn new(
        buffers: &'a mut StlBuffers<N, K>,
        model_height_mm: f32,
    ) -> Result<Self, HeightOutOfRange> {
        match HEIGHT_RANGE_MM.contains(&model_height_mm) {
            true => Ok(StlExporter { buffers, model_height_mm, stl: None }),
            false => Err(HeightOutOfRange(model_height_mm)),
        }
    }

    /// Creates an exporter for models of [`DEFAULT_HEIGHT_MM`].
    pub const fn of_default_height(buffers: &'a mut StlBuffers<N, K>) -> Self {
        StlExporter { buffers, model_height_mm: DEFAULT_HEIGHT_MM, stl: None }
    }

    /// Begins an export if the tick finished the session; otherwise advances the current one. Call it after
    /// every tick. Returns each file once, when it is finished. If a session ends before the last export is
    /// finished, that export is run to its end at once, and its file is returned.
    #[must_use = "a file is handed out once"]
    pub fn begin_if_finished_or_advance(&mut self, world: &World<N, K>) -> Option<FinishedStl> {
        if !world.events().contains(&WorldEvent::Finished) {
            return self.advance_export_step();
        }
        let last = self.run_export_to_end();
        self.begin_export(world.volume().rows(), world.mask());
        last
    }

    /// Begins an export of these voxels and the mask that supports some of them (empty for no mask). Drops
    /// the current export.
    #[inline(never)]
    pub fn begin_export(&mut self, bit_grid: &BitGrid<N>, mask: &RangeMaps<N, K>) {
        self.buffers.bit_grid.copy_from(bit_grid);
        self.buffers.mask.copy_from(mask);
        let started = self.buffers.exporter.start_export(self.model_height_mm);
        self.stl = started.is_ok().then(Vec::new);
    }

    /// Advances the current export by [`UNITS_PER_STEP`] units or [`MAX_BYTES_PER_STEP`] bytes. Returns the
    /// file once it is finished.
    #[must_use = "a file is handed out once"]
    #[inline(never)]
    pub fn advance_export_step(&mut self) -> Option<FinishedStl> {
        let stl = self.stl.as_mut()?;
        let StlBuffers { exporter, bit_grid, mask } = &mut *self.buffers;
        let made = stl.len();
        let left = exporter.file_len().map_or(MAX_BYTES_PER_STEP, |len| len as usize - made);
        stl.reserve_exact(left);
        stl.resize(made + left.min(MAX_BYTES_PER_STEP), 0);
        let progress = exporter.advance_export(bit_grid, mask, UNITS_PER_STEP, &mut stl[made..]);
        stl.truncate(made + progress.written);
        if progress.phase != ExportPhase::Done {
            return None;
        }
        let triangles = exporter.triangles().unwrap_or(0);
        self.stl.take().map(|bytes| FinishedStl { bytes, triangle_count: triangles })
    }

    /// Runs the current export to its end. Returns `None` if there is none.
    #[must_use = "a file is handed out once"]
    pub fn run_export_to_end(&mut self) -> Option<FinishedStl> {
        while self.is_busy() {
            if let Some(finished) = self.advance_export_step() {
                return Some(finished);
            }
        }
        None
    }

    /// Returns the height of its models, in millimetres.
    #[must_use]
    pub const fn model_height_mm(&self) -> f32 {
        self.model_height_mm
    }

    /// Returns `true` during an export.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.stl.is_some()
    }

    /// Returns the finished fraction of the current export, 0 to 1; 1 if there is none. It stays 0 at first,
    /// as the file's length is known only after all voxels have been scanned.
    #[must_use]
    pub fn part_made(&self) -> f32 {
        let Some(stl) = &self.stl else { return 1.0 };
        let len = self.buffers.exporter.file_len();
        len.map_or(0.0, |len| stl.len() as f32 / (len.max(1)) as f32)
    }

    /// Returns the number of bytes made so far of the current export; 0 if there is none.
    #[must_use]
    pub fn bytes_made(&self) -> usize {
        self.stl.as_ref().map_or(0, Vec::len)
    }
}

#[cfg(test)]
mod tests {
    use paros_core::TickInput;
    use paros_core::limits::INTERVALS;
    use paros_core::session::SessionMode;

    use super::*;
    use crate::statics::Resident;
    use crate::tick_runner::with_fresh_world;

    /// The toy isn't as high as the box, so its width shows the scale.
    #[test]
    fn the_scale_is_that_of_the_print() {
        with_fresh_world::<128, INTERVALS, _>(|mut runner| {
            runner.run_tick(&TickInput { start: SessionMode::Creative, ..TickInput::default() });
            let world = runner.world();
            let rows = world.volume().rows();
            let all_rows = (0..128).flat_map(|y| (0..128).map(move |z| rows.row(y, z)));
            let ends = all_rows.filter_map(|row| Some((row.first()?, row.last()?)));
            let (first, last) = ends.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).expect("a toy");
            let room_mm = (last + 1 - first) as f32 * world.stool_frame().voxel_metres() * 1e3;
            let mut stl_buffers = <Grid<128> as Resident<128, INTERVALS>>::lock_stl_buffers();
            let mut exporter = StlExporter::of_default_height(&mut stl_buffers);
            exporter.begin_export(rows, world.mask());
            let stl = exporter.run_export_to_end().expect("a print").bytes;
            let corner = |at: &[u8]| f32::from_le_bytes([at[0], at[1], at[2], at[3]]);
            let across = stl[84..]
                .chunks_exact(50)
                .flat_map(|triangle| [12, 24, 36].map(|at| corner(&triangle[at..])));
            let (low, high) =
                across.fold((f32::MAX, f32::MIN), |(low, high), x| (low.min(x), high.max(x)));
            let scale = print_scale(world, DEFAULT_HEIGHT_MM).expect("voxels");
            let error = (high - low) / (room_mm * scale) - 1.0;
            assert!(error.abs() < 0.04, "{scale}: {} mm for {room_mm}", high - low);
        });
    }
}
