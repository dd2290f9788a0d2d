//! Voxelization of a mesh through the core's baker, and the mesh's bounding box.

use super::Mesh;
use paros_core::convert::{BakeReport, MeshPlacement, UpAxis, Windings};
use paros_core::volume::{BitGrid, Grid, Size};
use paros_core::{Baker, RangeMaps};

/// An axis-aligned bounding box, in mesh units.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeshBounds {
    /// The least coordinates.
    pub min: [f32; 3],
    /// The greatest coordinates.
    pub max: [f32; 3],
}

impl MeshBounds {
    /// Returns bounds that are larger by a factor, with the same middle and the same floor.
    fn widened(self, up: UpAxis, factor: f32) -> Self {
        let upwards = if up == UpAxis::Y { 1 } else { 2 };
        let mut wide = self;
        for axis in 0..3 {
            let more = (self.max[axis] - self.min[axis]) * (factor - 1.0);
            if axis == upwards {
                wide.max[axis] += more;
            } else {
                wide.min[axis] -= 0.5 * more;
                wide.max[axis] += 0.5 * more;
            }
        }
        wide
    }
}

impl Mesh {
    /// Returns the axis-aligned bounding box of the vertices; `None` if there are none.
    #[must_use]
    pub fn bounding_box(&self) -> Option<MeshBounds> {
        let (&first, rest) = self.positions.split_first()?;
        let (mut low, mut high) = (first, first);
        for p in rest {
            for k in 0..3 {
                low[k] = if p[k] < low[k] { p[k] } else { low[k] };
                high[k] = if p[k] > high[k] { p[k] } else { high[k] };
            }
        }
        Some(MeshBounds { min: low, max: high })
    }

    /// Bakes the mesh, fitted to the grid by [`MeshPlacement::stand_bounds_on_floor`], into tight maps and
    /// their voxels. Returns `None` and changes nothing if the mesh has no extent; a mesh that was read
    /// always has one.
    #[must_use]
    pub fn bake_into_maps<const N: usize, const K: usize, W: Windings<N>>(
        &self,
        up: UpAxis,
        baker: &mut Baker<N, W>,
        maps: &mut RangeMaps<N, K>,
        bit_grid: &mut BitGrid<N>,
    ) -> Option<BakeReport>
    where
        Grid<N>: Size,
    {
        self.bake_within(self.bounding_box()?, up, baker, maps, bit_grid)
    }

    /// Bakes the mesh like [`Mesh::bake_into_maps`], but smaller, so that at least `margin` voxels stay empty
    /// on every side but the ground's.
    #[must_use]
    pub fn bake_with_margin_into_maps<const N: usize, const K: usize, W: Windings<N>>(
        &self,
        margin: usize,
        up: UpAxis,
        baker: &mut Baker<N, W>,
        maps: &mut RangeMaps<N, K>,
        bit_grid: &mut BitGrid<N>,
    ) -> Option<BakeReport>
    where
        Grid<N>: Size,
    {
        let room = N.checked_sub(2 * margin).filter(|room| *room > 0)?;
        let bounds = self.bounding_box()?.widened(up, N as f32 / room as f32);
        self.bake_within(bounds, up, baker, maps, bit_grid)
    }

    /// Bakes the mesh, placed as if these bounds, which contain it, were its own.
    fn bake_within<const N: usize, const K: usize, W: Windings<N>>(
        &self,
        MeshBounds { min, max }: MeshBounds,
        up: UpAxis,
        baker: &mut Baker<N, W>,
        maps: &mut RangeMaps<N, K>,
        bit_grid: &mut BitGrid<N>,
    ) -> Option<BakeReport>
    where
        Grid<N>: Size,
    {
        let placement = MeshPlacement::stand_bounds_on_floor(min, max, up, N)?;
        let snapped: Vec<_> = self.positions.iter().map(|&p| placement.snap_point(p)).collect();
        baker.clear();
        for t in &self.triangles {
            baker
                .add_triangle(t.map(|i| snapped[i as usize]))
                .expect("the placement keeps every corner inside the box");
        }
        Some(baker.write_maps(maps, bit_grid))
    }
}
