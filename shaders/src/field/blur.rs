//! The finest density of a box of texels: separable binomial blur of the occupancy, then creases
//! reopened and thin features raised.
//!
//! Each row of voxels is a word of bits. Table look-ups blur it along x into bytes; the passes
//! along y and z run over whole rows, which the compiler vectorises.

use paros_core::RangeMaps;

use super::crease;
use super::extent::TexelBox;
use super::rows::{AtLeastHalfMasks, BLURRED_ROWS, LANES, ROW_TEXELS, TexelRow, TexelRows};
use super::sizes::REACH;
use super::texels::gather_top_bits;
use super::thin;
use super::window::{MARGIN_X, VoxelWindow, WINDOW_ROWS};

/// Radius of the kernel 1 4 6 4 1, in voxels.
const TAPS: usize = 2;
/// The weighted sum along x and y of full voxels: 256, saturated to a byte.
const FULL: u8 = 255;

/// A box of texels and the buffers to compute them in.
#[derive(Debug)]
pub(super) struct BoxBlur {
    extent: TexelBox,
    window: VoxelWindow,
    /// Groups of sixteen texels in the box that have to be blurred.
    mixed_groups: usize,
    /// One slice blurred along x, 0 to 16.
    along_x: [TexelRow; WINDOW_ROWS],
    /// The last five slices blurred along x and y, 0 to 255: a ring buffer.
    along_y: [[TexelRow; BLURRED_ROWS]; 5],
    /// Coverage of the kernel along x and y, in all slices.
    nearby: [[NearbyVoxels; BLURRED_ROWS]; WINDOW_ROWS],
    /// The density, starting one texel before the box along y and z, and [`MARGIN_X`] texels before it
    /// along x.
    out: TexelRows,
    /// Bits of the texels that are at least a half.
    at_least_half: AtLeastHalfMasks,
}

/// Bit masks over a row's texels: texels whose kernel covers an occupied voxel, and those whose kernel
/// covers an empty one.
#[derive(Clone, Copy, Default, Debug)]
struct NearbyVoxels {
    full: u64,
    empty: u64,
}

/// Coverage of the kernels of sixteen texels: only empty voxels, only full ones, or both.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Uniformity {
    Empty,
    Full,
    Mixed,
}

impl NearbyVoxels {
    /// Dilates along x the union of five rows of voxels.
    fn around_rows(voxel_rows: [u64; 5], row_bits: u64) -> Self {
        let full = voxel_rows.iter().fold(0, |all, row| all | row) & row_bits;
        let empty = !voxel_rows.iter().fold(u64::MAX, |all, row| all & row) & row_bits;
        let near = |bits: u64| bits | bits << 1 | bits << 2 | bits >> 1 | bits >> 2;
        NearbyVoxels { full: near(full), empty: near(empty) }
    }

    /// Returns the union of a row's masks in five slices.
    fn union_of_slices(slices: [NearbyVoxels; 5]) -> Self {
        let all = |a: NearbyVoxels, b: &NearbyVoxels| NearbyVoxels {
            full: a.full | b.full,
            empty: a.empty | b.empty,
        };
        slices.iter().fold(NearbyVoxels::default(), all)
    }

    #[inline]
    fn classify_sixteen(self, group_index: usize) -> Uniformity {
        let part = |bits: u64| bits >> (LANES * group_index) & 0xffff;
        match (part(self.full), part(self.empty)) {
            (0, _) => Uniformity::Empty,
            (_, 0) => Uniformity::Full,
            _ => Uniformity::Mixed,
        }
    }

    /// Counts the mixed groups among the row's first `group_count`.
    fn count_mixed_sixteens(self, group_count: usize) -> usize {
        if self.full == 0 || self.empty == 0 {
            return 0;
        }
        (0..group_count).filter(|&group| self.classify_sixteen(group) == Uniformity::Mixed).count()
    }
}

