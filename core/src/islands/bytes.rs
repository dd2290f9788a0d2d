//! The state of a pass as bytes, and its digest.

use super::{Islands, Phase};
use crate::codec::{BadBytes, Reader, Writer};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::volume::{KEYS, mix};

impl<const N: usize> Islands<N>
where
    Grid<N>: Size,
{
    /// Digest of all that later passes can see. The reached voxels' part is kept up as they grow;
    /// the queue, N x N bits, is added to it here.
    #[must_use]
    pub fn digest(&self) -> u64 {
        self.digest_with(self.reached_sum)
    }

    /// The same, with nothing taken from sums kept up.
    #[must_use]
    pub fn recompute_digest(&self) -> u64 {
        let mut sum = 0u64;
        if self.phase == Phase::Sweep {
            for y in 0..N {
                for (z, row) in self.reached.layer(y).iter().enumerate() {
                    sum = sum.wrapping_add(keyed(y, z, *row));
                }
            }
        }
        self.digest_with(sum)
    }

    fn digest_with(&self, reached_sum: u64) -> u64 {
        let mut sum = reached_sum;
        if self.phase == Phase::Sweep {
            for (y, row) in self.queued.iter().enumerate() {
                sum = sum.wrapping_add(keyed(N, y, *row));
            }
        }
        let flags = [self.phase as u8, self.pending.into(), self.cursor, 0];
        let mut digest = mix(u32::from_le_bytes(flags).into());
        for part in [sum, self.kept_sum] {
            digest = mix(digest ^ part);
        }
        digest
    }

    /// Writes the state: flags, the kept voxels' sum, and in flight the cursor, then for each layer
    /// its queued rows and which rows hold reached voxels, as N bits each, then those rows.
    pub fn save(&self, out: &mut Writer<'_>) {
        out.u8(self.phase as u8 | u8::from(self.pending) << 1);
        out.u64(self.kept_sum);
        if self.phase == Phase::Idle {
            return;
        }
        out.u8(self.cursor);
        for (y, queued) in self.queued.iter().enumerate() {
            let mut held = <Grid<N> as Size>::Row::EMPTY;
            for (z, row) in self.reached.layer(y).iter().enumerate() {
                if !row.is_empty() {
                    held.insert(z);
                }
            }
            write_row(out, *queued);
            write_row(out, held);
            for z in held.ones() {
                write_row(out, self.reached.row(y, z));
            }
        }
    }

    /// Reads what [`Islands::save`] wrote, and goes on exactly from there.
    ///
    /// # Errors
    /// [`BadBytes`] where the bytes end early or say what no pass does; no pass is in flight then.
    pub fn load(&mut self, bytes: &mut Reader<'_>) -> Result<(), BadBytes> {
        self.abort();
        self.kept_sum = 0;
        let flags = bytes.u8()?;
        if flags > 3 {
            return Err(bytes.bad("flags of an island pass"));
        }
        let kept_sum = bytes.u64()?;
        if flags & 1 != 0 {
            self.load_pass(bytes).inspect_err(|_| self.stop())?;
            self.phase = Phase::Sweep;
        }
        self.kept_sum = kept_sum;
        self.pending = flags & 2 != 0;
        Ok(())
    }

    fn load_pass(&mut self, bytes: &mut Reader<'_>) -> Result<(), BadBytes> {
        self.cursor = bytes.u8()?;
        if usize::from(self.cursor) >= N {
            return Err(bytes.bad("a layer of the grid"));
        }
        self.reached.clear();
        // Which rows are open isn't saved: that any may be changes nothing but the time it takes.
        self.open.fill(Grid::<N>::FULL);
        for y in 0..N {
            self.queued[y] = read_row::<N>(bytes)?;
            if !self.queued[y].is_empty() {
                self.layers.insert(y);
            }
            for z in read_row::<N>(bytes)?.ones() {
                let row = read_row::<N>(bytes)?;
                if row.is_empty() {
                    return Err(bytes.bad("a row that holds voxels"));
                }
                self.reach(y, z, row);
            }
        }
        Ok(())
    }
}

/// The sum of a row's words, each times its own key: linear in disjoint voxels.
#[inline]
pub(super) fn keyed<R: Bits>(y: usize, z: usize, row: R) -> u64 {
    keyed_layer(y, keyed_row(z, row))
}

#[inline]
pub(super) fn keyed_row<R: Bits>(z: usize, row: R) -> u64 {
    let mut sum = 0u64;
    for i in 0..R::WORDS {
        let key = KEYS[z].rotate_left(13 * i as u32);
        sum = sum.wrapping_add(row.word(i).wrapping_mul(key));
    }
    sum
}

/// Of the sum of [`keyed_row`] over rows of one layer.
#[inline]
pub(super) fn keyed_layer(y: usize, sum: u64) -> u64 {
    sum.wrapping_mul(mix(KEYS[y]))
}

fn write_row<R: Bits>(out: &mut Writer<'_>, row: R) {
    for i in 0..R::WORDS {
        out.u64(row.word(i));
    }
}

fn read_row<const N: usize>(bytes: &mut Reader<'_>) -> Result<<Grid<N> as Size>::Row, BadBytes>
where
    Grid<N>: Size,
{
    let mut row = <Grid<N> as Size>::Row::EMPTY;
    for i in 0..<Grid<N> as Size>::Row::WORDS {
        row.set_word(i, bytes.u64()?);
    }
    if (row & !Grid::<N>::FULL).is_empty() { Ok(row) } else { Err(bytes.bad("bits of the grid")) }
}
