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
    /// Normals, none of which points to lower x, and extents: three faces of the box, three that
    /// the sweep adds.
    pub planes: [([i64; 3], i64); 6],
    /// Half extents along the grid's axes, in fixed point, rounded up.
    pub reach: IVec3,
    /// The sides of its shadow along x: those that the three edges and the path draw.
    sides: [Side; 4],
    is_still: bool,
}

/// A pair of sides of a shadow: the points `(y, z)` with `|up * z - slope * y| <= extent`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Side {
    up: i64,
    slope: i64,
    extent: i64,
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
        let rightward = |normal: [i64; 3]| match normal[0] < 0 {
            true => normal.map(|c| -c),
            false => normal,
        };
        let face = |i: usize| (rightward(axes[i]), (doubled[i] + w[i].abs()) * unit);
        let swept = |i: usize, j: usize| {
            let normal = core::array::from_fn(|k| axes[i][k] * w[j] - axes[j][k] * w[i]);
            (rightward(normal), (doubled[i] * w[j].abs() + doubled[j] * w[i].abs()) * unit)
        };
        let edge = |i: usize| axes[i].map(|c| c * doubled[i] / unit);
        // Sums of up to so much of each, forward or back, are all of `2p - middle`, but for `slack`.
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
            sides: edges.map(|edge| Side::new(edge, &edges, slack)),
            is_still: start == end,
        }
    }

    /// Its part in the rows at `y` (fixed point).
    #[inline]
    pub(super) fn layer(&self, y: i64) -> BoxLayer<'_> {
        let at = 2 * y - i64::from(self.middle.y);
        let first = 2 * centre(0) - i64::from(self.middle.x);
        BoxLayer {
            swept: self,
            at,
            planes: self.planes.map(|(normal, _)| normal[0] * first + normal[1] * at),
        }
    }
}

impl Side {
    fn new(edge: [i64; 3], edges: &[[i64; 3]; 4], slack: i64) -> Self {
        let [_, up, slope] = edge.map(|c| c * edge[1].signum());
        let across = |edge: &[i64; 3]| (up * edge[2] - slope * edge[1]).abs();
        let extent = edges.iter().map(across).sum::<i64>() + (up + slope.abs()) * slack;
        Side { up, slope, extent }
    }
}

/// The rows of a [`SweptBox`] at one y.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxLayer<'a> {
    swept: &'a SweptBox,
    /// Twice its y, from the middle.
    at: i64,
    /// The planes at voxel 0 of the row through the middle.
    planes: [i64; 6],
}

impl BoxLayer<'_> {
    /// The shadow of the box along x is a polygon whose sides run along the edges' shadows.
    #[inline]
    pub(super) fn rows(&self, n: usize) -> Option<(usize, usize)> {
        let [_, reach, reach_z] = self.swept.reach.to_array().map(i64::from);
        if self.at.abs() > 2 * reach {
            return None;
        }
        let (mut lo, mut hi) = (-2 * reach_z, 2 * reach_z);
        for side in &self.swept.sides {
            if side.up != 0 {
                let at = side.slope * self.at;
                lo = lo.max((at - side.extent).div_euclid(side.up));
                hi = hi.min((at + side.extent).div_euclid(side.up) + 1);
            }
        }
        let middle = i64::from(self.swept.middle.z);
        voxels_between((middle + lo).div_euclid(2), (middle + hi).div_euclid(2) + 1, n)
    }

    /// The voxels of its row at `z`: each plane's pair cuts off what is beyond them, and divides
    /// only if that is more than the others did.
    #[inline]
    pub(super) fn span(&self, z: i64, n: usize) -> Option<(usize, usize)> {
        let z = 2 * z - i64::from(self.swept.middle.z);
        let (mut lo, mut hi) = (0, n as i64 - 1);
        // Where nothing moves, the sweep adds no faces.
        let faces = if self.swept.is_still { 3 } else { 6 };
        for ((normal, extent), at) in self.swept.planes.iter().zip(self.planes).take(faces) {
            let at = at + normal[2] * z;
            let slope = normal[0] * 2 * i64::from(SUB);
            // The voxels with |at + slope * x| <= extent; the slope isn't negative.
            let (below, above) = (-extent - at, extent - at);
            if above < slope * hi {
                if above < 0 {
                    return None;
                }
                hi = above / slope;
            }
            if below > slope * lo {
                if slope == 0 {
                    return None;
                }
                lo = (below + slope - 1) / slope;
            }
            if lo > hi {
                return None;
            }
        }
        Some((lo as usize, hi as usize))
    }
}
