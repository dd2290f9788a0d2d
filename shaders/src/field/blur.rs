//! The finest density of a box of texels: blurred occupancy, with thin features raised.
//!
//! Each row of voxels is a word of bits; tables turn them into bytes blurred along x, and the rest
//! runs over whole rows, which the compiler makes vectors of.

use paros_core::maps::Maps;

use super::REACH;
use super::extent::Extent;
use super::texels::tops;
use super::thin;
use super::window::{LEFT, ROWS, Window};

/// Texels of the largest box along each axis. Along x the box, with [`LEFT`] more on either side,
/// fills a word; a multiple of 8.
/// A stroke of radius 6 changes 19 texels along y and z.
pub(super) const MOST: [usize; 3] = [56, 24, 24];

/// Rows along y and z that are blurred: those of the box and one around.
const OUT: usize = MOST[1] + 2;
const WIDTH: usize = 64;
/// What is computed at once: as many bytes as fill a vector register.
const LANES: usize = 16;
/// Voxels on either side that a texel is blurred with.
const TAPS: usize = 2;
/// A sum along x and y of voxels that are all full: 256, held to a byte.
const FULL: u8 = 255;

/// What one row holds.
type Row = [[u8; LANES]; WIDTH / LANES];

/// A box of texels and what it takes to compute them.
#[derive(Debug)]
pub(super) struct Blur {
    extent: Extent,
    window: Window,
    /// Blurred along x: 0 to 16, of one slice.
    along_x: [Row; ROWS],
    /// Blurred along x and y: 0 to 255, of the last five slices.
    along_y: [[Row; OUT]; 5],
    /// Which rows of those slices are nothing but 0 or 255.
    plain: [[Plain; OUT]; 5],
    /// The density, from one texel before the box, along x from [`LEFT`] before.
    out: [[Row; OUT]; OUT],
    /// Which of these are at least a half.
    half: [[u64; OUT]; OUT],
}

/// Whether a row is the same all along.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Plain {
    Empty,
    Full,
    Mixed,
}

impl Blur {
    pub(super) const fn new() -> Self {
        Blur {
            extent: Extent { lo: [0; 3], hi: [0; 3] },
            window: Window::new(),
            along_x: [[[0; LANES]; WIDTH / LANES]; ROWS],
            along_y: [[[[0; LANES]; WIDTH / LANES]; OUT]; 5],
            plain: [[Plain::Empty; OUT]; 5],
            out: [[[[0; LANES]; WIDTH / LANES]; OUT]; OUT],
            half: [[0; OUT]; OUT],
        }
    }

    /// A row of the box last computed.
    #[inline]
    pub(super) fn row(&self, y: usize, z: usize) -> &[u8] {
        let [x0, y0, z0] = self.extent.lo;
        &self.out[z - z0 + 1][y - y0 + 1].as_flattened()[LEFT..LEFT + self.extent.hi[0] - x0]
    }

    /// Computes the texels of a box, at most [`MOST`] and a multiple of 8 along x.
    pub(super) fn compute<const N: usize>(&mut self, maps: &Maps<N>, extent: Extent) {
        self.extent = extent;
        self.window.look(maps, extent);
        let [width, along_y, along_z] = extent.size();
        let width = width + 2 * LEFT;
        let mask = u64::MAX >> (WIDTH - width);
        let (slices, rows) = (along_z + 2 * REACH, along_y + 2 * REACH);
        let out_rows = rows - 2 * TAPS;
        for z in 0..slices {
            self.blur_slice(z, rows, width, mask);
            if z >= 2 * TAPS {
                for y in 0..out_rows {
                    self.blur_row(y, z - 2 * TAPS, width, mask);
                }
            }
        }
        thin::raise(&self.window, [out_rows, slices - 2 * TAPS], &mut self.out, &mut self.half);
    }

    /// Blurs a slice of the window along x and y.
    fn blur_slice(&mut self, z: usize, rows: usize, width: usize, mask: u64) {
        let (slot, groups) = (z % 5, width.div_ceil(LANES));
        for y in 0..rows {
            let (bits, row) = (self.window.row(y, z), &mut self.along_x[y][..groups]);
            match bits & mask {
                0 => row.fill([0; LANES]),
                all if all == mask => row.fill([16; LANES]),
                _ => blur_bits(bits, row.as_flattened_mut()),
            }
        }
        for y in 0..rows - 2 * TAPS {
            let bits = |i: usize| self.window.row(y + i, z) & mask;
            let five = [bits(0), bits(1), bits(2), bits(3), bits(4)];
            let row = &mut self.along_y[slot][y][..groups];
            self.plain[slot][y] = plain(five, mask);
            match self.plain[slot][y] {
                Plain::Empty => row.fill([0; LANES]),
                Plain::Full => row.fill([FULL; LANES]),
                Plain::Mixed => {
                    let [a, b, c, d, e] = [y, y + 1, y + 2, y + 3, y + 4];
                    let rows = &self.along_x;
                    for (g, sums) in row.iter_mut().enumerate() {
                        let five = [rows[a][g], rows[b][g], rows[c][g], rows[d][g], rows[e][g]];
                        *sums = blur_lanes(five);
                    }
                }
            }
        }
    }

