//! Save, load and digest of the whole state.

use core::array;

use crate::codec::bad_save::{BadSave, INTERVALS_OF_A_COLUMN};
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::digest::{DIGEST_PARTS, checksum, combine_digests};
use crate::edit::undo::UnsoundEntry;
use crate::limits::MAX_INTERVALS;
use crate::session::bared::BaredEnds;
use crate::session::state::{SessionState, WorldState};
use crate::session::world::World;
use crate::volume::bit_grid::BitGrid;
use crate::volume::column_digest::maps_digest;
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RangeMaps};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// First bytes of a saved world.
const MAGIC: [u8; 4] = *b"PWLD";

/// Returns the version of the save format. Increment it with every change of the format. The version is 5 for
/// one interval a column; for K intervals it is 6 in the high byte and K in the low byte.
const fn save_version(intervals: usize) -> u16 {
    if intervals == 1 { 5 } else { 6 << 8 | intervals as u16 }
}

/// Returns the session phase stored in a save, read only from its first bytes, or `None` if they aren't a
/// save of this version. Doesn't validate the rest: see [`World::load`].
#[must_use]
pub fn session_of_save(bytes: &[u8]) -> Option<SessionState> {
    let mut from = ByteReader::new(bytes);
    let magic = from.bytes(4).ok()?;
    let version = from.u16().ok()?;
    let (_side, _checksum, _tick) = (from.u16().ok()?, from.u64().ok()?, from.u64().ok()?);
    let is_save = magic == MAGIC && intervals_of(version).is_some();
    SessionState::from_number(from.u8().ok()?).filter(|_| is_save)
}

/// Returns the number of intervals a column of a version.
fn intervals_of(version: u16) -> Option<usize> {
    (1..=MAX_INTERVALS).find(|intervals| save_version(*intervals) == version)
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Writes the whole state: a header with a checksum, and then everything that later ticks depend on.
    /// Returns its length in bytes. If the length exceeds that of `bytes`, their contents are unspecified.
    ///
    /// More than [`MAX_INTERVALS`] intervals a column have no version, so this doesn't compile:
    /// ```compile_fail
    /// static WORLD: paros_core::World<16, 5> = paros_core::World::new();
    /// let _ = WORLD.save(&mut []);
    /// ```
    #[must_use]
    #[inline(never)]
    pub fn save(&self, bytes: &mut [u8]) -> usize {
        const { assert!(K <= MAX_INTERVALS, "more than MAX_INTERVALS intervals aren't saved") };
        let mut to = ByteWriter::new(bytes);
        to.bytes(&MAGIC);
        to.u16(save_version(K));
        to.u16(N as u16);
        to.u64(0);
        self.state.write(&mut to);
        write_maps(&mut to, self.volume.maps());
        write_maps(&mut to, &self.mask);
        self.undo.save(&mut to);
        self.islands.save(&mut to);
        let len = to.len();
        if let Some(all) = bytes.get_mut(..len) {
            let sum = checksum(&all[HEADER..]);
            all[HEADER - 8..HEADER].copy_from_slice(&sum.to_le_bytes());
        }
        len
    }

    /// Restores a saved state. Digests continue as if uninterrupted. Every column is dirty until the next
    /// tick.
    ///
    /// The bytes may be untrusted. Every invariant that later ticks rely on is checked: maps of volume and
    /// mask, the volumes that undo and redo lead to, the reached and queued rows of a running island search,
    /// poses within range, one tool a hand and one bit a tool. Unchecked values affect behaviour but no
    /// invariant: a hand's buttons, phase and haptics may have any value; a search may have reached too much,
    /// which the next search corrects; and the sum of kept voxels decides whether a report repeats them.
    ///
    /// Loading isn't part of a tick, and takes as long as dozens of ticks: with two intervals a column and
    /// some fifty strokes to undo, 136 to 154 million instructions at 128 and 511 to 637 million at 256. The
    /// cost of each entry is proportional to its columns and to the box around its changes.
    ///
    /// # Errors
    /// [`BadSave`] for bytes that [`World::save`] didn't write for this N and K. A wrong checksum leaves the
    /// world unchanged; invalid bytes with a valid checksum leave it empty.
    #[inline(never)]
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), BadSave> {
        let mut from = ByteReader::new(bytes);
        check_header::<K>(&mut from, N, bytes)?;
        let done = self.load_body(&mut from);
        if done.is_err() {
            self.clear();
        }
        self.mark_all_changed();
        done
    }

    /// Resets to the empty world, which waits for a session.
    #[inline(never)]
    pub fn clear(&mut self) {
        self.state = WorldState::new();
        self.bared = BaredEnds::NONE;
        self.mask.clear();
        self.volume.set_voxels(BitGrid::clear);
        self.undo.clear();
        self.islands.reset();
        self.mark_all_changed();
    }

    fn load_body(&mut self, from: &mut ByteReader<'_>) -> Result<(), BadSave> {
        self.state = WorldState::read(from)?;
        // The mask is a buffer for the volume's maps until its bit rows are built.
        let start = from.offset();
        read_maps(from, &mut self.mask)?;
        self.volume.set_maps(&self.mask);
        let volume = &self.volume;
        refuse_column::<N, K>(volume.first_loose_column(), start, "tight ranges")?;
        let expected = "a column without empty voxels where a gap has room";
        refuse_column::<N, K>(volume.first_unsaturated_column(), start, expected)?;
        let start = from.offset();
        read_maps(from, &mut self.mask)?;
        let masked = !self.mask.is_empty();
        if masked != self.state.masked || maps_digest(&self.mask) != self.state.mask_digest {
            return Err(from.error_here("the mask that the state names").into());
        }
        let mask = &self.mask;
        let expected = "tight ranges of the mask";
        let occupied = |voxel| mask.contains(voxel);
        refuse_column::<N, K>(mask.first_loose_column(occupied), start, expected)?;
        let expected = "a column of the mask without empty voxels where a gap has room";
        refuse_column::<N, K>(mask.first_unsaturated_column(occupied), start, expected)?;
        let expected = "a mask within the volume";
        refuse_column::<N, K>(first_column_beyond(mask, volume.rows()), start, expected)?;
        self.recount_bared_ends();
        self.load_history(from)?;
        let offset = from.offset();
        self.islands.load(from)?;
        if let Some(expected) = self.islands.find_fault(self.volume.rows(), &self.mask) {
            return Err(BadBytes { offset, expected }.into());
        }
        from.expect_end()?;
        Ok(())
    }

    /// Reads the undo history and checks every volume that it leads to.
    fn load_history(&mut self, from: &mut ByteReader<'_>) -> Result<(), BadSave> {
        let start = from.offset();
        self.undo.load(from)?;
        let checked = self.undo.check_entries(&mut self.volume, &self.mask);
        checked.map_err(|UnsoundEntry { entry, expected, axis, address }| {
            let offset = start + self.undo.saved_offset_of(entry);
            BadSave::Entry { entry, bad: BadBytes { offset, expected }, axis, address }
        })
    }

    /// Returns the digest of all state that later ticks depend on, combined from incrementally updated
    /// digests of its parts. [`World::recompute_digest`] computes them from scratch. A new world and a
    /// cleared world have the same digest.
    #[must_use]
    pub fn digest(&self) -> u64 {
        combine_digests(self.part_digests().map(|(_, digest)| digest))
    }

    /// Returns the digest, with every part computed from scratch.
    #[must_use]
    #[inline(never)]
    pub fn recompute_digest(&self) -> u64 {
        let mut state = self.state;
        state.mask_digest = maps_digest(&self.mask);
        combine_digests([
            state.digest(),
            maps_digest(self.volume.maps()),
            self.undo.recompute_digest(),
            self.islands.recompute_digest(),
        ])
    }

    /// Returns the digests of the state's parts with their names, to find the part in which two worlds
    /// differ.
    #[must_use]
    #[inline(never)]
    pub fn part_digests(&self) -> [(&'static str, u64); DIGEST_PARTS.len()] {
        let digests =
            [self.state.digest(), self.volume.digest(), self.undo.digest(), self.islands.digest()];
        core::array::from_fn(|part| (DIGEST_PARTS[part], digests[part]))
    }
}

