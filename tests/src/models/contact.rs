//! Contact voxel by voxel, and the freeze as a walk in small steps that skips nothing.

use glam::{I64Vec3, IVec3, Vec3};
use paros_core::contact::{Contact, Frozen, LONG_STRETCH, SHORT_STRETCH, looks};
use paros_core::limits::deep_steps;
use paros_core::pose::{Pose, SUB, UNIT};
use paros_core::tools::{GridBit, GridShape};

use super::dense::{Dense, neighbours};

/// Steps in a voxel's length of path.
pub const STEPS: f32 = 4.0;

/// What a bit can run into: a volume and the part of it that can't be removed.
#[derive(Debug)]
pub struct Block {
    volume: Dense,
    voxels: Vec<[i32; 3]>,
    masked: Vec<[i32; 3]>,
}

/// How deep a bit sits, in fixed point: in the volume and in the mask; 0 outside.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Depths {
    /// In the volume.
    pub volume: i32,
    /// In the mask.
    pub mask: i32,
}

impl Depths {
    /// Whether they are no greater than a bit's may be.
    fn suit(self, may: Depths) -> bool {
        self.volume <= may.volume && self.mask <= may.mask
    }
}

impl Block {
    /// A volume and its mask, which is part of it.
    pub fn new(volume: Dense, mask: &Dense) -> Self {
        assert!(mask.is_within(&volume), "the mask is part of the volume");
        Block { voxels: volume.occupied().collect(), masked: mask.occupied().collect(), volume }
    }

    /// What a bit touches at a pose.
    pub fn contact(&self, bit: &GridBit, pose: &Pose) -> Contact {
        let mut normal = IVec3::ZERO;
        let (mut overlap, mut depth) = (0, 0);
        for &voxel in &self.voxels {
            let Some(inner) = inner_distance(bit, pose, voxel) else { continue };
            overlap += 1;
            depth = depth.max(inner);
            for near in neighbours(voxel) {
                if !self.volume.contains(near) {
                    normal += IVec3::from_array(near) - IVec3::from_array(voxel);
                }
            }
        }
        let normal = normal.as_vec3().normalize_or_zero();
        let on_mask = self.masked.iter().any(|&voxel| is_near(bit, pose, voxel));
        Contact { overlap, depth, normal, on_mask }
    }

    /// How deep a bit sits.
    pub fn depths(&self, bit: &GridBit, pose: &Pose) -> Depths {
        if self.is_far(bit, pose) {
            return Depths { volume: 0, mask: 0 };
        }
        let deepest = |voxels: &[[i32; 3]]| {
            let inner = |&voxel: &[i32; 3]| inner_distance(bit, pose, voxel);
            voxels.iter().filter_map(inner).max().unwrap_or(0)
        };
        Depths { volume: deepest(&self.voxels), mask: deepest(&self.masked) }
    }

    /// Walks step by step while the bit sits no deeper than it may, then once along the tangent.
    pub fn freeze(&self, bit: &GridBit, from: &Pose, raw: &Pose, most: u32) -> Frozen {
        let mut left = most as usize;
        let (pose, blocked) = self.ways(bit, from, raw, &mut left);
        Frozen { pose, blocked, steps: most - left as u32 }
    }

    fn ways(&self, bit: &GridBit, from: &Pose, raw: &Pose, steps: &mut usize) -> (Pose, bool) {
        let (reached, stop) = self.walk(bit, from, raw, steps);
        let Some(stop) = stop else {
            return (reached, false);
        };
        let left = raw.position - reached.position;
        let normal = match self.contact(bit, &stop).normal {
            Vec3::ZERO => -left.normalize_or_zero(),
            normal => normal,
        };
        let inward = left.dot(normal);
        let target = if inward < 0.0 {
            Pose { position: reached.position + left - normal * inward, rotation: raw.rotation }
        } else {
            Pose { position: raw.position, rotation: reached.rotation }
        };
        let mut pose = self.walk(bit, &reached, &target, steps).0;
        let wanted = (target.position - reached.position) * STEPS;
        if pose.position == reached.position && wanted.length_squared() > 1.0 {
            let sits = self.depths(bit, &reached);
            let mut away = I64Vec3::ZERO;
            for voxel in &self.voxels {
                let inner = inner_distance(bit, &stop, *voxel).unwrap_or(i32::MIN);
                let held = self.masked.contains(voxel);
                if inner > bit.bite.max(sits.volume) || (held && inner > sits.mask) {
                    away -= from_bit(&stop, *voxel);
                }
            }
            let away = away.as_vec3().normalize_or_zero();
            let tangent = left - away * left.dot(away).min(0.0);
            let target = Pose { position: reached.position + tangent, ..reached };
            pose = self.walk(bit, &reached, &target, steps).0;
        }
        (pose, true)
    }

