//! Tools and their exchangeable bits as a data table: shape, bite, period, haptics.
//!
//! Source: section 1.1 of the paper (rotary and impact tools with exchangeable bits, a fill gun);
//! the rasp is an addition. Lengths are integers in micrometres.

use core::array;

use glam::IVec3;

use crate::edit::grid_bit::{GridBit, GridShape};
use crate::edit::pose::SUBUNITS_PER_VOXEL;
use crate::session::bit_size::SizeRange;

/// A tool body, held in a hand.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Tool {
    /// An electric rotary tool.
    Rotary = 0,
    /// A pneumatic hammer.
    Impact = 1,
    /// A gun that applies modelling paste.
    FillGun = 2,
    /// A rasp that smooths.
    Rasp = 3,
}

/// The tip of a tool. The stone's cube has a side of 450 mm: a voxel is 3.5 mm at 128 a side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum ToolBit {
    /// Rotary: a ball of 9 mm radius.
    SmallBall = 0,
    /// Rotary: a ball of 15 mm radius.
    MediumBall = 1,
    /// Rotary: a ball of 24 mm radius.
    LargeBall = 2,
    /// Rotary: a long cutter of square section.
    Cylinder = 3,
    /// Rotary: a flat disc, cut as a slab.
    Grinder = 4,
    /// Impact: a narrow chisel.
    PointChisel = 5,
    /// Impact: a wide chisel.
    FlatChisel = 6,
    /// Rotary: a ball of 40 mm radius, for roughing out.
    RoughingBall = 7,
    /// Rotary: a disc of 70 mm radius, two voxels thick.
    DiscSaw = 8,
    /// The fill gun's fixed nozzle.
    Nozzle = 9,
    /// Rasp: a file that smooths.
    File = 10,
    /// Rasp: a flat blade that levels a surface to a plane.
    Float = 11,
    /// Impact: a blunt chisel that splits flakes off near an edge.
    PitchingChisel = 12,
}

/// The edit that a bit makes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BitAction {
    /// Removes material.
    Carve,
    /// Adds material.
    Fill,
    /// Removes bumps and fills pits.
    Smooth,
    /// Removes stone above a plane and fills pits below it.
    Flatten,
}

impl BitAction {
    /// Returns `true` if the bit is rubbed over the stone, and passes through it.
    #[must_use]
    pub const fn is_rubbing(self) -> bool {
        matches!(self, BitAction::Smooth | BitAction::Flatten)
    }
}

/// The shape of a bit about its centre, in its own frame.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BitShape {
    /// A ball.
    Ball {
        /// Radius in micrometres.
        radius_um: i32,
    },
    /// A box.
    Box {
        /// Half extents in micrometres.
        half_extents_um: [i32; 3],
    },
    /// A disc that works along its own plane, whose normal is x. It is two voxels thick, so that the parts
    /// that it separates are disconnected in any orientation.
    Disc {
        /// Radius in micrometres.
        radius_um: i32,
    },
}

/// The table entry of a bit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ToolBitSpec {
    /// Its name, for display.
    pub name: &'static str,
    /// The tool that takes it.
    pub tool: Tool,
    /// Its action.
    pub action: BitAction,
    /// Its shape.
    pub shape: BitShape,
    /// Maximum penetration into the material, and so the advance in an edit, in micrometres.
    pub bite_um: i32,
    /// Distance by which its edit extends beyond its shape along each axis, in micrometres.
    pub reach_um: [i32; 3],
    /// The range of its sizes.
    pub sizes: SizeRange,
    /// Reach of the flakes that its blows split off, in micrometres; 0 for a bit that splits off none.
    pub flake_um: i32,
    /// Ticks from one blow to the next; 1 for an edit in every tick.
    pub bite_period: u8,
    /// Haptic amplitudes of successive ticks, 0 to 255, repeated while the tool runs.
    pub haptic_train: &'static [u8],
}

impl ToolBitSpec {
    /// Returns `true` if the bit edits this many ticks after its trigger was pulled: in the first half of
    /// each period, as one tick hasn't enough work for the blow of a quick hand. A bit that splits off flakes
    /// edits only in the first tick, so that it doesn't chip at the rest after a flake.
    #[must_use]
    pub const fn is_blow_at(&self, trigger_ticks: u16) -> bool {
        let period = self.bite_period as u16;
        let ticks = if self.flake_um > 0 { 1 } else { period.div_ceil(2) };
        trigger_ticks % period < ticks
    }

