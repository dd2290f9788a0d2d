//! Model of the range maps: a set of voxels as one boolean each. Column hull, closure, support by flood fill
//! and distance in steps follow their naive definitions. Also has proptest strategies for volumes.

use paros_core::RangeMaps;
use paros_core::internals::ColumnAddress;
use paros_core::volume::{Axis, BitGrid, BitSet, Column, Grid, Range, Size, VoxelBox};
use proptest::prelude::*;

/// The offsets of the six face neighbours.
pub const NEIGHBOUR_STEPS: [[i32; 3]; 6] =
    [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];

/// A set of voxels in a grid of `n`^3: one boolean a voxel.
#[derive(Clone, PartialEq, Eq)]
pub struct DenseVolume {
    n: usize,
    voxels: Vec<bool>,
}

impl DenseVolume {
    /// Returns the empty set in a grid of `side`^3 voxels.
    pub fn empty(side: usize) -> Self {
        DenseVolume { n: side, voxels: vec![false; side * side * side] }
    }

    /// Returns the voxels for which `occupied` returns true.
    pub fn from_fn(side: usize, mut occupied: impl FnMut([i32; 3]) -> bool) -> Self {
        let n = side as i32;
        let mut voxels = Vec::with_capacity(side * side * side);
        for y in 0..n {
            for z in 0..n {
                voxels.extend((0..n).map(|x| occupied([x, y, z])));
            }
        }
        DenseVolume { n: side, voxels }
    }

    /// Returns the intersection of the three maps.
    pub fn from_maps<const N: usize, const K: usize>(maps: &RangeMaps<N, K>) -> Self {
        DenseVolume::from_columns(N, |axis, at| maps.column(axis, at).intervals())
    }

    /// Returns the voxels that lie in an interval of each of the three columns through them.
    pub fn from_columns<I: IntoIterator<Item = Range>>(
        side: usize,
        intervals_of: impl Fn(Axis, ColumnAddress) -> I,
    ) -> Self {
        let mut held = vec![0u8; side * side * side];
        for axis in Axis::ALL {
            for at in (0..side * side).map(|at| (at / side, at % side)) {
                let (start, step) = stride_of_column(side, axis, at);
                for range in intervals_of(axis, at) {
                    let ends = start + range.first() * step..=start + range.last() * step;
                    held[ends].iter_mut().step_by(step).for_each(|axes| *axes |= 1 << axis as u8);
                }
            }
        }
        DenseVolume { n: side, voxels: held.into_iter().map(|axes| axes == 0b111).collect() }
    }

    /// Returns the voxels of a bit grid.
    pub fn from_bits<const N: usize>(bits: &BitGrid<N>) -> Self
    where
        Grid<N>: Size,
    {
        let mut dense = DenseVolume::empty(N);
        for (at, row) in dense.voxels.chunks_exact_mut(N).enumerate() {
            bits.row(at / N, at % N).iter_ones().for_each(|x| row[x] = true);
        }
        dense
    }

    /// Sets the occupied voxels in an empty bit grid.
    pub fn insert_into_empty_bits<const N: usize>(&self, empty_bits: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        for (at, row) in self.voxels.chunks_exact(N).enumerate() {
            let bits = empty_bits.row_mut(at / N, at % N);
            row.iter().enumerate().filter(|(_, bit)| **bit).for_each(|(x, _)| bits.insert(x));
        }
    }

    /// Writes the tight hulls of the columns.
    pub fn write_maps<const N: usize>(&self, maps: &mut RangeMaps<N>) {
        for axis in Axis::ALL {
            for line in 0..N {
                for place in 0..N {
                    let range = self.column_hull(axis, (line, place)).unwrap_or(Range::EMPTY);
                    maps.set_column(axis, (line, place), Column::new([range]));
                }
            }
        }
    }

    /// Returns the grid's side in voxels.
    pub fn side(&self) -> usize {
        self.n
    }

    /// Returns every voxel of the grid.
    pub fn all_voxels(&self) -> impl Iterator<Item = [i32; 3]> + use<> {
        let n = self.n as i32;
        (0..n).flat_map(move |y| (0..n).flat_map(move |z| (0..n).map(move |x| [x, y, z])))
    }

