//! The hidden figures and the stone around them, from which sessions of the constrained mode start.

use paros_core::RangeMaps;
use paros_core::session::SessionMode;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_shapes::lump;

use super::{Figure, raster};

/// The thickness of the stone around a figure at the start.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum StoneThickness {
    /// The whole lump.
    Whole = 0,
    /// About 45 mm of stone.
    Half = 1,
    /// About 20 mm of stone, which a newcomer removes in minutes.
    Near = 2,
}

/// A hidden figure and the stone around it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HiddenStart {
    /// One of [`Figure::HIDDEN`].
    pub figure: Figure,
    /// The thickness of the stone around it.
    pub thickness: StoneThickness,
}

/// The roughness of thinner stones, as a share of the lump's.
const ROUGHNESS_OF_LUMP: f32 = 0.5;

/// The greatest displacement of a thinner stone's surface.
const ROUGHNESS: f32 = ROUGHNESS_OF_LUMP * lump::MAX_FRACTURE;

/// Names on the command line, by figure and thickness. The bare name has the thinnest stone, for newcomers.
const NAMES: [[&str; 3]; 4] = [
    ["owl-whole", "owl-half", "owl"],
    ["cat-whole", "cat-half", "cat"],
    ["amphora-whole", "amphora-half", "amphora"],
    ["dolphin-whole", "dolphin-half", "dolphin"],
];

impl StoneThickness {
    /// All thicknesses, the thickest first.
    pub const ALL: [StoneThickness; 3] =
        [StoneThickness::Whole, StoneThickness::Half, StoneThickness::Near];

    /// Returns the distance from the figure to which the stone reaches, in 1/128 of the box's edge; `None`
    /// for the whole lump.
    const fn reach(self) -> Option<f32> {
        // The box's edge is 450 mm.
        const MILLIMETRE: f32 = 128.0 / 450.0;
        match self {
            StoneThickness::Whole => None,
            StoneThickness::Half => Some(45.0 * MILLIMETRE),
            StoneThickness::Near => Some(20.0 * MILLIMETRE),
        }
    }
}

impl HiddenStart {
    /// All starts, in the order of their numbers: by thickness, then by figure.
    pub const ALL: [HiddenStart; Figure::HIDDEN.len() * StoneThickness::ALL.len()] = {
        let first = HiddenStart { figure: Figure::Owl, thickness: StoneThickness::Whole };
        let mut all = [first; Figure::HIDDEN.len() * StoneThickness::ALL.len()];
        let mut number = 0;
        while number < all.len() {
            let figure = Figure::HIDDEN[number % Figure::HIDDEN.len()];
            let thickness = StoneThickness::ALL[number / Figure::HIDDEN.len()];
            all[number] = HiddenStart { figure, thickness };
            number += 1;
        }
        all
    };

    /// Returns the start with a number of [`SessionMode::Constrained`].
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Returns its number in [`SessionMode::Constrained`].
    #[must_use]
    pub const fn number(self) -> u8 {
        self.thickness as u8 * Figure::HIDDEN.len() as u8 + self.place_in_hidden() as u8
    }

    /// Returns the session mode that starts with it.
    #[must_use]
    pub const fn mode(self) -> SessionMode {
        SessionMode::Constrained { figure: self.number() }
    }

    /// Returns its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        NAMES[self.place_in_hidden()][self.thickness as usize]
    }

    /// Rasterizes its stone, like [`Figure::rasterize_into`] for a figure. The stone is a subset of the lump,
    /// and contains the figure. `maps` must hold the lump before.
    #[inline(never)]
    pub fn rasterize_stone_into<const N: usize, const K: usize>(
        self,
        maps: &mut RangeMaps<N, K>,
        bit_grid: &mut BitGrid<N>,
    ) where
        Grid<N>: Size,
    {
        bit_grid.set_from_maps(maps);
        let Some(reach) = self.thickness.reach() else { return };
        raster::keep_within(bit_grid, &|p| {
            let even = self.figure.signed_distance(p) - reach + 0.5;
            // Far from the surface a bound suffices for the sign; the fracture takes most of the time.
            let rough = if even > ROUGHNESS {
                -ROUGHNESS
            } else if even < -ROUGHNESS {
                ROUGHNESS
            } else {
                // Smoother than the lump, as a newcomer removes it in layers.
                ROUGHNESS_OF_LUMP * lump::fracture(p)
            };
            (even + rough) * 0.75
        });
        bit_grid.write_closure(maps);
        bit_grid.set_from_maps(maps);
    }

    /// Returns the figure's index in [`Figure::HIDDEN`].
    const fn place_in_hidden(self) -> usize {
        self.figure as usize - Figure::HIDDEN[0] as usize
    }
}

#[cfg(test)]
mod tests {
    use super::{HiddenStart, StoneThickness};
    use crate::figures::Figure;

    #[test]
    fn each_start_has_its_number_and_its_name() {
        for (number, start) in HiddenStart::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(start.number()), number);
            assert_eq!(HiddenStart::from_number(number as u8), Some(start));
            assert!(start.name().starts_with(start.figure.name()), "{start:?}");
        }
        assert_eq!(HiddenStart::from_number(HiddenStart::ALL.len() as u8), None);
        let near_cat = HiddenStart { figure: Figure::Cat, thickness: StoneThickness::Near };
        assert_eq!((near_cat.number(), near_cat.name()), (9, "cat"));
    }
}
