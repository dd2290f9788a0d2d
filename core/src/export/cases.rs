//! The triangles of each of the 256 ways to fill a cell's corners, worked out from the contour
//! rule when the crate is compiled.
//!
//! A cell is a cube between eight voxel centres; corner `i + 2 j + 4 k` is the one `i` up in x, `j`
//! in y and `k` in z. A vertex lies halfway along a cell edge from a solid corner to an empty one,
//! and is named by that solid corner and the edge's axis. On every cell face the contour walks
//! from vertex to vertex by [`Turn`], so the cells on both sides of a face agree.

use super::faces::{Face, TANGENTS, Turn, cross};

/// The most triangles one cell holds.
pub(super) const MOST: usize = 5;

/// A vertex of a cell: its solid corner and the axis of its edge, `3 * corner + axis`.
pub(super) type CellVertex = u8;

/// How many vertices [`CellVertex`] can name.
pub(super) const CELL_VERTICES: usize = 24;

/// The triangles of one case, counter-clockwise seen from outside the solid.
#[derive(Clone, Copy)]
pub(super) struct Case {
    /// How many of the triangles are used.
    pub(super) count: u8,
    /// The triangles; those past `count` are zero.
    pub(super) triangles: [[CellVertex; 3]; MOST],
}

/// The triangles by case: bit c of the index says whether corner c is solid.
pub(super) static CASES: [Case; 256] = {
    let mut cases = [Case { count: 0, triangles: [[0; 3]; MOST] }; 256];
    let mut solid = 0;
    while solid < 256 {
        cases[solid] = triangulate(solid);
        solid += 1;
    }
    cases
};

/// The solid corner of a vertex and the face of that corner's voxel that it is the centre of.
pub(super) const fn corner_face(vertex: CellVertex) -> (usize, Face) {
    let (corner, axis) = (vertex as usize / 3, vertex as usize % 3);
    // A corner at the low end of the axis has its edge to the high side.
    (corner, 2 * axis + (corner >> axis & 1))
}

const fn vertex(corner: usize, face: Face) -> CellVertex {
    (3 * corner + face / 2) as CellVertex
}

/// A contour round one piece of the cell's surface.
#[derive(Clone, Copy)]
struct Loop {
    vertices: [CellVertex; 12],
    len: usize,
}

const fn triangulate(solid: usize) -> Case {
    let mut case = Case { count: 0, triangles: [[0; 3]; MOST] };
    let mut seen = [false; CELL_VERTICES];
    let mut start = 0;
    while start < CELL_VERTICES {
        if !seen[start] && is_vertex(solid, start as CellVertex) {
            let contour = follow(solid, start as CellVertex);
            let mut i = 0;
            while i < contour.len {
                seen[contour.vertices[i] as usize] = true;
                i += 1;
            }
            case = match fill(&contour, 0, contour.len - 1, case) {
                Some(filled) => filled,
                None => panic!("a contour has no triangulation"),
            };
        }
        start += 1;
    }
    case
}

const fn is_vertex(solid: usize, vertex: CellVertex) -> bool {
    let (corner, face) = corner_face(vertex);
    solid >> corner & 1 == 1 && solid >> (corner ^ 1 << (face / 2)) & 1 == 0
}

/// The loop through a vertex, counter-clockwise seen from outside.
const fn follow(solid: usize, start: CellVertex) -> Loop {
    let mut contour = Loop { vertices: [0; 12], len: 0 };
    let mut at = start;
    loop {
        contour.vertices[contour.len] = at;
        contour.len += 1;
        at = next(solid, at);
        if at == start {
            return contour;
        }
    }
}

/// The vertex after this one. Of the two cell faces at a vertex, the loop leaves through the one
/// towards d where d, the other one's direction and the outward normal are right-handed.
const fn next(solid: usize, at: CellVertex) -> CellVertex {
    let (corner, normal) = corner_face(at);
    let mut k = 0;
    loop {
        let along = TANGENTS[normal][k];
        let other = cross(normal, along);
        if inside(corner, along) && inside(corner, other) {
            let beside = corner ^ 1 << (along / 2);
            let across = beside ^ 1 << (normal / 2);
            return match Turn::new(solid >> beside & 1 == 1, solid >> across & 1 == 1) {
                Turn::Convex => vertex(corner, along),
                Turn::Straight => vertex(beside, normal),
                Turn::Concave => vertex(across, along ^ 1),
            };
        }
        k += 1;
    }
}

/// Whether a step from the corner in the direction of a face stays in the cell.
const fn inside(corner: usize, face: Face) -> bool {
    corner >> (face / 2) & 1 == face & 1
}

/// Adds triangles between the contour's vertices `first..=last` and the side that joins those two.
const fn fill(contour: &Loop, first: usize, last: usize, case: Case) -> Option<Case> {
    if last - first < 2 {
        return Some(case);
    }
    let mut apex = first + 1;
    while apex < last {
        if side(contour, first, apex) && side(contour, apex, last) {
            let mut with = case;
            with.triangles[with.count as usize] =
                [contour.vertices[first], contour.vertices[apex], contour.vertices[last]];
            with.count += 1;
            if let Some(left) = fill(contour, first, apex, with)
                && let Some(both) = fill(contour, apex, last, left)
            {
                return Some(both);
            }
        }
        apex += 1;
    }
    None
}

/// Whether a triangle may have this side: a piece of the contour, or a diagonal that lies in no
/// cell face (the cell beyond that face could have the same one, and four triangles would share it).
const fn side(contour: &Loop, i: usize, j: usize) -> bool {
    j - i == 1 || !share_face(contour.vertices[i], contour.vertices[j])
}

/// Whether two vertices lie in one face of the cell.
const fn share_face(a: CellVertex, b: CellVertex) -> bool {
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
