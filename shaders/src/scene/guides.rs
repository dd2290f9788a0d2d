//! Guides of the hands: the extent of the next bites, the bit where stone hides it, and the mirror's plane
//! with the reflection of each tool. For display only: the core's state doesn't depend on them.

use core::f32::consts::{FRAC_PI_2, TAU};

use glam::{Affine3A, Quat, Vec3};
use paros_core::World;
use paros_core::edit::Pose;
use paros_core::internals::{BOX_SIDE, BitAction, BitShape, RoomPose};
use paros_core::session::ToolBit;
use paros_core::volume::{Grid, Size};

use super::assembly::LatestInput;
use super::draw::DrawList;
use super::meshes::{DrawGroup, MeshId};
use super::placing::bit_pose;
use crate::limits::BITE_DOTS;

/// Colour of the guides, and the opacity of dots, of reflections, of the plane's edges and of hidden bits.
const AMBER: [f32; 3] = [1.6, 1.0, 0.45];
const DOT_OPACITY: f32 = 0.9;
const REFLECTED_OPACITY: f32 = 0.45;
const EDGE_OPACITY: f32 = 0.35;
const HIDDEN_OPACITY: f32 = 0.30;
/// A dot's size, and the thickness of the plane's edges, in metres.
const DOT: f32 = 0.0035;
const EDGE: f32 = 0.0025;
/// Distance from the sculpture's box, in metres, from which on a bit has no guides.
const NEAR_BOX: f32 = 0.08;
/// Steps from the deepest point of a bite to beyond its widest, in the search for its rim on the stone.
const RIM_STEPS: u32 = 48;

/// Adds the guides of both hands, and those of the mirror if it is on and `latest` shows it.
pub(super) fn add_guides<const N: usize, const K: usize>(
    list: &mut DrawList,
    world: &World<N, K>,
    latest: &LatestInput,
    turn_radians: f32,
) where
    Grid<N>: Size,
{
    let mirrored = latest.show_mirror && world.is_mirrored();
    for hand in 0..2 {
        let Some(guided) = GuidedBit::of_hand(world, latest, hand) else { continue };
        let GuidedBit { bit, shown, .. } = guided;
        let room_from_bit = Affine3A::from_rotation_translation(shown.1, shown.0);
        list.add_to_group(
            DrawGroup::Hidden,
            MeshId::of_bit(bit),
            room_from_bit,
            tint(HIDDEN_OPACITY),
        );
        if !world.hand_state(hand).trigger && bit.spec().action != BitAction::Fill {
            guided.add_bite_rim(list, world);
        }
        if mirrored {
            let (position, rotation) = mirror_pose(world, &guided.frozen);
            let reflected = Affine3A::from_rotation_translation(rotation, position);
            list.add_to_group(
                DrawGroup::Particles,
                MeshId::of_bit(bit),
                reflected,
                tint(REFLECTED_OPACITY),
            );
        }
    }
    if mirrored {
        add_plane(list, turn_radians);
    }
}

/// A held bit near the sculpture.
struct GuidedBit {
    hand: usize,
    bit: ToolBit,
    /// The bit's pose as contact allows it, in the grid.
    frozen: Pose,
    /// The pose at which the bit is drawn, in the room.
    shown: RoomPose,
    /// The pose to which the next bites take the bit, in the grid.
    bite: Pose,
}

impl GuidedBit {
    fn of_hand<const N: usize, const K: usize>(
        world: &World<N, K>,
        latest: &LatestInput,
        hand: usize,
    ) -> Option<Self>
    where
        Grid<N>: Size,
    {
        let (tool, bit) = world.held_tool(hand)?;
        let state = world.hand_state(hand);
        let (frozen, frame) = (state.frozen_pose, world.stool_frame());
        let margin = NEAR_BOX / frame.voxel_metres();
        let side = N as f32 + margin;
        let is_near = frozen.position.cmpgt(Vec3::splat(-margin)).all()
            && frozen.position.cmplt(Vec3::splat(side)).all();
        if !state.has_frozen_pose || !is_near {
            return None;
        }
        let grip = latest.grips[hand].unwrap_or(state.grip);
        let shown = bit_pose((grip.0 + world.push_out_metres(hand), grip.1), tool);
        let pushed = match latest.next_bites[hand] {
            Some(way) => frame.to_grid(frame.to_room(&frozen).0 + way, Quat::IDENTITY).position,
            // With the trigger pulled, the bit follows the hand to its pose, bite by bite.
            None => state.raw_pose.position,
        };
        let bite = Pose { position: pushed, rotation: frozen.rotation };
        Some(GuidedBit { hand, bit, frozen, shown, bite })
    }

