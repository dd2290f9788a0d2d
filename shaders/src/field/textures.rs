//! The textures of a volume: full rebuild, full upload, and sampling.

use glam::{Vec3, Vec4};
use paros_core::RangeMaps;
use rayon::prelude::*;

use super::backlog::{BoxBacklog, CHUNK, StaleLines};
use super::blur::BoxBlur;
use super::cells::CellDistances;
use super::extent::TexelBox;
use super::gradient::Gradients;
use super::mips;
use super::sizes::{LEVELS, PAD, cell_side_texels};
use super::texels::TexelCube;
use crate::upload::{Region, Texture};

/// The textures of a volume of N voxels a side and K intervals a column, N a multiple of 8 and at
/// most 256, and the work left to bring them up to date.
#[derive(Debug)]
pub struct DensityField<const N: usize, const K: usize = 1> {
    /// The maps as noted last (`noted`), and those that the textures follow (`maps`).
    pub(super) noted: Box<RangeMaps<N, K>>,
    pub(super) maps: Box<RangeMaps<N, K>>,
    /// Columns in which the two may differ.
    pub(super) uncompared: StaleLines,
    pub(super) density: [TexelCube; LEVELS],
    pub(super) gradients: Gradients,
    pub(super) cells: CellDistances,
    pub(super) backlog: BoxBacklog,
    pub(super) stale_lines: StaleLines,
    /// Work done since the last update, not yet charged to a budget.
    pub(super) unbilled_work: usize,
    pub(super) blur: Box<BoxBlur>,
    /// Staging buffer: a region's contiguous bytes.
    pub(super) staging: Vec<u8>,
}

impl<const N: usize, const K: usize> DensityField<N, K> {
    /// Texels along a side of the finest density.
    pub(super) const SIDE: usize = {
        assert!(N.is_multiple_of(8) && N <= 256);
        N + 2 * PAD
    };

    /// Creates the textures of the empty volume: density 0, cell distances
    /// [`MAX_CELL_DISTANCE`](super::MAX_CELL_DISTANCE) - 1. Allocates all memory.
    #[must_use]
    #[allow(clippy::new_without_default)] // megabytes: to be made on purpose
    pub fn new() -> Self {
        DensityField {
            noted: Box::new(RangeMaps::new()),
            maps: Box::new(RangeMaps::new()),
            uncompared: StaleLines::new(N),
            density: [0, 1, 2, 3].map(|level| TexelCube::new(Self::SIDE >> level, 0)),
            gradients: Gradients::new(Self::SIDE / 2),
            cells: CellDistances::new(Self::SIDE, cell_side_texels(N)),
            backlog: BoxBacklog::new(Self::SIDE),
            stale_lines: StaleLines::new(N),
            unbilled_work: 0,
            blur: Box::new(BoxBlur::new()),
            staging: Vec::with_capacity(Self::staging_capacity()),
        }
    }

    /// Rebuilds all textures from these maps, on all cores. Uploads nothing: see
    /// [`DensityField::emit_all_regions`].
    pub fn rebuild_from(&mut self, maps: &RangeMaps<N, K>) {
        self.noted.copy_from(maps);
        self.maps.copy_from(maps);
        self.uncompared.clear();
        let maps = &*self.maps;
        let side = Self::SIDE;
        let [finest, ..] = &mut self.density;
        finest.slabs_mut(CHUNK[2]).enumerate().for_each_init(
            || Box::new(BoxBlur::new()),
            |blur, (slab, texels)| {
                for extent in slab_extents(side, slab) {
                    blur.load_voxels(maps, extent);
                    blur.compute_texels();
                    for (y, z) in extent.rows() {
                        let at = ((z - extent.lo[2]) * side + y) * side;
                        texels[at + extent.lo[0]..at + extent.hi[0]]
                            .copy_from_slice(blur.texel_row(y, z));
                    }
                }
            },
        );
        for level in 1..LEVELS {
            let (finer, coarser) = self.density.split_at_mut(level);
            let side = Self::SIDE >> level;
            mips::downsample_box(&finer[level - 1], &mut coarser[0], TexelBox::cube(side));
        }
        self.gradients.rebuild_from(&self.density[1]);
        self.cells.rescan_surface(&self.density[0], TexelBox::cube(Self::SIDE));
        self.cells.update_distances();
        self.cells.drain_changed_boxes(|_, _| {});
        self.backlog.clear();
        self.stale_lines.clear();
        self.unbilled_work = 0;
    }

    /// Passes every texture whole to `sink`, for textures on the GPU that were just created.
    pub fn emit_all_regions(&self, mut sink: impl FnMut(Region, &[u8])) {
        for axis in paros_core::volume::Axis::ALL {
            let min = [0, 0, axis as u32];
            let lines = (0..N).flat_map(|line| self.maps.line(axis, line));
            let bytes: Vec<u8> = lines.flat_map(|column| column.to_bytes()).flatten().collect();
            let size = [N as u32, N as u32, 1];
            sink(Region { texture: Texture::Maps(K as u8), min, size }, &bytes);
        }
        for (level, texels) in self.density.iter().enumerate() {
            let texture = Texture::Density(level as u8);
            sink(TexelBox::cube(texels.side()).to_region(texture), texels.bytes());
        }
        let whole = TexelBox::cube(self.gradients.side());
        sink(whole.to_region(Texture::Gradient), self.gradients.bytes());
        let cells = self.cells.free_cells_around_each();
        sink(TexelBox::cube(cells.side()).to_region(Texture::Cells), cells.bytes());
    }

