//! What a shell tells the core each tick: quantised integers of a fixed width.

use glam::{Quat, Vec3};

use crate::codec::{BadBytes, Reader, Writer};

/// Ticks in a second.
pub const TICK_RATE: u32 = 72;

/// Units of [`RawPose::position`] in a metre.
pub const METRE: i32 = 1 << 16;

/// A pose as tracked: metres and a rotation, quantised. Right-handed, y up; OpenXR's conventions.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct RawPose {
    /// In 1/65,536 m (15 micrometres).
    pub position: [i32; 3],
    /// Quaternion x, y, z, w; any length from a thousandth of the range up.
    pub rotation: [i16; 4],
}

/// One hand's controller.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct HandInput {
    /// Where it points: -z is forward.
    pub aim: RawPose,
    /// Where its palm is.
    pub grip: RawPose,
    /// 0 to 255.
    pub trigger: u8,
    /// 0 to 255.
    pub squeeze: u8,
    /// x (right) and y (forward), -127 to 127.
    pub stick: [i8; 2],
    /// Pressed buttons, of [`buttons`]; the highest bit is not kept.
    pub buttons: u8,
    /// Whether the poses are to be believed.
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

/// Bits of [`Input::commands`]. Each acts once a tick.
pub mod commands {
    /// Take the newest stroke back.
    pub const UNDO: u8 = 1;
    /// Bring it back again.
    pub const REDO: u8 = 2;
    /// Switch the mirror on or off.
    pub const SYMMETRY: u8 = 4;
    /// End the session; the sculpture takes no more edits.
    pub const FINISH: u8 = 8;
}

/// What a pointer (a mouse, a menu) does instead of a hand.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Pointer {
    /// Nothing.
    #[default]
    None,
    /// Puts an item of the bench into a hand.
    Take {
        /// 0 left, 1 right.
        hand: u8,
        /// Number of the item: tools first, then bits.
        item: u8,
    },
    /// Puts what a hand holds back on the bench.
    Return {
        /// 0 left, 1 right.
        hand: u8,
    },
    /// Turns the stool by 1/65,536 turns.
    Turn {
        /// Counter-clockwise as seen from above.
        by: i16,
    },
}

/// How a session starts (sections 1.1, 3.3 and 3.5 of the paper).
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Mode {
    /// No session.
    #[default]
    None,
    /// From a lump of stone, freely.
    FreeForm,
    /// From the lump, with a hidden figure that can't be removed.
    Constrained {
        /// Number of the figure.
        figure: u8,
    },
    /// From an already sculpted shape.
    Creative,
    /// From a volume of one's own.
    Own,
}

/// Everything a tick depends on, but for the state and the start volumes.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Input {
    /// The head.
    pub head: RawPose,
    /// Left and right hand.
    pub hands: [HandInput; 2],
    /// The pointer.
    pub pointer: Pointer,
    /// Of [`commands`].
    pub commands: u8,
    /// Starts a session anew, unless [`Mode::None`].
    pub start: Mode,
}

impl RawPose {
    const BYTES: usize = 20;

    /// Quantises a pose in metres. One that is not finite, or whose rotation has no direction,
    /// becomes the default pose, which the core passes over.
    #[must_use]
    pub fn new(position: Vec3, rotation: Quat) -> Self {
        let usable = rotation.is_finite() && rotation.length_squared() > 1e-6;
        if !usable || !position.is_finite() {
            return Self::default();
        }
        let rotation = rotation.normalize();
        let metres = |v: f32| libm::roundf(v * METRE as f32) as i32;
        let part = |v: f32| libm::roundf(v * f32::from(i16::MAX)) as i16;
        RawPose {
            position: position.to_array().map(metres),
            rotation: rotation.to_array().map(part),
        }
    }

