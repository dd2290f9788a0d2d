//! Target pose of the bit: on the surface under the cursor, with a way there through the air.

use glam::{Quat, Vec3};
use paros_core::internals::{BENCH_ITEMS, BitAction, BitShape};
use paros_core::{BenchItem, Grid, RangeMaps, Size, ToolBit, World};

use crate::window::raycast;

use super::RIGHT;

/// Clearance of a bit at rest above the surface, in metres.
const CLEARANCE_M: f32 = 0.004;

/// Picking radius of the workbench's items around a ray, in metres.
const PICK_RADIUS_M: f32 = 0.045;

/// Distance before the eye, in metres, of the waypoint from one side of the sculpture to another.
const WAYPOINT_M: f32 = 0.06;

/// Lag of the bit behind its target, in voxels of a grid of 128, above which a waypoint is tried and
/// ticks count towards [`STUCK_TICKS`].
const MAX_LAG_VOXELS: f32 = 5.0;

/// Ticks of lag after which a bit is stuck.
const STUCK_TICKS: u32 = 30;

/// Fraction of the rotation to its target that a bit makes in a tick.
const TURN_FRACTION: f32 = 0.3;

/// The target of the bit in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct BitTarget {
    /// The cursor's ray in the room: origin in metres, unit direction.
    pub(super) ray: (Vec3, Vec3),
    /// The eye's up vector in the room.
    pub(super) up: Vec3,
    pub(super) bit: ToolBit,
    /// Depth below the surface while it runs, in metres.
    pub(super) depth: f32,
    pub(super) running: bool,
}

/// Guidance of the bit over the surface, from tick to tick.
#[derive(Debug)]
pub(super) struct BitGuide<const N: usize> {
    /// The volume as it was when the stroke began.
    before: Box<RangeMaps<N>>,
    /// The bit's rotation in the grid, smoothed.
    rotation: Option<Quat>,
    /// Distance from the eye to the last hit, in voxels, and the same in metres.
    distance: f32,
    metres: f32,
    lifted: bool,
    behind: u32,
}

/// Picks the item on the workbench nearest to a ray in the room, unless the sculpture occludes it.
pub(super) fn pick_item<const N: usize>(
    (origin, direction): (Vec3, Vec3),
    world: &World<N>,
) -> Option<BenchItem>
where
    Grid<N>: Size,
{
    let pointed = |item: &BenchItem| {
        let (position, _) = world.workbench().pose_of(*item)?;
        let along = (position - origin).dot(direction);
        let aside = (position - origin - direction * along).length();
        (along > 0.0 && aside < PICK_RADIUS_M).then_some((along, aside))
    };
    let items = (0..BENCH_ITEMS).filter_map(BenchItem::from_number);
    let nearest = items
        .filter_map(|item| Some((pointed(&item)?, item)))
        .min_by(|((_, a), _), ((_, b), _)| a.total_cmp(b));
    let ((along, _), item) = nearest?;
    let (eye, way) = ray_to_grid((origin, direction), world);
    let before = raycast::cast_ray(world.volume().maps(), eye, way)
        .is_some_and(|hit| hit.distance * world.stool_frame().voxel_metres() < along);
    (!before).then_some(item)
}

