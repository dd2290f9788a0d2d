//! Model of collision detection and response: contact by a test of every voxel, and the freeze as a walk in
//! quarter-voxel steps along the path with a slide along the tangent. The naive definition: it skips nothing.

use glam::{I64Vec3, IVec3, Vec3};
use paros_core::edit::{Contact, Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{
    FIXED_ONE, FreezeResult, GridBit, GridShape, LONG_STRETCH, SHORT_STRETCH, exit_probe_steps,
};
use paros_core::limits::deep_step_cost_in_steps;
use paros_core::volume::Range;

use crate::dense::{DenseVolume, face_neighbours};

/// Walk steps a voxel of path length.
pub const STEPS_PER_VOXEL: f32 = 4.0;

/// The obstacle: a volume and its mask, the part that can't be removed.
#[derive(Debug)]
pub struct ContactModel {
    volume: DenseVolume,
    voxels: Vec<[i32; 3]>,
    masked: Vec<[i32; 3]>,
}

/// A bit's penetration depths in fixed point; 0 outside.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PenetrationDepths {
    /// The depth in the volume.
    pub volume: i32,
    /// The depth in the mask.
    pub mask: i32,
}

impl PenetrationDepths {
    /// Whether both are at most the limits.
    fn are_at_most(self, limits: PenetrationDepths) -> bool {
        self.volume <= limits.volume && self.mask <= limits.mask
    }
}

/// The end of a walk along a path.
#[derive(Clone, Copy, Debug)]
pub struct PathWalk {
    /// The last pose within the limit.
    pub last_allowed: Pose,
    /// The next pose of the path, if it is forbidden.
    pub first_forbidden: Option<Pose>,
}

/// The end of a walk with its slide.
struct SlidingWalk {
    pose: Pose,
    /// Whether the walk was stopped, so that the bit slid.
    blocked: bool,
}

impl ContactModel {
    /// The obstacle of a volume and its mask.
    ///
    /// # Panics
    /// The mask is not part of the volume.
    pub fn new(volume: DenseVolume, mask: &DenseVolume) -> Self {
        assert!(mask.is_within(&volume), "the mask is part of the volume");
        ContactModel {
            voxels: volume.occupied().collect(),
            masked: mask.occupied().collect(),
            volume,
        }
    }

    /// The contact of a bit at a pose: overlapping voxels, penetration depth and normal.
    pub fn contact_at(&self, bit: &GridBit, pose: &Pose) -> Contact {
        let mut normal = IVec3::ZERO;
        let (mut overlap, mut depth) = (0, 0);
        for &voxel in &self.voxels {
            let Some(inner) = centre_depth_subunits(bit, pose, voxel) else { continue };
            overlap += 1;
            depth = depth.max(inner);
            for near in face_neighbours(voxel) {
                if !self.volume.contains(near) {
                    normal += IVec3::from_array(near) - IVec3::from_array(voxel);
                }
            }
        }
        let normal = normal.as_vec3().normalize_or_zero();
        let on_mask =
            self.masked.iter().any(|&voxel| is_less_than_a_voxel_outside(bit, pose, voxel));
        Contact { overlap, depth, normal, on_mask }
    }

    /// The penetration depths of a bit at a pose.
    pub fn penetration_at(&self, bit: &GridBit, pose: &Pose) -> PenetrationDepths {
        if self.is_outside_grid(bit, pose) {
            return PenetrationDepths { volume: 0, mask: 0 };
        }
        let deepest = |voxels: &[[i32; 3]]| {
            let inner = |&voxel: &[i32; 3]| centre_depth_subunits(bit, pose, voxel);
            voxels.iter().filter_map(inner).max().unwrap_or(0)
        };
        PenetrationDepths { volume: deepest(&self.voxels), mask: deepest(&self.masked) }
    }

    /// Freezes a bit on its way from one pose to the tracked pose: walks step by step while the penetration is
    /// within the limit, then slides once along the tangent.
    pub fn freeze_by_walk(
        &self,
        bit: &GridBit,
        from: &Pose,
        tracked: &Pose,
        max_steps: u32,
    ) -> FreezeResult {
        let mut steps_left = max_steps as usize;
        let walk = self.walk_and_slide(bit, from, tracked, &mut steps_left);
        FreezeResult {
            pose: walk.pose,
            blocked: walk.blocked,
            steps: max_steps - steps_left as u32,
        }
    }

