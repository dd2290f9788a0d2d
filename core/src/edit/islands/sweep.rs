//! The flood fill of an island pass, a row at a time.

use super::bytes::{hash_row, hash_row_in_layer, layer_hash_from_sum};
use super::{IslandSearch, SearchPhase};
use crate::volume::bit_grid::BitGrid;
use crate::volume::editable::Volume;
use crate::volume::range_maps::{Axis, Column, RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// Rows of a layer as bits of one word of z: bit i of word k is the row at z = 64 k + i.
type RowsOfWord = u64;

/// Open rows around one word of a layer.
struct OpenRows {
    /// The open rows in the word itself.
    here: RowsOfWord,
    /// The last row of the previous word, as the bit of its neighbour in this word.
    last_before: RowsOfWord,
    /// The first row of the next word, as the bit of its neighbour in this word.
    first_after: RowsOfWord,
}

/// The result of visiting a row.
struct RowVisit<R> {
    /// The voxels that the visit marked as reached.
    newly_reached: R,
    /// `true` if no unreached voxels remain in the row.
    is_all_reached: bool,
}

impl<const N: usize> IslandSearch<N>
where
    Grid<N>: Size,
{
    /// Begins a pass: marks the ground layer as reached and queues all other rows with voxels.
    pub(super) fn begin_pass<const K: usize>(&mut self, volume: &Volume<N, K>) {
        self.reached.clear();
        self.reached.layer_mut(0).copy_from_slice(volume.rows().layer(0));
        let ground = self.reached.layer(0).iter().enumerate();
        let sum = ground.fold(0, |sum: u64, (z, row)| sum.wrapping_add(hash_row_in_layer(z, *row)));
        self.reached_sum = layer_hash_from_sum(0, sum);
        for y in 1..N {
            self.queued[y] = volume.maps().occupied_columns(Axis::X, y);
            self.layers.insert_if(!self.queued[y].is_empty(), y);
        }
        self.open.fill(<Grid<N> as Size>::Row::EMPTY);
        self.cursor = 0;
        self.phase = SearchPhase::Sweep;
    }

    /// Visits queued rows layer by layer in cyclic order, each layer until it has none left. Each visit takes
    /// one from `visits_left`.
    pub(super) fn sweep_queue<const K: usize>(
        &mut self,
        voxels: &BitGrid<N>,
        mask: &RangeMaps<N, K>,
        visits_left: &mut u32,
    ) {
        while let Some(y) = next_set_cyclic(self.layers, self.cursor.into()) {
            self.cursor = y as u8;
            if *visits_left == 0 {
                break;
            }
            for z_word in 0..<Grid<N> as Size>::Row::WORDS {
                if self.queued[y].word(z_word) != 0 {
                    self.visit_queued_rows(voxels, mask, (y, z_word), visits_left);
                }
            }
            if self.queued[y].is_empty() {
                self.layers.toggle(y);
            }
        }
    }

    /// Visits the queued rows of one word of layer `y`, lowest first, including rows queued meanwhile. Each
    /// visit takes one from `visits_left`.
    fn visit_queued_rows<const K: usize>(
        &mut self,
        voxels: &BitGrid<N>,
        mask: &RangeMaps<N, K>,
        (y, z_word): (usize, usize),
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
            let unseen_mask = (open & bit == 0).then_some(mask);
            let RowVisit { newly_reached: new, is_all_reached } =
                self.visit_row(voxels, unseen_mask, (y, z));
            sum = sum.wrapping_add(hash_row_in_layer(z, new));
            open = if is_all_reached { open & !bit } else { open | bit };
            let near = beside | open << 1 | before | open >> 1 | after;
            if near & bit != 0 && !new.is_empty() {
                todo |= self.queue_neighbours_outside_word(voxels, (y, z), new, z_word);
            }
        }
        self.reached_sum = self.reached_sum.wrapping_add(layer_hash_from_sum(y, sum));
        // Rows of this word were queued in `todo`, rows of the neighbouring words in the queue.
        self.queued[y].set_word(z_word, todo);
        self.open[y].set_word(z_word, open);
        *visits_left = left;
    }

    /// Returns the open rows of one word of layer `y`, and the rows next to it.
    #[inline]
    fn open_rows_around(&self, y: usize, z_word: usize) -> OpenRows {
        let (open, i) = (self.open[y], z_word);
        let before = if i > 0 { open.word(i - 1) >> 63 } else { 0 };
        let after = if i + 1 < <Grid<N> as Size>::Row::WORDS { open.word(i + 1) << 63 } else { 0 };
        OpenRows { here: open.word(i), last_before: before, first_after: after }
    }

    /// Marks the runs of row (y, z) that touch reached voxels, or hold voxels of `unseen_mask`, as reached.
    #[inline]
    fn visit_row<const K: usize>(
        &mut self,
        voxels: &BitGrid<N>,
        unseen_mask: Option<&RangeMaps<N, K>>,
        (y, z): RowAddress,
    ) -> RowVisit<<Grid<N> as Size>::Row> {
        let reached = self.reached.row(y, z);
        let medium = voxels.row(y, z) & !reached;
        let mut seeds = reached.shifted_up() | reached.shifted_down();
        for (y, z) in neighbour_rows::<N>((y, z)) {
            seeds |= self.reached.row(y, z);
        }
        let mut new = medium.flood_from(seeds);
        if let Some(mask) = unseen_mask
            && mask.column(Axis::X, (y, z)) != Column::EMPTY
            && new != medium
        {
            new |= flood_from_mask(medium & !new, mask, (y, z));
        }
        *self.reached.row_mut(y, z) = reached | new;
        RowVisit { newly_reached: new, is_all_reached: new == medium }
    }

    /// Queues the neighbour rows of (y, z) with unreached voxels next to its newly reached voxels. Rows in
    /// the same word of the same layer are returned instead.
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
    pub(super) fn mark_reached(&mut self, (y, z): RowAddress, unreached: <Grid<N> as Size>::Row) {
        *self.reached.row_mut(y, z) |= unreached;
        self.reached_sum = self.reached_sum.wrapping_add(hash_row((y, z), unreached));
    }

    #[inline]
    pub(super) fn queue_row_if(&mut self, is_needed: bool, (y, z): RowAddress) {
        self.queued[y].insert_if(is_needed, z);
        self.layers.insert_if(is_needed, y);
    }

    /// Ends the running pass without a result.
    pub(super) fn end_running_pass(&mut self) {
        self.queued.fill(<Grid<N> as Size>::Row::EMPTY);
        self.layers = <Grid<N> as Size>::Row::EMPTY;
        self.open.fill(<Grid<N> as Size>::Row::EMPTY);
        self.reached_sum = 0;
        self.cursor = 0;
        self.phase = SearchPhase::Idle;
    }
}

