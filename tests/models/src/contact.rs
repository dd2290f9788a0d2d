//! Model of collision detection and response by its naive definition: contact is a test of every voxel, and
//! the freeze a walk along the path in quarter-voxel steps, with a slide along the tangent. Skips nothing.

use std::sync::Arc;

use glam::{I64Vec3, IVec3, Vec3};
use paros_core::edit::{Contact, Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{
    BURIED_WITHIN, FreezeResult, GridBit, GridShape, LONG_STRETCH, SHORT_STRETCH, WayBudget,
    exit_probe_steps,
};
use paros_core::limits::{MAX_SLIDES, deep_step_cost_in_steps, slide_cost_in_steps};

use crate::bit_voxels::{
    centre_depth_subunits, centre_offset_subunits, holds_any, is_less_than_half_a_voxel_outside,
    voxels_around,
};
use crate::dense::{DenseVolume, face_neighbours};
use crate::path::{STEPS_PER_VOXEL, path_poses};

/// The obstacle: a volume and its mask, which is the part that can't be removed.
#[derive(Debug)]
pub struct ContactModel {
    volume: Arc<DenseVolume>,
    mask: Arc<DenseVolume>,
    /// `true` if the bit collides with the mask alone, which then also serves as the volume.
    is_mask_alone: bool,
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
    /// Returns `true` if both depths are at most the limits.
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
    /// `true` if the budget ended before the path.
    pub ran_out: bool,
}

impl ContactModel {
    /// Creates the obstacle of a volume and its mask.
    ///
    /// # Panics
    /// The mask isn't part of the volume.
    pub fn new(volume: DenseVolume, mask: &DenseVolume) -> Self {
        assert!(mask.is_within(&volume), "the mask is part of the volume");
        ContactModel {
            mask: Arc::new(mask.clone()),
            volume: Arc::new(volume),
            is_mask_alone: false,
        }
    }

    /// Creates the obstacle of a volume and its mask, without checking that the mask is part of it.
    pub fn of_shared(volume: &Arc<DenseVolume>, mask: &Arc<DenseVolume>) -> Self {
        ContactModel { volume: Arc::clone(volume), mask: Arc::clone(mask), is_mask_alone: false }
    }

    /// Creates the obstacle of a bit that collides with the mask alone.
    pub fn of_mask_alone(mask: &Arc<DenseVolume>) -> Self {
        ContactModel { is_mask_alone: true, ..ContactModel::of_shared(mask, mask) }
    }

    /// Returns `true` if a voxel is stone.
    pub fn is_occupied(&self, voxel: [i32; 3]) -> bool {
        self.volume.contains(voxel)
    }

    /// Returns the contact of a bit at a pose: overlapping voxels, penetration depth and normal. A disc that
    /// is too deep overlaps one voxel, has the depth of its centre, and no normal.
    pub fn contact_at(&self, bit: &GridBit, pose: &Pose) -> Contact {
        let inner = |voxel| centre_depth_subunits(bit, pose, voxel);
        let depths = voxels_around(&self.volume, bit, pose).filter_map(inner);
        let (overlap, depth) = depths.fold((0, 0), |(n, most), depth| (n + 1, depth.max(most)));
        let on_mask = voxels_around(&self.mask, bit, pose)
            .any(|voxel| is_less_than_half_a_voxel_outside(bit, pose, voxel));
        match bit.shape {
            GridShape::Disc { radius, .. } if depth > bit.bite => {
                let middle_across = f64::from(8 * bit.bite.max(1)) / 3.0;
                let depth = radius.min(middle_across.ceil() as i32);
                Contact { overlap: 1, depth, normal: Vec3::ZERO, on_mask }
            }
            _ => Contact { overlap, depth, normal: self.normal_at(bit, pose), on_mask },
        }
    }

    /// Returns the normal of the surface that a bit overlaps.
    fn normal_at(&self, bit: &GridBit, pose: &Pose) -> Vec3 {
        let mut normal = IVec3::ZERO;
        for voxel in voxels_around(&self.volume, bit, pose) {
            if centre_depth_subunits(bit, pose, voxel).is_none() {
                continue;
            }
            for near in face_neighbours(voxel) {
                if !self.volume.contains(near) {
                    normal += IVec3::from_array(near) - IVec3::from_array(voxel);
                }
            }
        }
        normal.as_vec3().normalize_or_zero()
    }

    /// Returns the penetration depths of a bit at a pose.
    pub fn penetration_at(&self, bit: &GridBit, pose: &Pose) -> PenetrationDepths {
        if self.is_outside_grid(bit, pose) {
            return PenetrationDepths { volume: 0, mask: 0 };
        }
        let deepest = |voxels: &DenseVolume| {
            let inner = |voxel: [i32; 3]| centre_depth_subunits(bit, pose, voxel);
            voxels_around(voxels, bit, pose).filter_map(inner).max().unwrap_or(0)
        };
        PenetrationDepths { volume: deepest(&self.volume), mask: deepest(&self.mask) }
    }

    /// Freezes a bit on its path from one pose to the tracked pose: walks step by step while the penetration
    /// is within the limit, then slides once along the tangent. A buried bit stays, or jumps to its tracked
    /// pose.
    pub fn freeze_by_walk(
        &self,
        bit: &GridBit,
        from: &Pose,
        tracked: &Pose,
        budget: WayBudget,
    ) -> FreezeResult {
        self.freeze(bit, (from, tracked), budget, true)
    }

    /// Freezes a bit as [`Self::freeze_by_walk`] does, without the slide.
    pub fn freeze_by_walk_straight(
        &self,
        bit: &GridBit,
        from: &Pose,
        tracked: &Pose,
        budget: WayBudget,
    ) -> FreezeResult {
        self.freeze(bit, (from, tracked), budget, false)
    }

    fn freeze(
        &self,
        bit: &GridBit,
        (from, tracked): (&Pose, &Pose),
        budget: WayBudget,
        slides: bool,
    ) -> FreezeResult {
        let stands =
            FreezeResult { pose: *from, blocked: false, ran_out: true, jumped: false, steps: 0 };
        if budget.steps == 0 || budget.quarter_voxels == 0 {
            return stands;
        }
        if self.buries(bit, from) {
            return self.jump_if_bite_allows(bit, from, tracked, budget);
        }
        let mut left = budget;
        let walk = self.walk_while_allowed(bit, from, tracked, &mut left);
        let mut frozen =
            FreezeResult { pose: walk.last_allowed, ran_out: walk.ran_out, steps: 0, ..stands };
        frozen.blocked = walk.first_forbidden.is_some();
        if let Some(stop) = walk.first_forbidden.filter(|_| slides) {
            let slide = self.slide(bit, &frozen.pose, &stop, tracked, &mut left);
            if !self.may_cross_stone(bit, from, &slide.last_allowed) {
                (frozen.pose, frozen.ran_out) = (slide.last_allowed, slide.ran_out);
            }
        }
        FreezeResult { steps: budget.steps - left.steps, ..frozen }
    }

    /// Freezes a bit without a path: it jumps to its tracked pose if its bite allows that, else it stays.
    pub fn jump_if_bite_allows(
        &self,
        bit: &GridBit,
        from: &Pose,
        tracked: &Pose,
        budget: WayBudget,
    ) -> FreezeResult {
        let steps = deep_step_cost_in_steps(self.volume.side()).min(budget.steps);
        let usual = PenetrationDepths { volume: bit.bite, mask: 0 };
        let is_spent = budget.steps == 0 || budget.quarter_voxels == 0;
        let jumped = !is_spent && self.penetration_at(bit, tracked).are_at_most(usual);
        let pose = if jumped { *tracked } else { *from };
        FreezeResult { pose, blocked: !jumped, ran_out: false, jumped, steps }
    }

    /// Returns `true` if the bit is too deep and its centre may be in stone.
    pub fn buries(&self, bit: &GridBit, pose: &Pose) -> bool {
        let unburied = bit.inscribed_radius_subunits() - BURIED_WITHIN;
        let sits = self.penetration_at(bit, pose);
        // A disc that is too deep anywhere counts as buried.
        let in_figure = matches!(bit.shape, GridShape::Disc { .. }) && sits.mask > 0;
        in_figure || sits.volume > unburied.max(bit.bite)
    }

    /// Returns `true` unless the straight path of the bit's centre is certainly free of stone.
    fn may_cross_stone(&self, bit: &GridBit, from: &Pose, to: &Pose) -> bool {
        let unburied = bit.inscribed_radius_subunits() - BURIED_WITHIN;
        let centre = PenetrationDepths { volume: unburied, mask: i32::MAX };
        unburied >= bit.bite && !self.is_sweep_free(bit, from, to, centre)
    }

    /// Slides a bit that was stopped.
    fn slide(
        &self,
        bit: &GridBit,
        reached: &Pose,
        stop: &Pose,
        tracked: &Pose,
        left: &mut WayBudget,
    ) -> PathWalk {
        let offset_left = tracked.position - reached.position;
        let is_disc = matches!(bit.shape, GridShape::Disc { .. });
        let cost = slide_cost_in_steps(self.volume.side(), is_disc);
        left.steps = left.steps.saturating_sub(cost);
        let surface = self.normal_at(bit, stop);
        let normal = match surface {
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
        let mut slide = self.walk_while_allowed(bit, reached, &target, left);
        let mut met = vec![self.away_from_stops(bit, reached, stop)];
        while met.len() <= MAX_SLIDES && left.steps > 0 && left.quarter_voxels > 0 {
            let (at, Some(stop)) = (slide.last_allowed, slide.first_forbidden) else { break };
            met.push(self.away_from_stops(bit, &at, &stop));
            let mut way = tracked.position - at.position;
            let against_surface = std::iter::repeat_n(&surface, 4);
            for normal in against_surface.chain(met.iter().cycle().take(4 * met.len())) {
                let inward = way.dot(*normal);
                if inward < 0.0 {
                    way -= *normal * inward;
                }
            }
            let steepness = (met.len() - 1) as f32 / 8.0;
            way += met[met.len() - 1] * (way.length() * steepness);
            if (way * STEPS_PER_VOXEL).length_squared() <= 1.0 {
                break;
            }
            left.steps = left.steps.saturating_sub(cost);
            let target = Pose { position: at.position + way, ..at };
            slide = self.walk_while_allowed(bit, &at, &target, left);
        }
        slide
    }

    /// Returns the mean direction from the voxels that stop the bit to the bit's centre.
    fn away_from_stops(&self, bit: &GridBit, reached: &Pose, stop: &Pose) -> Vec3 {
        let sits = self.penetration_at(bit, reached);
        let mut away = I64Vec3::ZERO;
        for voxel in voxels_around(&self.volume, bit, stop) {
            let inner = centre_depth_subunits(bit, stop, voxel).unwrap_or(i32::MIN);
            let held = self.mask.contains(voxel);
            if inner > bit.bite.max(sits.volume) || (held && inner > sits.mask) {
                away -= centre_offset_subunits(stop, voxel);
            }
        }
        away.as_vec3().normalize_or_zero()
    }

    /// Walks a path while the penetration is within the limit. A bit that is too deep leaves the stone where
    /// the path does. A stretch of the path that is tested at once costs one step, and no more if it is free.
    pub fn walk_while_allowed(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        left: &mut WayBudget,
    ) -> PathWalk {
        let poses: Vec<Pose> = path_poses(bit, from, to).collect();
        let mut reached = *from;
        let mut sits = self.penetration_at(bit, from);
        let (mut steps_done, mut singly_to, mut stretch) = (0, 0, SHORT_STRETCH as usize);
        let spend = |left: &mut WayBudget, steps: u32, way: usize| {
            left.steps = left.steps.saturating_sub(steps);
            left.quarter_voxels = left.quarter_voxels.saturating_sub(way as u32);
        };
        while steps_done < poses.len() && left.steps > 0 && left.quarter_voxels > 0 {
            let usual = PenetrationDepths { volume: bit.bite, mask: 0 };
            let limits = PenetrationDepths { volume: bit.bite.max(sits.volume), mask: sits.mask };
            let last = poses.len().min(steps_done.saturating_add(left.quarter_voxels as usize));
            if steps_done >= singly_to {
                let end = (steps_done + stretch).min(last);
                let cost = bit.swept_brush(&reached, &poses[end - 1]).pieces().count() as u32;
                spend(left, if limits == usual { cost } else { 0 }, 0);
                if limits == usual && self.is_sweep_free(bit, &reached, &poses[end - 1], usual) {
                    assert!(
                        poses[steps_done..end]
                            .iter()
                            .all(|pose| self.penetration_at(bit, pose).are_at_most(usual))
                    );
                    spend(left, 0, end - steps_done);
                    (steps_done, reached) = (end, poses[end - 1]);
                    (sits, stretch) = (self.penetration_at(bit, &reached), LONG_STRETCH as usize);
                    continue;
                }
                if stretch > SHORT_STRETCH as usize {
                    stretch = SHORT_STRETCH as usize;
                    continue;
                }
                singly_to = end;
                continue;
            }
            let deep = deep_step_cost_in_steps(self.volume.side());
            spend(left, if limits == usual { 1 } else { deep }, 1);
            let next = poses[steps_done];
            steps_done += 1;
            let depths = self.penetration_at(bit, &next);
            if depths.are_at_most(limits) {
                (reached, sits) = (next, depths);
                continue;
            }
            let stopped =
                PathWalk { last_allowed: reached, first_forbidden: Some(next), ran_out: false };
            if limits == usual {
                return stopped;
            }
            let probes = exit_probe_steps(steps_done as u32, last as u32, left.steps);
            let probes: Vec<usize> = probes.map(|step| step as usize).collect();
            let (tried, exit) = self.find_exit_step(bit, limits, &reached, &poses, &probes);
            spend(left, tried, 0);
            let Some(step) = exit else {
                return stopped;
            };
            spend(left, 0, step - steps_done);
            (steps_done, reached) = (step, poses[step - 1]);
            sits = self.penetration_at(bit, &reached);
        }
        let ran_out = steps_done < poses.len();
        PathWalk { last_allowed: reached, first_forbidden: None, ran_out }
    }

    /// Returns the number of exit probes tried, and the first at which the bit is out of the stone; probe 1
    /// is the first pose of `path`. Only probes that the bit's centre reaches without crossing stone count.
    fn find_exit_step(
        &self,
        bit: &GridBit,
        limits: PenetrationDepths,
        last_allowed: &Pose,
        path: &[Pose],
        probes: &[usize],
    ) -> (u32, Option<usize>) {
        let unburied = bit.inscribed_radius_subunits() - BURIED_WITHIN;
        let open = PenetrationDepths { volume: unburied, ..limits };
        let usual = PenetrationDepths { volume: bit.bite, mask: 0 };
        let mut last = *last_allowed;
        for (tried, step) in (1..).zip(probes) {
            let pose = path[step - 1];
            if !self.is_sweep_free(bit, &last, &pose, open) {
                return (tried, None);
            }
            if self.penetration_at(bit, &pose).are_at_most(usual) {
                return (tried, Some(*step));
            }
            last = pose;
        }
        (probes.len() as u32, None)
    }

    /// Returns `true` if the swept volume of the bit, shrunk to the allowed depths, contains no voxel.
    /// Conservative.
    fn is_sweep_free(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        allowed: PenetrationDepths,
    ) -> bool {
        let clear = |level, voxels: &DenseVolume| {
            let brush = bit.swept_cover_deeper_than(level, from, to);
            brush.is_none_or(|brush| !brush.pieces().any(|piece| holds_any(&piece, voxels)))
        };
        match self.is_mask_alone {
            // One test with the lower limit: a cover of a greater depth has fewer pieces, so it may reach
            // farther.
            true => clear(allowed.mask.min(allowed.volume), &self.mask),
            false => clear(allowed.volume, &self.volume) && clear(allowed.mask, &self.mask),
        }
    }

    /// Returns `true` if the whole bit lies outside the grid.
    fn is_outside_grid(&self, bit: &GridBit, pose: &Pose) -> bool {
        let n = self.volume.side() as f32;
        let outer = bit.circumscribed_radius_subunits() as f32 / SUBUNITS_PER_VOXEL as f32 + 1.0;
        let held = pose.position.clamp(Vec3::ZERO, Vec3::splat(n));
        held.distance(pose.position) > outer
    }
}
