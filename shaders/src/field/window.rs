//! The voxels around a box of texels, as bit rows of one word each.

use paros_core::maps::{Axis, Column, Maps, Range};

use super::extent::Extent;
use super::{PAD, REACH};

/// Rows of a window along y and along z, at most.
pub(super) const ROWS: usize = super::blur::MOST[1] + 2 * REACH;
/// Voxels of a row left of the box's first texel; one more than needed, to round the box to.
pub(super) const LEFT: usize = 4;
/// Rows along y and z before the first one that is blurred.
pub(super) const BEFORE: usize = 2;

/// Bit rows along x of the voxels at most [`REACH`] from a box of texels (and [`LEFT`] from it
/// along x). Row (0, 0) is the one of least y and z. Voxels below y = 0 are those of the ground layer.
#[derive(Clone, Debug)]
pub(super) struct Window {
    rows: [[u64; ROWS]; ROWS],
}

/// Where a stretch of voxels starts, in voxels, and how many it has.
#[derive(Clone, Copy)]
struct Stretch {
    start: isize,
    len: usize,
}

impl Stretch {
    /// The place of a voxel, if before the stretch its start, if behind it its end.
    #[inline]
    fn place(&self, voxel: usize) -> usize {
        (voxel as isize - self.start).clamp(0, self.len as isize) as usize
    }

    /// The voxels of the stretch that a grid of `n` has.
    fn voxels(self, n: usize) -> std::ops::Range<usize> {
        let inside = |end: isize| end.clamp(0, n as isize) as usize;
        inside(self.start)..inside(self.start + self.len as isize)
    }

    /// The place of the first of them.
    const fn first_inside(self) -> usize {
        self.start.unsigned_abs() * (self.start < 0) as usize
    }
}

impl Window {
    pub(super) const fn new() -> Self {
        Window { rows: [[0; ROWS]; ROWS] }
    }

    /// A row: places along y and z, from 0.
    #[inline]
    pub(super) fn row(&self, y: usize, z: usize) -> u64 {
        self.rows[z][y]
    }

    /// Looks at the voxels around a box.
    pub(super) fn look<const N: usize>(&mut self, maps: &Maps<N>, extent: Extent) {
        let around = |axis: usize, by: usize| Stretch {
            start: extent.lo[axis] as isize - (PAD + by) as isize,
            len: extent.size()[axis] + 2 * by,
        };
        let (x, y, z) = (around(0, LEFT), around(1, REACH), around(2, REACH));
        for rows in &mut self.rows[..z.len] {
            rows[..y.len].fill(0);
        }
        let (of_y, of_z) = (Tests::new(y, N), Tests::new(z, N));
        for (i, voxel) in z.voxels(N).enumerate() {
            self.follow_y(maps, x, (y, &of_y), (z.first_inside() + i, voxel));
        }
        // Rows beside the grid stay empty.
        for at in 0..y.len {
            let voxel = (y.start + at as isize).max(0) as usize;
            if voxel < N {
                self.meet_z_and_x(maps, x, (z, &of_z), (at, voxel));
            }
        }
    }

    /// Sets, in a slice of equal z, the voxels that the Y map's columns hold.
    fn follow_y<const N: usize>(
        &mut self,
        maps: &Maps<N>,
        x: Stretch,
        (y, tests): (Stretch, &Tests),
        (at, voxel): (usize, usize),
    ) {
        let columns = &maps.line(Axis::Y, voxel)[x.voxels(N)];
        let (mut ends, full) = column_ends(columns, x, tests, |range| {
            // A column that stands on the ground goes on below it.
            let first = if range.lo() == 0 { 0 } else { y.place(range.lo()) };
            (first, y.place(range.hi() + 1))
        });
        // What is full goes on below the ground, and not above the grid.
        ends[0] ^= full;
        ends[y.place(N)] ^= full;
        let mut inside = 0;
        for (row, end) in self.rows[at][..y.len].iter_mut().zip(ends) {
            inside ^= end;
            *row = inside;
        }
    }

