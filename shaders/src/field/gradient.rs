//! The direction out of the stone: the negative gradient of the density at level 1. A wide kernel serves
//! smooth surfaces, where it hides the terraces of the voxels; a narrow kernel serves features, where it
//! keeps grooves.
//!
//! Both are separable (Farid and Simoncelli 2004): a mean along each axis, but a derivative along the
//! gradient's own. The filters compute in 16-bit integers, eight texels at a time. The fourth component is
//! the surface's convexity.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::backlog::{BoxBacklog, CHUNK, MAX_MERGED_TEXELS};
use super::convexity::{at_least, at_most, convexity_bytes};
use super::extent::TexelBox;
use super::rows::MAX_BOX;
use super::texels::TexelCube;
use super::textures::slab_extents;

/// Radius of the texels that a gradient depends on, along each axis.
pub(super) const GRADIENT_REACH: usize = 2;
/// Mip level of the density whose gradients are computed.
pub(super) const GRADIENT_LEVEL: usize = 1;
/// Bytes of the largest box that is handed out at once.
pub(super) const MAX_GRADIENT_BYTES: usize = size_of::<GradientTexel>() * MAX_MERGED_TEXELS;
/// A texel: x, y, z as signed bytes, 127 for a density that falls by 254 in two texels; the fourth is the
/// surface's convexity, see [`convexity_bytes`].
pub(super) type GradientTexel = [u8; 4];

/// The most frames that stale gradients wait for the density, one box of which may take a whole frame.
const MAX_FRAMES_WAITED: u32 = 8;
/// Texels that are computed at once: 16-bit lanes of a vector register.
pub(super) const LANES: usize = 8;
const GROUPS: usize = MAX_BOX[0] / LANES;
/// Texels along each axis of the largest box, with those that its gradients depend on.
const WINDOW: [usize; 3] = [
    MAX_BOX[0] + 2 * GRADIENT_REACH,
    MAX_BOX[1] + 2 * GRADIENT_REACH,
    MAX_BOX[2] + 2 * GRADIENT_REACH,
];

/// Both kernels' sums for a derivative of 1: 2048 less three dropped bits (wide), 512 less one (narrow).
const UNIT: f32 = 256.0;
/// Squared cosines of the angle between the wide and the narrow gradient where the wide one begins to give
/// way (5 degrees, beyond the noise of the narrow one on a smooth surface), and where it has (10 degrees).
const SMOOTH_COS_2: f32 = 0.992_404;
const FEATURE_COS_2: f32 = 0.969_846;
/// Extrapolation at features, beyond the narrow gradient and away from the wide one: the narrow kernel is
/// still wider than a groove of two voxels.
const SHARPENING: f32 = 1.5;

type Lanes = [i16; LANES];
type Row<const KERNELS: usize> = [[Lanes; GROUPS]; KERNELS];

/// The gradients at every texel of level 1, and the boxes of stale ones.
#[derive(Debug)]
pub(super) struct Gradients {
    side: usize,
    texels: Vec<GradientTexel>,
    pub(super) stale: BoxBacklog,
    /// Frames since a box was recomputed, while some were stale.
    frames_waited: u32,
    buffers: Box<Buffers>,
}

/// Intermediate results between the passes.
#[derive(Debug)]
struct Buffers {
    /// Rows of the window after the kernels along x: wide and narrow mean, wide and narrow derivative.
    along_x: [[Row<4>; WINDOW[1]]; WINDOW[2]],
    /// Rows after the kernels along x and y: wide mean, derivative along x and along y; then the same three
    /// narrow.
    along_y: [[Row<6>; MAX_BOX[1]]; WINDOW[2]],
    /// The value of each uniform row of the window; `None` for a mixed row.
    uniform: [[Option<u8>; WINDOW[1]]; WINDOW[2]],
}

impl Buffers {
    fn new() -> Box<Self> {
        Box::new(Buffers {
            along_x: [[[[[0; LANES]; GROUPS]; 4]; WINDOW[1]]; WINDOW[2]],
            along_y: [[[[[0; LANES]; GROUPS]; 6]; MAX_BOX[1]]; WINDOW[2]],
            uniform: [[None; WINDOW[1]]; WINDOW[2]],
        })
    }
}

impl Gradients {
    /// Creates the gradients of the empty volume, `side` texels a side.
    pub(super) fn new(side: usize) -> Self {
        let texels = vec![[0; 4]; side.pow(3)];
        Gradients {
            side,
            texels,
            stale: BoxBacklog::new(side),
            frames_waited: 0,
            buffers: Buffers::new(),
        }
    }

    pub(super) const fn side(&self) -> usize {
        self.side
    }