    /// Blurs a row along z, from the last five slices.
    fn blur_row(&mut self, y: usize, z: usize, width: usize, mask: u64) {
        let [a, b, c, d, e] = [z % 5, (z + 1) % 5, (z + 2) % 5, (z + 3) % 5, (z + 4) % 5];
        let out = &mut self.out[z][y][..width.div_ceil(LANES)];
        let plain = |slot: usize| self.plain[slot][y];
        let kinds = [plain(a), plain(b), plain(c), plain(d), plain(e)];
        if kinds == [Plain::Empty; 5] {
            out.fill([0; LANES]);
            self.half[z][y] = 0;
            return;
        }
        if kinds == [Plain::Full; 5] {
            out.fill([255; LANES]);
            self.half[z][y] = mask;
            return;
        }
        let row = |slot: usize| &self.along_y[slot][y];
        let [a, b, c, d, e] = [row(a), row(b), row(c), row(d), row(e)];
        for (g, texels) in out.iter_mut().enumerate() {
            *texels = texels_of([a[g], b[g], c[g], d[g], e[g]]);
        }
        self.half[z][y] = tops(out.as_flattened());
    }
}

/// Blurs sixteen bytes, of 16 at most each; what comes to 256 is held to 255.
#[inline]
fn blur_lanes([a, b, c, d, e]: [[u8; LANES]; 5]) -> [u8; LANES] {
    let mut sums = [0; LANES];
    for (i, sum) in sums.iter_mut().enumerate() {
        let double = b[i] + d[i] + c[i];
        let double = double + double + c[i];
        *sum = (double + double).saturating_add(a[i] + e[i]);
    }
    sums
}

/// Blurs sixteen bytes; the mean, half up.
#[inline]
fn texels_of([a, b, c, d, e]: [[u8; LANES]; 5]) -> [u8; LANES] {
    let mut texels = [0; LANES];
    for (i, texel) in texels.iter_mut().enumerate() {
        let [a, b, c, d, e] = [a[i], b[i], c[i], d[i], e[i]].map(u16::from);
        *texel = ((a + e + 4 * (b + d) + 6 * c + 8) >> 4) as u8;
    }
    texels
}

fn plain(rows: [u64; 5], mask: u64) -> Plain {
    if rows == [0; 5] {
        Plain::Empty
    } else if rows == [mask; 5] {
        Plain::Full
    } else {
        Plain::Mixed
    }
}

/// Blurs a row of bits along x into bytes, 0 to 16; nothing lies beyond the word.
fn blur_bits(bits: u64, row: &mut [u8]) {
    for (i, eight) in row.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        // The twelve voxels that eight texels see.
        let seen = if i == 0 { bits << 2 } else { bits >> (8 * i - 2) };
        let sums = LOW[(seen & 63) as usize] + HIGH[(seen >> 6 & 63) as usize];
        *eight = sums.to_le_bytes();
    }
}

/// What the lower and the upper six of twelve voxels add to eight texels, a byte each.
static LOW: [u64; 64] = shares(0);
static HIGH: [u64; 64] = shares(6);

const fn shares(first: usize) -> [u64; 64] {
    const WEIGHTS: [u64; 5] = [1, 4, 6, 4, 1];
    let mut table = [0; 64];
    let mut bits = 0;
    while bits < 64 {
        let mut bit = 0;
        while bit < 6 {
            // Voxel v lies in texels v - 4 to v.
            let mut tap = 0;
            while bits >> bit & 1 == 1 && tap < 5 {
                let voxel = first + bit;
                if voxel >= tap && voxel - tap < 8 {
                    table[bits] += WEIGHTS[tap] << (8 * (voxel - tap));
                }
                tap += 1;
            }
            bit += 1;
        }
        bits += 1;
    }
    table
}

/// The rows of density around a box, to be raised: by z, then y.
pub(super) type Rows = [[Row; OUT]; OUT];
/// Which of these texels are at least a half.
pub(super) type Halves = [[u64; OUT]; OUT];
