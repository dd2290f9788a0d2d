//! A hand between ticks: its last valid poses, its buttons, and the pose of its bit.

use glam::{Quat, Vec3};

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::vectors::{
    QUAT_BYTES, VEC3_BYTES, read_finite_quat, read_vec3, write_quat, write_vec3,
};
use crate::edit::contact::Contact;
use crate::edit::half_space::HalfSpace;
use crate::edit::pose::Pose;
use crate::limits::{FULL_TRIGGER, MAX_TRAIL_POSES, finishing_edits, max_trail_ticks};
use crate::session::input::{HandInput, RawPose, buttons};
use crate::session::stool_frame::turn_about_stool;
use crate::session::tools::ToolBitSpec;
use crate::session::trail::HandTrail;

/// A position in metres and a rotation, in the room.
pub type RoomPose = (Vec3, Quat);

/// The state of one hand between ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HandState {
    /// The last valid pose of the grip.
    pub grip: RoomPose,
    /// The last valid pose of the aim.
    pub aim: RoomPose,
    /// `true` if the poses are from this tick.
    pub tracked: bool,
    /// `true` if the trigger is pulled.
    pub trigger: bool,
    /// `true` if the current or last pull of the trigger never reached [`FULL_TRIGGER`].
    pub is_light: bool,
    /// `true` if the hand is squeezed.
    pub squeeze: bool,
    /// `true` if the trigger is ignored until it is released, because it was pulled when the hands were
    /// swapped.
    pub awaits_release: bool,
    /// `true` if the hand is squeezed and holds the stool's rim.
    pub holds_stool: bool,
    /// The buttons in the last tick.
    pub buttons: u8,
    /// Ticks since the trigger was pulled.
    pub trigger_ticks: u16,
    /// The pose that contact allowed for the bit, in the grid.
    pub frozen_pose: Pose,
    /// The pose requested by the hand, without contact, in the grid: its own, or the pose to which a string
    /// pulls the bit.
    pub raw_pose: Pose,
    /// `true` if `frozen_pose` belongs to the last tick and this bit, so that a brush may be swept from it.
    pub can_sweep: bool,
    /// `true` if `frozen_pose` belongs to this bit, so that its next path starts there.
    pub has_frozen_pose: bool,
    /// Strength of the pulse of this tick, 0 to 255.
    pub haptic: u8,
    /// Ticks of the stick's push along y since it last resized the bit, negative if it is pulled back; 0 at
    /// rest.
    pub resize_push: i8,
    /// The poses of the hand that its running bit has yet to follow, in the grid.
    pub trail: HandTrail,
    /// The half-space above the plane of a float at the last pull, in the grid.
    pub above_float: HalfSpace,
}

/// The rising edges of a hand's controls in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct HandPresses {
    /// The trigger was pulled.
    pub pulled: bool,
    /// The grip was squeezed.
    pub squeezed: bool,
    /// The buttons that were pressed, bits of [`buttons`].
    pub buttons: u8,
    /// The angle by which the hand turned the stool that it holds, in 65,536ths of a turn.
    pub rim_turn: i32,
    /// The number of steps by which the stick enlarges the held bit, negative to shrink it; repeats while the
    /// stick is pushed.
    pub resized_by: i8,
}

