//! Every capacity of the core, with its reason. `grid_side` is the number of voxels along a side of
//! the grid, N.

mod badge;

pub use badge::{BADGE_CANDIDATES, BLOCK_NUMBERS};

/// Intervals of a column in the shells, K. One interval is the paper's volume, which holds every shape that
/// is seen completely along the three axes (section 3.2). Carving keeps the voxels that it can't represent:
/// 69 % of a restless visitor's cuts with one interval, 11 % with two (`core/README.md`).
pub const INTERVALS: usize = 2;

/// Maximum number of intervals of a column in a file: larger numbers are neither built nor tested.
pub const MAX_INTERVALS: usize = 4;

/// Convex pieces of a brush's swept volume. A swept box takes one piece for each voxel of arc that its corner
/// describes, plus one: 68 for half a turn of the largest box (radius 21.3 voxels at 256, the maximum), 96
/// for a radius of 30 voxels. A disc of radius 40, which is two voxels thick, leaves no gaps with 96.
pub const SWEEP_PIECES: usize = 96;

/// Capacity of a hand's trail: the poses that its running bit has yet to follow, the maximum of
/// [`max_trail_ticks`].
pub const MAX_TRAIL_POSES: usize = 12;

/// Maximum length of a steadied hand's string, on which the hand pulls its bit, in millimetres. A longer
/// string would round off corners as large as a figure's head.
pub const MAX_STRING_MM: u8 = 40;

/// Returns how many ticks a running bit may lag behind its hand before the oldest poses of the trail are
/// dropped: a twelfth of a second, which a user hardly notices, or for striking tools 12 ticks, one and a
/// half times the longest period between two blows.
#[must_use]
pub const fn max_trail_ticks(bite_period: u8) -> usize {
    if bite_period > 1 { MAX_TRAIL_POSES } else { 6 }
}

/// Maximum edits of a bit in a tick. At 1 m/s the small ball at 128, which has the shortest bite of the
/// rotary bits, needs six a tick; the work budget of a tick allows large bits fewer.
pub const MAX_BITES_PER_TICK: u32 = 8;

/// The greatest depth below the surface that an edit may reach in a tick, in six-neighbour steps. A carve
/// delays its writes by this number of layers of rows, to read the volume as it was at the start.
pub const SHELL_DEPTH: usize = 4;

/// Maximum radius of the smoothing filter, in voxels on each side of the middle voxel: a cube of 15.
pub const MAX_SMOOTHING_RADIUS: usize = 7;

/// Returns the radius of the smoothing filter: 12.3 mm to each side of a voxel's middle, which is 7 voxels at
/// 256 and 3 at 128. Narrower features are smoothed out at once, a bump of twice the width in half a second.
#[must_use]
pub const fn smoothing_radius(grid_side: usize) -> usize {
    scale_from_256(grid_side, MAX_SMOOTHING_RADIUS)
}

/// Returns the radius of the smoothing filter while the file works lightly: half, so that it rounds edges
/// half as much.
#[must_use]
pub const fn light_smoothing_radius(grid_side: usize) -> usize {
    let radius = smoothing_radius(grid_side) / 2;
    if radius == 0 { 1 } else { radius }
}

/// Maximum distance that flattening searches on each side of a voxel.
pub const MAX_FLATTENING_REACH: usize = 14;

/// Returns the distance that a float searches to either side for the walls of a pit: 24.6 mm, which is 14
/// voxels at 256 and 7 at 128. This is half the float's length: it fills the pits that it bridges.
#[must_use]
pub const fn flattening_reach(grid_side: usize) -> usize {
    scale_from_256(grid_side, MAX_FLATTENING_REACH)
}

/// Scales a number of voxels at 256 to a coarser grid. The result is at least one.
const fn scale_from_256(grid_side: usize, at_256: usize) -> usize {
    let scaled = grid_side * at_256 / 256;
    if scaled == 0 {
        1
    } else if scaled < at_256 {
        scaled
    } else {
        at_256
    }
}

/// Width of the rim inside a file's brush that isn't dithered, in voxels.
pub const DITHER_RIM_VOXELS: i32 = 1;

/// Ticks from one edit of a file to the next. The hands take turns: two edits in one tick would exceed its
/// work budget.
pub const SMOOTHING_PERIOD: u64 = 2;