    pub(super) fn bytes(&self) -> &[u8] {
        self.texels.as_flattened()
    }

    pub(super) fn texel(&self, [x, y, z]: [usize; 3]) -> [i8; 4] {
        self.texels[(z * self.side + y) * self.side + x].map(|c| c as i8)
    }

    /// Returns the bytes of a row's texels in a box.
    pub(super) fn row_bytes(&self, y: usize, z: usize, extent: &TexelBox) -> &[u8] {
        let row = &self.texels[(z * self.side + y) * self.side..][..self.side];
        row[extent.lo[0]..extent.hi[0]].as_flattened()
    }

    /// Marks the gradients stale that depend on a box of texels of the density.
    pub(super) fn mark_stale_around(&mut self, changed: &TexelBox) {
        self.stale.mark_texels(&changed.grown_by(GRADIENT_REACH, self.side));
    }

    /// Returns `true` if stale gradients have waited so long that they come before new texels of the
    /// density, which could otherwise starve them.
    pub(super) const fn waits_long(&self) -> bool {
        self.frames_waited >= MAX_FRAMES_WAITED
    }

    /// Notes the end of a frame.
    pub(super) const fn count_frame(&mut self) {
        let waits = !self.stale.is_empty();
        self.frames_waited = if waits { self.frames_waited.saturating_add(1) } else { 0 };
    }

    /// Recomputes all gradients, on all cores.
    pub(super) fn rebuild_from(&mut self, density: &TexelCube) {
        let side = self.side;
        let slabs = self.texels.par_chunks_mut(CHUNK[2] * side * side).enumerate();
        slabs.for_each_init(Buffers::new, |buffers, (slab, texels)| {
            for extent in slab_extents(side, slab) {
                compute_box(density, extent, buffers, |y, z, row| {
                    let at = ((z - slab * CHUNK[2]) * side + y) * side + extent.lo[0];
                    texels[at..at + row.len()].copy_from_slice(row);
                });
            }
        });
        self.stale.clear();
    }

    /// Recomputes a box, no larger than [`MAX_BOX`].
    pub(super) fn recompute_box(&mut self, density: &TexelCube, extent: TexelBox) {
        self.frames_waited = 0;
        let (side, texels) = (self.side, &mut self.texels);
        compute_box(density, extent, &mut self.buffers, |y, z, row| {
            let at = (z * side + y) * side + extent.lo[0];
            texels[at..at + row.len()].copy_from_slice(row);
        });
    }

    /// Returns a trilinear sample at a point in texels, clamped to the edge: -1 to 1 along each axis; w is
    /// the convexity.
    pub(super) fn sample_trilinear(&self, point_in_texels: Vec3) -> Vec4 {
        let most = (self.side - 1) as f32;
        let point = (point_in_texels - Vec3::splat(0.5)).clamp(Vec3::ZERO, Vec3::splat(most));
        let [x, y, z] = point.to_array().map(|c| (c as usize).min(self.side - 2));
        let part = point - Vec3::new(x as f32, y as f32, z as f32);
        let at = |x, y, z| Vec4::from_array(self.texel([x, y, z]).map(f32::from));
        let along_x = |y: usize, z: usize| at(x, y, z).lerp(at(x + 1, y, z), part.x);
        let along_y = |z: usize| along_x(y, z).lerp(along_x(y + 1, z), part.y);
        along_y(z).lerp(along_y(z + 1), part.z) / 127.0
    }
}

/// Computes the gradients of a box, no larger than [`MAX_BOX`], and passes each row to `put` with its y and
/// z.
fn compute_box(
    density: &TexelCube,
    extent: TexelBox,
    buffers: &mut Buffers,
    mut put: impl FnMut(usize, usize, &[GradientTexel]),
) {
    let [width, height, depth] = extent.size();
    let groups = width.div_ceil(LANES);
    let (mut row, mut texels) = ([0; WINDOW[0]], [[0; 4]; MAX_BOX[0]]);
    for z in 0..depth + 2 * GRADIENT_REACH {
        for y in 0..height + 2 * GRADIENT_REACH {
            let uniform = load_row(density, &extent, [y, z], &mut row);
            buffers.uniform[z][y] = uniform;
            match uniform {
                Some(value) => filter_uniform_row_x(value, groups, &mut buffers.along_x[z][y]),
                None => filter_row_x(&row, groups, &mut buffers.along_x[z][y]),
            }
        }
        for y in 0..height {
            let rows = core::array::from_fn(|i| &buffers.along_x[z][y + i]);
            filter_rows_y(rows, groups, &mut buffers.along_y[z][y]);
        }
    }
    for (y, z) in extent.rows() {
        let (from_y, from_z) = (y - extent.lo[1], z - extent.lo[2]);
        let mut around = buffers.uniform[from_z..from_z + 5].iter();
        let first = buffers.uniform[from_z][from_y];
        let is_uniform =
            |rows: &[Option<u8>; WINDOW[1]]| rows[from_y..][..5].iter().all(|one| *one == first);
        if first.is_some() && around.all(is_uniform) {
            texels[..width].fill([0; 4]);
        } else {
            let rows = core::array::from_fn(|i| &buffers.along_y[from_z + i][from_y]);
            let out = texels.as_chunks_mut::<LANES>().0[..groups].iter_mut();
            out.enumerate().for_each(|(g, out)| {
                *out = blend_gradients(filter_group_z(rows, g), filter_means_z(rows, g));
            });
        }
        put(y, z, &texels[..width]);
    }
}

