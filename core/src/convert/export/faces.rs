//! Voxel faces and surface adjacency: a vertex of the surface is the centre of an exposed voxel face,
//! and has one neighbour in each of the four directions along that face.

/// A face of a voxel, or the direction of its outward normal: +x, -x, +y, -y, +z, -z. Bit 0 is the sign; the
/// other bits are the axis.
pub(super) type VoxelFace = usize;

/// The voxel step of each direction.
pub(super) const FACE_STEPS: [[i32; 3]; 6] =
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

/// The four directions along each face, in the order of the bits of a vertex's code.
pub(super) const TANGENTS: [[VoxelFace; 4]; 6] =
    [[2, 3, 4, 5], [2, 3, 4, 5], [4, 5, 0, 1], [4, 5, 0, 1], [0, 1, 2, 3], [0, 1, 2, 3]];

/// The continuation of the surface from a face in a direction along it. Two solid voxels that share only an
/// edge are separate.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum SurfaceTurn {
    /// Around the voxel's own edge.
    Convex,
    /// To the same face of the voxel beside it.
    Straight,
    /// To the facing side of the voxel diagonally above.
    Concave,
}

impl SurfaceTurn {
    /// Returns the turn, given the voxel beside the face in the direction along it, and the voxel diagonally
    /// above.
    pub(super) const fn from_neighbours(is_beside_solid: bool, is_diagonal_solid: bool) -> Self {
        match (is_beside_solid, is_diagonal_solid) {
            (false, _) => SurfaceTurn::Convex,
            (true, false) => SurfaceTurn::Straight,
            (true, true) => SurfaceTurn::Concave,
        }
    }
}

/// Returns the cross product of two perpendicular directions.
pub(super) const fn cross_direction(a: VoxelFace, b: VoxelFace) -> VoxelFace {
    let axis = 3 - a / 2 - b / 2;
    let odd = (b / 2 + 3 - a / 2) % 3 == 2;
    2 * axis + ((a ^ b) & 1 ^ odd as usize)
}
