//! Placing the room: for each visitor it is turned and moved so that the stool is before them, wherever in the real
//! room they stand or sit. The floor stays where it is, or is moved by a [`HeightStep`] where that is wanted.
//!
//! The runtime's own "ahead" is that of whoever recentred last. The head decides: once it is tracked, steady and about
//! level, the room's origin goes below it, and the stool, which the core has on the -z axis, ahead of it.

#[cfg(test)]
mod reach;
#[cfg(test)]
mod tests;

use core::f32::consts::PI;

use glam::{Quat, Vec2, Vec3};
use paros_core::internals::RoomPose;
use paros_core::session::TICK_RATE;

use paros_shell::headset::height_step::HeightStep;

/// Where the room lies in the runtime's space: turned about the vertical, moved along the floor, and raised by a step.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct RoomTransform {
    /// Counter-clockwise as seen from above, in radians.
    pub yaw: f32,
    /// The room's origin in the runtime's space, x and z, in metres.
    pub origin: Vec2,
    /// How high its floor lies.
    pub height: HeightStep,
}

/// When the room is to be moved.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum PlacementNeed {
    /// If the stool is not before the visitor: a step away, or aside.
    IfFar,
    /// In any case: another visitor has come.
    Anyhow,
}

/// Decides where the room lies. Time is counted in ticks.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct RoomPlacement {
    room: RoomTransform,
    search: Option<HeadSearch>,
    /// Whether the room's height is chosen too.
    snaps_heights: bool,
    /// A head has chosen it: only another visitor's, or one that the staff recentres, chooses it anew.
    has_height: bool,
}

/// Waits for a head by which the room can be placed.
#[derive(Clone, Copy, PartialEq, Debug)]
struct HeadSearch {
    need: PlacementNeed,
    /// Ticks in which a head was tracked.
    seen_ticks: u32,
    /// Ticks for which it has stayed near `anchor`.
    steady_ticks: u32,
    anchor: RoomPose,
}

/// Ticks for which a head is steady before the room is placed: half a second. Whoever puts a headset on turns it
/// about for longer.
const STEADY_TICKS: u32 = TICK_RATE / 2;

/// Tracked ticks after which any head will do: five seconds. Who looks at their feet for so long needs a stool before
/// them, too.
const PATIENCE_TICKS: u32 = 5 * TICK_RATE;

/// How far a steady head moves and turns at most.
const STEADY_METRES: f32 = 0.1;
const STEADY_RADIANS: f32 = PI / 18.0;

/// The sines of how far a level head looks up or down (40 degrees) and leans aside (25) at most.
const LEVEL_PITCH_SINE: f32 = 0.64;
const LEVEL_ROLL_SINE: f32 = 0.42;

/// Heights of the eyes of those who sit or stand, children and tall people too, in metres above the floor: a headset
/// on a low table, or in a raised hand, is none.
const EYE_HEIGHTS: core::ops::Range<f32> = 0.8..2.3;

/// A head as far from the origin is an error of tracking, in metres.
const FARTHEST: f32 = 100.0;

/// The sine of the pitch from which a head looks straight up or down: 75 degrees.
const STEEP_PITCH_SINE: f32 = 0.966;

/// How far from the stool's place before them visitors may be where the room isn't moved: a step and a glance.
const NEAR_METRES: f32 = 0.4;
const NEAR_RADIANS: f32 = PI / 6.0;

impl RoomTransform {
    /// The transform by which a head, which is given in the runtime's space, is above the room's origin and faces
    /// along its -z axis. `None` where it faces nowhere, as a pose that isn't finite does.
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

    /// The room's rotation in the runtime's space.
    #[must_use]
    pub fn rotation(self) -> Quat {
        Quat::from_rotation_y(self.yaw)
    }

    /// The room's origin in the runtime's space, in metres.
    #[must_use]
    pub const fn translation(self) -> Vec3 {
        Vec3::new(self.origin.x, self.height.offset_metres(), self.origin.y)
    }

    /// A pose of the room in the runtime's space.
    #[must_use]
    pub fn to_runtime(self, (position, rotation): RoomPose) -> RoomPose {
        (self.rotation() * position + self.translation(), self.rotation() * rotation)
    }

    /// A pose of the runtime's space in the room.
    #[must_use]
    pub fn to_room(self, (position, rotation): RoomPose) -> RoomPose {
        let back = self.rotation().conjugate();
        (back * (position - self.translation()), back * rotation)
    }
}

impl RoomPlacement {
    /// A room where the runtime's space has it, whose height is a step by the head that it is placed by, if
    /// `snaps_heights`, or else stays.
    #[must_use]
    pub fn new(snaps_heights: bool) -> Self {
        RoomPlacement { snaps_heights, ..RoomPlacement::default() }
    }

    /// Where the room lies.
    #[must_use]
    pub const fn room(&self) -> RoomTransform {
        self.room
    }

    /// Has the room placed by the next head that will do. Of two needs the greater one counts.
    pub fn request(&mut self, need: PlacementNeed) {
        let need = self.search.map_or(need, |search| search.need.max(need));
        let anchor = (Vec3::ZERO, Quat::IDENTITY);
        self.search = Some(HeadSearch { need, seen_ticks: 0, steady_ticks: 0, anchor });
    }

    /// The runtime has another space, by a recentring or with another session: the room lies where that has it, unless
    /// the visitor is elsewhere, as high as before. Returns where that is, if it lay elsewhere.
    pub fn restart_in_new_space(&mut self) -> Option<RoomTransform> {
        self.request(PlacementNeed::IfFar);
        let there = RoomTransform { height: self.room.height, ..RoomTransform::default() };
        (core::mem::replace(&mut self.room, there) != there).then_some(there)
    }

    /// Takes in the head at a tick, as it is in the room; `None` where it is not tracked, or not worn. Returns where the
    /// room lies from now on, if it is to be moved.
    pub fn observe_head(&mut self, head_in_room: Option<RoomPose>) -> Option<RoomTransform> {
        let search = self.search.as_mut()?;
        let Some(head) = head_in_room else {
            search.steady_ticks = 0;
            return None;
        };
        // Eyes are as high above the real floor as they are, whatever the room's.
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

    /// The room's height from now on. A visitor's stays: nothing lifts them in the middle of their visit.
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
    /// Whether this head, a finite one, was steady for long enough, or there was no such head for too long.
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

/// Whether a head looks about level, from where the eyes of people are.
fn is_level_at_eye_height((position, rotation): RoomPose) -> bool {
    let (ahead, right) = (rotation * Vec3::NEG_Z, rotation * Vec3::X);
    EYE_HEIGHTS.contains(&position.y)
        && ahead.y.abs() < LEVEL_PITCH_SINE
        && right.y.abs() < LEVEL_ROLL_SINE
        && (rotation * Vec3::Y).y > 0.0
}

/// The yaw at which a head faces, in radians. Where it looks straight up or down, the line of its ears tells it.
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
