//! Where the bit goes: onto the surface that the cursor points at.

use glam::{Quat, Vec3};
use paros_core::maps::Maps;
use paros_core::size::{Grid, Size};
use paros_core::tools::{Action, Bit, Shape};
use paros_core::workbench::{ITEMS, Item};
use paros_core::world::World;

use crate::window::cast;

use super::RIGHT;

/// Metres between a bit at rest and the surface.
const CLEAR: f32 = 0.004;

/// How near a ray must come to a thing on the bench to point at it, in metres.
const THING: f32 = 0.045;

/// Metres before the eye through which a bit goes from one side of the sculpture to another.
const LIFT: f32 = 0.06;

/// How far a bit may be behind before it goes through the air, or counts as stuck, in voxels of a
/// grid of 128.
const BEHIND: f32 = 5.0;

/// Ticks after which a bit that stays behind is stuck.
const PATIENCE: u32 = 30;

/// How much of the way to its new direction a bit turns in a tick.
const TURN: f32 = 0.3;

/// What the bit is to do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    /// From the eye through the cursor, in the room.
    pub(super) ray: (Vec3, Vec3),
    /// What is up for the eye.
    pub(super) up: Vec3,
    pub(super) bit: Bit,
    /// Below the surface while it runs, in metres.
    pub(super) depth: f32,
    pub(super) running: bool,
}

/// What a hand remembers of its way over the surface.
#[derive(Debug)]
pub(super) struct Reach<const N: usize> {
    /// The volume as it was when the stroke began.
    before: Box<Maps<N>>,
    /// How the bit is turned, in the grid.
    rotation: Option<Quat>,
    /// Voxels from the eye to where the ray met something last, and as metres.
    distance: f32,
    metres: f32,
    lifted: bool,
    behind: u32,
}

/// The thing on the bench that a ray in the room points at, unless the sculpture is before it.
pub(super) fn thing<const N: usize>(
    (origin, direction): (Vec3, Vec3),
    world: &World<N>,
) -> Option<Item>
where
    Grid<N>: Size,
{
    let pointed = |item: &Item| {
        let (position, _) = world.bench().pose(*item)?;
        let along = (position - origin).dot(direction);
        let aside = (position - origin - direction * along).length();
        (along > 0.0 && aside < THING).then_some((along, aside))
    };
    let items = (0..ITEMS).filter_map(Item::from_number);
    let nearest = items
        .filter_map(|item| Some((pointed(&item)?, item)))
        .min_by(|((_, a), _), ((_, b), _)| a.total_cmp(b));
    let ((along, _), item) = nearest?;
    let (eye, way) = in_grid((origin, direction), world);
    let before = cast::first(world.volume().maps(), eye, way)
        .is_some_and(|hit| hit.distance * world.frame().voxel() < along);
    (!before).then_some(item)
}

impl<const N: usize> Reach<N>
where
    Grid<N>: Size,
{
    pub(super) fn new() -> Self {
        let before = Box::new(Maps::new());
        Reach { before, rotation: None, distance: 0.0, metres: 1.0, lifted: false, behind: 0 }
    }

    /// The surface that a stroke follows, until the next one begins.
    pub(super) fn begin_stroke(&mut self, maps: &Maps<N>) {
        self.before.copy_from(maps);
    }

    /// How far from the eye the surface was last, in metres.
    pub(super) const fn metres(&self) -> f32 {
        self.metres
    }

    /// Whether the bit has been held up for long.
    pub(super) fn is_stuck(&mut self) -> bool {
        let stuck = self.behind > PATIENCE;
        if stuck {
            self.behind = 0;
        }
        stuck
    }

    /// Where the bit's centre is to be in the room, and how it is to be turned.
    pub(super) fn tip(&mut self, aim: &Aim, world: &World<N>) -> (Vec3, Quat) {
        let frame = world.frame();
        let (eye, way) = in_grid(aim.ray, world);
        let maps = if aim.running { &*self.before } else { world.volume().maps() };
        let (target, rotation) = match cast::first(maps, eye, way) {
            Some(hit) => {
                (self.distance, self.metres) = (hit.distance, hit.distance * frame.voxel());
                let point = eye + way * hit.distance;
                let reach = (4 * N / 128).max(3) as i32;
                let normal = cast::normal(maps, point, reach).unwrap_or(-way);
                // A silhouette's normal turns away from the eye: no tool goes round corners.
                let normal = (normal - way * (0.35 + normal.dot(way).max(0.0))).normalize();
                let up = frame.to_grid(Vec3::ZERO, Quat::IDENTITY).rotation * aim.up;
                let (rotation, extent) = stance(aim.bit, normal, up);
                let depth = if aim.running { aim.depth } else { -CLEAR };
                (point + normal * ((extent - depth) / frame.voxel()), rotation)
            }
            None => {
                // Beside the sculpture it stays as far from the eye as it was.
                let middle = Vec3::new(0.5, 0.4, 0.5) * N as f32;
                let far = (middle - eye).dot(way);
                let distance = if aim.running { self.distance } else { far };
                (eye + way * distance, Quat::from_rotation_arc(Vec3::NEG_Z, way))
            }
        };
        let turned = self.rotation.map_or(rotation, |last| last.slerp(rotation, TURN).normalize());
        self.rotation = Some(turned);
        let target = self.route(target, eye + way * (LIFT / frame.voxel()), aim.running, world);
        frame.to_room(&paros_core::pose::Pose { position: target, rotation: turned })
    }

    /// The next point on the way to a target that the eye sees: straight through the air, or by way
    /// of a point before the eye.
    fn route(&mut self, target: Vec3, before_eye: Vec3, running: bool, world: &World<N>) -> Vec3 {
        let hand = world.hand(RIGHT);
        let at = hand.frozen.position;
        let way = target - at;
        let far = way.length() * 128.0 / N as f32 > BEHIND;
        if running || !hand.bound || !far {
            (self.lifted, self.behind) = (false, 0);
            return target;
        }
        self.behind += 1;
        let hit = cast::first(world.volume().maps(), at, way.normalize());
        let blocked = hit.is_some_and(|hit| hit.distance < way.length());
        self.lifted = blocked && !self.lifted;
        if self.lifted { before_eye } else { target }
    }
}

/// How a bit is turned on a surface with a normal, and how far its centre is from the face that
/// works, in metres.
fn stance(bit: Bit, normal: Vec3, up: Vec3) -> (Quat, f32) {
    let metres = |micrometres: i32| micrometres as f32 * 1e-6;
    let along = |axis: Vec3| (axis - normal * axis.dot(normal)).try_normalize();
    let aside = normal.any_orthonormal_vector();
    let upward = along(up).unwrap_or(aside);
    let (forward, y, extent) = match bit.data().shape {
        // A file lies flat, on its thin side.
        Shape::Box { half } if bit.data().action == Action::Smooth => {
            (upward, normal, metres(half[1]))
        }
        Shape::Box { half } => (-normal, upward, metres(half[2])),
        Shape::Ball { radius } => (-normal, upward, metres(radius)),
    };
    let z = -forward;
    (Quat::from_mat3(&glam::Mat3::from_cols(y.cross(z), y, z)), extent)
}

/// A ray in the room as one in the grid: origin in voxels, unit direction.
fn in_grid<const N: usize>((origin, direction): (Vec3, Vec3), world: &World<N>) -> (Vec3, Vec3)
where
    Grid<N>: Size,
{
    let pose = world.frame().to_grid(origin, Quat::IDENTITY);
    (pose.position, pose.rotation * direction)
}
