//! Test fixture: a volume with the state that the world's edits change beside it.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::edit::EditScratch;
use paros_core::internals::{IslandSearch, UndoHistory};
use paros_core::volume::{BitGrid, DirtyRects, Grid, Size};
use paros_core::{RangeMaps, Volume};
use paros_shell::statics::Resident;

/// The parts of a world that edits and island passes change, as separate fields.
pub(super) struct Fixture<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The subject's maps, as they are before every run.
    pub(super) start: RangeMaps<N, K>,
    /// A second volume, for the rival's result.
    pub(super) other: RangeMaps<N, K>,
    /// Always empty: no measurement uses a mask.
    pub(super) mask: RangeMaps<N, K>,
    pub(super) bit_grid: BitGrid<N>,
    pub(super) volume: Volume<N, K>,
    pub(super) undo: UndoHistory<N, K>,
    pub(super) dirty: DirtyRects,
    pub(super) islands: IslandSearch<N>,
    pub(super) scratch: EditScratch<N>,
}

impl<const N: usize, const K: usize> Fixture<N, K>
where
    Grid<N>: Size,
{
    pub(super) const fn new() -> Self {
        Fixture {
            start: RangeMaps::new(),
            other: RangeMaps::new(),
            mask: RangeMaps::new(),
            bit_grid: BitGrid::new(),
            volume: Volume::new(),
            undo: UndoHistory::new(),
            dirty: DirtyRects::new(),
            islands: IslandSearch::new(),
            scratch: EditScratch::new(),
        }
    }
}

/// The static fixtures of a grid size.
pub(super) trait HasFixture<const N: usize>: Resident<N, 1>
where
    Grid<N>: Size,
{
    /// Locks the fixture until the guard is dropped.
    fn lock_fixture() -> MutexGuard<'static, Fixture<N>>;

    /// Locks the fixture with two intervals a column until the guard is dropped.
    fn lock_fixture_of_two() -> MutexGuard<'static, Fixture<N, 2>>;
}

macro_rules! fixtures {
    ($($n:literal),*) => {$(
        impl HasFixture<$n> for Grid<$n> {
            fn lock_fixture() -> MutexGuard<'static, Fixture<$n>> {
                static FIXTURE: Mutex<Fixture<$n>> = Mutex::new(Fixture::new());
                FIXTURE.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn lock_fixture_of_two() -> MutexGuard<'static, Fixture<$n, 2>> {
                static FIXTURE: Mutex<Fixture<$n, 2>> = Mutex::new(Fixture::new());
                FIXTURE.lock().unwrap_or_else(PoisonError::into_inner)
            }
        }
    )*};
}

/// Restores the start volume, with an empty undo history and no island pass pending.
pub(super) fn restore_start_volume<const N: usize, const K: usize>(fixture: &mut Fixture<N, K>)
where
    Grid<N>: Size,
{
    fixture.volume.set_maps(&fixture.start);
    fixture.undo.clear();
    fixture.dirty.clear();
    fixture.islands.reset();
}

fixtures!(128, 256);