/// Ticks from one edit to the next of a file that works lightly: in half a second an edge loses no more than
/// a fillet of 15 mm would.
pub const LIGHT_SMOOTHING_PERIOD: u64 = 12;

/// Trigger value, of 255, from which a file works at full strength instead of lightly: about four fifths of
/// its travel. A user who doesn't think of it pulls the trigger completely.
pub const FULL_TRIGGER: u8 = 200;

/// Returns the number of edits without dither that a file makes after its trigger is released, so that it
/// leaves no grain: one if it works lightly, two otherwise.
#[must_use]
pub const fn finishing_edits(is_light: bool) -> usize {
    if is_light { 1 } else { 2 }
}

/// Capacity of a smoothing edit in rows, in multiples of N: 1,280 rows at 128 (35 x 35), 2,560 at 256 (50 x
/// 50). An edit in place never needs more, in any orientation. A swept edit that needs more, at extreme
/// orientations, is made in place. With a larger capacity, `World<128, 1>` would not fit in 1 MiB.
pub const SMOOTH_LINES: usize = 10;

/// Dirty rectangles of a range map in a tick. Two hands with mirrored edits and an island make five;
/// beyond eight, rectangles are merged.
pub const MAX_DIRTY_RECTS: usize = 8;

/// Planes of N x N columns that hold the packed undo entries: 128 KiB at 128 for each interval of a column.
/// Two entries that changed every column fit, as the newest entry is stored unpacked beside them, or some
/// fifty usual ones.
pub const UNDO_PLANES: usize = 4;

/// Maximum number of closed strokes that can be undone.
pub const UNDO_ENTRIES: usize = 128;

/// Returns the upper bound of a saved world's length in bytes: the range maps of volume and mask, an undo
/// history whose packed entries are full and whose newest entry changed every column, an island search that
/// reached every row, and 2 KiB for everything of fixed length. 685 KiB at 128 with one interval a column,
/// 3.7 MiB at 256; a typical save takes a third.
#[must_use]
pub const fn max_save_bytes(grid_side: usize, intervals: usize) -> usize {
    let row = grid_side.div_ceil(64) * 8;
    let maps = 3 * grid_side * grid_side * 2 * intervals;
    let entries = UNDO_PLANES * grid_side * grid_side * 2 * intervals + UNDO_ENTRIES * 4;
    let newest = maps + 3 * grid_side * row + 3 * grid_side * row / 64;
    let islands = grid_side * (grid_side + 2) * row;
    2 * maps + entries + newest + islands + 2048
}

/// Bytes of the world's small state, which is everything except volume, mask, undo and islands: tick and
/// session (15), the head (28), two hands of 469, seventeen bench items of 31, thirteen sizes of bits, the
/// visit (58), and the mask's digest (8).
pub const STATE_BYTES: usize = 1587;

/// Maximum crossings of a column's ray with a mesh for which a bake gives the column gaps: 16 solids one
/// behind the other, and a cache line a column. With more crossings, gaps are on average 4 voxels long at
/// 128, and a column keeps only one or two of them.
pub const BAKED_CROSSINGS: usize = 32;

/// Maximum events of a tick. A start, two hands that each grab, edit, split and release, undo, redo, mirror,
/// swapped hands, finish, islands, a tenth of the figure and its find make seventeen; the visit's phase, its
/// remaining time, two tools put back and its start make five more.
pub const MAX_EVENTS: usize = 22;

/// Returns the work budget of a tick, which the world divides between undo or redo, the hands and the island
/// search. The unit is a row visit of the island search: some 150 instructions at 128, and half as many again
/// at 256, keep a tick within 4 and 10 million.
#[must_use]
pub const fn tick_work(grid_side: usize) -> u32 {
    max_island_row_visits_per_tick(grid_side) + if grid_side > 128 { 16_000 } else { 6_000 }
}

/// Returns the work of counting the ends of a hidden figure's columns along one axis: 270,000 instructions at
/// 128, 1.1 million at 256.
#[must_use]
pub const fn bared_count_work(grid_side: usize) -> u32 {
    (grid_side * grid_side / 8) as u32
}