impl HandState {
    /// Creates a hand that was never tracked; all zero bytes.
    #[must_use]
    pub(crate) const fn new() -> Self {
        let nowhere = (Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        let pose = Pose { position: nowhere.0, rotation: nowhere.1 };
        HandState {
            grip: nowhere,
            aim: nowhere,
            tracked: false,
            trigger: false,
            is_light: false,
            squeeze: false,
            awaits_release: false,
            holds_stool: false,
            buttons: 0,
            trigger_ticks: 0,
            frozen_pose: pose,
            raw_pose: pose,
            can_sweep: false,
            has_frozen_pose: false,
            haptic: 0,
            resize_push: 0,
            trail: HandTrail::EMPTY,
            above_float: HalfSpace::NOTHING,
        }
    }

    /// Applies a tick's input and returns the presses. Keeps the last valid pose if the new one is invalid.
    /// Without tracking, nothing is pressed.
    pub(crate) fn apply_input(&mut self, input: &HandInput) -> HandPresses {
        self.haptic = 0;
        let keep = |last: &mut RoomPose, pose: &RawPose| {
            pose.to_clamped_metres().inspect(|good| *last = *good).is_some()
        };
        let last_grip = self.grip.0;
        let good = input.tracked && keep(&mut self.grip, &input.grip);
        if input.tracked {
            keep(&mut self.aim, &input.aim);
        }
        self.tracked = good || (input.tracked && self.was_ever_tracked());
        let live = u8::from(self.tracked);
        let was_down = self.trigger || self.awaits_release;
        let is_down = is_pressed_with_hysteresis(input.trigger * live, was_down);
        // The trigger of a hand that isn't tracked is unknown.
        self.awaits_release &= is_down || !self.tracked;
        let trigger = is_down && !self.awaits_release;
        let squeeze = is_pressed_with_hysteresis(input.squeeze * live, self.squeeze);
        self.holds_stool &= squeeze;
        let down = (input.buttons * live) & (buttons::LOWER | buttons::UPPER | buttons::STICK);
        let direction =
            if self.tracked { resize_direction(input.stick, self.resize_push.signum()) } else { 0 };
        self.resize_push = next_resize_push(self.resize_push, direction);
        let presses = HandPresses {
            rim_turn: if self.holds_stool { turn_about_stool(last_grip, self.grip.0) } else { 0 },
            pulled: trigger && !self.trigger,
            squeezed: squeeze && !self.squeeze,
            buttons: down & !self.buttons,
            resized_by: if self.resize_push == direction { direction } else { 0 },
        };
        if trigger {
            self.is_light = (presses.pulled || self.is_light) && input.trigger < FULL_TRIGGER;
        }
        self.trigger_ticks =
            if trigger && self.trigger { self.trigger_ticks.wrapping_add(1) } else { 0 };
        (self.trigger, self.squeeze, self.buttons) = (trigger, squeeze, down);
        if !self.tracked {
            self.can_sweep = false;
            self.drop_trail();
        }
        presses
    }

    /// Returns `true` if a tool in this hand runs: its trigger is pulled, or it finishes the trail of the
    /// last pull.
    #[must_use]
    pub const fn is_running(&self) -> bool {
        self.trigger || !self.trail.is_empty()
    }

    /// Drops the rest of the trail uncut.
    pub(crate) const fn drop_trail(&mut self) {
        self.trail = HandTrail::EMPTY;
    }

    /// Appends the pose requested by the hand to the trail that its bit is to cut. A new pull, or a bit that
    /// catches up after a gap, begins a new trail. Returns how many ticks of the trail were dropped.
    ///
    /// A file has no trail: it is moved straight to the hand's position.
    pub(crate) fn note_way(&mut self, raw: Pose, is_new_pull: bool, bit: &ToolBitSpec) -> u32 {
        if is_new_pull || !self.can_sweep {
            self.drop_trail();
        }
        match self.trigger && !bit.action.is_rubbing() {
            true => self.trail.push_and_drop_beyond(raw, max_trail_ticks(bit.bite_period)),
            false => 0,
        }
    }

    /// Returns the pose requested by a hand at `wanted`. While its tool runs, the bit is pulled behind it on
    /// a string, the painters' *pulled string*: it doesn't move while the string is slack, so trembling
    /// shorter than the string has no effect. A new pull of the trigger starts at the hand's own pose.
    pub(crate) fn drawn_pose(&self, wanted: Pose, is_new_pull: bool, string_voxels: f32) -> Pose {
        let is_drawn = self.trigger && !is_new_pull && self.has_frozen_pose;
        let behind = self.raw_pose.position - wanted.position;
        let distance = behind.length();
        match is_drawn && string_voxels > 0.0 && distance > 0.0 {
            true if distance <= string_voxels => {
                Pose { position: self.raw_pose.position, ..wanted }
            }
            true => {
                let position = wanted.position + behind * (string_voxels / distance);
                Pose { position, ..wanted }
            }
            false => wanted,
        }
    }

    /// Records the pose of a file's last edit, from which its next edit is swept, once for each edit that it
    /// makes there after its release.
    pub(crate) fn note_smoothed_pose(&mut self) {
        self.drop_trail();
        for _ in 0..finishing_edits(self.is_light) {
            self.trail.push_and_drop_beyond(self.frozen_pose, MAX_TRAIL_POSES);
        }
    }

    /// Returns the pose of the bit's centre in the room, `tool_length_metres` in front of the grip.
    #[must_use]
    pub fn bit_centre_pose(&self, tool_length_metres: f32) -> RoomPose {
        let (position, rotation) = self.grip;
        (position + rotation * Vec3::new(0.0, 0.0, -tool_length_metres), rotation)
    }

    /// Ends a pull: the tool in this hand runs again only after the trigger is released and pulled.
    pub(crate) const fn end_pull(&mut self) {
        self.invalidate_bit_pose();
        self.awaits_release |= self.trigger;
        self.trigger = false;
    }

    /// Invalidates the frozen pose, after a change of tool or bit.
    pub(crate) const fn invalidate_bit_pose(&mut self) {
        (self.can_sweep, self.has_frozen_pose, self.trigger_ticks) = (false, false, 0);
        self.drop_trail();
    }

    fn was_ever_tracked(&self) -> bool {
        self.grip.1.length_squared() > 0.0
    }

    /// Length of a serialised hand: four poses, flags, buttons, phase, haptics, the stick's push, trail and
    /// plane.
    pub(crate) const BYTES: usize =
        4 * (VEC3_BYTES + QUAT_BYTES) + 1 + 1 + 2 + 1 + 1 + HandTrail::BYTES + HalfSpace::BYTES;

    pub(crate) fn write(&self, to: &mut ByteWriter<'_>) {
        for (position, rotation) in [
            self.grip,
            self.aim,
            (self.frozen_pose.position, self.frozen_pose.rotation),
            (self.raw_pose.position, self.raw_pose.rotation),
        ] {
            write_vec3(to, position);
            write_quat(to, rotation);
        }
        let flags = [
            self.tracked,
            self.trigger,
            self.squeeze,
            self.can_sweep,
            self.has_frozen_pose,
            self.is_light,
            self.awaits_release,
            self.holds_stool,
        ];
        to.u8(flags.iter().rev().fold(0, |bits, flag| (bits << 1) | u8::from(*flag)));
        to.u8(self.buttons);
        to.u16(self.trigger_ticks);
        to.u8(self.haptic);
        to.u8(self.resize_push as u8);
        self.trail.write(to);
        self.above_float.write(to);
    }

    pub(crate) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let (grip, aim) = (read_pose(from)?, read_pose(from)?);
        let (frozen, raw) = (read_pose(from)?, read_pose(from)?);
        let bad = from.error_here("flags of a hand");
        let flags = from.u8()?;
        let flag = |i: u8| flags >> i & 1 != 0;
        let [trigger, squeeze, awaits_release, holds_stool] = [1, 2, 6, 7].map(flag);
        let has_frozen_pose = flag(4);
        let is_impossible = awaits_release && trigger || holds_stool && !squeeze;
        if is_impossible || has_frozen_pose && frozen.1.length_squared() == 0.0 {
            return Err(bad);
        }
        let (buttons, trigger_ticks, haptic) = (from.u8()?, from.u16()?, from.u8()?);
        let bad = from.error_here("ticks of a stick's push, 18 at most");
        let resize_push = from.u8()? as i8;
        if resize_push.unsigned_abs() > RESIZE_PERIOD.unsigned_abs() {
            return Err(bad);
        }
        Ok(HandState {
            grip,
            aim,
            frozen_pose: Pose { position: frozen.0, rotation: frozen.1 },
            raw_pose: Pose { position: raw.0, rotation: raw.1 },
            tracked: flag(0),
            trigger,
            squeeze,
            awaits_release,
            holds_stool,
            can_sweep: flag(3),
            has_frozen_pose,
            is_light: flag(5),
            buttons,
            trigger_ticks,
            haptic,
            resize_push,
            trail: HandTrail::read(from)?,
            above_float: HalfSpace::read(from)?,
        })
    }
}

