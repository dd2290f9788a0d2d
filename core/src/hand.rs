//! A hand: its last good poses, what its buttons did, and the tool that follows it.

use glam::{Quat, Vec3};

use crate::codec::{BadBytes, Reader, Writer};
use crate::contact::Contact;
use crate::input::{HandInput, RawPose, buttons};
use crate::pose::Pose;
use crate::tools::BitData;
use crate::workbench::{read_quat, read_vec3, write_quat, write_vec3};

/// A position in metres and a rotation, in the room.
pub type RoomPose = (Vec3, Quat);

/// The state of one hand between ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Hand {
    /// The last good pose of the grip.
    pub grip: RoomPose,
    /// The last good pose of the aim.
    pub aim: RoomPose,
    /// Whether the poses are from this tick.
    pub tracked: bool,
    /// Whether the trigger is pulled.
    pub trigger: bool,
    /// Whether the hand is squeezed.
    pub squeeze: bool,
    /// The buttons as of the last tick.
    pub buttons: u8,
    /// Ticks since the trigger was pulled.
    pub phase: u16,
    /// Where the bit was let go to, in the grid.
    pub frozen: Pose,
    /// Where the bit would be but for the volume, in the grid.
    pub raw: Pose,
    /// Whether `frozen` is of the last tick and this bit, so that a stroke may sweep from it.
    pub sweeps: bool,
    /// Whether `frozen` is of this bit at all, so that it bounds where the bit can go.
    pub bound: bool,
    /// Strength of the pulse of this tick, 0 to 255.
    pub haptic: u8,
}

/// What a hand did in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Did {
    /// Pulled the trigger.
    pub pulled: bool,
    /// Squeezed.
    pub squeezed: bool,
    /// Pressed these buttons.
    pub pressed: u8,
}

impl Hand {
    /// Nowhere: all zero bytes.
    #[must_use]
    #[allow(clippy::new_without_default)] // `const fn new` is the one way these are made
    pub const fn new() -> Self {
        let nowhere = (Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        let pose = Pose { position: nowhere.0, rotation: nowhere.1 };
        Hand {
            grip: nowhere,
            aim: nowhere,
            tracked: false,
            trigger: false,
            squeeze: false,
            buttons: 0,
            phase: 0,
            frozen: pose,
            raw: pose,
            sweeps: false,
            bound: false,
            haptic: 0,
        }
    }

    /// Takes in a tick's input. Poses that can't be used leave the last good ones; without
    /// tracking, nothing is pressed.
    pub fn update(&mut self, input: &HandInput) -> Did {
        self.haptic = 0;
        let keep = |last: &mut RoomPose, pose: &RawPose| {
            pose.metres().inspect(|good| *last = *good).is_some()
        };
        let good = input.tracked && keep(&mut self.grip, &input.grip);
        if input.tracked {
            keep(&mut self.aim, &input.aim);
        }
        self.tracked = good || (input.tracked && self.has_pose());
        let live = u8::from(self.tracked);
        let trigger = past(input.trigger * live, self.trigger);
        let squeeze = past(input.squeeze * live, self.squeeze);
        let down = (input.buttons * live) & (buttons::LOWER | buttons::UPPER | buttons::STICK);
        let did = Did {
            pulled: trigger && !self.trigger,
            squeezed: squeeze && !self.squeeze,
            pressed: down & !self.buttons,
        };
        self.phase = if trigger && self.trigger { self.phase.wrapping_add(1) } else { 0 };
        (self.trigger, self.squeeze, self.buttons) = (trigger, squeeze, down);
        if !self.tracked {
            self.sweeps = false;
        }
        did
    }

    /// The bit's pose in the room, `length` metres in front of the grip.
    #[must_use]
    pub fn tip(&self, length: f32) -> RoomPose {
        let (position, rotation) = self.grip;
        (position + rotation * Vec3::new(0.0, 0.0, -length), rotation)
    }

    /// Another tool or bit: what was frozen bounds nothing any more.
    pub fn forget_bit(&mut self) {
        (self.sweeps, self.bound, self.phase) = (false, false, 0);
    }

    fn has_pose(&self) -> bool {
        self.grip.1.length_squared() > 0.0
    }

    pub(crate) fn write(&self, to: &mut Writer<'_>) {
        for (position, rotation) in [
            self.grip,
            self.aim,
            (self.frozen.position, self.frozen.rotation),
            (self.raw.position, self.raw.rotation),
        ] {
            write_vec3(to, position);
            write_quat(to, rotation);
        }
        let flags = [self.tracked, self.trigger, self.squeeze, self.sweeps, self.bound];
        to.u8(flags.iter().rev().fold(0, |bits, flag| (bits << 1) | u8::from(*flag)));
        to.u8(self.buttons);
        to.u16(self.phase);
        to.u8(self.haptic);
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let (grip, aim) = (read_pose(from)?, read_pose(from)?);
        let (frozen, raw) = (read_pose(from)?, read_pose(from)?);
        let bad = from.bad("flags of a hand");
        let flags = from.u8()?;
        if flags > 31 {
            return Err(bad);
        }
        let flag = |i: u8| flags >> i & 1 != 0;
        Ok(Hand {
            grip,
            aim,
            frozen: Pose { position: frozen.0, rotation: frozen.1 },
            raw: Pose { position: raw.0, rotation: raw.1 },
            tracked: flag(0),
            trigger: flag(1),
            squeeze: flag(2),
            sweeps: flag(3),
            bound: flag(4),
            buttons: from.u8()?,
            phase: from.u16()?,
            haptic: from.u8()?,
        })
    }
}

/// The haptic level of a bit in contact: 0 without contact, growing with speed, highest on the
/// mask; a running tool pulses with its train, one at rest gives a quarter, steadily.
///
/// `speed` is in micrometres a tick.
#[must_use]
pub fn haptic_level(bit: &BitData, contact: &Contact, running: bool, phase: u16, speed: u32) -> u8 {
    if contact.overlap == 0 && !contact.on_mask {
        return 0;
    }
    let strength = if contact.on_mask { 255 } else { 80 + (speed / 250).min(120) };
    let train = match running {
        true => u32::from(bit.train[usize::from(phase) % bit.train.len()]),
        false => 64,
    };
    (strength * train / 255) as u8
}

/// Reads a pose in metres or voxels, none of which is farther off than tracked ones can be.
fn read_pose(from: &mut Reader<'_>) -> Result<RoomPose, BadBytes> {
    let bad = from.bad("a pose within reach, with a unit rotation or none");
    let (position, rotation) = (read_vec3(from)?, read_quat(from)?);
    let near = position.abs().max_element() <= FAR;
    let length = rotation.length_squared();
    if near && (length == 0.0 || (0.99..1.01).contains(&length)) {
        Ok((position, rotation))
    } else {
        Err(bad)
    }
}

/// Beyond what 16 m, turned by the stool, come to in the voxels of the finest grid.
const FAR: f32 = 32_768.0;

/// Whether an analogue button is down: it goes down at half its way and up at three eighths.
const fn past(value: u8, down: bool) -> bool {
    value >= if down { 96 } else { 128 }
}
