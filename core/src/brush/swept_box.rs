//! A swept box: six pairs of planes, each of which bounds a row by two divisions.

use glam::IVec3;

use super::{FAR, centre, held, voxels_between};
use crate::pose::{Pose, SUB, UNIT};

/// An oriented box swept along a straight line: the points `p` with `|plane . (2p - middle)| <=
/// extent` for its six pairs of planes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SweptBox {
    /// Twice the middle of the path, in fixed point.
    pub middle: IVec3,
    /// Normals and extents: three faces of the box, three that the sweep adds.
    pub planes: [([i64; 3], i64); 6],
    /// Half extents along the grid's axes, in fixed point, rounded up.
    pub reach: IVec3,
    /// The box's three edges and the path, in fixed point: sums of up to so much of each, forward
    /// or back, are all of `2p - middle`, but for `slack` either way.
    edges: [[i64; 3]; 4],
    slack: i64,
}

impl SweptBox {
    /// A box of half extents `half`, turned as `pose`, moved straight from `start` to the pose's
    /// position. The path is rounded to fixed point in the box's own frame, so the planes are those
    /// of an exact swept box; a box that moves is half a unit wider, so that the rounding loses
    /// nothing.
    #[must_use]
    pub fn new(half: IVec3, pose: &Pose, start: IVec3) -> Self {
        let unit = i64::from(UNIT);
        let axes =
            pose.fixed_axes().map(|axis| axis.to_array().map(|c| i64::from(c).clamp(-unit, unit)));
        let (start, end) = (held(start), pose.fixed_position());
        let travel = (end - start).to_array().map(i64::from);
        let doubled =
            half.to_array().map(|h| 2 * i64::from(h.clamp(0, FAR)) + i64::from(start != end));
        let w: [i64; 3] = axes.map(|axis| {
            let along: i64 = (0..3).map(|i| axis[i] * travel[i]).sum();
            (along + unit / 2).div_euclid(unit)
        });
        let face = |i: usize| (axes[i], (doubled[i] + w[i].abs()) * unit);
        let swept = |i: usize, j: usize| {
            let normal = core::array::from_fn(|k| axes[i][k] * w[j] - axes[j][k] * w[i]);
            (normal, (doubled[i] * w[j].abs() + doubled[j] * w[i].abs()) * unit)
        };
        let edge = |i: usize| axes[i].map(|c| c * doubled[i] / unit);
        let edges = [edge(0), edge(1), edge(2), travel];
        // Rounding an axis tilts it by up to a part in 2^15, which counts as far as the box reaches.
        let size: i64 = doubled.iter().chain(&travel).map(|l| l.abs()).sum();
        let slack = size / (1 << 12) + 16;
        let reach = core::array::from_fn(|k| {
            let sum: i64 = edges.iter().map(|edge| edge[k].abs()).sum();
            ((sum + slack) / 2 + 1) as i32
        });
        SweptBox {
            middle: start + end,
            planes: [face(0), face(1), face(2), swept(0, 1), swept(0, 2), swept(1, 2)],
            reach: IVec3::from_array(reach),
            edges,
            slack,
        }
    }

    /// The shadow of the box along x is a polygon whose sides run along the edges' shadows.
    pub(super) fn rows(&self, y: i64, n: usize) -> Option<(usize, usize)> {
        let at = 2 * y - i64::from(self.middle.y);
        let [_, reach, reach_z] = self.reach.to_array().map(i64::from);
        if at.abs() > 2 * reach {
            return None;
        }
        let (mut lo, mut hi) = (-2 * reach_z, 2 * reach_z);
        for side in self.edges {
            if side[1] == 0 {
                continue;
            }
            // Of this sign, the side's shadow runs up.
            let [_, sy, sz] = side.map(|c| c * side[1].signum());
            let across = |edge: &[i64; 3]| (sy * edge[2] - sz * edge[1]).abs();
            let extent: i64 =
                self.edges.iter().map(across).sum::<i64>() + (sy + sz.abs()) * self.slack;
            lo = lo.max((sz * at - extent).div_euclid(sy));
            hi = hi.min((sz * at + extent).div_euclid(sy) + 1);
        }
        let middle = i64::from(self.middle.z);
        voxels_between((middle + lo).div_euclid(2), (middle + hi).div_euclid(2) + 1, n)
    }

    pub(super) fn span(&self, y: i64, z: i64, n: usize) -> Option<(usize, usize)> {
        let step = 2 * i64::from(SUB);
        let first = 2 * centre(0) - i64::from(self.middle.x);
        let (y, z) = (2 * y - i64::from(self.middle.y), 2 * z - i64::from(self.middle.z));
        let (mut lo, mut hi) = (0, n as i64 - 1);
        // Where nothing moves, the sweep adds no faces.
        let faces = if self.edges[3] == [0; 3] { 3 } else { 6 };
        for (normal, extent) in &self.planes[..faces] {
            let at_zero = normal[0] * first + normal[1] * y + normal[2] * z;
            let slope = normal[0] * step;
            if slope == 0 {
                if at_zero.abs() > *extent {
                    return None;
                }
                continue;
            }
            let at_zero = if slope < 0 { -at_zero } else { at_zero };
            let slope = slope.abs();
            lo = lo.max(-(extent + at_zero).div_euclid(slope));
            hi = hi.min((extent - at_zero).div_euclid(slope));
            if lo > hi {
                return None;
            }
        }
        Some((lo as usize, hi as usize))
    }
}
