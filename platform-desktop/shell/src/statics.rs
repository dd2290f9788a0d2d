//! Static buffers, one set for each grid size. The core's buffers are large, start as all zero bytes
//! and never move, so they live in statics, each behind a mutex.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::{Baker, BitGrid, Grid, RangeMaps, Size, World};

use crate::start_volume_store::StartVolumeStore;
use crate::stl_export::StlBuffers;

/// The static buffers of a `Grid<N>`. Each method locks one until the guard is dropped; it still
/// holds what its last user left in it.
pub trait Resident<const N: usize>: Size
where
    Grid<N>: Size,
{
    /// Locks the range maps.
    fn lock_range_maps() -> MutexGuard<'static, RangeMaps<N>>;
    /// Locks the bit grid.
    fn lock_bit_grid() -> MutexGuard<'static, BitGrid<N>>;
    /// Locks the baker, which turns triangles into maps.
    fn lock_baker() -> MutexGuard<'static, Baker<N>>;
    /// Locks the print buffers, which turn voxels into triangles.
    fn lock_stl_buffers() -> MutexGuard<'static, StlBuffers<N>>;
    /// Locks the world.
    fn lock_world() -> MutexGuard<'static, World<N>>;
    /// Locks the start volumes.
    fn lock_start_volumes() -> MutexGuard<'static, StartVolumeStore<N>>;
}

macro_rules! resident {
    ($($n:literal),*) => {$(
        impl Resident<$n> for Grid<$n> {
            fn lock_range_maps() -> MutexGuard<'static, RangeMaps<$n>> {
                static RANGE_MAPS: Mutex<RangeMaps<$n>> = Mutex::new(RangeMaps::new());
                RANGE_MAPS.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn lock_bit_grid() -> MutexGuard<'static, BitGrid<$n>> {
                static BIT_GRID: Mutex<BitGrid<$n>> = Mutex::new(BitGrid::new());
                BIT_GRID.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn lock_baker() -> MutexGuard<'static, Baker<$n>> {
                static BAKER: Mutex<Baker<$n>> = Mutex::new(Baker::new());
                BAKER.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn lock_stl_buffers() -> MutexGuard<'static, StlBuffers<$n>> {
                static PRINT_BUFFERS: Mutex<StlBuffers<$n>> = Mutex::new(StlBuffers::new());
                PRINT_BUFFERS.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn lock_world() -> MutexGuard<'static, World<$n>> {
                static WORLD: Mutex<World<$n>> = Mutex::new(World::new());
                WORLD.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn lock_start_volumes() -> MutexGuard<'static, StartVolumeStore<$n>> {
                static START_VOLUMES: Mutex<StartVolumeStore<$n>> = Mutex::new(StartVolumeStore::new());
                START_VOLUMES.lock().unwrap_or_else(PoisonError::into_inner)
            }
        }
    )*};
}

resident!(128, 256);