/// Loads a row of the window around a box, from [`GRADIENT_REACH`] texels before the box on, clamped to the
/// edge. Returns the row's value if it is uniform.
fn load_row(
    density: &TexelCube,
    extent: &TexelBox,
    [window_y, window_z]: [usize; 2],
    row: &mut [i16; WINDOW[0]],
) -> Option<u8> {
    let last = density.side() - 1;
    let clamped = |c: usize| c.saturating_sub(GRADIENT_REACH).min(last);
    let texels = density.row(clamped(extent.lo[1] + window_y), clamped(extent.lo[2] + window_z));
    let (lo, hi) = (extent.lo[0], extent.hi[0]);
    let inner = &texels[lo.saturating_sub(GRADIENT_REACH)..(hi + GRADIENT_REACH).min(last + 1)];
    let first = inner[0];
    let before = GRADIENT_REACH.saturating_sub(lo);
    let (edge, rest) = row.split_at_mut(before);
    edge.fill(first.into());
    for (texel, byte) in rest.iter_mut().zip(inner) {
        *texel = i16::from(*byte);
    }
    let end = hi - lo + 2 * GRADIENT_REACH - before;
    rest[inner.len()..end].fill(inner[inner.len() - 1].into());
    let differs = inner.iter().fold(0, |all, byte| all | (byte ^ first));
    (differs == 0).then_some(first)
}

/// Returns 16 times the wide mean of five; at most 4096 times 16.
#[inline]
fn wide_mean([a, b, c, d, e]: [&Lanes; 5]) -> Lanes {
    let mut sums = [0; LANES];
    for (i, sum) in sums.iter_mut().enumerate() {
        let inner = b[i].wrapping_add(d[i]).wrapping_add(c[i]).wrapping_mul(4);
        *sum = a[i].wrapping_add(e[i]).wrapping_add(c[i].wrapping_mul(2)).wrapping_add(inner);
    }
    sums
}

/// Returns 8 times the wide derivative of five.
#[inline]
fn wide_derivative([a, b, _, d, e]: [&Lanes; 5]) -> Lanes {
    let mut sums = [0; LANES];
    for (i, sum) in sums.iter_mut().enumerate() {
        let inner = d[i].wrapping_sub(b[i]);
        *sum = e[i].wrapping_sub(a[i]).wrapping_add(inner).wrapping_add(inner);
    }
    sums
}

/// Returns 16 times the narrow mean; at most 4096 times 16.
#[inline]
fn narrow_mean([_, b, c, d, _]: [&Lanes; 5]) -> Lanes {
    let mut sums = [0; LANES];
    for (i, sum) in sums.iter_mut().enumerate() {
        *sum = b[i].wrapping_add(d[i]).wrapping_add(c[i].wrapping_mul(14));
    }
    sums
}

/// Returns twice the narrow derivative.
#[inline]
fn narrow_derivative([_, b, _, d, _]: [&Lanes; 5]) -> Lanes {
    let mut sums = [0; LANES];
    for (i, sum) in sums.iter_mut().enumerate() {
        *sum = d[i].wrapping_sub(b[i]);
    }
    sums
}

/// Drops the lowest `bits` bits of unsigned sums, which use all 16 bits.
#[inline]
fn drop_bits_of_means(sums: Lanes, bits: u32) -> Lanes {
    sums.map(|sum| (sum as u16 >> bits) as i16)
}

/// Drops the lowest `bits` bits of signed sums, rounded half up.
#[inline]
fn drop_bits(sums: Lanes, bits: u32) -> Lanes {
    sums.map(|sum| sum.wrapping_add(1 << (bits - 1)) >> bits)
}

