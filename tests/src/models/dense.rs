//! A grid of voxels as plain booleans: the obvious meaning of hull, closure, support and distance.

use std::collections::VecDeque;

use paros_core::maps::{Axis, Column, Maps, Range};
use paros_core::plane::Plane;
use paros_core::row::Bits;
use paros_core::size::{Grid, Size};
use proptest::prelude::*;

/// The steps to the six neighbours.
pub const SIX: [[i32; 3]; 6] =
    [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];

/// `n`^3 voxels, each occupied or not.
#[derive(Clone, PartialEq, Eq)]
pub struct Dense {
    n: usize,
    voxels: Vec<bool>,
}

impl Dense {
    /// No voxel occupied.
    pub fn new(n: usize) -> Self {
        Dense { n, voxels: vec![false; n * n * n] }
    }

    /// The voxels for which `occupied` says so.
    pub fn from_fn(n: usize, mut occupied: impl FnMut([i32; 3]) -> bool) -> Self {
        let mut dense = Dense::new(n);
        for voxel in dense.all() {
            dense.set(voxel, occupied(voxel));
        }
        dense
    }

    /// The voxels that all three maps hold, asked one by one.
    pub fn from_maps<const N: usize>(maps: &Maps<N>) -> Self {
        Dense::from_fn(N, |voxel| {
            let voxel = voxel.map(|i| i as usize);
            Axis::ALL.iter().all(|&axis| {
                let range = maps.column(axis, axis.address(voxel)).0[0];
                let i = voxel[axis as usize];
                range.lo() <= i && i <= range.hi()
            })
        })
    }

    /// The voxels set in a plane of bit rows.
    pub fn from_plane<const N: usize>(plane: &Plane<N>) -> Self
    where
        Grid<N>: Size,
    {
        Dense::from_fn(N, |[x, y, z]| plane.row(y as usize, z as usize).contains(x as usize))
    }

    /// Sets the occupied voxels in an empty plane.
    pub fn write_plane<const N: usize>(&self, plane: &mut Plane<N>)
    where
        Grid<N>: Size,
    {
        for [x, y, z] in self.occupied() {
            plane.row_mut(y as usize, z as usize).insert(x as usize);
        }
    }

    /// Writes the tight hulls of the columns.
    pub fn write_maps<const N: usize>(&self, maps: &mut Maps<N>) {
        for axis in Axis::ALL {
            for line in 0..N {
                for place in 0..N {
                    let range = match self.hull(axis, (line, place)) {
                        Some((lo, hi)) => Range::new(lo, hi),
                        None => Range::EMPTY,
                    };
                    maps.set_column(axis, (line, place), Column([range]));
                }
            }
        }
    }

    /// Voxels along an edge.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Every voxel of the grid.
    pub fn all(&self) -> impl Iterator<Item = [i32; 3]> + use<> {
        let n = self.n as i32;
        (0..n).flat_map(move |y| (0..n).flat_map(move |z| (0..n).map(move |x| [x, y, z])))
    }

    /// Every occupied voxel.
    pub fn occupied(&self) -> impl Iterator<Item = [i32; 3]> {
        self.all().zip(&self.voxels).filter_map(|(voxel, &occupied)| occupied.then_some(voxel))
    }

    /// Whether a voxel lies in the grid and is occupied.
    pub fn contains(&self, voxel: [i32; 3]) -> bool {
        self.index(voxel).is_some_and(|i| self.voxels[i])
    }

    /// Occupies or empties a voxel of the grid.
    pub fn set(&mut self, voxel: [i32; 3], occupied: bool) {
        let i = self.index(voxel).expect("a voxel of the grid");
        self.voxels[i] = occupied;
    }

    /// Occupied voxels.
    pub fn count(&self) -> u32 {
        self.voxels.iter().map(|&occupied| u32::from(occupied)).sum()
    }

    /// Whether no voxel is occupied.
    pub fn is_empty(&self) -> bool {
        self.count() == 0
    }

    /// The voxels of both.
    pub fn or(&self, other: &Dense) -> Dense {
        self.zip(other, |a, b| a | b)
    }

    /// The voxels in both.
    pub fn and(&self, other: &Dense) -> Dense {
        self.zip(other, |a, b| a & b)
    }

    /// The voxels that the other lacks.
    pub fn without(&self, other: &Dense) -> Dense {
        self.zip(other, |a, b| a & !b)
    }

