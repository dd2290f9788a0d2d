//! Static buffers, one set for each grid size and number of intervals. The core's buffers are large,
//! start as all zero bytes and never move, so they live in statics, each behind a mutex.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::convert::{ColumnWindings, NoWindings, Windings};
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{Baker, RangeMaps, World};

use crate::start_volume_store::StartVolumeStore;
use crate::stl_export::StlBuffers;

/// The static bit grid of a `Grid<N>`. It keeps the contents that its last user left.
pub trait ResidentBitGrid<const N: usize>: Size
where
    Grid<N>: Size,
{
    /// Locks the bit grid until the guard is dropped.
    fn lock_bit_grid() -> MutexGuard<'static, BitGrid<N>>;
}

/// A world and the volumes that its sessions start from.
pub struct WorldWithStarts<const N: usize, const K: usize>
where
    Grid<N>: Size,
{
    /// The start volumes; empty until [`WorldWithStarts::generate_starts`].
    pub start_volumes: StartVolumeStore<N, K>,
    /// The world.
    pub world: World<N, K>,
}

impl<const N: usize, const K: usize> WorldWithStarts<N, K>
where
    Grid<N>: Size + Resident<N, K>,
{
    /// Generates the start volumes unless they are there already.
    pub fn generate_starts(&mut self) {
        self.start_volumes.generate_once(&mut Grid::<N>::lock_bit_grid(), |_| {});
    }
}

/// The static buffers of a `Grid<N>` with K intervals per column. Each method locks a buffer until the guard
/// is dropped; the buffer keeps the contents that its last user left. To avoid a deadlock, lock a world
/// before the STL buffers in which its sculpture is exported.
pub trait Resident<const N: usize, const K: usize>: ResidentBitGrid<N>
where
    Grid<N>: Size,
{
    /// The baker's storage of winding numbers, which columns of several intervals need.
    type Windings: Windings<N>;

    /// Locks the range maps.
    fn lock_range_maps() -> MutexGuard<'static, RangeMaps<N, K>>;
    /// Locks the baker, which turns triangles into maps.
    fn lock_baker() -> MutexGuard<'static, Baker<N, Self::Windings>>;
    /// Locks the print buffers, which turn voxels into triangles.
    fn lock_stl_buffers() -> MutexGuard<'static, StlBuffers<N, K>>;
    /// Locks the world and its start volumes.
    fn lock_world() -> MutexGuard<'static, WorldWithStarts<N, K>>;
}

/// Defines a function with a static buffer that locks the buffer.
macro_rules! lock_static {
    ($lock:ident, $NAME:ident: $Buffer:ty) => {
        fn $lock() -> MutexGuard<'static, $Buffer> {
            static $NAME: Mutex<$Buffer> = Mutex::new(<$Buffer>::new());
            $NAME.lock().unwrap_or_else(PoisonError::into_inner)
        }
    };
}

macro_rules! resident {
    ($($n:literal: $($k:literal $Windings:ty),*;)*) => {$(
        impl ResidentBitGrid<$n> for Grid<$n> {
            lock_static!(lock_bit_grid, BIT_GRID: BitGrid<$n>);
        }

        $(impl Resident<$n, $k> for Grid<$n> {
            type Windings = $Windings;

            lock_static!(lock_range_maps, RANGE_MAPS: RangeMaps<$n, $k>);
            lock_static!(lock_baker, BAKER: Baker<$n, $Windings>);
            lock_static!(lock_stl_buffers, PRINT_BUFFERS: StlBuffers<$n, $k>);

            fn lock_world() -> MutexGuard<'static, WorldWithStarts<$n, $k>> {
                static WORLD: Mutex<WorldWithStarts<$n, $k>> = Mutex::new(WorldWithStarts {
                    start_volumes: StartVolumeStore::new(),
                    world: World::new(),
                });
                WORLD.lock().unwrap_or_else(PoisonError::into_inner)
            }
        })*
    )*};
}

// One interval per column is for old traces.
resident!(
    128: 1 NoWindings, 2 ColumnWindings<128>;
    256: 1 NoWindings, 2 ColumnWindings<256>;
);
