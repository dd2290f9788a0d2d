//! Mip chain of the density: a box filter over 2 x 2 x 2 texels.

use super::extent::TexelBox;
use super::texels::{TexelChanges, TexelCube};

/// Recomputes the texels `coarse_extent` of `coarse` from the next finer level. Returns which of
/// them changed.
pub(super) fn downsample_box(
    fine: &TexelCube,
    coarse: &mut TexelCube,
    coarse_extent: TexelBox,
) -> TexelChanges {
    let mut changes = TexelChanges::new(coarse_extent.lo[0]);
    let mut means = [0u8; MAX_ROW];
    let [lo, hi] = [coarse_extent.lo[0], coarse_extent.hi[0]];
    let means = &mut means[..hi - lo];
    for (y, z) in coarse_extent.rows() {
        let fine_row = |y: usize, z: usize| &fine.row(y, z)[2 * lo..2 * hi];
        let (y2, z2) = (2 * y, 2 * z);
        let rows = [
            fine_row(y2, z2),
            fine_row(y2 + 1, z2),
            fine_row(y2, z2 + 1),
            fine_row(y2 + 1, z2 + 1),
        ];
        let [a, b, c, d] = rows.map(|row| row.as_chunks::<8>());
        let (fours, rest) = means.as_chunks_mut::<4>();
        for (i, means) in fours.iter_mut().enumerate() {
            *means = mean_2x2x2([a.0[i], b.0[i], c.0[i], d.0[i]]);
        }
        let last = [a.1, b.1, c.1, d.1].map(|row| {
            let mut eight = [0; 8];
            eight[..row.len()].copy_from_slice(row);
            eight
        });
        rest.copy_from_slice(&mean_2x2x2(last)[..rest.len()]);
        coarse.replace_row(y, z, means, &mut changes);
    }
    changes
}

/// Returns four means of 2 x 2 x 2 texels, rounded half up, summed in 16-bit lanes of a word.
#[inline]
fn mean_2x2x2(rows: [[u8; 8]; 4]) -> [u8; 4] {
    const EVEN: u64 = 0x00ff_00ff_00ff_00ff;
    let pairs = |row: [u8; 8]| {
        let row = u64::from_le_bytes(row);
        (row & EVEN) + (row >> 8 & EVEN)
    };
    let [a, b, c, d] = rows.map(pairs);
    let means = (a + b + c + d + 0x0004_0004_0004_0004) >> 3 & EVEN;
    let [a, _, b, _, c, _, d, _] = means.to_le_bytes();
    [a, b, c, d]
}

/// The most texels in a row: half of those at 256.
const MAX_ROW: usize = 132;
