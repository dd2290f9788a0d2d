//! Save, load and digest: the whole state as bytes, and as 64 bits.

use core::array;

use crate::codec::{BadBytes, Reader, Writer};
use crate::maps::{Axis, Column, Maps, Range};
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::state::State;
use crate::volume::{maps_digest, mix};
use crate::world::World;

/// First bytes of a saved world.
const MAGIC: [u8; 4] = *b"PWLD";

/// Changes with every change of what is saved.
const VERSION: u16 = 2;

/// The parts of the state that have digests of their own.
pub const PARTS: [&str; 4] = ["hands, bench and session", "volume", "undo", "islands"];

impl<const N: usize> World<N>
where
    Grid<N>: Size,
{
    /// Writes the whole state: a header with a checksum, then what later ticks can see. Returns
    /// the length; nothing useful is in `bytes` unless it is at most theirs.
    #[must_use]
    pub fn save(&self, bytes: &mut [u8]) -> usize {
        let mut to = Writer::new(bytes);
        to.bytes(&MAGIC);
        to.u16(VERSION);
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

    /// Goes on from a saved state: digests continue as if uninterrupted. Until the next tick,
    /// everything is dirty.
    ///
    /// # Errors
    /// [`BadBytes`] for bytes that [`World::save`] didn't write for this N. They are told by their
    /// checksum before anything is touched; bytes that were forged with a right checksum and are
    /// wrong all the same leave the empty world.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), BadBytes> {
        let mut from = Reader::new(bytes);
        check_header(&mut from, N, bytes)?;
        let done = self.load_body(&mut from);
        if done.is_err() {
            self.clear();
        }
        self.refresh();
        done
    }

    /// Becomes the empty world that waits for a session.
    pub fn clear(&mut self) {
        self.state = State::new();
        self.mask.clear();
        self.volume.set_voxels(Plane::clear);
        self.undo.clear();
        self.islands.clear();
        self.refresh();
    }

    fn load_body(&mut self, from: &mut Reader<'_>) -> Result<(), BadBytes> {
        self.state = State::read(from)?;
        // The mask's place holds the volume's maps until the bit rows have been made of them.
        read_maps(from, &mut self.mask)?;
        self.volume.set_maps(&self.mask);
        if !self.volume.is_tight() {
            return Err(from.bad("tight ranges"));
        }
        read_maps(from, &mut self.mask)?;
        let masked = !self.mask.is_empty();
        if masked != self.state.masked || maps_digest(&self.mask) != self.state.mask_digest {
            return Err(from.bad("the mask that the state names"));
        }
        if !is_tight(&self.mask) || !is_within(&self.mask, self.volume.rows()) {
            return Err(from.bad("tight ranges of voxels that are in the volume"));
        }
        self.undo.load(from)?;
        self.islands.load(from)?;
        from.end()
    }

    /// Covers every bit of state that later ticks can see. Combined of digests that are kept up as
    /// things change; [`World::recompute_digest`] takes them from scratch. The same for a new
    /// world as for one that was cleared.
    #[must_use]
    pub fn digest(&self) -> u64 {
        combine(self.part_digests().map(|(_, digest)| digest))
    }

    /// The digest, with every part of it taken from scratch.
    #[must_use]
    pub fn recompute_digest(&self) -> u64 {
        let mut state = self.state;
        state.mask_digest = maps_digest(&self.mask);
        combine([
            state.digest(),
            maps_digest(self.volume.maps()),
            self.undo.recompute_digest(),
            self.islands.recompute_digest(),
        ])
    }

    /// The digests of the state's parts, by name: to tell which of them two worlds differ in.
    #[must_use]
    pub fn part_digests(&self) -> [(&'static str, u64); PARTS.len()] {
        let digests =
            [self.state.digest(), self.volume.digest(), self.undo.digest(), self.islands.digest()];
        core::array::from_fn(|part| (PARTS[part], digests[part]))
    }
}

/// Length of the header: magic, version, N, checksum of the rest.
const HEADER: usize = 16;

fn check_header(from: &mut Reader<'_>, n: usize, bytes: &[u8]) -> Result<(), BadBytes> {
    let bad = from.bad("the magic PWLD");
    if from.bytes(4)? != MAGIC {
        return Err(bad);
    }
    let bad = from.bad("version 2");
    if from.u16()? != VERSION {
        return Err(bad);
    }
    let bad = from.bad("this world's size");
    if usize::from(from.u16()?) != n {
        return Err(bad);
    }
    let bad = from.bad("the checksum of what follows");
    if from.u64()? != checksum(&bytes[HEADER..]) {
        return Err(bad);
    }
    Ok(())
}

/// A digest of bytes, eight at a time.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u64 {
    let mut sum = bytes.len() as u64;
    for chunk in bytes.chunks(8) {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        sum = mix(sum ^ u64::from_le_bytes(word)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    }
    sum
}

/// The digest of a world whose parts have these.
#[must_use]
pub fn combine(parts: [u64; PARTS.len()]) -> u64 {
    parts.into_iter().fold(0, |sum, part| mix(sum.rotate_left(17) ^ part))
}

fn is_tight<const N: usize>(maps: &Maps<N>) -> bool {
    Axis::ALL.into_iter().all(|axis| {
        (0..N).all(|line| {
            maps.line(axis, line).iter().enumerate().all(|(place, column)| {
                let (range, at) = (column.hull(), (line, place));
                let end = |i| maps.contains(axis.voxel(at, i));
                range.is_empty() || end(range.lo()) && end(range.hi())
            })
        })
    })
}

fn is_within<const N: usize>(maps: &Maps<N>, rows: &Plane<N>) -> bool
where
    Grid<N>: Size,
{
    let left = |y, z| maps.row_among((y, z), Grid::<N>::FULL & !rows.row(y, z));
    (0..N).all(|y| (0..N).all(|z| left(y, z).is_empty()))
}

fn write_maps<const N: usize>(to: &mut Writer<'_>, maps: &Maps<N>) {
    for axis in Axis::ALL {
        for line in 0..N {
            let columns = maps.line(axis, line);
            let bytes: [_; N] = array::from_fn(|place| columns[place].0.map(Range::to_bytes));
            to.bytes(bytes.as_flattened().as_flattened());
        }
    }
}

fn read_maps<const N: usize>(from: &mut Reader<'_>, maps: &mut Maps<N>) -> Result<(), BadBytes> {
    for axis in Axis::ALL {
        for line in 0..N {
            for place in 0..N {
                let bad = from.bad("a range within the grid");
                let bytes = [from.u8()?, from.u8()?];
                let range = Range::from_bytes(bytes, N).ok_or(bad)?;
                maps.set_column(axis, (line, place), Column([range]));
            }
        }
    }
    Ok(())
}
