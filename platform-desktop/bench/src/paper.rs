//! Flood fill over single voxels, the paper's island removal: the rival, implemented as fast as possible.
//!
//! Section 3.4 of the paper: the range maps become a grid of voxels, a queue visits them from the ground
//! layer up through their six neighbours, and the ranges shrink to the visited voxels. The visit can be split
//! after any number of voxels (the paper: 100,000 a frame). Details that the paper leaves open are chosen for
//! speed: one byte a voxel in a padded grid without border tests, a queue that holds each voxel once, and no
//! look at the maps if every voxel was visited.

use paros_core::RangeMaps;
use paros_core::volume::{Axis, Column, Range};

/// Number of voxels that the paper visits in a frame.
pub const PAPER_VISITS: usize = 100_000;

const EMPTY: u8 = 0;
const OCCUPIED: u8 = 1;
const VISITED: u8 = 2;

/// The state of a pass: finished or not.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FillState {
    /// The queue holds more voxels.
    Unfinished,
    /// The queue is empty.
    Done,
}

/// The grid and the queue, which passes reuse.
pub struct VoxelFill<const N: usize> {
    /// (N + 2)^3 voxels, x fastest, then z, then y, with an empty border.
    voxels: Vec<u8>,
    queue: Vec<u32>,
    /// Index of the next voxel in the queue.
    head: usize,
    occupied: usize,
}

impl<const N: usize> VoxelFill<N> {
    const ROW: usize = N + 2;
    const LAYER: usize = Self::ROW * Self::ROW;

    /// Allocates memory for a grid of N^3.
    #[expect(clippy::new_without_default, reason = "it is made once, by size")]
    pub fn new() -> Self {
        VoxelFill {
            voxels: vec![EMPTY; Self::ROW * Self::LAYER],
            queue: Vec::with_capacity(N * N * N),
            head: 0,
            occupied: 0,
        }
    }

    /// Runs a whole pass. Returns the number of voxels removed, before the ranges' intersection restores
    /// some.
    pub fn remove_islands(&mut self, maps: &mut RangeMaps<N>) -> usize {
        self.begin_pass(maps);
        while self.visit_voxels(usize::MAX) != FillState::Done {}
        self.shrink_ranges_to_visited(maps)
    }

    /// Expands the maps to voxels and queues those of the ground layer.
    pub fn begin_pass(&mut self, maps: &RangeMaps<N>) {
        self.occupied = 0;
        for y in 0..N {
            for z in 0..N {
                let start = Self::padded_index(0, y, z);
                let row = &mut self.voxels[start..start + N];
                row.fill(EMPTY);
                let range = maps.column(Axis::X, (y, z)).range(0);
                if range.is_empty() {
                    continue;
                }
                let along_y = &maps.line(Axis::Y, z)[range.first()..=range.last()];
                let along_z = &maps.line(Axis::Z, y)[range.first()..=range.last()];
                let row = &mut row[range.first()..=range.last()];
                for ((voxel, along_y), along_z) in row.iter_mut().zip(along_y).zip(along_z) {
                    let inside = along_y.range(0).contains(y) & along_z.range(0).contains(z);
                    *voxel = u8::from(inside);
                    self.occupied += usize::from(inside);
                }
            }
        }
        self.queue.clear();
        self.head = 0;
        for z in 0..N {
            for x in 0..N {
                self.mark_and_enqueue_if_occupied(Self::padded_index(x, 0, z));
            }
        }
    }

    /// Visits up to `max_visits` queued voxels.
    pub fn visit_voxels(&mut self, max_visits: usize) -> FillState {
        let end = self.head.saturating_add(max_visits);
        while self.head < self.queue.len().min(end) {
            let at = self.queue[self.head] as usize;
            self.head += 1;
            for step in [1, Self::ROW, Self::LAYER] {
                self.mark_and_enqueue_if_occupied(at - step);
                self.mark_and_enqueue_if_occupied(at + step);
            }
        }
        if self.head == self.queue.len() { FillState::Done } else { FillState::Unfinished }
    }

    /// Shrinks the ranges to the visited voxels. Returns the number of voxels not visited.
    pub fn shrink_ranges_to_visited(&mut self, maps: &mut RangeMaps<N>) -> usize {
        let missed = self.occupied - self.queue.len();
        if missed == 0 {
            return 0;
        }
        for axis in Axis::ALL {
            for line in 0..N {
                for place in 0..N {
                    let old = maps.column(axis, (line, place)).range(0);
                    if old.is_empty() {
                        continue;
                    }
                    let [x, y, z] = axis.voxel_at((line, place), 0);
                    let start = Self::padded_index(x, y, z);
                    let step = [1, Self::LAYER, Self::ROW][axis as usize];
                    let visited = |i: &usize| self.voxels[start + i * step] == VISITED;
                    let lo = (old.first()..=old.last()).find(visited);
                    let range = lo.map_or(Range::EMPTY, |lo| {
                        let hi = (lo..=old.last()).rev().find(visited);
                        Range::new(lo, hi.unwrap_or(lo))
                    });
                    if range != old {
                        maps.set_column(axis, (line, place), Column::new([range]));
                    }
                }
            }
        }
        missed
    }

    #[inline]
    fn mark_and_enqueue_if_occupied(&mut self, padded_index: usize) {
        if self.voxels[padded_index] == OCCUPIED {
            self.voxels[padded_index] = VISITED;
            self.queue.push(padded_index as u32);
        }
    }

    #[inline]
    const fn padded_index(x: usize, y: usize, z: usize) -> usize {
        (y + 1) * Self::LAYER + (z + 1) * Self::ROW + x + 1
    }
}
