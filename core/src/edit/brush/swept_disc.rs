//! A disc swept along a line: a capsule between two parallel planes.

use glam::IVec3;

use super::capsule::BallLayer;
use super::{
    BrushBounds, Capsule, FAR, SlabRows, SubunitInterval, clamp_to_far, isqrt,
    voxel_centre_subunits, voxels_with_centre_in,
};
use crate::edit::pose::{FIXED_ONE, Pose, SUBUNITS_PER_VOXEL};
use crate::volume::range::Range;
use crate::volume::row::BitSet;

/// A disc of constant normal, swept along a straight line: the points `p` of a capsule with
/// `|normal . (2p - middle)| <= extent`.
///
/// Along its own plane this is the exact swept disc, except that the ball rounds its rim: by a fortieth of a
/// voxel with a radius of 20 voxels and a thickness of two. Across its plane it is larger, by up to the whole
/// travel across at both ends, so a long travel across is divided.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SweptDisc {
    /// The swept ball that holds the disc.
    pub rim: Capsule,
    /// The disc's normal, whose x isn't negative.
    pub normal: [i64; 3],
    /// Twice the middle of the path, in fixed point.
    pub middle: IVec3,
    /// Half of the slab's thickness, in doubled fixed point times [`FIXED_ONE`].
    pub extent: i64,
}

/// The shape of a disc about its centre, in fixed point. Its normal is the x axis of its pose.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct DiscShape {
    /// Greatest squared distance from its centre.
    pub(crate) radius_squared: i64,
    /// Greatest distance from its plane, doubled and times [`FIXED_ONE`].
    pub(crate) extent: i64,
}

impl DiscShape {
    /// Creates a disc from a radius and half a thickness, boundary included.
    pub(crate) fn new(radius_subunits: i32, half_thickness_subunits: i32) -> Self {
        let [radius, half] =
            [radius_subunits, half_thickness_subunits].map(|v| i64::from(v.clamp(0, FAR)));
        DiscShape { radius_squared: radius * radius, extent: 2 * half * i64::from(FIXED_ONE) }
    }
}

/// Returns the normal of a disc at a pose, in fixed point.
pub(super) fn disc_normal(pose: &Pose) -> [i64; 3] {
    let unit = i64::from(FIXED_ONE);
    pose.unit_axes_q14()[0].to_array().map(|c| i64::from(c).clamp(-unit, unit))
}

/// Maximum row length at which testing each voxel is cheaper than computing the roots of the ball's ends.
const MOST_TESTED_ONE_BY_ONE: usize = 4;

/// Returns the intersection of two ranges.
fn common_range(a: Range, b: Range) -> Option<Range> {
    let (first, last) = (a.first().max(b.first()), a.last().min(b.last()));
    (first <= last).then(|| Range::new(first, last))
}

fn dot(a: [i64; 3], b: IVec3) -> i64 {
    let b = b.to_array();
    (0..3).map(|i| a[i] * i64::from(b[i])).sum()
}

/// Returns the maximum distance that a disc moves across its plane between two poses, in fixed point.
pub(super) fn way_across_disc_subunits(from: &Pose, to: &Pose) -> i32 {
    let travel = to.clamped_position_subunits() - from.clamped_position_subunits();
    let across = |pose| dot(disc_normal(pose), travel).abs();
    (across(from).max(across(to)) / i64::from(FIXED_ONE)) as i32
}

impl SweptDisc {
    /// Creates a disc with the rotation of the pose `end`, moved straight from a start to that pose's
    /// position.
    pub(crate) fn new(disc: DiscShape, end: &Pose, start_subunits: IVec3) -> Self {
        let normal = disc_normal(end);
        let normal = if normal[0] < 0 { normal.map(|c| -c) } else { normal };
        let (a, b) = (clamp_to_far(start_subunits), end.clamped_position_subunits());
        let rim = Capsule { a, b, radius_squared: disc.radius_squared };
        SweptDisc { rim, normal, middle: a + b, extent: disc.extent + dot(normal, b - a).abs() }
    }

