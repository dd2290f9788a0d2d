//! The editable volume: keeps range maps and bit rows in sync and journals every changed column.

use crate::codec::digest::DIGEST_KEYS;
use crate::volume::bit_grid::BitGrid;
use crate::volume::column_digest::{column_number, copy_and_digest_maps, line_key, maps_digest};
use crate::volume::journal::Journal;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RangeMaps};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// N^3 voxels: three tight range maps of K intervals a column, the bit rows of their intersection, and a
/// running digest.
///
/// # The closure rule
/// Columns of K intervals have K - 1 gaps between them. Let V be the volume, and e the exact voxels after an
/// edit. The *runs* of a column are the maximal sequences of empty voxels inside the tight hull of e. Each
/// column in which e differs from V becomes that hull without its first K - 1 runs, in this order: runs that
/// hold a voxel of one of the column's previous gaps come first, then longer runs, then lower ones. The new
/// volume V' is the set of voxels that all three maps hold. K = 1 is the rule of the paper (section 3.2): the
/// tight hulls, and their intersection.
///
/// Consequences, each a property test in the project's tests:
///
/// 1. *Nothing of e is lost*: e is within V'. A column that e changed holds all of e, as runs are empty
///    in e; in any other column e is V, which it holds.
/// 2. *Every interval is tight*: its ends are voxels of V'. By construction they are voxels of e, or of V
///    in a column in which e is V.
/// 3. *Every column is saturated*: a column with fewer than K - 1 gaps has no other empty voxel inside its
///    hull. The column took all runs of e, and by (1) every empty voxel of V' is empty in e. Therefore the
///    rule leaves columns unchanged in which e doesn't differ from V, and maps change exactly when V does.
/// 4. *A carve (e within V) adds nothing*, so every voxel that it fails to remove lies in its brush. A voxel
///    outside V was outside the hull of a column, and hulls of e only shrink; or it was in a gap, which is
///    empty in e and therefore lies in one run. There are at most as many such runs as there were gaps, so
///    all are held.
/// 5. *A fill (V within e) adds outside its brush only along its beams*: columns that don't cross the brush
///    still exclude every voxel that they excluded.
/// 6. *The order of columns doesn't matter*: each depends on e and on its own gaps.
/// 7. *A second island pass changes nothing.* A pass carves V to the supported voxels S, and S is within V'
///    within V, so the supported voxels of V' are S again. The runs of S are the same as before, and the gaps
///    that were chosen now come first.
///
/// Three properties that hold for K = 1 fail for more: the maps aren't a function of V, as the held gaps
/// depend on history; closure isn't monotone, as a larger carve may leave a voxel that a smaller one
/// wouldn't; and a mirrored edit of a mirrored volume may break the symmetry, as the lower of two runs of
/// equal length is held.
#[derive(Debug)]
pub struct Volume<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    maps: RangeMaps<N, K>,
    rows: BitGrid<N>,
    digest: u64,
}