/// Length of the header in bytes: magic, version, N, checksum of the rest.
const HEADER: usize = 16;

fn check_header<const K: usize>(
    from: &mut ByteReader<'_>,
    grid_side: usize,
    bytes: &[u8],
) -> Result<(), BadSave> {
    let bad = from.error_here("the magic PWLD");
    if from.bytes(4)? != MAGIC {
        return Err(bad.into());
    }
    let bad = from.error_here("save version 5, or 6 of 2 to 4 intervals a column");
    let saved = intervals_of(from.u16()?).ok_or(bad)?;
    if saved != K {
        return Err(BadSave::Intervals { saved, here: K });
    }
    let bad = from.error_here("this world's size");
    if usize::from(from.u16()?) != grid_side {
        return Err(bad.into());
    }
    let bad = from.error_here("the checksum of what follows");
    if from.u64()? != checksum(&bytes[HEADER..]) {
        return Err(bad.into());
    }
    Ok(())
}

/// Returns an error for a column of maps whose bytes begin at `start`, if there is such a column.
fn refuse_column<const N: usize, const K: usize>(
    column: Option<(Axis, ColumnAddress)>,
    start: usize,
    expected: &'static str,
) -> Result<(), BadSave> {
    let Some((axis, address)) = column else { return Ok(()) };
    let (line, place) = address;
    let offset = start + 2 * K * ((axis as usize * N + line) * N + place);
    Err(BadSave::Column { bad: BadBytes { offset, expected }, axis, address })
}

/// Returns the first column along x with a voxel that isn't in the volume.
fn first_column_beyond<const N: usize, const K: usize>(
    maps: &RangeMaps<N, K>,
    volume: &BitGrid<N>,
) -> Option<(Axis, ColumnAddress)>
where
    Grid<N>: Size,
{
    let beyond =
        |at @ (y, z)| !maps.occupied_among(at, Grid::<N>::FULL & !volume.row(y, z)).is_empty();
    maps.find_column(|axis, at, _| axis == Axis::X && beyond(at))
}

fn write_maps<const N: usize, const K: usize>(to: &mut ByteWriter<'_>, maps: &RangeMaps<N, K>) {
    for axis in Axis::ALL {
        for line in 0..N {
            let columns = maps.line(axis, line);
            let bytes: [_; N] = array::from_fn(|place| columns[place].to_bytes());
            to.bytes(bytes.as_flattened().as_flattened());
        }
    }
}

fn read_maps<const N: usize, const K: usize>(
    from: &mut ByteReader<'_>,
    maps: &mut RangeMaps<N, K>,
) -> Result<(), BadSave> {
    for axis in Axis::ALL {
        for line in 0..N {
            for place in 0..N {
                let bad = from.error_here(INTERVALS_OF_A_COLUMN);
                let mut bytes = [[0; 2]; K];
                for range in &mut bytes {
                    *range = [from.u8()?, from.u8()?];
                }
                let address = (line, place);
                let column = Column::from_bytes(bytes, N);
                let column = column.ok_or(BadSave::Column { bad, axis, address })?;
                maps.set_column(axis, address, column);
            }
        }
    }
    Ok(())
}
