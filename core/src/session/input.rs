//! The input of a tick, as quantised integers of a fixed width.

use glam::{Quat, Vec3};

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::session::hand::RoomPose;
use crate::visit::VisitInput;

/// Ticks in a second.
pub const TICK_RATE: u32 = 72;

/// Number of units of [`RawPose::position`] in a metre.
pub const UNITS_PER_METRE: i32 = 1 << 16;

/// A quantised tracked pose, in OpenXR's conventions: right-handed, y up, metres.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct RawPose {
    /// Position in units of 1/65,536 m (15 micrometres).
    pub position: [i32; 3],
    /// Quaternion x, y, z, w of any length above a thousandth of the range.
    pub rotation: [i16; 4],
}

/// One hand's controller.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct HandInput {
    /// The aim pose; -z is forward.
    pub aim: RawPose,
    /// The grip pose, in the palm.
    pub grip: RawPose,
    /// The trigger, 0 to 255. It counts as pulled from 128 on, until it falls below 96.
    pub trigger: u8,
    /// The squeeze of the grip, 0 to 255.
    pub squeeze: u8,
    /// The stick: x (right) turns the stool, y (forward) enlarges the held bit; -127 to 127.
    pub stick: [i8; 2],
    /// Pressed buttons, bits of [`buttons`]; the highest bit is ignored.
    pub buttons: u8,
    /// `true` if the poses are tracked.
    pub tracked: bool,
}

/// Bits of [`HandInput::buttons`].
pub mod buttons {
    /// The lower button: undo.
    pub const LOWER: u8 = 1;
    /// The upper button: redo.
    pub const UPPER: u8 = 2;
    /// The stick, pressed: symmetry.
    pub const STICK: u8 = 4;
}

/// Bits of [`TickInput::commands`]. Each acts once a tick.
pub mod commands {
    /// Undoes the newest stroke.
    pub const UNDO: u8 = 1;
    /// Redoes the last undone stroke.
    pub const REDO: u8 = 2;
    /// Switches the mirror on or off.
    pub const SYMMETRY: u8 = 4;
    /// Ends the session; the sculpture can't be edited any more.
    pub const FINISH: u8 = 8;
    /// Swaps the tools of the hands, if both are tracked. Ends pulls, strokes and trails: a tool runs again
    /// only after its new hand's trigger is released and pulled.
    pub const SWAP_HANDS: u8 = 16;
}

/// A command from a mouse or a menu instead of a hand.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum PointerCommand {
    /// No command.
    #[default]
    None,
    /// Puts an item of the bench into a hand: a tool, or a bit, which is mounted on the tool that it fits.
    Take {
        /// 0 left, 1 right.
        hand: u8,
        /// The item's [`BenchItem::number`](crate::session::BenchItem::number): tools first, then bits.
        item: u8,
    },
    /// Puts the item in a hand back on the bench.
    Return {
        /// 0 left, 1 right.
        hand: u8,
    },
    /// Turns the stool.
    Turn {
        /// The angle in 65,536ths of a turn, counter-clockwise as seen from above.
        by: i16,
    },
    /// Enlarges or shrinks the bit in a hand, within its size range.
    Resize {
        /// 0 left, 1 right.
        hand: u8,
        /// Number of steps of its [`BitSize`](crate::session::BitSize); negative to shrink.
        by: i8,
    },
    /// Steadies both hands: while a tool runs, its bit is pulled behind the hand on a string.
    Steady {
        /// The string's length, in millimetres of the room, at most
        /// [`MAX_STRING_MM`](crate::limits::MAX_STRING_MM); 0 switches steadying off.
        string_mm: u8,
    },
}

/// Session mode: which volume a session starts from (sections 1.1, 3.3 and 3.5 of the paper).
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum SessionMode {
    /// No session.
    #[default]
    None,
    /// A lump of stone, without a mask.
    FreeForm,
    /// A lump with a hidden figure that can't be removed.
    Constrained {
        /// The figure's index.
        figure: u8,
    },
    /// A shape that is already sculpted.
    Creative,
    /// A volume loaded by the user.
    Own,
}

/// The input of one tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct TickInput {
    /// The pose of the head.
    pub head: RawPose,
    /// Left and right hand.
    pub hands: [HandInput; 2],
    /// The pointer.
    pub pointer: PointerCommand,
    /// Bits of [`commands`].
    pub commands: u8,
    /// Starts a new session, unless [`SessionMode::None`].
    pub start: SessionMode,
    /// The input of the visit state machine.
    pub visit: VisitInput,
}

impl RawPose {
    const BYTES: usize = 20;

    /// Quantises a pose in metres. A pose that isn't finite, or whose rotation is near zero, becomes the
    /// default pose, which the core ignores.
    #[must_use]
    pub fn quantise(position_metres: Vec3, rotation: Quat) -> Self {
        let usable = rotation.is_finite() && rotation.length_squared() > 1e-6;
        if !usable || !position_metres.is_finite() {
            return Self::default();
        }
        let rotation = rotation.normalize();
        let metres = |v: f32| libm::roundf(v * UNITS_PER_METRE as f32) as i32;
        let part = |v: f32| libm::roundf(v * f32::from(i16::MAX)) as i16;
        RawPose {
            position: position_metres.to_array().map(metres),
            rotation: rotation.to_array().map(part),
        }
    }

