//! Export: the supported voxels become a smoothed surface by marching cubes, slab after slab, and
//! stream out as binary STL.
//!
//! Source: section 3.6 of the paper. Samples are voxel centres, and outside the grid all is empty,
//! so the surface is closed everywhere. Its vertices lie halfway between solid and empty centres
//! (Lorensen and Cline, 1987) and are smoothed by two Laplacian iterations of factor one half.
//!
//! The model has millimetres, z up (the grid's x, y and z become x, z and -y), its lowest vertex at
//! z = 0 and the middle of its bounding box over the origin.

mod cases;
mod cells;
mod faces;
mod smooth;
mod stl;
mod support;
mod walk;

use crate::maps::Maps;
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};
use cells::Edges;
use core::ops::RangeInclusive;
use smooth::Smooth;
use stl::Point;
use support::Support;
use walk::{Bounds, Step, Walk};

/// The heights that a model may have, in millimetres.
pub const HEIGHTS_MM: RangeInclusive<f32> = 0.1..=100_000.0;

/// A height outside [`HEIGHTS_MM`], or none at all (NaN).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HeightOutOfRange(pub f32);

/// What an exporter is at.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[repr(u8)]
pub enum Stage {
    /// Waits for [`Exporter::start`].
    Idle = 0,
    /// Finds the voxels that hold together.
    Supporting,
    /// Finds their bounding box.
    Bounding,
    /// Counts triangles and finds the bounds of the smoothed vertices.
    Measuring,
    /// Is about to write the header.
    Heading,
    /// Writes triangles.
    Writing,
    /// All is written.
    Done,
}

/// What a call of [`Exporter::advance`] came to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[must_use = "the bytes written must be taken out of the buffer"]
pub struct Progress {
    /// Bytes written to the front of the buffer. Those of all calls together are the file.
    pub written: usize,
    /// What is next; nothing after [`Stage::Done`].
    pub stage: Stage,
}

/// Makes an STL file out of a volume, a bounded piece of work at a time. All zero bytes at rest.
///
/// The file holds the voxels that are six-connected inside the volume to its ground layer y = 0 or
/// to the mask; where there is neither, the largest six-connected part (of equal ones, the first
/// in the order of y, z, x).
pub struct Exporter<const N: usize>
where
    Grid<N>: Size,
{
    support: Support<N>,
    smooth: Smooth<N>,
    /// Smoothed vertices in STL axes around the row of cells at hand: by y, z modulo 2, x and face.
    window: [[[[Point; 6]; N]; 2]; 2],
    /// First and last occupied x, y and z.
    voxels: Bounds,
    /// The voxels of any row that are outermost in x, and those next to them as well.
    rims: [<Grid<N> as Size>::Row; 2],
    /// The smoothed vertices' bounds in 1/128 voxel.
    vertices: Bounds,
    triangles: u32,
    height_mm: f32,
    /// Millimetres of 1/128 voxel.
    scale: f32,
    walk: Walk,
    /// The next layer to be skimmed.
    layer: u32,
    stage: Stage,
}

