//! Every capacity of the core, with its reason. `grid_side` is the number of voxels along a side of
//! the grid, N.

mod badge;

pub use badge::{BADGE_CANDIDATES, BLOCK_NUMBERS};

/// Intervals of a column in the shells, K. One is the paper's volume and holds every shape that is seen
/// whole along the three axes (section 3.2); carving refuses what it can't hold, half of a restless
/// visitor's cuts. With two, it refuses a quarter of a percent of them.
pub const INTERVALS: usize = 2;

/// Intervals of a column at most, as a file may say them: more than four are neither built nor tested.
pub const MAX_INTERVALS: usize = 4;

/// Convex pieces of a brush's swept volume. A swept box takes one piece for each voxel of arc that its
/// corner describes, and one more: 68 for half a turn of the largest box (radius 21.3 voxels, at 256; no box
/// grows beyond it), 96 for a radius of 30 voxels. A disc of 40, which is two voxels thick, leaves no gaps with 96.
pub const SWEEP_PIECES: usize = 96;

/// Poses of a hand's way that its running bit may have yet to follow: the most of [`max_trail_ticks`].
pub const MAX_TRAIL_POSES: usize = 12;

/// The longest string on which a steadied hand draws its bit, in millimetres: a longer one would round off corners
/// as large as a figure's head.
pub const MAX_STRING_MM: u8 = 40;

/// How many ticks a running bit may be behind its hand before the oldest way is dropped: a twelfth of a second,
/// which a hand hardly notices, or two thirds as long again as between the slowest blows.
#[must_use]
pub const fn max_trail_ticks(bite_period: u8) -> usize {
    if bite_period > 1 { MAX_TRAIL_POSES } else { 6 }
}

/// Edits of a bit in a tick. At 1 m/s the small ball at 128, whose bite is the shortest of the rotary bits', needs
/// six a tick; the tick's work allows large bits fewer.
pub const MAX_BITES_PER_TICK: u32 = 8;

/// The greatest depth that an edit may reach below the surface in a tick, in six-neighbour steps. A
/// carve delays its writes by so many layers of rows, to read the volume as it was at the start.
pub const SHELL_DEPTH: usize = 4;

/// Voxels that smoothing looks at on each side of one, at most: a cube of 15.
pub const MAX_SMOOTHING_RADIUS: usize = 7;

/// How far smoothing looks: 12.3 mm to each side of a voxel's middle, which is 7 voxels at 256 and 3 at 128. What
/// is narrower than that is evened out at once, a bump of twice the width in half a second.
#[must_use]
pub const fn smoothing_radius(grid_side: usize) -> usize {
    scale_from_256(grid_side, MAX_SMOOTHING_RADIUS)
}

/// How far smoothing looks where the file works lightly: half as far, so that it rounds edges off half as much.
#[must_use]
pub const fn light_smoothing_radius(grid_side: usize) -> usize {
    let radius = smoothing_radius(grid_side) / 2;
    if radius == 0 { 1 } else { radius }
}

/// Voxels that flattening looks at on each side of one, at most.
pub const MAX_FLATTENING_REACH: usize = 14;

/// How far a float looks to either side for the walls of a pit: 24.6 mm, which is 14 voxels at 256 and 7 at 128. That
/// is half its length: it fills what it bridges.
#[must_use]
pub const fn flattening_reach(grid_side: usize) -> usize {
    scale_from_256(grid_side, MAX_FLATTENING_REACH)
}

/// What is so many voxels at 256, in a coarser grid: one at least.
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

/// How far inside a file's brush the dither of its smoothing begins, in voxels.
pub const DITHER_RIM_VOXELS: i32 = 1;

/// Ticks from one edit of a file to the next. The hands take turns: two edits in one tick would be more than its work.
pub const SMOOTHING_PERIOD: u64 = 2;

/// The same of a file that works lightly: in half a second an edge loses no more than a fillet of 15 mm would.
pub const LIGHT_SMOOTHING_PERIOD: u64 = 12;

