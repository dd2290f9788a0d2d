//! Two Laplacian iterations of the surface's vertices in closed form, from a window of four layers.
//!
//! A vertex p, in half voxels, moves to p/2 + sum/8 over its four neighbours. Each neighbour is at
//! p + d - n, p + 2 d or p + d + n ([`Turn`]; d the direction, n the face's normal), so one
//! iteration gives 8 p + D in sixteenths of a voxel, where D is the sum of those four steps, and
//! two give 64 p + 12 D + (the sum of the neighbours' D) in 1/128 voxel. D depends on the vertex's
//! four turns alone: eight bits, its *code*. Every term is an integer, and no component of a vertex
//! moves more than half a voxel.

use super::faces::{Face, STEP, TANGENTS, Turn};
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};

/// Units of a vertex position in one voxel.
pub(super) const UNITS: i32 = 128;

/// Layers in the window: a vertex's neighbours lie at most one layer away, and two layers of
/// smoothed vertices bound a slab of cells.
const LAYERS: usize = 4;

/// The codes of four layers, layer y at place y modulo 4. Only those of exposed faces are ever
/// read, so none need clearing.
pub(super) struct Smooth<const N: usize> {
    codes: [[[[u8; 6]; N]; N]; LAYERS],
}

/// The way from a face to its neighbour.
#[derive(Clone, Copy)]
struct Hop {
    /// Distance in the window.
    offset: i32,
    /// Where the codes of the face arrived at begin in [`FIRST`].
    first: u32,
}

/// The ways from a face by direction and turn.
type Hops = [[Hop; 4]; 4];

impl<const N: usize> Smooth<N>
where
    Grid<N>: Size,
{
    /// No code. For static initialisers only.
    pub(super) const fn new() -> Self {
        Smooth { codes: [[[[0; 6]; N]; N]; LAYERS] }
    }

    /// Works out the codes of the exposed faces of the voxels `among` of row (y, z).
    pub(super) fn encode(
        &mut self,
        solid: &Plane<N>,
        (y, z): (usize, usize),
        among: <Grid<N> as Size>::Row,
    ) {
        let row = solid.row(y, z) & among;
        if row.is_empty() {
            return;
        }
        let near = Near::new(solid, (y, z));
        let codes = &mut self.codes[y % LAYERS][z];
        encode_face::<0, N, _>(row, &near, codes);
        encode_face::<1, N, _>(row, &near, codes);
        encode_face::<2, N, _>(row, &near, codes);
        encode_face::<3, N, _>(row, &near, codes);
        encode_face::<4, N, _>(row, &near, codes);
        encode_face::<5, N, _>(row, &near, codes);
    }

    /// Hands over the smoothed vertices of the voxels `among` of row (y, z), of those `faces` that
    /// are exposed: voxel x, face, and position in 1/128 voxel, where the centre of voxel (x, y, z)
    /// is at 128 (x, y, z). The codes of the layers y - 1 to y + 1 around those voxels must be in
    /// the window.
    #[inline(always)]
    pub(super) fn vertices(
        &self,
        solid: &Plane<N>,
        (y, z): (usize, usize),
        among: <Grid<N> as Size>::Row,
        faces: &[Face],
        mut each: impl FnMut(usize, Face, [i32; 3]),
    ) {
        let row = solid.row(y, z) & among;
        if row.is_empty() {
            return;
        }
        let near = Near::new(solid, (y, z));
        let exposed = near.exposed(row);
        let codes = self.codes.as_flattened().as_flattened().as_flattened();
        let start = (y % LAYERS * N + z) * N * 6;
        let [y_units, z_units] = [y as i32 * UNITS, z as i32 * UNITS];
        for &face in faces {
            let hops = &Self::HOPS[y % LAYERS][face];
            each_one(exposed[face], |x| {
                let [dx, dy, dz] = displacement(codes, start + x * 6, face, hops);
                each(x, face, [x as i32 * UNITS + dx, y_units + dy, z_units + dz]);
            });
        }
    }

    /// By the place of the layer in the window, and by face.
    const HOPS: [[Hops; 6]; LAYERS] = {
        let mut hops = [[[[Hop { offset: 0, first: 0 }; 4]; 4]; 6]; LAYERS];
        let mut i = 0;
        while i < LAYERS * 6 * 16 {
            let (layer, face, k, turn) = (i / (6 * 16), i / 16 % 6, i / 4 % 4, i % 4);
            hops[layer][face][k][turn] = Self::hop(layer, face, TANGENTS[face][k], decode(turn));
            i += 1;
        }
        hops
    };

    const fn hop(layer: usize, normal: Face, along: Face, turn: Turn) -> Hop {
        let ([dx, dy, dz], face) = match turn {
            Turn::Convex => ([0; 3], along),
            Turn::Straight => (STEP[along], normal),
            Turn::Concave => (add(STEP[along], STEP[normal]), along ^ 1),
        };
        let to = (layer as i32 + dy).rem_euclid(LAYERS as i32);
        let offset = (((to - layer as i32) * N as i32 + dz) * N as i32 + dx) * 6 + face as i32;
        Hop { offset, first: (face << 8) as u32 }
    }
}

