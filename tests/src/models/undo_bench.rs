//! A volume whose strokes are undone and redone under test.

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::codec::Reader;
use paros_core::dirty::Dirty;
use paros_core::edit::{self, Edit, EditScratch, Operation};
use paros_core::islands::Islands;
use paros_core::maps::{Axis, Column, Maps};
use paros_core::plane::Plane;
use paros_core::pose::SUB;
use paros_core::size::{Grid, Size};
use paros_core::undo::Undo;
use paros_core::volume::{Journal, Volume, maps_digest};
use proptest::prelude::*;

use super::saved;
use super::undo::History;

/// A volume with its undo ring, and what edits and islands need.
pub struct Bench<const N: usize>
where
    Grid<N>: Size,
{
    /// What is edited.
    pub volume: Volume<N>,
    none: Maps<N>,
    islands: Islands<N>,
    scratch: EditScratch<N>,
    /// Its history.
    pub undo: Undo<N>,
    spare: Undo<N>,
    plane: Plane<N>,
    stale: Maps<N>,
}

impl<const N: usize> Bench<N>
where
    Grid<N>: Size,
{
    /// Nothing at all. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the volume about by value
    pub const fn new() -> Self {
        Bench {
            volume: Volume::new(),
            none: Maps::new(),
            islands: Islands::new(),
            scratch: EditScratch::new(),
            undo: Undo::new(),
            spare: Undo::new(),
            plane: Plane::new(),
            stale: Maps::new(),
        }
    }

    /// A block on the ground, and no history.
    pub fn reset(&mut self) -> History<N> {
        self.volume.set_voxels(|plane| {
            for y in 0..N * 3 / 4 {
                plane.layer_mut(y)[2..N - 2].fill(Grid::<N>::FULL);
            }
        });
        self.undo.clear();
        self.islands.abort();
        History::new(self.volume.maps())
    }

    /// Applies an edit; whether the volume changed.
    pub fn edit(&mut self, brush: &Brush, operation: Operation) -> bool {
        let edit = Edit { brush, operation, mirrored: false };
        let mut log = Log { undo: &mut self.undo, late: false };
        let scratch = &mut self.scratch;
        let report = edit::apply(&mut self.volume, &self.none, &edit, scratch, &mut log);
        report.is_ok_and(|report| report.changed())
    }

    /// Clears islands at once; whether some went.
    pub fn clear_islands(&mut self) -> bool {
        self.islands.edited();
        let mut log = Log { undo: &mut self.undo, late: true };
        let report = self.islands.advance(&mut self.volume, &self.none, u32::MAX, &mut log);
        report.is_some_and(|report| report.removed > 0)
    }

    /// The volume is exactly that of `maps`, and all that is kept up beside it is right.
    ///
    /// # Errors
    /// What isn't so.
    pub fn check(&mut self, maps: &Maps<N>) -> Result<(), TestCaseError> {
        prop_assert!(self.volume.maps() == maps, "the maps differ");
        self.plane.expand(maps);
        prop_assert!(self.volume.rows() == &self.plane, "the rows differ");
        prop_assert_eq!(self.volume.digest(), maps_digest(maps));
        Ok(())
    }

    /// Saved, read into another ring and saved again: the same bytes and digest.
    ///
    /// # Errors
    /// What isn't so.
    pub fn check_saved(&mut self) -> Result<(), TestCaseError> {
        prop_assert_eq!(self.undo.digest(), self.undo.recompute_digest());
        let bytes = saved(|out| self.undo.save(out));
        let mut reader = Reader::new(&bytes);
        prop_assert_eq!(self.spare.load(&mut reader), Ok(()));
        prop_assert_eq!(reader.end(), Ok(()));
        prop_assert_eq!(self.spare.digest(), self.undo.digest());
        prop_assert_eq!(saved(|out| self.spare.save(out)), bytes);
        std::mem::swap(&mut self.undo, &mut self.spare);
        Ok(())
    }

    /// Undoes or redoes; the dirty rectangles must turn the old maps into the new ones.
    ///
    /// # Errors
    /// What isn't so.
    pub fn step(&mut self, back: bool) -> Result<bool, TestCaseError> {
        let mut dirty = Dirty::new();
        self.stale.copy_from(self.volume.maps());
        let stepped = match back {
            true => self.undo.undo(&mut self.volume, &mut dirty),
            false => self.undo.redo(&mut self.volume, &mut dirty),
        };
        for axis in Axis::ALL {
            for rect in dirty.rects(axis) {
                for line in rect.lo.0..=rect.hi.0 {
                    for place in rect.lo.1..=rect.hi.1 {
                        let at = (line.into(), place.into());
                        self.stale.set_column(axis, at, self.volume.maps().column(axis, at));
                    }
                }
            }
        }
        prop_assert!(self.stale == *self.volume.maps(), "a dirty rectangle is missing");
        prop_assert!(stepped || dirty.is_empty());
        Ok(stepped)
    }
}

/// When islands are cleared after a stroke.
#[derive(Clone, Copy, Debug)]
pub enum Clear {
    /// Not at all.
    Never,
    /// When it ends.
    AtEnd,
    /// When the next stroke has begun, but not changed anything.
    Late,
}

/// One edit of a stroke.
#[derive(Clone, Debug)]
pub struct Touch {
    /// The voxel in its middle.
    pub at: [i32; 3],
    /// In half voxels.
    pub radius: i32,
    /// Else it carves.
    pub fill: bool,
}

impl Touch {
    fn brush(&self) -> Brush {
        let centre = self.at.map(|i| i * SUB + SUB / 2);
        Brush::sphere(IVec3::from_array(centre), self.radius * SUB / 2)
    }

    fn operation(&self) -> Operation {
        if self.fill { Operation::Fill { depth: 3 } } else { Operation::Carve { depth: 4 } }
    }
}

/// A stroke of these edits, kept in `history` too if it changed anything.
pub fn stroke<const N: usize>(
    bench: &mut Bench<N>,
    history: &mut History<N>,
    edits: &[Touch],
    clear: Clear,
) where
    Grid<N>: Size,
{
    bench.undo.begin_stroke();
    let mut changed = false;
    for touch in edits {
        changed |= bench.edit(&touch.brush(), touch.operation());
    }
    if changed {
        match clear {
            Clear::Never => {}
            Clear::AtEnd => _ = bench.clear_islands(),
            Clear::Late => {
                bench.undo.begin_stroke();
                bench.clear_islands();
            }
        }
        history.push(bench.volume.maps());
    }
}

/// Records an edit in the ring, or adds a removal to its newest entry.
struct Log<'a, const N: usize>
where
    Grid<N>: Size,
{
    undo: &'a mut Undo<N>,
    late: bool,
}

impl<const N: usize> Journal<N> for Log<'_, N>
where
    Grid<N>: Size,
{
    fn columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        match self.late {
            true => self.undo.amend(axis, line, places, old),
            false => self.undo.record(axis, line, places, old),
        }
    }

    fn added(&mut self, _: (usize, usize), _: <Grid<N> as Size>::Row) {}
}