    /// Returns every occupied voxel.
    pub fn occupied(&self) -> impl Iterator<Item = [i32; 3]> {
        let n = self.n;
        let rows = (0..n * n).map(move |at| (at, &self.voxels[at * n..][..n]));
        rows.filter(|(_, row)| row.contains(&true)).flat_map(move |(at, row)| {
            let occupied = row.iter().enumerate().filter(|(_, occupied)| **occupied);
            occupied.map(move |(x, _)| [x, at / n, at % n].map(|i| i as i32))
        })
    }

    /// Returns `true` if a voxel lies in the grid and is occupied.
    pub fn contains(&self, voxel: [i32; 3]) -> bool {
        self.index(voxel).is_some_and(|i| self.voxels[i])
    }

    /// Returns the voxels of row (y, z), by x.
    pub fn row(&self, y: usize, z: usize) -> &[bool] {
        &self.voxels[(y * self.n + z) * self.n..][..self.n]
    }

    /// Sets or clears a voxel of the grid.
    pub fn set(&mut self, voxel: [i32; 3], occupied: bool) {
        let i = self.index(voxel).expect("a voxel of the grid");
        self.voxels[i] = occupied;
    }

    /// Returns the number of occupied voxels.
    pub fn count(&self) -> u32 {
        self.voxels.iter().map(|&occupied| u32::from(occupied)).sum()
    }

    /// Returns the smallest box around the occupied voxels.
    pub fn bounding_box(&self) -> VoxelBox {
        VoxelBox::new([0, 1, 2].map(|i| {
            let along = || self.occupied().map(|voxel| voxel[i] as usize);
            along().min().zip(along().max()).map_or(Range::EMPTY, |(lo, hi)| Range::new(lo, hi))
        }))
    }

    /// Returns `true` if no voxel is occupied.
    pub fn is_empty(&self) -> bool {
        !self.voxels.contains(&true)
    }

    /// Returns the union of two sets.
    pub fn union(&self, other: &DenseVolume) -> DenseVolume {
        self.zip(other, |a, b| a | b)
    }

    /// Adds the voxels of another set.
    pub fn extend(&mut self, other: &DenseVolume) {
        assert_eq!(self.n, other.n, "grids of one size");
        self.voxels.iter_mut().zip(&other.voxels).for_each(|(here, there)| *here |= there);
    }

    /// Returns the intersection of two sets.
    pub fn intersection(&self, other: &DenseVolume) -> DenseVolume {
        self.zip(other, |a, b| a & b)
    }

    /// Returns the voxels of this set that the other lacks.
    pub fn difference(&self, other: &DenseVolume) -> DenseVolume {
        self.zip(other, |a, b| a & !b)
    }

    /// Returns `true` if the other set contains every voxel of this one.
    pub fn is_within(&self, other: &DenseVolume) -> bool {
        self.difference(other).is_empty()
    }

    /// Returns the mirror image across the grid's middle: x becomes n - 1 - x.
    pub fn mirrored_in_x(&self) -> DenseVolume {
        let mut mirrored = self.clone();
        mirrored.voxels.chunks_exact_mut(self.n).for_each(<[bool]>::reverse);
        mirrored
    }

    /// Returns the voxels of a column, in order.
    pub fn column(
        &self,
        axis: Axis,
        at: ColumnAddress,
    ) -> impl DoubleEndedIterator<Item = bool> + ExactSizeIterator {
        let (start, step) = stride_of_column(self.n, axis, at);
        self.voxels[start..=start + (self.n - 1) * step].iter().step_by(step).copied()
    }

    /// Returns the first and last occupied voxel of a column; `None` if it is empty.
    pub fn column_hull(&self, axis: Axis, at: ColumnAddress) -> Option<Range> {
        let first = self.column(axis, at).position(|occupied| occupied)?;
        let last = self.column(axis, at).rposition(|occupied| occupied)?;
        Some(Range::new(first, last))
    }

    /// Returns the closure: the voxels that lie within the hulls of all three columns through them.
    pub fn closure(&self) -> DenseVolume {
        DenseVolume::from_columns(self.n, |axis, at| self.column_hull(axis, at))
    }

    /// Returns the support S(V): the voxels connected by six-neighbour steps inside the volume to its ground
    /// layer y = 0 or to its voxels in the mask.
    pub fn supported_by_ground_or(&self, mask: &DenseVolume) -> DenseVolume {
        let seeds = self.occupied().filter(|&voxel| voxel[1] == 0 || mask.contains(voxel));
        self.connected_to(seeds.collect())
    }

