//! Display poses of the bench's items: at home, falling, lying.

use core::f32::consts::FRAC_PI_2;

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::internals::{BENCH_TOP, BitShape, RoomPose, ToolPlace, Workbench};
use paros_core::session::{BenchItem, StoolFrame, Tool};

/// Height of a resting tool's axis over the bench, in metres.
const REST: f32 = 0.046;

/// Height of a racked bit's centre over the bench, in metres.
const RACK: f32 = 0.062;

/// Height of a blade's rim over the bench, in metres.
const CLEARANCE: f32 = 0.004;

/// Ticks over which a fallen item comes to lie flat.
const SETTLE: f32 = 10.0;

/// Returns the distance from a tool's grip to the centre of its bit, in metres.
#[must_use]
pub fn grip_to_bit_metres(tool: Tool) -> f32 {
    tool.length_um() as f32 * 1e-6
}

/// Returns the pose of the bit of a tool held at a grip pose.
#[must_use]
pub fn bit_pose(grip: RoomPose, tool: Tool) -> RoomPose {
    let (position, rotation) = grip;
    (position + rotation * Vec3::new(0.0, 0.0, -grip_to_bit_metres(tool)), rotation)
}

/// Returns the display pose of an item that is neither held nor mounted; `None` otherwise. At home, tools
/// lie across the bench and bits stand in their rack; the core's own poses, which hands reach for, differ.
#[must_use]
pub fn display_pose_unless_held_or_mounted(bench: &Workbench, item: BenchItem) -> Option<RoomPose> {
    let (position, rotation) = bench.pose_of(item)?;
    Some(match (bench.place_of(item), item) {
        (ToolPlace::Home, _) => display_pose_at_home(item),
        (ToolPlace::Lying(ticks), _) => {
            let settled = (f32::from(ticks) / SETTLE).min(1.0);
            let lift = lying_axis_height_metres(bench, item)
                * settled
                * if position.y < 0.5 * BENCH_TOP { 0.2 } else { 1.0 };
            (position + Vec3::Y * lift, rotation.slerp(yaw_rotation(rotation), settled))
        }
        _ => (position, rotation),
    })
}

/// Returns the display pose of an item in its place on the bench.
#[must_use]
pub fn display_pose_at_home(item: BenchItem) -> RoomPose {
    let position = item.home_position();
    match item {
        BenchItem::Tool(_) => (position + Vec3::Y * REST, Quat::from_rotation_y(-FRAC_PI_2)),
        BenchItem::Bit(bit) => {
            let height = match bit.spec().shape {
                // A blade stands on its rim.
                BitShape::Disc { radius_um } => radius_um as f32 * 1e-6 + CLEARANCE,
                _ => RACK,
            };
            (position + Vec3::Y * height, Quat::from_rotation_x(FRAC_PI_2))
        }
    }
}

/// Returns the stool's angle, in radians from 0 to tau, counter-clockwise from above.
#[must_use]
pub fn stool_turn_0_to_tau(frame: &StoolFrame) -> f32 {
    let (_, turn) = frame.to_room(&Pose::ZERO);
    (2.0 * turn.y.atan2(turn.w)).rem_euclid(core::f32::consts::TAU)
}

/// Returns the yaw of a rotation, without pitch and roll.
fn yaw_rotation(rotation: Quat) -> Quat {
    let ahead = rotation * Vec3::NEG_Z;
    let bearing =
        if ahead.x.abs() + ahead.z.abs() > 1e-4 { (-ahead.x).atan2(-ahead.z) } else { 0.0 };
    Quat::from_rotation_y(bearing)
}

/// Returns the height of a lying item's axis over the ground, in metres.
fn lying_axis_height_metres(bench: &Workbench, item: BenchItem) -> f32 {
    let bit = match item {
        BenchItem::Tool(tool) => bench.mounted_bit(tool),
        BenchItem::Bit(bit) => bit,
    };
    let half_thickness_um = match bit.spec_at(bench.size_of(bit)).shape {
        BitShape::Ball { radius_um } => radius_um,
        BitShape::Box { half_extents_um } => half_extents_um[1],
        BitShape::Disc { radius_um } => radius_um,
    };
    (half_thickness_um as f32 * 1e-6).max(0.023)
}
