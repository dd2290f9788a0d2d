//! Test harness of contact: a volume with its mask, the table of bits, and a strategy for rotations.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::Quat;
use paros_core::RangeMaps;
use paros_core::edit::{Contact, Pose};
use paros_core::internals::{BOX_SIDE, FreezeResult, GridBit, Obstacle, WayBudget};
use paros_core::limits::max_bit_steps_per_tick;
use paros_core::session::ToolBit;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_models::dense::DenseVolume;
use proptest::prelude::*;

/// A volume and its mask in the core's types.
pub(crate) struct ContactHarness<const N: usize>
where
    Grid<N>: Size,
{
    rows: BitGrid<N>,
    mask: RangeMaps<N>,
    masked: bool,
}

impl<const N: usize> ContactHarness<N>
where
    Grid<N>: Size,
{
    pub(crate) const fn new() -> Self {
        ContactHarness { rows: BitGrid::new(), mask: RangeMaps::new(), masked: false }
    }

    pub(crate) fn set(&mut self, volume: &DenseVolume, mask: &DenseVolume) {
        self.rows.clear();
        volume.insert_into_empty_bits(&mut self.rows);
        mask.write_maps(&mut self.mask);
        self.masked = !mask.is_empty();
    }

    pub(crate) fn obstacle(&self) -> Obstacle<'_, N> {
        Obstacle { rows: &self.rows, mask: self.masked.then_some(&self.mask), is_mask_alone: false }
    }

    pub(crate) fn contact(&self, bit: &GridBit, pose: &Pose) -> Contact {
        self.obstacle().contact_at(bit, pose)
    }

    pub(crate) fn freeze(&self, bit: &GridBit, from: &Pose, raw: &Pose) -> FreezeResult {
        self.obstacle().freeze_bit(bit, from, raw, tick_budget(N))
    }
}

pub(crate) static STONE_16: Mutex<ContactHarness<16>> = Mutex::new(ContactHarness::new());
pub(crate) static STONE_64: Mutex<ContactHarness<64>> = Mutex::new(ContactHarness::new());
pub(crate) static STONE_128: Mutex<ContactHarness<128>> = Mutex::new(ContactHarness::new());
pub(crate) static STONE_256: Mutex<ContactHarness<256>> = Mutex::new(ContactHarness::new());

pub(crate) fn lock_stone<T>(stone: &'static Mutex<T>) -> MutexGuard<'static, T> {
    stone.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the path budget of a tick for a bit that doesn't run.
pub(crate) fn tick_budget(n: usize) -> WayBudget {
    WayBudget::of_steps(max_bit_steps_per_tick(n))
}

/// Returns the side of a voxel in micrometres, in a grid of `n`^3.
pub(crate) fn voxel_micrometres(n: usize) -> f32 {
    BOX_SIDE / n as f32 * 1e6
}

/// Returns the bit with a number in the table, in a grid of `n`^3.
pub(crate) fn table_bit(number: u8, n: usize) -> GridBit {
    ToolBit::from_number(number).expect("a bit of the table").to_grid_bit(voxel_micrometres(n))
}

/// A strategy for rotations: the identity, or any.
pub(crate) fn any_rotations() -> impl Strategy<Value = Quat> {
    let any = [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0].prop_map(|q| {
        let q = Quat::from_array(q);
        if q.length_squared() > 1e-3 { q.normalize() } else { Quat::IDENTITY }
    });
    prop_oneof![1 => Just(Quat::IDENTITY), 4 => any]
}
