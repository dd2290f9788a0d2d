//! Conservative voxelization of a triangle stream into range maps, with holes in the mesh closed.
//!
//! Every voxel that a triangle touches is set in a bit grid (`triangle.rs` tests this exactly). In addition,
//! each column stores the first and the last crossing of the ray through its centre. A column's range is the
//! hull of its touched voxels. If the first crossing leaves the mesh, the ray was inside before: the mesh has
//! a hole there, and the range is extended to the low end of the box (or to the high end if the last crossing
//! enters). The other two axes bound it again, so a hole doesn't hollow the solid.
//!
//! A column of K intervals has gaps where its ray is outside the mesh between touched voxels (`winding.rs`):
//! the longest K - 1 of these runs; of equally long runs, the lowest.
//!
//! The volume V is the intersection of these columns. Its maps are the closure of V in columns that had these
//! gaps. Closure doesn't change V: a baked gap is empty in V, so it lies outside a hull of V or in one of its
//! empty runs. There are at most K - 1 of these runs, and they come first in the rule's order. So a new
//! column contains all of V and nothing outside the baked column. The maps are tight and saturated as after
//! an edit, and closing them again changes nothing. Choosing the longest runs of V instead would be wrong: if
//! the other axes emptied a longer run, a baked gap would be filled.
//!
//! Sources: section 3.3 of the paper; Karabassi, Papaioannou and Theoharis (1999) for the range of
//! a column; Schwarz and Seidel (2010) for the conservative test by plane and three projections.

mod crossing;
mod placement;
mod triangle;
mod winding;

pub use placement::{MeshPlacement, UpAxis};
pub use winding::{ColumnWindings, NoWindings, Windings};

use crate::volume::bit_grid::BitGrid;
use crate::volume::range_maps::{Axis, RangeMaps};
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

/// The properties of the mesh that a bake found.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct BakeReport {
    /// Triangles added.
    pub triangles: u64,
    /// Number of triangles without area after snapping. They touch voxels but cross no ray.
    pub degenerate: u64,
    /// `true` if the signed volume was negative: the mesh was inside out, and its orientation was reversed.
    pub flipped: bool,
    /// Number of columns, of all three axes, that were extended to an end of the box because of a hole.
    pub opened_columns: u32,
}

/// A bake in progress for a grid of N^3 voxels. Bakes into columns of one interval or, with
/// [`ColumnWindings`], of any number. 4 MiB at 128 and 17 MiB at 256; with `ColumnWindings` 7 and 29.2 MiB.
///
/// The order of the triangles does not matter.
#[derive(Debug)]
pub struct Baker<const N: usize, W: Windings<N> = NoWindings>
where
    Grid<N>: Size,
{
    touched: BitGrid<N>,
    ends: [[[ColumnCrossings; N]; N]; 3],
    windings: W,
    /// Six times the signed volume, in cubic units, summed over tetrahedra with their apex at the centre of
    /// the box, where the missing part of an open mesh has the least effect.
    volume: i128,
    triangles: u64,
    degenerate: u64,
}

impl<const N: usize, W: Windings<N>> Baker<N, W>
where
    Grid<N>: Size,
{
    /// Creates a baker without triangles. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the baker about by value
    pub const fn new() -> Self {
        Baker {
            touched: BitGrid::new(),
            ends: [[[ColumnCrossings::NONE; N]; N]; 3],
            windings: W::NONE,
            volume: 0,
            triangles: 0,
            degenerate: 0,
        }
    }

    /// Removes every triangle.
    #[inline(never)]
    pub fn clear(&mut self) {
        self.touched.clear();
        self.ends.as_flattened_mut().as_flattened_mut().fill(ColumnCrossings::NONE);
        self.windings.clear();
        self.volume = 0;
        self.triangles = 0;
        self.degenerate = 0;
    }

    /// Adds a triangle: corners in bake units of 1/256 voxel, counter-clockwise seen from outside. A
    /// triangle without area touches the voxels of its segment or point.
    ///
    /// # Errors
    /// [`OutsideBox`] if a corner is outside `0..=256 N`. Then nothing is changed.
    #[inline(never)]
    pub fn add_triangle(&mut self, corners_bake_units: [IVec3; 3]) -> Result<(), OutsideBox> {
        let triangle = GridTriangle::new_within_grid::<N>(corners_bake_units).ok_or(OutsideBox)?;
        triangle.mark_touched_voxels(&mut self.touched);
        let [x, y, z] = &mut self.ends;
        crossing::add_triangle_crossings(&triangle, Axis::X, x, &mut self.windings);
        crossing::add_triangle_crossings(&triangle, Axis::Y, y, &mut self.windings);
        crossing::add_triangle_crossings(&triangle, Axis::Z, z, &mut self.windings);
        self.volume += i128::from(
            triangle
                .signed_tetrahedron_volume_x6([N as i64 * i64::from(BAKE_UNITS_PER_VOXEL) / 2; 3]),
        );
        self.triangles += 1;
        self.degenerate += u64::from(triangle.is_degenerate());
        Ok(())
    }

    /// Writes the tight and saturated range maps of all triangles so far, and their voxels to `voxels`,
    /// replacing the previous content of both. More triangles may be added afterwards. Columns of several
    /// intervals need a baker with [`ColumnWindings`]; other bakers don't compile for them.
    #[inline(never)]
    pub fn write_maps<const K: usize>(
        &self,
        maps: &mut RangeMaps<N, K>,
        voxels: &mut BitGrid<N>,
    ) -> BakeReport {
        const { assert!(K == 1 || W::COUNTS, "columns with gaps need a Baker<N, ColumnWindings<N>>") };
        let flipped = self.volume < 0;
        self.windings.write_columns(&self.touched, maps);
        let opened_columns = self.extend_open_columns(flipped, maps);
        voxels.set_from_maps(maps);
        voxels.write_closure_holding_gaps(maps);
        BakeReport {
            triangles: self.triangles,
            degenerate: self.degenerate,
            flipped,
            opened_columns,
        }
    }

    /// Extends columns to the ends of the box at which the mesh has a hole. Returns the number of these
    /// columns.
    fn extend_open_columns<const K: usize>(
        &self,
        flipped: bool,
        maps: &mut RangeMaps<N, K>,
    ) -> u32 {
        let mut opened = 0;
        for axis in Axis::ALL {
            for (line, ends) in self.ends[axis as usize].iter().enumerate() {
                for (place, ends) in ends.iter().enumerate() {
                    let OpenEnds { low, high } = ends.ends_at_holes(flipped);
                    if low || high {
                        let column = &mut maps.line_mut(axis, line)[place];
                        if low {
                            column.set_hull_first(0);
                        }
                        if high && !column.range(0).is_empty() {
                            column.set_hull_last(N - 1);
                        }
                        opened += 1;
                    }
                }
            }
        }
        opened
    }
}