impl BoxBlur {
    pub(super) const fn new() -> Self {
        BoxBlur {
            extent: TexelBox { lo: [0; 3], hi: [0; 3] },
            window: VoxelWindow::new(),
            mixed_groups: 0,
            along_x: [[[0; LANES]; ROW_TEXELS / LANES]; WINDOW_ROWS],
            along_y: [[[[0; LANES]; ROW_TEXELS / LANES]; BLURRED_ROWS]; 5],
            nearby: [[NearbyVoxels { full: 0, empty: 0 }; BLURRED_ROWS]; WINDOW_ROWS],
            out: [[[[0; LANES]; ROW_TEXELS / LANES]; BLURRED_ROWS]; BLURRED_ROWS],
            at_least_half: [[0; BLURRED_ROWS]; BLURRED_ROWS],
        }
    }

    /// Returns a row of texels of the box last computed, by the texture's y and z.
    #[inline]
    pub(super) fn texel_row(&self, texture_y: usize, texture_z: usize) -> &[u8] {
        let [x0, y0, z0] = self.extent.lo;
        &self.out[texture_z - z0 + 1][texture_y - y0 + 1].as_flattened()
            [MARGIN_X..MARGIN_X + self.extent.hi[0] - x0]
    }

    /// Loads the voxels around a box of texels, no larger than [`MAX_BOX`](super::rows::MAX_BOX)
    /// and a multiple of 8 along x.
    pub(super) fn load_voxels<const N: usize, const K: usize>(
        &mut self,
        maps: &RangeMaps<N, K>,
        extent: TexelBox,
    ) {
        self.extent = extent;
        self.window.load_voxels(maps, extent);
        let WindowSize { slices, rows, groups, row_bits } = self.window_size();
        let mut mixed = 0;
        for z in 0..slices {
            for y in 0..rows {
                let row = |i: usize| self.window.row(y + i, z);
                self.nearby[z][y] =
                    NearbyVoxels::around_rows([row(0), row(1), row(2), row(3), row(4)], row_bits);
                if z >= 2 * TAPS {
                    mixed += self.nearby_voxels(y, z - 2 * TAPS).count_mixed_sixteens(groups);
                }
            }
        }
        self.mixed_groups = mixed;
    }

    /// Returns the number of groups of sixteen texels, in the loaded box, that have to be blurred.
    pub(super) const fn mixed_sixteen_count(&self) -> usize {
        self.mixed_groups
    }

    /// Computes the texels of the box whose voxels were loaded.
    pub(super) fn compute_texels(&mut self) {
        let size = self.window_size();
        for z in 0..size.slices {
            self.blur_slice_xy(z, &size);
            if z >= 2 * TAPS {
                for y in 0..size.rows {
                    self.blur_row_z(y, z - 2 * TAPS, &size);
                }
            }
        }
        let counts = [size.rows, size.slices - 2 * TAPS];
        crease::reopen_creases(
            &self.window,
            counts,
            size.row_bits,
            &mut self.out,
            &mut self.at_least_half,
        );
        thin::raise_thin_features(&self.window, counts, &mut self.out, &mut self.at_least_half);
    }

    fn window_size(&self) -> WindowSize {
        let [along_x, along_y, along_z] = self.extent.size();
        let width = along_x + 2 * MARGIN_X;
        WindowSize {
            slices: along_z + 2 * REACH,
            rows: along_y + 2 * REACH - 2 * TAPS,
            groups: width.div_ceil(LANES),
            row_bits: u64::MAX >> (ROW_TEXELS - width),
        }
    }

    /// Returns the coverage of the kernels of a row of texels.
    #[inline]
    fn nearby_voxels(&self, y: usize, z: usize) -> NearbyVoxels {
        let slice = |i: usize| self.nearby[z + i][y];
        NearbyVoxels::union_of_slices([slice(0), slice(1), slice(2), slice(3), slice(4)])
    }

    /// Blurs a slice of the window along x and y.
    fn blur_slice_xy(&mut self, window_z: usize, size: &WindowSize) {
        let WindowSize { rows, groups, row_bits, .. } = *size;
        let (z, slot) = (window_z, window_z % 5);
        for y in 0..rows + 2 * TAPS {
            let (bits, row) = (self.window.row(y, z), &mut self.along_x[y][..groups]);
            match bits & row_bits {
                0 => row.fill([0; LANES]),
                all if all == row_bits => row.fill([16; LANES]),
                _ => blur_row_x(bits, row.as_flattened_mut()),
            }
        }
        for y in 0..rows {
            let marks = self.nearby[z][y];
            let [a, b, c, d, e] = [y, y + 1, y + 2, y + 3, y + 4];
            let rows = &self.along_x;
            for (g, sums) in self.along_y[slot][y][..groups].iter_mut().enumerate() {
                *sums = match marks.classify_sixteen(g) {
                    Uniformity::Empty => [0; LANES],
                    Uniformity::Full => [FULL; LANES],
                    Uniformity::Mixed => {
                        blur_to_sums([rows[a][g], rows[b][g], rows[c][g], rows[d][g], rows[e][g]])
                    }
                }
            }
        }
    }

