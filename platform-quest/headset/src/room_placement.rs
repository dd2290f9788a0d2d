//! Placement of the room: for each visitor the room is turned and moved so that the stool is in front of
//! them, wherever in the real room they stand or sit. The floor stays where it is, or, if enabled, is moved
//! by a [`HeightStep`].
//!
//! The runtime's own "ahead" is that of the last recentring. Here the head decides: once it is tracked,
//! steady and about level, the room's origin goes below it, and the stool, which the core has on the -z axis,
//! ahead of it.

#[cfg(test)]
mod reach;
#[cfg(test)]
mod tests;

use core::f32::consts::PI;

use glam::{Quat, Vec2, Vec3};
use paros_core::internals::RoomPose;
use paros_core::session::TICK_RATE;

use paros_shell::headset::height_step::HeightStep;

/// The room's place in the runtime's space: turned about the vertical, moved along the floor, and raised by a
/// step.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct RoomTransform {
    /// The rotation, counter-clockwise as seen from above, in radians.
    pub yaw: f32,
    /// The room's origin in the runtime's space, x and z, in metres.
    pub origin: Vec2,
    /// The height of the room's floor.
    pub height: HeightStep,
}

/// The condition under which the room must move.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum PlacementNeed {
    /// If the visitor is too far from the stool's place or turned away: a step, or a glance aside.
    IfFar,
    /// In any case, as another visitor has come.
    Anyhow,
}

/// Decides where the room lies. Time is measured in ticks.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct RoomPlacement {
    room: RoomTransform,
    search: Option<HeadSearch>,
    /// `true` if the room's height is chosen too.
    snaps_heights: bool,
    /// `true` after a head has chosen the height: only another visitor's head, or a recentring by the staff,
    /// chooses it again.
    has_height: bool,
}

/// The search for a head pose that can place the room.
#[derive(Clone, Copy, PartialEq, Debug)]
struct HeadSearch {
    need: PlacementNeed,
    /// The number of ticks in which a head was tracked.
    seen_ticks: u32,
    /// The number of ticks for which the head has stayed near `anchor`.
    steady_ticks: u32,
    anchor: RoomPose,
}

/// The number of ticks for which a head must be steady before the room is placed: half a second. While a
/// headset is put on, it is turned about for longer.
const STEADY_TICKS: u32 = TICK_RATE / 2;

/// The number of tracked ticks after which any head will do: five seconds. Visitors who look at their feet
/// for so long need a stool in front of them, too.
const PATIENCE_TICKS: u32 = 5 * TICK_RATE;

/// The limits of a steady head's movement and rotation.
const STEADY_METRES: f32 = 0.1;
const STEADY_RADIANS: f32 = PI / 18.0;

/// The sines of the largest pitch (40 degrees) and roll (25 degrees) of a level head.
const LEVEL_PITCH_SINE: f32 = 0.64;
const LEVEL_ROLL_SINE: f32 = 0.42;

/// The range of eye heights of seated and standing people, including children and tall people, in metres
/// above the floor. A headset on a low table or in a raised hand is outside.
const EYE_HEIGHTS: core::ops::Range<f32> = 0.8..2.3;

/// The distance from the origin, in metres, beyond which a head is a tracking error.
const FARTHEST: f32 = 100.0;

/// The sine of the pitch from which a head looks straight up or down: 75 degrees.
const STEEP_PITCH_SINE: f32 = 0.966;

/// The distance and angle from the ideal place within which the room isn't moved: a step and a glance.
const NEAR_METRES: f32 = 0.4;
const NEAR_RADIANS: f32 = PI / 6.0;

impl RoomTransform {
    /// Returns the transform that places the room's origin below a head, given in the runtime's space, and
    /// lets the head face along the room's -z axis. `None` if the head has no heading or its pose is invalid.
    #[must_use]
    pub fn before_head(head_in_runtime: RoomPose) -> Option<Self> {
        let (position, rotation) = head_in_runtime;
        if !position.is_finite() || position.abs().max_element() > FARTHEST {
            return None;
        }
        Some(RoomTransform {
            yaw: find_heading(rotation)?,
            origin: Vec2::new(position.x, position.z),
            height: HeightStep::Middle,
        })
    }

    /// Returns the room's rotation in the runtime's space.
    #[must_use]
    pub fn rotation(self) -> Quat {
        Quat::from_rotation_y(self.yaw)
    }

    /// Returns the room's origin in the runtime's space, in metres.
    #[must_use]
    pub const fn translation(self) -> Vec3 {
        Vec3::new(self.origin.x, self.height.offset_metres(), self.origin.y)
    }

    /// Converts a pose from the room to the runtime's space.
    #[must_use]
    pub fn to_runtime(self, (position, rotation): RoomPose) -> RoomPose {
        (self.rotation() * position + self.translation(), self.rotation() * rotation)
    }

    /// Converts a pose from the runtime's space to the room.
    #[must_use]
    pub fn to_room(self, (position, rotation): RoomPose) -> RoomPose {
        let back = self.rotation().conjugate();
        (back * (position - self.translation()), back * rotation)
    }
}

