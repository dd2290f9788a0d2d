//! Islands: grow the supported voxels row by row from ground and mask, then drop what was missed.
//!
//! A pass keeps one plane beside the volume, the voxels *reached* so far, and a set of queued rows,
//! one bit a row, which a cursor sweeps in order and round again. A visit extends what is reached
//! along the row by whole runs and queues the neighbour rows that this touches. Between visits the
//! volume may change: what an edit adds counts as reached at once, what it removes stays reached.
//! So the reached set only grows, a row is queued only by its growth, and every pass ends.
//!
//! In any row that isn't queued no voxel of `volume & !reached` is a six-neighbour of a reached
//! one. Removing voxels from the volume keeps that true, growth of the reached set queues the rows
//! in which it stops being true, and when the queue is empty it says that everything connected to
//! ground or mask is reached. Source: section 3.4 of the paper, which visits voxel by voxel.

mod bytes;
mod removal;

use crate::limits::{mask_visits, removal_visits};
use crate::maps::{Axis, Maps};
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::{Journal, Volume};
use bytes::{keyed, keyed_layer, keyed_row};

/// What a finished pass did.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct IslandReport {
    /// Voxels removed.
    pub removed: u32,
    /// Unsupported voxels that stay because the ranges can't leave them out; 0 when they are the
    /// same as after the pass before.
    pub kept: u32,
    /// Neither ground layer nor mask holds a voxel: nothing can be told apart, nothing went.
    pub unsupported: bool,
}

/// What the pass is at.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
enum Phase {
    Idle = 0,
    Sweep = 1,
}

/// The search for islands in a volume of N^3 voxels, at most one pass in flight.
#[derive(Debug)]
pub struct Islands<const N: usize>
where
    Grid<N>: Size,
{
    /// Voxels found supported, or added since the pass began.
    reached: Plane<N>,
    /// Rows to visit: bit z of `queued[y]` is row (y, z).
    queued: [<Grid<N> as Size>::Row; N],
    /// Layers that hold queued rows.
    layers: <Grid<N> as Size>::Row,
    /// Rows visited that had something left. Any row that has is queued or open; an open one may
    /// have lost it since.
    open: [<Grid<N> as Size>::Row; N],
    /// The sum over the words of `reached`, each times its key.
    reached_sum: u64,
    /// The same for the voxels last reported as kept.
    kept_sum: u64,
    /// The layer at which the sweep goes on.
    cursor: u8,
    phase: Phase,
    /// Whether an edit calls for a pass that hasn't begun.
    pending: bool,
}

impl<const N: usize> Islands<N>
where
    Grid<N>: Size,
{
    /// Idle. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the plane about by value
    pub const fn new() -> Self {
        Islands {
            reached: Plane::new(),
            queued: [<Grid<N> as Size>::Row::EMPTY; N],
            layers: <Grid<N> as Size>::Row::EMPTY,
            open: [<Grid<N> as Size>::Row::EMPTY; N],
            reached_sum: 0,
            kept_sum: 0,
            cursor: 0,
            phase: Phase::Idle,
            pending: false,
        }
    }

    /// The volume was edited: a pass must begin after this. One in flight goes on and is followed
    /// by another.
    pub fn edited(&mut self) {
        self.pending = true;
    }

    /// Voxels of row (y, z) are about to be occupied; see [`Journal::added`].
    pub fn added(&mut self, (y, z): (usize, usize), voxels: <Grid<N> as Size>::Row) {
        // Voxels that are reached already have had their neighbours queued: queueing them again
        // would let a visitor who fills and carves one voxel for ever keep the pass from ending.
        let new = voxels & !self.reached.row(y, z);
        if self.phase == Phase::Idle || new.is_empty() {
            return;
        }
        self.reach(y, z, new);
        self.queue_if(true, y, z);
        for (y, z) in beside::<N>(y, z) {
            self.queue_if(true, y, z);
        }
    }

    /// Gives up the pass in flight and forgets the edits that called for one, as the volume was
    /// replaced as a whole.
    pub fn abort(&mut self) {
        self.stop();
        self.pending = false;
    }

    /// As new: forgets the pass, the edits that called for one, and what was last reported as kept.
    pub fn clear(&mut self) {
        self.abort();
        self.kept_sum = 0;
    }

    /// Whether a pass is in flight or called for.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.pending || matches!(self.phase, Phase::Sweep)
    }

    /// Begins a pass if one is called for, which takes [`mask_visits`] where there is a mask, and
    /// carries it on by what is left of `budget`, in row visits. When
    /// it ends, all islands go at once and its report comes back. The removal is left to the next
    /// call if the visits left to this one are fewer than [`removal_visits`].
    ///
    /// `mask` is part of the volume and the same throughout a pass.
    pub fn advance(
        &mut self,
        volume: &mut Volume<N>,
        mask: &Maps<N>,
        budget: u32,
        journal: &mut impl Journal<N>,
    ) -> Option<IslandReport> {
        let mut budget = budget;
        let begins = self.phase == Phase::Idle;
        if begins {
            if !self.pending {
                return None;
            }
            self.pending = false;
            if unsupported(volume, mask) {
                return Some(IslandReport { unsupported: true, ..Default::default() });
            }
            self.begin(volume, mask);
            if !mask.is_empty() {
                budget = budget.saturating_sub(mask_visits(N));
            }
        }
        let waited = !begins && self.layers.is_empty();
        let left = self.sweep(volume.rows(), budget);
        if !self.layers.is_empty() || (left < removal_visits(N) && !waited) {
            return None;
        }
        let report = if unsupported(volume, mask) {
            IslandReport { unsupported: true, ..Default::default() }
        } else {
            self.remove(volume, journal)
        };
        self.stop();
        Some(report)
    }
}

