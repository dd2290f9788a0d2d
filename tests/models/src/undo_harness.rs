//! Test harness of the undo ring: a volume with its history. Every undo and redo is checked against a replay
//! of the dirty rectangles.

use glam::IVec3;
use paros_core::codec::ByteReader;
use paros_core::edit::{BrushTooLarge, EditOperation, EditReport, EditScratch, SUBUNITS_PER_VOXEL};
use paros_core::internals::{IslandSearch, UndoHistory, maps_digest};
use paros_core::volume::{Axis, BitGrid, Column, DirtyRects, Grid, Journal, Size};
use paros_core::{Brush, Edit, RangeMaps, Volume, apply_edit};
use proptest::prelude::*;

use crate::save_to_bytes;
use crate::undo::SnapshotHistory;

/// A volume with its undo ring, and the scratch memory of edits and islands.
pub struct UndoHarness<const N: usize>
where
    Grid<N>: Size,
{
    /// The edited volume.
    pub volume: Volume<N>,
    none: RangeMaps<N>,
    islands: IslandSearch<N>,
    scratch: EditScratch<N>,
    /// The volume's undo ring.
    pub undo: UndoHistory<N>,
    spare: UndoHistory<N>,
    plane: BitGrid<N>,
    stale: RangeMaps<N>,
}

