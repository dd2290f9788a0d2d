//! A 3D texture of bytes, with trilinear sampling as on a GPU.

use glam::Vec3;
use rayon::prelude::*;

use super::extent::TexelBox;

/// A cube of byte texels, x fastest, z slowest.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct TexelCube {
    side: usize,
    bytes: Vec<u8>,
}

impl TexelCube {
    pub(super) fn new(side: usize, fill: u8) -> Self {
        TexelCube { side, bytes: vec![fill; side.pow(3)] }
    }

    pub(super) const fn side(&self) -> usize {
        self.side
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(super) fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    #[inline]
    pub(super) fn texel(&self, [x, y, z]: [usize; 3]) -> u8 {
        self.row(y, z)[x]
    }

    #[inline]
    pub(super) fn row(&self, y: usize, z: usize) -> &[u8] {
        &self.bytes[(z * self.side + y) * self.side..][..self.side]
    }

    #[inline]
    pub(super) fn row_mut(&mut self, y: usize, z: usize) -> &mut [u8] {
        &mut self.bytes[(z * self.side + y) * self.side..][..self.side]
    }

    /// Returns slabs of `slices_per_slab` slices of equal z, in order, for parallel writing.
    pub(super) fn slabs_mut(
        &mut self,
        slices_per_slab: usize,
    ) -> impl IndexedParallelIterator<Item = &mut [u8]> {
        self.bytes.par_chunks_mut(slices_per_slab * self.side * self.side)
    }

    /// Replaces a part of the row (y, z), from the first x of `changes` on, and records in
    /// `changes` which texels differ.
    #[inline]
    pub(super) fn replace_row(
        &mut self,
        y: usize,
        z: usize,
        texels: &[u8],
        changes: &mut TexelChanges,
    ) {
        let row = &mut self.row_mut(y, z)[changes.first_x..][..texels.len()];
        let (old, new) = (row.as_chunks_mut::<8>(), texels.as_chunks::<8>());
        let mut flipped = 0;
        for ((old, new), all) in old.0.iter_mut().zip(new.0).zip(&mut changes.flipped) {
            let bits = u64::from_le_bytes(*old) ^ u64::from_le_bytes(*new);
            *old = *new;
            *all |= bits;
            flipped |= bits;
        }
        let bits = word_from_bytes(old.1) ^ word_from_bytes(new.1);
        changes.flipped[new.0.len()] |= bits;
        flipped |= bits;
        if flipped != 0 {
            old.1.copy_from_slice(new.1);
            changes.rows = changes.rows.union(&TexelBox { lo: [0, y, z], hi: [1, y + 1, z + 1] });
        }
        if flipped & TOP_BITS != 0 {
            let row = TexelBox { lo: [0, y, z], hi: [1, y + 1, z + 1] };
            changes.crossed_rows = changes.crossed_rows.union(&row);
        }
    }

    /// Returns a trilinear sample, 0 to 1, at a point in texels, clamped to the edge. Texel centres lie at
    /// halves.
    #[inline]
    pub(super) fn sample_trilinear(&self, point_in_texels: Vec3) -> f32 {
        let most = (self.side - 1) as f32;
        let point = (point_in_texels - Vec3::splat(0.5)).clamp(Vec3::ZERO, Vec3::splat(most));
        let [x, y, z] = point.to_array().map(|c| (c as usize).min(self.side - 2));
        let part = point - Vec3::new(x as f32, y as f32, z as f32);
        let mix = |a: f32, b: f32, part: f32| a + (b - a) * part;
        let along_x = |y: usize, z: usize| {
            let row = self.row(y, z);
            mix(f32::from(row[x]), f32::from(row[x + 1]), part.x)
        };
        let along_y = |z: usize| mix(along_x(y, z), along_x(y + 1, z), part.y);
        mix(along_y(z), along_y(z + 1), part.z) / 255.0
    }
}

/// The top bits of eight bytes, set in texels of at least a half.
const TOP_BITS: u64 = 0x8080_8080_8080_8080;

/// Accumulates which texels of a box changed, and which crossed a half.
#[derive(Debug)]
pub(super) struct TexelChanges {
    /// The first texel of the box along x.
    first_x: usize,
    /// Bits that flipped in any row, eight texels a word; the last word may be partial.
    flipped: [u64; MAX_ROW / 8 + 1],
    /// Bounds of the rows with a change, and of those with a texel that crossed a half.
    rows: TexelBox,
    crossed_rows: TexelBox,
}

/// Most texels in a row.
const MAX_ROW: usize = 264;

impl TexelChanges {
    /// Creates an accumulator without changes, for a box that starts at `first_x` along x.
    pub(super) const fn new(first_x: usize) -> Self {
        let none = TexelBox::NONE;
        TexelChanges { first_x, flipped: [0; MAX_ROW / 8 + 1], rows: none, crossed_rows: none }
    }

    /// Returns the bounding box of the texels that changed.
    pub(super) fn changed_box(&self) -> TexelBox {
        self.bounds_of(u64::MAX, self.rows)
    }

    /// Returns the bounding box of the texels that crossed a half.
    pub(super) fn half_crossed_box(&self) -> TexelBox {
        self.bounds_of(TOP_BITS, self.crossed_rows)
    }

    fn bounds_of(&self, relevant_bits: u64, rows: TexelBox) -> TexelBox {
        let flipped = |word: &u64| word & relevant_bits != 0;
        let (Some(front), Some(back)) =
            (self.flipped.iter().position(flipped), self.flipped.iter().rposition(flipped))
        else {
            return TexelBox::NONE;
        };
        let first = 8 * front + (self.flipped[front] & relevant_bits).trailing_zeros() as usize / 8;
        let end = 8 * back + 8 - (self.flipped[back] & relevant_bits).leading_zeros() as usize / 8;
        let [_, y, z] = rows.lo;
        let [_, y_end, z_end] = rows.hi;
        TexelBox { lo: [self.first_x + first, y, z], hi: [self.first_x + end, y_end, z_end] }
    }
}

/// Returns the top bit of each of up to 64 bytes, the first byte's lowest.
#[inline]
pub(super) fn gather_top_bits(bytes: &[u8]) -> u64 {
    let (eights, rest) = bytes.as_chunks::<8>();
    let mut bits = match rest {
        [] => 0,
        rest => gather_word_top_bits(word_from_bytes(rest)) << (8 * eights.len()),
    };
    for (i, eight) in eights.iter().enumerate() {
        bits |= gather_word_top_bits(u64::from_le_bytes(*eight)) << (8 * i);
    }
    bits
}

/// Returns the top bits of eight bytes.
#[inline]
const fn gather_word_top_bits(bytes: u64) -> u64 {
    // Bit 7 of byte k goes to bit 56 + k; no two products meet below.
    (bytes >> 7 & 0x0101_0101_0101_0101).wrapping_mul(0x0102_0408_1020_4080) >> 56
}

/// Returns up to seven bytes as a word, the first one lowest.
#[inline]
fn word_from_bytes(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte))
}
