//! Start volumes as signed-distance code: a lump of stone, the figures hidden in it, and a toy.
//!
//! Everything is made when it is asked for, the same bits on every machine. All figures stand on the
//! ground layer and, but for the toy, lie within the lump.

mod amphora;
mod cat;
mod dolphin;
mod field;

mod lump;
mod owl;
mod raster;
mod toy;

use glam::Vec3;
use paros_core::maps::Maps;
use paros_core::plane::Plane;
use paros_core::size::{Grid, Size};

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
    /// The friendly nobody of the creative mode.
    Toy = 5,
}

impl Figure {
    /// All of them, in the order of their numbers.
    pub const ALL: [Figure; 6] =
        [Figure::Lump, Figure::Owl, Figure::Cat, Figure::Amphora, Figure::Dolphin, Figure::Toy];

    /// Those that hide in the lump, for the constrained mode (section 3.5 of the paper).
    pub const HIDDEN: [Figure; 4] = [Figure::Owl, Figure::Cat, Figure::Amphora, Figure::Dolphin];

    /// A word for it, as used on the command line.
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

    /// The figure of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|figure| figure.name() == name)
    }

    /// Makes the figure: `maps` are the tight hulls of its voxels, `plane` their closure. A voxel is
    /// the figure's when its centre is.
    pub fn carve_into<const N: usize>(self, plane: &mut Plane<N>, maps: &mut Maps<N>)
    where
        Grid<N>: Size,
    {
        match self {
            Figure::Lump => raster::fill(plane, &lump::field),
            Figure::Owl => raster::fill(plane, &owl::field),
            Figure::Cat => raster::fill(plane, &cat::field),
            Figure::Amphora => raster::fill(plane, &amphora::field),
            Figure::Dolphin => raster::fill(plane, &dolphin::field),
            Figure::Toy => raster::fill(plane, &toy::field),
        }
        plane.hulls(maps);
        plane.expand(maps);
    }

    /// Whether the centre of a voxel of an N^3 grid lies in the figure's shape, asked one by one:
    /// what [`Figure::carve_into`] must agree with before closure.
    #[must_use]
    pub fn covers<const N: usize>(self, voxel: [usize; 3]) -> bool {
        self.distance(raster::centre::<N>(voxel, 1)) <= 0.0
    }

    /// Signed distance to the figure's surface or less, in 1/128 of the box's edge: x and z from the
    /// middle, y from the ground.
    fn distance(self, p: Vec3) -> f32 {
        match self {
            Figure::Lump => lump::field(p),
            Figure::Owl => owl::field(p),
            Figure::Cat => cat::field(p),
            Figure::Amphora => amphora::field(p),
            Figure::Dolphin => dolphin::field(p),
            Figure::Toy => toy::field(p),
        }
    }
}
