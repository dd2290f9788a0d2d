//! Island removal: flood fill over bit rows from the ground layer and the mask, then removal of all
//! voxels that it didn't reach. Source: section 3.4 of the paper, which visits voxel by voxel.
//!
//! A pass keeps one bit grid beside the volume, the *reached* voxels, and a set of queued rows, one bit
//! each, which a cursor visits in cyclic order. A visit extends the reached voxels of a row by whole
//! runs and queues the neighbour rows with voxels next to them. The volume may change between visits:
//! added voxels count as reached at once, removed ones stay reached. So the reached set only grows, only
//! its growth queues rows, and every pass ends.
//!
//! Invariant: in a row that isn't queued, no voxel of `volume & !reached` is a six-neighbour of a
//! reached one. Removing voxels keeps it, and growth of the reached set queues the rows that would
//! break it. With an empty queue, everything connected to ground or mask is therefore reached.

mod bytes;
mod removal;

use crate::limits::{island_removal_row_visits, mask_layout_row_visits};
use crate::volume::bit_grid::BitGrid;
use crate::volume::editable::Volume;
use crate::volume::journal::Journal;
use crate::volume::range_maps::{Axis, RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use bytes::{hash_row, hash_row_in_layer, layer_hash_from_sum};

/// The result of a finished pass.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct IslandReport {
    /// Voxels removed.
    pub removed: u32,
    /// Unsupported voxels that closure keeps, as the ranges can't exclude them; 0 when they are the same
    /// as after the previous pass.
    pub kept: u32,
    /// Neither the ground layer nor the mask holds a voxel. Nothing was removed.
    pub unsupported: bool,
}

/// Rows of a layer as bits of one word of z: bit i of word k is the row at z = 64 k + i.
type RowsOfWord = u64;

/// Open rows about one word of a layer.
struct OpenRows {
    /// Those of the word itself.
    here: RowsOfWord,
    /// The last row of the word before, as the bit of the row that it adjoins.
    last_before: RowsOfWord,
    /// The first row of the word after, likewise.
    first_after: RowsOfWord,
}

/// The result of visiting a row.
struct RowVisit<R> {
    /// The voxels that it marked as reached.
    newly_reached: R,
    /// Whether no unreached voxels remain in the row.
    is_all_reached: bool,
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
    /// Visited rows that had unreached voxels. Every row that has any is queued or open; an open row may
    /// have lost them since.
    open: [<Grid<N> as Size>::Row; N],
    /// The linear hash of `reached`: the sum of its words, each times its key.
    reached_sum: u64,
    /// The same hash of the voxels last reported as kept.
    kept_sum: u64,
    /// The layer at which the sweep continues.
    cursor: u8,
    phase: SearchPhase,
    /// Whether a requested pass hasn't begun.
    pending: bool,
}

