//! Triangle and box overlap by the separating axis theorem: the voxels that a triangle touches.
//!
//! A triangle touches a voxel when they are separated by no face direction of the voxel, not by the
//! triangle's plane, and by no edge of a *shadow*, the triangle's projection along an axis. All of it
//! is exact: coordinates are at most 2^16 units, so areas stay under 2^34 and heights times areas under
//! 2^52.

use super::BAKE_UNITS_PER_VOXEL;
use crate::volume::bit_grid::BitGrid;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use glam::IVec3;

const VOXEL_UNITS: i64 = BAKE_UNITS_PER_VOXEL as i64;

/// Binary logarithm of a voxel's side in units.
const VOXEL_SHIFT: u32 = BAKE_UNITS_PER_VOXEL.trailing_zeros();

/// A triangle relative to `origin`, the upper corner of the lowest voxel of its bounding box.
pub(super) struct GridTriangle {
    pub(super) origin: [i64; 3],
    pub(super) corners: [[i64; 3]; 3],
    /// By axis, the voxels whose displaced centres lie in the bounds: `start..end`.
    pub(super) centres: [[i32; 2]; 3],
    /// By axis, the first and last voxel whose closed box meets the bounds.
    first: [usize; 3],
    last: [usize; 3],
    /// Edge i goes from corner i to the next.
    edges: [[i64; 3]; 3],
    /// By the axis of projection and by edge: see [`GridTriangle::shadow_edge`].
    offsets: [[i64; 3]; 3],
    /// The outward normal, of twice the area's length. Twice a shadow's signed area is the component
    /// along its axis.
    pub(super) normal: [i64; 3],
}

/// The edge function of a shadow's directed edge: `slope . p + offset` is zero on the edge, and has the
/// sign of the shadow's area inside.
#[derive(Clone, Copy)]
pub(super) struct ShadowEdge {
    pub(super) slope: [i64; 2],
    pub(super) offset: i64,
}

