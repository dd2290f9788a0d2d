//! The finest density of a box of texels: blurred occupancy, with creases opened and thin features raised.
//!
//! Each row of voxels is a word of bits; tables turn them into bytes blurred along x, and the rest
//! runs over whole rows, which the compiler makes vectors of.

use paros_core::maps::Maps;

use super::REACH;
use super::crease;
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
    /// What lies in reach of those along x and y, in all slices.
    marks: [[Marks; OUT]; ROWS],
    /// The density, from one texel before the box, along x from [`LEFT`] before.
    out: [[Row; OUT]; OUT],
    /// Which of these are at least a half.
    half: [[u64; OUT]; OUT],
}

/// Which texels of a row have an occupied voxel in reach, and which an empty one.
#[derive(Clone, Copy, Default, Debug)]
struct Marks {
    full: u64,
    empty: u64,
}

/// Whether sixteen texels are all the same.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Plain {
    Empty,
    Full,
    Mixed,
}

impl Marks {
    /// What five rows of voxels have in reach together, beside the rows' ends nothing.
    fn of_voxels(rows: [u64; 5], mask: u64) -> Self {
        let full = rows.iter().fold(0, |all, row| all | row) & mask;
        let empty = !rows.iter().fold(u64::MAX, |all, row| all & row) & mask;
        let near = |bits: u64| bits | bits << 1 | bits << 2 | bits >> 1 | bits >> 2;
        Marks { full: near(full), empty: near(empty) }
    }

    fn of_slices(slices: [Marks; 5]) -> Self {
        let all = |a: Marks, b: &Marks| Marks { full: a.full | b.full, empty: a.empty | b.empty };
        slices.iter().fold(Marks::default(), all)
    }

    #[inline]
    fn group(self, group: usize) -> Plain {
        let part = |bits: u64| bits >> (LANES * group) & 0xffff;
        match (part(self.full), part(self.empty)) {
            (0, _) => Plain::Empty,
            (_, 0) => Plain::Full,
            _ => Plain::Mixed,
        }
    }

    /// Groups of the row that are mixed.
    fn mixed(self, groups: usize) -> usize {
        if self.full == 0 || self.empty == 0 {
            return 0;
        }
        (0..groups).filter(|&group| self.group(group) == Plain::Mixed).count()
    }
}

impl Blur {
    pub(super) const fn new() -> Self {
        Blur {
            extent: Extent { lo: [0; 3], hi: [0; 3] },
            window: Window::new(),
            along_x: [[[0; LANES]; WIDTH / LANES]; ROWS],
            along_y: [[[[0; LANES]; WIDTH / LANES]; OUT]; 5],
            marks: [[Marks { full: 0, empty: 0 }; OUT]; ROWS],
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

    /// Looks at the voxels around a box of texels, at most [`MOST`] and a multiple of 8 along x;
    /// how many groups of texels are to be blurred comes back.
    pub(super) fn look<const N: usize>(&mut self, maps: &Maps<N>, extent: Extent) -> usize {
        self.extent = extent;
        self.window.look(maps, extent);
        let Frame { slices, rows, groups, mask } = self.frame();
        let mut mixed = 0;
        for z in 0..slices {
            for y in 0..rows {
                let row = |i: usize| self.window.row(y + i, z);
                self.marks[z][y] = Marks::of_voxels([row(0), row(1), row(2), row(3), row(4)], mask);
                if z >= 2 * TAPS {
                    mixed += self.marks_around(y, z - 2 * TAPS).mixed(groups);
                }
            }
        }
        mixed
    }

    /// Computes the texels of the box that was looked at.
    pub(super) fn compute(&mut self) {
        let Frame { slices, rows, groups, mask } = self.frame();
        for z in 0..slices {
            self.blur_slice(z, rows, groups, mask);
            if z >= 2 * TAPS {
                for y in 0..rows {
                    self.blur_row(y, z - 2 * TAPS, groups, mask);
                }
            }
        }
        let size = [rows, slices - 2 * TAPS];
        crease::open(&self.window, size, mask, &mut self.out, &mut self.half);
        thin::raise(&self.window, size, &mut self.out, &mut self.half);
    }

    fn frame(&self) -> Frame {
        let [along_x, along_y, along_z] = self.extent.size();
        let width = along_x + 2 * LEFT;
        Frame {
            slices: along_z + 2 * REACH,
            rows: along_y + 2 * REACH - 2 * TAPS,
            groups: width.div_ceil(LANES),
            mask: u64::MAX >> (WIDTH - width),
        }
    }

    /// What is in reach of a row of texels.
    #[inline]
    fn marks_around(&self, y: usize, z: usize) -> Marks {
        let slice = |i: usize| self.marks[z + i][y];
        Marks::of_slices([slice(0), slice(1), slice(2), slice(3), slice(4)])
    }

    /// Blurs a slice of the window along x and y.
    fn blur_slice(&mut self, z: usize, rows: usize, groups: usize, mask: u64) {
        let slot = z % 5;
        for y in 0..rows + 2 * TAPS {
            let (bits, row) = (self.window.row(y, z), &mut self.along_x[y][..groups]);
            match bits & mask {
                0 => row.fill([0; LANES]),
                all if all == mask => row.fill([16; LANES]),
                _ => blur_bits(bits, row.as_flattened_mut()),
            }
        }
        for y in 0..rows {
            let marks = self.marks[z][y];
            let [a, b, c, d, e] = [y, y + 1, y + 2, y + 3, y + 4];
            let rows = &self.along_x;
            for (g, sums) in self.along_y[slot][y][..groups].iter_mut().enumerate() {
                *sums = match marks.group(g) {
                    Plain::Empty => [0; LANES],
                    Plain::Full => [FULL; LANES],
                    Plain::Mixed => {
                        blur_lanes([rows[a][g], rows[b][g], rows[c][g], rows[d][g], rows[e][g]])
                    }
                }
            }
        }
    }

    /// Blurs a row along z, from the last five slices.
    fn blur_row(&mut self, y: usize, z: usize, groups: usize, mask: u64) {
        let marks = self.marks_around(y, z);
        let out = &mut self.out[z][y][..groups];
        if marks.full == 0 || marks.empty == 0 {
            let full = marks.empty == 0;
            out.fill([if full { 255 } else { 0 }; LANES]);
            self.half[z][y] = if full { mask } else { 0 };
            return;
        }
        let row = |z: usize| &self.along_y[z % 5][y];
        let [a, b, c, d, e] = [row(z), row(z + 1), row(z + 2), row(z + 3), row(z + 4)];
        for (g, texels) in out.iter_mut().enumerate() {
            *texels = match marks.group(g) {
                Plain::Empty => [0; LANES],
                Plain::Full => [255; LANES],
                Plain::Mixed => texels_of([a[g], b[g], c[g], d[g], e[g]]),
            };
        }
        self.half[z][y] = tops(out.as_flattened());
    }
}

/// How much of the window a box takes.
struct Frame {
    slices: usize,
    /// Rows of texels in a slice, with one around.
    rows: usize,
    /// Groups of texels in a row.
    groups: usize,
    /// The voxels of a row.
    mask: u64,
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

/// The rows of density around a box: by z, then y.
pub(super) type Rows = [[Row; OUT]; OUT];
/// Which of these texels are at least a half.
pub(super) type Halves = [[u64; OUT]; OUT];