impl<const N: usize> IslandSearch<N>
where
    Grid<N>: Size,
{
    /// Idle. For static initialisers only.
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

    /// Counts voxels of row (y, z) that are about to be occupied as reached; see [`Journal::record_added`].
    pub fn mark_added_as_reached(&mut self, (y, z): RowAddress, voxels: <Grid<N> as Size>::Row) {
        // Reached voxels have queued their neighbours already. Queueing them again would let a user who
        // fills and carves one voxel for ever keep the pass from ending.
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

    /// Cancels the running and the requested pass, as the volume was replaced as a whole.
    pub fn cancel_passes(&mut self) {
        self.end_running_pass();
        self.pending = false;
    }

    /// Returns to the initial state: no pass, none requested, nothing reported as kept.
    pub fn reset(&mut self) {
        self.cancel_passes();
        self.kept_sum = 0;
    }

    /// Whether a pass is running or requested.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.pending || matches!(self.phase, SearchPhase::Sweep)
    }

    /// Whether the next [`IslandSearch::advance_pass`] begins a pass.
    pub(crate) fn is_about_to_begin(&self) -> bool {
        self.pending && self.phase == SearchPhase::Idle
    }

    /// Begins a pass if one is called for, which takes [`mask_layout_row_visits`] where there is a mask, and
    /// carries it on by what is left of `max_row_visits`. When it ends, all islands go at once and its report
    /// comes back; the next call removes them if fewer are left than [`island_removal_row_visits`].
    ///
    /// `mask` is part of the volume and the same throughout a pass.
    pub fn advance_pass<const K: usize>(
        &mut self,
        volume: &mut Volume<N, K>,
        mask: &RangeMaps<N, K>,
        max_row_visits: u32,
        journal: &mut impl Journal<N, K>,
    ) -> Option<IslandReport> {
        let mut visits_left = max_row_visits;
        let begins = self.phase == SearchPhase::Idle;
        if begins {
            if !self.pending {
                return None;
            }
            self.pending = false;
            if has_no_support(volume, mask) {
                return Some(IslandReport { unsupported: true, ..Default::default() });
            }
            self.begin_pass(volume, mask);
            if !mask.is_empty() {
                visits_left = visits_left.saturating_sub(mask_layout_row_visits(N));
            }
        }
        let waited = !begins && self.layers.is_empty();
        self.sweep_queue(volume.rows(), &mut visits_left);
        if !self.layers.is_empty() || (visits_left < island_removal_row_visits(N) && !waited) {
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

/// The flood fill of a pass.
impl<const N: usize> IslandSearch<N>
where
    Grid<N>: Size,
{
    /// Begins a pass: marks ground layer and mask as reached and queues all other rows with voxels.
    fn begin_pass<const K: usize>(&mut self, volume: &Volume<N, K>, mask: &RangeMaps<N, K>) {
        let seeded = if mask.is_empty() {
            self.reached.clear();
            1
        } else {
            self.reached.set_from_maps(mask);
            N
        };
        self.reached.layer_mut(0).copy_from_slice(volume.rows().layer(0));
        self.reached_sum = 0;
        for y in 0..seeded {
            let rows = self.reached.layer(y).iter().enumerate().filter(|(_, row)| !row.is_empty());
            let sum =
                rows.fold(0, |sum: u64, (z, row)| sum.wrapping_add(hash_row_in_layer(z, *row)));
            self.reached_sum = self.reached_sum.wrapping_add(layer_hash_from_sum(y, sum));
        }
        for y in 1..N {
            self.queued[y] = volume.maps().occupied_columns(Axis::X, y);
            self.layers.insert_if(!self.queued[y].is_empty(), y);
        }
        self.open.fill(<Grid<N> as Size>::Row::EMPTY);
        self.cursor = 0;
        self.phase = SearchPhase::Sweep;
    }

    /// Visits queued rows layer by layer in cyclic order, each layer until it has none left. Each takes
    /// one from `visits_left`.
    fn sweep_queue(&mut self, voxels: &BitGrid<N>, visits_left: &mut u32) {
        while let Some(y) = next_set_cyclic(self.layers, self.cursor.into()) {
            self.cursor = y as u8;
            if *visits_left == 0 {
                break;
            }
            for z_word in 0..<Grid<N> as Size>::Row::WORDS {
                if self.queued[y].word(z_word) != 0 {
                    self.visit_queued_rows(voxels, y, z_word, visits_left);
                }
            }
            if self.queued[y].is_empty() {
                self.layers.toggle(y);
            }
        }
    }

    /// Visits the queued rows of one word of layer `y`, lowest first, including those queued meanwhile.
    /// Each takes one from `visits_left`.
    fn visit_queued_rows(
        &mut self,
        voxels: &BitGrid<N>,
        y: usize,
        z_word: usize,
        visits_left: &mut u32,
    ) {
        let mut left = *visits_left;
        let mut todo = self.queued[y].word(z_word);
        let mut sum = 0u64;
        let [below, above] = [y.saturating_sub(1), if y + 1 < N { y + 1 } else { y }];
        let beside = (self.open[below] | self.open[above]).word(z_word);
        let OpenRows { here: mut open, last_before: before, first_after: after } =
            self.open_rows_around(y, z_word);
        while todo != 0 && left > 0 {
            let z = z_word * 64 + todo.trailing_zeros() as usize;
            let bit = todo & todo.wrapping_neg();
            todo ^= bit;
            left -= 1;
            let RowVisit { newly_reached: new, is_all_reached } = self.visit_row(voxels, (y, z));
            sum = sum.wrapping_add(hash_row_in_layer(z, new));
            open = if is_all_reached { open & !bit } else { open | bit };
            let near = beside | open << 1 | before | open >> 1 | after;
            if near & bit != 0 && !new.is_empty() {
                todo |= self.queue_neighbours_outside_word(voxels, (y, z), new, z_word);
            }
        }
        self.reached_sum = self.reached_sum.wrapping_add(layer_hash_from_sum(y, sum));
        // Rows of this word were queued in `todo`, rows of the words beside in the queue.
        self.queued[y].set_word(z_word, todo);
        self.open[y].set_word(z_word, open);
        *visits_left = left;
    }

    /// The open rows of one word of layer `y`, and those next to it.
    #[inline]
    fn open_rows_around(&self, y: usize, z_word: usize) -> OpenRows {
        let (open, i) = (self.open[y], z_word);
        let before = if i > 0 { open.word(i - 1) >> 63 } else { 0 };
        let after = if i + 1 < <Grid<N> as Size>::Row::WORDS { open.word(i + 1) << 63 } else { 0 };
        OpenRows { here: open.word(i), last_before: before, first_after: after }
    }

    /// Marks the runs of row (y, z) that touch reached voxels as reached.
    #[inline]
    fn visit_row(
        &mut self,
        voxels: &BitGrid<N>,
        (y, z): RowAddress,
    ) -> RowVisit<<Grid<N> as Size>::Row> {
        let reached = self.reached.row(y, z);
        let medium = voxels.row(y, z) & !reached;
        let mut seeds = reached.shifted_up() | reached.shifted_down();
        for (y, z) in neighbour_rows::<N>((y, z)) {
            seeds |= self.reached.row(y, z);
        }
        let new = medium.flood_from(seeds);
        *self.reached.row_mut(y, z) = reached | new;
        RowVisit { newly_reached: new, is_all_reached: new == medium }
    }

    /// Queues the neighbour rows of (y, z) with unreached voxels next to its newly reached voxels.
    /// Those in the same word of the same layer are returned instead.
    #[cold]
    fn queue_neighbours_outside_word(
        &mut self,
        voxels: &BitGrid<N>,
        (y, z): RowAddress,
        newly_reached: <Grid<N> as Size>::Row,
        z_word: usize,
    ) -> RowsOfWord {
        let mut todo = 0;
        for (beside_y, beside_z) in neighbour_rows::<N>((y, z)) {
            let left = voxels.row(beside_y, beside_z) & !self.reached.row(beside_y, beside_z);
            let woken = !(left & newly_reached).is_empty();
            if beside_y == y && beside_z / 64 == z_word {
                todo |= u64::from(woken) << (beside_z % 64);
            } else {
                self.queue_row_if(woken, (beside_y, beside_z));
            }
        }
        todo
    }

    /// Marks unreached voxels of row (y, z) as reached.
    #[inline]
    fn mark_reached(&mut self, (y, z): RowAddress, unreached: <Grid<N> as Size>::Row) {
        *self.reached.row_mut(y, z) |= unreached;
        self.reached_sum = self.reached_sum.wrapping_add(hash_row((y, z), unreached));
    }

    #[inline]
    fn queue_row_if(&mut self, is_needed: bool, (y, z): RowAddress) {
        self.queued[y].insert_if(is_needed, z);
        self.layers.insert_if(is_needed, y);
    }

    /// Ends the running pass without a result.
    fn end_running_pass(&mut self) {
        self.queued.fill(<Grid<N> as Size>::Row::EMPTY);
        self.layers = <Grid<N> as Size>::Row::EMPTY;
        self.open.fill(<Grid<N> as Size>::Row::EMPTY);
        self.reached_sum = 0;
        self.cursor = 0;
        self.phase = SearchPhase::Idle;
    }
}

/// Whether neither the ground layer nor the mask holds a voxel.
fn has_no_support<const N: usize, const K: usize>(
    volume: &Volume<N, K>,
    mask: &RangeMaps<N, K>,
) -> bool
where
    Grid<N>: Size,
{
    !volume.touches_ground() && mask.is_empty()
}

/// The four neighbour rows of (y, z): y - 1, y + 1, z - 1, z + 1. At the grid's border a missing
/// neighbour is replaced by the row itself, which is harmless: a row doesn't seed itself, and has no
/// unreached voxels where it was just reached.
#[inline]
fn neighbour_rows<const N: usize>((y, z): RowAddress) -> [RowAddress; 4] {
    let before = |i: usize| i.saturating_sub(1);
    let after = |i: usize| if i + 1 < N { i + 1 } else { i };
    [(before(y), z), (after(y), z), (y, before(z)), (y, after(z))]
}

/// The lowest set bit at or above `from`.
#[inline]
fn first_set_from<R: BitSet>(row: R, from: usize) -> Option<usize> {
    let mut word = from / 64;
    let mut bits = if word < R::WORDS { row.word(word) & u64::MAX << (from % 64) } else { 0 };
    while bits == 0 {
        word += 1;
        if word >= R::WORDS {
            return None;
        }
        bits = row.word(word);
    }
    Some(word * 64 + bits.trailing_zeros() as usize)
}

/// The lowest set bit at or above `from`, else the lowest of all.
#[inline]
fn next_set_cyclic<R: BitSet>(row: R, from: usize) -> Option<usize> {
    first_set_from(row, from).or_else(|| row.first())
}