impl GridTriangle {
    /// `None` when a corner is outside the box of the grid.
    #[inline(always)]
    pub(super) fn new<const N: usize>(points: [IVec3; 3]) -> Option<Self> {
        let [a, b, c] = points;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if low.min_element() < 0 || high.max_element() > N as i32 * BAKE_UNITS_PER_VOXEL {
            return None;
        }
        let mut triangle = GridTriangle {
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
        triangle.set_axis_bounds::<N>(0, points, low, high);
        triangle.set_axis_bounds::<N>(1, points, low, high);
        triangle.set_axis_bounds::<N>(2, points, low, high);
        triangle.normal =
            [triangle.project_shadow(0), triangle.project_shadow(1), triangle.project_shadow(2)];
        Some(triangle)
    }

    /// Fills in what depends on one axis alone.
    #[inline(always)]
    fn set_axis_bounds<const N: usize>(
        &mut self,
        axis: usize,
        points: [IVec3; 3],
        low: IVec3,
        high: IVec3,
    ) {
        let (low, high) = (low[axis], high[axis]);
        // A face at both ends belongs to the voxels on either side.
        let first = ((low - 1) >> VOXEL_SHIFT).max(0);
        self.first[axis] = first as usize;
        self.last[axis] = (high as usize >> VOXEL_SHIFT).min(N - 1);
        self.origin[axis] = i64::from((first + 1) * BAKE_UNITS_PER_VOXEL);
        self.centres[axis] =
            [low, high].map(|at| (at + BAKE_UNITS_PER_VOXEL / 2 - 1) >> VOXEL_SHIFT);
        let [a, b, c] = points.map(|p| i64::from(p[axis]) - self.origin[axis]);
        [self.corners[0][axis], self.corners[1][axis], self.corners[2][axis]] = [a, b, c];
        [self.edges[0][axis], self.edges[1][axis], self.edges[2][axis]] = [b - a, c - b, a - c];
    }

    /// Fills in the shadow along `axis`, and returns twice its signed area.
    #[inline(always)]
    fn project_shadow(&mut self, axis: usize) -> i64 {
        let [u, v] = other_axes(axis);
        let [a, b, c] = self.corners;
        let cross = |p: [i64; 3], q: [i64; 3]| p[u] * q[v] - p[v] * q[u];
        self.offsets[axis] = [cross(a, b), cross(b, c), cross(c, a)];
        self.offsets[axis][0] + self.offsets[axis][1] + self.offsets[axis][2]
    }

    /// Whether the triangle has no area.
    #[inline(always)]
    pub(super) fn is_degenerate(&self) -> bool {
        self.normal == [0; 3]
    }

    /// Six times the signed volume of the tetrahedron with its apex at `centre`.
    #[inline(always)]
    pub(super) fn tetrahedron_volume_x6(&self, centre: [i64; 3]) -> i64 {
        let [x, y, z] = [0, 1, 2].map(|k| self.corners[0][k] + self.origin[k] - centre[k]);
        self.normal[0] * x + self.normal[1] * y + self.normal[2] * z
    }

    /// The edge function of an edge, 0 to 2, of the shadow along `axis`, in the coordinates of
    /// [`other_axes`].
    #[inline(always)]
    pub(super) fn shadow_edge(&self, axis: usize, edge: usize) -> ShadowEdge {
        let [u, v] = other_axes(axis);
        ShadowEdge {
            slope: [-self.edges[edge][v], self.edges[edge][u]],
            offset: self.offsets[axis][edge],
        }
    }

    /// Sets every voxel whose closed box the triangle touches.
    #[inline(always)]
    pub(super) fn mark_touched<const N: usize>(&self, touched: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        let more = [0, 1, 2].map(|k| self.last[k] - self.first[k]);
        if (more[0] | more[1] | more[2]) <= 1 {
            self.mark_octants(touched);
        } else if let Some(thin) = (0..3).find(|&k| more[k] == 0) {
            self.mark_sheet(thin, touched);
        } else {
            self.mark_layers(touched);
        }
    }

    /// Marks at most 2x2x2 voxels. They are the octants around `origin`, and each edge or plane that
    /// separates one from the triangle has the origin on its far side and faces away from it.
    #[inline(always)]
    fn mark_octants<const N: usize>(&self, touched: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        let double = [0, 1, 2].map(|k| self.first[k] < self.last[k]);
        let beyond = |k: usize| if double[k] { 0 } else { HIGH_OCTANTS[k] };
        let mut missed = beyond(0) | beyond(1) | beyond(2);
        // Two voxels in a line need no test: the triangle reaches both.
        if double[1] && double[2] {
            missed |= self.missed_octants(0);
        }
        if double[2] && double[0] {
            missed |= self.missed_octants(1);
        }
        if double[0] && double[1] {
            missed |= self.missed_octants(2);
        }
        if double == [true; 3] {
            let [x, y, z] = [0, 1, 2].map(|k| self.normal[k] * self.corners[0][k]);
            let [a, b, c] = self.normal.map(sign_index);
            missed |= octants_towards(
                &DIRECTION_OCTANTS,
                26 - (9 * a + 3 * b + c),
                sign_index(x + y + z),
            );
        }
        let octants = !missed;
        let [x, y, z] = self.first;
        for (dy, dz) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let pair = octants >> (2 * dy + 4 * dz) & 0b11;
            if pair != 0 {
                insert_pair::<N>(touched.row_mut(y + dy, z + dz), x, pair);
            }
        }
    }

    /// The octants around the origin that an edge of the shadow along `axis` separates from the
    /// triangle.
    #[inline(always)]
    fn missed_octants(&self, axis: usize) -> u8 {
        let [u, v] = other_axes(axis);
        let area = sign_index(self.normal[axis]);
        let mut missed = 0;
        for i in 0..3 {
            let offset = sign_index(self.offsets[axis][i]);
            // With the origin on the inner side, the edge separates nothing.
            let offset = if offset == area { 1 } else { offset };
            let slope = 3 * (2 - sign_index(self.edges[i][v])) + sign_index(self.edges[i][u]);
            missed |= octants_towards(&QUADRANT_OCTANTS[axis], slope, offset);
        }
        missed
    }

