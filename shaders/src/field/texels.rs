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

    /// Replaces the part of a row, (y, z), from where `changes` starts, which are told what changed.
    #[inline]
    pub(super) fn replace(&mut self, (y, z): (usize, usize), texels: &[u8], changes: &mut Changes) {
        let row = &mut self.row_mut(y, z)[changes.start..][..texels.len()];
        let (old, new) = (row.as_chunks_mut::<8>(), texels.as_chunks::<8>());
        let mut flipped = 0;
        for ((old, new), all) in old.0.iter_mut().zip(new.0).zip(&mut changes.flipped) {
            let bits = u64::from_le_bytes(*old) ^ u64::from_le_bytes(*new);
            *old = *new;
            *all |= bits;
            flipped |= bits;
        }
        let bits = word(old.1) ^ word(new.1);
        changes.flipped[new.0.len()] |= bits;
        flipped |= bits;
        if flipped != 0 {
            old.1.copy_from_slice(new.1);
            changes.rows = changes.rows.union(&Extent { lo: [0, y, z], hi: [1, y + 1, z + 1] });
        }
        if flipped & TOPS != 0 {
            let row = Extent { lo: [0, y, z], hi: [1, y + 1, z + 1] };
            changes.crossed_rows = changes.crossed_rows.union(&row);
        }
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

/// The top bits of eight bytes: whether texels are at least a half.
const TOPS: u64 = 0x8080_8080_8080_8080;

/// What changed in a box of texels.
#[derive(Debug)]
pub(super) struct Changes {
    /// Where the box starts along x.
    start: usize,
    /// The bits that flipped in any row, eight texels a word; the last word may be a part.
    flipped: [u64; MOST / 8 + 1],
    /// The rows with a change, and those where a texel came to a half or fell below.
    rows: Extent,
    crossed_rows: Extent,
}

/// The longest row.
const MOST: usize = 264;

impl Changes {
    /// None yet, in a box that starts there along x.
    pub(super) const fn new(start: usize) -> Self {
        let none = Extent::NONE;
        Changes { start, flipped: [0; MOST / 8 + 1], rows: none, crossed_rows: none }
    }

    /// The texels that changed.
    pub(super) fn all(&self) -> Extent {
        self.of(u64::MAX, self.rows)
    }

    /// Those that came to a half or fell below.
    pub(super) fn crossed(&self) -> Extent {
        self.of(TOPS, self.crossed_rows)
    }

    fn of(&self, mask: u64, rows: Extent) -> Extent {
        let flipped = |word: &u64| word & mask != 0;
        let (Some(front), Some(back)) =
            (self.flipped.iter().position(flipped), self.flipped.iter().rposition(flipped))
        else {
            return Extent::NONE;
        };
        let first = 8 * front + (self.flipped[front] & mask).trailing_zeros() as usize / 8;
        let end = 8 * back + 8 - (self.flipped[back] & mask).leading_zeros() as usize / 8;
        let [_, y, z] = rows.lo;
        let [_, y_end, z_end] = rows.hi;
        Extent { lo: [self.start + first, y, z], hi: [self.start + end, y_end, z_end] }
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