/// Returns the runs of `medium`, voxels of row (y, z), that contain voxels of the mask.
fn flood_from_mask<R: BitSet, const N: usize, const K: usize>(
    medium: R,
    mask: &RangeMaps<N, K>,
    row: RowAddress,
) -> R
where
    Grid<N>: Size<Row = R>,
{
    // Ranges are tight: their ends are voxels of the mask, and most runs with mask voxels contain one of
    // these ends.
    let column = mask.column(Axis::X, row);
    let mut ends = R::EMPTY;
    for range in column.intervals() {
        ends.insert(range.first());
        ends.insert(range.last());
    }
    let new = medium.flood_from(ends);
    let rest = mask.occupied_among(row, medium & !new);
    new | if rest.is_empty() { rest } else { medium.flood_from(rest) }
}

/// Returns the four neighbour rows of (y, z): y - 1, y + 1, z - 1, z + 1. At the grid's border a missing
/// neighbour is replaced by the row itself, which is harmless: a row doesn't seed itself, and has no
/// unreached voxels where it was just reached.
#[inline]
pub(super) fn neighbour_rows<const N: usize>((y, z): RowAddress) -> [RowAddress; 4] {
    let before = |i: usize| i.saturating_sub(1);
    let after = |i: usize| if i + 1 < N { i + 1 } else { i };
    [(before(y), z), (after(y), z), (y, before(z)), (y, after(z))]
}

/// Returns the lowest set bit at or above `from`.
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

/// Returns the lowest set bit at or above `from`, else the lowest of all.
#[inline]
fn next_set_cyclic<R: BitSet>(row: R, from: usize) -> Option<usize> {
    first_set_from(row, from).or_else(|| row.first())
}