fn filter_row_x(
    row: &[i16; WINDOW[0]],
    groups: usize,
    [mean, narrow, slope, narrow_slope]: &mut Row<4>,
) {
    for g in 0..groups {
        let at = |by: usize| -> Lanes { core::array::from_fn(|i| row[g * LANES + by + i]) };
        let five = [at(0), at(1), at(2), at(3), at(4)];
        let five = five.each_ref();
        mean[g] = wide_mean(five);
        narrow[g] = narrow_mean(five);
        slope[g] = wide_derivative(five);
        narrow_slope[g] = narrow_derivative(five);
    }
}

/// Filters a row of one value, with the result of `filter_row_x`.
fn filter_uniform_row_x(
    value: u8,
    groups: usize,
    [mean, narrow, slope, narrow_slope]: &mut Row<4>,
) {
    let sum = 16 * i16::from(value);
    mean[..groups].fill([sum; LANES]);
    narrow[..groups].fill([sum; LANES]);
    slope[..groups].fill([0; LANES]);
    narrow_slope[..groups].fill([0; LANES]);
}

fn filter_rows_y(rows: [&Row<4>; 5], groups: usize, out: &mut Row<6>) {
    let [a, b, c, d, e] = rows;
    for g in 0..groups {
        let five = |kernel: usize| {
            [&a[kernel][g], &b[kernel][g], &c[kernel][g], &d[kernel][g], &e[kernel][g]]
        };
        out[0][g] = drop_bits_of_means(wide_mean(five(0)), 3);
        out[1][g] = drop_bits(wide_mean(five(2)), 3);
        out[2][g] = drop_bits(wide_derivative(five(0)), 3);
        out[3][g] = drop_bits_of_means(narrow_mean(five(1)), 1);
        out[4][g] = drop_bits(narrow_mean(five(3)), 1);
        out[5][g] = drop_bits(narrow_derivative(five(1)), 1);
    }
}

/// Returns a group's wide and narrow gradients: x, y, z of each.
#[inline]
fn filter_group_z([a, b, c, d, e]: [&Row<6>; 5], group: usize) -> [[Lanes; 3]; 2] {
    let g = group;
    let five =
        |kernel: usize| [&a[kernel][g], &b[kernel][g], &c[kernel][g], &d[kernel][g], &e[kernel][g]];
    [
        [wide_mean(five(1)), wide_mean(five(2)), wide_derivative(five(0))],
        [narrow_mean(five(4)), narrow_mean(five(5)), narrow_derivative(five(3))],
    ]
}

/// Returns 128 times a group's wide and narrow means.
#[inline]
fn filter_means_z([a, b, c, d, e]: [&Row<6>; 5], g: usize) -> [Lanes; 2] {
    let five = |kernel: usize, bits: u32| {
        [a, b, c, d, e].map(|row| drop_bits_of_means(row[kernel][g], bits))
    };
    [
        drop_bits_of_means(wide_mean(five(0, 1).each_ref()), 1),
        drop_bits_of_means(narrow_mean(five(3, 3).each_ref()), 1),
    ]
}

/// Blends the gradients: the wide one where both agree, else extrapolated beyond the narrow one, as far as
/// they differ. Returns the negative as bytes, with the convexity as the fourth.
#[inline]
fn blend_gradients([wide, narrow]: [[Lanes; 3]; 2], means: [Lanes; 2]) -> [GradientTexel; LANES] {
    let convexity = convexity_bytes(means);
    let scaled = |lanes: Lanes| lanes.map(|c| f32::from(c) * (1.0 / UNIT));
    let (w, n) = (wide.map(scaled), narrow.map(scaled));
    let mut part = [0.0; LANES];
    for (i, part) in part.iter_mut().enumerate() {
        let dot = |a: &[[f32; LANES]; 3], b: &[[f32; LANES]; 3]| {
            a[0][i] * b[0][i] + a[1][i] * b[1][i] + a[2][i] * b[2][i]
        };
        let along = at_least(dot(&w, &n), 0.0);
        let cos_2 = along * along / at_least(dot(&w, &w) * dot(&n, &n), 1e-9);
        let differs = (SMOOTH_COS_2 - cos_2) * (1.0 / (SMOOTH_COS_2 - FEATURE_COS_2));
        *part = SHARPENING * at_most(at_least(differs, 0.0), 1.0);
    }
    let mut texels = [0u32; LANES];
    for (i, texel) in texels.iter_mut().enumerate() {
        let byte = |axis: usize| {
            let outward = -(w[axis][i] + (n[axis][i] - w[axis][i]) * part[i]);
            // Adding a large float rounds the value to an integer, in the lowest bits of the sum.
            let rounded = at_most(at_least(outward, -127.0), 127.0) + 12_582_912.0;
            rounded.to_bits() & 0xff
        };
        *texel = byte(0) | byte(1) << 8 | byte(2) << 16 | convexity[i] << 24;
    }
    texels.map(u32::to_le_bytes)
}
