//! How a mesh is turned, scaled and moved into the box of a grid.

use super::UNITS;
use glam::IVec3;

/// The axis that points up in the mesh's own coordinates, which are right-handed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Up {
    /// As in the grid.
    Y,
    /// As in most files for printing: (x, y, z) becomes (x, z, -y).
    Z,
}

/// A turn, one scale and a shift from mesh units to the units of a bake.
///
/// One voxel stays empty on every side but below, where the mesh stands on y = 0; it is centred in
/// x and z.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Placement {
    up: Up,
    /// Units per mesh unit.
    scale: f64,
    /// The point, in the turned mesh, that comes to `onto`.
    from: [f64; 3],
    onto: [f64; 3],
    /// Side of the box in units.
    side: f64,
}

impl Placement {
    /// Fits a mesh with the bounds `min..=max` into a grid of `n` voxels a side. `None` when a
    /// bound is not finite, a low one is above its high one, or the bounds hold only one point.
    #[must_use]
    pub fn fit(min: [f32; 3], max: [f32; 3], up: Up, n: usize) -> Option<Self> {
        let finite = min.iter().chain(&max).all(|c| c.is_finite());
        if !finite || (0..3).any(|k| min[k] > max[k]) || min == max {
            return None;
        }
        let (a, b) = (up.turn(min), up.turn(max));
        let unit = f64::from(UNITS);
        let side = n as f64 * unit;
        // A unit less than a whole voxel: a vertex on a face touches the voxels on both sides.
        let margin = unit + 1.0;
        let room = [side - 2.0 * margin, side - margin, side - 2.0 * margin];
        let mut scale = f64::INFINITY;
        for k in 0..3 {
            let extent = if a[k] > b[k] { a[k] - b[k] } else { b[k] - a[k] };
            if extent > 0.0 && room[k] / extent < scale {
                scale = room[k] / extent;
            }
        }
        let bottom = if a[1] < b[1] { a[1] } else { b[1] };
        Some(Placement {
            up,
            scale,
            from: [(a[0] + b[0]) * 0.5, bottom, (a[2] + b[2]) * 0.5],
            onto: [side * 0.5, 0.0, side * 0.5],
            side,
        })
    }

    /// Where a point comes to, snapped to the nearest unit; a point outside the bounds of the fit
    /// comes no further than the side of the box.
    #[must_use]
    #[inline]
    pub fn snap(&self, point: [f32; 3]) -> IVec3 {
        let turned = self.up.turn(point);
        let unit = |k: usize| {
            let at = (turned[k] - self.from[k]) * self.scale + self.onto[k];
            // Truncation rounds half up, as what is kept is not negative.
            if at > self.side { self.side as i32 } else { ((at + 0.5) as i32).max(0) }
        };
        IVec3::new(unit(0), unit(1), unit(2))
    }

    /// Voxels per mesh unit.
    #[must_use]
    pub fn voxels_per_unit(&self) -> f64 {
        self.scale / f64::from(UNITS)
    }
}

impl Up {
    #[inline]
    fn turn(self, point: [f32; 3]) -> [f64; 3] {
        let [x, y, z] = point.map(f64::from);
        match self {
            Up::Y => [x, y, z],
            Up::Z => [x, z, -y],
        }
    }
}
