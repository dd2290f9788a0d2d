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

/// The way from a face to its neighbour, by direction and turn.
#[derive(Clone, Copy)]
struct Hop {
    /// Layers up, plus one.
    layer: u8,
    /// Face of the voxel arrived at.
    face: u8,
    /// Distance in a layer of codes.
    offset: i32,
}

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
        for normal in 0..6 {
            let exposed = row & !near.towards([normal]);
            if exposed.is_empty() {
                continue;
            }
            let beside = TANGENTS[normal].map(|along| near.towards([along]));
            let above = TANGENTS[normal].map(|along| near.towards([along, normal]));
            for w in 0..<Grid<N> as Size>::Row::WORDS {
                let (beside, above) = (beside.map(|row| row.word(w)), above.map(|row| row.word(w)));
                let mut left = exposed.word(w);
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    let mut code = 0;
                    for k in 0..4 {
                        let turn = (beside[k] >> bit & 1) | (above[k] >> bit & 1) << 1;
                        code |= (turn as u8) << (2 * k);
                    }
                    codes[w * 64 + bit as usize][normal] = code;
                }
            }
        }
    }

    /// Hands over the smoothed vertices of the voxels `among` of row (y, z): voxel x, face, and
    /// position in 1/128 voxel, where the centre of voxel (x, y, z) is at 128 (x, y, z). The codes
    /// of the layers y - 1 to y + 1 around those voxels must be in the window.
    #[inline]
    pub(super) fn vertices(
        &self,
        solid: &Plane<N>,
        (y, z): (usize, usize),
        among: <Grid<N> as Size>::Row,
        mut each: impl FnMut(usize, Face, [i32; 3]),
    ) {
        let row = solid.row(y, z) & among;
        if row.is_empty() {
            return;
        }
        let near = Near::new(solid, (y, z));
        for normal in 0..6 {
            for x in (row & !near.towards([normal])).ones() {
                let [dx, dy, dz] = self.displacement([x, y, z], normal);
                let [x_units, y_units, z_units] = [x, y, z].map(|c| c as i32 * UNITS);
                each(x, normal, [x_units + dx, y_units + dy, z_units + dz]);
            }
        }
    }

    /// From a voxel's centre to the smoothed vertex of one of its exposed faces, in 1/128 voxel.
    #[inline]
    fn displacement(&self, [x, y, z]: [usize; 3], normal: Face) -> [i32; 3] {
        let codes = self.codes.as_flattened().as_flattened().as_flattened();
        let layer = |dy: usize| ((y + dy + LAYERS - 1) % LAYERS * N * N + z * N + x) * 6;
        let layers = [layer(0), layer(1), layer(2)];
        let code = codes[layers[1] + normal];
        let mut sum = FACE_CENTRE[normal].wrapping_add(FIRST[normal][code as usize].wrapping_mul(12));
        for (k, hops) in Self::HOPS[normal].iter().enumerate() {
            let hop = hops[(code >> (2 * k) & 3) as usize];
            let at = layers[hop.layer as usize].wrapping_add_signed(hop.offset as isize);
            sum = sum.wrapping_add(FIRST[hop.face as usize][codes[at] as usize]);
        }
        unpack(sum)
    }

    const HOPS: [[[Hop; 4]; 4]; 6] = {
        let mut hops = [[[Hop { layer: 0, face: 0, offset: 0 }; 4]; 4]; 6];
        let mut i = 0;
        while i < 6 * 4 * 4 {
            let (normal, k, turn) = (i / 16, i / 4 % 4, i % 4);
            hops[normal][k][turn] = Self::hop(normal, TANGENTS[normal][k], decode(turn));
            i += 1;
        }
        hops
    };

    const fn hop(normal: Face, along: Face, turn: Turn) -> Hop {
        let ([dx, dy, dz], face) = match turn {
            Turn::Convex => ([0; 3], along),
            Turn::Straight => (STEP[along], normal),
            Turn::Concave => (add(STEP[along], STEP[normal]), along ^ 1),
        };
        Hop { layer: (dy + 1) as u8, face: face as u8, offset: (dz * N as i32 + dx) * 6 + face as i32 }
    }
}

/// The rows around a row; outside the grid all is empty.
struct Near<R> {
    /// By z - 1, z, z + 1 within y - 1, y, y + 1.
    rows: [[R; 3]; 3],
}

impl<R: Bits> Near<R> {
    fn new<const N: usize>(solid: &Plane<N>, (y, z): (usize, usize)) -> Self
    where
        Grid<N>: Size<Row = R>,
    {
        let row = |dy: usize, dz: usize| {
            let (y, z) = ((y + dy).wrapping_sub(1), (z + dz).wrapping_sub(1));
            if y < N && z < N { solid.row(y, z) } else { R::EMPTY }
        };
        Near { rows: [0, 1, 2].map(|dy| [0, 1, 2].map(|dz| row(dy, dz))) }
    }

    /// For each x of the middle row, the voxel that many steps away.
    #[inline(always)]
    fn towards<const STEPS: usize>(&self, faces: [Face; STEPS]) -> R {
        let [x, y, z] = faces.iter().fold([0; 3], |sum, &face| add(sum, STEP[face]));
        let row = self.rows[(y + 1) as usize][(z + 1) as usize];
        match x {
            1 => row.down(),
            -1 => row.up(),
            _ => row,
        }
    }
}

/// The sum of a vertex's four steps to its neighbours by face and code, packed.
static FIRST: [[u32; 256]; 6] = {
    let mut first = [[0; 256]; 6];
    let mut i = 0;
    while i < 6 * 256 {
        let (normal, code) = (i / 256, i % 256);
        let mut sum = [0; 3];
        let mut k = 0;
        while k < 4 {
            sum = add(sum, neighbour(normal, TANGENTS[normal][k], decode(code >> (2 * k) & 3)));
            k += 1;
        }
        first[normal][code] = pack(sum);
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
