//! One resident set of buffers for each size that is chosen at run time.
//!
//! The core's buffers start as all zero bytes and never move, so they live in statics. A size read
//! from a file or a command line picks among them.

use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::bake::Baker;
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};
use paros_core::world::World;

use crate::print::Press;
use crate::starts::StartVolumes;

/// The buffers that a `Grid<N>` of a run-time size brings along.
pub trait Resident<const N: usize>: Size
where
    Grid<N>: Size,
{
    /// The range maps, held until the guard is dropped. What they hold is what was left there.
    fn maps() -> MutexGuard<'static, Maps<N>>;
    /// The bit rows, held until the guard is dropped. What they hold is what was left there.
    fn plane() -> MutexGuard<'static, Plane<N>>;
    /// What turns triangles into maps.
    fn baker() -> MutexGuard<'static, Baker<N>>;
    /// What turns voxels into triangles.
    fn press() -> MutexGuard<'static, Press<N>>;
    /// The world, held until the guard is dropped.
    fn world() -> MutexGuard<'static, World<N>>;
    /// The start volumes, held until the guard is dropped.
    fn start_volumes() -> MutexGuard<'static, StartVolumes<N>>;
}

macro_rules! resident {
    ($($n:literal),*) => {$(
        impl Resident<$n> for Grid<$n> {
            fn maps() -> MutexGuard<'static, Maps<$n>> {
                static MAPS: Mutex<Maps<$n>> = Mutex::new(Maps::new());
                MAPS.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn plane() -> MutexGuard<'static, Plane<$n>> {
                static PLANE: Mutex<Plane<$n>> = Mutex::new(Plane::new());
                PLANE.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn baker() -> MutexGuard<'static, Baker<$n>> {
                static BAKER: Mutex<Baker<$n>> = Mutex::new(Baker::new());
                BAKER.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn press() -> MutexGuard<'static, Press<$n>> {
                static PRESS: Mutex<Press<$n>> = Mutex::new(Press::new());
                PRESS.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn world() -> MutexGuard<'static, World<$n>> {
                static WORLD: Mutex<World<$n>> = Mutex::new(World::new());
                WORLD.lock().unwrap_or_else(PoisonError::into_inner)
            }

            fn start_volumes() -> MutexGuard<'static, StartVolumes<$n>> {
                static STARTS: Mutex<StartVolumes<$n>> = Mutex::new(StartVolumes::new());
                STARTS.lock().unwrap_or_else(PoisonError::into_inner)
            }
        }
    )*};
}

resident!(128, 256);
