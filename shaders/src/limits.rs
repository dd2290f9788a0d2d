//! Every capacity of the scene, with its reason.

/// Chips and motes that fly or lie about at a time. Two running tools throw at most 20 a tick,
/// which live for about a second and a half; older ones make room. 8 triangles each.
pub const PARTICLES: usize = 1024;

/// Particles that one edit throws, at the most.
pub const EDIT_PARTICLES: u32 = 10;

/// Motes that stand for a removed island, at the most: a quarter of the ring, so that what the
/// tools throw is not swept away.
pub const ISLAND_MOTES: usize = 256;

/// Boxes that mark what closure brought back: of each hand's last edit one, or two where it was mirrored.
pub const REFUSAL_MARKS: usize = 4;

/// Stones that fall at a time; an older one makes room. A saw frees one at a time, and they fall for a second.
pub const FALLING_STONES: usize = 3;

/// Cells of a falling stone that are drawn, at the most: the outer ones of a block of 80 mm, whose cells are 14 mm wide.
pub const FALLING_STONE_CELLS: usize = 200;

/// Dots around what a hand's next bite takes: at the largest bit a bit's breadth apart.
pub const BITE_DOTS: u32 = 40;

/// What guides the hands: of each its dots, its hidden bit and its reflected one; and the mirror's four edges.
pub const GUIDES: usize = 2 * (BITE_DOTS as usize + 2) + 4;

/// Instances drawn: the particles; room, garden, bench, stool and its top; two hands and the
/// bench's things; the twelve edges of each mark; falling stones and guides.
pub const INSTANCES: usize = PARTICLES
    + 5
    + 2
    + paros_core::internals::BENCH_ITEMS
    + 2
    + 12 * REFUSAL_MARKS
    + FALLING_STONES * FALLING_STONE_CELLS
    + GUIDES;

/// Intervals of a column that a texel of the map textures holds: two bytes each, and formats that every
/// device samples have one, two or four bytes.
pub const MAP_INTERVALS: usize = 2;

/// Samples along each axis of the grid by which the place of a removed island is told. One bit
/// each: 4 KiB.
pub const LATTICE: usize = 32;

/// Quads of a frame's panels: a screen of a visit has 145 at the most, and three stand at a time, with the clock and the
/// staff's; room for twice that. 92 bytes each.
pub const PANEL_QUADS: usize = 1024;

/// Texels along a side of a picture on a panel: as many as a headset of 20 pixels a degree has of a card's, 196 mm wide
/// and 1.2 m away.
pub const PANEL_CELL_TEXELS: usize = 192;

/// Pictures on panels: a card each of the widest choice without scrolling, two rows of four. 147 KiB each on the device,
/// of which a frame uploads one.
pub const PANEL_CELLS: usize = 8;
