//! The tools and their bits as plain data: shape, bite, pulse, haptic signature.
//!
//! Source: section 1.1 of the paper (rotary and impact tools with exchangeable bits, a fill gun);
//! the rasp is ours. Lengths in micrometres, so that the table holds no float.

use glam::IVec3;

use crate::pose::SUB;

/// A tool body that a hand holds.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Tool {
    /// An electric rotary tool.
    Rotary = 0,
    /// A pneumatic hammer.
    Impact = 1,
    /// A gun that lays modelling paste.
    FillGun = 2,
    /// A rasp that smooths.
    Rasp = 3,
}

/// The tip of a tool.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Bit {
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
    /// The fill gun's fixed nozzle.
    Nozzle = 7,
    /// The rasp's fixed file.
    File = 8,
}

/// What a bit does where it bites.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Action {
    /// Removes material.
    Carve,
    /// Lays material on.
    Fill,
    /// Wears bumps down and fills pits.
    Smooth,
}

/// The shape of a bit about its centre, in its own frame.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// A ball.
    Ball {
        /// In micrometres.
        radius: i32,
    },
    /// A box.
    Box {
        /// Half extents in micrometres.
        half: [i32; 3],
    },
}

/// Everything the core knows of a bit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BitData {
    /// Its name, for people.
    pub name: &'static str,
    /// The tool that takes it.
    pub tool: Tool,
    /// What it does.
    pub action: Action,
    /// Its shape.
    pub shape: Shape,
    /// How deep it may sit in the material, and so how far it advances in a tick, in micrometres.
    pub bite: i32,
    /// Ticks from one bite to the next; 1 bites on every tick.
    pub period: u8,
    /// Haptic strength of each tick of its train, 0 to 255, repeated.
    pub train: &'static [u8],
}

/// A bit's shape and bite on a given grid, in fixed point ([`SUB`] to a voxel).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct GridBit {
    /// The shape.
    pub shape: GridShape,
    /// How deep it may sit in the material.
    pub bite: i32,
}

/// A shape in fixed point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum GridShape {
    /// A ball of a radius.
    Ball(i32),
    /// A box of half extents.
    Box(IVec3),
}

impl Tool {
    /// All of them, by number.
    pub const ALL: [Tool; 4] = [Tool::Rotary, Tool::Impact, Tool::FillGun, Tool::Rasp];

    /// The bit it lies on the bench with.
    #[must_use]
    pub const fn first_bit(self) -> Bit {
        match self {
            Tool::Rotary => Bit::MediumBall,
            Tool::Impact => Bit::PointChisel,
            Tool::FillGun => Bit::Nozzle,
            Tool::Rasp => Bit::File,
        }
    }

    /// From the hand's grip to the centre of the bit, forward, in micrometres.
    #[must_use]
    pub const fn length(self) -> i32 {
        match self {
            Tool::Rotary => 130_000,
            Tool::Impact => 160_000,
            Tool::FillGun => 140_000,
            Tool::Rasp => 120_000,
        }
    }
}

impl Bit {
    /// All of them, by number.
    pub const ALL: [Bit; 9] = [
        Bit::SmallBall,
        Bit::MediumBall,
        Bit::LargeBall,
        Bit::Cylinder,
        Bit::Grinder,
        Bit::PointChisel,
        Bit::FlatChisel,
        Bit::Nozzle,
        Bit::File,
    ];

    /// The bit of a number.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Bit> {
        Bit::ALL.get(usize::from(number)).copied()
    }

    /// What the table holds for it.
    #[must_use]
    pub const fn data(self) -> &'static BitData {
        &BITS[self as usize]
    }

    /// The bit on a grid whose voxels measure `voxel` micrometres.
    #[must_use]
    pub fn on_grid(self, voxel: f32) -> GridBit {
        let fixed = |length: i32| libm::roundf(length as f32 * SUB as f32 / voxel) as i32;
        let data = self.data();
        let shape = match data.shape {
            Shape::Ball { radius } => GridShape::Ball(fixed(radius)),
            Shape::Box { half } => GridShape::Box(IVec3::from_array(half.map(fixed))),
        };
        GridBit { shape, bite: fixed(data.bite) }
    }
}

impl GridBit {
    /// The shell depth that goes with the bite, in voxels: its ceiling.
    #[must_use]
    pub fn depth(&self) -> usize {
        (self.bite + SUB - 1).div_euclid(SUB).max(0) as usize
    }

    /// Radius of the largest ball inside the shape.
    #[must_use]
    pub fn inner_radius(&self) -> i32 {
        match self.shape {
            GridShape::Ball(radius) => radius,
            GridShape::Box(half) => half.min_element(),
        }
    }

    /// Radius of the smallest ball about its centre that holds the shape.
    #[must_use]
    pub fn outer_radius(&self) -> i32 {
        match self.shape {
            GridShape::Ball(radius) => radius,
            GridShape::Box(half) => libm::ceilf(half.as_vec3().length()) as i32,
        }
    }
}

const fn ball(name: &'static str, radius: i32, bite: i32, train: &'static [u8]) -> BitData {
    let shape = Shape::Ball { radius };
    BitData { name, tool: Tool::Rotary, action: Action::Carve, shape, bite, period: 1, train }
}

const fn block(name: &'static str, tool: Tool, half: [i32; 3], bite: i32) -> BitData {
    let shape = Shape::Box { half };
    BitData { name, tool, action: Action::Carve, shape, bite, period: 1, train: &[200, 160] }
}

static BITS: [BitData; 9] = [
    ball("small ball burr", 9_000, 2_500, &[180, 120]),
    ball("medium ball burr", 15_000, 3_000, &[200, 140]),
    ball("large ball burr", 24_000, 3_400, &[220, 220, 150]),
    block("cylinder cutter", Tool::Rotary, [9_000, 9_000, 22_000], 2_500),
    BitData {
        train: &[150, 170, 190, 170],
        ..block("flat grinder", Tool::Rotary, [26_000, 26_000, 7_000], 1_500)
    },
    BitData {
        period: 6,
        train: &[255, 120, 40, 0, 0, 0],
        ..block("point chisel", Tool::Impact, [7_000, 7_000, 20_000], 3_400)
    },
    BitData {
        period: 8,
        train: &[255, 140, 60, 20, 0, 0, 0, 0],
        ..block("flat chisel", Tool::Impact, [18_000, 7_000, 14_000], 3_000)
    },
    BitData {
        tool: Tool::FillGun,
        action: Action::Fill,
        ..ball("paste nozzle", 12_000, 3_000, &[60])
    },
    BitData {
        action: Action::Smooth,
        train: &[90, 30, 90, 60],
        ..block("rasp file", Tool::Rasp, [10_000, 7_000, 24_000], 1_200)
    },
];
