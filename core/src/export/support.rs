//! What of a volume holds together in print, by a flood over bit rows with a queue of rows.

use crate::maps::Maps;
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};

/// How far the search has come.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
enum Stage {
    /// Not started.
    Idle,
    /// Looking for ground and mask voxels, row by row.
    Seed,
    /// Flooding from them.
    Flood,
    /// Without any: looking for the next part of the volume not yet flooded.
    Part,
    /// Flooding that part and counting it.
    Count,
    /// Flooding the largest part again, alone.
    Largest,
    /// The voxels are found.
    Done,
}

/// A part of the volume: one of its voxels, and how many it has.
#[derive(Clone, Copy)]
struct Part {
    size: u32,
    voxel: [u8; 3],
}

/// The search, its result and its queue.
pub(super) struct Support<const N: usize>
where
    Grid<N>: Size,
{
    /// What has been reached.
    found: Plane<N>,
    /// Rows still to be spread from, `y N + z`, as a ring that starts at `head`.
    queue: [[u16; N]; N],
    head: u32,
    queued: u32,
    /// The rows in the queue, bit z of row y.
    is_queued: [<Grid<N> as Size>::Row; N],
    /// The next row of the stages that go through all of them.
    next: u32,
    part: Part,
    largest: Part,
    stage: Stage,
}

impl<const N: usize> Support<N>
where
    Grid<N>: Size,
{
    /// At rest. For static initialisers only.
    pub(super) const fn new() -> Self {
        Support {
            found: Plane::new(),
            queue: [[0; N]; N],
            head: 0,
            queued: 0,
            is_queued: [<Grid<N> as Size>::Row::EMPTY; N],
            next: 0,
            part: Part { size: 0, voxel: [0; 3] },
            largest: Part { size: 0, voxel: [0; 3] },
            stage: Stage::Idle,
        }
    }

    /// Begins anew.
    pub(super) fn start(&mut self) {
        self.found.clear();
        (self.head, self.queued, self.next) = (0, 0, 0);
        self.is_queued.fill(<Grid<N> as Size>::Row::EMPTY);
        self.largest = Part { size: 0, voxel: [0; 3] };
        self.stage = Stage::Seed;
    }

    /// The voxels found; complete once [`Support::advance`] has returned true.
    pub(super) fn found(&self) -> &Plane<N> {
        &self.found
    }

    /// Visits rows, each of which takes one from the budget; true when done.
    pub(super) fn advance(&mut self, rows: &Plane<N>, mask: &Maps<N>, budget: &mut u32) -> bool {
        while *budget > 0 && self.stage != Stage::Done {
            *budget -= 1;
            self.stage = match self.stage {
                Stage::Seed => self.seed(rows, mask),
                Stage::Flood => self.flood(rows, Stage::Done),
                Stage::Part => self.look_for_part(rows),
                Stage::Count => self.flood(rows, Stage::Part),
                Stage::Largest => self.flood(rows, Stage::Done),
                Stage::Idle | Stage::Done => return false,
            };
            if self.stage == Stage::Part && self.part.size > self.largest.size {
                self.largest = self.part;
            }
        }
        self.stage == Stage::Done
    }

    /// Takes the ground and mask voxels of the next row.
    fn seed(&mut self, rows: &Plane<N>, mask: &Maps<N>) -> Stage {
        let (y, z) = self.next_row();
        let row = rows.row(y, z);
        let seeds = if y == 0 { row } else { mask.row_among((y, z), row) };
        self.reach(rows, (y, z), seeds);
        // Without a mask the ground layer has all the seeds.
        if self.next < (N * N) as u32 && !(self.next == N as u32 && mask.is_empty()) {
            return Stage::Seed;
        }
        self.next = 0;
        self.part.size = 0;
        if self.queued > 0 { Stage::Flood } else { Stage::Part }
    }

    /// Spreads from the row at the head of the queue; the next stage when there is none.
    fn flood(&mut self, rows: &Plane<N>, then: Stage) -> Stage {
        if self.queued == 0 {
            return then;
        }
        let at = self.queue.as_flattened()[self.head as usize] as usize;
        self.head = (self.head + 1) % (N * N) as u32;
        self.queued -= 1;
        let (y, z) = (at / N, at % N);
        self.is_queued[y].toggle(z);
        let row = self.found.row(y, z);
        for near in [(y.wrapping_sub(1), z), (y + 1, z), (y, z.wrapping_sub(1)), (y, z + 1)] {
            if near.0 < N && near.1 < N {
                self.reach(rows, near, row);
            }
        }
        self.stage
    }

    /// Adds the runs of a row that `seeds` touch, and queues the row if that changed it.
    #[inline]
    fn reach(&mut self, rows: &Plane<N>, (y, z): (usize, usize), seeds: <Grid<N> as Size>::Row) {
        let (row, found) = (rows.row(y, z), self.found.row(y, z));
        let new = seeds & row & !found;
        if new.is_empty() {
            return;
        }
        let new = row.runs_with(new);
        if matches!(self.stage, Stage::Part | Stage::Count) {
            self.part.size += new.count();
        }
        *self.found.row_mut(y, z) = found | new;
        if !self.is_queued[y].contains(z) {
            self.is_queued[y].insert(z);
            let tail = (self.head + self.queued) as usize % (N * N);
            self.queue.as_flattened_mut()[tail] = (y * N + z) as u16;
            self.queued += 1;
        }
    }

    /// Begins the next part in the order of the rows, or the largest one after the last.
    fn look_for_part(&mut self, rows: &Plane<N>) -> Stage {
        if self.next == (N * N) as u32 {
            return self.take_largest(rows);
        }
        let (y, z) = self.next_row();
        let Some(x) = (rows.row(y, z) & !self.found.row(y, z)).first() else {
            return Stage::Part;
        };
        // This row may hold another part.
        self.next -= 1;
        self.part = Part { size: 0, voxel: [x, y, z].map(|c| c as u8) };
        self.reach(rows, (y, z), <Grid<N> as Size>::Row::span(x, x));
        Stage::Count
    }

    fn take_largest(&mut self, rows: &Plane<N>) -> Stage {
        self.found.clear();
        if self.largest.size == 0 {
            return Stage::Done;
        }
        let [x, y, z] = self.largest.voxel.map(usize::from);
        self.reach(rows, (y, z), <Grid<N> as Size>::Row::span(x, x));
        Stage::Largest
    }

    fn next_row(&mut self) -> (usize, usize) {
        let at = self.next as usize;
        self.next += 1;
        (at / N, at % N)
    }
}