    /// Whether the other holds every voxel of this one.
    pub fn is_within(&self, other: &Dense) -> bool {
        self.without(other).is_empty()
    }

    /// The voxel mirror: x becomes n - 1 - x.
    pub fn mirrored(&self) -> Dense {
        let n = self.n as i32;
        Dense::from_fn(self.n, |[x, y, z]| self.contains([n - 1 - x, y, z]))
    }

    /// The first and last occupied voxel of a column.
    pub fn hull(&self, axis: Axis, at: (usize, usize)) -> Option<(usize, usize)> {
        let occupied = |&i: &usize| self.contains(axis.voxel(at, i).map(|i| i as i32));
        Some(((0..self.n).find(occupied)?, (0..self.n).rfind(occupied)?))
    }

    /// The voxels that lie within the hulls of all three columns through them.
    pub fn closure(&self) -> Dense {
        let n = self.n;
        let hulls = Axis::ALL.map(|axis| {
            let column = |i: usize| self.hull(axis, (i / n, i % n));
            (0..n * n).map(column).collect::<Vec<_>>()
        });
        Dense::from_fn(n, |voxel| {
            let voxel = voxel.map(|i| i as usize);
            Axis::ALL.iter().all(|&axis| {
                let (line, place) = axis.address(voxel);
                let i = voxel[axis as usize];
                hulls[axis as usize][line * n + place].is_some_and(|(lo, hi)| lo <= i && i <= hi)
            })
        })
    }

    /// S(V): the voxels connected by six-neighbour steps inside the volume to its ground layer
    /// y = 0 or to its voxels in the mask.
    pub fn supported(&self, mask: &Dense) -> Dense {
        let seeds = self.occupied().filter(|&voxel| voxel[1] == 0 || mask.contains(voxel));
        self.connected_to(seeds.collect())
    }

    /// The occupied voxels connected to the seeds, which are occupied.
    pub fn connected_to(&self, seeds: Vec<[i32; 3]>) -> Dense {
        let mut found = Dense::new(self.n);
        let mut queue = VecDeque::from(seeds);
        while let Some(voxel) = queue.pop_front() {
            if self.contains(voxel) && !found.contains(voxel) {
                found.set(voxel, true);
                queue.extend(neighbours(voxel));
            }
        }
        found
    }

    /// The voxels at most `depth` six-neighbour steps from a place for which `seed` says so; places
    /// are the grid's voxels and those that touch the grid from outside.
    pub fn within(&self, depth: usize, seed: impl Fn([i32; 3]) -> bool) -> Dense {
        let n = self.n as i32;
        let side = self.n + 2;
        let index = |[x, y, z]: [i32; 3]| {
            ((y + 1) as usize * side + (z + 1) as usize) * side + (x + 1) as usize
        };
        let mut near = vec![false; side * side * side];
        let mut front = Vec::new();
        for y in -1..=n {
            for z in -1..=n {
                for x in -1..=n {
                    if seed([x, y, z]) {
                        near[index([x, y, z])] = true;
                        front.push([x, y, z]);
                    }
                }
            }
        }
        for _ in 0..depth {
            let mut next = Vec::new();
            for place in front.into_iter().flat_map(neighbours) {
                let inside = place.iter().all(|i| (-1..=n).contains(i));
                if inside && !near[index(place)] {
                    near[index(place)] = true;
                    next.push(place);
                }
            }
            front = next;
        }
        Dense::from_fn(self.n, |voxel| near[index(voxel)])
    }

    /// Voxels at most `depth` six-neighbour steps from an empty one; outside counts as empty.
    pub fn near_empty(&self, depth: usize) -> Dense {
        self.within(depth, |place| !self.contains(place))
    }

    /// Voxels at most `depth` six-neighbour steps from an occupied one or from the ground, which is
    /// everywhere under y = 0.
    pub fn near_occupied(&self, depth: usize) -> Dense {
        self.within(depth, |place| place[1] < 0 || self.contains(place))
    }

    fn index(&self, [x, y, z]: [i32; 3]) -> Option<usize> {
        let n = self.n as i32;
        let inside = [x, y, z].iter().all(|i| (0..n).contains(i));
        inside.then(|| ((y * n + z) * n + x) as usize)
    }