/// Returns the haptic amplitude of a bit, 0 to 255: 0 without contact, growing with speed, highest on the
/// mask. A running tool pulses with its haptic train; at rest a quarter of the amplitude is constant.
#[must_use]
pub fn haptic_amplitude(
    bit: &ToolBitSpec,
    contact: &Contact,
    is_running: bool,
    trigger_ticks: u16,
    speed_um_per_tick: u32,
) -> u8 {
    if contact.overlap == 0 && !contact.on_mask {
        return 0;
    }
    let strength = if contact.on_mask { 255 } else { 80 + (speed_um_per_tick / 250).min(120) };
    let train = match is_running {
        true => u32::from(bit.haptic_train[usize::from(trigger_ticks) % bit.haptic_train.len()]),
        false => 64,
    };
    (strength * train / 255) as u8
}

/// Reads a pose in metres or voxels, with coordinates up to [`FAR`].
pub(crate) fn read_pose(from: &mut ByteReader<'_>) -> Result<RoomPose, BadBytes> {
    let bad = from.error_here("a pose within reach, with a unit rotation or none");
    let (position, rotation) = (read_vec3(from)?, read_finite_quat(from)?);
    let near = position.abs().max_element() <= FAR;
    let length = rotation.length_squared();
    if near && (length == 0.0 || (0.99..1.01).contains(&length)) {
        Ok((position, rotation))
    } else {
        Err(bad)
    }
}

/// Maximum coordinate of a pose: more than 16 m in voxels of the finest grid.
const FAR: f32 = 32_768.0;

/// Returns `true` if an analogue button is pressed, with hysteresis: on from 128, off below 96 of 255.
const fn is_pressed_with_hysteresis(value: u8, was_pressed: bool) -> bool {
    value >= if was_pressed { 96 } else { 128 }
}

/// Ticks between two steps of a bit's size while the stick is pushed: from half to double takes two seconds.
const RESIZE_PERIOD: i8 = 18;

/// Returns the direction in which the stick resizes a bit: 1 to enlarge, -1 to shrink, 0 for neither. A push
/// begins at three quarters of the stick's travel along y, if that exceeds its travel along x, which turns
/// the stool. It ends below half.
const fn resize_direction([x, y]: [i8; 2], last_direction: i8) -> i8 {
    let goes_on = y.signum() == last_direction && y.unsigned_abs() >= 64;
    let begins = y.unsigned_abs() >= 96 && y.unsigned_abs() > x.unsigned_abs();
    if goes_on || begins { y.signum() } else { 0 }
}

/// Returns the tick count of a push in this direction that follows `push`: it cycles from 1 to
/// [`RESIZE_PERIOD`].
const fn next_resize_push(push: i8, direction: i8) -> i8 {
    let goes_on = push.signum() == direction && push.unsigned_abs() < RESIZE_PERIOD as u8;
    if goes_on { push + direction } else { direction }
}
