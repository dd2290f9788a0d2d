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

use crate::maps::Maps;
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};
use cells::Edges;
use core::ops::RangeInclusive;
use smooth::Smooth;
use stl::Point;
use support::Support;

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
    /// The smoothed vertices' bounds in 1/128 voxel.
    vertices: Bounds,
    triangles: u32,
    height_mm: f32,
    /// Millimetres of 1/128 voxel.
    scale: f32,
    /// The layer whose voxels are being taken up; the slab of cells worked on ends one layer below.
    layer: u32,
    /// The next row of the layer: rows of voxels first, rows of cells after them.
    step: u32,
    stage: Stage,
}

/// Ends of a box, both inside.
#[derive(Clone, Copy)]
struct Bounds {
    lo: [i32; 3],
    hi: [i32; 3],
}

/// A step of the walk through the layers.
enum Step {
    /// Take up row (y, z) of voxels.
    Voxels(usize, usize),
    /// Work on the cells between the layers y - 1 and y and the rows z - 1 and z. Layer y has been taken up, and y + 1 where it has voxels.
    Cells(usize, usize),
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
        const ZERO: Bounds = Bounds { lo: [0; 3], hi: [0; 3] };
        Exporter {
            support: Support::new(),
            smooth: Smooth::new(),
            window: [[[[[0.0; 4]; 6]; N]; 2]; 2],
            voxels: ZERO,
            vertices: ZERO,
            triangles: 0,
            height_mm: 0.0,
            scale: 0.0,
            layer: 0,
            step: 0,
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
        (self.triangles, self.layer, self.step) = (0, 0, 0);
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
            self.walk(Stage::Measuring, Stage::Heading);
        }
    }

    /// A step of the measuring walk. No vertex moves more than half a voxel, so those of the
    /// outermost voxels have the bounds.
    fn measure(&mut self) {
        let solid = self.support.found();
        match self.step() {
            Step::Voxels(y, z) => {
                let rim = rim::<N>(&self.voxels, (y, z), 1);
                self.smooth.encode(solid, (y, z), rim);
            },
            Step::Cells(y, z) => {
                self.triangles += cells::count(&self.edges((y, z)));
                if y < N && z < N {
                    let bounds = &mut self.vertices;
                    let rim = rim::<N>(&self.voxels, (y, z), 0);
                    self.smooth.vertices(solid, (y, z), rim, |_, _, position| bounds.add(position));
                }
            }
        }
        self.next_step(Stage::Heading);
        if self.stage == Stage::Heading {
            self.scale = self.height_mm / (self.vertices.hi[1] - self.vertices.lo[1]) as f32;
        }
    }

    /// Writes the header, or takes a step of the writing walk; `None` without room for it.
    fn write(&mut self, out: &mut [u8]) -> Option<usize> {
        if self.stage == Stage::Heading {
            out.get_mut(..stl::HEADER)?.copy_from_slice(&stl::header(self.triangles));
            self.walk(Stage::Writing, Stage::Done);
            return Some(stl::HEADER);
        }
        let mut written = 0;
        match self.step() {
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
        self.next_step(Stage::Done);
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
            let solid = self.support.found();
            self.smooth.vertices(solid, (y, z), Grid::<N>::FULL, |voxel, face, [x, y, z]| {
                window[voxel][face] =
                    [x as f32 - x_middle, z_middle - z as f32, (y - lo[1]) as f32, 0.0];
            });
        }
    }

    /// Writes the triangles of a row of cells.
    fn triangulate(&self, edges: &Edges<<Grid<N> as Size>::Row>, z: usize, out: &mut [u8]) -> usize {
        let window = self.window.as_flattened().as_flattened().as_flattened();
        // From the voxel after a cell to the cell's vertices.
        let places: [usize; cases::CELL_VERTICES] = core::array::from_fn(|vertex| {
            let (corner, face) = cases::corner_face(vertex as u8);
            let [i, j, k] = [0, 1, 2].map(|axis| corner >> axis & 1);
            let row = 2 * j + (z + k + 1) % 2;
            ((row * N + i) * 6 + face).wrapping_sub(6)
        });
        let (records, _) = out.as_chunks_mut::<{ stl::RECORD }>();
        let mut records = records.iter_mut();
        let mut count = 0;
        cells::each_cell(edges, |cell, case| {
            let case = &cases::CASES[case];
            for (triangle, record) in case.triangles[..case.count as usize].iter().zip(&mut records) {
                let corners = triangle.map(|v| window[places[v as usize].wrapping_add(cell * 6)]);
                stl::record(corners, self.scale, record);
            }
            count += usize::from(case.count);
        });
        count * stl::RECORD
    }

    /// The rows around the cells between the layers y - 1 and y and the rows z - 1 and z.
    fn edges(&self, (y, z): (usize, usize)) -> Edges<<Grid<N> as Size>::Row> {
        let found = self.support.found();
        [y.wrapping_sub(1), y].map(|y| {
            [z.wrapping_sub(1), z].map(|z| {
                if y < N && z < N { found.row(y, z) } else { <Grid<N> as Size>::Row::EMPTY }
            })
        })
    }

    /// Begins a walk through the layers, or goes on where there is nothing to walk through.
    fn walk(&mut self, stage: Stage, then: Stage) {
        if self.voxels.is_empty() {
            self.stage = then;
            return;
        }
        (self.layer, self.step) = (self.voxels.lo[1] as u32, 0);
        self.stage = stage;
    }

    fn step(&self) -> Step {
        let (z, depth) = (self.voxels.lo[2] as u32, self.depth());
        let layer = self.layer as usize;
        if self.step < depth {
            Step::Voxels(layer, (z + self.step) as usize)
        } else {
            Step::Cells(layer - 1, (z + self.step - depth) as usize)
        }
    }

    /// Layer by layer: its voxels if it has any, then the cells whose vertices that decides, which
    /// lie below the layer before.
    fn next_step(&mut self, then: Stage) {
        let [bottom, top] = [self.voxels.lo[1] as u32, self.voxels.hi[1] as u32];
        let depth = self.depth();
        self.step += 1;
        if self.step == depth && self.layer > bottom || self.step < depth {
            return;
        }
        if self.layer == bottom || self.step == 2 * depth + 1 {
            self.layer += 1;
            self.step = if self.layer > top { depth } else { 0 };
            if self.layer == top + 3 {
                self.stage = then;
            }
        }
    }

    /// Rows of a layer that can hold voxels.
    fn depth(&self) -> u32 {
        (self.voxels.hi[2] - self.voxels.lo[2] + 1) as u32
    }
}

