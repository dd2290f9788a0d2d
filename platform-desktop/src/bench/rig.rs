//! What the benches work on: a volume with all that an edit in the world takes along.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::dirty::Dirty;
use paros_core::edit::EditScratch;
use paros_core::islands::Islands;
use paros_core::maps::{Axis, Column, Maps};
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_core::undo::Undo;
use paros_core::volume::{Journal, Volume};
use paros_shell::statics::Resident;

/// The parts of a world that edits and islands change, each by itself.
pub(super) struct Rig<const N: usize>
where
    Grid<N>: Size,
{
    /// The subject, as it is before every run.
    pub(super) start: Maps<N>,
    /// Room for another version of it.
    pub(super) other: Maps<N>,
    /// Always empty: nothing measured here has a mask.
    pub(super) mask: Maps<N>,
    pub(super) plane: Plane<N>,
    pub(super) volume: Volume<N>,
    pub(super) undo: Undo<N>,
    pub(super) dirty: Dirty,
    pub(super) islands: Islands<N>,
    pub(super) scratch: EditScratch<N>,
}

impl<const N: usize> Rig<N>
where
    Grid<N>: Size,
{
    const fn new() -> Self {
        Rig {
            start: Maps::new(),
            other: Maps::new(),
            mask: Maps::new(),
            plane: Plane::new(),
            volume: Volume::new(),
            undo: Undo::new(),
            dirty: Dirty::new(),
            islands: Islands::new(),
            scratch: EditScratch::new(),
        }
    }
}

/// One rig for each size.
pub(super) trait Rigged<const N: usize>: Resident<N>
where
    Grid<N>: Size,
{
    /// The rig, held until the guard is dropped.
    fn rig() -> MutexGuard<'static, Rig<N>>;
}

macro_rules! rigged {
    ($($n:literal),*) => {$(
        impl Rigged<$n> for Grid<$n> {
            fn rig() -> MutexGuard<'static, Rig<$n>> {
                static RIG: Mutex<Rig<$n>> = Mutex::new(Rig::new());
                RIG.lock().unwrap_or_else(PoisonError::into_inner)
            }
        }
    )*};
}

/// The volume as it starts, with nothing to undo and no pass called for.
pub(super) fn reset<const N: usize>(rig: &mut Rig<N>)
where
    Grid<N>: Size,
{
    rig.volume.set_maps(&rig.start);
    rig.undo.clear();
    rig.dirty.clear();
    rig.islands.clear();
}

rigged!(128, 256);

/// Hears of what an edit does, as the world's own log.
pub(super) struct Log<'a, const N: usize>
where
    Grid<N>: Size,
{
    pub(super) undo: &'a mut Undo<N>,
    pub(super) dirty: &'a mut Dirty,
    pub(super) islands: &'a mut Islands<N>,
}

impl<const N: usize> Journal<N> for Log<'_, N>
where
    Grid<N>: Size,
{
    fn column(&mut self, axis: Axis, at: (usize, usize), old: Column) {
        self.undo.record(axis, at, old);
        self.dirty.note(axis, at);
    }

    fn columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    ) {
        self.undo.record_line(axis, line, places, old);
        self.dirty.note_line(axis, line, places);
    }

    fn added(&mut self, row: (usize, usize), voxels: <Grid<N> as Size>::Row) {
        self.islands.added(row, voxels);
    }
}

/// Hears of what the removal of islands does, as the world's own record.
pub(super) struct Record<'a, const N: usize>
where
    Grid<N>: Size,
{
    pub(super) undo: &'a mut Undo<N>,
    pub(super) dirty: &'a mut Dirty,
}

impl<const N: usize> Journal<N> for Record<'_, N>
where
    Grid<N>: Size,
{
    fn column(&mut self, axis: Axis, at: (usize, usize), old: Column) {
        self.undo.amend(axis, at, old);
        self.dirty.note(axis, at);
    }

    fn added(&mut self, _: (usize, usize), _: <Grid<N> as Size>::Row) {}
}