impl<const N: usize> BitGuide<N>
where
    Grid<N>: Size,
{
    pub(super) fn new() -> Self {
        let before = Box::new(RangeMaps::new());
        BitGuide { before, rotation: None, distance: 0.0, metres: 1.0, lifted: false, behind: 0 }
    }

    /// Copies the volume whose surface the stroke follows.
    pub(super) fn begin_stroke(&mut self, maps: &RangeMaps<N>) {
        self.before.copy_from(maps);
    }

    /// Distance from the eye to the last hit, in metres.
    pub(super) const fn distance_metres(&self) -> f32 {
        self.metres
    }

    /// Whether the bit has lagged for more than [`STUCK_TICKS`]. Clears the count if so.
    pub(super) fn take_stuck(&mut self) -> bool {
        let stuck = self.behind > STUCK_TICKS;
        if stuck {
            self.behind = 0;
        }
        stuck
    }

    /// The pose of the bit's centre in the room: position in metres, and rotation.
    pub(super) fn bit_pose(&mut self, aim: &BitTarget, world: &World<N>) -> (Vec3, Quat) {
        let frame = world.stool_frame();
        let (eye, way) = ray_to_grid(aim.ray, world);
        let maps = if aim.running { &*self.before } else { world.volume().maps() };
        let (target, rotation) = match raycast::cast_ray(maps, eye, way) {
            Some(hit) => {
                (self.distance, self.metres) = (hit.distance, hit.distance * frame.voxel_metres());
                let point = eye + way * hit.distance;
                let reach = (4 * N / 128).max(3) as i32;
                let normal = raycast::estimate_normal(maps, point, reach).unwrap_or(-way);
                // At a silhouette the normal points away from the eye: it is bent back towards it.
                let normal = (normal - way * (0.35 + normal.dot(way).max(0.0))).normalize();
                let up = frame.to_grid(Vec3::ZERO, Quat::IDENTITY).rotation * aim.up;
                let (rotation, extent) = bit_orientation(aim.bit, normal, up);
                let depth = if aim.running { aim.depth } else { -CLEARANCE_M };
                (point + normal * ((extent - depth) / frame.voxel_metres()), rotation)
            }
            None => {
                // Beside the sculpture the distance from the eye is kept.
                let middle = Vec3::new(0.5, 0.4, 0.5) * N as f32;
                let far = (middle - eye).dot(way);
                let distance = if aim.running { self.distance } else { far };
                (eye + way * distance, Quat::from_rotation_arc(Vec3::NEG_Z, way))
            }
        };
        let turned =
            self.rotation.map_or(rotation, |last| last.slerp(rotation, TURN_FRACTION).normalize());
        self.rotation = Some(turned);
        let target = self.next_waypoint(
            target,
            eye + way * (WAYPOINT_M / frame.voxel_metres()),
            aim.running,
            world,
        );
        frame.to_room(&paros_core::Pose { position: target, rotation: turned })
    }

    /// The next point on the way to `target`, in grid units: the target itself, or `before_eye` while the
    /// sculpture blocks the straight way.
    fn next_waypoint(
        &mut self,
        target: Vec3,
        before_eye: Vec3,
        running: bool,
        world: &World<N>,
    ) -> Vec3 {
        let hand = world.hand_state(RIGHT);
        let at = hand.frozen_pose.position;
        let way = target - at;
        let far = way.length() * 128.0 / N as f32 > MAX_LAG_VOXELS;
        if running || !hand.has_frozen_pose || !far {
            (self.lifted, self.behind) = (false, 0);
            return target;
        }
        self.behind += 1;
        let hit = raycast::cast_ray(world.volume().maps(), at, way.normalize());
        let blocked = hit.is_some_and(|hit| hit.distance < way.length());
        self.lifted = blocked && !self.lifted;
        if self.lifted { before_eye } else { target }
    }
}

/// The bit's rotation on a surface with unit `normal`, and the distance of its centre from the face
/// that carves, in metres.
fn bit_orientation(bit: ToolBit, normal: Vec3, up: Vec3) -> (Quat, f32) {
    let metres = |micrometres: i32| micrometres as f32 * 1e-6;
    let along = |axis: Vec3| (axis - normal * axis.dot(normal)).try_normalize();
    let aside = normal.any_orthonormal_vector();
    let upward = along(up).unwrap_or(aside);
    let (forward, y, extent) = match bit.spec().shape {
        // A rasp lies flat, on its thin side.
        BitShape::Box { half } if bit.spec().action == BitAction::Smooth => {
            (upward, normal, metres(half[1]))
        }
        BitShape::Box { half } => (-normal, upward, metres(half[2])),
        BitShape::Ball { radius } => (-normal, upward, metres(radius)),
    };
    let z = -forward;
    (Quat::from_mat3(&glam::Mat3::from_cols(y.cross(z), y, z)), extent)
}

/// Transforms a ray from the room to the grid: origin in voxels, unit direction.
fn ray_to_grid<const N: usize>((origin, direction): (Vec3, Vec3), world: &World<N>) -> (Vec3, Vec3)
where
    Grid<N>: Size,
{
    let pose = world.stool_frame().to_grid(origin, Quat::IDENTITY);
    (pose.position, pose.rotation * direction)
}
