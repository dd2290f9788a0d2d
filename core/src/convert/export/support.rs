//! Flood fill over bit rows with a queue of rows: finds the supported voxels of a volume, which are printed
//! as one connected part.

use crate::volume::bit_grid::BitGrid;
use crate::volume::range_maps::{RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// The phase of the search.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
enum SupportPhase {
    /// Not started.
    Idle,
    /// Seeding with ground and mask voxels, row by row.
    Seed,
    /// Flooding from the seeds.
    Flood,
    /// Without seeds: looking for the next component not yet flooded.
    Component,
    /// Flooding that component and counting its voxels.
    Count,
    /// Flooding only the largest component again.
    Largest,
    /// The supported voxels are found.
    Done,
}

/// A connected component of the volume: one of its voxels, and its size.
#[derive(Clone, Copy)]
struct SolidComponent {
    size: u32,
    voxel: [u8; 3],
}

/// The search, its result and its queue.
pub(super) struct SupportSearch<const N: usize>
where
    Grid<N>: Size,
{
    /// The voxels reached.
    found: BitGrid<N>,
    /// Ring buffer of rows to spread from, as `y N + z`; it starts at `head`.
    queue: [[u16; N]; N],
    head: u32,
    queued: u32,
    /// Bit z of element y is set if row (y, z) is in the queue.
    is_queued: [<Grid<N> as Size>::Row; N],
    /// The next row in the phases that visit all rows.
    next: u32,
    component: SolidComponent,
    largest: SolidComponent,
    phase: SupportPhase,
}

impl<const N: usize> SupportSearch<N>
where
    Grid<N>: Size,
{
    /// Creates an idle search. For static initialisers only.
    pub(super) const fn new() -> Self {
        SupportSearch {
            found: BitGrid::new(),
            queue: [[0; N]; N],
            head: 0,
            queued: 0,
            is_queued: [<Grid<N> as Size>::Row::EMPTY; N],
            next: 0,
            component: SolidComponent { size: 0, voxel: [0; 3] },
            largest: SolidComponent { size: 0, voxel: [0; 3] },
            phase: SupportPhase::Idle,
        }
    }

    /// Starts a new search.
    pub(super) fn restart(&mut self) {
        self.found.clear();
        (self.head, self.queued, self.next) = (0, 0, 0);
        self.is_queued.fill(<Grid<N> as Size>::Row::EMPTY);
        self.largest = SolidComponent { size: 0, voxel: [0; 3] };
        self.phase = SupportPhase::Seed;
    }

    /// Returns the supported voxels; complete once [`SupportSearch::is_done`].
    pub(super) fn supported_voxels(&self) -> &BitGrid<N> {
        &self.found
    }

    pub(super) fn is_done(&self) -> bool {
        self.phase == SupportPhase::Done
    }

    /// Visits rows until the search is done. Each visit takes one from `visits_left`.
    pub(super) fn advance_search<const K: usize>(
        &mut self,
        voxels: &BitGrid<N>,
        mask: &RangeMaps<N, K>,
        visits_left: &mut u32,
    ) {
        while *visits_left > 0 && !self.is_done() {
            *visits_left -= 1;
            self.phase = match self.phase {
                SupportPhase::Seed => self.seed_next_row_from_ground_and_mask(voxels, mask),
                SupportPhase::Flood => self.flood_row(voxels, SupportPhase::Done),
                SupportPhase::Component => self.find_next_component(voxels),
                SupportPhase::Count => self.flood_row(voxels, SupportPhase::Component),
                SupportPhase::Largest => self.flood_row(voxels, SupportPhase::Done),
                SupportPhase::Idle | SupportPhase::Done => return,
            };
            if self.phase == SupportPhase::Component && self.component.size > self.largest.size {
                self.largest = self.component;
            }
        }
    }

    /// Seeds the flood with the ground and mask voxels of the next row.
    fn seed_next_row_from_ground_and_mask<const K: usize>(
        &mut self,
        voxels: &BitGrid<N>,
        seed_mask: &RangeMaps<N, K>,
    ) -> SupportPhase {
        let (y, z) = self.advance_to_next_row();
        let row = voxels.row(y, z);
        let seeds = if y == 0 { row } else { seed_mask.occupied_among((y, z), row) };
        self.reach_runs_with_seeds(voxels, (y, z), seeds);
        // Without a mask, all seeds are in the ground layer.
        if self.next < (N * N) as u32 && !(self.next == N as u32 && seed_mask.is_empty()) {
            return SupportPhase::Seed;
        }
        self.next = 0;
        self.component.size = 0;
        if self.queued > 0 { SupportPhase::Flood } else { SupportPhase::Component }
    }

    /// Spreads from the row at the head of the queue. Returns `next_phase` if the queue is empty.
    fn flood_row(&mut self, voxels: &BitGrid<N>, next_phase: SupportPhase) -> SupportPhase {
        if self.queued == 0 {
            return next_phase;
        }
        let row_index = self.queue.as_flattened()[self.head as usize] as usize;
        self.head = (self.head + 1) % (N * N) as u32;
        self.queued -= 1;
        let (y, z) = (row_index / N, row_index % N);
        self.is_queued[y].toggle(z);
        let row = self.found.row(y, z);
        for near in [(y.wrapping_sub(1), z), (y + 1, z), (y, z.wrapping_sub(1)), (y, z + 1)] {
            if near.0 < N && near.1 < N {
                self.reach_runs_with_seeds(voxels, near, row);
            }
        }
        self.phase
    }

    /// Adds the runs of row (y, z) that contain a voxel of `seeds`, and queues the row if it changed.
    #[inline]
    fn reach_runs_with_seeds(
        &mut self,
        voxels: &BitGrid<N>,
        (y, z): RowAddress,
        seeds: <Grid<N> as Size>::Row,
    ) {
        let (row, found) = (voxels.row(y, z), self.found.row(y, z));
        let new = seeds & row & !found;
        if new.is_empty() {
            return;
        }
        let new = row.flood_from(new);
        if matches!(self.phase, SupportPhase::Component | SupportPhase::Count) {
            self.component.size += new.count_ones();
        }
        *self.found.row_mut(y, z) = found | new;
        if !self.is_queued[y].contains(z) {
            self.is_queued[y].insert(z);
            let tail = (self.head + self.queued) as usize % (N * N);
            self.queue.as_flattened_mut()[tail] = (y * N + z) as u16;
            self.queued += 1;
        }
    }

    /// Starts the next component in the order of the rows. After the last one, floods the largest component
    /// again.
    fn find_next_component(&mut self, voxels: &BitGrid<N>) -> SupportPhase {
        if self.next == (N * N) as u32 {
            return self.flood_largest_component(voxels);
        }
        let (y, z) = self.advance_to_next_row();
        let Some(x) = (voxels.row(y, z) & !self.found.row(y, z)).first() else {
            return SupportPhase::Component;
        };
        // This row may hold another component.
        self.next -= 1;
        self.component = SolidComponent { size: 0, voxel: [x, y, z].map(|c| c as u8) };
        self.reach_runs_with_seeds(voxels, (y, z), <Grid<N> as Size>::Row::span(x, x));
        SupportPhase::Count
    }

    fn flood_largest_component(&mut self, voxels: &BitGrid<N>) -> SupportPhase {
        self.found.clear();
        if self.largest.size == 0 {
            return SupportPhase::Done;
        }
        let [x, y, z] = self.largest.voxel.map(usize::from);
        self.reach_runs_with_seeds(voxels, (y, z), <Grid<N> as Size>::Row::span(x, x));
        SupportPhase::Largest
    }

    fn advance_to_next_row(&mut self) -> RowAddress {
        let row_index = self.next as usize;
        self.next += 1;
        (row_index / N, row_index % N)
    }
}
