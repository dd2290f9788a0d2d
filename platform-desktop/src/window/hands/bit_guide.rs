//! Target pose of the bit: on the surface under the cursor, with a path through the air to it.

use glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, BitShape, RoomPose, ToolBitSpec};
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_core::{RangeMaps, World};
use paros_shaders::Ray;

use crate::window::raycast;

use super::RIGHT;

/// Clearance of a bit at rest above the surface, in metres.
const CLEARANCE_M: f32 = 0.004;

/// Distance before the eye, in metres, of the waypoint between two sides of the sculpture.
const WAYPOINT_M: f32 = 0.06;

/// Lag of the bit behind its target, in voxels of a grid of 128, above which a waypoint is tried and
/// ticks count towards [`STUCK_TICKS`].
const MAX_LAG_VOXELS: f32 = 5.0;

/// Ticks of lag after which a bit is stuck.
const STUCK_TICKS: u32 = 30;

/// Fraction of the rotation to its target that a bit makes in a tick.
const TURN_FRACTION: f32 = 0.3;

/// Angle at which a pitching chisel is held to a surface, in radians.
const PITCH: f32 = 0.65;

/// Length of path that sets a blade's direction, in voxels of a grid of 128.
const HEADING_VOXELS: f32 = 3.0;

/// The target of the bit in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct BitTarget {
    /// The cursor's ray in the room: origin in metres, unit direction.
    pub(super) room_ray: Ray,
    /// The eye's up vector in the room.
    pub(super) up: Vec3,
    /// The bit, in its present size.
    pub(super) bit: ToolBitSpec,
    /// Depth below the surface while the tool runs, in metres.
    pub(super) depth_m: f32,
    pub(super) running: bool,
}

/// Guidance of the bit over the surface, from tick to tick.
#[derive(Debug)]
pub(super) struct BitGuide<const N: usize> {
    /// The volume as it was when the stroke began.
    before: Box<RangeMaps<N, INTERVALS>>,
    /// The bit's smoothed rotation in the grid.
    rotation: Option<Quat>,
    /// Distance from the eye to the last hit, in voxels; the next field has it in metres.
    hit_distance_voxels: f32,
    hit_distance_m: f32,
    lifted: bool,
    behind: u32,
    heading: Heading,
    next_bite: Option<Vec3>,
}

