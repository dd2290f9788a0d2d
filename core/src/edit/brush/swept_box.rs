//! An oriented box swept along a line: the intersection of six slabs (pairs of parallel planes).

use glam::IVec3;

use super::{FAR, SubunitInterval, clamp_to_far, voxel_centre_subunits, voxels_with_centre_in};
use crate::edit::pose::{FIXED_ONE, Pose, SUBUNITS_PER_VOXEL};
use crate::volume::range::Range;

/// An oriented box swept along a straight line: the points `p` with `|plane . (2p - middle)| <=
/// extent` for its six pairs of planes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SweptBox {
    /// Twice the middle of the path, in fixed point.
    pub middle: IVec3,
    /// The slabs as normals, whose x isn't negative, and extents: three of the box's faces and three
    /// added by the sweep.
    pub planes: [([i64; 3], i64); 6],
    /// Half extents along the grid's axes, in fixed point, rounded up.
    pub reach: IVec3,
    /// The sides of its projection along x: parallel to its three edges and to the path.
    sides: [ProjectedSlab; 4],
    is_still: bool,
}

/// A 2D slab of the projection along x: the points `(y, z)` with `|up * z - slope * y| <= extent`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct ProjectedSlab {
    up: i64,
    slope: i64,
    extent: i64,
}

impl SweptBox {
    /// Creates a box with the rotation of the pose `end`, moved straight from a start to that pose's
    /// position. The path is rounded to fixed point in the box's own frame, so the planes are those of an
    /// exact swept box. A moving box is half a unit wider, so that the rounding loses nothing.
    #[must_use]
    pub fn new(half_extents_subunits: IVec3, end: &Pose, start_subunits: IVec3) -> Self {
        let unit = i64::from(FIXED_ONE);
        let axes = end
            .unit_axes_q14()
            .map(|axis| axis.to_array().map(|c| i64::from(c).clamp(-unit, unit)));
        let (start, end) = (clamp_to_far(start_subunits), end.clamped_position_subunits());
        let travel = (end - start).to_array().map(i64::from);
        let doubled = half_extents_subunits
            .to_array()
            .map(|h| 2 * i64::from(h.clamp(0, FAR)) + i64::from(start != end));
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
        // Every `2p - middle` is a sum of these, each times -1 to 1, up to `margin` per component.
        let edges = [edge(0), edge(1), edge(2), travel];
        // Rounding an axis tilts it by up to a part in 2^15, which is multiplied by the box's size.
        let size: i64 = doubled.iter().chain(&travel).map(|l| l.abs()).sum();
        let margin = size / (1 << 12) + 16;
        let reach = core::array::from_fn(|k| {
            let sum: i64 = edges.iter().map(|edge| edge[k].abs()).sum();
            ((sum + margin) / 2 + 1) as i32
        });
        SweptBox {
            middle: start + end,
            planes: [face(0), face(1), face(2), swept(0, 1), swept(0, 2), swept(1, 2)],
            reach: IVec3::from_array(reach),
            sides: edges.map(|edge| ProjectedSlab::new(edge, &edges, margin)),
            is_still: start == end,
        }
    }

    /// Returns its slice at a fixed-point y.
    #[inline]
    pub(super) fn layer(&self, y_subunits: i64) -> BoxLayer<'_> {
        let at = 2 * y_subunits - i64::from(self.middle.y);
        let first = 2 * voxel_centre_subunits(0) - i64::from(self.middle.x);
        BoxLayer {
            swept: self,
            at,
            planes: self.planes.map(|(normal, _)| normal[0] * first + normal[1] * at),
        }
    }
}

impl ProjectedSlab {
    /// Creates the slab parallel to `side` that holds all sums of the `edges`, each times -1 to 1, up to
    /// `rounding_margin` a component.
    fn new(side: [i64; 3], edges: &[[i64; 3]; 4], rounding_margin: i64) -> Self {
        let [_, up, slope] = side.map(|c| c * side[1].signum());
        let across = |edge: &[i64; 3]| (up * edge[2] - slope * edge[1]).abs();
        let extent = edges.iter().map(across).sum::<i64>() + (up + slope.abs()) * rounding_margin;
        ProjectedSlab { up, slope, extent }
    }
}

/// The rows of a [`SweptBox`] at one y.
#[derive(Clone, Copy, Debug)]
pub(super) struct BoxLayer<'a> {
    swept: &'a SweptBox,
    /// Twice the layer's y, relative to the middle.
    at: i64,
    /// The planes at voxel 0 of the row through the middle.
    planes: [i64; 6],
}

impl BoxLayer<'_> {
    /// Returns the z of the rows that may hold voxels: the projection along x is a convex polygon whose sides
    /// are parallel to the projected edges.
    #[inline]
    pub(super) fn z_range(&self, grid_side: usize) -> Option<Range> {
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
        let inside = SubunitInterval {
            lo: (middle + lo).div_euclid(2),
            hi: (middle + hi).div_euclid(2) + 1,
        };
        voxels_with_centre_in(inside, grid_side)
    }

    /// Returns the voxels `among` of its row at a fixed-point z, by slab clipping. A plane costs a division
    /// only if it clips more than the planes before it and leaves any voxels.
    #[inline]
    pub(super) fn x_range_among(&self, z_subunits: i64, among: Range) -> Option<Range> {
        let z = 2 * z_subunits - i64::from(self.swept.middle.z);
        let (mut lo, mut hi) = (among.first() as i64, among.last() as i64);
        // The sweep adds no faces to a box that doesn't move.
        let faces = if self.swept.is_still { 3 } else { 6 };
        for ((normal, extent), at) in self.swept.planes.iter().zip(self.planes).take(faces) {
            let at = at + normal[2] * z;
            let slope = normal[0] * 2 * i64::from(SUBUNITS_PER_VOXEL);
            // The voxels with |at + slope * x| <= extent; the slope isn't negative.
            let (below, above) = (-extent - at, extent - at);
            let (least, greatest) = (slope * lo, slope * hi);
            if above < least || below > greatest {
                return None;
            }
            if above < greatest {
                hi = above / slope;
            }
            if below > least {
                lo = (below + slope - 1) / slope;
            }
            if lo > hi {
                return None;
            }
        }
        Some(Range::new(lo as usize, hi as usize))
    }
}
