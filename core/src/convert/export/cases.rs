//! Marching cubes case table: the triangles for each of the 256 combinations of solid corners, derived
//! from the contour rule at compile time.
//!
//! A cell is a cube between eight voxel centres; corner `i + 2 j + 4 k` is the corner `i` up in x, `j` in y
//! and `k` in z. A vertex lies halfway along a cell edge from a solid corner to an empty one, and is
//! identified by that solid corner and the edge's axis. On every cell face the contour goes from vertex to
//! vertex by [`SurfaceTurn`], so the cells on both sides of a face agree.

use super::faces::{SurfaceTurn, TANGENTS, VoxelFace, cross_direction};

/// Upper bound of the triangles of a cell.
pub(super) const MAX_CELL_TRIANGLES: usize = 5;

/// A vertex of a cell: its solid corner and the axis of its edge, `3 * corner + axis`.
pub(super) type CellVertex = u8;

/// Number of values of [`CellVertex`].
pub(super) const CELL_VERTICES: usize = 24;

/// The triangles of a case, counter-clockwise seen from outside the solid.
#[derive(Clone, Copy)]
pub(super) struct CellCase {
    /// Number of triangles used.
    pub(super) count: u8,
    /// The triangles; those past `count` are zero.
    pub(super) triangles: [[CellVertex; 3]; MAX_CELL_TRIANGLES],
}

/// The triangles of each case: bit c of the index is set if corner c is solid.
pub(super) static CASES: [CellCase; 256] = {
    let mut cases = [CellCase { count: 0, triangles: [[0; 3]; MAX_CELL_TRIANGLES] }; 256];
    let mut solid = 0;
    while solid < 256 {
        cases[solid] = triangulate_case(solid);
        solid += 1;
    }
    cases
};

/// A corner of a cell, and a face of that corner's voxel.
pub(super) struct CornerFace {
    pub(super) corner: usize,
    pub(super) face: VoxelFace,
}

/// Returns the solid corner of a vertex, and the face of that corner's voxel with the vertex as its centre.
pub(super) const fn corner_and_face_of(vertex: CellVertex) -> CornerFace {
    let (corner, axis) = (vertex as usize / 3, vertex as usize % 3);
    // A corner at the low end of the axis has its edge towards the high side.
    CornerFace { corner, face: 2 * axis + (corner >> axis & 1) }
}

/// The inverse of [`corner_and_face_of`].
const fn join_vertex(CornerFace { corner, face }: CornerFace) -> CellVertex {
    (3 * corner + face / 2) as CellVertex
}

/// The closed contour of one component of the surface in a cell.
#[derive(Clone, Copy)]
struct CellContour {
    vertices: [CellVertex; 12],
    len: usize,
}

const fn triangulate_case(solid_mask: usize) -> CellCase {
    let mut case = CellCase { count: 0, triangles: [[0; 3]; MAX_CELL_TRIANGLES] };
    let mut seen = [false; CELL_VERTICES];
    let mut start = 0;
    while start < CELL_VERTICES {
        if !seen[start] && is_vertex(solid_mask, start as CellVertex) {
            let contour = trace_contour(solid_mask, start as CellVertex);
            let mut i = 0;
            while i < contour.len {
                seen[contour.vertices[i] as usize] = true;
                i += 1;
            }
            case = match triangulate_contour(&contour, 0, contour.len - 1, case) {
                Some(filled) => filled,
                None => panic!("a contour has no triangulation"),
            };
        }
        start += 1;
    }
    case
}

const fn is_vertex(solid_mask: usize, vertex: CellVertex) -> bool {
    let CornerFace { corner, face } = corner_and_face_of(vertex);
    solid_mask >> corner & 1 == 1 && solid_mask >> (corner ^ 1 << (face / 2)) & 1 == 0
}

/// Returns the contour through a vertex, counter-clockwise seen from outside.
const fn trace_contour(solid_mask: usize, start: CellVertex) -> CellContour {
    let mut contour = CellContour { vertices: [0; 12], len: 0 };
    let mut at = start;
    loop {
        contour.vertices[contour.len] = at;
        contour.len += 1;
        at = next_vertex(solid_mask, at);
        if at == start {
            return contour;
        }
    }
}

/// Returns the next vertex of the contour. Two cell faces meet at a vertex; the contour leaves through the
/// face in direction d for which d, the other face's direction and the outward normal are right-handed.
const fn next_vertex(solid_mask: usize, at: CellVertex) -> CellVertex {
    let CornerFace { corner, face: normal } = corner_and_face_of(at);
    let mut k = 0;
    loop {
        let along = TANGENTS[normal][k];
        let other = cross_direction(normal, along);
        if is_step_inside_cell(corner, along) && is_step_inside_cell(corner, other) {
            let beside = corner ^ 1 << (along / 2);
            let across = beside ^ 1 << (normal / 2);
            return match SurfaceTurn::from_neighbours(
                solid_mask >> beside & 1 == 1,
                solid_mask >> across & 1 == 1,
            ) {
                SurfaceTurn::Convex => join_vertex(CornerFace { corner, face: along }),
                SurfaceTurn::Straight => join_vertex(CornerFace { corner: beside, face: normal }),
                SurfaceTurn::Concave => join_vertex(CornerFace { corner: across, face: along ^ 1 }),
            };
        }
        k += 1;
    }
}

/// Returns `true` if a step from the corner in the direction of a face stays in the cell.
const fn is_step_inside_cell(corner: usize, face: VoxelFace) -> bool {
    corner >> (face / 2) & 1 == face & 1
}

/// Triangulates the polygon of the contour's vertices `first..=last` by backtracking. Returns the case with
/// those triangles added, or `None` if every triangulation has an invalid side.
const fn triangulate_contour(
    contour: &CellContour,
    first: usize,
    last: usize,
    case: CellCase,
) -> Option<CellCase> {
    if last - first < 2 {
        return Some(case);
    }
    let mut apex = first + 1;
    while apex < last {
        if is_valid_triangle_side(contour, first, apex)
            && is_valid_triangle_side(contour, apex, last)
        {
            let mut with = case;
            with.triangles[with.count as usize] =
                [contour.vertices[first], contour.vertices[apex], contour.vertices[last]];
            with.count += 1;
            if let Some(left) = triangulate_contour(contour, first, apex, with)
                && let Some(both) = triangulate_contour(contour, apex, last, left)
            {
                return Some(both);
            }
        }
        apex += 1;
    }
    None
}

/// Returns `true` if a triangle may have the side from vertex `i` to `j`: a side of the contour, or a
/// diagonal that lies in no cell face (the cell beyond that face could have the same diagonal, and four
/// triangles would share it).
const fn is_valid_triangle_side(contour: &CellContour, i: usize, j: usize) -> bool {
    j - i == 1 || !share_cell_face(contour.vertices[i], contour.vertices[j])
}

/// Returns `true` if two vertices lie in the same face of the cell.
const fn share_cell_face(a: CellVertex, b: CellVertex) -> bool {
    let ((a, a_axis), (b, b_axis)) =
        ((a as usize / 3, a as usize % 3), (b as usize / 3, b as usize % 3));
    let mut axis = 0;
    while axis < 3 {
        if axis != a_axis && axis != b_axis && (a ^ b) >> axis & 1 == 0 {
            return true;
        }
        axis += 1;
    }
    false
}
