//! What the fast path marches: textures derived from the range maps, kept up to date where the
//! volume changed, so much a frame.
//!
//! # Textures, for N voxels a side
//! - [`Texture::Maps`]: the range maps that [`Field::note`] saw, as far as they are taken over.
//! - [`Texture::Density`] 0: a cube of N + 8 texels, one for each voxel and [`PAD`] around the grid
//!   on every side. A byte, 255 where all is full: the mean of 5 x 5 x 5 voxels with the weights
//!   1 4 6 4 1 along each axis. Exactly: the weighted sum of a slice's 5 x 5 voxels, 256 where all
//!   are full, is held to 255, and the weighted mean of five such sums rounded, half up. Below y = 0
//!   the ground layer goes on, the rest outside is empty. Creases that would close are opened (see
//!   `crease`), and what is too thin to reach a half by itself is raised (see `thin`).
//! - [`Texture::Density`] 1 to 3: each texel the mean of 2 x 2 x 2 of the finer one, half up.
//! - [`Texture::Cells`]: a byte for each cell of 2 x 2 x 2 texels at N up to 128 and 4 x 4 x 4
//!   above, so that cells are as large in the room (see [`cell`]). The surface of half density may
//!   pass through a cell where a texel in it or next to it is at least [`HALF`]. The byte is how
//!   many cells all around are none of these: the Chebyshev distance to the nearest one, at most
//!   [`FAR`], less one; 0 for those themselves and their neighbours. From anywhere in the cell so
//!   many cells' sides can be stepped, with no more than a multiply-add. While changes are
//!   pending it may tell less, never more.
//!
//! A texel depends on the voxels at most [`REACH`] from it along each axis.
//!
//! Textures are stored, and handed out, with x fastest and z slowest, as a GPU has them.

mod backlog;
mod blur;
mod cells;
mod crease;
mod extent;
mod mips;
mod texels;
mod thin;
mod upkeep;
mod window;

use glam::Vec3;
use paros_core::maps::Maps;
use rayon::prelude::*;

use crate::upload::{Region, Texture};
use backlog::{Backlog, CHUNK, Lines};
use blur::Blur;
use cells::Cells;
use extent::Extent;
use texels::Texels;
pub use upkeep::Budget;

/// Texels around the grid on each side, so that a surface on the cube's border is met as any other.
pub const PAD: usize = 4;
/// The least texel that counts as inside.
pub const HALF: u8 = 128;
/// Levels of detail of the density.
pub const LEVELS: usize = 4;
/// The distance in cells from which on all is as far: a change is felt no further, so that it takes
/// little to measure anew.
pub const FAR: u8 = 7;
/// How far a voxel can change texels, in texels along each axis.
pub const REACH: usize = 3;

/// Texels along a side of a cell, for a volume of `n` voxels a side: 68 cells a side at 128, 66 at
/// 256.
#[must_use]
pub const fn cell(n: usize) -> usize {
    if n > 128 { 4 } else { 2 }
}

/// The textures of a volume of N voxels a side, N a multiple of 8 and at most 256, and what of them
/// is behind the volume.
#[derive(Debug)]
pub struct Field<const N: usize> {
    /// As noted last, and as far as they are taken over.
    latest: Box<Maps<N>>,
    maps: Box<Maps<N>>,
    /// Columns that are to be compared.
    unseen: Lines,
    density: [Texels; LEVELS],
    cells: Cells,
    backlog: Backlog,
    lines: Lines,
    /// Work done since the last frame.
    noted: usize,
    blur: Box<Blur>,
    /// A region's bytes on their way out.
    stage: Vec<u8>,
}

impl<const N: usize> Field<N> {
    /// Texels along a side of the finest density.
    const SIDE: usize = {
        assert!(N.is_multiple_of(8) && N <= 256);
        N + 2 * PAD
    };

    /// The textures of the empty volume: density 0, [`FAR`] - 1 cells free. All memory is taken here.
    #[must_use]
    #[allow(clippy::new_without_default)] // megabytes: to be made on purpose
    pub fn new() -> Self {
        Field {
            latest: Box::new(Maps::new()),
            maps: Box::new(Maps::new()),
            unseen: Lines::new(N),
            density: [0, 1, 2, 3].map(|level| Texels::new(Self::SIDE >> level, 0)),
            cells: Cells::new(Self::SIDE, cell(N)),
            backlog: Backlog::new(Self::SIDE),
            lines: Lines::new(N),
            noted: 0,
            blur: Box::new(Blur::new()),
            stage: Vec::with_capacity(Self::stage_bytes()),
        }
    }