/// The voxels of a row that lie at most `margin` inside the bounds of all voxels.
fn rim<const N: usize>(
    Bounds { lo, hi }: &Bounds,
    (y, z): (usize, usize),
    margin: i32,
) -> <Grid<N> as Size>::Row
where
    Grid<N>: Size,
{
    let near = |axis: usize, at: usize| (at as i32 - lo[axis]).min(hi[axis] - at as i32) <= margin;
    if near(1, y) || near(2, z) {
        return Grid::<N>::FULL;
    }
    let span = |lo: i32, hi: i32| <Grid<N> as Size>::Row::span(lo.max(0) as usize, hi as usize);
    span(lo[0], (lo[0] + margin).min(hi[0])) | span(hi[0] - margin, hi[0])
}

impl Bounds {
    /// Around nothing.
    const NONE: Bounds = Bounds { lo: [i32::MAX; 3], hi: [i32::MIN; 3] };

    fn is_empty(&self) -> bool {
        self.lo[0] > self.hi[0]
    }

    fn widen(&mut self, axis: usize, at: i32) {
        self.lo[axis] = self.lo[axis].min(at);
        self.hi[axis] = self.hi[axis].max(at);
    }

    fn add(&mut self, point: [i32; 3]) {
        for (axis, at) in point.into_iter().enumerate() {
            self.widen(axis, at);
        }
    }
}