    /// Position in metres and unit rotation; `None` where the rotation has no direction. Positions
    /// are held within 16 m of the origin.
    #[must_use]
    pub fn metres(&self) -> Option<(Vec3, Quat)> {
        let far = 16 * METRE;
        let position = self.position.map(|v| v.clamp(-far, far) as f32 / METRE as f32);
        let q = Quat::from_array(self.rotation.map(f32::from));
        let shortest = f32::from(i16::MAX / 1000);
        (q.length_squared() >= shortest * shortest)
            .then(|| (Vec3::from_array(position), q.normalize()))
    }

    fn write(&self, to: &mut Writer<'_>) {
        self.position.iter().for_each(|v| to.i32(*v));
        self.rotation.iter().for_each(|v| to.i16(*v));
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
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

    fn write(&self, to: &mut Writer<'_>) {
        self.aim.write(to);
        self.grip.write(to);
        to.u8(self.trigger);
        to.u8(self.squeeze);
        self.stick.iter().for_each(|v| to.i8(*v));
        to.u8(self.buttons & 0x7f | u8::from(self.tracked) << 7);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let aim = RawPose::read(from)?;
        let grip = RawPose::read(from)?;
        let (trigger, squeeze) = (from.u8()?, from.u8()?);
        let stick = [from.i8()?, from.i8()?];
        let last = from.u8()?;
        let (buttons, tracked) = (last & 0x7f, last >> 7 != 0);
        Ok(HandInput { aim, grip, trigger, squeeze, stick, buttons, tracked })
    }
}

impl Pointer {
    const BYTES: usize = 3;

    fn write(self, to: &mut Writer<'_>) {
        match self {
            Pointer::None => to.bytes(&[0, 0, 0]),
            Pointer::Take { hand, item } => to.bytes(&[1, hand, item]),
            Pointer::Return { hand } => to.bytes(&[2, hand, 0]),
            Pointer::Turn { by } => {
                to.u8(3);
                to.i16(by);
            }
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let bad = from.bad("a pointer command, 0 to 3, and zeros for what it doesn't take");
        match [from.u8()?, from.u8()?, from.u8()?] {
            [0, 0, 0] => Ok(Pointer::None),
            [1, hand, item] => Ok(Pointer::Take { hand, item }),
            [2, hand, 0] => Ok(Pointer::Return { hand }),
            [3, lo, hi] => Ok(Pointer::Turn { by: i16::from_le_bytes([lo, hi]) }),
            _ => Err(bad),
        }
    }
}

impl Mode {
    const BYTES: usize = 2;

    pub(crate) fn write(self, to: &mut Writer<'_>) {
        to.bytes(&match self {
            Mode::None => [0, 0],
            Mode::FreeForm => [1, 0],
            Mode::Constrained { figure } => [2, figure],
            Mode::Creative => [3, 0],
            Mode::Own => [4, 0],
        });
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let bad = from.bad("a mode, 0 to 4, and a figure for 2 alone");
        match [from.u8()?, from.u8()?] {
            [0, 0] => Ok(Mode::None),
            [1, 0] => Ok(Mode::FreeForm),
            [2, figure] => Ok(Mode::Constrained { figure }),
            [3, 0] => Ok(Mode::Creative),
            [4, 0] => Ok(Mode::Own),
            _ => Err(bad),
        }
    }
}

impl Input {
    /// Length of an input in bytes.
    pub const BYTES: usize =
        RawPose::BYTES + 2 * HandInput::BYTES + Pointer::BYTES + 1 + Mode::BYTES;

    /// Writes [`Input::BYTES`] bytes.
    pub fn write(&self, to: &mut Writer<'_>) {
        self.head.write(to);
        self.hands.iter().for_each(|hand| hand.write(to));
        self.pointer.write(to);
        to.u8(self.commands);
        self.start.write(to);
    }

    /// Reads what [`Input::write`] wrote.
    ///
    /// # Errors
    /// [`BadBytes`] at the end, or where there is no such command or mode.
    pub fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let head = RawPose::read(from)?;
        let hands = [HandInput::read(from)?, HandInput::read(from)?];
        let pointer = Pointer::read(from)?;
        let commands = from.u8()?;
        let start = Mode::read(from)?;
        Ok(Input { head, hands, pointer, commands, start })
    }
}