    /// Marks a sheet of voxels one thick along `axis`: the shadow along it decides alone.
    fn mark_sheet<const N: usize>(&self, axis: usize, touched: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        let [u, v] = other_axes(axis);
        let edges = self.grown_edges(axis);
        let mut voxel = self.first;
        for i in self.first[u]..=self.last[u] {
            voxel[u] = i;
            for j in self.first[v]..=self.last[v] {
                voxel[v] = j;
                if contain_square(&edges, [self.local_low_end(u, i), self.local_low_end(v, j)]) {
                    touched.row_mut(voxel[1], voxel[2]).insert(voxel[0]);
                }
            }
        }
    }

    /// Marks voxels of a box of any size: the cells of the shadow along the dominant axis of the
    /// normal, and in each cell the few voxels that the triangle's plane passes through.
    fn mark_layers<const N: usize>(&self, touched: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        let area = self.normal.map(i64::abs);
        let w = (0..3).fold(0, |best, k| if area[k] > area[best] { k } else { best });
        let [u, v] = other_axes(w);
        let [along_u, along_v, along_w] = [u, v, w].map(|k| self.grown_edges(k));
        let (mut cell, mut voxel) = ([0; 3], [0; 3]);
        for i in self.first[u]..=self.last[u] {
            (cell[u], voxel[u]) = (self.local_low_end(u, i), i);
            for j in self.first[v]..=self.last[v] {
                (cell[v], voxel[v]) = (self.local_low_end(v, j), j);
                if !contain_square(&along_w, [cell[u], cell[v]]) {
                    continue;
                }
                for k in self.passed_voxels([u, v, w], cell) {
                    (cell[w], voxel[w]) = (self.local_low_end(w, k), k);
                    if contain_square(&along_u, [cell[v], cell[w]])
                        && contain_square(&along_v, [cell[w], cell[u]])
                    {
                        touched.row_mut(voxel[1], voxel[2]).insert(voxel[0]);
                    }
                }
            }
        }
    }

    /// The shadow's edge functions along `axis`, each moved outwards so that a voxel-sized square
    /// overlaps the shadow exactly where its low corner is inside all three.
    #[inline(always)]
    fn grown_edges(&self, axis: usize) -> [ShadowEdge; 3] {
        let mut edges =
            [self.shadow_edge(axis, 0), self.shadow_edge(axis, 1), self.shadow_edge(axis, 2)];
        if self.normal[axis] == 0 {
            // The shadow is a segment: any edge that isn't a point gives both sides.
            let edge = edges.into_iter().find(|edge| edge.slope != [0; 2]).unwrap_or(edges[0]);
            let [s, t] = edge.slope;
            edges = [edge, ShadowEdge { slope: [-s, -t], offset: -edge.offset }, edge];
        }
        let turn = if self.normal[axis] < 0 { -1 } else { 1 };
        for edge in &mut edges {
            edge.slope = edge.slope.map(|s| s * turn);
            edge.offset *= turn;
            edge.offset += (edge.slope[0].max(0) + edge.slope[1].max(0)) * VOXEL_UNITS;
        }
        edges
    }

    /// The low end of a voxel along an axis, in units relative to `origin`.
    #[inline(always)]
    fn local_low_end(&self, axis: usize, voxel: usize) -> i64 {
        (voxel as i64 - self.first[axis] as i64 - 1) * VOXEL_UNITS
    }

