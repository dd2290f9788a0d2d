//! Sizes of bits: each scales from half to double in steps of a quarter of an octave, within the range of its
//! table entry.
//!
//! A size belongs to a bit, not to a hand: the bit keeps it on the bench and when remounted, until the next
//! session starts.

use crate::session::tools::{BitShape, ToolBit, ToolBitSpec};

/// The number of steps by which a bit is larger than in the table, negative if smaller. Four steps double it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct BitSize(i8);

/// The range of a bit's sizes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SizeRange {
    /// The smallest size in steps, at most 0. A smaller bit would leave less than a voxel's wall beside a
    /// useful bite.
    pub smallest: i8,
    /// The largest size in steps, at least 0. A bite of a larger bit wouldn't fit in a hand's share of a tick
    /// with both hands in use and the mirror on.
    pub largest: i8,
}

impl SizeRange {
    pub(crate) const ALL: SizeRange = SizeRange::of(-4, 4);
    pub(crate) const NATURAL_ALONE: SizeRange = SizeRange::of(0, 0);

    pub(crate) const fn of(smallest: i8, largest: i8) -> Self {
        SizeRange { smallest, largest }
    }
}

/// The scale of each size, in thousandths of the table's lengths.
const SCALES: [i32; 9] = [500, 595, 707, 841, 1000, 1189, 1414, 1682, 2000];

/// Radius of the core of a bit, other than a disc, that may not enter stone, in micrometres. Seven eighths of
/// a voxel at 128: with this, a bit's centre is never in stone.
const WALL_UM: i32 = 3_100;

/// The deepest bite, in micrometres: the depth that an edit may reach below the surface at 256.
const DEEPEST_BITE_UM: i32 = 7_000;

impl BitSize {
    /// The size in the table.
    pub const NATURAL: BitSize = BitSize(0);

    /// Returns the size of this many steps, or `None` if it is outside the bit's range.
    #[must_use]
    pub fn of_bit(bit: ToolBit, steps: i8) -> Option<BitSize> {
        let SizeRange { smallest, largest } = bit.spec().sizes;
        (smallest..=largest).contains(&steps).then_some(BitSize(steps))
    }

    /// Returns the number of steps from the size in the table.
    #[must_use]
    pub const fn steps(self) -> i8 {
        self.0
    }

    /// Returns the scale in percent of the table's lengths.
    #[must_use]
    pub fn percent(self) -> u32 {
        (self.thousandths() as u32 + 5) / 10
    }

    /// Returns the scale relative to the table's lengths.
    #[must_use]
    pub fn scale(self) -> f32 {
        self.thousandths() as f32 * 1e-3
    }

    /// Returns the size this many steps from this one, clamped to the bit's range.
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
    /// Returns its table entry scaled to a size. A larger bit makes fewer bites in a tick, so its bite grows
    /// with it. A smaller bit makes more bites and keeps its bite as far as possible. So both can follow a
    /// quick hand.
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
