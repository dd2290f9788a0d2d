//! The hidden figures, each with the stone around it: what a session of the constrained mode starts from.

use paros_core::RangeMaps;
use paros_core::session::SessionMode;
use paros_core::volume::{BitGrid, Grid, Size};
use paros_shapes::lump;

use super::{Figure, raster};

/// How much stone hides a figure at the start.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum StoneThickness {
    /// The whole lump.
    Whole = 0,
    /// About 45 mm of it.
    Half = 1,
    /// About 20 mm of it: what a newcomer takes off in minutes.
    Near = 2,
}

/// A hidden figure and the stone around it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HiddenStart {
    /// One of [`Figure::HIDDEN`].
    pub figure: Figure,
    /// The stone around it.
    pub thickness: StoneThickness,
}

/// The thinner stones' fracture, as a share of the lump's.
const ROUGHNESS_OF_LUMP: f32 = 0.5;

/// The most by which that fracture moves their surface.
const ROUGHNESS: f32 = ROUGHNESS_OF_LUMP * lump::MAX_FRACTURE;

/// Names on the command line, by figure and thickness. The bare name is for newcomers.
const NAMES: [[&str; 3]; 4] = [
    ["owl-whole", "owl-half", "owl"],
    ["cat-whole", "cat-half", "cat"],
    ["amphora-whole", "amphora-half", "amphora"],
    ["dolphin-whole", "dolphin-half", "dolphin"],
];

impl StoneThickness {
    /// All of them, thickest first.
    pub const ALL: [StoneThickness; 3] =
        [StoneThickness::Whole, StoneThickness::Half, StoneThickness::Near];

    /// How far it reaches from the figure, in 1/128 of the box's edge; `None` for all of the lump.
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
    /// All of them in the order of their numbers: by thickness, then by figure.
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

    /// The one of a number of [`SessionMode::Constrained`].
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// Its number in [`SessionMode::Constrained`].
    #[must_use]
    pub const fn number(self) -> u8 {
        self.thickness as u8 * Figure::HIDDEN.len() as u8 + self.place_in_hidden() as u8
    }

    /// The mode that starts with it.
    #[must_use]
    pub const fn mode(self) -> SessionMode {
        SessionMode::Constrained { figure: self.number() }
    }

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        NAMES[self.place_in_hidden()][self.thickness as usize]
    }

    /// Rasterizes its stone, as [`Figure::rasterize_into`] does a figure: a subset of the lump, and the figure one
    /// of it. `maps` are the lump before.
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
            // A bound is enough where a sign is certain: the fracture takes most of the time.
            let rough = if even > ROUGHNESS {
                -ROUGHNESS
            } else if even < -ROUGHNESS {
                ROUGHNESS
            } else {
                // Smoother than the lump, as a newcomer strokes it off in layers.
                ROUGHNESS_OF_LUMP * lump::fracture(p)
            };
            (even + rough) * 0.75
        });
        bit_grid.write_closure(maps);
        bit_grid.set_from_maps(maps);
    }

    /// The figure's place in [`Figure::HIDDEN`].
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
