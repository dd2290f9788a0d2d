//! The editable volume: range maps and bit rows in sync, every changed column journalled.

use crate::codec::digest::DIGEST_KEYS;
use crate::volume::bit_grid::BitGrid;
use crate::volume::column_digest::{column_digest, column_number, line_key, maps_digest};
use crate::volume::journal::Journal;
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RangeMaps};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// N^3 voxels: three tight range maps, the bit rows of their intersection, and a running digest.
#[derive(Debug)]
pub struct Volume<const N: usize>
where
    Grid<N>: Size,
{
    maps: RangeMaps<N>,
    rows: BitGrid<N>,
    digest: u64,
}

impl<const N: usize> Volume<N>
where
    Grid<N>: Size,
{
    /// The empty volume. For a `static`, as [`World::new`](crate::World::new).
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would be moved by value
    pub const fn new() -> Self {
        Volume { maps: RangeMaps::new(), rows: BitGrid::new(), digest: 0 }
    }

    /// Becomes the volume of these range maps, which must be tight.
    pub fn set_maps(&mut self, maps: &RangeMaps<N>) {
        self.maps.copy_from(maps);
        self.rebuild_from_maps();
    }

    /// Becomes the closure of the voxels that `fill_empty` sets in an empty grid.
    pub fn set_voxels(&mut self, fill_empty: impl FnOnce(&mut BitGrid<N>)) {
        self.rows.clear();
        fill_empty(&mut self.rows);
        self.rows.write_hulls(&mut self.maps);
        self.rebuild_from_maps();
    }

    /// Rebuilds bit rows and digest after the range maps were replaced.
    fn rebuild_from_maps(&mut self) {
        self.rows.set_from_maps(&self.maps);
        self.digest = maps_digest(&self.maps);
    }

    /// Rebuilds the bit rows after [`Volume::replace_column_leaving_bit_rows`].
    pub(crate) fn rebuild_rows(&mut self) {
        self.rows.set_from_maps(&self.maps);
    }

    /// The range maps.
    #[must_use]
    pub const fn maps(&self) -> &RangeMaps<N> {
        &self.maps
    }

    /// The bit rows.
    #[must_use]
    pub const fn rows(&self) -> &BitGrid<N> {
        &self.rows
    }

    /// The bit rows, mutable. The caller updates the range maps afterwards.
    pub(crate) fn rows_mut(&mut self) -> &mut BitGrid<N> {
        &mut self.rows
    }

    /// The [`maps_digest`](crate::internals::maps_digest) of the range maps, updated incrementally.
    #[must_use]
    pub const fn digest(&self) -> u64 {
        self.digest
    }

    /// Replaces the columns at `places` of a line by those of `new`, and journals them. Each must
    /// differ from the old one.
    #[inline]
    pub(crate) fn replace_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        new: &[Column; N],
        journal: &mut impl Journal<N>,
    ) {
        if places.is_empty() {
            return;
        }
        let old = self.maps.line_mut(axis, line);
        journal.record_columns(axis, line, places, old);
        let mut sum = 0u64;
        for run in places.iter_runs() {
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

    /// Replaces one column without journalling it, and returns the old one. The bit rows are stale
    /// until [`Volume::rebuild_rows`].
    #[inline]
    pub(crate) fn replace_column_leaving_bit_rows(
        &mut self,
        axis: Axis,
        at: ColumnAddress,
        column: Column,
    ) -> Column {
        let old = self.maps.column(axis, at);
        self.digest = self
            .digest
            .wrapping_sub(column_digest(axis, at, old))
            .wrapping_add(column_digest(axis, at, column));
        self.maps.set_column(axis, at, column);
        old
    }

    /// Whether every range is tight: both its end voxels are occupied. Always true after an edit; a
    /// check for range maps of unknown origin.
    #[must_use]
    pub fn are_ranges_tight(&self) -> bool {
        Axis::ALL.into_iter().all(|axis| {
            (0..N).all(|line| {
                self.maps.line(axis, line).iter().enumerate().all(|(place, column)| {
                    column.0.iter().filter(|range| !range.is_empty()).all(|range| {
                        let end = |i| self.rows.contains(axis.voxel_at((line, place), i));
                        end(range.first()) && end(range.last())
                    })
                })
            })
        })
    }

    /// Number of occupied voxels.
    #[must_use]
    pub fn count_voxels(&self) -> u64 {
        self.rows.count_voxels()
    }

    /// Whether the ground layer y = 0 holds a voxel.
    #[must_use]
    pub fn touches_ground(&self) -> bool {
        self.rows.layer(0).iter().any(|row| !row.is_empty())
    }
}
