//! Marks of what closure brought back: the edges of the box around it, on the turning sculpture, fading.

use glam::{Affine3A, IVec3, Quat, Vec3};
use paros_core::World;
use paros_core::internals::{BOX_SIDE, BitShape};
use paros_core::volume::{Grid, Range, Size, VoxelBox};

use super::assembly::SculpturePlacement;
use super::draw::DrawList;
use super::meshes::MeshId;
use super::particles::MAX_STEP_SECONDS;
use crate::limits::REFUSAL_MARKS;

/// How long a mark is seen after the last edit that was refused, in seconds.
pub const REFUSAL_SECONDS: f32 = 0.7;

/// Thickness of an edge in its middle, in metres; it ends in points.
const THICKNESS: f32 = 0.004;

/// Dull red, unlike the stone and what flies off it; the fourth part is the opacity at first.
const TINT: [f32; 4] = [0.5, 0.1, 0.06, 0.8];

/// By how much a mark stands off its box, in metres: a bite is smaller than the bit, which would hide it.
pub const REFUSAL_MARGIN: f32 = 0.008;

/// A box on the sculpture.
#[derive(Clone, Copy, Debug)]
struct Mark {
    /// Opposite corners, in the grid's sides, from its corner.
    lo: Vec3,
    hi: Vec3,
    seconds_left: f32,
}

/// The marks of both hands. All that a mirrored edit brought back has one box, which spans both sides; it is
/// marked along the bit's path in the tick, and along its mirror.
#[derive(Debug)]
pub(super) struct RefusalMarks {
    /// Of each hand, at its bit and at the bit's mirror.
    marks: [[Option<Mark>; REFUSAL_MARKS / 2]; 2],
    /// Of each hand, where along x its bit was after the last tick, in voxels: its next path begins there.
    path_starts: [Option<f32>; 2],
}

impl RefusalMarks {
    pub(super) const fn new() -> Self {
        RefusalMarks { marks: [[None; REFUSAL_MARKS / 2]; 2], path_starts: [None; 2] }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// Marks what closure brought back of a hand's edits of the last tick, in place of the hand's last mark.
    /// Nothing is marked where more was removed. Call it after every tick.
    pub(super) fn follow_tick<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        hand: usize,
    ) where
        Grid<N>: Size,
    {
        let bit = world.hand_state(hand);
        let path_end = bit.frozen_pose.position.x;
        let path_start = self.path_starts[hand].unwrap_or(path_end);
        self.path_starts[hand] = bit.can_sweep.then_some(path_end);
        let report = world.edit_report(hand);
        if !report.is_mostly_refused_by_closure() {
            return;
        }
        let boxes = match world.is_mirrored() {
            true => split_by_mirror(world, hand, [path_start, path_end], report.closure_box),
            false => [report.closure_box, VoxelBox::EMPTY],
        };
        self.marks[hand] = boxes.map(|voxels| {
            let [x, y, z] = voxels.ranges();
            let corner =
                |end: fn(Range) -> usize| Vec3::from_array([x, y, z].map(|r| end(r) as f32));
            (!voxels.is_empty()).then(|| Mark {
                lo: corner(Range::first) / N as f32,
                hi: (corner(Range::last) + 1.0) / N as f32,
                seconds_left: REFUSAL_SECONDS,
            })
        });
    }

    pub(super) fn advance_time(&mut self, seconds: f32) {
        for mark in self.marks.iter_mut().flatten() {
            let seconds = seconds.clamp(0.0, MAX_STEP_SECONDS);
            mark.iter_mut().for_each(|mark| mark.seconds_left -= seconds);
            *mark = mark.filter(|mark| mark.seconds_left > 0.0);
        }
    }

    pub(super) fn add_instances(&self, list: &mut DrawList, sculpture: &SculpturePlacement) {
        let room_from_stool = Affine3A::from_rotation_translation(
            Quat::from_rotation_y(sculpture.turn_radians),
            sculpture.foot,
        );
        for Mark { lo, hi, seconds_left } in self.marks.iter().flatten().flatten() {
            let [r, g, b, opacity] = TINT;
            let tint = [r, g, b, opacity * seconds_left / REFUSAL_SECONDS];
            // From the box's base on the stool, in metres.
            let from_foot = |corner: &Vec3| (*corner - Vec3::new(0.5, 0.0, 0.5)) * sculpture.side;
            let (lo, hi) = (from_foot(lo) - REFUSAL_MARGIN, from_foot(hi) + REFUSAL_MARGIN);
            for (middle, extent) in box_edges(lo, hi) {
                let edge = Affine3A::from_scale_rotation_translation(
                    extent.max(Vec3::splat(THICKNESS)),
                    Quat::IDENTITY,
                    middle,
                );
                list.add(MeshId::Speck, room_from_stool * edge, tint);
            }
        }
    }
}

/// The parts of a mirrored edit's box along the bit's path and along its mirror; one where they meet.
/// `path_ends` are those along x, in voxels.
fn split_by_mirror<const N: usize, const K: usize>(
    world: &World<N, K>,
    hand: usize,
    path_ends: [f32; 2],
    voxels: VoxelBox,
) -> [VoxelBox; 2]
where
    Grid<N>: Size,
{
    let [x, y, z] = voxels.ranges();
    let bit = world.held_bit_spec(hand).map_or(0.0, |spec| match spec.shape {
        BitShape::Ball { radius_um } => radius_um as f32,
        BitShape::Disc { radius_um } => radius_um as f32,
        BitShape::Box { half_extents_um } => IVec3::from_array(half_extents_um).as_vec3().length(),
    });
    // And what rounding takes.
    let reach = bit * 1e-6 / BOX_SIDE * N as f32 + 1.0;
    let [a, b] = path_ends;
    let clip = |low: f32, high: f32| {
        let first = (low - reach).max(x.first() as f32) as usize;
        let last = (high + reach).clamp(0.0, x.last() as f32) as usize;
        Range::new(first.min(N - 1), last)
    };
    let (low, high) = (a.min(b), a.max(b));
    let [own, mirror] = [clip(low, high), clip(N as f32 - high, N as f32 - low)];
    if own.last() + 1 >= mirror.first() && mirror.last() + 1 >= own.first() {
        return [voxels, VoxelBox::EMPTY];
    }
    if own.is_empty() && mirror.is_empty() {
        // A tick was left out.
        return [voxels, VoxelBox::EMPTY];
    }
    [own, mirror].map(|x| VoxelBox::new([x, y, z]))
}

/// The twelve edges of a box: the middle of each, and its extent along its axis.
fn box_edges(lo: Vec3, hi: Vec3) -> impl Iterator<Item = (Vec3, Vec3)> {
    (0..3).flat_map(move |axis| {
        (0..4).map(move |edge| {
            let ends = |i: usize| if edge >> i & 1 == 0 { lo } else { hi };
            let mut middle = (lo + hi) / 2.0;
            middle[(axis + 1) % 3] = ends(0)[(axis + 1) % 3];
            middle[(axis + 2) % 3] = ends(1)[(axis + 2) % 3];
            let mut extent = Vec3::ZERO;
            extent[axis] = hi[axis] - lo[axis];
            (middle, extent)
        })
    })
}
