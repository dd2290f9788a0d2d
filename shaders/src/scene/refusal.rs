//! Marks of what closure restored: the edges of the box around it, on the turning sculpture, fading.

use glam::{Affine3A, IVec3, Quat, Vec3};
use paros_core::World;
use paros_core::internals::{BOX_SIDE, BitShape};
use paros_core::volume::{Grid, Range, Size, VoxelBox};

use super::assembly::SculpturePlacement;
use super::draw::DrawList;
use super::meshes::MeshId;
use super::particles::MAX_STEP_SECONDS;
use crate::limits::REFUSAL_MARKS;

/// Seconds that a mark is shown after the last refused edit.
pub const REFUSAL_SECONDS: f32 = 0.7;

/// Thickness of an edge in its middle, in metres; it ends in points.
const THICKNESS: f32 = 0.004;

/// Dull red, unlike the stone and its chips; the fourth component is the opacity at first.
const TINT: [f32; 4] = [0.5, 0.1, 0.06, 0.8];

/// Gap between a mark and its box, in metres: a bite is smaller than the bit, which would hide the mark.
pub const REFUSAL_MARGIN: f32 = 0.008;

/// A box on the sculpture.
#[derive(Clone, Copy, Debug)]
struct Mark {
    /// Opposite corners, in the grid's sides, from its corner.
    lo: Vec3,
    hi: Vec3,
    seconds_left: f32,
}

/// The marks of both hands. A mirrored edit reports one box of all that closure restored, which spans both
/// sides; the marks are its parts along the bit's path in the tick, and along the path's mirror image.
#[derive(Debug)]
pub(super) struct RefusalMarks {
    /// For each hand, the marks at its bit and at the bit's mirror image.
    marks: [[Option<Mark>; REFUSAL_MARKS / 2]; 2],
    /// For each hand, the x of its bit after the last tick, in voxels: its next path begins there.
    path_starts: [Option<f32>; 2],
}

impl RefusalMarks {
    pub(super) const fn new() -> Self {
        RefusalMarks { marks: [[None; REFUSAL_MARKS / 2]; 2], path_starts: [None; 2] }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new();
    }

    /// Marks what closure restored of a hand's edits in the last tick, in place of the hand's last marks.
    /// Does nothing if the edits removed more than was restored. Call it after every tick.
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

/// Splits a mirrored edit's box into its parts along the bit's path and along the path's mirror image;
/// returns one box if they meet. `path_ends` are the path's ends along x, in voxels.
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
    // One voxel more for rounding.
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
        // A tick was skipped.
        return [voxels, VoxelBox::EMPTY];
    }
    [own, mirror].map(|x| VoxelBox::new([x, y, z]))
}

/// Returns the twelve edges of a box: the middle of each, and its extent along its axis.
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