impl<const N: usize> BitGuide<N>
where
    Grid<N>: Size,
{
    pub(super) fn new() -> Self {
        let before = Box::new(RangeMaps::new());
        BitGuide {
            before,
            rotation: None,
            hit_distance_voxels: 0.0,
            hit_distance_m: 1.0,
            lifted: false,
            behind: 0,
            heading: Heading::default(),
            next_bite: None,
        }
    }

    /// Copies the volume whose surface the stroke follows.
    pub(super) fn begin_stroke(&mut self, maps: &RangeMaps<N, INTERVALS>) {
        self.before.copy_from(maps);
    }

    /// Returns the distance from the eye to the last hit, in metres.
    pub(super) const fn last_hit_distance_m(&self) -> f32 {
        self.hit_distance_m
    }

    /// Returns the displacement by which the trigger would move the bit over the surface, in metres of the
    /// room.
    pub(super) const fn next_bite(&self) -> Option<Vec3> {
        self.next_bite
    }

    /// Clears the next bite, as no bit is in hand.
    pub(super) const fn forget_next_bite(&mut self) {
        self.next_bite = None;
    }

    /// Returns `true` if the bit has lagged for more than [`STUCK_TICKS`], and restarts the count then.
    pub(super) fn take_is_stuck(&mut self) -> bool {
        let stuck = self.behind > STUCK_TICKS;
        if stuck {
            self.behind = 0;
        }
        stuck
    }

    /// Returns the pose of the bit's centre in the room: position in metres, and rotation.
    pub(super) fn next_bit_centre_pose(
        &mut self,
        aim: &BitTarget,
        world: &World<N, INTERVALS>,
    ) -> RoomPose {
        let frame = world.stool_frame();
        let grid_ray = ray_from_room_to_grid(&aim.room_ray, world);
        let Ray { origin: eye, direction: way } = grid_ray;
        let maps = if aim.running { &*self.before } else { world.volume().maps() };
        let (target, rotation) = match raycast::cast_ray(maps, &grid_ray) {
            Some(hit) => {
                self.hit_distance_voxels = hit.distance_voxels;
                self.hit_distance_m = hit.distance_voxels * frame.voxel_metres();
                let point = eye + way * hit.distance_voxels;
                let reach = (4 * N / 128).max(3) as i32;
                let normal = raycast::estimate_normal(maps, point, reach).unwrap_or(-way);
                // At a silhouette the normal points away from the eye: bend it back towards the eye.
                let normal = (normal - way * (0.35 + normal.dot(way).max(0.0))).normalize();
                let up = frame.to_grid(Vec3::ZERO, Quat::IDENTITY).rotation * aim.up;
                let up = match aim.bit.shape {
                    // A blade points along its path.
                    BitShape::Disc { .. } => self.heading.follow(point, N).unwrap_or(up),
                    _ => up,
                };
                let edge = match aim.bit.flake_um {
                    0 => None,
                    _ => direction_to_edge(maps, point, normal),
                };
                let BitOrientation { rotation, centre_m } = match edge {
                    Some(edge) => pitching_orientation(&aim.bit, normal, edge),
                    None => bit_orientation(&aim.bit, normal, up),
                };
                let inward = frame.to_room(&paros_core::edit::Pose::ZERO).1 * -normal;
                self.next_bite = Some(inward * (aim.depth_m + CLEARANCE_M));
                let depth_m = if aim.running { aim.depth_m } else { -CLEARANCE_M };
                (point + (centre_m - normal * depth_m) / frame.voxel_metres(), rotation)
            }
            None => {
                self.next_bite = None;
                // Beside the sculpture the distance from the eye is kept.
                let middle = Vec3::new(0.5, 0.4, 0.5) * N as f32;
                let far = (middle - eye).dot(way);
                let distance = if aim.running { self.hit_distance_voxels } else { far };
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
        frame.to_room(&paros_core::edit::Pose { position: target, rotation: turned })
    }

    /// Returns the next point on the path to `target`, in voxels: the target itself, or `point_before_eye`
    /// while the sculpture blocks the straight path.
    fn next_waypoint(
        &mut self,
        target: Vec3,
        point_before_eye: Vec3,
        is_running: bool,
        world: &World<N, INTERVALS>,
    ) -> Vec3 {
        let hand = world.hand_state(RIGHT);
        let at = hand.frozen_pose.position;
        let way = target - at;
        let far = way.length() * 128.0 / N as f32 > MAX_LAG_VOXELS;
        if is_running || !hand.has_frozen_pose || !far {
            (self.lifted, self.behind) = (false, 0);
            return target;
        }
        self.behind += 1;
        let hit = raycast::cast_ray(
            world.volume().maps(),
            &Ray { origin: at, direction: way.normalize() },
        );
        let blocked = hit.is_some_and(|hit| hit.distance_voxels < way.length());
        self.lifted = blocked && !self.lifted;
        if self.lifted { point_before_eye } else { target }
    }
}

/// The direction in which a point moves.
#[derive(Clone, Copy, Default, Debug)]
struct Heading {
    from: Option<Vec3>,
    direction: Option<Vec3>,
}

impl Heading {
    /// Returns the direction of the point's last few voxels of path; `None` before it has moved that far.
    fn follow(&mut self, point: Vec3, grid_side: usize) -> Option<Vec3> {
        let way = point - *self.from.get_or_insert(point);
        if way.length() * 128.0 / grid_side as f32 > HEADING_VOXELS {
            (self.from, self.direction) = (Some(point), way.try_normalize());
        }
        self.direction
    }
}

/// Orientation of a bit on a surface.
struct BitOrientation {
    rotation: Quat,
    /// Offset of the bit's centre from the contact point on the surface.
    centre_m: Vec3,
}

/// Returns the orientation of a bit on a surface with an outward unit normal, turned towards the eye's up
/// vector.
fn bit_orientation(bit: &ToolBitSpec, outward_normal: Vec3, eye_up: Vec3) -> BitOrientation {
    let normal = outward_normal;
    let metres = |micrometres: i32| micrometres as f32 * 1e-6;
    let along = |axis: Vec3| (axis - normal * axis.dot(normal)).try_normalize();
    let aside = normal.any_orthonormal_vector();
    let upward = along(eye_up).unwrap_or(aside);
    let (forward, y, centre_height_m) = match bit.shape {
        // A rasp's bits lie flat, on their thin side.
        BitShape::Box { half_extents_um } if bit.action.is_rubbing() => {
            (upward, normal, metres(half_extents_um[1]))
        }
        BitShape::Box { half_extents_um } => (-normal, upward, metres(half_extents_um[2])),
        BitShape::Ball { radius_um } | BitShape::Disc { radius_um } => {
            (-normal, upward, metres(radius_um))
        }
    };
    let z = -forward;
    let rotation = Quat::from_mat3(&glam::Mat3::from_cols(y.cross(z), y, z));
    BitOrientation { rotation, centre_m: normal * centre_height_m }
}

/// Returns the orientation of a pitching chisel on a surface: its blow leads down towards an edge.
fn pitching_orientation(bit: &ToolBitSpec, outward_normal: Vec3, to_edge: Vec3) -> BitOrientation {
    let (sine, cosine) = PITCH.sin_cos();
    let back = outward_normal * sine - to_edge * cosine;
    let y = to_edge * sine + outward_normal * cosine;
    let rotation = Quat::from_mat3(&glam::Mat3::from_cols(y.cross(back), y, back));
    let BitShape::Box { half_extents_um } = bit.shape else {
        return BitOrientation { rotation, centre_m: Vec3::ZERO };
    };
    BitOrientation { rotation, centre_m: back * (half_extents_um[2] as f32 * 1e-6) }
}

/// Returns the direction along a surface in which the stone ends soonest, within a flake's reach. It is
/// searched a little below the surface.
fn direction_to_edge<const N: usize>(
    maps: &RangeMaps<N, INTERVALS>,
    point_voxels: Vec3,
    outward_normal: Vec3,
) -> Option<Vec3> {
    const BELOW_M: f32 = 0.010;
    const REACH_M: f32 = 0.036;
    const DIRECTIONS: u16 = 24;
    let per_metre = N as f32 / BOX_SIDE;
    let from = point_voxels - outward_normal * BELOW_M * per_metre;
    let is_stone = |at: Vec3| {
        let voxel = at.floor().as_ivec3().to_array();
        voxel[1] < 0
            || voxel.iter().all(|v| (0..N as i32).contains(v))
                && maps.contains(voxel.map(|v| v as usize))
    };
    let (a, b) = outward_normal.any_orthonormal_pair();
    let steps_to_end = |way: Vec3| {
        (1..=(2.0 * REACH_M * per_metre) as u16)
            .find(|&i| !is_stone(from + way * (0.5 * f32::from(i))))
    };
    let ways = (0..DIRECTIONS).map(|i| {
        let (sine, cosine) =
            (f32::from(i) * std::f32::consts::TAU / f32::from(DIRECTIONS)).sin_cos();
        a * cosine + b * sine
    });
    ways.filter_map(|way| steps_to_end(way).map(|steps| (steps, way)))
        .min_by_key(|(steps, _)| *steps)
        .map(|(_, way)| way)
}

/// Transforms a ray from the room to the grid: origin in voxels, unit direction.
pub(super) fn ray_from_room_to_grid<const N: usize>(
    room_ray: &Ray,
    world: &World<N, INTERVALS>,
) -> Ray
where
    Grid<N>: Size,
{
    let pose = world.stool_frame().to_grid(room_ray.origin, Quat::IDENTITY);
    Ray { origin: pose.position, direction: pose.rotation * room_ray.direction }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use paros_core::RangeMaps;
    use paros_core::limits::INTERVALS;
    use paros_core::session::ToolBit;
    use paros_core::volume::{BitGrid, BitSet};

    use super::{Heading, direction_to_edge, pitching_orientation};

    /// The surface is the top of a block that ends at x = 100.
    #[test]
    fn a_pitching_chisel_is_set_towards_the_nearest_edge() {
        let mut bits = Box::new(BitGrid::<128>::new());
        for (y, z) in (0..64 * 128).map(|i| (i / 128, i % 128)) {
            *bits.row_mut(y, z) = BitSet::span(0, 99);
        }
        let mut maps = Box::new(RangeMaps::<128, INTERVALS>::new());
        bits.write_closure(&mut maps);
        let at = |x: f32| direction_to_edge(&maps, Vec3::new(x, 64.0, 60.0), Vec3::Y);
        assert_eq!(at(60.0), None, "far from all edges");
        let edge = at(94.0).expect("an edge 6 voxels away");
        assert!(edge.dot(Vec3::X) > 0.95, "{edge}");
        let set = pitching_orientation(ToolBit::PitchingChisel.spec(), Vec3::Y, edge);
        let blow = set.rotation * Vec3::NEG_Z;
        assert!(blow.y < -0.5 && blow.dot(edge) > 0.7, "{blow}");
        // The tip touches the contact point.
        let tip = set.centre_m + blow * 0.014;
        assert!(tip.length() < 1e-6, "{tip}");
    }

    #[test]
    fn a_heading_is_that_of_the_last_way() {
        let mut heading = Heading::default();
        for (x, z, expected) in [
            (10.0, 0.0, None),
            (12.0, 0.0, None),
            (14.0, 0.0, Some(Vec3::X)),
            (14.0, 2.0, Some(Vec3::X)),
            (14.0, 4.0, Some(Vec3::Z)),
        ] {
            assert_eq!(heading.follow(Vec3::new(x, 0.0, z), 128), expected, "at {x}, {z}");
        }
        assert_eq!(heading.follow(Vec3::new(14.0, 0.0, 9.0), 256), Some(Vec3::Z), "finer voxels");
    }
}
