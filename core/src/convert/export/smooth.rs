//! Laplacian smoothing of the surface's vertices: two iterations in closed form, over a window of four
//! layers.
//!
//! A vertex p, in half voxels, moves to p/2 + sum/8 over its four neighbours. Each neighbour is at
//! p + d - n, p + 2 d or p + d + n ([`SurfaceTurn`]; d the direction, n the face's normal), so one
//! iteration gives 8 p + D in sixteenths of a voxel, where D is the sum of those four steps, and
//! two give 64 p + 12 D + (the sum of the neighbours' D) in 1/128 voxel. D depends on the vertex's
//! four turns alone: eight bits, its *code*. Every term is an integer, and no component of a vertex
//! moves more than half a voxel.

use super::faces::{FACE_STEPS, SurfaceTurn, TANGENTS, VoxelFace};
use crate::volume::bit_grid::BitGrid;
use crate::volume::range_maps::RowAddress;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// Vertex units along a voxel's side: positions are in 1/128 voxel.
pub(super) const VERTEX_UNITS: i32 = 128;

/// Layers in the window: a vertex's neighbours are at most one layer away, and two layers of smoothed
/// vertices bound a slab of cells.
const WINDOW_LAYERS: usize = 4;

/// The codes of four layers; layer y is at index y modulo 4. Only the codes of exposed faces are ever read,
/// so none need clearing.
pub(super) struct VertexSmoother<const N: usize> {
    codes: [[[[u8; 6]; N]; N]; WINDOW_LAYERS],
}

/// A smoothed vertex of a row of voxels.
pub(super) struct SmoothedVertex {
    /// Its voxel.
    pub(super) x: usize,
    /// The exposed face with the unsmoothed vertex as its centre.
    pub(super) face: VoxelFace,
    /// Position in 1/128 voxel; the centre of voxel (x, y, z) is at 128 (x, y, z).
    pub(super) position: [i32; 3],
}

/// The hop from a face to a neighbour of its vertex.
#[derive(Clone, Copy)]
struct NeighbourHop {
    /// Difference of the indices in the window.
    offset: i32,
    /// The index in [`NEIGHBOUR_SUMS`] of code 0 of the neighbour's face.
    first: u32,
}

/// The hops from a face, indexed by direction and turn.
type FaceHops = [[NeighbourHop; 4]; 4];

impl<const N: usize> VertexSmoother<N>
where
    Grid<N>: Size,
{
    /// Creates a smoother without codes. For static initialisers only.
    pub(super) const fn new() -> Self {
        VertexSmoother { codes: [[[[0; 6]; N]; N]; WINDOW_LAYERS] }
    }

    /// Computes the codes of the exposed faces of the voxels `among` of row (y, z).
    pub(super) fn encode_turns_of_row(
        &mut self,
        solid: &BitGrid<N>,
        (y, z): RowAddress,
        among: <Grid<N> as Size>::Row,
    ) {
        let row = solid.row(y, z) & among;
        if row.is_empty() {
            return;
        }
        let near = RowNeighbours::new(solid, (y, z));
        let codes = &mut self.codes[y % WINDOW_LAYERS][z];
        encode_turns_of_face::<0, N, _>(row, &near, codes);
        encode_turns_of_face::<1, N, _>(row, &near, codes);
        encode_turns_of_face::<2, N, _>(row, &near, codes);
        encode_turns_of_face::<3, N, _>(row, &near, codes);
        encode_turns_of_face::<4, N, _>(row, &near, codes);
        encode_turns_of_face::<5, N, _>(row, &near, codes);
    }

    /// Visits the smoothed vertices of the voxels `among` of row (y, z), on the exposed ones of `faces`. The
    /// codes of the layers y - 1 to y + 1 around those voxels must be in the window.
    #[inline(always)]
    pub(super) fn visit_vertices(
        &self,
        solid: &BitGrid<N>,
        (y, z): RowAddress,
        among: <Grid<N> as Size>::Row,
        faces: &[VoxelFace],
        mut visit: impl FnMut(SmoothedVertex),
    ) {
        let row = solid.row(y, z) & among;
        if row.is_empty() {
            return;
        }
        let near = RowNeighbours::new(solid, (y, z));
        let exposed = near.exposed_by_face(row);
        let codes = self.codes.as_flattened().as_flattened().as_flattened();
        let start = (y % WINDOW_LAYERS * N + z) * N * 6;
        let [y_units, z_units] = [y as i32 * VERTEX_UNITS, z as i32 * VERTEX_UNITS];
        for &face in faces {
            let hops = &Self::HOPS[y % WINDOW_LAYERS][face];
            visit_ones(exposed[face], |x| {
                let [dx, dy, dz] = smoothed_offset_from_centre(codes, start + x * 6, face, hops);
                let position = [x as i32 * VERTEX_UNITS + dx, y_units + dy, z_units + dz];
                visit(SmoothedVertex { x, face, position });
            });
        }
    }

    /// The hops, indexed by the layer's index in the window and by face.
    const HOPS: [[FaceHops; 6]; WINDOW_LAYERS] = {
        let mut hops = [[[[NeighbourHop { offset: 0, first: 0 }; 4]; 4]; 6]; WINDOW_LAYERS];
        let mut i = 0;
        while i < WINDOW_LAYERS * 6 * 16 {
            let (layer, face, k, turn) = (i / (6 * 16), i / 16 % 6, i / 4 % 4, i % 4);
            hops[layer][face][k][turn] =
                Self::neighbour_hop(layer, face, TANGENTS[face][k], decode_turn(turn));
            i += 1;
        }
        hops
    };

    const fn neighbour_hop(
        window_layer: usize,
        normal: VoxelFace,
        along: VoxelFace,
        turn: SurfaceTurn,
    ) -> NeighbourHop {
        let ([dx, dy, dz], face) = match turn {
            SurfaceTurn::Convex => ([0; 3], along),
            SurfaceTurn::Straight => (FACE_STEPS[along], normal),
            SurfaceTurn::Concave => (add_steps(FACE_STEPS[along], FACE_STEPS[normal]), along ^ 1),
        };
        let to = (window_layer as i32 + dy).rem_euclid(WINDOW_LAYERS as i32);
        let offset =
            (((to - window_layer as i32) * N as i32 + dz) * N as i32 + dx) * 6 + face as i32;
        NeighbourHop { offset, first: (face << 8) as u32 }
    }
}

