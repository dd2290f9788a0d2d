//! Where the rays through the columns' centres cross the mesh first and last, and which way.
//!
//! Each ray is thought displaced by (e, e^2) for an e smaller than any other length, the same for
//! all triangles: then it meets no edge and no vertex, crosses a surface once where two triangles
//! share an edge, and crosses surfaces that meet under it one after the other. No e appears in the
//! code: where two values are equal, their slopes decide (Edelsbrunner and Muecke 1990). Only
//! triangles that overlap in one plane are crossed together; there the directions are added up.

use super::UNITS;
use super::shape::{Edge, Shape, across};
use crate::maps::Axis;
use core::cmp::Ordering;

/// A crossing of a column's ray: the height along it as the fraction `height / scale`, and how that
/// grows with the displacement.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    height: i64,
    slope: [i64; 2],
    /// Positive; 0 where there is no crossing.
    scale: i64,
    /// Surfaces entered less surfaces left here, along the axis.
    entered: i32,
}

/// The first and the last crossing of a column. All zero bytes: no crossing.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    first: Crossing,
    last: Crossing,
}

impl Ends {
    pub(super) const NONE: Ends = Ends { first: Crossing::NONE, last: Crossing::NONE };

    /// Whether the ray is inside the mesh before its first crossing, and after its last.
    #[inline]
    pub(super) fn open(&self, flipped: bool) -> (bool, bool) {
        if flipped {
            (self.first.entered > 0, self.last.entered < 0)
        } else {
            (self.first.entered < 0, self.last.entered > 0)
        }
    }

    #[inline]
    fn add(&mut self, crossing: Crossing) {
        if self.first.scale == 0 {
            *self = Ends { first: crossing, last: crossing };
            return;
        }
        let order = crossing.cmp(&self.first);
        if order != Ordering::Greater {
            self.first.join(crossing, order);
        }
        let order = crossing.cmp(&self.last);
        if order != Ordering::Less {
            self.last.join(crossing, order);
        }
    }
}

impl Crossing {
    const NONE: Crossing = Crossing { height: 0, slope: [0; 2], scale: 0, entered: 0 };

    /// Order along the displaced ray.
    #[inline]
    fn cmp(&self, other: &Crossing) -> Ordering {
        let by = |mine: i64, its: i64| {
            let mine = i128::from(mine) * i128::from(other.scale);
            mine.cmp(&(i128::from(its) * i128::from(self.scale)))
        };
        by(self.height, other.height)
            .then_with(|| by(self.slope[0], other.slope[0]))
            .then_with(|| by(self.slope[1], other.slope[1]))
    }

    /// Takes the place of a crossing that is beaten, or adds to an equal one.
    #[inline]
    fn join(&mut self, other: Crossing, order: Ordering) {
        if order == Ordering::Equal {
            self.entered += other.entered;
        } else {
            *self = other;
        }
    }
}

/// Adds the crossings of a triangle with the rays along `axis` to their columns, addressed as
/// [`Axis::address`] says.
#[inline(always)]
pub(super) fn cross<const N: usize>(shape: &Shape, axis: Axis, ends: &mut [[Ends; N]; N]) {
    let w = axis as usize;
    let [u, v] = across(w);
    let facing = shape.normal[w].signum();
    let [u_centres, v_centres] = [u, v].map(|k| shape.centres[k][0]..shape.centres[k][1]);
    if facing == 0 || u_centres.is_empty() || v_centres.is_empty() {
        return;
    }
    let edges = [shape.edge(w, 0), shape.edge(w, 1), shape.edge(w, 2)];
    for i in u_centres {
        let p_u = centre(i) - shape.origin[u];
        for j in v_centres.clone() {
            let p_v = centre(j) - shape.origin[v];
            if edges.iter().all(|edge| edge.holds(facing, [p_u, p_v])) {
                let mut voxel = [0; 3];
                (voxel[u], voxel[v]) = (i as usize, j as usize);
                let (line, place) = axis.address(voxel);
                let [n_u, n_v, n_w] = [u, v, w].map(|k| shape.normal[k] * facing);
                let corner = shape.corners[0];
                let height = n_w * (corner[w] + shape.origin[w])
                    - n_u * (p_u - corner[u])
                    - n_v * (p_v - corner[v]);
                ends[line][place].add(Crossing {
                    height,
                    slope: [-n_u, -n_v],
                    scale: n_w,
                    entered: -(facing as i32),
                });
            }
        }
    }
}

impl Edge {
    /// Whether a displaced point is on the inner side.
    #[inline(always)]
    fn holds(&self, facing: i64, [p_u, p_v]: [i64; 2]) -> bool {
        let [s, t] = self.slope;
        let value = match s * p_u + t * p_v + self.offset {
            0 if s != 0 => s,
            0 => t,
            value => value,
        };
        (value ^ facing) >= 0
    }
}

/// The centre of voxel i along an axis.
#[inline]
fn centre(i: i32) -> i64 {
    i64::from(i * UNITS + UNITS / 2)
}
