//! Model of mesh voxelisation: every triangle is clipped to every voxel's box, and every column sorts its
//! crossings with the mesh. The naive definition, in exact fractions.

use paros_core::{Axis, Column, Range, RangeMaps};

/// Three corners in units of 1/256 voxel; coordinates up to 16 * 256, so that no product overflows.
pub type Triangle = [[i32; 3]; 3];

/// The result of a bake.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BakedVoxels {
    /// The voxels of a grid of n^3, x fastest, then y, then z.
    pub occupied: Vec<bool>,
    /// Whether the mesh's signed volume was negative, so that its orientation was reversed.
    pub flipped: bool,
    /// The number of triangles without area.
    pub degenerate: u64,
    /// The number of columns that were extended to an end of the box, as the mesh is open there.
    pub opened: u32,
}

/// Voxelises triangles in a grid of `side`^3 voxels.
#[must_use]
pub fn bake_triangles(side: usize, triangles: &[Triangle]) -> BakedVoxels {
    let mut touched = vec![false; side * side * side];
    for triangle in triangles {
        for [x, y, z] in touched_voxels(side, triangle) {
            touched[x + side * (y + side * z)] = true;
        }
    }
    let flipped = six_times_signed_volume(side, triangles) < 0;
    let mut occupied = vec![true; side * side * side];
    let mut opened = 0;
    for axis in Axis::ALL {
        for column in column_voxels(side, axis) {
            let hull: Vec<bool> =
                column.iter().map(|&[x, y, z]| touched[x + side * (y + side * z)]).collect();
            let mut lo = hull.iter().position(|&bit| bit).unwrap_or(side);
            let mut end = hull.iter().rposition(|&bit| bit).map_or(0, |hi| hi + 1);
            let groups = signs_of_crossings(triangles, axis, column[0]);
            let outwards = if flipped { -1 } else { 1 };
            let below = groups.first().is_some_and(|&facing| facing * outwards > 0);
            let above = groups.last().is_some_and(|&facing| facing * outwards < 0);
            if below {
                lo = 0;
            }
            if above {
                end = side;
            }
            opened += u32::from(below || above);
            for (i, &[x, y, z]) in column.iter().enumerate() {
                occupied[x + side * (y + side * z)] &= lo <= i && i < end;
            }
        }
    }
    let degenerate = triangles.iter().filter(|t| triangle_normal(t) == [0; 3]).count() as u64;
    BakedVoxels { occupied, flipped, degenerate, opened }
}

/// Writes the hull of every column of a set of voxels to the maps.
pub fn write_column_hulls<const N: usize>(occupied: &[bool], maps: &mut RangeMaps<N>) {
    for axis in Axis::ALL {
        for column in column_voxels(N, axis) {
            let inside = |&[x, y, z]: &[usize; 3]| occupied[x + N * (y + N * z)];
            let lo = column.iter().position(inside);
            let hi = column.iter().rposition(inside);
            let range = lo.zip(hi).map_or(Range::EMPTY, |(lo, hi)| Range::new(lo, hi));
            maps.set_column(axis, axis.column_address(column[0]), Column([range]));
        }
    }
}

/// The voxels of every column along an axis, in order.
fn column_voxels(side: usize, axis: Axis) -> Vec<Vec<[usize; 3]>> {
    let places = (0..side).flat_map(|line| (0..side).map(move |place| (line, place)));
    places.map(|at| (0..side).map(|i| axis.voxel_at(at, i)).collect()).collect()
}

/// A point in homogeneous coordinates: (x, y, z) / w, with w positive.
type HomogeneousPoint = [i128; 4];

/// The voxels whose closed boxes a triangle touches.
fn touched_voxels(side: usize, triangle: &Triangle) -> Vec<[usize; 3]> {
    let corners: Vec<HomogeneousPoint> = triangle
        .iter()
        .map(|p| [i128::from(p[0]), i128::from(p[1]), i128::from(p[2]), 1])
        .collect();
    let mut voxels = Vec::new();
    for x in 0..side {
        let slab = clip_to_slab(&corners, 0, x);
        for y in 0..side {
            let beam = clip_to_slab(&slab, 1, y);
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

/// The facings of the crossings of a column's centre line, in order along the axis: positive where the line
/// leaves the mesh, and the sum where several triangles are crossed at one height.
fn signs_of_crossings(triangles: &[Triangle], axis: Axis, column_voxel: [usize; 3]) -> Vec<i32> {
    let w = axis as usize;
    let [u, v] = [(w + 1) % 3, (w + 2) % 3];
    let centre = [u, v].map(|k| 256 * column_voxel[k] as i128 + 128);
    let mut found: Vec<([Fraction; 3], i32)> = Vec::new();
    for triangle in triangles {
        let n = triangle_normal(triangle);
        if n[w] != 0 && projection_contains(triangle, [u, v], centre) {
            let p = triangle[0].map(i128::from);
            // n . (r - p) = 0 for r = (centre + (e, e^2), height), by powers of e.
            let at_centre = n[w] * p[w] - n[u] * (centre[0] - p[u]) - n[v] * (centre[1] - p[v]);
            let height = [at_centre, -n[u], -n[v]].map(|part| Fraction(part, n[w]));
            found.push((height, n[w].signum() as i32));
        }
    }
    found.sort_by_key(|(height, _)| *height);
    let mut sums: Vec<([Fraction; 3], i32)> = Vec::new();
    for (height, facing) in found {
        match sums.last_mut() {
            Some((last, sum)) if *last == height => *sum += facing,
            _ => sums.push((height, facing)),
        }
    }
    sums.into_iter().map(|(_, sum)| sum).collect()
}

/// Whether a triangle's projection to (u, v) contains the column's centre moved by (e, e^2), with e = 2^-20
/// (simulation of simplicity, Edelsbrunner and Muecke 1990): at this size no edge is nearer than that.
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

/// A triangle's normal, as long as twice its area.
fn triangle_normal(triangle: &Triangle) -> [i128; 3] {
    let [a, b, c] = triangle.map(|p| p.map(i128::from));
    let (d, e) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
    [0, 1, 2].map(|k| {
        let (u, v) = ((k + 1) % 3, (k + 2) % 3);
        d[u] * e[v] - d[v] * e[u]
    })
}

/// Six times the signed volume between the triangles and the box's centre.
fn six_times_signed_volume(side: usize, triangles: &[Triangle]) -> i128 {
    let centre = 128 * side as i128;
    let volume = |t: &Triangle| -> i128 {
        (0..3).map(|k| triangle_normal(t)[k] * (i128::from(t[0][k]) - centre)).sum()
    };
    triangles.iter().map(volume).sum()
}