/// Returns the number of columns of an undo entry above which its undo or redo takes a tick's whole work
/// budget, with the islands' reserve. It is a third of all columns; a stroke of usual length changes far
/// fewer. Undoing all columns takes up to 2.6 million instructions at 128. At 256 it takes 8.2 million with
/// one interval, 9.4 million with two, and 11.8 million if every column has a gap, more than a tick should.
#[must_use]
pub(crate) const fn dear_rewind_columns(grid_side: usize) -> u32 {
    (grid_side * grid_side) as u32
}

/// Returns the work of an undo or redo of fewer columns, which swaps the columns and rebuilds the volume's
/// bit rows. It takes 1.3 and 5.7 million instructions with one interval a column. With two it takes up to 2
/// million at 128, and 6 million at 256, or 9.5 million if every column has a gap.
#[must_use]
pub const fn rewind_work(grid_side: usize, intervals: usize) -> u32 {
    let work = if grid_side > 128 { 25_000 } else { 8_000 };
    if intervals > 1 { work + work / 4 } else { work }
}

/// Returns the part of a tick's work that is reserved for the island search: a pass that needs one tick's
/// visits ends within five ticks, whatever the hands do.
#[must_use]
pub const fn island_reserve(grid_side: usize) -> u32 {
    max_island_row_visits_per_tick(grid_side) / 4
}

/// Returns the side of a bit's bounding cube in voxels, in any orientation, from the radius of its bounding
/// ball.
#[must_use]
pub const fn bit_side_voxels(circumscribed_radius_subunits: i32) -> u32 {
    (2 * circumscribed_radius_subunits as u32).div_ceil(256) + 1
}

/// Returns the work of a step of a bit, which tests the rows of its bounding cube.
#[must_use]
pub const fn bit_step_work(side_voxels: u32) -> u32 {
    1 + side_voxels * side_voxels / 8
}

/// Returns the work of an edit in place, including the columns that it touches and the search for the bit's
/// next position. Measured with hands that cut as fast as they can.
#[must_use]
pub const fn bite_work(side_voxels: u32) -> u32 {
    6 * side_voxels * side_voxels
}

/// Returns the work of splitting off a flake, which is half a ball: a whole ball was measured at 0.7 million
/// instructions at 128 and 3 million at 256, where a unit of work is half as much again.
#[must_use]
pub const fn flake_work(side_voxels: u32) -> u32 {
    6 * side_voxels * side_voxels
}

/// Returns the work of spalling, whose edit reaches deeper than a bite.
#[must_use]
pub const fn spall_work(side_voxels: u32) -> u32 {
    10 * side_voxels * side_voxels
}

/// Returns the work that each quarter voxel of travel adds to a ball's edit: rows at its front.
#[must_use]
pub const fn ball_sweep_work_per_quarter_voxel(side_voxels: u32) -> u32 {
    side_voxels
}

/// Returns the work that each quarter voxel of travel adds to a box's edit: another piece for each voxel of
/// arc.
#[must_use]
pub const fn box_sweep_work_per_quarter_voxel(side_voxels: u32) -> u32 {
    side_voxels + side_voxels * side_voxels / 8
}

/// Returns the work of a step of a disc, or of one piece of a stretch that is tried at once: a test of the
/// rows of its bounding cube. A row costs a fifth of a unit of work at 128, and a seventh at 256.
#[must_use]
pub const fn disc_step_work(grid_side: usize, side_voxels: u32) -> u32 {
    1 + side_voxels * side_voxels / if grid_side > 128 { 7 } else { 5 }
}

/// Returns the work of a disc's edit in place, which has two pieces if the disc turns, and of the search for
/// its next position. It is highest if the disc stands across x and lies in every row of its bounding cube.
/// At 256, where a unit of work is half as much again, this leaves enough for a hand to cut while the other
/// holds a tool too.
#[must_use]
pub const fn disc_bite_work(grid_side: usize, side_voxels: u32) -> u32 {
    side_voxels * side_voxels * if grid_side > 128 { 3 } else { 5 } / 2
}

/// Returns the work of finding the contact of a bit that touches stone, and the direction in which it slides.
#[must_use]
pub const fn contact_work(side_voxels: u32) -> u32 {
    side_voxels * side_voxels
}