    /// The voxels along w, inside the bounds, through which the plane passes over the cell with its low
    /// corner at `cell_low`.
    #[inline(always)]
    fn passed_voxels(&self, [u, v, w]: [usize; 3], cell_low: [i64; 3]) -> core::ops::Range<usize> {
        let toward = self.normal[w].signum();
        if toward == 0 {
            return self.first[w]..self.last[w] + 1;
        }
        let [n_u, n_v, n_w] = [u, v, w].map(|k| self.normal[k] * toward);
        let corner = self.corners[0];
        // n_w times the plane's height over the cell's low corner, then its range over the cell.
        let height =
            n_w * corner[w] - n_u * (cell_low[u] - corner[u]) - n_v * (cell_low[v] - corner[v]);
        let least = height - (n_u.max(0) + n_v.max(0)) * VOXEL_UNITS;
        let most = height - (n_u.min(0) + n_v.min(0)) * VOXEL_UNITS;
        let first = self.first[w] as i64;
        let start = first - (-least).div_euclid(n_w * VOXEL_UNITS);
        let end = first + 2 + most.div_euclid(n_w * VOXEL_UNITS);
        let start = start.max(first);
        start as usize..end.clamp(start, self.last[w] as i64 + 1) as usize
    }
}

/// The two other axes, in cyclic order after `axis`.
#[inline(always)]
pub(super) const fn other_axes(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Whether a voxel-sized square's low corner is inside all three grown edges.
#[inline(always)]
fn contain_square(edges: &[ShadowEdge; 3], low_corner: [i64; 2]) -> bool {
    let inside = |edge: &ShadowEdge| {
        edge.slope[0] * low_corner[0] + edge.slope[1] * low_corner[1] + edge.offset >= 0
    };
    inside(&edges[0]) & inside(&edges[1]) & inside(&edges[2])
}

/// By axis k, the octants around the origin on the axis's high side: octant i where bit k of i is set.
const HIGH_OCTANTS: [u8; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

/// By axis, the octants in the quadrant that a 2D direction on the [`other_axes`] points to, at index
/// `3 * sign_index(u) + sign_index(v)`; both sides of an axis on which it is zero.
const QUADRANT_OCTANTS: [[u8; 9]; 3] = {
    let mut table = [[0; 9]; 3];
    let mut i = 0;
    while i < 27 {
        let (k, slope) = (i / 9, i % 9);
        let [u, v] = other_axes(k);
        table[k][slope] = octants_on_side(u, slope / 3) & octants_on_side(v, slope % 3);
        i += 1;
    }
    table
};

/// The octants that a direction points to, at `9 * sign_index(x) + 3 * sign_index(y) + sign_index(z)`.
const DIRECTION_OCTANTS: [u8; 27] = {
    let mut table = [0; 27];
    let mut i = 0;
    while i < 27 {
        table[i] =
            octants_on_side(0, i / 9) & octants_on_side(1, i / 3 % 3) & octants_on_side(2, i % 3);
        i += 1;
    }
    table
};

/// The octants on the low side of an axis for [`sign_index`] 0, all for 1, on the high side for 2.
const fn octants_on_side(axis: usize, sign: usize) -> u8 {
    [!HIGH_OCTANTS[axis], 0xff, HIGH_OCTANTS[axis]][sign]
}

/// 0 for negative, 1 for zero, 2 for positive.
#[inline(always)]
fn sign_index(value: i64) -> usize {
    (value >= 0) as usize + (value > 0) as usize
}

/// The table's octants for a direction index where `sign` is 2, for the opposite direction where it is
/// 0, and none where it is 1.
#[inline(always)]
fn octants_towards<const M: usize>(octants: &[u8; M], direction: usize, sign: usize) -> u8 {
    let at = if sign == 0 { M - 1 - direction } else { direction };
    octants[at] & ((sign != 1) as u8).wrapping_neg()
}

/// Sets bit x where bit 0 of `pair` is set, and bit x + 1 where bit 1 is.
#[inline(always)]
fn insert_pair<const N: usize>(row: &mut <Grid<N> as Size>::Row, x: usize, pair: u8)
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
