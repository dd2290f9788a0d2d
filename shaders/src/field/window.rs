//! The voxels around a box of texels, as bit rows of one word each.

use paros_core::{Axis, Column, Range, RangeMaps};

use super::extent::TexelBox;
use super::rows::MAX_BOX;
use super::sizes::{PAD, REACH};

/// Rows of a window along y and along z, at most.
pub(super) const WINDOW_ROWS: usize = MAX_BOX[1] + 2 * REACH;
/// Voxels of a row left of the box's first texel; one more than needed, to align the box.
pub(super) const MARGIN_X: usize = 4;
/// Rows along y and z before the first one that is blurred, in voxels.
pub(super) const BLUR_MARGIN: usize = 2;

/// Bit rows along x of the voxels at most [`REACH`] from a box of texels (and [`MARGIN_X`] from it
/// along x). Row (0, 0) is the one of least y and z. Voxels below y = 0 are those of the ground
/// layer.
#[derive(Clone, Debug)]
pub(super) struct VoxelWindow {
    rows: [[u64; WINDOW_ROWS]; WINDOW_ROWS],
}

/// A run of voxels along an axis, which may reach beyond the grid.
#[derive(Clone, Copy)]
struct VoxelSpan {
    start: isize,
    len: usize,
}

impl VoxelSpan {
    /// The index of a voxel within the run, clamped to 0 and `len`.
    #[inline]
    fn clamp_to_place(&self, voxel: usize) -> usize {
        (voxel as isize - self.start).clamp(0, self.len as isize) as usize
    }

    /// The voxels of the run that lie in a grid of side `n`.
    fn voxels_in_grid(self, n: usize) -> std::ops::Range<usize> {
        let inside = |end: isize| end.clamp(0, n as isize) as usize;
        inside(self.start)..inside(self.start + self.len as isize)
    }

    /// The index within the run of the first of them.
    const fn first_place_in_grid(self) -> usize {
        self.start.unsigned_abs() * (self.start < 0) as usize
    }
}

impl VoxelWindow {
    pub(super) const fn new() -> Self {
        VoxelWindow { rows: [[0; WINDOW_ROWS]; WINDOW_ROWS] }
    }

    /// A bit row along x, by the window's own y and z, from 0.
    #[inline]
    pub(super) fn row(&self, y: usize, z: usize) -> u64 {
        self.rows[z][y]
    }

    /// Intersects the three range maps around a box of texels into bit rows.
    pub(super) fn load_voxels<const N: usize>(&mut self, maps: &RangeMaps<N>, extent: TexelBox) {
        let around = |axis: usize, by: usize| VoxelSpan {
            start: extent.lo[axis] as isize - (PAD + by) as isize,
            len: extent.size()[axis] + 2 * by,
        };
        let (x, y, z) = (around(0, MARGIN_X), around(1, REACH), around(2, REACH));
        for rows in &mut self.rows[..z.len] {
            rows[..y.len].fill(0);
        }
        let (of_y, of_z) = (ColumnTests::new(y, N), ColumnTests::new(z, N));
        for (i, voxel) in z.voxels_in_grid(N).enumerate() {
            self.fill_from_y_map(maps, x, (y, &of_y), (z.first_place_in_grid() + i, voxel));
        }
        // Rows beside the grid stay empty.
        for at in 0..y.len {
            let voxel = (y.start + at as isize).max(0) as usize;
            if voxel < N {
                self.intersect_z_and_x_maps(maps, x, (z, &of_z), (at, voxel));
            }
        }
    }

    /// Sets, in a slice of equal z, the voxels that the Y map's columns hold: a parity fill from
    /// the columns' ends.
    fn fill_from_y_map<const N: usize>(
        &mut self,
        maps: &RangeMaps<N>,
        x: VoxelSpan,
        (y, tests): (VoxelSpan, &ColumnTests),
        (at, voxel): (usize, usize),
    ) {
        let columns = &maps.line(Axis::Y, voxel)[x.voxels_in_grid(N)];
        let (mut ends, full) = column_ends(columns, x, tests, |range| {
            // A column that stands on the ground is continued below it.
            let first = if range.first() == 0 { 0 } else { y.clamp_to_place(range.first()) };
            (first, y.clamp_to_place(range.last() + 1))
        });
        // Full columns are continued below the ground, and not above the grid.
        ends[0] ^= full;
        ends[y.clamp_to_place(N)] ^= full;
        let mut inside = 0;
        for (row, end) in self.rows[at][..y.len].iter_mut().zip(ends) {
            inside ^= end;
            *row = inside;
        }
    }