    /// Adds dots on the stone along the rim of what the next bites take, if they take anything.
    fn add_bite_rim<const N: usize, const K: usize>(&self, list: &mut DrawList, world: &World<N, K>)
    where
        Grid<N>: Size,
    {
        let way = self.bite.position - self.frozen.position;
        // A bit that is already where its hand pushes it still takes the stone that it overlaps.
        let against = world.hand_contact(self.hand).map_or(Vec3::ZERO, |contact| -contact.normal);
        let Some(inward) = way.try_normalize().or(against.try_normalize()) else { return };
        let frame = world.stool_frame();
        let (aside, beside) = inward.any_orthonormal_pair();
        let shape = bit_shape_in_voxels(self.bit, frame.voxel_metres());
        for dot in 0..BITE_DOTS {
            let (sin, cos) = (TAU * dot as f32 / BITE_DOTS as f32).sin_cos();
            let outward = aside * cos + beside * sin;
            let rim = (0..RIM_STEPS).rev().find_map(|step| {
                let (sin, cos) = (1.2 * FRAC_PI_2 * step as f32 / RIM_STEPS as f32).sin_cos();
                let way = inward * cos + outward * sin;
                let reach = reach_along(&shape, self.bite.rotation.inverse() * way);
                let point = self.bite.position + way * reach;
                is_stone(world, point).then_some(point)
            });
            let Some(point) = rim else { continue };
            let pose = Pose { position: point, rotation: Quat::IDENTITY };
            let at = frame.to_room(&pose).0;
            let dot =
                Affine3A::from_scale_rotation_translation(Vec3::splat(DOT), Quat::IDENTITY, at);
            list.add(MeshId::Speck, dot, tint(DOT_OPACITY));
        }
    }
}

/// A bit's shape in voxels: the radius of a ball, or the half extents of a box. A disc becomes the box
/// around it.
enum VoxelShape {
    Ball(f32),
    Box(Vec3),
}

fn bit_shape_in_voxels(bit: ToolBit, voxel_metres: f32) -> VoxelShape {
    let voxels = |micrometres: i32| micrometres as f32 * 1e-6 / voxel_metres;
    match bit.spec().shape {
        BitShape::Ball { radius_um } => VoxelShape::Ball(voxels(radius_um)),
        BitShape::Box { half_extents_um } => {
            VoxelShape::Box(Vec3::from_array(half_extents_um.map(voxels)))
        }
        // The disc's normal is x; the disc cuts two voxels.
        BitShape::Disc { radius_um } => {
            VoxelShape::Box(Vec3::new(1.0, voxels(radius_um), voxels(radius_um)))
        }
    }
}

/// Returns the distance from a shape's middle to its surface, in a direction in the shape's own space.
fn reach_along(shape: &VoxelShape, unit_direction: Vec3) -> f32 {
    match shape {
        VoxelShape::Ball(radius) => *radius,
        VoxelShape::Box(half) => {
            (*half / unit_direction.abs().max(Vec3::splat(1e-6))).min_element()
        }
    }
}

/// Returns `true` if a point of the grid, in voxels, lies in the stone.
fn is_stone<const N: usize, const K: usize>(world: &World<N, K>, point: Vec3) -> bool
where
    Grid<N>: Size,
{
    let is_in = point.cmpge(Vec3::ZERO).all() && point.cmplt(Vec3::splat(N as f32)).all();
    is_in && world.volume().rows().contains(point.to_array().map(|c| c as usize))
}

/// Returns the reflection of a pose in the plane that halves the grid along x, in the room. Bits are
/// symmetric along their own x, so that a reflected bit is a turned one.
fn mirror_pose<const N: usize, const K: usize>(world: &World<N, K>, pose: &Pose) -> RoomPose
where
    Grid<N>: Size,
{
    let Pose { position, rotation } = *pose;
    let position = Vec3 { x: N as f32 - position.x, ..position };
    let rotation = Quat::from_xyzw(rotation.x, -rotation.y, -rotation.z, rotation.w);
    world.stool_frame().to_room(&Pose { position, rotation })
}

/// Adds the edges of the mirror's plane.
fn add_plane(list: &mut DrawList, turn_radians: f32) {
    let room_from_stool = Affine3A::from_rotation_translation(
        Quat::from_rotation_y(turn_radians),
        paros_core::internals::STOOL_TOP,
    );
    let half = 0.5 * BOX_SIDE;
    let upright = Vec3::new(EDGE, BOX_SIDE, EDGE);
    let level = Vec3::new(EDGE, EDGE, BOX_SIDE);
    for (y, z, extent) in
        [(half, -half, upright), (half, half, upright), (EDGE, 0.0, level), (BOX_SIDE, 0.0, level)]
    {
        let middle = Vec3::new(0.0, y, z);
        let edge = Affine3A::from_scale_rotation_translation(extent, Quat::IDENTITY, middle);
        list.add(MeshId::Speck, room_from_stool * edge, tint(EDGE_OPACITY));
    }
}

const fn tint(opacity: f32) -> [f32; 4] {
    let [r, g, b] = AMBER;
    [r, g, b, opacity]
}