/// Returns the vector from a voxel's centre to the smoothed vertex of one of its exposed faces, in 1/128
/// voxel. `first_code` is the index of the code of the voxel's face 0.
#[inline(always)]
fn smoothed_offset_from_centre(
    codes: &[u8],
    first_code: usize,
    face: VoxelFace,
    hops: &FaceHops,
) -> [i32; 3] {
    let code = codes[first_code + face];
    let first = NEIGHBOUR_SUMS[(face << 8 | code as usize) % NEIGHBOUR_SUMS.len()];
    let mut sum = FACE_CENTRE[face].wrapping_add(first.wrapping_mul(12));
    for (k, hops) in hops.iter().enumerate() {
        let hop = hops[(code >> (2 * k) & 3) as usize];
        let neighbour = codes[first_code.wrapping_add_signed(hop.offset as isize)];
        sum = sum.wrapping_add(
            NEIGHBOUR_SUMS[(hop.first as usize | neighbour as usize) % NEIGHBOUR_SUMS.len()],
        );
    }
    unpack_biased_10_10_10(sum)
}

/// Calls `visit` with the set bits of a row, lowest first.
#[inline(always)]
fn visit_ones<R: BitSet>(row: R, mut visit: impl FnMut(usize)) {
    for w in 0..R::WORDS {
        let mut left = row.word(w);
        while left != 0 {
            visit(w * 64 + left.trailing_zeros() as usize);
            left &= left - 1;
        }
    }
}

/// A row and its eight neighbours; everything outside the grid is empty.
struct RowNeighbours<R> {
    /// The rows at z - 1, z, z + 1 for each of y - 1, y, y + 1.
    rows: [[R; 3]; 3],
}

impl<R: BitSet> RowNeighbours<R> {
    #[inline(always)]
    fn new<const N: usize>(solid: &BitGrid<N>, (y, z): RowAddress) -> Self
    where
        Grid<N>: Size<Row = R>,
    {
        let mut rows = [[R::EMPTY; 3]; 3];
        for (dy, rows) in rows.iter_mut().enumerate() {
            let y = (y + dy).wrapping_sub(1);
            if y < N {
                let layer = solid.layer(y);
                rows[1] = layer[z];
                if z > 0 {
                    rows[0] = layer[z - 1];
                }
                if z + 1 < N {
                    rows[2] = layer[z + 1];
                }
            }
        }
        RowNeighbours { rows }
    }

    /// Returns a row with, at each x of the middle row, the voxel displaced by `step`, whose components are
    /// -1 to 1.
    #[inline(always)]
    fn row_towards(&self, step: [i32; 3]) -> R {
        let row = self.rows[(step[1] + 1) as usize][(step[2] + 1) as usize];
        match step[0] {
            1 => row.shifted_down(),
            -1 => row.shifted_up(),
            _ => row,
        }
    }

