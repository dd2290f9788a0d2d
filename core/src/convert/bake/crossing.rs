//! Ray crossings: the first and the last crossing of the mesh by the rays through the columns' centres, and
//! their directions.
//!
//! Ties are broken by simulation of simplicity (Edelsbrunner and Muecke, 1990). Each ray counts as displaced
//! by (e, e^2) for an infinitesimal e, the same for all triangles. So it meets no edge and no vertex, crosses
//! a surface once at an edge that two triangles share, and crosses surfaces that coincide under it one after
//! the other. No e appears in the code: if two values are equal, their slopes decide. Only overlapping
//! coplanar triangles are crossed together; their directions are summed.

use super::BAKE_UNITS_PER_VOXEL;
use super::triangle::{GridTriangle, ProjectedEdge, other_axes};
use super::winding::Windings;
use crate::volume::range_maps::Axis;
use core::cmp::Ordering;

/// A crossing of a column's ray: its height along the ray as the fraction `height / scale`, and the
/// derivative of that height by the displacement.
#[derive(Clone, Copy, Debug)]
struct RayCrossing {
    height: i64,
    slope: [i64; 2],
    /// Positive; 0 if there is no crossing.
    scale: i64,
    /// Surfaces entered minus surfaces left here, in the direction of the axis.
    entered: i32,
}

/// The first and the last crossing of a column. All zero bytes mean no crossing.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnCrossings {
    first: RayCrossing,
    last: RayCrossing,
}

/// For each end of a column's ray, `true` if the ray is inside the mesh there: before its first crossing, or
/// after its last.
#[derive(Clone, Copy)]
pub(super) struct OpenEnds {
    pub(super) low: bool,
    pub(super) high: bool,
}

impl ColumnCrossings {
    pub(super) const NONE: ColumnCrossings =
        ColumnCrossings { first: RayCrossing::NONE, last: RayCrossing::NONE };

    /// Returns the ends at which the mesh has a hole.
    #[inline]
    pub(super) fn ends_at_holes(&self, is_mesh_inside_out: bool) -> OpenEnds {
        if is_mesh_inside_out {
            OpenEnds { low: self.first.entered > 0, high: self.last.entered < 0 }
        } else {
            OpenEnds { low: self.first.entered < 0, high: self.last.entered > 0 }
        }
    }

    #[inline]
    fn add_crossing(&mut self, crossing: RayCrossing) {
        if self.first.scale == 0 {
            *self = ColumnCrossings { first: crossing, last: crossing };
            return;
        }
        self.first.merge_outermost(crossing, Ordering::Less);
        self.last.merge_outermost(crossing, Ordering::Greater);
    }
}

impl RayCrossing {
    const NONE: RayCrossing = RayCrossing { height: 0, slope: [0; 2], scale: 0, entered: 0 };

    /// Compares two crossings by their order along the displaced ray.
    #[inline]
    fn compare_along_ray(&self, other: &RayCrossing) -> Ordering {
        let by = |mine: i64, its: i64| {
            let mine = i128::from(mine) * i128::from(other.scale);
            mine.cmp(&(i128::from(its) * i128::from(self.scale)))
        };
        by(self.height, other.height)
            .then_with(|| by(self.slope[0], other.slope[0]))
            .then_with(|| by(self.slope[1], other.slope[1]))
    }

    /// Replaces the crossing by `other` if that is farther out, or merges them if they are equal. `outward`
    /// is the order along the ray of a crossing farther out.
    #[inline]
    fn merge_outermost(&mut self, other: RayCrossing, outward: Ordering) {
        let order = other.compare_along_ray(self);
        if order == outward.reverse() {
            return;
        }
        if order == Ordering::Equal {
            self.entered += other.entered;
        } else {
            *self = other;
        }
    }
}

/// Adds the crossings of a triangle with the rays along `axis` to their columns, indexed by
/// [`Axis::column_address`].
#[inline(always)]
pub(super) fn add_triangle_crossings<const N: usize>(
    triangle: &GridTriangle,
    axis: Axis,
    columns: &mut [[ColumnCrossings; N]; N],
    windings: &mut impl Windings<N>,
) {
    let w = axis as usize;
    let [u, v] = other_axes(w);
    let facing = triangle.normal[w].signum();
    let [u_centres, v_centres] = [u, v].map(|k| triangle.centres[k][0]..triangle.centres[k][1]);
    if facing == 0 || u_centres.is_empty() || v_centres.is_empty() {
        return;
    }
    let edges = triangle.projected_edges(w);
    for i in u_centres {
        let p_u = voxel_centre_bake_units(i) - triangle.origin[u];
        for j in v_centres.clone() {
            let p_v = voxel_centre_bake_units(j) - triangle.origin[v];
            if edges.iter().all(|edge| edge.contains_displaced_point(facing, [p_u, p_v])) {
                let mut voxel = [0; 3];
                (voxel[u], voxel[v]) = (i as usize, j as usize);
                let (line, place) = axis.column_address(voxel);
                let [n_u, n_v, n_w] = [u, v, w].map(|k| triangle.normal[k] * facing);
                let corner = triangle.corners[0];
                let height = n_w * (corner[w] + triangle.origin[w])
                    - n_u * (p_u - corner[u])
                    - n_v * (p_v - corner[v]);
                columns[line][place].add_crossing(RayCrossing {
                    height,
                    slope: [-n_u, -n_v],
                    scale: n_w,
                    entered: -(facing as i32),
                });
                windings.add_crossing(axis, (line, place), -(facing as i8), || {
                    triangle.voxel_containing_height(w, height, n_w)
                });
            }
        }
    }
}

impl ProjectedEdge {
    /// Returns `true` if a displaced point is on the inner side. `projected_area_sign` is the sign of the
    /// projection's area, not 0.
    #[inline(always)]
    fn contains_displaced_point(&self, projected_area_sign: i64, [p_u, p_v]: [i64; 2]) -> bool {
        let [s, t] = self.slope;
        let value = match s * p_u + t * p_v + self.offset {
            0 if s != 0 => s,
            0 => t,
            value => value,
        };
        (value ^ projected_area_sign) >= 0
    }
}

impl GridTriangle {
    /// Returns the voxel along an axis at the height `height / scale`, which must be one of the triangle's
    /// voxels; on a face, the upper of the two voxels in the grid.
    #[inline(always)]
    fn voxel_containing_height(&self, axis: usize, height: i64, scale: i64) -> usize {
        let (first, last) = (self.first[axis], self.last[axis]);
        match last - first {
            0 => first,
            // The origin is on the face between the two.
            1 => first + usize::from(height >= scale * self.origin[axis]),
            _ => ((height / (scale * i64::from(BAKE_UNITS_PER_VOXEL))) as usize).min(last),
        }
    }
}

/// Returns the centre of voxel `i` along an axis, in bake units.
#[inline]
fn voxel_centre_bake_units(i: i32) -> i64 {
    i64::from(i * BAKE_UNITS_PER_VOXEL + BAKE_UNITS_PER_VOXEL / 2)
}