impl<const N: usize> UndoHarness<N>
where
    Grid<N>: Size,
{
    /// Creates an empty volume without history; `const` for statics.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the volume about by value
    pub const fn new() -> Self {
        UndoHarness {
            volume: Volume::new(),
            none: RangeMaps::new(),
            islands: IslandSearch::new(),
            scratch: EditScratch::new(),
            undo: UndoHistory::new(),
            spare: UndoHistory::new(),
            plane: BitGrid::new(),
            stale: RangeMaps::new(),
        }
    }

    /// Resets the volume to a block on the ground, with no history. Returns the model's history of it.
    pub fn reset_to_block(&mut self) -> SnapshotHistory<N> {
        self.volume.set_voxels(|plane| {
            for y in 0..N * 3 / 4 {
                plane.layer_mut(y)[2..N - 2].fill(Grid::<N>::FULL);
            }
        });
        self.undo.clear();
        self.islands.cancel_passes();
        SnapshotHistory::new(self.volume.maps())
    }

    /// Applies an edit, which the ring records.
    ///
    /// # Errors
    /// The core rejects the edit.
    pub fn apply_edit(
        &mut self,
        brush: &Brush,
        operation: EditOperation,
    ) -> Result<EditReport, BrushTooLarge> {
        let edit = Edit { brush, operation, mirrored: false };
        let mut log = UndoJournal { undo: &mut self.undo, late: false };
        let scratch = &mut self.scratch;
        apply_edit(&mut self.volume, &self.none, &edit, scratch, &mut log)
    }

    /// Runs a whole island pass, whose removals amend the newest stroke.
    pub fn clear_islands(&mut self) {
        self.islands.request_pass();
        let mut log = UndoJournal { undo: &mut self.undo, late: true };
        self.islands.advance_pass(&mut self.volume, &self.none, u32::MAX, &mut log);
    }

    /// Checks that the volume equals `expected`, and that its rows and its digest match.
    ///
    /// # Errors
    /// A check failed.
    pub fn check_volume_equals(&mut self, expected: &RangeMaps<N>) -> Result<(), TestCaseError> {
        prop_assert!(self.volume.maps() == expected, "the maps differ");
        self.plane.set_from_maps(expected);
        prop_assert!(self.volume.rows() == &self.plane, "the rows differ");
        prop_assert_eq!(self.volume.digest(), maps_digest(expected));
        Ok(())
    }

    /// Round trip: saves the ring, loads it into another ring and saves that. Bytes and digest must be equal.
    ///
    /// # Errors
    /// A check failed.
    pub fn check_save_round_trip(&mut self) -> Result<(), TestCaseError> {
        prop_assert_eq!(self.undo.digest(), self.undo.recompute_digest());
        let bytes = save_to_bytes(|out| self.undo.save(out));
        let mut reader = ByteReader::new(&bytes);
        prop_assert_eq!(self.spare.load(&mut reader), Ok(()));
        prop_assert_eq!(reader.expect_end(), Ok(()));
        prop_assert_eq!(self.spare.digest(), self.undo.digest());
        prop_assert_eq!(save_to_bytes(|out| self.spare.save(out)), bytes);
        std::mem::swap(&mut self.undo, &mut self.spare);
        Ok(())
    }

    /// Undoes a stroke, if there is one. Checks that the dirty rectangles turn the old maps into the new
    /// ones.
    ///
    /// # Errors
    /// A check failed.
    pub fn try_undo_checked(&mut self) -> Result<bool, TestCaseError> {
        self.try_step_checked(UndoHistory::try_undo)
    }

    /// Redoes a stroke, if there is one, with the same check as an undo.
    ///
    /// # Errors
    /// A check failed.
    pub fn try_redo_checked(&mut self) -> Result<bool, TestCaseError> {
        self.try_step_checked(UndoHistory::try_redo)
    }

    fn try_step_checked(
        &mut self,
        try_step: impl FnOnce(&mut UndoHistory<N>, &mut Volume<N>, &mut DirtyRects) -> bool,
    ) -> Result<bool, TestCaseError> {
        let mut dirty = DirtyRects::new();
        self.stale.copy_from(self.volume.maps());
        let stepped = try_step(&mut self.undo, &mut self.volume, &mut dirty);
        for axis in Axis::ALL {
            for rect in dirty.rects(axis) {
                for line in rect.first.0..=rect.last.0 {
                    for place in rect.first.1..=rect.last.1 {
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

/// The time at which islands are cleared after a stroke.
#[derive(Clone, Copy, Debug)]
pub enum IslandClearing {
    /// Never.
    Never,
    /// When the stroke ends.
    AtEnd,
    /// When the next stroke has begun, but hasn't changed anything.
    Late,
}

/// One edit of a stroke, with a sphere.
#[derive(Clone, Debug)]
pub struct SphereEdit {
    /// The voxel at the sphere's centre.
    pub at: [i32; 3],
    /// The radius in half voxels.
    pub radius: i32,
    /// `true` to fill, `false` to carve.
    pub fill: bool,
}

impl SphereEdit {
    fn brush(&self) -> Brush {
        let centre = self.at.map(|i| i * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2);
        Brush::sphere(IVec3::from_array(centre), self.radius * SUBUNITS_PER_VOXEL / 2)
    }

    fn operation(&self) -> EditOperation {
        if self.fill { EditOperation::Fill { depth: 3 } } else { EditOperation::Carve { depth: 4 } }
    }
}

/// Applies a stroke of these edits, and appends it to `history` if it changed the volume.
pub fn apply_stroke<const N: usize>(
    harness: &mut UndoHarness<N>,
    history: &mut SnapshotHistory<N>,
    edits: &[SphereEdit],
    clearing: IslandClearing,
) where
    Grid<N>: Size,
{
    harness.undo.begin_stroke();
    let mut changed = false;
    for touch in edits {
        let report = harness.apply_edit(&touch.brush(), touch.operation());
        changed |= report.is_ok_and(|report| report.changed_volume());
    }
    if changed {
        match clearing {
            IslandClearing::Never => {}
            IslandClearing::AtEnd => harness.clear_islands(),
            IslandClearing::Late => {
                harness.undo.begin_stroke();
                harness.clear_islands();
            }
        }
        history.push_state(harness.volume.maps());
    }
}

/// The journal of an edit, which records columns in the ring. A late removal amends the newest entry.
struct UndoJournal<'a, const N: usize>
where
    Grid<N>: Size,
{
    undo: &'a mut UndoHistory<N>,
    late: bool,
}

impl<const N: usize> Journal<N> for UndoJournal<'_, N>
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        (old, _): (&[Column; N], &[Column; N]),
    ) {
        match self.late {
            true => self.undo.record_into_newest_entry(axis, line, places, old),
            false => self.undo.record_columns(axis, line, places, old),
        }
    }

    fn record_added(&mut self, _: (usize, usize), _: <Grid<N> as Size>::Row) {}
}