    /// Flood fill: returns the occupied voxels connected to the seeds, which must be occupied.
    pub fn connected_to(&self, seeds: Vec<[i32; 3]>) -> DenseVolume {
        let mut found = DenseVolume::empty(self.n);
        let mut left = seeds;
        while let Some(voxel) = left.pop() {
            if let Some(i) = self.index(voxel)
                && self.voxels[i]
                && !found.voxels[i]
            {
                found.voxels[i] = true;
                left.extend(face_neighbours(voxel));
            }
        }
        found
    }

    /// Returns the voxels at most `max_steps` six-neighbour steps from a voxel for which `is_seed` returns
    /// true. Steps and seeds include the layer of voxels around the grid.
    pub fn within_face_steps(
        &self,
        max_steps: usize,
        is_seed: impl Fn([i32; 3]) -> bool,
    ) -> DenseVolume {
        let n = self.n as i32;
        // A second layer around that layer is a sentinel that is never entered.
        let side = self.n + 4;
        let index = |[x, y, z]: [i32; 3]| {
            ((y + 2) as usize * side + (z + 2) as usize) * side + (x + 2) as usize
        };
        let mut near = vec![true; side * side * side];
        let mut front = Vec::new();
        for (y, z) in (-1..=n).flat_map(|y| (-1..=n).map(move |z| (y, z))) {
            for x in -1..=n {
                near[index([x, y, z])] = is_seed([x, y, z]);
                if near[index([x, y, z])] {
                    front.push(index([x, y, z]));
                }
            }
        }
        for _ in 0..max_steps {
            for place in std::mem::take(&mut front) {
                for step in [1, side, side * side] {
                    for beside in [place - step, place + step] {
                        if !near[beside] {
                            near[beside] = true;
                            front.push(beside);
                        }
                    }
                }
            }
        }
        DenseVolume::from_fn(self.n, |voxel| near[index(voxel)])
    }

    /// Returns the voxels at most `max_steps` six-neighbour steps from an empty voxel; outside counts as
    /// empty.
    pub fn within_steps_of_empty(&self, max_steps: usize) -> DenseVolume {
        self.within_face_steps(max_steps, |place| !self.contains(place))
    }

    /// Returns the voxels at most `max_steps` six-neighbour steps from an occupied voxel or from the ground,
    /// which is everywhere under y = 0.
    pub fn within_steps_of_occupied(&self, max_steps: usize) -> DenseVolume {
        self.within_face_steps(max_steps, |place| place[1] < 0 || self.contains(place))
    }

    fn index(&self, [x, y, z]: [i32; 3]) -> Option<usize> {
        // As an unsigned number a negative coordinate is large, so one comparison covers both ends.
        let [x, y, z] = [x as u32 as usize, y as u32 as usize, z as u32 as usize];
        if x < self.n && y < self.n && z < self.n {
            Some((y * self.n + z) * self.n + x)
        } else {
            None
        }
    }

    fn zip(&self, other: &DenseVolume, op: impl Fn(bool, bool) -> bool) -> DenseVolume {
        assert_eq!(self.n, other.n, "grids of one size");
        let both = self.voxels.iter().zip(&other.voxels);
        DenseVolume { n: self.n, voxels: both.map(|(&a, &b)| op(a, b)).collect() }
    }
}

impl std::fmt::Debug for DenseVolume {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let some: Vec<_> = self.occupied().take(24).collect();
        write!(f, "{} of {}^3 voxels: {some:?}", self.count(), self.n)
    }
}

/// Returns the index of a column's first voxel, and the distance from each voxel to the next.
fn stride_of_column(side: usize, axis: Axis, at: ColumnAddress) -> (usize, usize) {
    let [first, second] = [0, 1].map(|i| {
        let [x, y, z] = axis.voxel_at(at, i);
        (y * side + z) * side + x
    });
    (first, second - first)
}

/// Returns the six neighbours of a voxel.
pub fn face_neighbours([x, y, z]: [i32; 3]) -> [[i32; 3]; 6] {
    NEIGHBOUR_STEPS.map(|[i, j, k]| [x + i, y + j, z + k])
}

