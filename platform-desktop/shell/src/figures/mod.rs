//! Start volumes as signed distance functions: a lump of stone, the figures hidden in it, and a toy.
//!
//! They are rasterized on demand, to the same bits on every machine. All figures stand on the ground
//! layer and, except for the toy, lie within the lump.

mod hidden;
mod own;
mod raster;

use glam::Vec3;
use paros_core::RangeMaps;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_shapes::{amphora, cat, dolphin, lump, owl, toy};

pub use hidden::{HiddenStart, StoneThickness};
pub use own::{
    MAX_FIGURE_NAME_BYTES, MAX_OWN_FIGURES, check_own_figure_names, coat_margin, own_figure_mode,
    write_coat_into,
};

/// A start volume.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Figure {
    /// The roughly cut lump of stone of the free-form and constrained modes.
    Lump = 0,
    /// A small owl on a stump.
    Owl = 1,
    /// A seated cat.
    Cat = 2,
    /// A two-handled jar.
    Amphora = 3,
    /// A dolphin over a wave.
    Dolphin = 4,
    /// A round little creature, for the creative mode.
    Toy = 5,
}

impl Figure {
    /// All figures, in the order of their numbers.
    pub const ALL: [Figure; 6] =
        [Figure::Lump, Figure::Owl, Figure::Cat, Figure::Amphora, Figure::Dolphin, Figure::Toy];

    /// The figures that can hide in the lump, for the constrained mode (section 3.5 of the paper).
    pub const HIDDEN: [Figure; 4] = [Figure::Owl, Figure::Cat, Figure::Amphora, Figure::Dolphin];

    /// Returns the name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Figure::Lump => "lump",
            Figure::Owl => "owl",
            Figure::Cat => "cat",
            Figure::Amphora => "amphora",
            Figure::Dolphin => "dolphin",
            Figure::Toy => "toy",
        }
    }

    /// Returns the figure with this [`Figure::name`].
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|figure| figure.name() == name)
    }

    /// Rasterizes the figure: a voxel belongs to it if its centre does. Sets `maps` and `bit_grid` to the
    /// closure of these voxels.
    #[inline(never)]
    pub fn rasterize_into<const N: usize, const K: usize>(
        self,
        maps: &mut RangeMaps<N, K>,
        bit_grid: &mut BitGrid<N>,
    ) where
        Grid<N>: Size,
    {
        match self {
            Figure::Lump => raster::rasterize(bit_grid, &lump::signed_distance),
            Figure::Owl => raster::rasterize(bit_grid, &owl::signed_distance),
            Figure::Cat => raster::rasterize(bit_grid, &cat::signed_distance),
            Figure::Amphora => raster::rasterize(bit_grid, &amphora::signed_distance),
            Figure::Dolphin => raster::rasterize(bit_grid, &dolphin::signed_distance),
            Figure::Toy => raster::rasterize(bit_grid, &toy::signed_distance),
        }
        bit_grid.write_closure(maps);
        bit_grid.set_from_maps(maps);
    }

    /// Returns `true` if the centre of a voxel of an N^3 grid lies in the figure. [`Figure::rasterize_into`]
    /// must agree with this before closure.
    #[must_use]
    pub fn contains_voxel_centre<const N: usize>(self, voxel: [usize; 3]) -> bool {
        self.signed_distance(raster::block_centre::<N>(voxel, 1)) <= 0.0
    }

    /// Returns the signed distance to the figure's surface, or a bound closer to zero, in 1/128 of the box's
    /// edge. The origin is the middle of the ground.
    fn signed_distance(self, p: Vec3) -> f32 {
        match self {
            Figure::Lump => lump::signed_distance(p),
            Figure::Owl => owl::signed_distance(p),
            Figure::Cat => cat::signed_distance(p),
            Figure::Amphora => amphora::signed_distance(p),
            Figure::Dolphin => dolphin::signed_distance(p),
            Figure::Toy => toy::signed_distance(p),
        }
    }
}
