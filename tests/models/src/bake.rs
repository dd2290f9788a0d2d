//! Model of mesh voxelisation by its naive definition, in exact fractions: every triangle is clipped to every
//! voxel's box, and every column sorts its crossings with the mesh.

use std::cmp::Reverse;

use paros_core::limits::BAKED_CROSSINGS;
use paros_core::volume::Axis;

use crate::layers::{Intervals, closed_intervals};

/// A triangle's corners in units of 1/256 voxel; coordinates up to 16 * 256, so that no product overflows.
pub type Triangle = [[i32; 3]; 3];

/// The result of a bake.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BakedVoxels {
    /// The voxels of a grid of n^3, x fastest, then y, then z.
    pub occupied: Vec<bool>,
    /// The columns' intervals, by axis, line and place.
    pub columns: [Vec<Intervals>; 3],
    /// `true` if the mesh's signed volume was negative, so that its orientation was reversed.
    pub flipped: bool,
    /// The number of triangles without area.
    pub degenerate: u64,
    /// The number of columns extended to an end of the box because the mesh is open there.
    pub opened: u32,
}

/// Triangles, and the voxels of a grid of `side`^3 that they touch.
#[derive(Debug)]
pub struct TouchedVoxels<'a> {
    side: usize,
    triangles: &'a [Triangle],
    touched: Vec<bool>,
    /// The crossings, by axis, line and place.
    crossings: [Vec<Vec<RayCrossing>>; 3],
}

impl<'a> TouchedVoxels<'a> {
    /// Clips every triangle to every voxel.
    #[must_use]
    pub fn new(side: usize, triangles: &'a [Triangle]) -> Self {
        let mut touched = vec![false; side * side * side];
        for triangle in triangles {
            for [x, y, z] in touched_voxels(side, triangle) {
                touched[x + side * (y + side * z)] = true;
            }
        }
        let crossings = Axis::ALL.map(|axis| {
            let columns = column_voxels(side, axis);
            columns.iter().map(|column| crossings_of_ray(triangles, axis, column[0])).collect()
        });
        TouchedVoxels { side, triangles, touched, crossings }
    }

    /// Bakes into columns of at most `layers` intervals.
    ///
    /// # Panics
    /// A winding number changes along untouched voxels, or the volume differs from its columns.
    #[must_use]
    pub fn bake(&self, layers: usize) -> BakedVoxels {
        let side = self.side;
        let flipped = six_times_signed_volume(side, self.triangles) < 0;
        let mut opened = 0;
        let mut columns = Axis::ALL.map(|axis| {
            let columns = column_voxels(side, axis);
            let crossings = &self.crossings[axis as usize];
            let intervals = columns.iter().zip(crossings).map(|(column, crossings)| {
                let touched = self.bits_of(column, &self.touched);
                let (low, high) = ends_at_holes(crossings, flipped);
                let mut intervals = intervals_without_gaps(&touched, crossings, layers);
                if low {
                    intervals.first_mut().unwrap().0 = 0;
                }
                if high {
                    intervals.last_mut().unwrap().1 = side - 1;
                }
                opened += u32::from(low || high);
                intervals
            });
            intervals.collect::<Vec<_>>()
        });
        let occupied = self.intersection(&columns);
        for axis in Axis::ALL {
            for (voxels, held) in column_voxels(side, axis).iter().zip(&mut columns[axis as usize])
            {
                *held = closed_intervals(&self.bits_of(voxels, &occupied), held, layers);
            }
        }
        assert!(self.intersection(&columns) == occupied, "closure changes the volume");
        let degenerate =
            self.triangles.iter().filter(|t| triangle_normal(t) == [0; 3]).count() as u64;
        BakedVoxels { occupied, columns, flipped, degenerate, opened }
    }

    fn bits_of(&self, column: &[[usize; 3]], voxels: &[bool]) -> Vec<bool> {
        column.iter().map(|&[x, y, z]| voxels[x + self.side * (y + self.side * z)]).collect()
    }

    /// Returns the voxels that lie in all three of their columns.
    fn intersection(&self, columns: &[Vec<Intervals>; 3]) -> Vec<bool> {
        let side = self.side;
        let mut all = vec![true; side * side * side];
        for axis in Axis::ALL {
            for (voxels, column) in column_voxels(side, axis).iter().zip(&columns[axis as usize]) {
                for (i, &[x, y, z]) in voxels.iter().enumerate() {
                    let held = column.iter().any(|&(lo, hi)| lo <= i && i <= hi);
                    all[x + side * (y + side * z)] &= held;
                }
            }
        }
        all
    }
}