    /// Converts the bit to fixed-point grid units, for voxels of side `voxel_um` in micrometres.
    #[must_use]
    pub fn to_grid_bit(&self, voxel_um: f32) -> GridBit {
        self.grid_bit_grown_by([0; 3], voxel_um)
    }

    /// Converts the bit's brush, its shape enlarged by its reach, like [`ToolBitSpec::to_grid_bit`].
    #[must_use]
    pub fn to_grid_brush(&self, voxel_um: f32) -> GridBit {
        self.grid_bit_grown_by(self.reach_um, voxel_um)
    }

    /// Returns the ball of stone that spalls off a hidden figure when the bit touches the figure, in the
    /// units of [`ToolBitSpec::to_grid_bit`]: everything within 34 mm of the bit's centre, at any depth.
    /// `None` for a bit that doesn't carve, for a disc, which only separates stone, and for a ball that is as
    /// large itself.
    #[must_use]
    pub fn to_grid_spall(&self, voxel_um: f32) -> Option<GridBit> {
        /// At 256, a tick has no work for a larger ball beside bites of the large ball.
        const RADIUS_UM: i32 = 34_000;
        let ToolBitSpec { action, shape, .. } = *self;
        let is_large = matches!(shape, BitShape::Ball { radius_um } if radius_um >= RADIUS_UM);
        if action != BitAction::Carve || is_large || matches!(shape, BitShape::Disc { .. }) {
            return None;
        }
        let radius = subunits_from_um(RADIUS_UM, voxel_um);
        Some(GridBit { shape: GridShape::Ball(radius), bite: radius })
    }

    fn grid_bit_grown_by(&self, reach_um: [i32; 3], voxel_um: f32) -> GridBit {
        let fixed = |length_um: i32| subunits_from_um(length_um, voxel_um);
        let shape = match self.shape {
            BitShape::Ball { radius_um } => GridShape::Ball(fixed(radius_um + reach_um[0])),
            BitShape::Box { half_extents_um } => {
                GridShape::Box(IVec3::from_array(array::from_fn(|i| {
                    fixed(half_extents_um[i] + reach_um[i])
                })))
            }
            BitShape::Disc { radius_um } => GridShape::Disc {
                radius: fixed(radius_um + reach_um[1]),
                half_thickness: SUBUNITS_PER_VOXEL + fixed(reach_um[0]),
            },
        };
        GridBit { shape, bite: fixed(self.bite_um) }
    }
}

impl Tool {
    /// All tools, by number.
    pub const ALL: [Tool; 4] = [Tool::Rotary, Tool::Impact, Tool::FillGun, Tool::Rasp];

    /// Returns the bit that is mounted at the start of a session.
    #[must_use]
    pub const fn default_bit(self) -> ToolBit {
        match self {
            Tool::Rotary => ToolBit::MediumBall,
            Tool::Impact => ToolBit::PointChisel,
            Tool::FillGun => ToolBit::Nozzle,
            Tool::Rasp => ToolBit::File,
        }
    }

    /// Distance from the grip forward to the centre of the bit, in micrometres.
    #[must_use]
    pub const fn length_um(self) -> i32 {
        match self {
            Tool::Rotary => 130_000,
            Tool::Impact => 160_000,
            Tool::FillGun => 140_000,
            Tool::Rasp => 120_000,
        }
    }
}

impl ToolBit {
    /// All bits, by number.
    pub const ALL: [ToolBit; 13] = [
        ToolBit::SmallBall,
        ToolBit::MediumBall,
        ToolBit::LargeBall,
        ToolBit::Cylinder,
        ToolBit::Grinder,
        ToolBit::PointChisel,
        ToolBit::FlatChisel,
        ToolBit::RoughingBall,
        ToolBit::DiscSaw,
        ToolBit::Nozzle,
        ToolBit::File,
        ToolBit::Float,
        ToolBit::PitchingChisel,
    ];

    /// Returns the bit with this number.
    #[must_use]
    pub fn from_number(number: u8) -> Option<ToolBit> {
        ToolBit::ALL.get(usize::from(number)).copied()
    }

    /// Returns its table entry.
    #[must_use]
    pub const fn spec(self) -> &'static ToolBitSpec {
        &BITS[self as usize]
    }

    /// Converts the bit in its natural size, like [`ToolBitSpec::to_grid_bit`].
    #[must_use]
    pub fn to_grid_bit(self, voxel_um: f32) -> GridBit {
        self.spec().to_grid_bit(voxel_um)
    }

    /// Returns the reach of the flakes that the bit splits off, in the units of [`ToolBit::to_grid_bit`].
    #[must_use]
    pub fn to_grid_flake_reach(self, voxel_um: f32) -> Option<i32> {
        let reach_um = self.spec().flake_um;
        (reach_um > 0).then(|| subunits_from_um(reach_um, voxel_um))
    }
}

