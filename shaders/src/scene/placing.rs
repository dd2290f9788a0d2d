//! Where the bench's things are shown: resting on the bench, falling, lying about.

use core::f32::consts::FRAC_PI_2;

use glam::{Quat, Vec3};
use paros_core::frame::Frame;
use paros_core::hand::RoomPose;
use paros_core::pose::Pose;
use paros_core::tools::{Shape, Tool};
use paros_core::workbench::{BENCH_TOP, Item, Place, Workbench};

/// Height of a tool's axis over the bench, on its rests, in metres.
const REST: f32 = 0.046;

/// Height of a bit's centre over the bench, in its rack, in metres.
const RACK: f32 = 0.062;

/// Ticks in which a thing that fell comes to lie flat.
const SETTLE: f32 = 10.0;

/// From a tool's grip to the centre of its bit, in metres.
#[must_use]
pub fn length(tool: Tool) -> f32 {
    tool.length() as f32 * 1e-6
}

/// The pose of a bit on a tool at a grip.
#[must_use]
pub fn tip((position, rotation): RoomPose, tool: Tool) -> RoomPose {
    (position + rotation * Vec3::new(0.0, 0.0, -length(tool)), rotation)
}

/// Where a thing is shown that is neither in a hand nor on a tool. At home tools lie across the
/// bench, pointing away from the visitor, and bits stand in their rack: poses for the eye, while
/// the hand reaches for the core's.
#[must_use]
pub fn shown(bench: &Workbench, item: Item) -> Option<RoomPose> {
    let (position, rotation) = bench.pose(item)?;
    Some(match (bench.place(item), item) {
        (Place::Home, Item::Tool(_)) => {
            (position + Vec3::Y * REST, Quat::from_rotation_y(-FRAC_PI_2))
        }
        (Place::Home, Item::Bit(_)) => {
            (position + Vec3::Y * RACK, Quat::from_rotation_x(FRAC_PI_2))
        }
        (Place::Lying(ticks), _) => {
            let settled = (f32::from(ticks) / SETTLE).min(1.0);
            let lift =
                rise(bench, item) * settled * if position.y < 0.5 * BENCH_TOP { 0.2 } else { 1.0 };
            (position + Vec3::Y * lift, rotation.slerp(flat(rotation), settled))
        }
        _ => (position, rotation),
    })
}

/// The turn of the stool, in radians from 0 to tau, counter-clockwise as seen from above.
#[must_use]
pub fn stool_turn(frame: &Frame) -> f32 {
    let (_, turn) = frame.to_room(&Pose::ZERO);
    (2.0 * turn.y.atan2(turn.w)).rem_euclid(core::f32::consts::TAU)
}

/// The rotation with the same bearing, level.
fn flat(rotation: Quat) -> Quat {
    let ahead = rotation * Vec3::NEG_Z;
    let bearing =
        if ahead.x.abs() + ahead.z.abs() > 1e-4 { (-ahead.x).atan2(-ahead.z) } else { 0.0 };
    Quat::from_rotation_y(bearing)
}

/// How high a lying thing's axis is over what it lies on, in metres.
fn rise(bench: &Workbench, item: Item) -> f32 {
    let bit = match item {
        Item::Tool(tool) => bench.mounted(tool),
        Item::Bit(bit) => bit,
    };
    let thick = match bit.data().shape {
        Shape::Ball { radius } => radius,
        Shape::Box { half } => half[1],
    };
    (thick as f32 * 1e-6).max(0.023)
}
