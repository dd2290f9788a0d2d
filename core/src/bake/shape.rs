//! One triangle in the grid: its shadows on the three coordinate planes, and the voxels it touches.
//!
//! A triangle touches a voxel when no face direction of the voxel, not the triangle's plane and no
//! edge of a shadow separates them (the separating axis theorem). All of it is exact: coordinates
//! are at most 2^16 units, so areas stay under 2^34 and heights times areas under 2^52.

use super::UNITS;
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};
use glam::IVec3;

const SIDE: i64 = UNITS as i64;

/// Side of a voxel as a shift.
const SHIFT: u32 = UNITS.trailing_zeros();

/// A triangle relative to `origin`, the upper corner of the lowest voxel of its bounding box.
pub(super) struct Shape {
    pub(super) origin: [i64; 3],
    pub(super) corners: [[i64; 3]; 3],
    /// The voxels whose centres, displaced upwards a little, lie in the bounds: from, to before.
    pub(super) centres: [[i32; 2]; 3],
    /// Voxels whose closed box meets the bounds.
    first: [usize; 3],
    last: [usize; 3],
    /// Edge i goes from corner i to the next.
    edges: [[i64; 3]; 3],
    /// By the axis along which the shadow is seen and by edge: see [`Shape::edge`].
    offsets: [[i64; 3]; 3],
    /// Twice the area, towards the outside; a shadow's is the component along its axis.
    pub(super) normal: [i64; 3],
}

/// A directed edge of a shadow: `slope . p + offset` is zero along it, and inside has the sign of
/// the shadow's area.
#[derive(Clone, Copy)]
pub(super) struct Edge {
    pub(super) slope: [i64; 2],
    pub(super) offset: i64,
}

impl Shape {
    /// `None` when a corner is outside the box of the grid.
    #[inline(always)]
    pub(super) fn new<const N: usize>(points: [IVec3; 3]) -> Option<Self> {
        let [a, b, c] = points;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if low.min_element() < 0 || high.max_element() > N as i32 * UNITS {
            return None;
        }
        let mut shape = Shape {
            origin: [0; 3],
            corners: [[0; 3]; 3],
            centres: [[0; 2]; 3],
            first: [0; 3],
            last: [0; 3],
            edges: [[0; 3]; 3],
            offsets: [[0; 3]; 3],
            normal: [0; 3],
        };
        // Written out by axis: the compiler leaves a loop of this size a loop.
        shape.measure::<N>(0, points, low, high);
        shape.measure::<N>(1, points, low, high);
        shape.measure::<N>(2, points, low, high);
        shape.normal = [shape.project(0), shape.project(1), shape.project(2)];
        Some(shape)
    }

    /// Fills in what only one axis tells.
    #[inline(always)]
    fn measure<const N: usize>(&mut self, k: usize, points: [IVec3; 3], low: IVec3, high: IVec3) {
        let (low, high) = (low[k], high[k]);
        // A face at both ends belongs to the voxels on either side.
        let first = ((low - 1) >> SHIFT).max(0);
        self.first[k] = first as usize;
        self.last[k] = (high as usize >> SHIFT).min(N - 1);
        self.origin[k] = i64::from((first + 1) * UNITS);
        self.centres[k] = [low, high].map(|at| (at + UNITS / 2 - 1) >> SHIFT);
        let [a, b, c] = points.map(|p| i64::from(p[k]) - self.origin[k]);
        [self.corners[0][k], self.corners[1][k], self.corners[2][k]] = [a, b, c];
        [self.edges[0][k], self.edges[1][k], self.edges[2][k]] = [b - a, c - b, a - c];
    }

    /// Fills in the shadow along axis k, and gives twice its area.
    #[inline(always)]
    fn project(&mut self, k: usize) -> i64 {
        let [u, v] = across(k);
        let [a, b, c] = self.corners;
        let cross = |p: [i64; 3], q: [i64; 3]| p[u] * q[v] - p[v] * q[u];
        self.offsets[k] = [cross(a, b), cross(b, c), cross(c, a)];
        self.offsets[k][0] + self.offsets[k][1] + self.offsets[k][2]
    }

    /// Whether the triangle has no area.
    #[inline(always)]
    pub(super) fn is_degenerate(&self) -> bool {
        self.normal == [0; 3]
    }

    /// Six times the signed volume of the tetrahedron to `centre`.
    #[inline(always)]
    pub(super) fn volume_about(&self, centre: [i64; 3]) -> i64 {
        let [x, y, z] = [0, 1, 2].map(|k| self.corners[0][k] + self.origin[k] - centre[k]);
        self.normal[0] * x + self.normal[1] * y + self.normal[2] * z
    }

    /// Edge i of the shadow along axis k, on the axes [`across`] it.
    #[inline(always)]
    pub(super) fn edge(&self, k: usize, i: usize) -> Edge {
        let [u, v] = across(k);
        Edge { slope: [-self.edges[i][v], self.edges[i][u]], offset: self.offsets[k][i] }
    }

