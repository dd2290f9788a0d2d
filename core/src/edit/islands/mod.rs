//! Island removal: flood fill over bit rows from the ground layer and the mask, then removal of all voxels
//! that weren't reached. Source: section 3.4 of the paper, which visits voxel by voxel.
//!
//! A pass keeps one bit grid beside the volume, the *reached* voxels, and a set of queued rows, one bit
//! each, which a cursor visits in cyclic order. A visit extends the reached voxels of a row by whole
//! runs and queues the neighbour rows with voxels next to them. The volume may change between visits:
//! added voxels count as reached at once, removed ones stay reached. So the reached set only grows, only
//! its growth queues rows, and every pass ends.
//!
//! A pass begins with the ground reached and all other rows queued. A row's voxels of the mask are marked as
//! reached on its first visit, so no tick pays for rasterising the whole mask.
//!
//! Invariant: in a row that isn't queued, no voxel of `volume & !reached` belongs to the mask or is a
//! six-neighbour of a reached voxel. Removing voxels preserves it, and growth of the reached set queues the
//! rows that would break it. With an empty queue, everything connected to ground or mask is therefore
//! reached.

mod bytes;
mod removal;
mod sweep;

use crate::limits::island_removal_row_visits;
use crate::volume::bit_grid::BitGrid;
use crate::volume::editable::Volume;
use crate::volume::journal::Journal;
use crate::volume::range_maps::{RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use sweep::neighbour_rows;

/// The result of a finished pass.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct IslandReport {
    /// Voxels removed.
    pub removed: u32,
    /// Unsupported voxels that closure keeps, as the ranges can't exclude them; 0 if they are the same as
    /// after the previous pass.
    pub kept: u32,
    /// `true` if neither the ground layer nor the mask holds a voxel. Nothing was removed.
    pub unsupported: bool,
}

/// The phase of a pass.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
enum SearchPhase {
    Idle = 0,
    Sweep = 1,
}

/// The incremental island search in a volume of N^3 voxels; at most one pass runs at a time.
#[derive(Debug)]
pub struct IslandSearch<const N: usize>
where
    Grid<N>: Size,
{
    /// Voxels found supported, or added since the pass began.
    reached: BitGrid<N>,
    /// Rows to visit: bit z of `queued[y]` is row (y, z).
    queued: [<Grid<N> as Size>::Row; N],
    /// Layers that hold queued rows.
    layers: <Grid<N> as Size>::Row,
    /// Rows that were visited and had unreached voxels, none of them of the mask. Every row with unreached
    /// voxels is queued or open; an open row may have lost them since.
    open: [<Grid<N> as Size>::Row; N],
    /// The linear hash of `reached`: the sum of its words, each times its key.
    reached_sum: u64,
    /// The linear hash of the voxels last reported as kept.
    kept_sum: u64,
    /// The layer at which the sweep continues.
    cursor: u8,
    phase: SearchPhase,
    /// `true` if a requested pass hasn't begun.
    pending: bool,
}

impl<const N: usize> IslandSearch<N>
where
    Grid<N>: Size,
{
    /// Creates an idle search. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the plane about by value
    pub const fn new() -> Self {
        IslandSearch {
            reached: BitGrid::new(),
            queued: [<Grid<N> as Size>::Row::EMPTY; N],
            layers: <Grid<N> as Size>::Row::EMPTY,
            open: [<Grid<N> as Size>::Row::EMPTY; N],
            reached_sum: 0,
            kept_sum: 0,
            cursor: 0,
            phase: SearchPhase::Idle,
            pending: false,
        }
    }

    /// Requests a pass, after an edit of the volume. A running pass continues and is followed by
    /// another.
    pub fn request_pass(&mut self) {
        self.pending = true;
    }

    /// Marks voxels of row (y, z) that are about to be occupied as reached; see [`Journal::record_added`].
    pub fn mark_added_as_reached(&mut self, (y, z): RowAddress, voxels: <Grid<N> as Size>::Row) {
        // Reached voxels have already queued their neighbours. Queueing them again would let a user who fills
        // and carves one voxel for ever keep the pass from ending.
        let new = voxels & !self.reached.row(y, z);
        if self.phase == SearchPhase::Idle || new.is_empty() {
            return;
        }
        self.mark_reached((y, z), new);
        self.queue_row_if(true, (y, z));
        for row in neighbour_rows::<N>((y, z)) {
            self.queue_row_if(true, row);
        }
    }

    /// Cancels the running pass and requests another, after a part of the volume was replaced.
    pub fn restart_pass(&mut self) {
        self.end_running_pass();
        self.pending = true;
    }

    /// Cancels the running and the requested pass, after the whole volume was replaced.
    pub fn cancel_passes(&mut self) {
        self.end_running_pass();
        self.pending = false;
    }

    /// Returns to the initial state: no pass, none requested, nothing reported as kept.
    pub fn reset(&mut self) {
        self.cancel_passes();
        self.kept_sum = 0;
    }

    /// Returns `true` if a pass is running or requested.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.pending || matches!(self.phase, SearchPhase::Sweep)
    }

    /// Returns `true` if no pass is running.
    pub(crate) fn is_idle(&self) -> bool {
        self.phase == SearchPhase::Idle
    }

    /// Returns `true` if a pass has visited all its rows and the next [`IslandSearch::advance_pass`] ends it.
    pub(crate) fn is_removal_due(&self) -> bool {
        self.phase == SearchPhase::Sweep && self.layers.is_empty()
    }

    /// Begins a pass if one is requested, and continues it by `max_row_visits`. When the pass ends, all
    /// islands are removed at once and its report is returned. If fewer visits are left than
    /// [`island_removal_row_visits`], the removal is postponed to the next call.
    ///
    /// `mask` must be part of the volume and must not change during a pass.
    pub fn advance_pass<const K: usize>(
        &mut self,
        volume: &mut Volume<N, K>,
        mask: &RangeMaps<N, K>,
        max_row_visits: u32,
        journal: &mut dyn Journal<N, K>,
    ) -> Option<IslandReport> {
        let mut visits_left = max_row_visits;
        let has_waited = self.is_removal_due();
        if self.phase == SearchPhase::Idle {
            if !self.pending {
                return None;
            }
            self.pending = false;
            if has_no_support(volume, mask) {
                return Some(IslandReport { unsupported: true, ..Default::default() });
            }
            self.begin_pass(volume);
        }
        self.sweep_queue(volume.rows(), mask, &mut visits_left);
        if !self.layers.is_empty() || (visits_left < island_removal_row_visits(N) && !has_waited) {
            return None;
        }
        let report = if has_no_support(volume, mask) {
            IslandReport { unsupported: true, ..Default::default() }
        } else {
            self.remove_islands(volume, journal)
        };
        self.end_running_pass();
        Some(report)
    }
}

/// Returns `true` if neither the ground layer nor the mask holds a voxel.
fn has_no_support<const N: usize, const K: usize>(
    volume: &Volume<N, K>,
    mask: &RangeMaps<N, K>,
) -> bool
where
    Grid<N>: Size,
{
    !volume.touches_ground() && mask.is_empty()
}