    /// Returns the bounding box of its voxels in a grid `grid_side` voxels wide, or `None` if it lies
    /// outside.
    pub(super) fn bounds(&self, grid_side: usize) -> Option<BrushBounds> {
        let unit = i64::from(FIXED_ONE);
        let Capsule { a, b, radius_squared } = self.rim;
        // The distance of a point across the plane from the nearest position of the path.
        let across = (self.extent + dot(self.normal, b - a).abs()) / (2 * unit) + 1;
        let mut bounds = BrushBounds { lo: [0; 3], hi: [0; 3] };
        for i in 0..3 {
            let n = self.normal[i];
            // The disc's circle and its thickness; the axis is rounded by up to a part in 2^15.
            let plane_part = (unit * unit - n * n).max(0) + 2 * unit;
            let in_plane = i128::from(radius_squared) * i128::from(plane_part);
            let in_plane = isqrt((in_plane / i128::from(unit * unit)) as i64);
            let reach = (in_plane + across * n.abs() / unit + 2).min(isqrt(radius_squared) + 1);
            let inside = SubunitInterval {
                lo: i64::from(a[i].min(b[i])) - reach,
                hi: i64::from(a[i].max(b[i])) + reach,
            };
            let voxels = voxels_with_centre_in(inside, grid_side)?;
            (bounds.lo[i], bounds.hi[i]) = (voxels.first(), voxels.last());
        }
        Some(bounds)
    }

    /// Returns the z range of the rows at a fixed-point y that may hold voxels. It is limited by the ball's
    /// radius at this y around the ends of the path, and by the planes over all x that the ball has there.
    #[inline]
    pub(super) fn z_range(&self, y_subunits: i64, grid_side: usize) -> Option<Range> {
        let Capsule { a, b, radius_squared } = self.rim;
        let [nx, ny, nz] = self.normal;
        let travel = (b - a).abs();
        let doubled_y = 2 * y_subunits - i64::from(self.middle.y);
        let away = (doubled_y.abs() - i64::from(travel.y)).max(0) / 2;
        let left = radius_squared - away * away;
        if left < 0 {
            return None;
        }
        let reach = isqrt(left) + 1;
        let of_ball = SubunitInterval {
            lo: i64::from(a.z.min(b.z)) - reach,
            hi: i64::from(a.z.max(b.z)) + reach,
        };
        if nz == 0 {
            return voxels_with_centre_in(of_ball, grid_side);
        }
        // |nx x + ny y + nz z| <= extent, all doubled and relative to the middle.
        let slack = self.extent + nx * (2 * reach + i64::from(travel.x));
        let ends = [-slack - ny * doubled_y, slack - ny * doubled_y].map(|end| end * nz.signum());
        let (lo, hi) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let middle = i64::from(self.middle.z);
        let of_planes = SubunitInterval {
            lo: (middle + lo.div_euclid(nz.abs())).div_euclid(2),
            hi: (middle + hi.div_euclid(nz.abs()) + 1).div_euclid(2) + 1,
        };
        let of_both =
            SubunitInterval { lo: of_ball.lo.max(of_planes.lo), hi: of_ball.hi.min(of_planes.hi) };
        voxels_with_centre_in(of_both, grid_side)
    }

    /// Returns the voxels of a row, given the fixed-point y and z of its centres: an interval of the slab,
    /// cut by the ball.
    #[inline]
    pub(super) fn x_range(
        &self,
        y_subunits: i64,
        z_subunits: i64,
        grid_side: usize,
    ) -> Option<Range> {
        let of_planes =
            self.x_range_of_planes(self.across_at(y_subunits, z_subunits), grid_side)?;
        self.cut_by_ball(of_planes, (y_subunits, z_subunits), grid_side)
    }