    /// Becomes the textures of these maps, from nothing and at once, on all cores. What is handed
    /// out later is what changes from then on: see [`Field::whole`].
    pub fn rebuild(&mut self, maps: &Maps<N>) {
        self.latest.copy_from(maps);
        self.maps.copy_from(maps);
        self.unseen.clear();
        let maps = &*self.maps;
        let side = Self::SIDE;
        let [finest, ..] = &mut self.density;
        finest.slabs_mut(CHUNK[2]).enumerate().for_each_init(
            || Box::new(Blur::new()),
            |blur, (slab, texels)| {
                for extent in slab_extents(side, slab) {
                    blur.look(maps, extent);
                    blur.compute();
                    for (y, z) in extent.rows() {
                        let at = ((z - extent.lo[2]) * side + y) * side;
                        texels[at + extent.lo[0]..at + extent.hi[0]]
                            .copy_from_slice(blur.row(y, z));
                    }
                }
            },
        );
        for level in 1..LEVELS {
            let (finer, coarser) = self.density.split_at_mut(level);
            let side = Self::SIDE >> level;
            mips::halve(&finer[level - 1], &mut coarser[0], Extent::cube(side));
        }
        self.cells.follow(&self.density[0], Extent::cube(Self::SIDE));
        self.cells.measure();
        self.cells.take_changed(|_, _| {});
        self.backlog.clear();
        self.lines.clear();
        self.noted = 0;
    }

    /// Hands out every texture whole, as for one that was just made.
    pub fn whole(&self, mut sink: impl FnMut(Region, &[u8])) {
        for axis in paros_core::maps::Axis::ALL {
            let min = [0, 0, axis as u32];
            let lines = (0..N).flat_map(|line| self.maps.line(axis, line));
            let bytes: Vec<u8> = lines.flat_map(|column| column.0[0].to_bytes()).collect();
            let size = [N as u32, N as u32, 1];
            sink(Region { texture: Texture::Maps, min, size }, &bytes);
        }
        for (level, texels) in self.density.iter().enumerate() {
            let texture = Texture::Density(level as u8);
            sink(Extent::cube(texels.side()).region(texture), texels.bytes());
        }
        let cells = self.cells.free();
        sink(Extent::cube(cells.side()).region(Texture::Cells), cells.bytes());
    }

    /// The maps as they were last noted.
    #[must_use]
    pub const fn latest(&self) -> &Maps<N> {
        &self.latest
    }

    /// Whether a voxel of the grid is occupied in [`Field::latest`].
    #[must_use]
    #[inline]
    pub fn occupied(&self, voxel: [usize; 3]) -> bool {
        self.latest.contains(voxel)
    }

    /// Texels along a side of the density at a level below [`LEVELS`].
    #[must_use]
    #[inline]
    pub fn side(&self, level: usize) -> usize {
        self.density[level].side()
    }

    /// A texel of the density at a level, 255 where all is full.
    #[must_use]
    #[inline]
    pub fn texel(&self, level: usize, texel: [usize; 3]) -> u8 {
        self.density[level].at(texel)
    }

    /// The density at a level and a point in voxels, 0 to 1, filtered trilinearly between texels;
    /// beyond the outermost ones as they are.
    #[must_use]
    #[inline]
    pub fn sample(&self, level: usize, point: Vec3) -> f32 {
        let scale = 1.0 / (1u32 << level) as f32;
        self.density[level].sample((point + Vec3::splat(PAD as f32)) * scale)
    }

    /// How far from a point in voxels no surface is, along each axis, in voxels: what the cell that
    /// it lies in tells; beyond the outermost cells, what those do.
    #[must_use]
    #[inline]
    pub fn free(&self, point: Vec3) -> f32 {
        let most = self.cells_side() - 1;
        let size = cell(N) as f32;
        let place = (point + Vec3::splat(PAD as f32)) / size;
        f32::from(self.cell(place.to_array().map(|c| (c as usize).min(most)))) * size
    }

    /// Cells along a side.
    #[must_use]
    #[inline]
    pub fn cells_side(&self) -> usize {
        self.cells.free().side()
    }

    /// How many cells all around one are free of the surface, 0 to [`FAR`] - 1; texel t lies in
    /// cell t / [`cell`].
    #[must_use]
    #[inline]
    pub fn cell(&self, cell: [usize; 3]) -> u8 {
        self.cells.free().at(cell)
    }
}

/// The parts, as large as can be computed at once, of a slab of the finest texels.
fn slab_extents(side: usize, slab: usize) -> impl Iterator<Item = Extent> {
    let [along_x, along_y, along_z] = CHUNK;
    let starts = (0..side)
        .step_by(along_y)
        .flat_map(move |y| (0..side).step_by(along_x).map(move |x| [x, y, slab * along_z]));
    starts.map(move |lo| Extent {
        lo,
        hi: [0, 1, 2].map(|axis: usize| side.min(lo[axis] + CHUNK[axis])),
    })
}