    /// Walks, and slides where it is stopped.
    fn walk_and_slide(
        &self,
        bit: &GridBit,
        from: &Pose,
        tracked: &Pose,
        steps_left: &mut usize,
    ) -> SlidingWalk {
        let PathWalk { last_allowed: reached, first_forbidden } =
            self.walk_while_allowed(bit, from, tracked, steps_left);
        let Some(stop) = first_forbidden else {
            return SlidingWalk { pose: reached, blocked: false };
        };
        let offset_left = tracked.position - reached.position;
        let normal = match self.contact_at(bit, &stop).normal {
            Vec3::ZERO => -offset_left.normalize_or_zero(),
            normal => normal,
        };
        let inward = offset_left.dot(normal);
        let target = if inward < 0.0 {
            Pose {
                position: reached.position + offset_left - normal * inward,
                rotation: tracked.rotation,
            }
        } else {
            Pose { position: tracked.position, rotation: reached.rotation }
        };
        let mut pose = self.walk_while_allowed(bit, &reached, &target, steps_left).last_allowed;
        let wanted = (target.position - reached.position) * STEPS_PER_VOXEL;
        if pose.position == reached.position && wanted.length_squared() > 1.0 {
            let sits = self.penetration_at(bit, &reached);
            let mut away = I64Vec3::ZERO;
            for voxel in &self.voxels {
                let inner = centre_depth_subunits(bit, &stop, *voxel).unwrap_or(i32::MIN);
                let held = self.masked.contains(voxel);
                if inner > bit.bite.max(sits.volume) || (held && inner > sits.mask) {
                    away -= centre_offset_subunits(&stop, *voxel);
                }
            }
            let away = away.as_vec3().normalize_or_zero();
            let tangent = offset_left - away * offset_left.dot(away).min(0.0);
            let target = Pose { position: reached.position + tangent, ..reached };
            pose = self.walk_while_allowed(bit, &reached, &target, steps_left).last_allowed;
        }
        SlidingWalk { pose, blocked: true }
    }

    /// Walks a path while the penetration is within the limit. A bit that is too deep leaves where the path
    /// does. Stretches of free path cost fewer of the steps that are left, but are walked alike.
    pub fn walk_while_allowed(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        steps_left: &mut usize,
    ) -> PathWalk {
        let poses: Vec<Pose> = path_poses(bit, from, to).collect();
        let mut reached = *from;
        let mut sits = self.penetration_at(bit, from);
        let (mut steps_done, mut singly_to, mut stretch) = (0, 0, SHORT_STRETCH as usize);
        while steps_done < poses.len() && *steps_left > 0 {
            let usual = PenetrationDepths { volume: bit.bite, mask: 0 };
            let limits = PenetrationDepths { volume: bit.bite.max(sits.volume), mask: sits.mask };
            if steps_done >= singly_to {
                let end = (steps_done + stretch).min(poses.len());
                if limits == usual && self.is_sweep_free(bit, &reached, &poses[end - 1], usual) {
                    assert!(
                        poses[steps_done..end]
                            .iter()
                            .all(|pose| self.penetration_at(bit, pose).are_at_most(usual))
                    );
                    (steps_done, *steps_left, reached) = (end, *steps_left - 1, poses[end - 1]);
                    (sits, stretch) = (self.penetration_at(bit, &reached), LONG_STRETCH as usize);
                    continue;
                }
                if stretch > SHORT_STRETCH as usize {
                    stretch = SHORT_STRETCH as usize;
                    continue;
                }
                singly_to = end;
            }
            *steps_left = steps_left.saturating_sub(if limits == usual {
                1
            } else {
                deep_step_cost_in_steps(self.volume.side()) as usize
            });
            let next = poses[steps_done];
            steps_done += 1;
            let depths = self.penetration_at(bit, &next);
            if depths.are_at_most(limits) {
                (reached, sits) = (next, depths);
                continue;
            }
            if limits == usual {
                return PathWalk { last_allowed: reached, first_forbidden: Some(next) };
            }
            match self.find_exit_step(bit, limits, &reached, &poses, steps_done) {
                Some(step) => (steps_done, reached) = (step, poses[step - 1]),
                None => return PathWalk { last_allowed: reached, first_forbidden: Some(next) },
            }
            sits = self.penetration_at(bit, &reached);
        }
        PathWalk { last_allowed: reached, first_forbidden: None }
    }

    /// The step of the first exit probe after `after_step` at which the bit is out of the stone; step 1 leads to
    /// the first pose of `path`. If the bit's centre is in the open, only probes that the centre reaches through
    /// the open count.
    fn find_exit_step(
        &self,
        bit: &GridBit,
        limits: PenetrationDepths,
        last_allowed: &Pose,
        path: &[Pose],
        after_step: usize,
    ) -> Option<usize> {
        let half_diagonal = (SUBUNITS_PER_VOXEL as f32 * 0.866).ceil() as i32;
        let open =
            PenetrationDepths { volume: bit.inscribed_radius_subunits() - half_diagonal, ..limits };
        let mut last = *last_allowed;
        for step in exit_probe_steps(after_step as u32, path.len() as u32) {
            let pose = path[step as usize - 1];
            if limits.volume <= open.volume && !self.is_sweep_free(bit, &last, &pose, open) {
                return None;
            }
            if self
                .penetration_at(bit, &pose)
                .are_at_most(PenetrationDepths { volume: bit.bite, mask: 0 })
            {
                return Some(step as usize);
            }
            last = pose;
        }
        None
    }