/// The pass.
impl<const N: usize> Islands<N>
where
    Grid<N>: Size,
{
    /// The ground layer and the mask are reached; all other rows with voxels are queued.
    fn begin(&mut self, volume: &Volume<N>, mask: &Maps<N>) {
        let seeded = if mask.is_empty() {
            self.reached.clear();
            1
        } else {
            self.reached.expand(mask);
            N
        };
        self.reached.layer_mut(0).copy_from_slice(volume.rows().layer(0));
        self.reached_sum = 0;
        for y in 0..seeded {
            let rows = self.reached.layer(y).iter().enumerate().filter(|(_, row)| !row.is_empty());
            let sum = rows.fold(0, |sum: u64, (z, row)| sum.wrapping_add(keyed_row(z, *row)));
            self.reached_sum = self.reached_sum.wrapping_add(keyed_layer(y, sum));
        }
        for y in 1..N {
            self.queued[y] = volume.maps().occupied(Axis::X, y);
            self.layers.insert_if(!self.queued[y].is_empty(), y);
        }
        self.open.fill(<Grid<N> as Size>::Row::EMPTY);
        self.cursor = 0;
        self.phase = Phase::Sweep;
    }

    /// Visits queued rows, a layer at a time until it is through, then the next above that has
    /// any, and round again. The visits left come back.
    fn sweep(&mut self, rows: &Plane<N>, budget: u32) -> u32 {
        let mut left = budget;
        while let Some(y) = next(self.layers, self.cursor.into()) {
            self.cursor = y as u8;
            if left == 0 {
                break;
            }
            for i in 0..<Grid<N> as Size>::Row::WORDS {
                if self.queued[y].word(i) != 0 {
                    left = self.visit_rows(rows, y, i, left);
                }
            }
            if self.queued[y].is_empty() {
                self.layers.toggle(y);
            }
        }
        left
    }

    /// Visits the rows of word `i` of layer y's queue, lowest first, also those queued on the way.
    /// The visits left come back.
    fn visit_rows(&mut self, rows: &Plane<N>, y: usize, i: usize, budget: u32) -> u32 {
        let mut left = budget;
        let mut todo = self.queued[y].word(i);
        let mut sum = 0u64;
        let [below, above] = [y.saturating_sub(1), if y + 1 < N { y + 1 } else { y }];
        let beside = (self.open[below] | self.open[above]).word(i);
        let (mut open, before, after) = self.open_about(y, i);
        while todo != 0 && left > 0 {
            let z = i * 64 + todo.trailing_zeros() as usize;
            let bit = todo & todo.wrapping_neg();
            todo ^= bit;
            left -= 1;
            let (new, all) = self.visit(rows, y, z);
            sum = sum.wrapping_add(keyed_row(z, new));
            open = if all { open & !bit } else { open | bit };
            let near = beside | open << 1 | before | open >> 1 | after;
            if near & bit != 0 && !new.is_empty() {
                todo |= self.wake_beside(rows, (y, z), new, i);
            }
        }
        self.reached_sum = self.reached_sum.wrapping_add(keyed_layer(y, sum));
        // Rows of this word were queued in `todo`, rows of the words beside in the queue.
        self.queued[y].set_word(i, todo);
        self.open[y].set_word(i, open);
        left
    }

    /// Word `i` of the open rows of layer y, and the bits next to it of the words beside, at the
    /// place of the row they are next to.
    #[inline]
    fn open_about(&self, y: usize, i: usize) -> (u64, u64, u64) {
        let open = self.open[y];
        let before = if i > 0 { open.word(i - 1) >> 63 } else { 0 };
        let after = if i + 1 < <Grid<N> as Size>::Row::WORDS { open.word(i + 1) << 63 } else { 0 };
        (open.word(i), before, after)
    }

    /// Reaches the runs of row (y, z) that touch what is reached already. Returns them, and whether
    /// they are all that was left.
    #[inline]
    fn visit(&mut self, rows: &Plane<N>, y: usize, z: usize) -> (<Grid<N> as Size>::Row, bool) {
        let reached = self.reached.row(y, z);
        let medium = rows.row(y, z) & !reached;
        let mut seeds = reached.up() | reached.down();
        for (y, z) in beside::<N>(y, z) {
            seeds |= self.reached.row(y, z);
        }
        let new = medium.runs_with(seeds);
        *self.reached.row_mut(y, z) = reached | new;
        (new, new == medium)
    }

    /// Queues the rows beside row (y, z) that have something left beside its voxels `new`. Those
    /// of the same word `i` of the same layer are returned instead, as bits of that word.
    #[cold]
    fn wake_beside(
        &mut self,
        rows: &Plane<N>,
        (y, z): (usize, usize),
        new: <Grid<N> as Size>::Row,
        i: usize,
    ) -> u64 {
        let mut todo = 0;
        for (beside_y, beside_z) in beside::<N>(y, z) {
            let left = rows.row(beside_y, beside_z) & !self.reached.row(beside_y, beside_z);
            let woken = !(left & new).is_empty();
            if beside_y == y && beside_z / 64 == i {
                todo |= u64::from(woken) << (beside_z % 64);
            } else {
                self.queue_if(woken, beside_y, beside_z);
            }
        }
        todo
    }

    /// Adds voxels that weren't reached.
    #[inline]
    fn reach(&mut self, y: usize, z: usize, new: <Grid<N> as Size>::Row) {
        *self.reached.row_mut(y, z) |= new;
        self.reached_sum = self.reached_sum.wrapping_add(keyed(y, z, new));
    }

    #[inline]
    fn queue_if(&mut self, needed: bool, y: usize, z: usize) {
        self.queued[y].insert_if(needed, z);
        self.layers.insert_if(needed, y);
    }

    /// Forgets the pass in flight.
    fn stop(&mut self) {
        self.queued.fill(<Grid<N> as Size>::Row::EMPTY);
        self.layers = <Grid<N> as Size>::Row::EMPTY;
        self.open.fill(<Grid<N> as Size>::Row::EMPTY);
        self.reached_sum = 0;
        self.cursor = 0;
        self.phase = Phase::Idle;
    }
}

/// Whether no voxel stands on the ground layer and none is masked.
fn unsupported<const N: usize>(volume: &Volume<N>, mask: &Maps<N>) -> bool
where
    Grid<N>: Size,
{
    !volume.touches_ground() && mask.is_empty()
}

/// The rows that share a side with row (y, z): below, above, before, after. At the grid's border
/// the row itself stands for the one that isn't there: no row seeds itself, nor has anything left
/// where it was just reached.
#[inline]
fn beside<const N: usize>(y: usize, z: usize) -> [(usize, usize); 4] {
    let before = |i: usize| i.saturating_sub(1);
    let after = |i: usize| if i + 1 < N { i + 1 } else { i };
    [(before(y), z), (after(y), z), (y, before(z)), (y, after(z))]
}

/// The lowest set bit from `from` on.
#[inline]
fn at_or_after<R: Bits>(row: R, from: usize) -> Option<usize> {
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

/// The lowest set bit from `from` on, else the lowest of all.
#[inline]
fn next<R: Bits>(row: R, from: usize) -> Option<usize> {
    at_or_after(row, from).or_else(|| row.first())
}