    fn zip(&self, other: &Dense, op: impl Fn(bool, bool) -> bool) -> Dense {
        assert_eq!(self.n, other.n, "grids of one size");
        let both = self.voxels.iter().zip(&other.voxels);
        Dense { n: self.n, voxels: both.map(|(&a, &b)| op(a, b)).collect() }
    }
}

impl std::fmt::Debug for Dense {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let some: Vec<_> = self.occupied().take(24).collect();
        write!(f, "{} of {}^3 voxels: {some:?}", self.count(), self.n)
    }
}

/// The six neighbours of a voxel.
pub fn neighbours([x, y, z]: [i32; 3]) -> [[i32; 3]; 6] {
    SIX.map(|[i, j, k]| [x + i, y + j, z + k])
}

/// The sculpted and the awkward: empty, full, noise, checkerboards, combs, single voxels, balls,
/// slabs, frames along the border. Not closed; about half stand clear of the ground.
pub fn voxels(n: usize) -> impl Strategy<Value = Dense> {
    let n = n as i32;
    let place = [0..n, 0..n, 0..n];
    prop_oneof![
        1 => Just(Dense::new(n as usize)),
        1 => Just(Dense::from_fn(n as usize, |_| true)),
        3 => (any::<u64>(), 1..256u64).prop_map(move |(seed, density)| noise(n as usize, seed, density)),
        1 => (0..2).prop_map(move |odd| Dense::from_fn(n as usize, |[x, y, z]| (x + y + z) % 2 == odd)),
        2 => (0..3usize, 2..5, 0..4).prop_map(move |(axis, period, spine)| comb(n, axis, period, spine)),
        2 => proptest::collection::vec(place.clone(), 1..4).prop_map(move |voxels| {
            let mut dense = Dense::new(n as usize);
            voxels.into_iter().for_each(|voxel| dense.set(voxel, true));
            dense
        }),
        6 => proptest::collection::vec((place.clone(), 1..n), 1..5)
            .prop_map(move |balls| Dense::from_fn(n as usize, |v| balls.iter().any(|&(c, r)| in_ball(v, c, r)))),
        4 => proptest::collection::vec((place.clone(), place), 1..5)
            .prop_map(move |slabs| Dense::from_fn(n as usize, |v| slabs.iter().any(|&(a, b)| in_slab(v, a, b)))),
        1 => (1..4).prop_map(move |thick| Dense::from_fn(n as usize, |v| {
            v.iter().filter(|&&i| i < thick || i >= n - thick).count() >= 2
        })),
    ]
}

/// Closed volumes out of [`voxels`].
pub fn volumes(n: usize) -> impl Strategy<Value = Dense> {
    voxels(n).prop_map(|voxels| voxels.closure())
}

/// A volume and a closed mask inside it: often empty, sometimes all of it.
pub fn masked_volumes(n: usize) -> impl Strategy<Value = (Dense, Dense)> {
    let mask = prop_oneof![
        2 => Just(Dense::new(n)),
        3 => voxels(n),
    ];
    (volumes(n), mask).prop_map(|(volume, mask)| {
        let mask = volume.and(&mask).closure();
        (volume, mask)
    })
}

fn noise(n: usize, seed: u64, density: u64) -> Dense {
    let mut state = seed | 1;
    Dense::from_fn(n, |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state >> 56 < density
    })
}

/// Sheets across an axis, each joined to the next at one edge of the grid in turn.
fn comb(n: i32, axis: usize, period: i32, spine: i32) -> Dense {
    Dense::from_fn(n as usize, |voxel| {
        let (i, j) = (voxel[axis], voxel[(axis + 1) % 3]);
        let joined = match spine {
            0 => false,
            1 => j == 0,
            2 => j == n - 1,
            _ => j == if (i / period) % 2 == 0 { 0 } else { n - 1 },
        };
        i % period == 0 || joined
    })
}

fn in_ball(voxel: [i32; 3], centre: [i32; 3], radius: i32) -> bool {
    (0..3).map(|i| (voxel[i] - centre[i]).pow(2)).sum::<i32>() <= radius * radius / 4
}

fn in_slab(voxel: [i32; 3], a: [i32; 3], b: [i32; 3]) -> bool {
    (0..3).all(|i| (a[i].min(b[i])..=a[i].max(b[i])).contains(&voxel[i]))
}