impl<const N: usize, const K: usize> Volume<N, K>
where
    Grid<N>: Size,
{
    /// Creates an empty volume. For a `static`, as [`World::new`](crate::World::new).
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would be moved by value
    pub const fn new() -> Self {
        Volume { maps: RangeMaps::new(), rows: BitGrid::new(), digest: 0 }
    }

    /// Sets the volume to these range maps, which must be tight and saturated.
    #[inline(never)]
    pub fn set_maps(&mut self, maps: &RangeMaps<N, K>) {
        self.digest = copy_and_digest_maps(maps, &mut self.maps);
        self.rebuild_rows();
    }

    /// Sets the volume to the closure of the voxels that `fill_empty` sets in an empty grid.
    pub fn set_voxels(&mut self, fill_empty: impl FnOnce(&mut BitGrid<N>)) {
        self.rows.clear();
        fill_empty(&mut self.rows);
        self.rows.write_closure(&mut self.maps);
        self.digest = maps_digest(&self.maps);
        self.rebuild_rows();
    }

    /// Rebuilds the bit rows after [`Volume::maps_and_digest_leaving_bit_rows`].
    pub(crate) fn rebuild_rows(&mut self) {
        self.rows.set_from_maps(&self.maps);
    }

    /// Rebuilds only the bit rows whose y and z lie in these ranges. No other row may have changed.
    pub(crate) fn rebuild_rows_of(&mut self, y_and_z: [Range; 2]) {
        self.rows.set_rows_from_maps(&self.maps, y_and_z);
    }

    /// Returns the range maps.
    #[must_use]
    pub const fn maps(&self) -> &RangeMaps<N, K> {
        &self.maps
    }

    /// Returns the bit rows.
    #[must_use]
    pub const fn rows(&self) -> &BitGrid<N> {
        &self.rows
    }

    /// Returns the bit rows for changes. The caller must update the range maps afterwards.
    pub(crate) fn rows_mut(&mut self) -> &mut BitGrid<N> {
        &mut self.rows
    }

    /// Returns the [`maps_digest`](crate::internals::maps_digest) of the range maps, updated incrementally.
    #[must_use]
    pub const fn digest(&self) -> u64 {
        self.digest
    }

    /// Replaces the columns at `places` of a line by the columns of `new`, and journals them. Each new column
    /// must differ from the old one.
    #[inline]
    pub(crate) fn replace_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        new: &[Column<K>; N],
        journal: &mut dyn Journal<N, K>,
    ) {
        if places.is_empty() {
            return;
        }
        let old = self.maps.line_mut(axis, line);
        journal.record_columns(axis, line, places, (old, new));
        let mut sum = 0u64;
        for run in places.iter_runs_within_words() {
            let run = run.first()..=run.last();
            let (old, new) = (&mut old[run.clone()], &new[run.clone()]);
            for ((old, new), key) in old.iter_mut().zip(new).zip(&DIGEST_KEYS[run]) {
                let change = column_number(*new).wrapping_sub(column_number(*old));
                sum = sum.wrapping_add(key.wrapping_mul(change));
                *old = *new;
            }
        }
        self.digest = self.digest.wrapping_add(sum.wrapping_mul(line_key(axis, line)));
    }

    /// Returns the maps, to swap columns without journalling them, and the digest, which the caller must
    /// update with them. The bit rows are stale until [`Volume::rebuild_rows`].
    #[inline]
    pub(crate) fn maps_and_digest_leaving_bit_rows(&mut self) -> (&mut RangeMaps<N, K>, &mut u64) {
        (&mut self.maps, &mut self.digest)
    }

    /// Returns `true` if every range is tight: both its end voxels are occupied. Always true after an edit;
    /// use it to check range maps of unknown origin.
    #[must_use]
    #[inline(never)]
    pub fn are_ranges_tight(&self) -> bool {
        self.first_loose_column().is_none()
    }

    /// Returns the first column with a range that isn't tight.
    pub(crate) fn first_loose_column(&self) -> Option<(Axis, ColumnAddress)> {
        self.maps.first_loose_column(|voxel| self.rows.contains(voxel))
    }

    /// Returns `true` if every column is saturated: if it has room for another gap, it has no empty voxel
    /// inside its intervals. Always true after an edit, and for columns of one interval.
    #[must_use]
    #[inline(never)]
    pub fn is_saturated(&self) -> bool {
        self.first_unsaturated_column().is_none()
    }

    /// Returns the first column that isn't saturated.
    pub(crate) fn first_unsaturated_column(&self) -> Option<(Axis, ColumnAddress)> {
        self.maps.first_unsaturated_column(|voxel| self.rows.contains(voxel))
    }

    /// Returns the number of occupied voxels.
    #[must_use]
    #[inline(never)]
    pub fn count_voxels(&self) -> u64 {
        self.rows.count_voxels()
    }

    /// Returns `true` if the ground layer y = 0 holds a voxel.
    #[must_use]
    pub fn touches_ground(&self) -> bool {
        self.rows.layer(0).iter().any(|row| !row.is_empty())
    }
}
