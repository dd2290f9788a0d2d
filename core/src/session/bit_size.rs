//! Sizes of bits: each scales by half to double in steps of a quarter of an octave, as far as its table entry allows.
//!
//! A size is a bit's own, not a hand's: it stays with the bit on the bench and on another tool's return, until the
//! next session starts.

use crate::session::tools::{BitShape, ToolBit, ToolBitSpec};

/// How many steps a bit is larger than in the table, or smaller where negative. Four steps double it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct BitSize(i8);

/// The sizes that a bit comes in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SizeRange {
    /// In steps, not above 0. A smaller bit would leave less than a voxel's wall beside a bite worth the name.
    pub smallest: i8,
    /// In steps, not below 0. A bite of a larger bit wouldn't fit a hand's share of a tick with both hands in use and
    /// the mirror on.
    pub largest: i8,
}

impl SizeRange {
    pub(crate) const ALL: SizeRange = SizeRange::of(-4, 4);
    pub(crate) const NATURAL_ALONE: SizeRange = SizeRange::of(0, 0);

    pub(crate) const fn of(smallest: i8, largest: i8) -> Self {
        SizeRange { smallest, largest }
    }
}

/// The lengths of bits of each size, in thousandths of those in the table.
const SCALES: [i32; 9] = [500, 595, 707, 841, 1000, 1189, 1414, 1682, 2000];

/// Half of what may not enter stone of a bit that isn't a disc, in micrometres: a bit's centre is never in stone where
/// that is seven eighths of a voxel at 128.
const WALL_UM: i32 = 3_100;

/// The deepest bite, in micrometres: what an edit may reach below the surface at 256.
const DEEPEST_BITE_UM: i32 = 7_000;

impl BitSize {
    /// As in the table.
    pub const NATURAL: BitSize = BitSize(0);

    /// The size of so many steps, if a bit comes in it.
    #[must_use]
    pub fn of_bit(bit: ToolBit, steps: i8) -> Option<BitSize> {
        let SizeRange { smallest, largest } = bit.spec().sizes;
        (smallest..=largest).contains(&steps).then_some(BitSize(steps))
    }

    /// Steps from the size in the table.
    #[must_use]
    pub const fn steps(self) -> i8 {
        self.0
    }

    /// The bit's lengths in percent of those in the table.
    #[must_use]
    pub fn percent(self) -> u32 {
        (self.thousandths() as u32 + 5) / 10
    }

    /// The bit's lengths in those of the table.
    #[must_use]
    pub fn scale(self) -> f32 {
        self.thousandths() as f32 * 1e-3
    }

    /// The size so many steps from this one, or the last one on the way that the bit comes in.
    pub(crate) fn resized_by(self, bit: ToolBit, steps: i32) -> BitSize {
        let SizeRange { smallest, largest } = bit.spec().sizes;
        let wanted = i32::from(self.0).saturating_add(steps);
        BitSize(wanted.clamp(smallest.into(), largest.into()) as i8)
    }

    const fn thousandths(self) -> i32 {
        SCALES[(self.0 + 4) as usize]
    }

    const fn scale_um(self, length_um: i32) -> i32 {
        length_um * self.thousandths() / 1000
    }
}

impl ToolBit {
    /// Its table entry with the lengths that it has at a size. A larger bit makes fewer bites in a tick, so its bite
    /// grows with it; a smaller one makes more, and keeps its bite as far as it can: so both follow a quick hand.
    #[must_use]
    pub fn spec_at(self, size: BitSize) -> ToolBitSpec {
        let spec = *self.spec();
        if size == BitSize::NATURAL {
            return spec;
        }
        let shape = match spec.shape {
            BitShape::Ball { radius_um } => BitShape::Ball { radius_um: size.scale_um(radius_um) },
            BitShape::Box { half_extents_um } => {
                BitShape::Box { half_extents_um: half_extents_um.map(|half| size.scale_um(half)) }
            }
            BitShape::Disc { .. } => spec.shape,
        };
        let thinnest_um = match shape {
            BitShape::Ball { radius_um } | BitShape::Disc { radius_um } => radius_um,
            BitShape::Box { half_extents_um: [x, y, z] } => x.min(y).min(z),
        };
        let bite_um = spec.bite_um.max(size.scale_um(spec.bite_um));
        let bite_um = bite_um.min(DEEPEST_BITE_UM).min(thinnest_um - WALL_UM);
        ToolBitSpec { shape, bite_um, reach_um: spec.reach_um.map(|um| size.scale_um(um)), ..spec }
    }
}
