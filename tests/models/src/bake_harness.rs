//! Test harness of the baker: bakes triangles, and compares maps, volume and report with the model's.

use std::sync::{Mutex, MutexGuard};

use glam::IVec3;
use paros_core::convert::{ColumnWindings, NoWindings, Windings};
use paros_core::internals::BAKE_UNITS_PER_VOXEL;
use paros_core::volume::{Axis, BitGrid};
use paros_core::{Baker, RangeMaps, Volume};
use proptest::prelude::*;

use crate::bake::{BakedVoxels, TouchedVoxels, Triangle};
use crate::layers::Intervals;

/// The grid's side in voxels.
pub const N: usize = 16;
/// The grid's side in the baker's units.
pub const SIDE_UNITS: i32 = N as i32 * BAKE_UNITS_PER_VOXEL;

/// A baker and its output, in columns of K intervals.
#[derive(Debug)]
pub struct BakeHarness<const K: usize, W: Windings<N> = ColumnWindings<N>> {
    /// The baker.
    pub baker: Baker<N, W>,
    /// The baked volume.
    pub maps: RangeMaps<N, K>,
    /// The baked volume as bits.
    pub bits: BitGrid<N>,
    volume: Volume<N, K>,
}

impl<const K: usize, W: Windings<N>> Default for BakeHarness<K, W> {
    fn default() -> Self {
        BakeHarness::new()
    }
}

impl<const K: usize, W: Windings<N>> BakeHarness<K, W> {
    /// Creates a harness with empty output.
    #[must_use]
    pub const fn new() -> Self {
        BakeHarness {
            baker: Baker::new(),
            maps: RangeMaps::new(),
            bits: BitGrid::new(),
            volume: Volume::new(),
        }
    }

    /// Bakes triangles and compares maps, volume and report with the model's.
    ///
    /// # Errors
    /// Baker and model differ.
    pub fn check_bake(
        &mut self,
        triangles: &[Triangle],
        baked: &BakedVoxels,
    ) -> Result<(), TestCaseError> {
        self.baker.clear();
        for t in triangles {
            prop_assert_eq!(self.baker.add_triangle(t.map(IVec3::from_array)), Ok(()));
        }
        let report = self.baker.write_maps(&mut self.maps, &mut self.bits);
        for z in 0..N {
            for y in 0..N {
                for x in 0..N {
                    let expected = baked.occupied[x + N * (y + N * z)];
                    prop_assert_eq!(self.maps.contains([x, y, z]), expected, "{:?}", [x, y, z]);
                    prop_assert_eq!(self.bits.contains([x, y, z]), expected, "{:?}", [x, y, z]);
                }
            }
        }
        for axis in Axis::ALL {
            for (at, expected) in baked.columns[axis as usize].iter().enumerate() {
                let at = (at / N, at % N);
                let ranges = self.maps.column(axis, at).intervals();
                let column: Intervals = ranges.map(|r| (r.first(), r.last())).collect();
                prop_assert_eq!(&column, expected, "K = {}, {:?} {:?}", K, axis, at);
            }
        }
        self.volume.set_maps(&self.maps);
        prop_assert!(self.volume.are_ranges_tight(), "K = {}: not tight", K);
        prop_assert!(self.volume.is_saturated(), "K = {}: not saturated", K);
        prop_assert_eq!(report.flipped, baked.flipped);
        prop_assert_eq!(report.degenerate, baked.degenerate);
        prop_assert_eq!(report.opened_columns, baked.opened);
        prop_assert_eq!(report.triangles, triangles.len() as u64);
        Ok(())
    }
}

/// Runs [`BakeHarness::check_bake`] with one to three intervals a column, and with one interval in a baker
/// without winding numbers, on harnesses shared by all tests of a process.
///
/// # Errors
/// As [`BakeHarness::check_bake`].
pub fn check_bake(triangles: &[Triangle]) -> Result<(), TestCaseError> {
    static WITHOUT_WINDINGS: Mutex<BakeHarness<1, NoWindings>> = Mutex::new(BakeHarness::new());
    static ONE: Mutex<BakeHarness<1>> = Mutex::new(BakeHarness::new());
    static TWO: Mutex<BakeHarness<2>> = Mutex::new(BakeHarness::new());
    static THREE: Mutex<BakeHarness<3>> = Mutex::new(BakeHarness::new());
    let touched = TouchedVoxels::new(N, triangles);
    let baked = touched.bake(1);
    lock(&WITHOUT_WINDINGS).check_bake(triangles, &baked)?;
    lock(&ONE).check_bake(triangles, &baked)?;
    lock(&TWO).check_bake(triangles, &touched.bake(2))?;
    lock(&THREE).check_bake(triangles, &touched.bake(3))
}

/// Bakes closed shapes of the small grid in the middle of a grid of 128, whose rows have two words, and
/// compares the voxels with the model's, in columns of K intervals.
///
/// # Errors
/// The baker's volume differs from the expected one.
pub fn check_bake_moved_into_two_word_rows<const K: usize>(
    small_grid_triangles: &[Triangle],
    small_grid_baked: &BakedVoxels,
) -> Result<(), TestCaseError> {
    static BAKER: Mutex<Baker<128, ColumnWindings<128>>> = Mutex::new(Baker::new());
    static PLANE: Mutex<BitGrid<128>> = Mutex::new(BitGrid::new());
    let (mut baker, mut bits) = (lock(&BAKER), lock(&PLANE));
    let mut maps = Box::new(RangeMaps::<128, K>::new());
    baker.clear();
    for t in small_grid_triangles {
        let moved = t.map(|p| IVec3::from_array(p) + IVec3::splat(56 * BAKE_UNITS_PER_VOXEL));
        prop_assert_eq!(baker.add_triangle(moved), Ok(()));
    }
    baker.write_maps(&mut maps, &mut bits);
    for (i, &expected) in small_grid_baked.occupied.iter().enumerate() {
        let voxel = [i % N, i / N % N, i / N / N].map(|c| c + 56);
        prop_assert_eq!(bits.contains(voxel), expected, "{:?}", voxel);
        prop_assert_eq!(maps.contains(voxel), expected, "{:?}", voxel);
    }
    prop_assert_eq!(
        bits.count_voxels(),
        small_grid_baked.occupied.iter().filter(|&&set| set).count() as u64
    );
    Ok(())
}

/// Locks a mutex that a failed test may have poisoned.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|held| held.into_inner())
}
