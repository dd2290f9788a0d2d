//! Serialisation and digest of an island search.

use super::{IslandSearch, SearchPhase, neighbour_rows};
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::digest::{DIGEST_KEYS, mix_bits};
use crate::volume::bit_grid::BitGrid;
use crate::volume::range_maps::{RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

impl<const N: usize> IslandSearch<N>
where
    Grid<N>: Size,
{
    /// Returns a digest of the state that determines later passes. The reached voxels' part is maintained
    /// incrementally; the queue, N x N bits, is added here.
    #[must_use]
    pub fn digest(&self) -> u64 {
        self.digest_with(self.reached_sum)
    }

    /// Returns the same digest, computed without the incremental sums.
    #[must_use]
    pub fn recompute_digest(&self) -> u64 {
        let mut sum = 0u64;
        if self.phase == SearchPhase::Sweep {
            for y in 0..N {
                for (z, row) in self.reached.layer(y).iter().enumerate() {
                    sum = sum.wrapping_add(hash_row((y, z), *row));
                }
            }
        }
        self.digest_with(sum)
    }

    fn digest_with(&self, reached_sum: u64) -> u64 {
        let mut sum = reached_sum;
        if self.phase == SearchPhase::Sweep {
            for (y, row) in self.queued.iter().enumerate() {
                sum = sum.wrapping_add(hash_row((N, y), *row));
            }
        }
        let flags = [self.phase as u8, self.pending.into(), self.cursor, 0];
        let mut digest = mix_bits(u32::from_le_bytes(flags).into());
        for part in [sum, self.kept_sum] {
            digest = mix_bits(digest ^ part);
        }
        digest
    }

    /// Writes the state: flags and the kept voxels' sum. During a pass also the cursor, then for each layer a
    /// bitmap of its queued rows, a bitmap of the rows that hold reached voxels, N bits each, and those rows.
    pub fn save(&self, out: &mut ByteWriter<'_>) {
        out.u8(self.phase as u8 | u8::from(self.pending) << 1);
        out.u64(self.kept_sum);
        if self.phase == SearchPhase::Idle {
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
            for z in held.iter_ones() {
                write_row(out, self.reached.row(y, z));
            }
        }
    }

    /// Reads the output of [`IslandSearch::save`], so that the search continues exactly from there.
    ///
    /// # Errors
    /// [`BadBytes`] if the bytes end early or are invalid. Then no pass is running.
    pub fn load(&mut self, bytes: &mut ByteReader<'_>) -> Result<(), BadBytes> {
        self.cancel_passes();
        self.kept_sum = 0;
        let flags = bytes.u8()?;
        if flags > 3 {
            return Err(bytes.error_here("flags of an island pass"));
        }
        let kept_sum = bytes.u64()?;
        if flags & 1 != 0 {
            self.load_pass(bytes).inspect_err(|_| self.end_running_pass())?;
            self.phase = SearchPhase::Sweep;
        }
        self.kept_sum = kept_sum;
        self.pending = flags & 2 != 0;
        Ok(())
    }

    /// Returns a description of the first invariant that a loaded search violates, or `None`. The invariants
    /// ensure that no pass removes supported voxels: the ground is reached; in rows that aren't queued, the
    /// mask's voxels are reached, and no unreached voxel adjoins a reached one. Reached voxels in excess are
    /// harmless: the next pass corrects them.
    pub(crate) fn find_fault<const K: usize>(
        &self,
        voxels: &BitGrid<N>,
        mask: &RangeMaps<N, K>,
    ) -> Option<&'static str> {
        if self.phase == SearchPhase::Idle {
            return None;
        }
        let mut rows = (0..N).flat_map(|y| (0..N).map(move |z| (y, z)));
        rows.find_map(|(y, z)| {
            let reached = self.reached.row(y, z);
            let left = voxels.row(y, z) & !reached;
            let is_queued = self.queued[y].contains(z);
            let is_mask_missed = !is_queued && !mask.occupied_among((y, z), left).is_empty();
            if (y == 0 && !left.is_empty()) || is_mask_missed {
                return Some("an island search that has reached ground and mask");
            }
            let mut beside = reached.shifted_up() | reached.shifted_down();
            for (y, z) in neighbour_rows::<N>((y, z)) {
                beside |= self.reached.row(y, z);
            }
            let is_missed = !is_queued && !(left & beside).is_empty();
            is_missed.then_some("an island search that has queued the rows beside what it reached")
        })
    }

    fn load_pass(&mut self, bytes: &mut ByteReader<'_>) -> Result<(), BadBytes> {
        self.cursor = bytes.u8()?;
        if usize::from(self.cursor) >= N {
            return Err(bytes.error_here("a layer of the grid"));
        }
        self.reached.clear();
        for y in 0..N {
            self.queued[y] = read_row::<N>(bytes)?;
            // Open rows aren't saved. A queued row may be waiting for its first visit; treating any other row
            // as open only costs time.
            self.open[y] = Grid::<N>::FULL & !self.queued[y];
            if !self.queued[y].is_empty() {
                self.layers.insert(y);
            }
            for z in read_row::<N>(bytes)?.iter_ones() {
                let row = read_row::<N>(bytes)?;
                if row.is_empty() {
                    return Err(bytes.error_here("a row that holds voxels"));
                }
                self.mark_reached((y, z), row);
            }
        }
        Ok(())
    }
}

/// Linear hash of row (y, z): the sum of its words, each times its own key. The hashes of disjoint sets of
/// voxels add up to the hash of their union. All factors are odd: an even one would shift high bits out.
#[inline]
pub(super) fn hash_row<R: BitSet>((y, z): RowAddress, voxels: R) -> u64 {
    layer_hash_from_sum(y, hash_row_in_layer(z, voxels))
}

#[inline]
pub(super) fn hash_row_in_layer<R: BitSet>(z: usize, voxels: R) -> u64 {
    let mut sum = 0u64;
    for i in 0..R::WORDS {
        let key = DIGEST_KEYS[z].rotate_left(13 * i as u32) | 1;
        sum = sum.wrapping_add(voxels.word(i).wrapping_mul(key));
    }
    sum
}

/// Scales the sum of [`hash_row_in_layer`] over rows of layer `y` to the layer's part of the hash.
#[inline]
pub(super) fn layer_hash_from_sum(y: usize, sum_of_rows: u64) -> u64 {
    sum_of_rows.wrapping_mul(mix_bits(DIGEST_KEYS[y]) | 1)
}

fn write_row<R: BitSet>(out: &mut ByteWriter<'_>, row: R) {
    for i in 0..R::WORDS {
        out.u64(row.word(i));
    }
}

fn read_row<const N: usize>(bytes: &mut ByteReader<'_>) -> Result<<Grid<N> as Size>::Row, BadBytes>
where
    Grid<N>: Size,
{
    let mut row = <Grid<N> as Size>::Row::EMPTY;
    for i in 0..<Grid<N> as Size>::Row::WORDS {
        row.set_word(i, bytes.u64()?);
    }
    if (row & !Grid::<N>::FULL).is_empty() {
        Ok(row)
    } else {
        Err(bytes.error_here("bits of the grid"))
    }
}