    /// Sets every voxel whose closed box the triangle touches.
    #[inline(always)]
    pub(super) fn touch<const N: usize>(&self, touched: &mut Plane<N>)
    where
        Grid<N>: Size,
    {
        let more = [0, 1, 2].map(|k| self.last[k] - self.first[k]);
        if (more[0] | more[1] | more[2]) <= 1 {
            self.touch_octants(touched);
        } else if let Some(thin) = (0..3).find(|&k| more[k] == 0) {
            self.touch_sheet(thin, touched);
        } else {
            self.touch_layers(touched);
        }
    }

    /// At most 2x2x2 voxels: they are the octants around `origin`, and each edge or plane that
    /// separates one from the triangle has the origin on its far side and faces away from it.
    #[inline(always)]
    fn touch_octants<const N: usize>(&self, touched: &mut Plane<N>)
    where
        Grid<N>: Size,
    {
        let double = [0, 1, 2].map(|k| self.first[k] < self.last[k]);
        let beyond = |k: usize| if double[k] { 0 } else { HIGH[k] };
        let mut missed = beyond(0) | beyond(1) | beyond(2);
        // Two voxels in a line need no test: the triangle reaches each and leaves neither.
        if double[1] && double[2] {
            missed |= self.octants_missed(0);
        }
        if double[2] && double[0] {
            missed |= self.octants_missed(1);
        }
        if double[0] && double[1] {
            missed |= self.octants_missed(2);
        }
        if double == [true; 3] {
            let [x, y, z] = [0, 1, 2].map(|k| self.normal[k] * self.corners[0][k]);
            let [a, b, c] = self.normal.map(sign);
            missed |= turned(&OCTANT, 26 - (9 * a + 3 * b + c), sign(x + y + z));
        }
        let octants = !missed;
        let [x, y, z] = self.first;
        for (dy, dz) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let pair = octants >> (2 * dy + 4 * dz) & 0b11;
            if pair != 0 {
                insert_two::<N>(touched.row_mut(y + dy, z + dz), x, pair);
            }
        }
    }

    /// The octants around the origin that an edge of the shadow along axis k separates from it.
    #[inline(always)]
    fn octants_missed(&self, k: usize) -> u8 {
        let [u, v] = across(k);
        let area = sign(self.normal[k]);
        let mut missed = 0;
        for i in 0..3 {
            let offset = sign(self.offsets[k][i]);
            // With the origin on the side where the area is, nothing is missed.
            let offset = if offset == area { 1 } else { offset };
            let slope = 3 * (2 - sign(self.edges[i][v])) + sign(self.edges[i][u]);
            missed |= turned(&QUADRANT[k], slope, offset);
        }
        missed
    }

    /// One voxel thick along axis k: the shadow along it decides alone.
    fn touch_sheet<const N: usize>(&self, k: usize, touched: &mut Plane<N>)
    where
        Grid<N>: Size,
    {
        let [u, v] = across(k);
        let fences = self.fences(k);
        let mut voxel = self.first;
        for i in self.first[u]..=self.last[u] {
            voxel[u] = i;
            for j in self.first[v]..=self.last[v] {
                voxel[v] = j;
                if hold(&fences, [self.local(u, i), self.local(v, j)]) {
                    touched.row_mut(voxel[1], voxel[2]).insert(voxel[0]);
                }
            }
        }
    }

    /// Any size: the cells of the shadow along the axis that the plane faces most, and in each the
    /// few voxels that the plane passes.
    fn touch_layers<const N: usize>(&self, touched: &mut Plane<N>)
    where
        Grid<N>: Size,
    {
        let area = self.normal.map(i64::abs);
        let w = (0..3).fold(0, |best, k| if area[k] > area[best] { k } else { best });
        let [u, v] = across(w);
        let [along_u, along_v, along_w] = [u, v, w].map(|k| self.fences(k));
        let (mut cell, mut voxel) = ([0; 3], [0; 3]);
        for i in self.first[u]..=self.last[u] {
            (cell[u], voxel[u]) = (self.local(u, i), i);
            for j in self.first[v]..=self.last[v] {
                (cell[v], voxel[v]) = (self.local(v, j), j);
                if !hold(&along_w, [cell[u], cell[v]]) {
                    continue;
                }
                for k in self.passed([u, v, w], cell) {
                    (cell[w], voxel[w]) = (self.local(w, k), k);
                    if hold(&along_u, [cell[v], cell[w]]) && hold(&along_v, [cell[w], cell[u]]) {
                        touched.row_mut(voxel[1], voxel[2]).insert(voxel[0]);
                    }
                }
            }
        }
    }

    /// Three edges, each moved outwards until a voxel-sized square that the shadow along axis k
    /// reaches has its low corner inside.
    #[inline(always)]
    fn fences(&self, k: usize) -> [Edge; 3] {
        let mut edges = [self.edge(k, 0), self.edge(k, 1), self.edge(k, 2)];
        if self.normal[k] == 0 {
            // All on one line: any edge that is not a point gives both sides.
            let edge = edges.into_iter().find(|edge| edge.slope != [0; 2]).unwrap_or(edges[0]);
            let [s, t] = edge.slope;
            edges = [edge, Edge { slope: [-s, -t], offset: -edge.offset }, edge];
        }
        let turn = if self.normal[k] < 0 { -1 } else { 1 };
        for edge in &mut edges {
            edge.slope = edge.slope.map(|s| s * turn);
            edge.offset *= turn;
            edge.offset += (edge.slope[0].max(0) + edge.slope[1].max(0)) * SIDE;
        }
        edges
    }

    /// The low end of a voxel, relative to `origin`.
    #[inline(always)]
    fn local(&self, axis: usize, voxel: usize) -> i64 {
        (voxel as i64 - self.first[axis] as i64 - 1) * SIDE
    }

    /// The voxels along w, inside the bounds, which the plane passes over the cell at `low`.
    #[inline(always)]
    fn passed(&self, [u, v, w]: [usize; 3], low: [i64; 3]) -> core::ops::Range<usize> {
        let toward = self.normal[w].signum();
        if toward == 0 {
            return self.first[w]..self.last[w] + 1;
        }
        let [n_u, n_v, n_w] = [u, v, w].map(|k| self.normal[k] * toward);
        let corner = self.corners[0];
        // n_w times the plane's height over the cell's low corner, and how it varies in the cell.
        let height = n_w * corner[w] - n_u * (low[u] - corner[u]) - n_v * (low[v] - corner[v]);
        let least = height - (n_u.max(0) + n_v.max(0)) * SIDE;
        let most = height - (n_u.min(0) + n_v.min(0)) * SIDE;
        let first = self.first[w] as i64;
        let start = first - (-least).div_euclid(n_w * SIDE);
        let end = first + 2 + most.div_euclid(n_w * SIDE);
        let start = start.max(first);
        start as usize..end.clamp(start, self.last[w] as i64 + 1) as usize
    }
}