    /// Returns, for each face, the `voxels` of the middle row on which it is exposed.
    #[inline(always)]
    fn exposed_by_face(&self, voxels: R) -> [R; 6] {
        let [[_, below, _], [behind, here, before], [_, above, _]] = self.rows;
        [
            voxels & !here.shifted_down(),
            voxels & !here.shifted_up(),
            voxels & !above,
            voxels & !below,
            voxels & !before,
            voxels & !behind,
        ]
    }
}

#[inline(always)]
fn encode_turns_of_face<const FACE: VoxelFace, const N: usize, R: BitSet>(
    row: R,
    near: &RowNeighbours<R>,
    codes: &mut [[u8; 6]; N],
) {
    let exposed = row & !near.row_towards(FACE_STEPS[FACE]);
    if exposed.is_empty() {
        return;
    }
    // Plain loops, as the compiler doesn't inline `array::map` here.
    let mut turns = [[R::EMPTY; 2]; 4];
    for (turn, along) in turns.iter_mut().zip(TANGENTS[FACE]) {
        *turn = [
            near.row_towards(FACE_STEPS[along]),
            near.row_towards(add_steps(FACE_STEPS[along], FACE_STEPS[FACE])),
        ];
    }
    visit_ones(exposed, |x| {
        let (w, bit) = (x / 64, x % 64);
        let mut code = 0;
        for (k, [beside, above]) in turns.iter().enumerate() {
            let turn = (beside.word(w) >> bit & 1) | (above.word(w) >> bit & 1) << 1;
            code |= turn << (2 * k);
        }
        codes[x][FACE] = code as u8;
    });
}

/// The sum of a vertex's four steps to its neighbours, packed: face f with code c at `f << 8 | c`.
static NEIGHBOUR_SUMS: [u32; 8 << 8] = {
    let mut first = [0; 8 << 8];
    let mut i = 0;
    while i < 6 << 8 {
        let (normal, code) = (i >> 8, i & 0xff);
        let mut sum = [0; 3];
        let mut k = 0;
        while k < 4 {
            sum = add_steps(
                sum,
                neighbour_step_half_voxels(
                    normal,
                    TANGENTS[normal][k],
                    decode_turn(code >> (2 * k) & 3),
                ),
            );
            k += 1;
        }
        first[i] = pack_borrowing_10_10_10(sum);
        i += 1;
    }
    first
};

/// The vector from a voxel's centre to a face's centre in 1/128 voxel, packed, with the bias of 512 added to
/// each component.
static FACE_CENTRE: [u32; 6] = {
    let mut centres = [0; 6];
    let mut face = 0;
    while face < 6 {
        let [x, y, z] = FACE_STEPS[face];
        centres[face] = pack_borrowing_10_10_10([
            512 + VERTEX_UNITS / 2 * x,
            512 + VERTEX_UNITS / 2 * y,
            512 + VERTEX_UNITS / 2 * z,
        ]);
        face += 1;
    }
    centres
};

/// Returns the step to a neighbouring vertex, in half voxels.
const fn neighbour_step_half_voxels(
    normal: VoxelFace,
    along: VoxelFace,
    turn: SurfaceTurn,
) -> [i32; 3] {
    let onward = match turn {
        SurfaceTurn::Convex => FACE_STEPS[normal ^ 1],
        SurfaceTurn::Straight => FACE_STEPS[along],
        SurfaceTurn::Concave => FACE_STEPS[normal],
    };
    add_steps(FACE_STEPS[along], onward)
}

const fn decode_turn(turn_bits: usize) -> SurfaceTurn {
    SurfaceTurn::from_neighbours(turn_bits & 1 == 1, turn_bits & 2 == 2)
}

const fn add_steps(a: [i32; 3], b: [i32; 3]) -> [i32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Packs three small integers into ten bits each of a word, so that adding words adds vectors (SIMD
/// within a register). Negative components borrow from the next field; a bias of 512 in each field,
/// added once, corrects that.
const fn pack_borrowing_10_10_10([x, y, z]: [i32; 3]) -> u32 {
    (x as u32).wrapping_add((y as u32) << 10).wrapping_add((z as u32) << 20)
}

/// The inverse of [`pack_borrowing_10_10_10`], for a sum with the bias.
#[inline]
const fn unpack_biased_10_10_10(packed_sum: u32) -> [i32; 3] {
    let sum = packed_sum;
    [(sum & 1023) as i32 - 512, (sum >> 10 & 1023) as i32 - 512, (sum >> 20 & 1023) as i32 - 512]
}