    /// Whether the swept volume of the bit, shrunk to the allowed depths, contains no voxel. Conservative.
    fn is_sweep_free(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        allowed: PenetrationDepths,
    ) -> bool {
        let n = self.volume.side();
        let clear = |level, voxels: &[[i32; 3]]| {
            bit.swept_brush_deeper_than(level, from, to).is_none_or(|brush| {
                let pieces: Vec<_> = brush.pieces().collect();
                !voxels.iter().any(|voxel| {
                    let [x, y, z] = voxel.map(|i| i as usize);
                    let holds = |range: Range| range.contains(x);
                    pieces.iter().any(|piece| piece.x_range(y, z, n).is_some_and(holds))
                })
            })
        };
        clear(allowed.volume, &self.voxels) && clear(allowed.mask, &self.masked)
    }

    /// Whether the whole bit lies outside the grid.
    fn is_outside_grid(&self, bit: &GridBit, pose: &Pose) -> bool {
        let n = self.volume.side() as f32;
        let outer = bit.circumscribed_radius_subunits() as f32 / SUBUNITS_PER_VOXEL as f32 + 1.0;
        let held = pose.position.clamp(Vec3::ZERO, Vec3::splat(n));
        held.distance(pose.position) > outer
    }
}

/// The poses of a path, in steps of a quarter voxel of translation and rotation together: `from` is none of
/// them, the last is `to`.
pub fn path_poses(bit: &GridBit, from: &Pose, to: &Pose) -> impl Iterator<Item = Pose> + use<> {
    let (from, to) = (*from, *to);
    let turn = from.angle_radians_to(&to) * bit.circumscribed_radius_subunits() as f32
        / SUBUNITS_PER_VOXEL as f32;
    let length = (to.position - from.position).length() + turn;
    let steps = (length * STEPS_PER_VOXEL).ceil().max(1.0) as u32;
    (1..=steps).map(move |i| from.interpolate(&to, i as f32 / steps as f32))
}

/// The depth of a voxel's centre inside the bit, rounded up to whole fixed-point units; `None` outside.
fn centre_depth_subunits(bit: &GridBit, pose: &Pose, voxel: [i32; 3]) -> Option<i32> {
    let p = centre_offset_subunits(pose, voxel);
    let inner = match bit.shape {
        GridShape::Ball(radius) => {
            // The least k for which radius - k is no more than the distance.
            let squared = p.length_squared();
            let mut k = i64::from(radius) - squared.isqrt() - 1;
            while (i64::from(radius) - k).max(0).pow(2) > squared {
                k += 1;
            }
            if squared > i64::from(radius).pow(2) {
                return None;
            }
            k
        }
        GridShape::Box(half) => {
            let unit = i64::from(FIXED_ONE);
            let across = distances_along_bit_axes(pose, p);
            let left = [0, 1, 2].map(|i| i64::from(half[i]) * unit - across[i]);
            let least = *left.iter().min().expect("three axes");
            if least < 0 {
                return None;
            }
            (least + unit - 1) / unit
        }
    };
    Some(inner as i32)
}

/// Whether a voxel's centre lies in the bit or less than a voxel outside its radius or faces.
fn is_less_than_a_voxel_outside(bit: &GridBit, pose: &Pose, voxel: [i32; 3]) -> bool {
    let p = centre_offset_subunits(pose, voxel);
    match bit.shape {
        GridShape::Ball(radius) => {
            p.length_squared() < i64::from(radius + SUBUNITS_PER_VOXEL).pow(2)
        }
        GridShape::Box(half) => {
            distances_along_bit_axes(pose, p).iter().enumerate().all(|(i, &across)| {
                across < i64::from(half[i] + SUBUNITS_PER_VOXEL) * i64::from(FIXED_ONE)
            })
        }
    }
}

/// A voxel's centre relative to the bit's, along the grid's axes.
fn centre_offset_subunits(bit_pose: &Pose, voxel: [i32; 3]) -> I64Vec3 {
    let centre = voxel.map(|i| i64::from(i * SUBUNITS_PER_VOXEL + SUBUNITS_PER_VOXEL / 2));
    I64Vec3::from_array(centre) - bit_pose.position_subunits().as_i64vec3()
}

/// The distances of a point from the bit's centre along the bit's axes, in subunits times [`FIXED_ONE`].
fn distances_along_bit_axes(bit_pose: &Pose, offset_subunits: I64Vec3) -> [i64; 3] {
    bit_pose.unit_axes_q14().map(|axis| offset_subunits.dot(axis.as_i64vec3()).abs())
}