/// A file works lightly until its trigger was pulled this far, of 255: about four fifths of its way. Whoever doesn't
/// think of it pulls it wholly.
pub const FULL_TRIGGER: u8 = 200;

/// Edits without dither that a file still makes once its trigger is released, so that it leaves no grain; one where it
/// works lightly.
#[must_use]
pub const fn finishing_edits(is_light: bool) -> usize {
    if is_light { 1 } else { 2 }
}

/// Rows that a smoothing edit may touch, in multiples of N: 1,280 rows at 128 (35 x 35), 2,560 at 256 (50 x 50). No
/// more does a file touch in place, however it is turned; swept, one that is turned most is smoothed in place. With
/// more, `World<128, 1>` would not fit in 1 MiB.
pub const SMOOTH_LINES: usize = 10;

/// Dirty rectangles of a range map in a tick. Two hands with mirrored edits and an island make five;
/// beyond eight, rectangles are merged.
pub const MAX_DIRTY_RECTS: usize = 8;

/// Planes of N x N columns that hold the packed undo entries: 128 KiB at 128 with one interval a column,
/// and as much for each more. Two entries that
/// changed every column fit, the newest being stored unpacked beside them, or some fifty usual ones.
pub const UNDO_PLANES: usize = 4;

/// Closed strokes that can be undone.
pub const UNDO_ENTRIES: usize = 128;

/// Upper bound of a saved world's length in bytes: the range maps of volume and mask, an undo history
/// whose packed entries are full and whose newest entry changed every column, an island search that
/// reached every row, and 2 KiB for everything of fixed length. 685 KiB at 128 with one interval a
/// column, 3.7 MiB at 256; a third of it is usual.
#[must_use]
pub const fn max_save_bytes(grid_side: usize, intervals: usize) -> usize {
    let row = grid_side.div_ceil(64) * 8;
    let maps = 3 * grid_side * grid_side * 2 * intervals;
    let entries = UNDO_PLANES * grid_side * grid_side * 2 * intervals + UNDO_ENTRIES * 4;
    let newest = maps + 3 * grid_side * row + 3 * grid_side * row / 64;
    let islands = grid_side * (grid_side + 2) * row;
    2 * maps + entries + newest + islands + 2048
}

/// Bytes of the world's small state, which is all but volume, mask, undo and islands: tick and session
/// (15), the head (28), two hands of 469, seventeen bench items of 31, thirteen sizes of bits, the visit
/// (58), and the mask's digest (8).
pub const STATE_BYTES: usize = 1587;

/// Crossings of a column's ray with a mesh with which a bake gives the column gaps: 16 solids one behind the
/// other, and a cache line a column. Between more, gaps are 4 voxels long in the mean at 128, and a column
/// keeps one or two.
pub const BAKED_CROSSINGS: usize = 32;

/// Events of a tick. A start, two hands that each grab, edit, split and release, undo, redo, mirror, swapped hands,
/// finish, islands, a tenth of the figure and its find make seventeen; the visit's phase, its time left, two tools put
/// back and its start five more.
pub const MAX_EVENTS: usize = 22;

/// The work of a tick that the world hands out: to undo or redo, to the hands and to the island search, in
/// row visits of the island search. Some 150 instructions each at 128, half as many again at 256, keep a
/// tick within 4 and 10 million.
#[must_use]
pub const fn tick_work(grid_side: usize) -> u32 {
    max_island_row_visits_per_tick(grid_side) + if grid_side > 128 { 16_000 } else { 6_000 }
}

/// The work of counting the ends of a hidden figure's columns along one axis: 270,000 instructions at 128, 1.1 million
/// at 256.
#[must_use]
pub const fn bared_count_work(grid_side: usize) -> u32 {
    (grid_side * grid_side / 8) as u32
}