    /// Blurs a row of texels along z, from the last five slices: the density.
    fn blur_row_z(&mut self, y: usize, z: usize, size: &WindowSize) {
        let marks = self.nearby_voxels(y, z);
        let out = &mut self.out[z][y][..size.groups];
        if marks.full == 0 || marks.empty == 0 {
            let full = marks.empty == 0;
            out.fill([if full { 255 } else { 0 }; LANES]);
            self.at_least_half[z][y] = if full { size.row_bits } else { 0 };
            return;
        }
        let row = |z: usize| &self.along_y[z % 5][y];
        let [a, b, c, d, e] = [row(z), row(z + 1), row(z + 2), row(z + 3), row(z + 4)];
        for (g, texels) in out.iter_mut().enumerate() {
            *texels = match marks.classify_sixteen(g) {
                Uniformity::Empty => [0; LANES],
                Uniformity::Full => [255; LANES],
                Uniformity::Mixed => blur_to_texels([a[g], b[g], c[g], d[g], e[g]]),
            };
        }
        self.at_least_half[z][y] = gather_top_bits(out.as_flattened());
    }
}

/// The part of the window that a box takes.
struct WindowSize {
    slices: usize,
    /// Rows of texels in a slice, with one more on either side.
    rows: usize,
    /// Groups of texels in a row.
    groups: usize,
    /// Bits of the voxels in a row.
    row_bits: u64,
}

/// Applies the kernel to five rows of sixteen bytes, each at most 16; the sum saturates at 255.
#[inline]
fn blur_to_sums([a, b, c, d, e]: [[u8; LANES]; 5]) -> [u8; LANES] {
    let mut sums = [0; LANES];
    for (i, sum) in sums.iter_mut().enumerate() {
        let double = b[i] + d[i] + c[i];
        let double = double + double + c[i];
        *sum = (double + double).saturating_add(a[i] + e[i]);
    }
    sums
}

/// Applies the kernel to five rows of sixteen bytes. Returns the weighted means, rounded half up.
#[inline]
fn blur_to_texels([a, b, c, d, e]: [[u8; LANES]; 5]) -> [u8; LANES] {
    let mut texels = [0; LANES];
    for (i, texel) in texels.iter_mut().enumerate() {
        let [a, b, c, d, e] = [a[i], b[i], c[i], d[i], e[i]].map(u16::from);
        *texel = ((a + e + 4 * (b + d) + 6 * c + 8) >> 4) as u8;
    }
    texels
}

/// Blurs a row of bits along x into bytes, 0 to 16; bits beyond the word count as empty.
fn blur_row_x(voxels: u64, sums: &mut [u8]) {
    for (i, eight) in sums.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        // The twelve voxels that eight texels see.
        let seen = if i == 0 { voxels << 2 } else { voxels >> (8 * i - 2) };
        let sums = LOW[(seen & 63) as usize] + HIGH[(seen >> 6 & 63) as usize];
        *eight = sums.to_le_bytes();
    }
}

/// Look-up tables: the contribution of the lower and of the upper six of twelve voxels to eight texels, a
/// byte each.
static LOW: [u64; 64] = tap_table(0);
static HIGH: [u64; 64] = tap_table(6);

/// Builds the table, indexed by bits, of the contribution to eight texels of six voxels, from the
/// `first_voxel`th of twelve on.
const fn tap_table(first_voxel: usize) -> [u64; 64] {
    const WEIGHTS: [u64; 5] = [1, 4, 6, 4, 1];
    let mut table = [0; 64];
    let mut bits = 0;
    while bits < 64 {
        let mut bit = 0;
        while bit < 6 {
            // Voxel v lies in texels v - 4 to v.
            let mut tap = 0;
            while bits >> bit & 1 == 1 && tap < 5 {
                let voxel = first_voxel + bit;
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
