//! The small part of a world's state: everything except volumes, undo history and island search. It is
//! written as bytes of a fixed length, from which its digest is computed.

use glam::{Quat, Vec3};

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::digest::checksum;
use crate::codec::vectors::{QUAT_BYTES, VEC3_BYTES, write_quat, write_vec3};
use crate::limits::{MAX_STRING_MM, STATE_BYTES};
use crate::session::bared::ToldPart;
use crate::session::hand::{HandState, RoomPose, read_pose};
use crate::session::input::SessionMode;
use crate::session::workbench::Workbench;
use crate::visit::Visit;

/// The phase of a session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum SessionState {
    /// No session yet; nothing can be taken or edited.
    Waiting = 0,
    /// Tools can be taken and the sculpture edited.
    Sculpting = 1,
    /// The sculpture is final.
    Finished = 2,
}

impl SessionState {
    /// Returns the state with this number.
    pub(crate) const fn from_number(number: u8) -> Option<Self> {
        match number {
            0 => Some(SessionState::Waiting),
            1 => Some(SessionState::Sculpting),
            2 => Some(SessionState::Finished),
            _ => None,
        }
    }
}

/// The state of a world except volumes, undo history and island search.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct WorldState {
    pub(crate) tick: u64,
    pub(crate) session: SessionState,
    pub(crate) mode: SessionMode,
    pub(crate) masked: bool,
    pub(crate) symmetry: bool,
    /// The number of axes of the hidden figure whose ends are counted.
    pub(crate) counted_axes: u8,
    /// The part of the hidden figure that was last reported as bared.
    pub(crate) told: ToldPart,
    /// The length of the string on which running bits are pulled behind their hands; 0 without a string.
    pub(crate) string_mm: u8,
    /// The stool's rotation in 65,536ths of a turn.
    pub(crate) stool: u16,
    pub(crate) head: RoomPose,
    pub(crate) hands: [HandState; 2],
    pub(crate) bench: Workbench,
    pub(crate) mask_digest: u64,
    pub(crate) visit: Visit,
}

impl WorldState {
    pub(crate) const fn new() -> Self {
        let quat = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        WorldState {
            tick: 0,
            session: SessionState::Waiting,
            mode: SessionMode::None,
            masked: false,
            symmetry: false,
            counted_axes: 0,
            told: ToldPart::NONE,
            string_mm: 0,
            stool: 0,
            head: (Vec3::ZERO, quat),
            hands: [HandState::new(); 2],
            bench: Workbench::new(),
            mask_digest: 0,
            visit: Visit::new(),
        }
    }

    /// Length of a serialised state, the sum of its fields in the order of [`WorldState::write`].
    const BYTES: usize = size_of::<u64>()
        + size_of::<u8>()
        + SessionMode::BYTES
        + size_of::<u8>()
        + size_of::<u8>()
        + size_of::<u16>()
        + (VEC3_BYTES + QUAT_BYTES)
        + 2 * HandState::BYTES
        + Workbench::BYTES
        + Visit::BYTES
        + size_of::<u64>();

    pub(crate) fn digest(&self) -> u64 {
        const { assert!(WorldState::BYTES == STATE_BYTES, "STATE_BYTES is not what a state takes") };
        let mut bytes = [0; STATE_BYTES];
        let mut to = ByteWriter::new(&mut bytes);
        self.write(&mut to);
        debug_assert_eq!(to.len(), STATE_BYTES, "a part of the state is left out of its digest");
        checksum(&bytes)
    }

    pub(crate) fn write(&self, to: &mut ByteWriter<'_>) {
        to.u64(self.tick);
        to.u8(self.session as u8);
        self.mode.write(to);
        let flags = u8::from(self.masked) | u8::from(self.symmetry) << 1;
        to.u8(flags | self.counted_axes << 2 | self.told.number() << 4);
        to.u8(self.string_mm);
        to.u16(self.stool);
        write_vec3(to, self.head.0);
        write_quat(to, self.head.1);
        self.hands.iter().for_each(|hand| hand.write(to));
        self.bench.write(to);
        self.visit.write(to);
        to.u64(self.mask_digest);
    }

    pub(crate) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let tick = from.u64()?;
        let bad = from.error_here("a session, 0 to 2");
        let session = SessionState::from_number(from.u8()?).ok_or(bad)?;
        let mode = SessionMode::read(from)?;
        let bad =
            from.error_here("flags of a session, and what was told of a figure if it has one");
        let flags = from.u8()?;
        let counted_axes = flags >> 2 & 3;
        let is_told = |told: &ToldPart| counted_axes == 3 || *told == ToldPart::NONE;
        let told = ToldPart::from_number(flags >> 4).filter(is_told).ok_or(bad)?;
        if counted_axes > 0 && flags & 1 == 0 {
            return Err(bad);
        }
        let bad = from.error_here("a string's millimetres, 40 at most");
        let string_mm = from.u8()?;
        if string_mm > MAX_STRING_MM {
            return Err(bad);
        }
        Ok(WorldState {
            tick,
            session,
            mode,
            masked: flags & 1 != 0,
            symmetry: flags & 2 != 0,
            counted_axes,
            told,
            string_mm,
            stool: from.u16()?,
            head: read_pose(from)?,
            hands: [HandState::read(from)?, HandState::read(from)?],
            bench: Workbench::read(from)?,
            visit: Visit::read(from)?,
            mask_digest: from.u64()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_fills_its_bytes_and_comes_back_from_them() {
        let mut state = WorldState::new();
        (state.tick, state.stool, state.mask_digest) = (7, 40_000, u64::MAX);
        state.bench.reset_items();
        let mut bytes = [0; STATE_BYTES];
        let mut to = ByteWriter::new(&mut bytes);
        state.write(&mut to);
        assert_eq!(to.len(), STATE_BYTES);
        let mut from = ByteReader::new(&bytes);
        assert_eq!(WorldState::read(&mut from), Ok(state));
        assert_eq!(from.expect_end(), Ok(()));
        for i in 0..STATE_BYTES {
            let mut other = bytes;
            other[i] ^= 1;
            assert_ne!(checksum(&other), state.digest(), "byte {i} is not in the digest");
        }
    }
}
