//! The small part of a world's state, all but volumes, undo and islands, as bytes and as a digest.

use glam::{Quat, Vec3};

use crate::codec::{BadBytes, Reader, Writer};
use crate::hand::{Hand, RoomPose};
use crate::input::Mode;
use crate::save::checksum;
use crate::workbench::{Workbench, read_quat, read_vec3, write_quat, write_vec3};
use crate::world::Session;

/// The small part of the state: all but volumes, undo and islands.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct State {
    pub(crate) tick: u64,
    pub(crate) session: Session,
    pub(crate) mode: Mode,
    pub(crate) masked: bool,
    pub(crate) symmetry: bool,
    /// The stool's turn in 65,536ths.
    pub(crate) stool: u16,
    pub(crate) head: RoomPose,
    pub(crate) hands: [Hand; 2],
    pub(crate) bench: Workbench,
    pub(crate) mask_digest: u64,
}

impl State {
    pub(crate) const fn new() -> Self {
        let quat = Quat::from_xyzw(0.0, 0.0, 0.0, 0.0);
        State {
            tick: 0,
            session: Session::Waiting,
            mode: Mode::None,
            masked: false,
            symmetry: false,
            stool: 0,
            head: (Vec3::ZERO, quat),
            hands: [Hand::new(); 2],
            bench: Workbench::new(),
            mask_digest: 0,
        }
    }

    /// Room for a written state.
    const ROOM: usize = 1024;

    pub(crate) fn digest(&self) -> u64 {
        let mut bytes = [0; Self::ROOM];
        let mut to = Writer::new(&mut bytes);
        self.write(&mut to);
        debug_assert!(to.fits());
        let len = to.len().min(Self::ROOM);
        checksum(&bytes[..len])
    }

    pub(crate) fn write(&self, to: &mut Writer<'_>) {
        to.u64(self.tick);
        to.u8(self.session as u8);
        self.mode.write(to);
        to.u8(u8::from(self.masked) | u8::from(self.symmetry) << 1);
        to.u16(self.stool);
        write_vec3(to, self.head.0);
        write_quat(to, self.head.1);
        self.hands.iter().for_each(|hand| hand.write(to));
        self.bench.write(to);
        to.u64(self.mask_digest);
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let tick = from.u64()?;
        let bad = from.bad("a session, 0 to 2");
        let session = match from.u8()? {
            0 => Session::Waiting,
            1 => Session::Sculpting,
            2 => Session::Finished,
            _ => return Err(bad),
        };
        let mode = Mode::read(from)?;
        let bad = from.bad("flags of a session");
        let flags = from.u8()?;
        if flags > 3 {
            return Err(bad);
        }
        Ok(State {
            tick,
            session,
            mode,
            masked: flags & 1 != 0,
            symmetry: flags & 2 != 0,
            stool: from.u16()?,
            head: (read_vec3(from)?, read_quat(from)?),
            hands: [Hand::read(from)?, Hand::read(from)?],
            bench: Workbench::read(from)?,
            mask_digest: from.u64()?,
        })
    }
}
