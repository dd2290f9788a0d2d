//! Small parts far away from the rest, which make the rest small in the grid.

use super::shells::Shell;
use std::fmt;

/// A small part of a mesh, far away from the rest.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Outlier {
    /// Facets of the part.
    pub facets: usize,
    /// Extents along x, y and z, in mesh units.
    pub size: [f64; 3],
    /// The gap between the part and the rest along an axis, in mesh units.
    pub distance: f64,
    /// The factor by which the rest would be larger in the grid without the part.
    pub shrinks: f64,
}

impl fmt::Display for Outlier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.size;
        write!(
            f,
            "a part of {} facets, {x:.3} x {y:.3} x {z:.3}, lies {:.3} away from the rest, which would be {:.1} \
             times as large without it",
            self.facets, self.distance, self.shrinks
        )
    }
}

/// Bounds of several shells.
#[derive(Clone, Copy)]
struct Side {
    low: [f64; 3],
    high: [f64; 3],
    facets: usize,
}

impl Side {
    const EMPTY: Side = Side { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3], facets: 0 };

    fn joined(&self, other: &Side) -> Side {
        Side {
            low: [0, 1, 2].map(|k| self.low[k].min(other.low[k])),
            high: [0, 1, 2].map(|k| self.high[k].max(other.high[k])),
            facets: self.facets + other.facets,
        }
    }

    fn size(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.high[k] - self.low[k])
    }

    fn extent(&self) -> f64 {
        self.size().into_iter().fold(0.0, f64::max)
    }
}

/// Finds the part that shrinks the rest most, at least to a half. The part lies beyond a gap along an axis,
/// has fewer facets than the rest, and is smaller than the gap.
pub(super) fn find(shells: &[Shell]) -> Option<Outlier> {
    /// The least factor that is reported.
    const REPORTED: f64 = 2.0;
    let sides: Vec<Side> =
        shells.iter().map(|s| Side { low: s.low, high: s.high, facets: s.facets }).collect();
    let whole = sides.iter().fold(Side::EMPTY, |sum, side| sum.joined(side));
    let mut found: Option<Outlier> = None;
    for axis in 0..3 {
        let mut order: Vec<usize> = (0..sides.len()).collect();
        order.sort_by(|&a, &b| sides[a].low[axis].total_cmp(&sides[b].low[axis]));
        // For each shell, the bounds of that shell and all after it.
        let mut above = vec![Side::EMPTY; order.len() + 1];
        for i in (0..order.len()).rev() {
            above[i] = above[i + 1].joined(&sides[order[i]]);
        }
        let mut below = Side::EMPTY;
        for i in 1..order.len() {
            below = below.joined(&sides[order[i - 1]]);
            let distance = above[i].low[axis] - below.high[axis];
            let (part, rest) =
                if below.facets < above[i].facets { (below, above[i]) } else { (above[i], below) };
            let shrinks = whole.extent() / rest.extent();
            let is_far = distance > part.extent() && rest.extent() > 0.0 && shrinks >= REPORTED;
            if is_far && found.is_none_or(|outlier| shrinks > outlier.shrinks) {
                found = Some(Outlier { facets: part.facets, size: part.size(), distance, shrinks });
            }
        }
    }
    found
}