    /// Visits each row at a fixed-point y that holds voxels, with its z and the voxels.
    #[inline]
    pub(super) fn visit_rows(
        &self,
        y_subunits: i64,
        grid_side: usize,
        mut visit: impl FnMut(usize, Range),
    ) {
        let Some(z_range) = self.z_range(y_subunits, grid_side) else {
            return;
        };
        let mut across = self.across_at(y_subunits, voxel_centre_subunits(z_range.first()));
        let mut slab = self.slab_rows(y_subunits, z_range.first());
        let of_end = self.rim.ball_at_end(y_subunits);
        for z in z_range.first()..z_range.last() + 1 {
            let of_planes = match &mut slab {
                Some(slab) => self.x_range_near(slab.next_ends(), across, grid_side),
                None => self.x_range_of_planes(across, grid_side),
            };
            across += self.normal[2] * 2 * i64::from(SUBUNITS_PER_VOXEL);
            let Some(of_planes) = of_planes else {
                continue;
            };
            if let Some(x_range) = self.within_ball(of_planes, (y_subunits, z), &of_end, grid_side)
            {
                visit(z, x_range);
            }
        }
    }

    /// [`SweptDisc::visit_rows`], except rows without a voxel of `layer`, the grid's rows at this y. A disc
    /// without [`SweptDisc::slab_rows`] visits none.
    #[inline]
    pub(super) fn visit_rows_held<R: BitSet>(
        &self,
        y_subunits: i64,
        layer: &[R],
        mut visit: impl FnMut(usize, Range),
    ) {
        let grid_side = layer.len();
        let Some(z_range) = self.z_range(y_subunits, grid_side) else {
            return;
        };
        let Some(slab) = self.slab_rows(y_subunits, z_range.first()) else {
            return;
        };
        let of_end = self.rim.ball_at_end(y_subunits);
        let rows = &layer[z_range.first()..=z_range.last()];
        slab.find_row_holding(rows, (0, grid_side - 1), |i, ends| {
            let z = z_range.first() + i;
            let across = self.across_at(y_subunits, voxel_centre_subunits(z));
            let of_planes = self.x_range_near(ends, across, grid_side);
            let x_range = of_planes.and_then(|of_planes| {
                self.within_ball(of_planes, (y_subunits, z), &of_end, grid_side)
            });
            if let Some(x_range) = x_range {
                visit(z, x_range);
            }
            false
        });
    }

    /// Returns the part of the row at `z` between the planes that is in the ball. `of_end` is the ball's
    /// slice at its end.
    #[inline]
    fn within_ball(
        &self,
        of_planes: Range,
        (y_subunits, z): (i64, usize),
        of_end: &BallLayer,
        grid_side: usize,
    ) -> Option<Range> {
        let z_subunits = voxel_centre_subunits(z);
        // A capsule is convex: a row is inside if its ends are. Most rows' ends are in the ball at the path's
        // end.
        match of_end.holds_ends(of_planes, z_subunits) {
            true => Some(of_planes),
            false => self.cut_by_ball(of_planes, (y_subunits, z_subunits), grid_side),
        }
    }

    /// Returns a row's voxels that are in the ball.
    #[inline]
    fn cut_by_ball(&self, of_planes: Range, (y, z): (i64, i64), grid_side: usize) -> Option<Range> {
        let is_short = of_planes.last() - of_planes.first() < MOST_TESTED_ONE_BY_ONE;
        if is_short && self.rim.a == self.rim.b {
            return self.cut_by_still_ball(y, z, of_planes);
        }
        if is_short {
            let mut voxels = of_planes.first()..of_planes.last() + 1;
            let inside = |x: usize| self.rim.contains([voxel_centre_subunits(x), y, z]);
            let first = voxels.find(|x| inside(*x))?;
            let last = voxels.rfind(|x| inside(*x)).unwrap_or(first);
            return Some(Range::new(first, last));
        }
        common_range(self.rim.x_range_at(y, z, grid_side)?, of_planes)
    }

