//! Prints: a finished sculpture becomes the bytes of an STL file, a bounded piece of work at each
//! tick, while the shell goes on ticking and drawing.

use paros_core::events::Event;
use paros_core::export::{Exporter, HEIGHTS_MM, HeightOutOfRange, Stage};
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_core::world::World;

/// The usual height of a print, in millimetres.
pub const HEIGHT_MM: f32 = 120.0;

/// Work units of the exporter in one [`Printer::advance`]: 0.2 ms of a desktop's thread in the mean
/// and 0.4 at most, so that a headset's has room for it in a tick. The prints of the demo at 128 and
/// of a bunny at 256 take 20 and 120 of them.
pub const BUDGET: u32 = 2048;

/// Bytes that one [`Printer::advance`] makes at the most, above what its units usually make.
pub const ROOM: usize = 1 << 20;

/// What a printer works on. All zero bytes at first: it lives in a static.
pub struct Press<const N: usize>
where
    Grid<N>: Size,
{
    /// Makes the bytes.
    pub exporter: Exporter<N>,
    rows: Plane<N>,
    mask: Maps<N>,
}

/// A whole print.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Print {
    /// The bytes of the file.
    pub stl: Vec<u8>,
    /// Triangles in it. None at all means that there was nothing to print.
    pub triangles: u32,
}

/// Makes prints on a press, one at a time. It keeps the voxels aside, so a new session may begin
/// while the last one's sculpture is printed.
pub struct Printer<'a, const N: usize>
where
    Grid<N>: Size,
{
    press: &'a mut Press<N>,
    height_mm: f32,
    /// What is made of the print under way.
    stl: Option<Vec<u8>>,
}

impl<const N: usize> Press<N>
where
    Grid<N>: Size,
{
    /// At rest. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the press about by value
    pub const fn new() -> Self {
        Press { exporter: Exporter::new(), rows: Plane::new(), mask: Maps::new() }
    }
}

impl<'a, const N: usize> Printer<'a, N>
where
    Grid<N>: Size,
{
    /// At rest, for prints `height_mm` high.
    ///
    /// # Errors
    /// A height outside [`HEIGHTS_MM`].
    pub fn new(press: &'a mut Press<N>, height_mm: f32) -> Result<Self, HeightOutOfRange> {
        match HEIGHTS_MM.contains(&height_mm) {
            true => Ok(Printer { press, height_mm, stl: None }),
            false => Err(HeightOutOfRange(height_mm)),
        }
    }

    /// To be called after every tick: begins where the session is finished, and goes on. The print
    /// is handed out once, when it is whole. A session that is finished before the last one's print
    /// is made has that made at once.
    #[must_use = "a print is handed out once"]
    pub fn tick(&mut self, world: &World<N>) -> Option<Print> {
        if !world.events().contains(&Event::Finished) {
            return self.advance();
        }
        let last = self.complete();
        self.begin(world.volume().rows(), world.mask());
        last
    }

    /// Begins a print of these voxels and the mask that supports some of them (empty for none). One
    /// under way is dropped.
    pub fn begin(&mut self, rows: &Plane<N>, mask: &Maps<N>) {
        self.press.rows.copy_from(rows);
        self.press.mask.copy_from(mask);
        let started = self.press.exporter.start(self.height_mm);
        self.stl = started.is_ok().then(Vec::new);
    }

    /// Goes on by [`BUDGET`] units of work or [`ROOM`] bytes; the print, once it is whole.
    #[must_use = "a print is handed out once"]
    pub fn advance(&mut self) -> Option<Print> {
        let stl = self.stl.as_mut()?;
        let Press { exporter, rows, mask } = &mut *self.press;
        let made = stl.len();
        let left = exporter.file_len().map_or(ROOM, |len| len as usize - made);
        stl.reserve_exact(left);
        stl.resize(made + left.min(ROOM), 0);
        let progress = exporter.advance(rows, mask, BUDGET, &mut stl[made..]);
        stl.truncate(made + progress.written);
        if progress.stage != Stage::Done {
            return None;
        }
        let triangles = exporter.triangles().unwrap_or(0);
        self.stl.take().map(|stl| Print { stl, triangles })
    }

    /// Does all that is left of the print under way.
    #[must_use = "a print is handed out once"]
    pub fn complete(&mut self) -> Option<Print> {
        while self.is_busy() {
            if let Some(print) = self.advance() {
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

    /// Bytes of the print under way that are made.
    #[must_use]
    pub fn made(&self) -> usize {
        self.stl.as_ref().map_or(0, Vec::len)
    }
}
