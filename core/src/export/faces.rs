//! A vertex of the surface is the centre of a voxel's exposed face, and has one neighbour in each
//! of the four directions along that face.

/// One of a voxel's six faces, or the direction in which it looks: +x, -x, +y, -y, +z, -z. Bit 0
/// turns it round; the rest is the axis.
pub(super) type Face = usize;

/// The voxel step of each direction.
pub(super) const STEP: [[i32; 3]; 6] =
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

/// The four directions along each face.
pub(super) const TANGENTS: [[Face; 4]; 6] =
    [[2, 3, 4, 5], [2, 3, 4, 5], [4, 5, 0, 1], [4, 5, 0, 1], [0, 1, 2, 3], [0, 1, 2, 3]];

/// How the surface goes on from a face in a direction along it. Where two solid voxels meet at an
/// edge only, each is wrapped on its own.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Turn {
    /// Round the voxel's own edge.
    Convex,
    /// On to the same face of the voxel beside it.
    Straight,
    /// Up the wall of the voxel diagonally above.
    Concave,
}

impl Turn {
    /// The turn, by whether the voxel beside and the one above that are solid.
    pub(super) const fn new(beside: bool, above: bool) -> Self {
        match (beside, above) {
            (false, _) => Turn::Convex,
            (true, false) => Turn::Straight,
            (true, true) => Turn::Concave,
        }
    }
}

/// The direction of the cross product of two perpendicular ones.
pub(super) const fn cross(a: Face, b: Face) -> Face {
    let axis = 3 - a / 2 - b / 2;
    let odd = (b / 2 + 3 - a / 2) % 3 == 2;
    2 * axis + ((a ^ b) & 1 ^ odd as usize)
}