    /// Returns a row's voxels that are in the ball, if it doesn't move.
    #[inline]
    fn cut_by_still_ball(&self, y: i64, z: i64, voxels: Range) -> Option<Range> {
        let Capsule { a, radius_squared, .. } = self.rim;
        let (dy, dz) = (y - i64::from(a.y), z - i64::from(a.z));
        let left = radius_squared - dy * dy - dz * dz;
        let is_inside = |x: usize| {
            let dx = voxel_centre_subunits(x) - i64::from(a.x);
            dx * dx <= left
        };
        let (mut first, mut last) = (voxels.first(), voxels.last());
        while !is_inside(first) {
            first += 1;
            if first > last {
                return None;
            }
        }
        while !is_inside(last) {
            last -= 1;
        }
        Some(Range::new(first, last))
    }

    /// Returns the voxels between its planes, row by row at a fixed-point y from the row at `first_z` on,
    /// computed by additions (a digital differential analyser) instead of divisions. The result may have one
    /// voxel too many at an end, never too few. `None` for a disc that faces away from x, whose rows are long
    /// and few.
    pub(crate) fn slab_rows(&self, y_subunits: i64, first_z: usize) -> Option<SlabRows> {
        if !self.has_slab_rows() {
            return None;
        }
        let [nx, _, nz] = self.normal;
        let at = self.across_at(y_subunits, voxel_centre_subunits(first_z));
        let slope = nx * 2 * i64::from(SUBUNITS_PER_VOXEL);
        let end = |across: i64| ((across - at) << SlabRows::FRACTION_BITS).div_euclid(slope);
        Some(SlabRows {
            lo: end(-self.extent),
            hi: end(self.extent) + SlabRows::SLACK,
            step: (-nz << SlabRows::FRACTION_BITS).div_euclid(nx),
        })
    }

    /// Returns `true` if the disc has [`SweptDisc::slab_rows`].
    #[inline]
    pub(crate) fn has_slab_rows(&self) -> bool {
        self.normal[0] >= i64::from(FIXED_ONE) / 8
    }

    /// Returns the position of a row's voxel 0 across the disc: `normal . (2p - middle)`.
    #[inline]
    fn across_at(&self, y: i64, z: i64) -> i64 {
        let ([nx, ny, nz], middle) = (self.normal, self.middle.as_i64vec3());
        let x = voxel_centre_subunits(0);
        nx * (2 * x - middle.x) + ny * (2 * y - middle.y) + nz * (2 * z - middle.z)
    }

    /// Returns the voxels between the planes of a row whose voxel 0 lies at `across`.
    #[inline]
    fn x_range_of_planes(&self, across: i64, grid_side: usize) -> Option<Range> {
        let slope = self.normal[0] * 2 * i64::from(SUBUNITS_PER_VOXEL);
        // The voxels with |across + slope * x| <= extent; the slope isn't negative.
        let (below, above) = (-self.extent - across, self.extent - across);
        if slope == 0 {
            return (below <= 0 && above >= 0).then(|| Range::new(0, grid_side - 1));
        }
        let lo = (below + slope - 1).div_euclid(slope).max(0);
        let hi = above.div_euclid(slope).min(grid_side as i64 - 1);
        (lo <= hi).then(|| Range::new(lo as usize, hi as usize))
    }

    /// [`SweptDisc::x_range_of_planes`], from approximate ends that may have one voxel too many at either
    /// side.
    #[inline]
    fn x_range_near(&self, (lo, hi): (i64, i64), across: i64, grid_side: usize) -> Option<Range> {
        let slope = self.normal[0] * 2 * i64::from(SUBUNITS_PER_VOXEL);
        let lo = lo + i64::from(across + slope * lo < -self.extent);
        let hi = hi - i64::from(across + slope * hi > self.extent);
        let (lo, hi) = (lo.max(0), hi.min(grid_side as i64 - 1));
        (lo <= hi).then(|| Range::new(lo as usize, hi as usize))
    }
}