    /// Returns the maps as they were last noted.
    #[must_use]
    pub const fn noted_maps(&self) -> &RangeMaps<N, K> {
        &self.noted
    }

    /// Returns `true` if a voxel of the grid is occupied in [`DensityField::noted_maps`].
    #[must_use]
    #[inline]
    pub fn is_occupied(&self, voxel: [usize; 3]) -> bool {
        self.noted.contains(voxel)
    }

    /// Returns the texels along a side of the density at a level below [`LEVELS`].
    #[must_use]
    #[inline]
    pub fn level_side(&self, mip_level: usize) -> usize {
        self.density[mip_level].side()
    }

    /// Returns a texel of the density at a level, 255 where all is full.
    #[must_use]
    #[inline]
    pub fn density_texel(&self, mip_level: usize, texel: [usize; 3]) -> u8 {
        self.density[mip_level].texel(texel)
    }

    /// Returns a trilinear sample of the density, 0 to 1, at a mip level and a point in voxels, clamped to
    /// the edge.
    #[must_use]
    #[inline]
    pub fn sample_density(&self, mip_level: usize, point_in_voxels: Vec3) -> f32 {
        let scale = 1.0 / (1u32 << mip_level) as f32;
        self.density[mip_level]
            .sample_trilinear((point_in_voxels + Vec3::splat(PAD as f32)) * scale)
    }

    /// Returns the direction out of the stone at a texel of level 1: 127 where the density falls by 254 in
    /// two texels.
    #[must_use]
    pub fn outward_texel(&self, texel: [usize; 3]) -> [i8; 3] {
        let [x, y, z, _] = self.gradients.texel(texel);
        [x, y, z]
    }

    /// Returns the convexity of the surface around a texel of level 1: 127 times
    /// [`DensityField::sample_convexity`].
    #[must_use]
    pub fn convexity_texel(&self, texel: [usize; 3]) -> i8 {
        self.gradients.texel(texel)[3]
    }

    /// Returns a trilinear sample, clamped to the edge, of the direction out of the stone at a point in
    /// voxels: longer the nearer to the surface, at most 1 along each axis.
    #[must_use]
    #[inline]
    pub fn sample_outward(&self, point_in_voxels: Vec3) -> Vec3 {
        self.sample_gradient(point_in_voxels).truncate()
    }

    /// Returns the convexity of the surface at a point in voxels: 1 at the sharpest edges, -1 in the
    /// deepest cavities.
    #[must_use]
    #[inline]
    pub fn sample_convexity(&self, point_in_voxels: Vec3) -> f32 {
        self.sample_gradient(point_in_voxels).w
    }

    fn sample_gradient(&self, point_in_voxels: Vec3) -> Vec4 {
        self.gradients.sample_trilinear((point_in_voxels + Vec3::splat(PAD as f32)) * 0.5)
    }

    /// Returns the Chebyshev distance, in voxels, within which no surface lies around a point in voxels:
    /// that of the point's cell, clamped to the edge.
    #[must_use]
    #[inline]
    pub fn free_distance_voxels(&self, point_in_voxels: Vec3) -> f32 {
        let most = self.cells_per_side() - 1;
        let size = cell_side_texels(N) as f32;
        let place = (point_in_voxels + Vec3::splat(PAD as f32)) / size;
        let cell = place.to_array().map(|c| (c as usize).min(most));
        f32::from(self.free_cells_around(cell)) * size
    }

    /// Returns the number of cells along a side.
    #[must_use]
    #[inline]
    pub fn cells_per_side(&self) -> usize {
        self.cells.free_cells_around_each().side()
    }

    /// Returns the number of cells around `cell`, in each direction, that are free of the surface: 0 to
    /// [`MAX_CELL_DISTANCE`](super::MAX_CELL_DISTANCE) - 1. Texel t lies in cell t / [`cell_side_texels`].
    #[must_use]
    #[inline]
    pub fn free_cells_around(&self, cell: [usize; 3]) -> u8 {
        self.cells.free_cells_around_each().texel(cell)
    }
}

/// Returns boxes that each can be computed at once and together cover a slab of the finest texels.
pub(super) fn slab_extents(
    density_side: usize,
    slab_index: usize,
) -> impl Iterator<Item = TexelBox> {
    let [along_x, along_y, along_z] = CHUNK;
    let starts = (0..density_side).step_by(along_y).flat_map(move |y| {
        (0..density_side).step_by(along_x).map(move |x| [x, y, slab_index * along_z])
    });
    starts.map(move |lo| TexelBox {
        lo,
        hi: [0, 1, 2].map(|axis: usize| density_side.min(lo[axis] + CHUNK[axis])),
    })
}
