//! The rows between two parallel planes, computed one after another by additions.

use crate::volume::row::BitSet;

/// The ends of the rows between a disc's planes, in voxels times 2^[`SlabRows::FRACTION_BITS`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlabRows {
    pub(super) lo: i64,
    pub(super) hi: i64,
    pub(super) step: i64,
}

impl SlabRows {
    pub(super) const FRACTION_BITS: u32 = 20;
    /// Exceeds the rounding error of 256 steps: rounding down makes both `lo` and `hi` too small.
    pub(super) const SLACK: i64 = 1 << 9;

    /// Returns the first and the last voxel of the next row, which may lie outside the grid. In an empty row,
    /// the last is the voxel before the first.
    #[inline]
    const fn ends(&self) -> (i64, i64) {
        let up = (1 << Self::FRACTION_BITS) - 1;
        ((self.lo + up) >> Self::FRACTION_BITS, self.hi >> Self::FRACTION_BITS)
    }

    #[inline]
    const fn step(&mut self) {
        (self.lo, self.hi) = (self.lo + self.step, self.hi + self.step);
    }

    /// Returns [`SlabRows::ends`] and advances to the next row.
    #[inline]
    pub(crate) const fn next_ends(&mut self) -> (i64, i64) {
        let ends = self.ends();
        self.step();
        ends
    }

    /// Returns the indices of the first `count` rows that have a voxel from `first_x` to `last_x`.
    #[inline]
    fn rows_meeting(
        &self,
        (first_x, last_x): (usize, usize),
        count: usize,
    ) -> core::ops::Range<usize> {
        // The distance from the first row's end to the voxels, and from its beginning to their end, in steps
        // of a row.
        let short = ((first_x as i64) << Self::FRACTION_BITS) - self.hi;
        let room = ((last_x as i64) << Self::FRACTION_BITS) - self.lo;
        let (short, room, step) = match self.step {
            0 if short <= 0 && room >= 0 => return 0..count,
            0 => return 0..0,
            step if step < 0 => (-room, -short, -step),
            step => (short, room, step),
        };
        let first = if short > 0 { ((short - 1) / step + 1) as usize } else { 0 };
        let end = if room >= 0 { (room / step) as usize + 1 } else { 0 };
        first..end.min(count)
    }

    /// Returns `true` if `is_found` does for one of `rows`, starting with the next row. `is_found` gets the
    /// index and the ends of each row that has a voxel between its ends and from `first_x` to `last_x`.
    ///
    /// Rows whose voxels lie in the same word are tested first with the widest mask that any of them can
    /// have.
    #[inline]
    pub(crate) fn find_row_holding<R: BitSet>(
        mut self,
        rows: &[R],
        (first_x, last_x): (usize, usize),
        mut is_found: impl FnMut(usize, (i64, i64)) -> bool,
    ) -> bool {
        let most = ((self.hi - self.lo) >> Self::FRACTION_BITS) + 1;
        let widest = u64::MAX.checked_shl(most as u32).map_or(u64::MAX, |beyond| !beyond);
        let meeting = self.rows_meeting((first_x, last_x), rows.len());
        let (mut i, rows) = (meeting.start, &rows[..meeting.end]);
        (self.lo, self.hi) = (self.lo + self.step * i as i64, self.hi + self.step * i as i64);
        while i < rows.len() {
            let ends @ (first, last) = self.ends();
            let (within_first, within_last) = (first.max(first_x as i64), last.min(last_x as i64));
            let word = first.clamp(0, 64 * R::WORDS as i64 - 1) as usize / 64;
            let of_word = (first_x.max(64 * word) as i64, last_x.min(64 * word + 63) as i64);
            let like_it = if most < 64 { self.count_rows_within(of_word) } else { 0 };
            for (i, row) in (i..).zip(&rows[i..]).take(like_it) {
                let first = (self.ends().0 % 64) as u32;
                if row.word(word) >> first & widest != 0 {
                    let ends = self.ends();
                    let voxels = !(u64::MAX << (ends.1 + 1 - ends.0)) << first;
                    if row.word(word) & voxels != 0 && is_found(i, ends) {
                        return true;
                    }
                }
                self.step();
            }
            i += like_it;
            if like_it == 0 {
                let is_held = within_first <= within_last
                    && has_any_of(&rows[i], within_first as usize, within_last as usize);
                if is_held && is_found(i, ends) {
                    return true;
                }
                self.step();
                i += 1;
            }
        }
        false
    }

    /// Returns how many rows from the next on have no voxel outside `first..=last`.
    #[inline]
    fn count_rows_within(&self, (first, last): (i64, i64)) -> usize {
        // The greatest `lo` that is too small, and the least `hi` that is too great.
        let (below, above) =
            ((first - 1) << Self::FRACTION_BITS, (last + 1) << Self::FRACTION_BITS);
        if self.lo <= below || self.hi >= above {
            return 0;
        }
        let left = if self.step < 0 { self.lo - below - 1 } else { above - 1 - self.hi };
        left.checked_div(self.step.abs()).map_or(usize::MAX, |steps| steps as usize + 1)
    }
}

/// Returns `true` if a row has one of the bits `first..=last` set.
#[inline]
fn has_any_of<R: BitSet>(row: &R, first: usize, last: usize) -> bool {
    if first / 64 == last / 64 {
        let bits = row.word(first / 64) >> (first % 64);
        return bits & (u64::MAX >> (63 - (last - first))) != 0;
    }
    let words = first / 64..last / 64 + 1;
    words.clone().any(|i| {
        let from = if i == words.start { u64::MAX << (first % 64) } else { u64::MAX };
        let to = if i + 1 == words.end { u64::MAX >> (63 - last % 64) } else { u64::MAX };
        row.word(i) & from & to != 0
    })
}