    /// Keeps, in a layer of equal y, only the voxels that the Z and X maps' columns hold too.
    fn intersect_z_and_x_maps<const N: usize>(
        &mut self,
        maps: &RangeMaps<N>,
        x: VoxelSpan,
        (z, tests): (VoxelSpan, &ColumnTests),
        (at, voxel): (usize, usize),
    ) {
        let columns = &maps.line(Axis::Z, voxel)[x.voxels_in_grid(N)];
        let (ends, full) = column_ends(columns, x, tests, |range| {
            (z.clamp_to_place(range.first()), z.clamp_to_place(range.last() + 1))
        });
        let mut inside = full;
        for (rows, end) in self.rows[..z.len].iter_mut().zip(ends) {
            inside ^= end;
            rows[at] &= inside;
        }
        let line = maps.line(Axis::X, voxel);
        for (rows, column) in
            self.rows[z.first_place_in_grid()..].iter_mut().zip(&line[z.voxels_in_grid(N)])
        {
            if rows[at] != 0 {
                rows[at] &= span_bits(column.hull(), x);
            }
        }
    }
}

/// For columns along x, a bit each: the rows at which they begin or end, as `places` maps their
/// ranges, and those that hold all rows.
#[inline(always)]
fn column_ends(
    columns: &[Column],
    x: VoxelSpan,
    tests: &ColumnTests,
    places: impl Fn(Range) -> (usize, usize),
) -> ([u64; WINDOW_ROWS + 1], u64) {
    let mut ends = [0u64; WINDOW_ROWS + 1];
    let mut full = 0;
    for (i, columns) in columns.chunks(8).enumerate() {
        let bit = x.first_place_in_grid() + 8 * i;
        match tests.classify_columns(columns) {
            ColumnCoverage::Empty => {}
            ColumnCoverage::Full => full |= (u64::MAX >> (64 - columns.len())) << bit,
            ColumnCoverage::Mixed => {
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

/// What eight columns hold of a run of voxels.
enum ColumnCoverage {
    Empty,
    /// All of the run that lies in the grid.
    Full,
    Mixed,
}

/// Bounds for comparing eight columns' ends at once, as a range stores them.
struct ColumnTests {
    /// Ends at least these: the column holds all of the run.
    full: [u8; 16],
    /// Ends at most these: the column holds nothing of the run, as it lies behind it, or before.
    behind: [u8; 16],
    before: [u8; 16],
}

impl ColumnTests {
    fn new(stretch: VoxelSpan, n: usize) -> Self {
        let voxels = stretch.voxels_in_grid(n);
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
        ColumnTests { full: pairs(full), behind: pairs(behind), before: pairs(before) }
    }

    #[inline]
    fn classify_columns(&self, columns: &[Column]) -> ColumnCoverage {
        let Some(columns) = columns.first_chunk::<8>() else { return ColumnCoverage::Mixed };
        let mut ends = [0; 16];
        for (i, column) in columns.iter().enumerate() {
            [ends[2 * i], ends[2 * i + 1]] = column.0[0].to_bytes();
        }
        // Without branches, so that the compiler vectorises it.
        let (mut full, mut behind, mut before) = (true, true, true);
        for (i, end) in ends.into_iter().enumerate() {
            full &= end >= self.full[i];
            behind &= end <= self.behind[i];
            before &= end <= self.before[i];
        }
        match (behind | before, full) {
            (true, _) => ColumnCoverage::Empty,
            (_, true) => ColumnCoverage::Full,
            _ => ColumnCoverage::Mixed,
        }
    }
}

/// Bits of a run's voxels that a range holds. The run has at most 64.
fn span_bits(range: Range, stretch: VoxelSpan) -> u64 {
    if range.is_empty() {
        return 0;
    }
    let below = |place: usize| if place >= 64 { u64::MAX } else { (1 << place) - 1 };
    below(stretch.clamp_to_place(range.last() + 1)) & !below(stretch.clamp_to_place(range.first()))
}