/// A strategy for any set of voxels: empty, full, noise, checkerboards, combs, single voxels, balls, boxes,
/// frames along the border. The sets aren't closed, and about half don't touch the ground.
pub fn any_voxels(side: usize) -> impl Strategy<Value = DenseVolume> {
    let n = side as i32;
    let place = [0..n, 0..n, 0..n];
    prop_oneof![
        1 => Just(DenseVolume::empty(side)),
        1 => Just(DenseVolume::from_fn(side, |_| true)),
        3 => (any::<u64>(), 1..256u64).prop_map(move |(seed, occupied_of_256)| noise_voxels(side, seed, occupied_of_256)),
        1 => (0..2).prop_map(move |odd| DenseVolume::from_fn(side, |[x, y, z]| (x + y + z) % 2 == odd)),
        2 => (0..3usize, 2..5, 0..4usize).prop_map(move |(axis, period, spine)| comb_voxels(side, axis, period, CombSpine::ALL[spine])),
        2 => proptest::collection::vec(place.clone(), 1..4).prop_map(move |voxels| {
            let mut dense = DenseVolume::empty(side);
            voxels.into_iter().for_each(|voxel| dense.set(voxel, true));
            dense
        }),
        6 => proptest::collection::vec((place.clone(), 1..n), 1..5)
            .prop_map(move |balls| DenseVolume::from_fn(side, |v| balls.iter().any(|&(centre, diameter)| is_in_ball(v, centre, diameter)))),
        4 => proptest::collection::vec((place.clone(), place), 1..5)
            .prop_map(move |boxes| DenseVolume::from_fn(side, |v| boxes.iter().any(|&(a, b)| is_in_box(v, a, b)))),
        1 => (1..4).prop_map(move |thick| DenseVolume::from_fn(side, |v| {
            v.iter().filter(|&&i| i < thick || i >= n - thick).count() >= 2
        })),
    ]
}

/// A strategy for closed volumes, the closures of [`any_voxels`].
pub fn closed_volumes(side: usize) -> impl Strategy<Value = DenseVolume> {
    any_voxels(side).prop_map(|voxels| voxels.closure())
}

/// A closed volume, and a closed mask inside it.
#[derive(Clone, Debug)]
pub struct MaskedVolume {
    /// The volume.
    pub volume: DenseVolume,
    /// Its mask.
    pub mask: DenseVolume,
}

/// A strategy for a closed volume and a closed mask inside it, which is often empty, sometimes all of it.
pub fn closed_volumes_with_inner_mask(side: usize) -> impl Strategy<Value = MaskedVolume> {
    let mask = prop_oneof![
        2 => Just(DenseVolume::empty(side)),
        3 => any_voxels(side),
    ];
    (closed_volumes(side), mask).prop_map(|(volume, mask)| {
        let mask = volume.intersection(&mask).closure();
        MaskedVolume { volume, mask }
    })
}

/// Returns independent random voxels (xorshift64), each occupied with probability `occupied_of_256` / 256.
fn noise_voxels(side: usize, seed: u64, occupied_of_256: u64) -> DenseVolume {
    let mut state = seed | 1;
    DenseVolume::from_fn(side, |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state >> 56 < occupied_of_256
    })
}

/// The edges at which the sheets of a comb are joined.
#[derive(Clone, Copy)]
enum CombSpine {
    None,
    LowEdge,
    HighEdge,
    /// At both edges alternately.
    Alternating,
}

impl CombSpine {
    const ALL: [CombSpine; 4] =
        [CombSpine::None, CombSpine::LowEdge, CombSpine::HighEdge, CombSpine::Alternating];
}

/// Returns sheets across an axis, every `period` voxels, joined at edges of the grid.
fn comb_voxels(side: usize, axis: usize, period: i32, spine: CombSpine) -> DenseVolume {
    let last = side as i32 - 1;
    DenseVolume::from_fn(side, |voxel| {
        let (i, j) = (voxel[axis], voxel[(axis + 1) % 3]);
        let joined = match spine {
            CombSpine::None => false,
            CombSpine::LowEdge => j == 0,
            CombSpine::HighEdge => j == last,
            CombSpine::Alternating => j == if (i / period) % 2 == 0 { 0 } else { last },
        };
        i % period == 0 || joined
    })
}

fn is_in_ball(voxel: [i32; 3], centre: [i32; 3], diameter: i32) -> bool {
    (0..3).map(|i| (voxel[i] - centre[i]).pow(2)).sum::<i32>() <= diameter * diameter / 4
}

/// Returns `true` if a voxel lies in the box with these opposite corners, inclusive.
fn is_in_box(voxel: [i32; 3], corner: [i32; 3], opposite: [i32; 3]) -> bool {
    (0..3).all(|i| (corner[i].min(opposite[i])..=corner[i].max(opposite[i])).contains(&voxel[i]))
}
