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
    /// Bounds of the corners, relative to `origin`.
    pub(super) min: [i64; 3],
    pub(super) max: [i64; 3],
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

/// A directed edge of a shadow: `slope . p + offset` is zero along it and positive inside, or zero
/// at all three corners where the shadow has no area.
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
            min: [0; 3],
            max: [0; 3],
            first: [0; 3],
            last: [0; 3],
            edges: [[0; 3]; 3],
            offsets: [[0; 3]; 3],
            normal: [0; 3],
        };
        for k in 0..3 {
            // A face at both ends belongs to the voxels on either side.
            shape.first[k] = ((low[k] - 1) >> SHIFT).max(0) as usize;
            shape.last[k] = ((high[k] >> SHIFT) as usize).min(N - 1);
            shape.origin[k] = (shape.first[k] as i64 + 1) * SIDE;
            shape.min[k] = i64::from(low[k]) - shape.origin[k];
            shape.max[k] = i64::from(high[k]) - shape.origin[k];
            for i in 0..3 {
                shape.corners[i][k] = i64::from(points[i][k]) - shape.origin[k];
            }
            for i in 0..3 {
                shape.edges[i][k] = shape.corners[(i + 1) % 3][k] - shape.corners[i][k];
            }
        }
        for k in 0..3 {
            let [u, v] = across(k);
            for i in 0..3 {
                let (from, to) = (&shape.corners[i], &shape.corners[(i + 1) % 3]);
                shape.offsets[k][i] = from[u] * to[v] - from[v] * to[u];
                shape.normal[k] += shape.offsets[k][i];
            }
        }
        Some(shape)
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
        let turn = if self.normal[k] < 0 { -1 } else { 1 };
        Edge {
            slope: [-self.edges[i][v] * turn, self.edges[i][u] * turn],
            offset: self.offsets[k][i] * turn,
        }
    }

    /// Sets every voxel whose closed box the triangle touches.
    #[inline(always)]
    pub(super) fn touch<const N: usize>(&self, touched: &mut Plane<N>)
    where
        Grid<N>: Size,
    {
        let more = [0, 1, 2].map(|k| self.last[k] - self.first[k]);
        if more[0] | more[1] | more[2] <= 1 {
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
        let mut missed = 0;
        // Along an axis with one voxel the shadows' other tests have nothing to tell apart, and
        // the octants beyond it are none.
        for k in 0..3 {
            let low_only = (self.first[k] == self.last[k]) as u8;
            missed |= HIGH[k] & low_only.wrapping_neg();
        }
        for k in 0..3 {
            missed |= self.octants_missed(k);
        }
        let [x, y, z] = [0, 1, 2].map(|k| self.normal[k] * self.corners[0][k]);
        let height = (x + y + z).signum();
        let away = self.normal.map(|n| -n.signum() * height);
        let beyond = side(0, away[0]) & side(1, away[1]) & side(2, away[2]);
        missed |= beyond & ((height != 0) as u8).wrapping_neg();
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
        let area = self.normal[k].signum();
        let mut missed = 0;
        for i in 0..3 {
            // Signs before the turn: where the turn is -1, offset and slope change together.
            let beside = self.offsets[k][i].signum();
            let away = side(u, -self.edges[i][v] * beside) & side(v, self.edges[i][u] * beside);
            missed |= away & ((beside != 0 && beside != area) as u8).wrapping_neg();
        }
        missed
    }

    /// One voxel thick along axis k: the shadow along it decides alone.
    fn touch_sheet<const N: usize>(&self, k: usize, touched: &mut Plane<N>)
    where
        Grid<N>: Size,
    {
        let [u, v] = across(k);
        let line = self.first[u] == self.last[u] || self.first[v] == self.last[v];
        let mut voxel = self.first;
        for i in self.first[u]..=self.last[u] {
            voxel[u] = i;
            for j in self.first[v]..=self.last[v] {
                voxel[v] = j;
                // The triangle reaches both ends of a line of voxels and leaves none of it.
                if line || !self.misses(k, [self.local(u, i), self.local(v, j)]) {
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
        let (mut cell, mut voxel) = ([0; 3], [0; 3]);
        for i in self.first[u]..=self.last[u] {
            (cell[u], voxel[u]) = (self.local(u, i), i);
            for j in self.first[v]..=self.last[v] {
                (cell[v], voxel[v]) = (self.local(v, j), j);
                if self.misses(w, [cell[u], cell[v]]) {
                    continue;
                }
                for k in self.passed([u, v, w], cell) {
                    (cell[w], voxel[w]) = (self.local(w, k), k);
                    if !self.misses(u, [cell[v], cell[w]]) && !self.misses(v, [cell[w], cell[u]]) {
                        touched.row_mut(voxel[1], voxel[2]).insert(voxel[0]);
                    }
                }
            }
        }
    }

    /// The low end of a voxel, relative to `origin`.
    #[inline(always)]
    fn local(&self, axis: usize, voxel: usize) -> i64 {
        (voxel as i64 - self.first[axis] as i64 - 1) * SIDE
    }

    /// Whether an edge separates the closed voxel-sized square at `low` from the shadow along k.
    #[inline(always)]
    fn misses(&self, k: usize, low: [i64; 2]) -> bool {
        let flat = self.normal[k] == 0;
        (0..3).any(|i| {
            let Edge { slope: [s, t], offset } = self.edge(k, i);
            let at_low = s * low[0] + t * low[1] + offset;
            at_low + (s.max(0) + t.max(0)) * SIDE < 0
                || (flat && at_low + (s.min(0) + t.min(0)) * SIDE > 0)
        })
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

/// The octants around the origin on the high side of axis k. Octant i is where bit k of i is set.
const HIGH: [u8; 3] = [0b1010_1010, 0b1100_1100, 0b1111_0000];

/// The octants on the high side of axis k where `sign` is positive, on the low side where it is
/// negative, and all for zero.
#[inline(always)]
fn side(k: usize, sign: i64) -> u8 {
    let high = ((sign >= 0) as u8).wrapping_neg();
    let low = ((sign <= 0) as u8).wrapping_neg();
    HIGH[k] & high | !HIGH[k] & low
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
