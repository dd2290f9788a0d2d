//! The similarity transform that fits a mesh into the box of a grid.

use super::BAKE_UNITS_PER_VOXEL;
use glam::IVec3;

/// The up axis of the mesh's coordinates, which are right-handed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UpAxis {
    /// Y is up, as in the grid.
    Y,
    /// Z is up, as in most files for printing: (x, y, z) becomes (x, z, -y).
    Z,
}

/// A rotation, a uniform scale and a translation from mesh units to bake units (1/256 voxel).
///
/// The mesh stands on y = 0 and is centred in x and z. One voxel stays empty on every other side.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeshPlacement {
    up: UpAxis,
    /// Bake units per mesh unit.
    scale: f64,
    /// The point of the rotated mesh that is mapped to `onto`.
    from: [f64; 3],
    onto: [f64; 3],
    /// Side of the box in bake units.
    side: f64,
}

impl MeshPlacement {
    /// Fits a mesh with the bounds `min..=max`, in mesh units, into a grid of `grid_side` voxels a side.
    /// Returns `None` if a bound is not finite, a lower bound is above its upper bound, or the bounds contain
    /// a single point.
    #[must_use]
    pub fn stand_bounds_on_floor(
        min: [f32; 3],
        max: [f32; 3],
        up: UpAxis,
        grid_side: usize,
    ) -> Option<Self> {
        let finite = min.iter().chain(&max).all(|c| c.is_finite());
        if !finite || (0..3).any(|k| min[k] > max[k]) || min == max {
            return None;
        }
        let (a, b) = (up.to_grid_axes(min), up.to_grid_axes(max));
        let unit = f64::from(BAKE_UNITS_PER_VOXEL);
        let side = grid_side as f64 * unit;
        // A voxel and a unit: a vertex on a face touches the voxels on both sides.
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
        Some(MeshPlacement {
            up,
            scale,
            from: [(a[0] + b[0]) * 0.5, bottom, (a[2] + b[2]) * 0.5],
            onto: [side * 0.5, 0.0, side * 0.5],
            side,
        })
    }

    /// Maps a point from mesh units to bake units, rounded to the nearest. A point outside the bounds of the
    /// fit is clamped to the box.
    #[must_use]
    #[inline]
    pub fn snap_point(&self, point: [f32; 3]) -> IVec3 {
        let turned = self.up.to_grid_axes(point);
        let unit = |k: usize| {
            let at = (turned[k] - self.from[k]) * self.scale + self.onto[k];
            // Truncation rounds half up, as the values kept aren't negative.
            if at > self.side { self.side as i32 } else { ((at + 0.5) as i32).max(0) }
        };
        IVec3::new(unit(0), unit(1), unit(2))
    }

    /// Returns the number of voxels in a mesh unit.
    #[must_use]
    pub fn voxels_per_unit(&self) -> f64 {
        self.scale / f64::from(BAKE_UNITS_PER_VOXEL)
    }
}

impl UpAxis {
    #[inline]
    fn to_grid_axes(self, point: [f32; 3]) -> [f64; 3] {
        let [x, y, z] = point.map(f64::from);
        match self {
            UpAxis::Y => [x, y, z],
            UpAxis::Z => [x, z, -y],
        }
    }
}