/// Converts a length to fixed-point grid units, for voxels of side `voxel_um` in micrometres.
fn subunits_from_um(length_um: i32, voxel_um: f32) -> i32 {
    libm::roundf(length_um as f32 * SUBUNITS_PER_VOXEL as f32 / voxel_um) as i32
}

const fn ball_spec(
    name: &'static str,
    radius_um: i32,
    bite_um: i32,
    haptic_train: &'static [u8],
) -> ToolBitSpec {
    let shape = BitShape::Ball { radius_um };
    ToolBitSpec {
        name,
        tool: Tool::Rotary,
        action: BitAction::Carve,
        shape,
        bite_um,
        reach_um: [0; 3],
        sizes: SizeRange::ALL,
        flake_um: 0,
        bite_period: 1,
        haptic_train,
    }
}

const fn box_spec(
    name: &'static str,
    tool: Tool,
    half_extents_um: [i32; 3],
    bite_um: i32,
) -> ToolBitSpec {
    let shape = BitShape::Box { half_extents_um };
    ToolBitSpec {
        name,
        tool,
        action: BitAction::Carve,
        shape,
        bite_um,
        reach_um: [0; 3],
        sizes: SizeRange::of(-3, 1),
        flake_um: 0,
        bite_period: 1,
        haptic_train: &[200, 160],
    }
}

static BITS: [ToolBitSpec; 13] = [
    ball_spec("small ball burr", 9_000, 2_500, &[180, 120]),
    ToolBitSpec {
        sizes: SizeRange::of(-4, 3),
        ..ball_spec("medium ball burr", 15_000, 3_000, &[200, 140])
    },
    ToolBitSpec {
        sizes: SizeRange::of(-4, 1),
        ..ball_spec("large ball burr", 24_000, 3_400, &[220, 220, 150])
    },
    ToolBitSpec {
        sizes: SizeRange::of(-4, 0),
        ..box_spec("cylinder cutter", Tool::Rotary, [9_000, 9_000, 22_000], 2_500)
    },
    ToolBitSpec {
        sizes: SizeRange::of(-3, 0),
        haptic_train: &[150, 170, 190, 170],
        ..box_spec("flat grinder", Tool::Rotary, [26_000, 26_000, 7_000], 1_500)
    },
    ToolBitSpec {
        bite_period: 6,
        haptic_train: &[255, 120, 40, 0, 0, 0],
        ..box_spec("point chisel", Tool::Impact, [7_000, 7_000, 20_000], 3_400)
    },
    ToolBitSpec {
        bite_period: 8,
        haptic_train: &[255, 140, 60, 20, 0, 0, 0, 0],
        ..box_spec("flat chisel", Tool::Impact, [18_000, 7_000, 14_000], 3_000)
    },
    ToolBitSpec {
        sizes: SizeRange::of(-4, 0),
        ..ball_spec("roughing ball burr", 40_000, 7_000, &[255, 220, 240, 180])
    },
    ToolBitSpec {
        sizes: SizeRange::NATURAL_ALONE,
        shape: BitShape::Disc { radius_um: 70_000 },
        ..ball_spec("disc saw", 70_000, 7_000, &[160, 200, 180, 220])
    },
    ToolBitSpec {
        tool: Tool::FillGun,
        action: BitAction::Fill,
        ..ball_spec("paste nozzle", 12_000, 3_000, &[60])
    },
    ToolBitSpec {
        action: BitAction::Smooth,
        reach_um: [8_000, 14_000, 8_000],
        sizes: SizeRange::of(-3, 0),
        haptic_train: &[90, 30, 90, 60],
        ..box_spec("rasp file", Tool::Rasp, [10_000, 7_000, 24_000], 1_200)
    },
    ToolBitSpec {
        action: BitAction::Flatten,
        reach_um: [2_000, 8_000, 2_000],
        sizes: SizeRange::of(-3, 0),
        haptic_train: &[110, 50],
        ..box_spec("float", Tool::Rasp, [16_000, 7_000, 26_000], 1_200)
    },
    ToolBitSpec {
        flake_um: 40_000,
        sizes: SizeRange::of(-3, 0),
        bite_period: 8,
        haptic_train: &[255, 180, 90, 40, 0, 0, 0, 0],
        ..box_spec("pitching chisel", Tool::Impact, [22_000, 7_000, 14_000], 3_000)
    },
];
