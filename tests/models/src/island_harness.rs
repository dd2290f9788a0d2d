//! Test harness of island removal: a volume, its mask and a pass. Each tick is checked against its journal.

use glam::IVec3;
use paros_core::edit::{EditOperation, EditScratch, IslandReport, SUBUNITS_PER_VOXEL};
use paros_core::internals::{ColumnAddress, IslandSearch, RowAddress, maps_digest};
use paros_core::volume::{Axis, BitSet, Column, Grid, Journal, Size};
use paros_core::{Brush, Edit, RangeMaps, Volume, apply_edit};
use proptest::prelude::*;

use crate::dense::{DenseVolume, MaskedVolume, closed_volumes_with_inner_mask};

/// A volume with its mask and island pass, and the scratch memory of edits.
pub struct IslandHarness<const N: usize>
where
    Grid<N>: Size,
{
    /// The volume that is edited and cleared.
    pub volume: Volume<N>,
    /// The part of `volume` that is never removed.
    pub mask: RangeMaps<N>,
    /// The island search.
    pub islands: IslandSearch<N>,
    scratch: EditScratch<N>,
    spare: RangeMaps<N>,
}

impl<const N: usize> IslandHarness<N>
where
    Grid<N>: Size,
{
    /// Creates an empty volume; `const` for statics.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the volume about by value
    pub const fn new() -> Self {
        IslandHarness {
            volume: Volume::new(),
            mask: RangeMaps::new(),
            islands: IslandSearch::new(),
            scratch: EditScratch::new(),
            spare: RangeMaps::new(),
        }
    }

    /// Sets volume and mask, and aborts the pass.
    pub fn set_volume(&mut self, volume: &DenseVolume, mask: &DenseVolume) {
        self.volume.set_voxels(|bits| volume.insert_into_empty_bits(bits));
        mask.write_maps(&mut self.mask);
        self.islands.cancel_passes();
    }

    /// Returns the volume as the model's set of voxels.
    #[must_use]
    pub fn to_dense(&self) -> DenseVolume {
        DenseVolume::from_bits(self.volume.rows())
    }

    /// Advances the pass by a tick of `max_row_visits`. Checks that the journal contains exactly the changed
    /// columns with their old values, that nothing is added, that the maps are tight and the digests right.
    /// Returns the report at the pass's end.
    ///
    /// # Errors
    /// A check failed.
    pub fn advance_checked(
        &mut self,
        max_row_visits: u32,
    ) -> Result<Option<IslandReport>, TestCaseError> {
        self.spare.copy_from(self.volume.maps());
        let mut changes = JournalledChanges::default();
        let report =
            self.islands.advance_pass(&mut self.volume, &self.mask, max_row_visits, &mut changes);
        prop_assert!(changes.added.is_empty(), "an island pass adds nothing");
        for (axis, at, old) in changes.columns {
            prop_assert_eq!(self.spare.column(axis, at), old, "told once, with the old value");
            let new = self.volume.maps().column(axis, at);
            prop_assert!(new != old, "told without a change");
            self.spare.set_column(axis, at, new);
        }
        prop_assert!(self.spare == *self.volume.maps(), "a change wasn't told");
        prop_assert_eq!(self.islands.digest(), self.islands.recompute_digest());
        if report.is_some() {
            prop_assert_eq!(self.volume.digest(), maps_digest(self.volume.maps()));
            self.check_closed()?;
        }
        Ok(report)
    }

    /// Checks that the rows are the intersection of the maps, and that every range is tight.
    ///
    /// # Errors
    /// A check failed.
    pub fn check_closed(&mut self) -> Result<(), TestCaseError> {
        let dense = self.to_dense();
        prop_assert!(dense == DenseVolume::from_maps(self.volume.maps()), "rows and maps differ");
        dense.write_maps(&mut self.spare);
        prop_assert!(self.spare == *self.volume.maps(), "a range isn't tight");
        Ok(())
    }

    /// Runs a whole pass in ticks of `max_row_visits`.
    ///
    /// # Errors
    /// As [`IslandHarness::advance_checked`].
    pub fn run_pass(&mut self, max_row_visits: u32) -> Result<WholePass, TestCaseError> {
        self.islands.request_pass();
        for ticks in 1.. {
            if let Some(report) = self.advance_checked(max_row_visits)? {
                return Ok(WholePass { report, ticks });
            }
        }
        unreachable!()
    }

    /// Applies an edit. Returns the voxels that it added, by row.
    pub fn apply_edit(&mut self, edit: &RandomEdit) -> Vec<AddedVoxels<<Grid<N> as Size>::Row>> {
        let place = |i: i32| i * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2;
        let brush = Brush::sphere(
            IVec3::from_array(edit.at.map(place)),
            edit.radius * SUBUNITS_PER_VOXEL / 2,
        );
        let operation = match edit.kind {
            0 => EditOperation::Carve { depth: 4 },
            1 => EditOperation::Fill { depth: 2 },
            _ => EditOperation::Smooth { radius: 1, dither: None },
        };
        let edit = Edit { brush: &brush, operation, mirrored: false };
        let mut log = AdditionJournal { islands: &mut self.islands, added: Vec::new() };
        let report = apply_edit(&mut self.volume, &self.mask, &edit, &mut self.scratch, &mut log);
        let added = log.added;
        if report.is_ok_and(|report| report.changed_volume()) {
            self.islands.request_pass();
        }
        added
    }
}