/// The columns of an undo entry above which its undo or redo takes a tick's whole work, and the islands'
/// share with it: a third of all, which a stroke of usual length is far from. All columns take up to 2.6 million
/// instructions at 128. At 256 they take 8.2 million with one interval, 9.4 million with two, and 11.8 million
/// where every column has a gap, more than a tick should.
#[must_use]
pub(crate) const fn dear_rewind_columns(grid_side: usize) -> u32 {
    (grid_side * grid_side) as u32
}

/// The work of an undo or redo of fewer columns, which swaps them and rebuilds the volume's bit rows. That
/// takes 1.3 and 5.7 million instructions with one interval a column. With two it takes up to 2 million at
/// 128, and 6 million at 256, or 9.5 million where every column has a gap.
#[must_use]
pub const fn rewind_work(grid_side: usize, intervals: usize) -> u32 {
    let work = if grid_side > 128 { 25_000 } else { 8_000 };
    if intervals > 1 { work + work / 4 } else { work }
}

/// The part of a tick's work that is always the island search's: a pass that needs one tick's visits ends
/// within five ticks, whatever hands do.
#[must_use]
pub const fn island_reserve(grid_side: usize) -> u32 {
    max_island_row_visits_per_tick(grid_side) / 4
}

/// Side of a bit's bounding cube in voxels, however it is turned, by the radius of its bounding ball.
#[must_use]
pub const fn bit_side_voxels(circumscribed_radius_subunits: i32) -> u32 {
    (2 * circumscribed_radius_subunits as u32).div_ceil(256) + 1
}

/// The work of a step of a bit, which tests the rows of its bounding cube.
#[must_use]
pub const fn bit_step_work(side_voxels: u32) -> u32 {
    1 + side_voxels * side_voxels / 8
}

/// The work of an edit in place, of the columns that it touches, and of the look for where its bit goes on: what
/// hands that cut as fast as they may were measured to take.
#[must_use]
pub const fn bite_work(side_voxels: u32) -> u32 {
    6 * side_voxels * side_voxels
}

/// The work of splitting a flake off, half a ball: a whole one was measured to take 0.7 million instructions at 128 and
/// 3 million at 256, where a unit of work is half as much again.
#[must_use]
pub const fn flake_work(side_voxels: u32) -> u32 {
    6 * side_voxels * side_voxels
}

/// The work of spalling, whose edit reaches deeper than a bite.
#[must_use]
pub const fn spall_work(side_voxels: u32) -> u32 {
    10 * side_voxels * side_voxels
}

/// What a quarter voxel of way adds to the work of a ball's edit: rows at its front.
#[must_use]
pub const fn ball_sweep_work_per_quarter_voxel(side_voxels: u32) -> u32 {
    side_voxels
}

/// The same for a box, which takes another piece for each voxel of arc.
#[must_use]
pub const fn box_sweep_work_per_quarter_voxel(side_voxels: u32) -> u32 {
    side_voxels + side_voxels * side_voxels / 8
}

/// The work of a step of a disc, or of one piece of a stretch that is tried at once: a glance at the rows of its
/// bounding cube, of which one costs a fifth of a unit of work at 128, and a seventh at 256.
#[must_use]
pub const fn disc_step_work(grid_side: usize, side_voxels: u32) -> u32 {
    1 + side_voxels * side_voxels / if grid_side > 128 { 7 } else { 5 }
}

/// The work of a disc's edit in place, which is two pieces where it turns, and of the look for where it goes on: most
/// where it stands across x, and lies in every row of its bounding cube. At 256, where a unit of work is half as much
/// again, a hand cuts whose other hand has a tool too.
#[must_use]
pub const fn disc_bite_work(grid_side: usize, side_voxels: u32) -> u32 {
    side_voxels * side_voxels * if grid_side > 128 { 3 } else { 5 } / 2
}

/// The work of finding the contact of a bit that touches stone, and of the direction in which it slides.
#[must_use]
pub const fn contact_work(side_voxels: u32) -> u32 {
    side_voxels * side_voxels
}

/// The same of a disc, which may lie in every row of its bounding cube.
#[must_use]
pub const fn disc_contact_work(side_voxels: u32) -> u32 {
    2 * side_voxels * side_voxels
}

