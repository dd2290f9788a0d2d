//! Model of the export by its naive definition: marching cubes over voxel centres and Laplacian smoothing.
//! All vertices lie in one array; their neighbours are found from every square of four voxel centres.

use std::collections::HashMap;

use crate::dense::{DenseVolume, face_neighbours};

/// Returns the exported voxels of a volume: the support S(V), or the largest part if nothing is supported.
#[must_use]
pub fn exported_voxels(volume: &DenseVolume, mask: &DenseVolume) -> DenseVolume {
    let grounded = volume.occupied().any(|[_, y, _]| y == 0);
    if grounded || !volume.intersection(mask).is_empty() {
        return volume.supported_by_ground_or(mask);
    }
    let mut seen = DenseVolume::empty(volume.side());
    let mut largest = Vec::new();
    for voxel in volume.occupied() {
        let mut part = Vec::new();
        let mut next = vec![voxel];
        while let Some(voxel) = next.pop() {
            if volume.contains(voxel) && !seen.contains(voxel) {
                seen.set(voxel, true);
                part.push(voxel);
                next.extend(face_neighbours(voxel));
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
pub struct SurfaceModel {
    /// Vertices at the middle of their edges, in half voxels.
    pub raw: Vec<[i32; 3]>,
    /// The same vertices smoothed, in 1/128 voxel.
    pub smooth: Vec<[i32; 3]>,
    /// The contour segments on the squares of four centres, as pairs of vertex indices.
    pub segments: Vec<[usize; 2]>,
    /// The number of triangles: a loop of k vertices in a cell gives k - 2.
    pub triangles: usize,
}

impl SurfaceModel {
    /// Returns the surface of a set of voxels.
    #[must_use]
    pub fn from_voxels(solid: &DenseVolume) -> Self {
        let mut surface = SurfaceModel::default();
        let mut ids = HashMap::new();
        for voxel in solid.occupied() {
            for empty in face_neighbours(voxel).into_iter().filter(|&v| !solid.contains(v)) {
                ids.insert(CrossingEdge { solid: voxel, empty }, surface.raw.len());
                surface.raw.push([0, 1, 2].map(|i| voxel[i] + empty[i]));
            }
        }
        for corner in lowest_corners_of_cells(solid) {
            let mut cell = Vec::new();
            for axis in 0..3 {
                let here = contour_of_square(solid, corner, axis);
                surface.segments.extend(here.iter().map(|ends| ends.map(|end| ids[&end])));
                let mut opposite = corner;
                opposite[axis] += 1;
                cell.extend(here);
                cell.extend(contour_of_square(solid, opposite, axis));
            }
            surface.triangles += count_cell_triangles(&cell);
        }
        let once = smooth_once(&surface.raw, &surface.segments);
        surface.smooth = smooth_once(&once, &surface.segments);
        surface
    }
}

/// An edge of a cell from a solid to an empty voxel centre.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
struct CrossingEdge {
    solid: [i32; 3],
    empty: [i32; 3],
}

/// Returns the lowest corners of all cells (cubes of eight voxel centres) that touch a solid voxel.
fn lowest_corners_of_cells(solid: &DenseVolume) -> Vec<[i32; 3]> {
    let mut all: Vec<_> = solid
        .occupied()
        .flat_map(|[x, y, z]| (0..8).map(move |k| [x - (k & 1), y - (k >> 1 & 1), z - (k >> 2)]))
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// Marching squares on the square of four centres across an axis: returns segments between two edges from a
/// solid to an empty centre. Two solid corners on a diagonal are cut off separately.
fn contour_of_square(
    solid: &DenseVolume,
    lowest_corner: [i32; 3],
    normal_axis: usize,
) -> Vec<[CrossingEdge; 2]> {
    let at = |u: i32, v: i32| {
        let mut voxel = lowest_corner;
        voxel[(normal_axis + 1) % 3] += u;
        voxel[(normal_axis + 2) % 3] += v;
        voxel
    };
    let square = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
    let is_solid = square.map(|voxel| solid.contains(voxel));
    let crossing = |i: usize, j: usize| {
        let (i, j) = if is_solid[i % 4] { (i % 4, j % 4) } else { (j % 4, i % 4) };
        CrossingEdge { solid: square[i], empty: square[j] }
    };
    let round = |i: usize| [crossing(i, i + 1), crossing(i, i + 3)];
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
            segments.push([crossing(i, i + 3), crossing(i + 1, i + 2)]);
        }
    }
    segments
}

/// Returns the number of triangles of a cell, from the contours on its six sides.
fn count_cell_triangles(segments: &[[CrossingEdge; 2]]) -> usize {
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

/// One step of Laplacian smoothing: p/2 + sum/8 over the four neighbours, in units of 1/8 of the input's.
fn smooth_once(vertices: &[[i32; 3]], segments: &[[usize; 2]]) -> Vec<[i32; 3]> {
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
