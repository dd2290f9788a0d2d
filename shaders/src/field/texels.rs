//! A cube of bytes, and sampling it as a GPU does.

use glam::Vec3;
use rayon::prelude::*;

use super::extent::Extent;

/// A cube of texels of a byte, x fastest, z slowest.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Texels {
    side: usize,
    bytes: Vec<u8>,
}

impl Texels {
    pub(super) fn new(side: usize, texel: u8) -> Self {
        Texels { side, bytes: vec![texel; side.pow(3)] }
    }

    pub(super) const fn side(&self) -> usize {
        self.side
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    #[inline]
    pub(super) fn at(&self, [x, y, z]: [usize; 3]) -> u8 {
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

    /// So many slices of equal z at a time, in order.
    pub(super) fn slabs_mut(
        &mut self,
        slices: usize,
    ) -> impl IndexedParallelIterator<Item = &mut [u8]> {
        self.bytes.par_chunks_mut(slices * self.side * self.side)
    }

    /// Replaces a stretch of a row; what changed of it is added to `changed`, and which
    /// bits flipped comes back.
    #[inline]
    pub(super) fn replace(
        &mut self,
        [x, y, z]: [usize; 3],
        texels: &[u8],
        changed: &mut Extent,
    ) -> u8 {
        let row = &mut self.row_mut(y, z)[x..x + texels.len()];
        let (mut first, mut end, mut flipped) = (usize::MAX, 0, 0);
        let (old, new) = (row.as_chunks::<8>(), texels.as_chunks::<8>());
        let mut compare = |i: usize, bits: u64| {
            if bits != 0 {
                first = first.min(8 * i + bits.trailing_zeros() as usize / 8);
                end = 8 * i + 8 - bits.leading_zeros() as usize / 8;
                flipped |= bits;
            }
        };
        for (i, (old, new)) in old.0.iter().zip(new.0).enumerate() {
            compare(i, u64::from_le_bytes(*old) ^ u64::from_le_bytes(*new));
        }
        compare(old.0.len(), word(old.1) ^ word(new.1));
        if flipped == 0 {
            return 0;
        }
        row.copy_from_slice(texels);
        let part = Extent { lo: [x + first, y, z], hi: [x + end, y + 1, z + 1] };
        *changed = changed.union(&part);
        flipped.to_le_bytes().into_iter().fold(0, |all, bits| all | bits)
    }

    /// The value, 0 to 1, at a place in texels whose centres lie at halves, filtered trilinearly.
    #[inline]
    pub(super) fn sample(&self, place: Vec3) -> f32 {
        let most = (self.side - 1) as f32;
        let place = (place - Vec3::splat(0.5)).clamp(Vec3::ZERO, Vec3::splat(most));
        let [x, y, z] = place.to_array().map(|c| (c as usize).min(self.side - 2));
        let part = place - Vec3::new(x as f32, y as f32, z as f32);
        let mix = |a: f32, b: f32, part: f32| a + (b - a) * part;
        let along_x = |y: usize, z: usize| {
            let row = self.row(y, z);
            mix(f32::from(row[x]), f32::from(row[x + 1]), part.x)
        };
        let along_y = |z: usize| mix(along_x(y, z), along_x(y + 1, z), part.y);
        mix(along_y(z), along_y(z + 1), part.z) / 255.0
    }
}

/// The top bit of each of up to 64 bytes, the first one lowest.
#[inline]
pub(super) fn tops(bytes: &[u8]) -> u64 {
    let (eights, rest) = bytes.as_chunks::<8>();
    let mut bits = match rest {
        [] => 0,
        rest => tops_of(word(rest)) << (8 * eights.len()),
    };
    for (i, eight) in eights.iter().enumerate() {
        bits |= tops_of(u64::from_le_bytes(*eight)) << (8 * i);
    }
    bits
}

/// The top bits of eight bytes.
#[inline]
const fn tops_of(bytes: u64) -> u64 {
    // Bit 7 of byte k goes to bit 56 + k; no two products meet below.
    (bytes >> 7 & 0x0101_0101_0101_0101).wrapping_mul(0x0102_0408_1020_4080) >> 56
}

/// Up to seven bytes as a word, the first one lowest.
#[inline]
fn word(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte))
}