/// The report of a whole pass.
#[derive(Clone, Copy, Debug)]
pub struct WholePass {
    /// The report.
    pub report: IslandReport,
    /// The number of ticks that it took.
    pub ticks: u32,
}

/// The voxels that an edit added to a bit row.
#[derive(Clone, Copy, Debug)]
pub struct AddedVoxels<R> {
    /// The row's address.
    pub row: RowAddress,
    /// The voxels, which were empty.
    pub voxels: R,
}

/// An edit of one tick, with a sphere.
#[derive(Clone, Debug)]
pub struct RandomEdit {
    /// The voxel at the sphere's centre.
    pub at: [i32; 3],
    /// The radius in half voxels.
    pub radius: i32,
    /// 0 carves, 1 fills, 2 smooths.
    pub kind: u8,
}

/// A strategy for 1 to 39 edits, one a tick, in a grid of `side`^3 voxels.
pub fn random_edits(side: i32) -> impl Strategy<Value = Vec<RandomEdit>> {
    let edit = ([0..side, 0..side, 0..side], 0..side / 2 + 2, 0..3u8)
        .prop_map(|(at, radius, kind)| RandomEdit { at, radius, kind });
    proptest::collection::vec(edit, 1..40)
}

/// A strategy for loosely joined balls, which an edit easily separates, with an empty mask; or any volume
/// and mask.
pub fn barely_joined_volumes(side: usize) -> impl Strategy<Value = MaskedVolume> {
    let n = side as i32;
    let ball = ([0..n, 0..n, 0..n], 1..n / 2);
    let balls = proptest::collection::vec(ball, 1..8).prop_map(move |balls| {
        let inside = |[x, y, z]: [i32; 3], ([i, j, k], r): ([i32; 3], i32)| {
            4 * ((x - i).pow(2) + (y - j).pow(2) + (z - k).pow(2)) <= r * r
        };
        let voxels = DenseVolume::from_fn(side, |v| balls.iter().any(|&ball| inside(v, ball)));
        MaskedVolume { volume: voxels.closure(), mask: DenseVolume::empty(side) }
    });
    prop_oneof![2 => balls, 1 => closed_volumes_with_inner_mask(side)]
}

/// A journal that keeps everything: changed columns with their old values, and added voxels.
struct JournalledChanges<R> {
    columns: Vec<(Axis, ColumnAddress, Column)>,
    added: Vec<AddedVoxels<R>>,
}

impl<R> Default for JournalledChanges<R> {
    fn default() -> Self {
        JournalledChanges { columns: Vec::new(), added: Vec::new() }
    }
}

impl<const N: usize> Journal<N> for JournalledChanges<<Grid<N> as Size>::Row>
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
        self.columns.extend(places.iter_ones().map(|place| (axis, (line, place), old[place])));
    }
    fn record_added(&mut self, row: RowAddress, voxels: <Grid<N> as Size>::Row) {
        self.added.push(AddedVoxels { row, voxels });
    }
}

/// A journal that passes an edit's additions on to the island pass, and keeps them.
struct AdditionJournal<'a, const N: usize>
where
    Grid<N>: Size,
{
    islands: &'a mut IslandSearch<N>,
    added: Vec<AddedVoxels<<Grid<N> as Size>::Row>>,
}

impl<const N: usize> Journal<N> for AdditionJournal<'_, N>
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        _: Axis,
        _: usize,
        _: <Grid<N> as Size>::Row,
        _: (&[Column; N], &[Column; N]),
    ) {
    }

    fn record_added(&mut self, row: RowAddress, voxels: <Grid<N> as Size>::Row) {
        self.islands.mark_added_as_reached(row, voxels);
        self.added.push(AddedVoxels { row, voxels });
    }
}
