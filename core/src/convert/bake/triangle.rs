//! Triangle and box overlap by the separating axis theorem: the voxels that a triangle touches.
//!
//! A triangle touches a voxel if they aren't separated by a face direction of the voxel, by the triangle's
//! plane, or by an edge of its projections along the axes. The tests are exact: coordinates are at most 2^16
//! units, so areas stay under 2^34 and heights times areas under 2^52.

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
    /// For each axis, the voxels whose displaced centres lie in the bounds: `start..end`.
    pub(super) centres: [[i32; 2]; 3],
    /// For each axis, the first and last voxel whose closed box meets the bounds.
    pub(super) first: [usize; 3],
    pub(super) last: [usize; 3],
    /// Edge i goes from corner i to the next.
    edges: [[i64; 3]; 3],
    /// Indexed by the axis of projection and by edge: see [`GridTriangle::projected_edges`].
    offsets: [[i64; 3]; 3],
    /// The outward normal, with a length of twice the area. Its component along an axis is twice the signed
    /// area of the projection along that axis.
    pub(super) normal: [i64; 3],
}

/// The edge function of a projection's directed edge: `slope . p + offset` is zero on the edge, and has
/// the sign of the projection's area inside.
#[derive(Clone, Copy)]
pub(super) struct ProjectedEdge {
    pub(super) slope: [i64; 2],
    pub(super) offset: i64,
}

impl GridTriangle {
    /// Creates the triangle, or returns `None` if a corner is outside the box of the grid.
    #[inline(always)]
    pub(super) fn new_within_grid<const N: usize>(points: [IVec3; 3]) -> Option<Self> {
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
        // Written out by axis, as the compiler doesn't unroll a loop of this size.
        triangle.set_components_on_axis::<N>(0, points, low, high);
        triangle.set_components_on_axis::<N>(1, points, low, high);
        triangle.set_components_on_axis::<N>(2, points, low, high);
        triangle.set_projection(0);
        triangle.set_projection(1);
        triangle.set_projection(2);
        Some(triangle)
    }