/// Returns the hull of a column's touched voxels without its gaps. The gaps are the longest `layers - 1`
/// untouched runs inside the hull with winding number 0, lower ones first if equally long; there are none if
/// the crossings don't add up to 0 or are too many.
fn intervals_without_gaps(touched: &[bool], crossings: &[RayCrossing], layers: usize) -> Intervals {
    let Some(first) = touched.iter().position(|&bit| bit) else {
        return Vec::new();
    };
    let last = touched.iter().rposition(|&bit| bit).unwrap();
    let mut gaps: Vec<(usize, usize)> = Vec::new();
    let mut i = first;
    while i < last {
        let end = (i..=last).find(|&j| touched[j] != touched[i]).unwrap_or(last + 1);
        if !touched[i] {
            let winding = winding_number(crossings, i);
            assert!((i..end).all(|j| winding_number(crossings, j) == winding));
            if winding == 0 {
                gaps.push((i, end - 1));
            }
        }
        i = end;
    }
    let sum: i32 = crossings.iter().map(|crossing| crossing.facing).sum();
    if sum != 0 || crossings.len() > BAKED_CROSSINGS {
        gaps.clear();
    }
    gaps.sort_by_key(|&(lo, hi)| (Reverse(hi - lo), lo));
    gaps.truncate(layers - 1);
    gaps.sort_unstable();
    let starts = std::iter::once(first).chain(gaps.iter().map(|&(_, hi)| hi + 1));
    let ends = gaps.iter().map(|&(lo, _)| lo - 1).chain(std::iter::once(last));
    starts.zip(ends).collect()
}

/// Returns the winding number at voxel `i`'s centre: the surfaces that a column's ray enters below it, less
/// those that it leaves.
fn winding_number(crossings: &[RayCrossing], i: usize) -> i32 {
    let centre = Fraction(256 * i as i128 + 128, 1);
    let below = crossings.iter().filter(|crossing| crossing.height[0] < centre);
    -below.map(|crossing| crossing.facing).sum::<i32>()
}

/// Returns whether the mesh is open at the low and at the high end of a column: the first surfaces crossed,
/// at one height, are left, or the last are entered.
fn ends_at_holes(crossings: &[RayCrossing], flipped: bool) -> (bool, bool) {
    let outwards = if flipped { -1 } else { 1 };
    let mut groups = crossings
        .chunk_by(|a, b| a.height == b.height)
        .map(|group| outwards * group.iter().map(|crossing| crossing.facing).sum::<i32>());
    let first = groups.next().unwrap_or(0);
    (first > 0, groups.next_back().unwrap_or(first) < 0)
}

/// Returns the voxels of every column along an axis, in order.
fn column_voxels(side: usize, axis: Axis) -> Vec<Vec<[usize; 3]>> {
    let places = (0..side).flat_map(|line| (0..side).map(move |place| (line, place)));
    places.map(|at| (0..side).map(|i| axis.voxel_at(at, i)).collect()).collect()
}

/// A point in homogeneous coordinates: (x, y, z) / w, with w positive.
type HomogeneousPoint = [i128; 4];

/// Returns the voxels whose closed boxes a triangle touches.
fn touched_voxels(side: usize, triangle: &Triangle) -> Vec<[usize; 3]> {
    let corners: Vec<HomogeneousPoint> = triangle
        .iter()
        .map(|p| [i128::from(p[0]), i128::from(p[1]), i128::from(p[2]), 1])
        .collect();
    let mut voxels = Vec::new();
    for x in 0..side {
        let slab = clip_to_slab(&corners, 0, x);
        if slab.is_empty() {
            continue;
        }
        for y in 0..side {
            let beam = clip_to_slab(&slab, 1, y);
            if beam.is_empty() {
                continue;
            }
            for z in 0..side {
                let reaches_low = beam.iter().any(|p| p[2] >= 256 * z as i128 * p[3]);
                let reaches_high = beam.iter().any(|p| p[2] <= 256 * (z as i128 + 1) * p[3]);
                if reaches_low && reaches_high {
                    voxels.push([x, y, z]);
                }
            }
        }
    }
    voxels
}

/// Clips a convex polygon to the closed slab of voxel `i` along an axis.
fn clip_to_slab(polygon: &[HomogeneousPoint], axis: usize, i: usize) -> Vec<HomogeneousPoint> {
    let above = clip_to_half_space(polygon, |p| p[axis] - 256 * i as i128 * p[3]);
    clip_to_half_space(&above, |p| 256 * (i as i128 + 1) * p[3] - p[axis])
}

