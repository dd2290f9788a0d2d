//! Offsets of the parts of a saved world, for tests that forge saves.

use std::ops::Range;

use paros_core::World;
use paros_core::internals::checksum;
use paros_core::limits::{STATE_BYTES, max_save_bytes};
use paros_core::volume::{Axis, Grid, Size};

/// Offset of the checksum.
const CHECKSUM: usize = 8;

/// Offset of the bytes that the checksum covers, which begin with the world's small state.
pub const BODY: usize = 16;

/// Offset of the volume's columns.
pub const MAPS: usize = BODY + STATE_BYTES;

/// Offsets of the parts of a save that have no fixed place.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SaveLayout {
    /// The mask's columns.
    pub mask: usize,
    /// The undo history.
    pub undo: usize,
    /// The range of each undo entry, including the length before it.
    pub entries: Vec<Range<usize>>,
    /// The island search.
    pub islands: usize,
}

impl SaveLayout {
    /// Finds the parts of a save of this N and K. Returns `None` if the bytes end early.
    #[must_use]
    pub fn of<const N: usize, const K: usize>(bytes: &[u8]) -> Option<Self> {
        let mask = MAPS + 6 * N * N * K;
        let undo = mask + 6 * N * N * K;
        let header: [u8; 5] = *bytes.get(undo..)?.first_chunk()?;
        let packed = u16::from_le_bytes([header[0], header[1]]);
        let count = u32::from(packed) + u32::from(header[4] & 1);
        let (mut entries, mut at) = (Vec::new(), undo + 5);
        for _ in 0..count {
            let cells = u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?);
            let end = at + 4 + 2 * cells as usize;
            entries.push(at..end);
            at = end;
        }
        (at < bytes.len()).then_some(SaveLayout { mask, undo, entries, islands: at })
    }

    /// Returns the columns of an undo entry with the offsets of their values, 2 K bytes each.
    ///
    /// # Panics
    /// The entry doesn't exist.
    #[must_use]
    pub fn columns_of_entry<const N: usize, const K: usize>(
        &self,
        bytes: &[u8],
        entry: usize,
    ) -> Vec<(Axis, (usize, usize), usize)> {
        let words_of_line = N.div_ceil(64);
        let flags = self.entries[entry].start + 4;
        let mut word_at = flags + 3 * N * words_of_line / 8;
        let mut columns = Vec::new();
        for word in 0..3 * N * words_of_line {
            if bytes[flags + word / 8] >> (word % 8) & 1 == 0 {
                continue;
            }
            let bits = u64::from_le_bytes(*bytes[word_at..].first_chunk().expect("a word"));
            word_at += 8;
            let (line, first) = (word / words_of_line, word % words_of_line * 64);
            let places = (0..64).filter(|bit| bits >> bit & 1 == 1);
            columns.extend(places.map(|bit| (Axis::ALL[line / N], (line % N, first + bit))));
        }
        let at = |i: usize| word_at + 2 * K * i;
        columns.into_iter().enumerate().map(|(i, (axis, address))| (axis, address, at(i))).collect()
    }
}

/// Saves a world to a vector.
pub fn save_to_vec<const N: usize, const K: usize>(world: &World<N, K>) -> Vec<u8>
where
    Grid<N>: Size,
{
    let mut bytes = vec![0; max_save_bytes(N, K)];
    let len = world.save(&mut bytes);
    bytes.truncate(len);
    bytes
}

/// Writes a valid checksum to a forged save.
pub fn write_checksum(bytes: &mut [u8]) {
    let sum = checksum(&bytes[BODY..]);
    bytes[CHECKSUM..BODY].copy_from_slice(&sum.to_le_bytes());
}