    /// Sets the fields that depend on a single axis.
    #[inline(always)]
    fn set_components_on_axis<const N: usize>(
        &mut self,
        axis: usize,
        points: [IVec3; 3],
        low: IVec3,
        high: IVec3,
    ) {
        let (low, high) = (low[axis], high[axis]);
        // A face at either end belongs to the voxels on both sides.
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

    /// Sets the fields of the projection along `axis`: its edges' offsets and twice its signed area.
    #[inline(always)]
    fn set_projection(&mut self, axis: usize) {
        let [u, v] = other_axes(axis);
        let [a, b, c] = self.corners;
        let cross = |p: [i64; 3], q: [i64; 3]| p[u] * q[v] - p[v] * q[u];
        self.offsets[axis] = [cross(a, b), cross(b, c), cross(c, a)];
        self.normal[axis] = self.offsets[axis][0] + self.offsets[axis][1] + self.offsets[axis][2];
    }

    /// Returns `true` if the triangle has no area.
    #[inline(always)]
    pub(super) fn is_degenerate(&self) -> bool {
        self.normal == [0; 3]
    }

    /// Returns six times the signed volume of the tetrahedron with its apex at a point in bake units.
    #[inline(always)]
    pub(super) fn signed_tetrahedron_volume_x6(&self, apex: [i64; 3]) -> i64 {
        let [x, y, z] = [0, 1, 2].map(|k| self.corners[0][k] + self.origin[k] - apex[k]);
        self.normal[0] * x + self.normal[1] * y + self.normal[2] * z
    }

    /// Returns the edge functions of the projection along `axis`, in the coordinates of [`other_axes`].
    #[inline(always)]
    pub(super) fn projected_edges(&self, axis: usize) -> [ProjectedEdge; 3] {
        let [u, v] = other_axes(axis);
        let edge = |i: usize| ProjectedEdge {
            slope: [-self.edges[i][v], self.edges[i][u]],
            offset: self.offsets[axis][i],
        };
        [edge(0), edge(1), edge(2)]
    }

    /// Sets every voxel whose closed box the triangle touches.
    #[inline(always)]
    pub(super) fn mark_touched_voxels<const N: usize>(&self, touched: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        let more = [0, 1, 2].map(|k| self.last[k] - self.first[k]);
        if (more[0] | more[1] | more[2]) <= 1 {
            self.mark_in_octants(touched);
        } else if let Some(thin) = (0..3).find(|&k| more[k] == 0) {
            self.mark_in_sheet(thin, touched);
        } else {
            self.mark_in_box(touched);
        }
    }

    /// Marks at most 2x2x2 voxels, the octants around `origin`. Each edge or plane that separates an octant
    /// from the triangle has the origin on its far side and faces away from it.
    #[inline(always)]
    fn mark_in_octants<const N: usize>(&self, touched: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        let double = [0, 1, 2].map(|k| self.first[k] < self.last[k]);
        let beyond = |k: usize| if double[k] { 0 } else { HIGH_OCTANTS[k] };
        let mut missed = beyond(0) | beyond(1) | beyond(2);
        // Two voxels in a line need no test: the triangle touches both.
        if double[1] && double[2] {
            missed |= self.octants_beyond_edges(0);
        }
        if double[2] && double[0] {
            missed |= self.octants_beyond_edges(1);
        }
        if double[0] && double[1] {
            missed |= self.octants_beyond_edges(2);
        }
        if double == [true; 3] {
            let [x, y, z] = [0, 1, 2].map(|k| self.normal[k] * self.corners[0][k]);
            let [a, b, c] = self.normal.map(sign_index);
            missed |= octants_in_signed_direction(
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
                insert_two_voxels::<N>(touched.row_mut(y + dy, z + dz), x, pair);
            }
        }
    }

    /// Returns the octants around the origin that an edge of the projection along `axis` separates from the
    /// triangle.
    #[inline(always)]
    fn octants_beyond_edges(&self, axis: usize) -> OctantMask {
        let [u, v] = other_axes(axis);
        let area = sign_index(self.normal[axis]);
        let mut missed = 0;
        for i in 0..3 {
            let offset = sign_index(self.offsets[axis][i]);
            // An edge with the origin on its inner side separates nothing.
            let offset = if offset == area { 1 } else { offset };
            let slope = 3 * (2 - sign_index(self.edges[i][v])) + sign_index(self.edges[i][u]);
            missed |= octants_in_signed_direction(&QUADRANT_OCTANTS[axis], slope, offset);
        }
        missed
    }

    /// Marks a sheet of voxels one thick along `axis`: only the projection along `axis` is tested.
    fn mark_in_sheet<const N: usize>(&self, axis: usize, touched: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        let [u, v] = other_axes(axis);
        let edges = self.conservative_edges_for_low_corners(axis);
        let mut voxel = self.first;
        for i in self.first[u]..=self.last[u] {
            voxel[u] = i;
            for j in self.first[v]..=self.last[v] {
                voxel[v] = j;
                let low_corner = [self.low_end_from_origin(u, i), self.low_end_from_origin(v, j)];
                if contain_square(&edges, low_corner) {
                    touched.row_mut(voxel[1], voxel[2]).insert(voxel[0]);
                }
            }
        }
    }

    /// Marks voxels of a box of any size: iterates over the cells of the projection along the normal's
    /// dominant axis, and in each cell over the few voxels that the triangle's plane passes through.
    fn mark_in_box<const N: usize>(&self, touched: &mut BitGrid<N>)
    where
        Grid<N>: Size,
    {
        let area = self.normal.map(i64::abs);
        let w = (0..3).fold(0, |best, k| if area[k] > area[best] { k } else { best });
        let [u, v] = other_axes(w);
        let [along_u, along_v, along_w] =
            [u, v, w].map(|k| self.conservative_edges_for_low_corners(k));
        let (mut cell, mut voxel) = ([0; 3], [0; 3]);
        for i in self.first[u]..=self.last[u] {
            (cell[u], voxel[u]) = (self.low_end_from_origin(u, i), i);
            for j in self.first[v]..=self.last[v] {
                (cell[v], voxel[v]) = (self.low_end_from_origin(v, j), j);
                if !contain_square(&along_w, [cell[u], cell[v]]) {
                    continue;
                }
                for k in self.voxels_along_w_in_plane([u, v, w], cell) {
                    (cell[w], voxel[w]) = (self.low_end_from_origin(w, k), k);
                    if contain_square(&along_u, [cell[v], cell[w]])
                        && contain_square(&along_v, [cell[w], cell[u]])
                    {
                        touched.row_mut(voxel[1], voxel[2]).insert(voxel[0]);
                    }
                }
            }
        }
    }

    /// Returns the edge functions of the projection along `axis`, each moved outwards so that a voxel-sized
    /// square overlaps the projection exactly if its low corner is inside all three.
    #[inline(always)]
    fn conservative_edges_for_low_corners(&self, axis: usize) -> [ProjectedEdge; 3] {
        let mut edges = self.projected_edges(axis);
        if self.normal[axis] == 0 {
            // The projection is a segment: any edge of non-zero length gives both sides.
            let edge = edges.into_iter().find(|edge| edge.slope != [0; 2]).unwrap_or(edges[0]);
            let [s, t] = edge.slope;
            edges = [edge, ProjectedEdge { slope: [-s, -t], offset: -edge.offset }, edge];
        }
        let turn = if self.normal[axis] < 0 { -1 } else { 1 };
        for edge in &mut edges {
            edge.slope = edge.slope.map(|s| s * turn);
            edge.offset *= turn;
            edge.offset += (edge.slope[0].max(0) + edge.slope[1].max(0)) * VOXEL_UNITS;
        }
        edges
    }

    /// Returns the low end of a voxel along an axis, in units relative to `origin`.
    #[inline(always)]
    fn low_end_from_origin(&self, axis: usize, voxel: usize) -> i64 {
        (voxel as i64 - self.first[axis] as i64 - 1) * VOXEL_UNITS
    }

    /// Returns the voxels along w, inside the bounds, through which the plane passes over the cell with its
    /// low corner at `cell_low`.
    #[inline(always)]
    fn voxels_along_w_in_plane(
        &self,
        [u, v, w]: [usize; 3],
        cell_low: [i64; 3],
    ) -> core::ops::Range<usize> {
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

/// Returns the two other axes, in cyclic order after `axis`.
#[inline(always)]
pub(super) const fn other_axes(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

/// Returns `true` if a voxel-sized square's low corner is inside all three conservative edges.
#[inline(always)]
fn contain_square(edges: &[ProjectedEdge; 3], low_corner: [i64; 2]) -> bool {
    let inside = |edge: &ProjectedEdge| {
        edge.slope[0] * low_corner[0] + edge.slope[1] * low_corner[1] + edge.offset >= 0
    };
    inside(&edges[0]) & inside(&edges[1]) & inside(&edges[2])
}

/// A set of the octants around a triangle's origin: bit i is octant i, which lies on the high side of axis k
/// if bit k of i is set.
type OctantMask = u8;

/// The sign of a number as returned by [`sign_index`]: 0 for negative, 1 for zero, 2 for positive.
type SignIndex = usize;

/// The octants on the high side of each axis.
const HIGH_OCTANTS: [OctantMask; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

/// For each axis, the octants in the quadrant that a 2D direction on the [`other_axes`] points to, at index
/// `3 * sign_index(u) + sign_index(v)`. A component of zero selects both sides of its axis.
const QUADRANT_OCTANTS: [[OctantMask; 9]; 3] = {
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
const DIRECTION_OCTANTS: [OctantMask; 27] = {
    let mut table = [0; 27];
    let mut i = 0;
    while i < 27 {
        table[i] =
            octants_on_side(0, i / 9) & octants_on_side(1, i / 3 % 3) & octants_on_side(2, i % 3);
        i += 1;
    }
    table
};

/// Returns the octants on the low side of an axis for [`sign_index`] 0, all octants for 1, those on the high
/// side for 2.
const fn octants_on_side(axis: usize, side: SignIndex) -> OctantMask {
    [!HIGH_OCTANTS[axis], 0xff, HIGH_OCTANTS[axis]][side]
}

/// Returns 0 for negative, 1 for zero, 2 for positive numbers.
#[inline(always)]
fn sign_index(value: i64) -> SignIndex {
    (value >= 0) as usize + (value > 0) as usize
}

/// Returns the table's octants for a direction if `sign` is positive, for the opposite direction if it is
/// negative, and no octants if it is zero.
#[inline(always)]
fn octants_in_signed_direction<const M: usize>(
    octants_by_direction: &[OctantMask; M],
    direction_index: usize,
    sign: SignIndex,
) -> OctantMask {
    let at = if sign == 0 { M - 1 - direction_index } else { direction_index };
    octants_by_direction[at] & ((sign != 1) as u8).wrapping_neg()
}

/// Sets bit `first_x` if bit 0 of `two_bits` is set, and the next bit if bit 1 is set.
#[inline(always)]
fn insert_two_voxels<const N: usize>(row: &mut <Grid<N> as Size>::Row, first_x: usize, two_bits: u8)
where
    Grid<N>: Size,
{
    let (x, pair) = (first_x, two_bits);
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
