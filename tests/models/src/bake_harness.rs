//! Test harness of the baker: bakes triangles and compares volume and report with the model, voxel by voxel.

use std::sync::Mutex;

use glam::IVec3;
use paros_core::internals::BAKE_UNITS_PER_VOXEL;
use paros_core::{Baker, BitGrid, RangeMaps};
use proptest::prelude::*;

use crate::bake::{self as model, Triangle};

/// The grid's side in voxels.
pub const N: usize = 16;
/// The grid's side in the baker's units.
pub const SIDE_UNITS: i32 = N as i32 * BAKE_UNITS_PER_VOXEL;

/// A baker and its output.
#[derive(Debug)]
pub struct BakeHarness {
    /// The baker.
    pub baker: Baker<N>,
    /// The baked volume.
    pub maps: RangeMaps<N>,
    /// The baked volume as bits.
    pub bits: BitGrid<N>,
    expected: RangeMaps<N>,
}

impl Default for BakeHarness {
    fn default() -> Self {
        BakeHarness::new()
    }
}

impl BakeHarness {
    /// A harness with empty output.
    #[must_use]
    pub const fn new() -> Self {
        BakeHarness {
            baker: Baker::new(),
            maps: RangeMaps::new(),
            bits: BitGrid::new(),
            expected: RangeMaps::new(),
        }
    }

    /// Bakes triangles and compares volume and report with the model's.
    ///
    /// # Errors
    /// Baker and model differ.
    pub fn check_bake(&mut self, triangles: &[Triangle]) -> Result<(), TestCaseError> {
        self.baker.clear();
        for t in triangles {
            prop_assert_eq!(self.baker.add_triangle(t.map(IVec3::from_array)), Ok(()));
        }
        let report = self.baker.write_maps(&mut self.maps, &mut self.bits);
        let baked = model::bake_triangles(N, triangles);
        for z in 0..N {
            for y in 0..N {
                for x in 0..N {
                    let expected = baked.occupied[x + N * (y + N * z)];
                    prop_assert_eq!(self.maps.contains([x, y, z]), expected, "{:?}", [x, y, z]);
                    prop_assert_eq!(self.bits.contains([x, y, z]), expected, "{:?}", [x, y, z]);
                }
            }
        }
        model::write_column_hulls(&baked.occupied, &mut self.expected);
        prop_assert!(self.maps == self.expected, "the maps are not tight");
        prop_assert_eq!(report.flipped, baked.flipped);
        prop_assert_eq!(report.degenerate, baked.degenerate);
        prop_assert_eq!(report.opened_columns, baked.opened);
        prop_assert_eq!(report.triangles, triangles.len() as u64);
        Ok(())
    }
}

/// [`BakeHarness::check_bake`] on a harness that all tests of a process share.
///
/// # Errors
/// As [`BakeHarness::check_bake`].
pub fn check_bake(triangles: &[Triangle]) -> Result<(), TestCaseError> {
    static BENCH: Mutex<BakeHarness> = Mutex::new(BakeHarness::new());
    BENCH.lock().unwrap_or_else(|held| held.into_inner()).check_bake(triangles)
}

/// Bakes closed shapes of the small grid in the middle of one of 128, whose rows have two words, and compares
/// the voxels with those that the model baked.
///
/// # Errors
/// The baker's volume differs from what is expected.
pub fn check_bake_moved_into_two_word_rows(
    small_grid_triangles: &[Triangle],
    small_grid_baked: &model::BakedVoxels,
) -> Result<(), TestCaseError> {
    static BAKER: Mutex<Baker<128>> = Mutex::new(Baker::new());
    static MAPS: Mutex<RangeMaps<128>> = Mutex::new(RangeMaps::new());
    static PLANE: Mutex<BitGrid<128>> = Mutex::new(BitGrid::new());
    let mut baker = BAKER.lock().unwrap_or_else(|held| held.into_inner());
    let mut bits = PLANE.lock().unwrap_or_else(|held| held.into_inner());
    baker.clear();
    for t in small_grid_triangles {
        let moved = t.map(|p| IVec3::from_array(p) + IVec3::splat(56 * BAKE_UNITS_PER_VOXEL));
        prop_assert_eq!(baker.add_triangle(moved), Ok(()));
    }
    baker.write_maps(&mut MAPS.lock().unwrap_or_else(|held| held.into_inner()), &mut bits);
    for (i, &expected) in small_grid_baked.occupied.iter().enumerate() {
        let voxel = [i % N, i / N % N, i / N / N].map(|c| c + 56);
        prop_assert_eq!(bits.contains(voxel), expected, "{:?}", voxel);
    }
    prop_assert_eq!(
        bits.count_voxels(),
        small_grid_baked.occupied.iter().filter(|&&set| set).count() as u64
    );
    Ok(())
}
