//! A volume whose islands are cleared under test: each advance is checked against its journal.

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::edit::{self, Edit, EditScratch, Operation};
use paros_core::islands::{IslandReport, Islands};
use paros_core::maps::{Axis, Column, Maps};
use paros_core::pose::SUB;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use paros_core::volume::{Journal, Volume, maps_digest};
use proptest::prelude::*;

use super::dense::{Dense, masked_volumes};

/// A volume with its islands, its mask, and what edits need.
pub struct Bench<const N: usize>
where
    Grid<N>: Size,
{
    /// What is edited and cleared.
    pub volume: Volume<N>,
    /// Of `volume`, never removed.
    pub mask: Maps<N>,
    /// The pass.
    pub islands: Islands<N>,
    scratch: EditScratch<N>,
    spare: Maps<N>,
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
            mask: Maps::new(),
            islands: Islands::new(),
            scratch: EditScratch::new(),
            spare: Maps::new(),
        }
    }

    /// Another volume and mask, and no pass.
    pub fn set(&mut self, volume: &Dense, mask: &Dense) {
        self.volume.set_voxels(|plane| volume.write_plane(plane));
        mask.write_maps(&mut self.mask);
        self.islands.abort();
    }

    /// The volume as booleans.
    #[must_use]
    pub fn dense(&self) -> Dense {
        Dense::from_plane(self.volume.rows())
    }

    /// Advances once. The journal must tell of exactly the columns that changed, nothing may be
    /// added, the maps must be tight and the digests right.
    ///
    /// # Errors
    /// What isn't so.
    pub fn advance(&mut self, budget: u32) -> Result<Option<IslandReport>, TestCaseError> {
        self.spare.copy_from(self.volume.maps());
        let mut changes = Changes::default();
        let report = self.islands.advance(&mut self.volume, &self.mask, budget, &mut changes);
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

    /// Rows are the intersection of the maps, and every range is tight.
    ///
    /// # Errors
    /// What isn't so.
    pub fn check_closed(&mut self) -> Result<(), TestCaseError> {
        let dense = self.dense();
        prop_assert!(dense == Dense::from_maps(self.volume.maps()), "rows and maps differ");
        dense.write_maps(&mut self.spare);
        prop_assert!(self.spare == *self.volume.maps(), "a range isn't tight");
        Ok(())
    }

    /// A whole pass: what it reports, and after how many ticks.
    ///
    /// # Errors
    /// As [`Bench::advance`].
    pub fn run(&mut self, budget: u32) -> Result<(IslandReport, u32), TestCaseError> {
        self.islands.edited();
        for ticks in 1.. {
            if let Some(report) = self.advance(budget)? {
                return Ok((report, ticks));
            }
        }
        unreachable!()
    }

    /// Applies an edit; the voxels that it added, by row.
    pub fn edit(&mut self, visit: &Visit) -> Vec<((usize, usize), <Grid<N> as Size>::Row)> {
        let place = |i: i32| i * SUB + SUB / 2;
        let brush = Brush::sphere(IVec3::from_array(visit.at.map(place)), visit.radius * SUB / 2);
        let operation = match visit.kind {
            0 => Operation::Carve { depth: 4 },
            1 => Operation::Fill { depth: 2 },
            _ => Operation::Smooth,
        };
        let edit = Edit { brush: &brush, operation, mirrored: false };
        let mut log = Log { islands: &mut self.islands, added: Vec::new() };
        let report = edit::apply(&mut self.volume, &self.mask, &edit, &mut self.scratch, &mut log);
        let added = log.added;
        if report.is_ok_and(|report| report.changed()) {
            self.islands.edited();
        }
        added
    }
}

/// A visitor's edit in one tick.
#[derive(Clone, Debug)]
pub struct Visit {
    /// The voxel in its middle.
    pub at: [i32; 3],
    /// In half voxels.
    pub radius: i32,
    /// 0 carves, 1 fills, 2 smooths.
    pub kind: u8,
}

/// Up to 40 ticks of them in a grid of n^3 voxels.
pub fn visits(n: i32) -> impl Strategy<Value = Vec<Visit>> {
    let visit = ([0..n, 0..n, 0..n], 0..n / 2 + 2, 0..3u8).prop_map(|(at, radius, kind)| Visit {
        at,
        radius,
        kind,
    });
    proptest::collection::vec(visit, 1..40)
}

/// Blobs barely held together: what an edit easily cuts loose.
pub fn loose_volumes(n: usize) -> impl Strategy<Value = (Dense, Dense)> {
    let side = n as i32;
    let ball = ([0..side, 0..side, 0..side], 1..side / 2);
    let balls = proptest::collection::vec(ball, 1..8).prop_map(move |balls| {
        let inside = |[x, y, z]: [i32; 3], ([i, j, k], r): ([i32; 3], i32)| {
            4 * ((x - i).pow(2) + (y - j).pow(2) + (z - k).pow(2)) <= r * r
        };
        let voxels = Dense::from_fn(n, |v| balls.iter().any(|&ball| inside(v, ball)));
        (voxels.closure(), Dense::new(n))
    });
    prop_oneof![2 => balls, 1 => masked_volumes(n)]
}

/// What a journal was told.
struct Changes<R> {
    columns: Vec<(Axis, (usize, usize), Column)>,
    added: Vec<((usize, usize), R)>,
}

impl<R> Default for Changes<R> {
    fn default() -> Self {
        Changes { columns: Vec::new(), added: Vec::new() }
    }
}

impl<const N: usize> Journal<N> for Changes<<Grid<N> as Size>::Row>
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
        self.columns.extend(places.ones().map(|place| (axis, (line, place), old[place])));
    }
    fn added(&mut self, row: (usize, usize), voxels: <Grid<N> as Size>::Row) {
        self.added.push((row, voxels));
    }
}

/// Passes an edit's additions on.
struct Log<'a, const N: usize>
where
    Grid<N>: Size,
{
    islands: &'a mut Islands<N>,
    added: Vec<((usize, usize), <Grid<N> as Size>::Row)>,
}

impl<const N: usize> Journal<N> for Log<'_, N>
where
    Grid<N>: Size,
{
    fn columns(&mut self, _: Axis, _: usize, _: <Grid<N> as Size>::Row, _: &[Column; N]) {}
    fn added(&mut self, row: (usize, usize), voxels: <Grid<N> as Size>::Row) {
        self.islands.added(row, voxels);
        self.added.push((row, voxels));
    }
}
