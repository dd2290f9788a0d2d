//! Incremental STL export: after each tick a bounded piece of work turns a finished sculpture into
//! the bytes of an STL file. It knows no files.

use paros_core::{
    BitGrid, ExportPhase, Exporter, Grid, HEIGHT_RANGE_MM, HeightOutOfRange, RangeMaps, Size,
    World, WorldEvent,
};

/// The default height of a print, in millimetres.
pub const DEFAULT_HEIGHT_MM: f32 = 120.0;

/// Work units of the exporter in one [`StlPrinter::advance_print`]: 0.2 ms of a desktop's thread in the mean
/// and 0.4 at most, so that a headset's has room for it in a tick. The prints of the demo at 128 and
/// of a bunny at 256 take 20 and 120 of them.
pub const UNITS_PER_STEP: u32 = 2048;

/// Bytes that one [`StlPrinter::advance_print`] makes at the most, above what its units usually make.
pub const MAX_BYTES_PER_STEP: usize = 1 << 20;

/// The exporter and a copy of the voxels it prints. All zero bytes at first: it lives in a static.
pub struct PrintBuffers<const N: usize>
where
    Grid<N>: Size,
{
    /// Turns voxels into the bytes of an STL file.
    pub exporter: Exporter<N>,
    rows: BitGrid<N>,
    mask: RangeMaps<N>,
}

/// A finished print.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FinishedPrint {
    /// The bytes of the STL file.
    pub stl: Vec<u8>,
    /// Triangles in it; 0 if there were no voxels to print.
    pub triangle_count: u32,
}

/// Makes prints, one at a time. It works on a copy of the voxels, so that a new session may begin
/// while the last one's sculpture is printed.
pub struct StlPrinter<'a, const N: usize>
where
    Grid<N>: Size,
{
    press: &'a mut PrintBuffers<N>,
    height_mm: f32,
    /// The bytes so far of the print under way; `None` at rest.
    stl: Option<Vec<u8>>,
}

impl<const N: usize> PrintBuffers<N>
where
    Grid<N>: Size,
{
    /// Empty buffers. For static initialisers only: they are large.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the press about by value
    pub const fn new() -> Self {
        PrintBuffers { exporter: Exporter::new(), rows: BitGrid::new(), mask: RangeMaps::new() }
    }
}

impl<'a, const N: usize> StlPrinter<'a, N>
where
    Grid<N>: Size,
{
    /// A printer at rest, for prints `height_mm` millimetres high.
    ///
    /// # Errors
    /// A height outside [`HEIGHT_RANGE_MM`].
    pub fn new(press: &'a mut PrintBuffers<N>, height_mm: f32) -> Result<Self, HeightOutOfRange> {
        match HEIGHT_RANGE_MM.contains(&height_mm) {
            true => Ok(StlPrinter { press, height_mm, stl: None }),
            false => Err(HeightOutOfRange(height_mm)),
        }
    }

    /// Begins a print if the tick finished the session, else advances the one under way. Call it after
    /// every tick. Returns each print once, when it is finished. Where a session ends before the last
    /// one's print is finished, that print is finished at once and returned.
    #[must_use = "a print is handed out once"]
    pub fn advance_after_tick(&mut self, world: &World<N>) -> Option<FinishedPrint> {
        if !world.events().contains(&WorldEvent::Finished) {
            return self.advance_print();
        }
        let last = self.finish_print();
        self.begin_print(world.volume().rows(), world.mask());
        last
    }

    /// Begins a print of these voxels and the mask that supports some of them (empty for none). A
    /// print under way is dropped.
    pub fn begin_print(&mut self, rows: &BitGrid<N>, mask: &RangeMaps<N>) {
        self.press.rows.copy_from(rows);
        self.press.mask.copy_from(mask);
        let started = self.press.exporter.start_export(self.height_mm);
        self.stl = started.is_ok().then(Vec::new);
    }

    /// Works on the print under way, [`UNITS_PER_STEP`] units or [`MAX_BYTES_PER_STEP`] bytes. Returns the
    /// print once it is finished.
    #[must_use = "a print is handed out once"]
    pub fn advance_print(&mut self) -> Option<FinishedPrint> {
        let stl = self.stl.as_mut()?;
        let PrintBuffers { exporter, rows, mask } = &mut *self.press;
        let made = stl.len();
        let left = exporter.file_len().map_or(MAX_BYTES_PER_STEP, |len| len as usize - made);
        stl.reserve_exact(left);
        stl.resize(made + left.min(MAX_BYTES_PER_STEP), 0);
        let progress = exporter.advance_export(rows, mask, UNITS_PER_STEP, &mut stl[made..]);
        stl.truncate(made + progress.written);
        if progress.phase != ExportPhase::Done {
            return None;
        }
        let triangles = exporter.triangles().unwrap_or(0);
        self.stl.take().map(|stl| FinishedPrint { stl, triangle_count: triangles })
    }

    /// Runs the print under way to its end; `None` if there is none.
    #[must_use = "a print is handed out once"]
    pub fn finish_print(&mut self) -> Option<FinishedPrint> {
        while self.is_busy() {
            if let Some(print) = self.advance_print() {
                return Some(print);
            }
        }
        None
    }

    /// Whether a print is under way.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.stl.is_some()
    }

    /// Bytes made so far of the print under way; 0 at rest.
    #[must_use]
    pub fn bytes_made(&self) -> usize {
        self.stl.as_ref().map_or(0, Vec::len)
    }
}