/// From a voxel's centre to the smoothed vertex of one of its exposed faces, in 1/128 voxel;
/// `voxel` is where its codes begin.
#[inline(always)]
fn displacement(codes: &[u8], voxel: usize, face: Face, hops: &Hops) -> [i32; 3] {
    let code = codes[voxel + face];
    let first = FIRST[(face << 8 | code as usize) % FIRST.len()];
    let mut sum = FACE_CENTRE[face].wrapping_add(first.wrapping_mul(12));
    for (k, hops) in hops.iter().enumerate() {
        let hop = hops[(code >> (2 * k) & 3) as usize];
        let neighbour = codes[voxel.wrapping_add_signed(hop.offset as isize)];
        sum = sum.wrapping_add(FIRST[(hop.first as usize | neighbour as usize) % FIRST.len()]);
    }
    unpack(sum)
}

/// Calls `each` with the set bits of a row, lowest first.
#[inline(always)]
fn each_one<R: Bits>(row: R, mut each: impl FnMut(usize)) {
    for w in 0..R::WORDS {
        let mut left = row.word(w);
        while left != 0 {
            each(w * 64 + left.trailing_zeros() as usize);
            left &= left - 1;
        }
    }
}

/// The rows around a row; outside the grid all is empty.
struct Near<R> {
    /// By z - 1, z, z + 1 within y - 1, y, y + 1.
    rows: [[R; 3]; 3],
}

impl<R: Bits> Near<R> {
    #[inline(always)]
    fn new<const N: usize>(solid: &Plane<N>, (y, z): (usize, usize)) -> Self
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
        Near { rows }
    }

    /// For each x of the middle row, the voxel that many steps away.
    #[inline(always)]
    fn towards(&self, step: [i32; 3]) -> R {
        let row = self.rows[(step[1] + 1) as usize][(step[2] + 1) as usize];
        match step[0] {
            1 => row.down(),
            -1 => row.up(),
            _ => row,
        }
    }

    /// By face, the voxels of the middle row that show it.
    #[inline(always)]
    fn exposed(&self, row: R) -> [R; 6] {
        let [[_, below, _], [behind, here, before], [_, above, _]] = self.rows;
        [
            row & !here.down(),
            row & !here.up(),
            row & !above,
            row & !below,
            row & !before,
            row & !behind,
        ]
    }
}

#[inline(always)]
fn encode_face<const FACE: Face, const N: usize, R: Bits>(
    row: R,
    near: &Near<R>,
    codes: &mut [[u8; 6]; N],
) {
    let exposed = row & !near.towards(STEP[FACE]);
    if exposed.is_empty() {
        return;
    }
    // Plain loops: `array::map` leaves calls behind in this place.
    let mut turns = [[R::EMPTY; 2]; 4];
    for (turn, along) in turns.iter_mut().zip(TANGENTS[FACE]) {
        *turn = [near.towards(STEP[along]), near.towards(add(STEP[along], STEP[FACE]))];
    }
    each_one(exposed, |x| {
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
static FIRST: [u32; 8 << 8] = {
    let mut first = [0; 8 << 8];
    let mut i = 0;
    while i < 6 << 8 {
        let (normal, code) = (i >> 8, i & 0xff);
        let mut sum = [0; 3];
        let mut k = 0;
        while k < 4 {
            sum = add(sum, neighbour(normal, TANGENTS[normal][k], decode(code >> (2 * k) & 3)));
            k += 1;
        }
        first[i] = pack(sum);
        i += 1;
    }
    first
};

/// The face's centre seen from its voxel's in 1/128 voxel, packed, with 512 added to each component.
static FACE_CENTRE: [u32; 6] = {
    let mut centres = [0; 6];
    let mut face = 0;
    while face < 6 {
        let [x, y, z] = STEP[face];
        centres[face] = pack([512 + UNITS / 2 * x, 512 + UNITS / 2 * y, 512 + UNITS / 2 * z]);
        face += 1;
    }
    centres
};

/// The step to a neighbour in half voxels.
const fn neighbour(normal: Face, along: Face, turn: Turn) -> [i32; 3] {
    let onward = match turn {
        Turn::Convex => STEP[normal ^ 1],
        Turn::Straight => STEP[along],
        Turn::Concave => STEP[normal],
    };
    add(STEP[along], onward)
}

const fn decode(turn: usize) -> Turn {
    Turn::new(turn & 1 == 1, turn & 2 == 2)
}

const fn add(a: [i32; 3], b: [i32; 3]) -> [i32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Three small integers in ten bits each of a word, added at once by adding the words: negative
/// ones borrow from the field above, which a bias of 512 in each field sets right in the end.
const fn pack([x, y, z]: [i32; 3]) -> u32 {
    (x as u32).wrapping_add((y as u32) << 10).wrapping_add((z as u32) << 20)
}

#[inline]
const fn unpack(sum: u32) -> [i32; 3] {
    [(sum & 1023) as i32 - 512, (sum >> 10 & 1023) as i32 - 512, (sum >> 20 & 1023) as i32 - 512]
}
