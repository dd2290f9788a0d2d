//! Export: marching cubes over the supported voxels, Laplacian smoothing, and binary STL as a stream,
//! slab by slab.
//!
//! Source: section 3.6 of the paper. Samples are voxel centres, and everything outside the grid is
//! empty, so the surface is closed. Its vertices lie halfway between solid and empty centres (Lorensen
//! and Cline, 1987) and are smoothed by two Laplacian iterations of factor one half.
//!
//! The model is in millimetres, z up: the grid's x, y and z become x, z and -y. Its lowest vertex is at
//! z = 0, and its bounding box is centred over the origin.

mod cases;
mod cells;
mod faces;
mod smooth;
mod stl;
mod support;
mod walk;

use crate::volume::bit_grid::BitGrid;
use crate::volume::range_maps::{RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use cells::CornerRows;
use core::ops::RangeInclusive;
use smooth::VertexSmoother;
use stl::StlPoint;
use support::SupportSearch;
use walk::{CellWalk, ClosedBounds, WalkStep};

/// The range of model heights: 0.1 to 100,000 mm, inclusive.
pub const HEIGHT_RANGE_MM: RangeInclusive<f32> = 0.1..=100_000.0;

/// A height outside [`HEIGHT_RANGE_MM`], or NaN.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HeightOutOfRange(pub f32);

/// The phase of an export, in chronological order.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[repr(u8)]
pub enum ExportPhase {
    /// Waiting for [`Exporter::start_export`].
    Idle = 0,
    /// Finding the supported voxels.
    Supporting,
    /// Finding their bounding box.
    Bounding,
    /// Counting triangles and finding the bounds of the smoothed vertices.
    Measuring,
    /// Writing the header.
    Heading,
    /// Writing triangles.
    Writing,
    /// The file is complete.
    Done,
}

/// The result of a call of [`Exporter::advance_export`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[must_use = "the bytes written must be taken out of the buffer"]
pub struct ExportProgress {
    /// Bytes written to the front of the buffer. The bytes of all calls, concatenated, are the file.
    pub written: usize,
    /// The phase at the next call.
    pub phase: ExportPhase,
}

/// Writes a volume as a binary STL file of 84 + 50 x triangles bytes, a bounded piece of work at a time. All
/// zero bytes when idle.
///
/// Coordinates are in millimetres with z up: the grid's y becomes z, the lowest vertex lies at z = 0, and
/// the model is centred in x and y.
///
/// The file contains the *supported* voxels: those that are six-connected inside the volume to its ground
/// layer y = 0 or to the mask. If there are neither, it contains the largest six-connected component (the
/// first of equal ones, in the order of y, z, x).
pub struct Exporter<const N: usize>
where
    Grid<N>: Size,
{
    support: SupportSearch<N>,
    smooth: VertexSmoother<N>,
    /// Smoothed vertices in STL axes around the current row of cells, indexed by y, z modulo 2, x and face.
    window: [[[[StlPoint; 6]; N]; 2]; 2],
    /// The first and last occupied x, y and z.
    voxels: ClosedBounds,
    /// Masks of a row: the first and last x of [`Self::voxels`], and the same with their neighbours.
    rims: [<Grid<N> as Size>::Row; 2],
    /// The smoothed vertices' bounds in 1/128 voxel.
    vertices: ClosedBounds,
    triangles: u32,
    height_mm: f32,
    /// Millimetres per vertex unit, 1/128 voxel.
    scale: f32,
    walk: CellWalk,
    /// The next layer for [`Self::include_next_layer_in_bounds`].
    layer: u32,
    phase: ExportPhase,
}

impl<const N: usize> Exporter<N>
where
    Grid<N>: Size,
{
    /// Buffer size with which [`Exporter::advance_export`] always makes progress: the triangles of one row of
    /// cells in the worst case. 32 KB at 128, twice that at 256.
    pub const MIN_BUFFER: usize = (N + 1) * cases::MAX_CELL_TRIANGLES * stl::TRIANGLE_BYTES;

    /// Creates an idle exporter. For a `static`, as [`World::new`](crate::World::new).
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the exporter about by value
    pub const fn new() -> Self {
        Exporter {
            support: SupportSearch::new(),
            smooth: VertexSmoother::new(),
            window: [[[[[0.0; 4]; 6]; N]; 2]; 2],
            voxels: ClosedBounds::ZERO,
            rims: [<Grid<N> as Size>::Row::EMPTY; 2],
            vertices: ClosedBounds::ZERO,
            triangles: 0,
            height_mm: 0.0,
            scale: 0.0,
            walk: CellWalk::new(),
            layer: 0,
            phase: ExportPhase::Idle,
        }
    }

    /// Starts a file, discarding an unfinished one. The smoothed model will be `height_mm` high, from
    /// its lowest vertex to its highest; its scale is the same along all axes.
    ///
    /// # Errors
    /// [`HeightOutOfRange`] for a height outside [`HEIGHT_RANGE_MM`]. The exporter is unchanged.
    #[inline(never)]
    pub fn start_export(&mut self, height_mm: f32) -> Result<(), HeightOutOfRange> {
        if !HEIGHT_RANGE_MM.contains(&height_mm) {
            return Err(HeightOutOfRange(height_mm));
        }
        self.support.restart();
        self.voxels = ClosedBounds::NONE;
        self.vertices = ClosedBounds::NONE;
        (self.triangles, self.layer) = (0, 0);
        self.height_mm = height_mm;
        self.phase = ExportPhase::Supporting;
        Ok(())
    }

    /// Does at most `max_work_units` of work, and writes to the front of `out`. A unit is a row visited, or a
    /// layer searched for its bounds.
    ///
    /// `mask` is the volume's mask (empty for none); volume and mask must not change until the export ends.
    /// Returns early if `out` has no room for the next piece. With [`Exporter::MIN_BUFFER`] bytes, or room
    /// for the whole file, every call makes progress. A smaller buffer may stop the export for good: then no
    /// bytes are written and the phase doesn't change. The bytes of the file don't depend on budgets and
    /// buffers.
    #[inline(never)]
    pub fn advance_export<const K: usize>(
        &mut self,
        volume: &BitGrid<N>,
        mask: &RangeMaps<N, K>,
        max_work_units: u32,
        out: &mut [u8],
    ) -> ExportProgress {
        let (mut written, mut units_left) = (0, max_work_units);
        while units_left > 0 {
            match self.phase {
                ExportPhase::Supporting => {
                    self.support.advance_search(volume, mask, &mut units_left);
                    if self.support.is_done() {
                        self.phase = ExportPhase::Bounding;
                    }
                    continue;
                }
                ExportPhase::Bounding => self.include_next_layer_in_bounds(),
                ExportPhase::Measuring => self.measure_next_row(),
                ExportPhase::Heading | ExportPhase::Writing => {
                    let Some(len) = self.write_next_piece(&mut out[written..]) else { break };
                    written += len;
                }
                ExportPhase::Idle | ExportPhase::Done => break,
            }
            units_left -= 1;
        }
        ExportProgress { written, phase: self.phase }
    }

    /// Returns the number of triangles, known from [`ExportPhase::Heading`] on. An empty volume has zero.
    #[must_use]
    pub fn triangles(&self) -> Option<u32> {
        (self.phase >= ExportPhase::Heading).then_some(self.triangles)
    }

    /// Returns the length of the whole file in bytes, known from [`ExportPhase::Heading`] on.
    #[must_use]
    pub fn file_len(&self) -> Option<u64> {
        let triangles = u64::from(self.triangles()?);
        Some(stl::HEADER_BYTES as u64 + triangles * stl::TRIANGLE_BYTES as u64)
    }

    /// Adds the next layer to the voxels' bounds.
    fn include_next_layer_in_bounds(&mut self) {
        let y = self.layer as usize;
        let mut all = <Grid<N> as Size>::Row::EMPTY;
        for (z, row) in self.support.supported_voxels().layer(y).iter().enumerate() {
            if !row.is_empty() {
                all |= *row;
                self.voxels.include_on_axis(1, y as i32);
                self.voxels.include_on_axis(2, z as i32);
            }
        }
        if let (Some(first), Some(last)) = (all.first(), all.last()) {
            self.voxels.include_on_axis(0, first as i32);
            self.voxels.include_on_axis(0, last as i32);
        }
        self.layer += 1;
        if self.layer == N as u32 {
            if !self.voxels.is_empty() {
                let [first, last] = [self.voxels.lo[0] as usize, self.voxels.hi[0] as usize];
                let span = <Grid<N> as Size>::Row::span;
                self.rims[0] = span(first, first) | span(last, last);
                self.rims[1] =
                    (self.rims[0].shifted_up() | self.rims[0] | self.rims[0].shifted_down())
                        & Grid::<N>::FULL;
            }
            self.start_walk_or_skip(ExportPhase::Measuring, ExportPhase::Heading);
        }
    }

    /// Counts the triangles of the walk's current step, and updates the bounds of the vertices. Smoothing
    /// moves no vertex by more than half a voxel, so the outermost voxels' vertices determine the bounds.
    fn measure_next_row(&mut self) {
        let solid = self.support.supported_voxels();
        match self.walk.current_step() {
            WalkStep::Voxels((y, z)) => {
                self.smooth.encode_turns_of_row(
                    solid,
                    (y, z),
                    self.voxels_near_faces_of_bounds((y, z), 1),
                );
            }
            WalkStep::Cells((y, z)) => {
                self.triangles += cells::count_triangles(&self.corner_rows((y, z)));
                if y < N && z < N {
                    let (rim, bounds) =
                        (self.voxels_near_faces_of_bounds((y, z), 0), &mut self.vertices);
                    self.smooth.visit_vertices(solid, (y, z), rim, &[0, 1, 2, 3, 4, 5], |vertex| {
                        bounds.include_point(vertex.position);
                    });
                }
            }
        }
        if !self.walk.advance_if_more(&self.voxels) {
            self.phase = ExportPhase::Heading;
            self.scale = self.height_mm / (self.vertices.hi[1] - self.vertices.lo[1]) as f32;
        }
    }

    /// Returns the voxels of row (y, z) within a margin, 0 or 1, of a face of the bounds of all voxels.
    fn voxels_near_faces_of_bounds(
        &self,
        (y, z): RowAddress,
        margin_voxels: usize,
    ) -> <Grid<N> as Size>::Row {
        let (ClosedBounds { lo, hi }, margin) = (self.voxels, margin_voxels as i32);
        let near = |axis: usize, at: i32| at - lo[axis] <= margin || hi[axis] - at <= margin;
        if near(1, y as i32) || near(2, z as i32) {
            Grid::<N>::FULL
        } else {
            self.rims[margin_voxels]
        }
    }

    /// Writes the header or the triangles of the walk's current step. Returns the number of bytes, or `None`
    /// if `out` has no room for them.
    fn write_next_piece(&mut self, out: &mut [u8]) -> Option<usize> {
        if self.phase == ExportPhase::Heading {
            out.get_mut(..stl::HEADER_BYTES)?.copy_from_slice(&stl::header_bytes(self.triangles));
            self.start_walk_or_skip(ExportPhase::Writing, ExportPhase::Done);
            return Some(stl::HEADER_BYTES);
        }
        let mut written = 0;
        match self.walk.current_step() {
            WalkStep::Voxels((y, z)) => {
                self.smooth.encode_turns_of_row(
                    self.support.supported_voxels(),
                    (y, z),
                    Grid::<N>::FULL,
                );
            }
            WalkStep::Cells((y, z)) => {
                let corners = self.corner_rows((y, z));
                if out.len() < Self::MIN_BUFFER
                    && out.len() < cells::count_triangles(&corners) as usize * stl::TRIANGLE_BYTES
                {
                    return None;
                }
                self.smooth_vertices_into_window((y, z));
                written = self.write_row_triangles(&corners, z, out);
            }
        }
        if !self.walk.advance_if_more(&self.voxels) {
            self.phase = ExportPhase::Done;
        }
        Some(written)
    }

    /// Writes the smoothed vertices of the rows (y - 1, z) and (y, z) to the window, translated to the
    /// model's origin.
    fn smooth_vertices_into_window(&mut self, (y, z): RowAddress) {
        let ClosedBounds { lo, hi } = self.vertices;
        // All values are at most halves, so this is exact.
        let [x_middle, z_middle] = [0, 2].map(|axis| (lo[axis] + hi[axis]) as f32 / 2.0);
        for (above, window) in self.window.iter_mut().enumerate() {
            let y = (y + above).wrapping_sub(1);
            if y >= N || z >= N {
                continue;
            }
            let window = &mut window[z % 2];
            // The slab's cells have no vertices on its outward faces.
            let faces = if above == 0 { &[0, 1, 2, 4, 5] } else { &[0, 1, 3, 4, 5] };
            let solid = self.support.supported_voxels();
            self.smooth.visit_vertices(solid, (y, z), Grid::<N>::FULL, faces, |vertex| {
                let [x, y, z] = vertex.position;
                window[vertex.x][vertex.face] =
                    [x as f32 - x_middle, z_middle - z as f32, (y - lo[1]) as f32, 0.0];
            });
        }
    }

    /// Writes the triangles of a row of cells. Returns the number of bytes.
    fn write_row_triangles(
        &self,
        corners: &CornerRows<<Grid<N> as Size>::Row>,
        z: usize,
        out: &mut [u8],
    ) -> usize {
        let window = self.window.as_flattened().as_flattened().as_flattened();
        let places = &Self::WINDOW_OFFSETS[z % 2];
        let (records, _) = out.as_chunks_mut::<{ stl::TRIANGLE_BYTES }>();
        let mut records = records.iter_mut();
        let mut count = 0;
        cells::visit_surface_cells(corners, |cell| {
            let case = &cases::CASES[cell.case];
            for (triangle, record) in case.triangles[..case.count as usize].iter().zip(&mut records)
            {
                let corner =
                    |i: usize| window[places[triangle[i] as usize % 32].wrapping_add(cell.x * 6)];
                stl::write_triangle([corner(0), corner(1), corner(2)], self.scale, record);
            }
            count += usize::from(case.count);
        });
        count * stl::TRIANGLE_BYTES
    }

    /// Returns the rows around the cells between the layers y - 1 and y and the rows z - 1 and z.
    fn corner_rows(&self, (y, z): RowAddress) -> CornerRows<<Grid<N> as Size>::Row> {
        let found = self.support.supported_voxels();
        let mut corners = [[<Grid<N> as Size>::Row::EMPTY; 2]; 2];
        for (above, corners) in corners.iter_mut().enumerate() {
            let y = (y + above).wrapping_sub(1);
            if y < N {
                for (before, corner) in corners.iter_mut().enumerate() {
                    let z = (z + before).wrapping_sub(1);
                    if z < N {
                        *corner = found.row(y, z);
                    }
                }
            }
        }
        corners
    }

    /// The vertex's offset in the window from the first face of the voxel after a cell, indexed by that
    /// voxel's z modulo 2 and by [`cases::CellVertex`].
    const WINDOW_OFFSETS: [[usize; 32]; 2] = {
        let mut places = [[0; 32]; 2];
        let mut i = 0;
        while i < 2 * cases::CELL_VERTICES {
            let (odd, vertex) = (i / cases::CELL_VERTICES, i % cases::CELL_VERTICES);
            let cases::CornerFace { corner, face } = cases::corner_and_face_of(vertex as u8);
            let (i_x, j, k) = (corner & 1, corner >> 1 & 1, corner >> 2);
            let row = 2 * j + (odd + k + 1) % 2;
            places[odd][vertex] = ((row * N + i_x) * 6 + face).wrapping_sub(6);
            i += 1;
        }
        places
    };

    /// Starts a walk through the layers in the given phase. Without any voxels, skips to `phase_if_empty`.
    fn start_walk_or_skip(&mut self, phase: ExportPhase, phase_if_empty: ExportPhase) {
        if self.voxels.is_empty() {
            self.phase = phase_if_empty;
        } else {
            self.walk.restart(&self.voxels);
            self.phase = phase;
        }
    }
}
