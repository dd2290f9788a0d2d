//! Every capacity of the core, with its reason.

/// Intervals a column holds. One expresses every shape without hidden cavities (section 3.2).
pub const LAYERS: usize = 1;

/// Convex pieces of a brush. A swept box takes one for each voxel that its corner turns, and one more:
/// half a turn of the largest bit's corner (21.3 voxels, at 256) is 68, of one of 30 voxels 96.
pub const SWEEP_PIECES: usize = 96;

/// The deepest shell an edit may reach in a tick, in six-neighbour steps. Four layers of rows are
/// held back while a carve reads the volume as it stood at the start.
pub const SHELL_DEPTH: usize = 4;

/// Lines of N rows that a smoothing edit may touch: 1,024 rows at 128 (32 x 32), 2,048 at 256
/// (45 x 45), above any rasp's reach in a tick.
pub const SMOOTH_LINES: usize = 8;

/// Dirty rectangles of an axis map in a tick. Two hands with mirrored edits and an island make
/// five; beyond eight they merge.
pub const DIRTY_RECTS: usize = 8;

/// Lines of N columns x N that hold packed undo entries (2 bytes a column): 128 KiB at 128. With
/// the newest entry unpacked beside them, two entries that changed every column fit, and some
/// fifty usual ones.
pub const UNDO_PLANES: usize = 4;

/// Closed strokes that can be undone.
pub const UNDO_ENTRIES: usize = 128;

/// Bytes that a saved world of `n` voxels a side takes at the most: the volume's maps and a mask's,
/// an undo ring whose packed entries are full and whose newest changed every column, a search for
/// islands that has reached every row, and 1 KiB for all that is of one length. 684 KiB at 128,
/// 3.7 MiB at 256; usual is a third of it.
#[must_use]
pub const fn save_bytes(n: usize) -> usize {
    let row = n.div_ceil(64) * 8;
    let maps = 3 * n * n * 2;
    let entries = UNDO_PLANES * n * n * 2 + UNDO_ENTRIES * 4;
    let newest = maps + 3 * n * row + 3 * n * row / 64;
    let islands = n * (n + 2) * row;
    2 * maps + entries + newest + islands + 1024
}

/// Events of a tick: a start, two hands that take, edit and let go, undo, redo, mirror, finish and
/// islands make twelve.
pub const EVENTS: usize = 16;

/// Row visits that the search for islands may take in a tick: 10,240 at 128, where the meshes need
/// some 8,000 and what a removal is held to be worth, and 16,384 at 256. A visit takes 100 to 170
/// instructions in a solid at 128, 300 in a comb of sheets; half as many again at 256.
#[must_use]
pub const fn row_visits(n: usize) -> u32 {
    (if n > 128 { n * n / 4 } else { n * n * 5 / 8 }) as u32
}

/// Row visits that laying out the mask is held to be worth, as a search begins: a tick's.
#[must_use]
pub const fn mask_visits(n: usize) -> u32 {
    row_visits(n)
}

/// Steps of a quarter voxel that a bit walks at most in a tick, on its way and aside: 7 cm along the
/// stone, or 5 m/s, which is beyond hands at work. A stretch of free steps counts as one, so in the
/// air it is a metre. After a jump the bit catches up in some ticks.
#[must_use]
pub const fn walk_steps(n: usize) -> u32 {
    if n > 128 { 160 } else { 80 }
}

/// The same in a tick of an undo or redo, which lays out the volume anew.
#[must_use]
pub const fn short_walk_steps(n: usize) -> u32 {
    walk_steps(n) / 4
}

/// Steps of both hands in a tick, and pieces of the brushes that they draw, beyond which the islands
/// wait for the next: 20 mm along the stone at 128, or 1.4 m/s, and half as much at 256. Hands at work
/// are slower.
pub const LONG_WAY: u32 = 24;

/// Steps that one of a bit which is too deep, as an undo may leave it, counts as: each measures anew
/// how deep all voxels in the bit are, eight times as many at 256.
#[must_use]
pub const fn deep_steps(n: usize) -> u32 {
    if n > 128 { 8 } else { 4 }
}

/// Places on the rest of its way where a bit that is too deep looks for the way out, each time it is
/// stopped: every step of the next 8 voxels if it goes no farther, and else more thinly.
pub const LOOKS: u32 = 32;

/// Row visits that removing islands is held to be worth. With fewer left the next tick does it.
#[must_use]
pub const fn removal_visits(n: usize) -> u32 {
    (n * n / 8) as u32
}