    /// Returns the position in metres, clamped to 16 m along each axis, and the unit rotation. Returns `None`
    /// if the rotation is near zero.
    #[must_use]
    pub fn to_clamped_metres(&self) -> Option<RoomPose> {
        let far = 16 * UNITS_PER_METRE;
        let position = self.position.map(|v| v.clamp(-far, far) as f32 / UNITS_PER_METRE as f32);
        let q = Quat::from_array(self.rotation.map(f32::from));
        let shortest = f32::from(i16::MAX / 1000);
        (q.length_squared() >= shortest * shortest)
            .then(|| (Vec3::from_array(position), q.normalize()))
    }

    fn write(&self, to: &mut ByteWriter<'_>) {
        self.position.iter().for_each(|v| to.i32(*v));
        self.rotation.iter().for_each(|v| to.i16(*v));
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let mut pose = RawPose::default();
        for v in &mut pose.position {
            *v = from.i32()?;
        }
        for v in &mut pose.rotation {
            *v = from.i16()?;
        }
        Ok(pose)
    }
}

impl HandInput {
    const BYTES: usize = 2 * RawPose::BYTES + 5;

    fn write(&self, to: &mut ByteWriter<'_>) {
        self.aim.write(to);
        self.grip.write(to);
        to.u8(self.trigger);
        to.u8(self.squeeze);
        self.stick.iter().for_each(|v| to.i8(*v));
        to.u8(self.buttons & 0x7f | u8::from(self.tracked) << 7);
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let aim = RawPose::read(from)?;
        let grip = RawPose::read(from)?;
        let (trigger, squeeze) = (from.u8()?, from.u8()?);
        let stick = [from.i8()?, from.i8()?];
        let last = from.u8()?;
        let (buttons, tracked) = (last & 0x7f, last >> 7 != 0);
        Ok(HandInput { aim, grip, trigger, squeeze, stick, buttons, tracked })
    }
}

impl PointerCommand {
    const BYTES: usize = 3;

    fn write(self, to: &mut ByteWriter<'_>) {
        match self {
            PointerCommand::None => to.bytes(&[0, 0, 0]),
            PointerCommand::Take { hand, item } => to.bytes(&[1, hand, item]),
            PointerCommand::Return { hand } => to.bytes(&[2, hand, 0]),
            PointerCommand::Turn { by } => {
                to.u8(3);
                to.i16(by);
            }
            PointerCommand::Resize { hand, by } => to.bytes(&[4, hand, by as u8]),
            PointerCommand::Steady { string_mm } => to.bytes(&[5, string_mm, 0]),
        }
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let bad = from.error_here("a pointer command, 0 to 5, and zeros for what it doesn't take");
        match [from.u8()?, from.u8()?, from.u8()?] {
            [0, 0, 0] => Ok(PointerCommand::None),
            [1, hand, item] => Ok(PointerCommand::Take { hand, item }),
            [2, hand, 0] => Ok(PointerCommand::Return { hand }),
            [3, lo, hi] => Ok(PointerCommand::Turn { by: i16::from_le_bytes([lo, hi]) }),
            [4, hand, by] => Ok(PointerCommand::Resize { hand, by: by as i8 }),
            [5, string_mm, 0] => Ok(PointerCommand::Steady { string_mm }),
            _ => Err(bad),
        }
    }
}

impl SessionMode {
    pub(crate) const BYTES: usize = 2;

    pub(crate) const fn to_bytes(self) -> [u8; 2] {
        match self {
            SessionMode::None => [0, 0],
            SessionMode::FreeForm => [1, 0],
            SessionMode::Constrained { figure } => [2, figure],
            SessionMode::Creative => [3, 0],
            SessionMode::Own => [4, 0],
        }
    }

    pub(crate) const fn from_bytes(bytes: [u8; 2]) -> Option<Self> {
        match bytes {
            [0, 0] => Some(SessionMode::None),
            [1, 0] => Some(SessionMode::FreeForm),
            [2, figure] => Some(SessionMode::Constrained { figure }),
            [3, 0] => Some(SessionMode::Creative),
            [4, 0] => Some(SessionMode::Own),
            _ => None,
        }
    }

    pub(crate) fn write(self, to: &mut ByteWriter<'_>) {
        to.bytes(&self.to_bytes());
    }

    pub(crate) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let bad = from.error_here("a mode, 0 to 4, and a figure for 2 alone");
        SessionMode::from_bytes([from.u8()?, from.u8()?]).ok_or(bad)
    }
}

impl TickInput {
    /// Length of an input in bytes.
    pub const BYTES: usize = RawPose::BYTES
        + 2 * HandInput::BYTES
        + PointerCommand::BYTES
        + 1
        + SessionMode::BYTES
        + VisitInput::BYTES;

    /// Writes [`TickInput::BYTES`] bytes.
    pub fn write(&self, to: &mut ByteWriter<'_>) {
        self.head.write(to);
        self.hands.iter().for_each(|hand| hand.write(to));
        self.pointer.write(to);
        to.u8(self.commands);
        self.start.write(to);
        self.visit.write(to);
    }

    /// Reads the output of [`TickInput::write`].
    ///
    /// # Errors
    /// [`BadBytes`] if the bytes end early, or for an unknown command or mode.
    pub fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let head = RawPose::read(from)?;
        let hands = [HandInput::read(from)?, HandInput::read(from)?];
        let pointer = PointerCommand::read(from)?;
        let commands = from.u8()?;
        let start = SessionMode::read(from)?;
        let visit = VisitInput::read(from)?;
        Ok(TickInput { head, hands, pointer, commands, start, visit })
    }
}
