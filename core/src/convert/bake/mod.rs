//! Conservative voxelization of a triangle stream into range maps, with holes in the mesh closed.
//!
//! Every voxel that a triangle touches is set in a bit grid (`triangle.rs` decides, exactly). Beside
//! it, each column keeps the first and the last crossing of the ray through its centre. A column's
//! range is the hull of its touched voxels. Where the first crossing leaves the mesh, the ray was
//! inside before: the mesh has a hole there, and the range is extended to the low end of the box (to
//! the high end where the last crossing enters). The other two axes bound it again, so a hole doesn't
//! hollow the solid. The maps are the tight hulls of the intersection of the three.
//!
//! Sources: section 3.3 of the paper; Karabassi, Papaioannou and Theoharis (1999) for the range of
//! a column; Schwarz and Seidel (2010) for the conservative test by plane and three projections.

mod crossing;
mod placement;
mod triangle;

pub use placement::{MeshPlacement, UpAxis};

use crate::volume::bit_grid::BitGrid;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, RangeMaps};
use crate::volume::size::{Grid, Size};
use crossing::{ColumnCrossings, OpenEnds};
use glam::IVec3;
use triangle::GridTriangle;

/// Bake units along a voxel's side: vertices are snapped to 1/256 voxel.
pub const BAKE_UNITS_PER_VOXEL: i32 = 256;

/// A vertex lay outside the box of the grid, `0..=256 N` units on each axis; the triangle was
/// rejected.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct OutsideBox;

/// What a bake found about the mesh.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct BakeReport {
    /// Triangles added.
    pub triangles: u64,
    /// Of these, the ones without area after snapping. They touch voxels but cross no ray.
    pub degenerate: u64,
    /// The signed volume was negative: the mesh was inside out, and its orientation was reversed.
    pub flipped: bool,
    /// Columns, of all three axes, that were extended to an end of the box because of a hole.
    pub opened_columns: u32,
}

/// A bake in progress for a grid of N^3 voxels. 4 MiB at 128, 17 MiB at 256.
///
/// The order of the triangles does not matter.
#[derive(Debug)]
pub struct Baker<const N: usize>
where
    Grid<N>: Size,
{
    touched: BitGrid<N>,
    ends: [[[ColumnCrossings; N]; N]; 3],
    /// Six times the signed volume, in cubic units, summed over tetrahedra with their apex at the
    /// centre of the box: there the missing part of an open mesh weighs least.
    volume: i128,
    triangles: u64,
    degenerate: u64,
}

impl<const N: usize> Baker<N>
where
    Grid<N>: Size,
{
    /// No triangle yet. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the baker about by value
    pub const fn new() -> Self {
        Baker {
            touched: BitGrid::new(),
            ends: [[[ColumnCrossings::NONE; N]; N]; 3],
            volume: 0,
            triangles: 0,
            degenerate: 0,
        }
    }

    /// Removes every triangle, in place.
    pub fn clear(&mut self) {
        self.touched.clear();
        self.ends.as_flattened_mut().as_flattened_mut().fill(ColumnCrossings::NONE);
        self.volume = 0;
        self.triangles = 0;
        self.degenerate = 0;
    }

    /// Adds a triangle: corners in bake units of 1/256 voxel, counter-clockwise seen from outside. A
    /// triangle without area touches the voxels of its segment or point.
    ///
    /// # Errors
    /// [`OutsideBox`] when a corner is outside `0..=256 N`; nothing is changed then.
    pub fn add_triangle(&mut self, corners_bake_units: [IVec3; 3]) -> Result<(), OutsideBox> {
        let triangle = GridTriangle::new::<N>(corners_bake_units).ok_or(OutsideBox)?;
        triangle.mark_touched_voxels(&mut self.touched);
        let [x, y, z] = &mut self.ends;
        crossing::add_triangle_crossings(&triangle, Axis::X, x);
        crossing::add_triangle_crossings(&triangle, Axis::Y, y);
        crossing::add_triangle_crossings(&triangle, Axis::Z, z);
        self.volume += i128::from(
            triangle
                .signed_tetrahedron_volume_x6([N as i64 * i64::from(BAKE_UNITS_PER_VOXEL) / 2; 3]),
        );
        self.triangles += 1;
        self.degenerate += u64::from(triangle.is_degenerate());
        Ok(())
    }

    /// Writes the tight range maps of all triangles so far, and their voxels to `voxels`, whatever both
    /// held before. More triangles may be added afterwards.
    pub fn write_maps<const K: usize>(
        &self,
        maps: &mut RangeMaps<N, K>,
        voxels: &mut BitGrid<N>,
    ) -> BakeReport {
        let flipped = self.volume < 0;
        self.touched.write_hulls(maps);
        let mut opened = 0;
        for axis in Axis::ALL {
            for (line, ends) in self.ends[axis as usize].iter().enumerate() {
                for (place, ends) in ends.iter().enumerate() {
                    let OpenEnds { low, high } = ends.open_ends(flipped);
                    if low || high {
                        let hull = maps.column(axis, (line, place)).hull();
                        let lo = if low { 0 } else { hull.first() };
                        let hi = if high { N - 1 } else { hull.last() };
                        maps.set_column(
                            axis,
                            (line, place),
                            Column::from_range(Range::new(lo, hi)),
                        );
                        opened += 1;
                    }
                }
            }
        }
        voxels.set_from_maps(maps);
        voxels.write_closure(maps);
        BakeReport {
            triangles: self.triangles,
            degenerate: self.degenerate,
            flipped,
            opened_columns: opened,
        }
    }
}
