//! Coarser levels of the density.

use super::extent::Extent;
use super::texels::Texels;

/// Recomputes the texels `extent` of `coarse` from a level twice as fine; which changed comes back.
pub(super) fn halve(fine: &Texels, coarse: &mut Texels, extent: Extent) -> Extent {
    let mut changed = Extent::NONE;
    let mut mean = [0u8; MOST];
    let [lo, hi] = [extent.lo[0], extent.hi[0]];
    for (y, z) in extent.rows() {
        let fine_row = |y: usize, z: usize| &fine.row(y, z)[2 * lo..2 * hi];
        let (y2, z2) = (2 * y, 2 * z);
        let rows = [
            fine_row(y2, z2),
            fine_row(y2 + 1, z2),
            fine_row(y2, z2 + 1),
            fine_row(y2 + 1, z2 + 1),
        ];
        let mean = &mut mean[..hi - lo];
        for (i, mean) in mean.iter_mut().enumerate() {
            let pair = |row: &[u8]| u16::from(row[2 * i]) + u16::from(row[2 * i + 1]);
            let sum = pair(rows[0]) + pair(rows[1]) + pair(rows[2]) + pair(rows[3]);
            *mean = ((sum + 4) / 8) as u8;
        }
        coarse.replace([lo, y, z], mean, &mut changed);
    }
    changed
}

/// The longest row: half of that at 256.
const MOST: usize = 132;
