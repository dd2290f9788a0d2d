//! Every capacity of the scene, with its reason.

/// The most chips and motes at a time. Two running tools throw at most 20 a tick, which live for about a
/// second and a half; the oldest are replaced. 8 triangles each.
pub const PARTICLES: usize = 1024;

/// The most particles that one edit throws.
pub const EDIT_PARTICLES: u32 = 10;

/// The most motes that stand for a removed island: a quarter of the ring, so that the tools' particles
/// aren't swept away.
pub const ISLAND_MOTES: usize = 256;

/// The most boxes that mark voxels restored by closure: one for each hand's last edit, or two if the edit
/// was mirrored.
pub const REFUSAL_MARKS: usize = 4;

/// The most stones that fall at a time; a new one replaces an older one. A saw frees one at a time, and
/// each falls for a second.
pub const FALLING_STONES: usize = 3;

/// The most cells drawn of a falling stone: the outer ones of a block of 80 mm, whose cells are 14 mm wide.
pub const FALLING_STONE_CELLS: usize = 200;

/// Dots along the rim of a hand's next bite: at the largest bit a bit's breadth apart.
pub const BITE_DOTS: u32 = 40;

/// Guides for the hands: for each hand its dots, its hidden bit and its reflected bit; and the mirror's
/// four edges.
pub const GUIDES: usize = 2 * (BITE_DOTS as usize + 2) + 4;

/// The most instances drawn: the particles; room, garden, bench, stool and its top; two hands and the
/// bench's things; the twelve edges of each mark; falling stones and guides.
pub const INSTANCES: usize = PARTICLES
    + 5
    + 2
    + paros_core::internals::BENCH_ITEMS
    + 2
    + 12 * REFUSAL_MARKS
    + FALLING_STONES * FALLING_STONE_CELLS
    + GUIDES;

/// The most intervals of a column in a texel of the map textures: two bytes each, and formats that every
/// device can sample have one, two or four bytes.
pub const MAP_INTERVALS: usize = 2;

/// Samples along each axis of the grid that record the place of a removed island. One bit each: 4 KiB.
pub const LATTICE: usize = 32;

/// Quads of a frame's panels: a screen of a visit has 145 at the most, and three stand at a time, with the clock and the
/// staff's; room for twice that. 92 bytes each.
pub const PANEL_QUADS: usize = 1024;

/// Texels along a side of a picture on a panel: the pixels that a headset of 20 pixels a degree has for a
/// card, 196 mm wide and 1.2 m away.
pub const PANEL_CELL_TEXELS: usize = 192;

/// The most pictures on panels: one for each card of the widest choice without scrolling, two rows of four.
/// 147 KiB each on the device; a frame uploads at most one.
pub const PANEL_CELLS: usize = 8;