/// Clips a convex polygon to the half space where `signed_height`, linear in a point, is not negative
/// (Sutherland and Hodgman, 1974).
fn clip_to_half_space(
    polygon: &[HomogeneousPoint],
    signed_height: impl Fn(&HomogeneousPoint) -> i128,
) -> Vec<HomogeneousPoint> {
    let mut kept = Vec::new();
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (h_p, h_q) = (signed_height(p), signed_height(q));
        if h_p >= 0 {
            kept.push(*p);
        }
        if (h_p < 0 && h_q > 0) || (h_p > 0 && h_q < 0) {
            kept.push([0, 1, 2, 3].map(|k| p[k] * h_q.abs() + q[k] * h_p.abs()));
        }
    }
    kept
}

/// A crossing of a column's centre line with a triangle.
#[derive(Clone, Copy, Debug)]
struct RayCrossing {
    /// The height along the axis at the centre (c, d) moved to (c + e, d + e^2), by powers of e.
    height: [Fraction; 3],
    /// 1 where the line leaves the mesh, -1 where it enters it.
    facing: i32,
}

/// Returns the crossings of a column's centre line, in order along the axis.
fn crossings_of_ray(
    triangles: &[Triangle],
    axis: Axis,
    column_voxel: [usize; 3],
) -> Vec<RayCrossing> {
    let w = axis as usize;
    let [u, v] = [(w + 1) % 3, (w + 2) % 3];
    let centre = [u, v].map(|k| 256 * column_voxel[k] as i128 + 128);
    let mut found = Vec::new();
    for triangle in triangles {
        let is_beside = [u, v].into_iter().zip(centre).any(|(k, centre)| {
            let side_of = |p: &[i32; 3]| i128::from(p[k]).cmp(&centre);
            let [a, b, c] = triangle.each_ref().map(side_of);
            a.is_ne() && a == b && b == c
        });
        if is_beside {
            continue;
        }
        let n = triangle_normal(triangle);
        if n[w] != 0 && projection_contains(triangle, [u, v], centre) {
            let p = triangle[0].map(i128::from);
            // n . (r - p) = 0 for r = (centre + (e, e^2), height), by powers of e.
            let at_centre = n[w] * p[w] - n[u] * (centre[0] - p[u]) - n[v] * (centre[1] - p[v]);
            let height = [at_centre, -n[u], -n[v]].map(|part| Fraction(part, n[w]));
            found.push(RayCrossing { height, facing: n[w].signum() as i32 });
        }
    }
    found.sort_by_key(|crossing| crossing.height);
    found
}

/// Returns `true` if a triangle's projection to (u, v) contains the column's centre moved by (e, e^2), with e
/// = 2^-20, which is small enough that no edge is nearer (simulation of simplicity, Edelsbrunner and Muecke
/// 1990).
fn projection_contains(triangle: &Triangle, axes: [usize; 2], centre: [i128; 2]) -> bool {
    let fine = |units: i128| units << 40;
    let p = [fine(centre[0]) + (1 << 20), fine(centre[1]) + 1];
    let sides = [0, 1, 2].map(|i| {
        let [a, b] = [i, (i + 1) % 3].map(|c| axes.map(|k| fine(i128::from(triangle[c][k]))));
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    });
    sides.iter().all(|&s| s > 0) || sides.iter().all(|&s| s < 0)
}

/// A fraction: numerator and denominator, which may be negative.
#[derive(Clone, Copy, Debug)]
struct Fraction(i128, i128);

impl Ord for Fraction {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let sign = self.1.signum() * other.1.signum();
        (self.0 * other.1 * sign).cmp(&(other.0 * self.1 * sign))
    }
}

impl PartialOrd for Fraction {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Fraction {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Fraction {}

/// Returns a triangle's normal, with a length of twice the area.
fn triangle_normal(triangle: &Triangle) -> [i128; 3] {
    let [a, b, c] = triangle.map(|p| p.map(i128::from));
    let (d, e) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
    [0, 1, 2].map(|k| {
        let (u, v) = ((k + 1) % 3, (k + 2) % 3);
        d[u] * e[v] - d[v] * e[u]
    })
}

/// Returns six times the signed volume between the triangles and the box's centre.
fn six_times_signed_volume(side: usize, triangles: &[Triangle]) -> i128 {
    let centre = 128 * side as i128;
    let volume = |t: &Triangle| -> i128 {
        (0..3).map(|k| triangle_normal(t)[k] * (i128::from(t[0][k]) - centre)).sum()
    };
    triangles.iter().map(volume).sum()
}