impl RoomPlacement {
    /// Creates a room at the origin of the runtime's space. If `snaps_heights`, the head that places the room
    /// also chooses a height step; otherwise the height stays.
    #[must_use]
    pub fn new(snaps_heights: bool) -> Self {
        RoomPlacement { snaps_heights, ..RoomPlacement::default() }
    }

    /// Returns the room's place.
    #[must_use]
    pub const fn room(&self) -> RoomTransform {
        self.room
    }

    /// Requests that the next suitable head places the room. Of two requests the stronger counts.
    pub fn request(&mut self, need: PlacementNeed) {
        let need = self.search.map_or(need, |search| search.need.max(need));
        let anchor = (Vec3::ZERO, Quat::IDENTITY);
        self.search = Some(HeadSearch { need, seen_ticks: 0, steady_ticks: 0, anchor });
    }

    /// Restarts in a new space of the runtime, after a recentring or with a new session. The room moves to
    /// the new space's origin and keeps its height, until a head that is far from it places it again. Returns
    /// the new place if it differs from the old one.
    pub fn restart_in_new_space(&mut self) -> Option<RoomTransform> {
        self.request(PlacementNeed::IfFar);
        let there = RoomTransform { height: self.room.height, ..RoomTransform::default() };
        (core::mem::replace(&mut self.room, there) != there).then_some(there)
    }

    /// Observes the head's pose in the room at a tick; `None` if the head is not tracked, or the headset not
    /// worn. Returns the room's new place if it must move.
    pub fn observe_head(&mut self, head_in_room: Option<RoomPose>) -> Option<RoomTransform> {
        let search = self.search.as_mut()?;
        let Some(head) = head_in_room else {
            search.steady_ticks = 0;
            return None;
        };
        // The height of the eyes is measured from the real floor, not from the room's.
        let in_runtime = self.room.to_runtime(head);
        let room = RoomTransform::before_head(in_runtime)?;
        if !search.is_head_found(in_runtime) {
            return None;
        }
        let need = search.need;
        self.search = None;
        let height = self.choose_height(need, in_runtime.0.y);
        let is_near = RoomTransform::before_head(head).is_some_and(RoomTransform::is_near_identity);
        if need == PlacementNeed::IfFar && is_near && height == self.room.height {
            return None;
        }
        self.room = RoomTransform { height, ..room };
        Some(self.room)
    }

    /// Returns the room's height from now on. It stays the same during a visit: nothing lifts the visitor.
    fn choose_height(&mut self, need: PlacementNeed, eyes: f32) -> HeightStep {
        let is_chosen = self.has_height && need == PlacementNeed::IfFar;
        if is_chosen || !self.snaps_heights || !EYE_HEIGHTS.contains(&eyes) {
            return self.room.height;
        }
        self.has_height = true;
        HeightStep::for_eyes(eyes)
    }
}

impl HeadSearch {
    /// Returns `true` if this head, whose pose is finite, was steady for long enough, or the patience has
    /// ended.
    fn is_head_found(&mut self, head: RoomPose) -> bool {
        let (position, rotation) = head;
        let (before, turned) = self.anchor;
        self.seen_ticks += 1;
        let is_steady = before.distance(position) < STEADY_METRES
            && turned.angle_between(rotation) < STEADY_RADIANS;
        if !is_steady || !is_level_at_eye_height(head) {
            (self.anchor, self.steady_ticks) = (head, 0);
        }
        self.steady_ticks += 1;
        self.steady_ticks >= STEADY_TICKS || self.seen_ticks >= PATIENCE_TICKS
    }
}

impl RoomTransform {
    fn is_near_identity(self) -> bool {
        self.origin.length() < NEAR_METRES && self.yaw.abs() < NEAR_RADIANS
    }
}

/// Returns `true` if a head looks about level, and is at the height of people's eyes.
fn is_level_at_eye_height((position, rotation): RoomPose) -> bool {
    let (ahead, right) = (rotation * Vec3::NEG_Z, rotation * Vec3::X);
    EYE_HEIGHTS.contains(&position.y)
        && ahead.y.abs() < LEVEL_PITCH_SINE
        && right.y.abs() < LEVEL_ROLL_SINE
        && (rotation * Vec3::Y).y > 0.0
}

/// Returns the yaw of a head, in radians. If the head looks straight up or down, the axis through its ears
/// gives the yaw.
fn find_heading(rotation: Quat) -> Option<f32> {
    if !rotation.is_finite() || rotation.length_squared() < 0.5 {
        return None;
    }
    let rotation = rotation.normalize();
    let gaze = rotation * Vec3::NEG_Z;
    let is_steep = gaze.y.abs() > STEEP_PITCH_SINE;
    let ahead = if is_steep { Vec3::Y.cross(rotation * Vec3::X) } else { gaze };
    let is_told = ahead.x.hypot(ahead.z) > 0.1;
    is_told.then(|| (-ahead.x).atan2(-ahead.z))
}