/// What a step of way adds to the work of a disc's edit: rows at its front, and a quarter of a piece where it turns.
#[must_use]
pub const fn disc_sweep_work_per_step(side_voxels: u32) -> u32 {
    side_voxels + side_voxels * side_voxels / 16
}

/// The work of a smoothing edit in place: sums for each row of its brush's bounding cube and of what the filter
/// reaches beyond it, mostly in one word of a row. Some 900 instructions for each row of the cube at 128 and 1,200 at
/// 256, where a unit of work is half as much again.
#[must_use]
pub const fn smoothing_work(grid_side: usize, side_voxels: u32) -> u32 {
    side_voxels * side_voxels * if grid_side > 128 { 5 } else { 6 }
}

/// What a quarter voxel of way adds to a smoothing edit's work: rows at the front, and a quarter of a piece of the
/// brush.
#[must_use]
pub const fn smoothing_sweep_work_per_quarter_voxel(side_voxels: u32) -> u32 {
    side_voxels + side_voxels * side_voxels / 16
}

/// The work of finding the contact of a bit that may be in the stone as a whole, as a file that runs, by the side of
/// its bounding cube: each of its voxels counts.
#[must_use]
pub const fn buried_contact_work(side_voxels: u32) -> u32 {
    4 * side_voxels * side_voxels
}

/// The island search's budget for a tick, in row visits: 10,240 at 128, where the test meshes need
/// some 8,000 and the cost of a removal, and 16,384 at 256. A visit takes 100 to 170 instructions in a
/// solid at 128, and 300 in a comb of sheets; half as many again at 256.
#[must_use]
pub const fn max_island_row_visits_per_tick(grid_side: usize) -> u32 {
    (if grid_side > 128 { grid_side * grid_side / 4 } else { grid_side * grid_side * 5 / 8 }) as u32
}

/// Upper bound of a bit's steps in a tick, each of a quarter voxel, forward or sliding: 5.6 cm in contact
/// with the stone, or 4 m/s, which is faster than hands at work. A stretch of several steps that is tried at
/// once counts as one step, free or not, so a bit in the air covers a metre. After a jump the bit catches up within some ticks.
#[must_use]
pub const fn max_bit_steps_per_tick(grid_side: usize) -> u32 {
    if grid_side > 128 { 160 } else { 80 }
}

/// The cost of a step, in steps, while the bit is deeper than its penetration limit, as an undo may
/// leave it. Such a step measures the depth of every voxel inside the bit, in rows of several words at 256.
#[must_use]
pub const fn deep_step_cost_in_steps(grid_side: usize) -> u32 {
    if grid_side > 128 { 12 } else { 8 }
}

/// Slides of a bit that was stopped, after the one along the surface: a corner of three planes stops it, and one more
/// leads out of it.
pub const MAX_SLIDES: usize = 4;

/// The cost of a slide beside its way, in steps: its bit is measured, and where it was stopped the voxels that did. Small
/// bits slide most often, and at 256, where their steps are cheap beside it, it is worth more of them. A disc's are dear
/// there: it pays for its way alone, or would fall so far behind its hand that its cuts don't meet.
#[must_use]
pub const fn slide_cost_in_steps(grid_side: usize, is_disc: bool) -> u32 {
    match (grid_side > 128, is_disc) {
        (false, _) => 10,
        (true, false) => 24,
        (true, true) => 0,
    }
}

/// Exit probes: places on the rest of its path at which a bit beyond its penetration limit is tested,
/// each time it is stopped, for a way out. Every step of a path of up to 8 voxels; farther apart on a
/// longer one. Each costs a step, and with fewer steps left they are as few.
pub const EXIT_PROBES: u32 = 32;

/// The cost of removing the islands found, in row visits. With less budget left, the next tick removes
/// them.
#[must_use]
pub const fn island_removal_row_visits(grid_side: usize) -> u32 {
    (grid_side * grid_side / 8) as u32
}