/// The two axes after axis k, in cyclic order.
#[inline(always)]
pub(super) const fn across(k: usize) -> [usize; 2] {
    [(k + 1) % 3, (k + 2) % 3]
}

/// Whether the square with its low corner there is inside all three fences.
#[inline(always)]
fn hold(fences: &[Edge; 3], low: [i64; 2]) -> bool {
    let inside = |edge: &Edge| edge.slope[0] * low[0] + edge.slope[1] * low[1] + edge.offset >= 0;
    inside(&fences[0]) & inside(&fences[1]) & inside(&fences[2])
}

/// The octants around the origin on the high side of axis k. Octant i is where bit k of i is set.
const HIGH: [u8; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

/// For each axis k, the octants in the quadrants that a direction on the axes across k points to:
/// at `3 * sign(first) + sign(second)`, all on an axis where it is zero.
const QUADRANT: [[u8; 9]; 3] = {
    let mut table = [[0; 9]; 3];
    let mut i = 0;
    while i < 27 {
        let (k, slope) = (i / 9, i % 9);
        let [u, v] = across(k);
        table[k][slope] = side(u, slope / 3) & side(v, slope % 3);
        i += 1;
    }
    table
};

/// The octants that a direction points to, at `9 * sign(x) + 3 * sign(y) + sign(z)`.
const OCTANT: [u8; 27] = {
    let mut table = [0; 27];
    let mut i = 0;
    while i < 27 {
        table[i] = side(0, i / 9) & side(1, i / 3 % 3) & side(2, i % 3);
        i += 1;
    }
    table
};

/// The octants on the low side of axis k for sign 0, all for 1 and those on the high side for 2.
const fn side(k: usize, sign: usize) -> u8 {
    [!HIGH[k], 0xff, HIGH[k]][sign]
}

/// 0 for negative, 1 for zero, 2 for positive.
#[inline(always)]
fn sign(value: i64) -> usize {
    (value >= 0) as usize + (value > 0) as usize
}

/// The octants in a direction, those in the opposite one, or none, as the sign tells.
#[inline(always)]
fn turned<const M: usize>(octants: &[u8; M], direction: usize, sign: usize) -> u8 {
    let at = if sign == 0 { M - 1 - direction } else { direction };
    octants[at] & ((sign != 1) as u8).wrapping_neg()
}

/// Sets bit x where bit 0 of `pair` is set, and bit x + 1 where bit 1 is.
#[inline(always)]
fn insert_two<const N: usize>(row: &mut <Grid<N> as Size>::Row, x: usize, pair: u8)
where
    Grid<N>: Size,
{
    if x % 64 < 63 {
        row.set_word(x / 64, row.word(x / 64) | u64::from(pair) << (x % 64));
    } else {
        if pair & 1 != 0 {
            row.insert(x);
        }
        if pair & 2 != 0 {
            row.insert(x + 1);
        }
    }
}