impl<const N: usize> Exporter<N>
where
    Grid<N>: Size,
{
    /// A buffer of this many bytes always lets [`Exporter::advance`] go on: the triangles of one
    /// row of cells, at worst. 32 KB at 128.
    pub const MIN_BUFFER: usize = (N + 1) * cases::MOST * stl::RECORD;

    /// At rest. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the exporter about by value
    pub const fn new() -> Self {
        Exporter {
            support: Support::new(),
            smooth: Smooth::new(),
            window: [[[[[0.0; 4]; 6]; N]; 2]; 2],
            voxels: Bounds::ZERO,
            rims: [<Grid<N> as Size>::Row::EMPTY; 2],
            vertices: Bounds::ZERO,
            triangles: 0,
            height_mm: 0.0,
            scale: 0.0,
            walk: Walk::new(),
            layer: 0,
            stage: Stage::Idle,
        }
    }

    /// Begins a file, dropping one under way. The smoothed model, from its lowest vertex to its
    /// highest, will be `height_mm` high.
    ///
    /// # Errors
    /// A height outside [`HEIGHTS_MM`]; the exporter stays as it was.
    pub fn start(&mut self, height_mm: f32) -> Result<(), HeightOutOfRange> {
        if !HEIGHTS_MM.contains(&height_mm) {
            return Err(HeightOutOfRange(height_mm));
        }
        self.support.start();
        self.voxels = Bounds::NONE;
        self.vertices = Bounds::NONE;
        (self.triangles, self.layer) = (0, 0);
        self.height_mm = height_mm;
        self.stage = Stage::Supporting;
        Ok(())
    }

    /// Goes on for at most `budget` units of work, writing to the front of `out`. A unit is a row
    /// visited, or a layer skimmed for its bounds.
    ///
    /// `rows` is the volume and `mask` its mask (empty for none); neither may change from start to
    /// end. Returns early when `out` has no room for the next piece; with
    /// [`Exporter::MIN_BUFFER`] bytes of room it has, and a file that fits `out` as a whole is
    /// written as a whole. Budgets and buffers make no difference to the bytes.
    pub fn advance(
        &mut self,
        rows: &Plane<N>,
        mask: &Maps<N>,
        mut budget: u32,
        out: &mut [u8],
    ) -> Progress {
        let mut written = 0;
        while budget > 0 {
            match self.stage {
                Stage::Supporting => {
                    if self.support.advance(rows, mask, &mut budget) {
                        self.stage = Stage::Bounding;
                    }
                    continue;
                }
                Stage::Bounding => self.bound(),
                Stage::Measuring => self.measure(),
                Stage::Heading | Stage::Writing => {
                    let Some(len) = self.write(&mut out[written..]) else { break };
                    written += len;
                }
                Stage::Idle | Stage::Done => break,
            }
            budget -= 1;
        }
        Progress { written, stage: self.stage }
    }

    /// The number of triangles, once it is known: from [`Stage::Heading`] on. None at all means
    /// that the volume is empty.
    #[must_use]
    pub fn triangles(&self) -> Option<u32> {
        (self.stage >= Stage::Heading).then_some(self.triangles)
    }

    /// The length of the whole file in bytes, once it is known: from [`Stage::Heading`] on.
    #[must_use]
    pub fn file_len(&self) -> Option<u64> {
        let triangles = u64::from(self.triangles()?);
        Some(stl::HEADER as u64 + triangles * stl::RECORD as u64)
    }

    /// Takes the next layer into the voxels' bounds.
    fn bound(&mut self) {
        let y = self.layer as usize;
        let mut all = <Grid<N> as Size>::Row::EMPTY;
        for (z, row) in self.support.found().layer(y).iter().enumerate() {
            if !row.is_empty() {
                all |= *row;
                self.voxels.widen(1, y as i32);
                self.voxels.widen(2, z as i32);
            }
        }
        if let (Some(first), Some(last)) = (all.first(), all.last()) {
            self.voxels.widen(0, first as i32);
            self.voxels.widen(0, last as i32);
        }
        self.layer += 1;
        if self.layer == N as u32 {
            if !self.voxels.is_empty() {
                let [first, last] = [self.voxels.lo[0] as usize, self.voxels.hi[0] as usize];
                let span = <Grid<N> as Size>::Row::span;
                self.rims[0] = span(first, first) | span(last, last);
                self.rims[1] =
                    (self.rims[0].up() | self.rims[0] | self.rims[0].down()) & Grid::<N>::FULL;
            }
            self.walk(Stage::Measuring, Stage::Heading);
        }
    }

    /// A step of the measuring walk. No vertex moves more than half a voxel, so those of the
    /// outermost voxels have the bounds.
    fn measure(&mut self) {
        let solid = self.support.found();
        match self.walk.step() {
            Step::Voxels(y, z) => self.smooth.encode(solid, (y, z), self.rim((y, z), 1)),
            Step::Cells(y, z) => {
                self.triangles += cells::count(&self.edges((y, z)));
                if y < N && z < N {
                    let (rim, bounds) = (self.rim((y, z), 0), &mut self.vertices);
                    self.smooth.vertices(
                        solid,
                        (y, z),
                        rim,
                        &[0, 1, 2, 3, 4, 5],
                        |_, _, position| {
                            bounds.add(position);
                        },
                    );
                }
            }
        }
        if !self.walk.next(&self.voxels) {
            self.stage = Stage::Heading;
            self.scale = self.height_mm / (self.vertices.hi[1] - self.vertices.lo[1]) as f32;
        }
    }

    /// The places in a row at most `margin` inside the bounds of all voxels, which is 0 or 1.
    fn rim(&self, (y, z): (usize, usize), margin: usize) -> <Grid<N> as Size>::Row {
        let Bounds { lo, hi } = self.voxels;
        let near =
            |axis: usize, at: i32| at - lo[axis] <= margin as i32 || hi[axis] - at <= margin as i32;
        if near(1, y as i32) || near(2, z as i32) { Grid::<N>::FULL } else { self.rims[margin] }
    }

    /// Writes the header, or takes a step of the writing walk; `None` without room for it.
    fn write(&mut self, out: &mut [u8]) -> Option<usize> {
        if self.stage == Stage::Heading {
            out.get_mut(..stl::HEADER)?.copy_from_slice(&stl::header(self.triangles));
            self.walk(Stage::Writing, Stage::Done);
            return Some(stl::HEADER);
        }
        let mut written = 0;
        match self.walk.step() {
            Step::Voxels(y, z) => {
                self.smooth.encode(self.support.found(), (y, z), Grid::<N>::FULL);
            }
            Step::Cells(y, z) => {
                let edges = self.edges((y, z));
                if out.len() < Self::MIN_BUFFER
                    && out.len() < cells::count(&edges) as usize * stl::RECORD
                {
                    return None;
                }
                self.place(y, z);
                written = self.triangulate(&edges, z, out);
            }
        }
        if !self.walk.next(&self.voxels) {
            self.stage = Stage::Done;
        }
        Some(written)
    }

    /// Puts the smoothed vertices of the rows (y - 1, z) and (y, z) into the window, moved so that
    /// the model stands where it should.
    fn place(&mut self, y: usize, z: usize) {
        let Bounds { lo, hi } = self.vertices;
        // Halves at most: all of this is exact.
        let [x_middle, z_middle] = [0, 2].map(|axis| (lo[axis] + hi[axis]) as f32 / 2.0);
        for (above, window) in self.window.iter_mut().enumerate() {
            let y = (y + above).wrapping_sub(1);
            if y >= N || z >= N {
                continue;
            }
            let window = &mut window[z % 2];
            // Those that look out of the slab are not in its cells.
            let faces = if above == 0 { &[0, 1, 2, 4, 5] } else { &[0, 1, 3, 4, 5] };
            let solid = self.support.found();
            self.smooth.vertices(
                solid,
                (y, z),
                Grid::<N>::FULL,
                faces,
                |voxel, face, [x, y, z]| {
                    window[voxel][face] =
                        [x as f32 - x_middle, z_middle - z as f32, (y - lo[1]) as f32, 0.0];
                },
            );
        }
    }

    /// Writes the triangles of a row of cells.
    fn triangulate(
        &self,
        edges: &Edges<<Grid<N> as Size>::Row>,
        z: usize,
        out: &mut [u8],
    ) -> usize {
        let window = self.window.as_flattened().as_flattened().as_flattened();
        let places = &Self::PLACES[z % 2];
        let (records, _) = out.as_chunks_mut::<{ stl::RECORD }>();
        let mut records = records.iter_mut();
        let mut count = 0;
        cells::each_cell(edges, |cell, case| {
            let case = &cases::CASES[case];
            for (triangle, record) in case.triangles[..case.count as usize].iter().zip(&mut records)
            {
                let corner =
                    |i: usize| window[places[triangle[i] as usize % 32].wrapping_add(cell * 6)];
                stl::record([corner(0), corner(1), corner(2)], self.scale, record);
            }
            count += usize::from(case.count);
        });
        count * stl::RECORD
    }

    /// The rows around the cells between the layers y - 1 and y and the rows z - 1 and z.
    fn edges(&self, (y, z): (usize, usize)) -> Edges<<Grid<N> as Size>::Row> {
        let found = self.support.found();
        let mut edges = [[<Grid<N> as Size>::Row::EMPTY; 2]; 2];
        for (above, edges) in edges.iter_mut().enumerate() {
            let y = (y + above).wrapping_sub(1);
            if y < N {
                for (before, edge) in edges.iter_mut().enumerate() {
                    let z = (z + before).wrapping_sub(1);
                    if z < N {
                        *edge = found.row(y, z);
                    }
                }
            }
        }
        edges
    }

    /// From the first face of the voxel after a cell to the cell's vertices in the window, by z
    /// modulo 2 of that voxel.
    const PLACES: [[usize; 32]; 2] = {
        let mut places = [[0; 32]; 2];
        let mut i = 0;
        while i < 2 * cases::CELL_VERTICES {
            let (odd, vertex) = (i / cases::CELL_VERTICES, i % cases::CELL_VERTICES);
            let (corner, face) = cases::corner_face(vertex as u8);
            let (i_x, j, k) = (corner & 1, corner >> 1 & 1, corner >> 2);
            let row = 2 * j + (odd + k + 1) % 2;
            places[odd][vertex] = ((row * N + i_x) * 6 + face).wrapping_sub(6);
            i += 1;
        }
        places
    };

    /// Begins a walk through the layers, or goes on where there is nothing to walk through.
    fn walk(&mut self, stage: Stage, then: Stage) {
        if self.voxels.is_empty() {
            self.stage = then;
        } else {
            self.walk.start(&self.voxels);
            self.stage = stage;
        }
    }
}
