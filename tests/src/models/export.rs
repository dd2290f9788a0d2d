//! Export, naively: every vertex of the model in one array, smoothed as the definition says, with
//! its neighbours found by looking at every square of four voxel centres.

use std::collections::HashMap;

use super::dense::{Dense, neighbours};

/// S(V): what an export holds of a volume.
#[must_use]
pub fn printed(volume: &Dense, mask: &Dense) -> Dense {
    let grounded = volume.occupied().any(|[_, y, _]| y == 0);
    if grounded || !volume.and(mask).is_empty() {
        return volume.supported(mask);
    }
    let mut seen = Dense::new(volume.n());
    let mut largest = Vec::new();
    for voxel in volume.occupied() {
        let mut part = Vec::new();
        let mut next = vec![voxel];
        while let Some(voxel) = next.pop() {
            if volume.contains(voxel) && !seen.contains(voxel) {
                seen.set(voxel, true);
                part.push(voxel);
                next.extend(neighbours(voxel));
            }
        }
        if part.len() > largest.len() {
            largest = part;
        }
    }
    volume.connected_to(largest)
}

/// The surface between solid and empty voxel centres.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    /// Vertices halfway along their edges, in half voxels.
    pub raw: Vec<[i32; 3]>,
    /// The same vertices smoothed, in 1/128 voxel.
    pub smooth: Vec<[i32; 3]>,
    /// The contour on the squares between centres, as pairs of vertices.
    pub segments: Vec<[usize; 2]>,
    /// Triangles, by Euler: each loop of k vertices in a cell has k - 2.
    pub triangles: usize,
}

impl Surface {
    /// The surface of a set of voxels.
    #[must_use]
    pub fn new(solid: &Dense) -> Self {
        let mut surface = Surface::default();
        let mut ids = HashMap::new();
        for voxel in solid.occupied() {
            for beside in neighbours(voxel).into_iter().filter(|&v| !solid.contains(v)) {
                ids.insert((voxel, beside), surface.raw.len());
                surface.raw.push([0, 1, 2].map(|i| voxel[i] + beside[i]));
            }
        }
        for corner in corners(solid) {
            let mut cell = Vec::new();
            for axis in 0..3 {
                let here = contour(solid, corner, axis);
                surface.segments.extend(here.iter().map(|ends| ends.map(|end| ids[&end])));
                let mut opposite = corner;
                opposite[axis] += 1;
                cell.extend(here);
                cell.extend(contour(solid, opposite, axis));
            }
            surface.triangles += triangles_of(&cell);
        }
        let once = iterate(&surface.raw, &surface.segments);
        surface.smooth = iterate(&once, &surface.segments);
        surface
    }
}

type Edge = ([i32; 3], [i32; 3]);

/// The lowest corners of all cells that touch a solid voxel.
fn corners(solid: &Dense) -> Vec<[i32; 3]> {
    let mut all: Vec<_> = solid
        .occupied()
        .flat_map(|[x, y, z]| (0..8).map(move |k| [x - (k & 1), y - (k >> 1 & 1), z - (k >> 2)]))
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The contour on the square of four centres across an axis, each segment between two edges from a
/// solid centre to an empty one. Where two solid corners face each other, each is cut off singly.
fn contour(solid: &Dense, corner: [i32; 3], axis: usize) -> Vec<[Edge; 2]> {
    let at = |u: i32, v: i32| {
        let mut voxel = corner;
        voxel[(axis + 1) % 3] += u;
        voxel[(axis + 2) % 3] += v;
        voxel
    };
    let square = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
    let is_solid = square.map(|voxel| solid.contains(voxel));
    let edge = |i: usize, j: usize| {
        let (i, j) = (i % 4, j % 4);
        if is_solid[i] { (square[i], square[j]) } else { (square[j], square[i]) }
    };
    let round = |i: usize| [edge(i, i + 1), edge(i, i + 3)];
    let mut segments = Vec::new();
    for i in 0..4 {
        let [here, next, across, before] = [0, 1, 2, 3].map(|k| is_solid[(i + k) % 4]);
        if here && !next && !before {
            segments.push(round(i));
        }
        if !here && next && across && before {
            segments.push(round(i));
        }
        if here && next && !across && !before {
            segments.push([edge(i, i + 3), edge(i + 1, i + 2)]);
        }
    }
    segments
}

/// The triangles of a cell, from the contour on its six sides.
fn triangles_of(segments: &[[Edge; 2]]) -> usize {
    let mut left = segments.to_vec();
    let mut triangles = 0;
    while let Some([start, mut at]) = left.pop() {
        let mut length = 1;
        while at != start {
            let next = left.iter().position(|ends| ends.contains(&at)).expect("a closed loop");
            let ends = left.swap_remove(next);
            at = if ends[0] == at { ends[1] } else { ends[0] };
            length += 1;
        }
        triangles += length - 2;
    }
    triangles
}

/// p/2 + sum/8, in units of an eighth of the unit before.
fn iterate(vertices: &[[i32; 3]], segments: &[[usize; 2]]) -> Vec<[i32; 3]> {
    let mut moved: Vec<[i32; 3]> = vertices.iter().map(|v| v.map(|c| 4 * c)).collect();
    let mut neighbours = vec![0; vertices.len()];
    for &[a, b] in segments {
        for (to, from) in [(a, b), (b, a)] {
            neighbours[to] += 1;
            for axis in 0..3 {
                moved[to][axis] += vertices[from][axis];
            }
        }
    }
    assert!(neighbours.iter().all(|&count| count == 4), "each vertex has four neighbours");
    moved
}