    /// The last pose that may be taken on the way, and the one after it. A bit that is too deep comes
    /// out where the way does. Stretches in which nothing stops the bit only count for less.
    pub fn walk(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        left: &mut usize,
    ) -> (Pose, Option<Pose>) {
        let poses: Vec<Pose> = path(bit, from, to).collect();
        let mut reached = *from;
        let mut sits = self.depths(bit, from);
        let (mut i, mut singly_to, mut stretch) = (0, 0, SHORT_STRETCH as usize);
        while i < poses.len() && *left > 0 {
            let usual = Depths { volume: bit.bite, mask: 0 };
            let may = Depths { volume: bit.bite.max(sits.volume), mask: sits.mask };
            if i >= singly_to {
                let end = (i + stretch).min(poses.len());
                if may == usual && self.is_free(bit, &reached, &poses[end - 1], usual) {
                    assert!(poses[i..end].iter().all(|pose| self.depths(bit, pose).suit(usual)));
                    (i, *left, reached) = (end, *left - 1, poses[end - 1]);
                    (sits, stretch) = (self.depths(bit, &reached), LONG_STRETCH as usize);
                    continue;
                }
                if stretch > SHORT_STRETCH as usize {
                    stretch = SHORT_STRETCH as usize;
                    continue;
                }
                singly_to = end;
            }
            *left = left.saturating_sub(if may == usual {
                1
            } else {
                deep_steps(self.volume.n()) as usize
            });
            let next = poses[i];
            i += 1;
            let depths = self.depths(bit, &next);
            if depths.suit(may) {
                (reached, sits) = (next, depths);
                continue;
            }
            if may == usual {
                return (reached, Some(next));
            }
            match self.way_out(bit, may, &reached, (&poses, i)) {
                Some(out) => (i, reached) = (out, poses[out - 1]),
                None => return (reached, Some(next)),
            }
            sits = self.depths(bit, &reached);
        }
        (reached, None)
    }

    /// The first of the looks after step `i` at which the bit is out: of all if its centre is in the
    /// stone, else of those that its centre reaches through the open.
    fn way_out(
        &self,
        bit: &GridBit,
        may: Depths,
        reached: &Pose,
        (poses, i): (&[Pose], usize),
    ) -> Option<usize> {
        let half_diagonal = (SUB as f32 * 0.866).ceil() as i32;
        let open = Depths { volume: bit.inner_radius() - half_diagonal, ..may };
        let mut last = *reached;
        for look in looks(i as u32, poses.len() as u32) {
            let pose = poses[look as usize - 1];
            if may.volume <= open.volume && !self.is_free(bit, &last, &pose, open) {
                return None;
            }
            if self.depths(bit, &pose).suit(Depths { volume: bit.bite, mask: 0 }) {
                return Some(look as usize);
            }
            last = pose;
        }
        None
    }

    /// Whether no voxel lies where the bit would get deeper than it may, nor where it nearly would.
    fn is_free(&self, bit: &GridBit, from: &Pose, to: &Pose, may: Depths) -> bool {
        let n = self.volume.n();
        let clear = |level, voxels: &[[i32; 3]]| {
            bit.swept_deeper_than(level, from, to).is_none_or(|brush| {
                let pieces: Vec<_> = brush.pieces().collect();
                !voxels.iter().any(|voxel| {
                    let [x, y, z] = voxel.map(|i| i as usize);
                    let holds = |(lo, hi)| (lo..=hi).contains(&x);
                    pieces.iter().any(|piece| piece.span(y, z, n).is_some_and(holds))
                })
            })
        };
        clear(may.volume, &self.voxels) && clear(may.mask, &self.masked)
    }

    /// Whether all of the bit is outside the grid.
    fn is_far(&self, bit: &GridBit, pose: &Pose) -> bool {
        let n = self.volume.n() as f32;
        let outer = bit.outer_radius() as f32 / SUB as f32 + 1.0;
        let held = pose.position.clamp(Vec3::ZERO, Vec3::splat(n));
        held.distance(pose.position) > outer
    }
}

/// The poses on the way, in steps of a quarter voxel of path and turn together; the last is `to`.
pub fn path(bit: &GridBit, from: &Pose, to: &Pose) -> impl Iterator<Item = Pose> + use<> {
    let (from, to) = (*from, *to);
    let turn = from.angle_to(&to) * bit.outer_radius() as f32 / SUB as f32;
    let length = (to.position - from.position).length() + turn;
    let steps = (length * STEPS).ceil().max(1.0) as u32;
    (1..=steps).map(move |i| from.toward(&to, i as f32 / steps as f32))
}

/// How far inside the bit a voxel's centre is, rounded up to whole fixed-point units; `None`
/// outside.
fn inner_distance(bit: &GridBit, pose: &Pose, voxel: [i32; 3]) -> Option<i32> {
    let p = from_bit(pose, voxel);
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
            let unit = i64::from(UNIT);
            let left = across(pose, p).map(|(i, across)| i64::from(half[i]) * unit - across);
            let least = *left.iter().min().expect("three axes");
            if least < 0 {
                return None;
            }
            (least + unit - 1) / unit
        }
    };
    Some(inner as i32)
}

/// Whether a voxel's centre is in the bit or less than a voxel outside its radius or faces.
fn is_near(bit: &GridBit, pose: &Pose, voxel: [i32; 3]) -> bool {
    let p = from_bit(pose, voxel);
    match bit.shape {
        GridShape::Ball(radius) => p.length_squared() < i64::from(radius + SUB).pow(2),
        GridShape::Box(half) => across(pose, p)
            .iter()
            .all(|&(i, across)| across < i64::from(half[i] + SUB) * i64::from(UNIT)),
    }
}

/// A voxel's centre, from the bit's.
fn from_bit(pose: &Pose, voxel: [i32; 3]) -> I64Vec3 {
    let centre = voxel.map(|i| i64::from(i * SUB + SUB / 2));
    I64Vec3::from_array(centre) - pose.fixed_position().as_i64vec3()
}

/// How far a point is from the bit's centre along each of its axes, times [`UNIT`].
fn across(pose: &Pose, p: I64Vec3) -> [(usize, i64); 3] {
    let axes = pose.fixed_axes();
    [0, 1, 2].map(|i| (i, p.dot(axes[i].as_i64vec3()).abs()))
}