/// Returns the work of finding the contact of a disc, which may lie in every row of its bounding cube.
#[must_use]
pub const fn disc_contact_work(side_voxels: u32) -> u32 {
    2 * side_voxels * side_voxels
}

/// Returns the work that each step adds to a disc's edit: rows at its front, and a quarter of a piece if it
/// turns.
#[must_use]
pub const fn disc_sweep_work_per_step(side_voxels: u32) -> u32 {
    side_voxels + side_voxels * side_voxels / 16
}

/// Returns the work of a smoothing edit in place: sums for each row of its brush's bounding cube and of the
/// filter's reach beyond it, mostly in one word of a row. Some 900 instructions for each row of the cube at
/// 128 and 1,200 at 256, where a unit of work is half as much again.
#[must_use]
pub const fn smoothing_work(grid_side: usize, side_voxels: u32) -> u32 {
    side_voxels * side_voxels * if grid_side > 128 { 5 } else { 6 }
}

/// Returns the work that each quarter voxel of travel adds to a smoothing edit: rows at the front, and a
/// quarter of a piece of the brush.
#[must_use]
pub const fn smoothing_sweep_work_per_quarter_voxel(side_voxels: u32) -> u32 {
    side_voxels + side_voxels * side_voxels / 16
}

/// Returns the work of finding the contact of a bit that may be completely inside the stone, such as a
/// running file, by the side of its bounding cube: each of its voxels counts.
#[must_use]
pub const fn buried_contact_work(side_voxels: u32) -> u32 {
    4 * side_voxels * side_voxels
}

/// Returns the island search's budget for a tick, in row visits: 10,240 at 128, where the test meshes need
/// some 8,000 and the cost of a removal, and 16,384 at 256. A visit takes 100 to 170 instructions in a solid
/// at 128, and 300 in a comb of sheets; half as many again at 256.
#[must_use]
pub const fn max_island_row_visits_per_tick(grid_side: usize) -> u32 {
    (if grid_side > 128 { grid_side * grid_side / 4 } else { grid_side * grid_side * 5 / 8 }) as u32
}

/// Returns the maximum steps of a bit in a tick, each of a quarter voxel, forward or sliding: 5.6 cm in
/// contact with the stone, or 4 m/s, which is faster than hands at work. A stretch of several steps that is
/// tried at once counts as one step, free or not, so a bit in the air covers a metre. After a jump the bit
/// catches up within a few ticks.
#[must_use]
pub const fn max_bit_steps_per_tick(grid_side: usize) -> u32 {
    if grid_side > 128 { 160 } else { 80 }
}

/// Returns the cost of a step, in steps, while the bit is deeper than its penetration limit, which an undo
/// may cause. Such a step measures the depth of every voxel inside the bit, in rows of several words at 256.
#[must_use]
pub const fn deep_step_cost_in_steps(grid_side: usize) -> u32 {
    if grid_side > 128 { 12 } else { 8 }
}

/// Maximum slides of a stopped bit, after the one along the surface: a corner of three planes stops it, and
/// one more slide leads out.
pub const MAX_SLIDES: usize = 4;

/// Returns the cost of a slide in addition to its travel, in steps: measuring the bit, and the voxels that
/// stopped it. Small bits slide most often. At 256, where their steps are cheap, the cost is higher. A disc's
/// slides are expensive there: it pays for its travel only, or it would lag so far behind its hand that its
/// cuts don't meet.
#[must_use]
pub const fn slide_cost_in_steps(grid_side: usize, is_disc: bool) -> u32 {
    match (grid_side > 128, is_disc) {
        (false, _) => 10,
        (true, false) => 24,
        (true, true) => 0,
    }
}

/// Exit probes: positions on the rest of its path at which a stopped bit beyond its penetration limit is
/// tested for a way out. On a path of up to 8 voxels every step is probed; on a longer path the probes are
/// farther apart. Each probe costs a step, so fewer remaining steps mean fewer probes.
pub const EXIT_PROBES: u32 = 32;

/// Returns the cost of removing the islands found, in row visits. If less budget is left, the next tick
/// removes them.
#[must_use]
pub const fn island_removal_row_visits(grid_side: usize) -> u32 {
    (grid_side * grid_side / 8) as u32
}