    /// Keeps, in a layer of equal y, the voxels that the Z and X maps' columns hold too.
    fn meet_z_and_x<const N: usize>(
        &mut self,
        maps: &Maps<N>,
        x: Stretch,
        (z, tests): (Stretch, &Tests),
        (at, voxel): (usize, usize),
    ) {
        let columns = &maps.line(Axis::Z, voxel)[x.voxels(N)];
        let (ends, full) =
            column_ends(columns, x, tests, |range| (z.place(range.lo()), z.place(range.hi() + 1)));
        let mut inside = full;
        for (rows, end) in self.rows[..z.len].iter_mut().zip(ends) {
            inside ^= end;
            rows[at] &= inside;
        }
        let line = maps.line(Axis::X, voxel);
        for (rows, column) in self.rows[z.first_inside()..].iter_mut().zip(&line[z.voxels(N)]) {
            if rows[at] != 0 {
                rows[at] &= span(column.hull(), x);
            }
        }
    }
}

/// The columns of a stretch along x, a bit each: where those that begin or end within the rows do so,
/// as `places` has it, and which hold all of them.
#[inline(always)]
fn column_ends(
    columns: &[Column],
    x: Stretch,
    tests: &Tests,
    places: impl Fn(Range) -> (usize, usize),
) -> ([u64; ROWS + 1], u64) {
    let mut ends = [0u64; ROWS + 1];
    let mut full = 0;
    for (i, columns) in columns.chunks(8).enumerate() {
        let bit = x.first_inside() + 8 * i;
        match tests.common(columns) {
            Common::Empty => {}
            Common::Full => full |= (u64::MAX >> (64 - columns.len())) << bit,
            Common::Mixed => {
                for (bit, column) in (bit..).zip(columns) {
                    let range = column.hull();
                    if !range.is_empty() {
                        let (first, end) = places(range);
                        ends[first] ^= 1 << bit;
                        ends[end] ^= 1 << bit;
                    }
                }
            }
        }
    }
    (ends, full)
}

/// What eight columns hold of a stretch.
enum Common {
    Empty,
    /// All that the grid has.
    Full,
    Mixed,
}

/// Bounds of eight columns' ends, as a range stores them, to tell what they hold of a stretch.
struct Tests {
    /// At least these: all of it.
    full: [u8; 16],
    /// At most these: nothing, as they lie behind, or before.
    behind: [u8; 16],
    before: [u8; 16],
}

impl Tests {
    fn new(stretch: Stretch, n: usize) -> Self {
        let voxels = stretch.voxels(n);
        let pairs = |[not_lo, hi]: [u8; 2]| {
            [
                not_lo, hi, not_lo, hi, not_lo, hi, not_lo, hi, not_lo, hi, not_lo, hi, not_lo, hi,
                not_lo, hi,
            ]
        };
        // Where there is nothing before or behind, only empty columns pass.
        let empty = Range::EMPTY.to_bytes();
        let behind = if voxels.end < 256 { [!(voxels.end as u8), u8::MAX] } else { empty };
        let before = match voxels.start {
            0 => empty,
            start => [u8::MAX, start as u8 - 1],
        };
        let full = Range::new(voxels.start, voxels.end - 1).to_bytes();
        Tests { full: pairs(full), behind: pairs(behind), before: pairs(before) }
    }

    #[inline]
    fn common(&self, columns: &[Column]) -> Common {
        let Some(columns) = columns.first_chunk::<8>() else { return Common::Mixed };
        let mut ends = [0; 16];
        for (i, column) in columns.iter().enumerate() {
            [ends[2 * i], ends[2 * i + 1]] = column.0[0].to_bytes();
        }
        // Written so that the compiler makes vectors of it.
        let (mut full, mut behind, mut before) = (true, true, true);
        for (i, end) in ends.into_iter().enumerate() {
            full &= end >= self.full[i];
            behind &= end <= self.behind[i];
            before &= end <= self.before[i];
        }
        match (behind | before, full) {
            (true, _) => Common::Empty,
            (_, true) => Common::Full,
            _ => Common::Mixed,
        }
    }
}

/// The voxels of a stretch, no longer than 64, that a range holds.
fn span(range: Range, stretch: Stretch) -> u64 {
    if range.is_empty() {
        return 0;
    }
    let below = |place: usize| if place >= 64 { u64::MAX } else { (1 << place) - 1 };
    below(stretch.place(range.hi() + 1)) & !below(stretch.place(range.lo()))
}
