//! The voxels around a box of texels, as bit rows of one word each.

use paros_core::RangeMaps;
use paros_core::volume::{Axis, Column, Range};

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
    /// Returns a voxel's offset from the run's start, clamped to 0 and `len`.
    #[inline]
    fn clamped_offset(&self, voxel: usize) -> usize {
        (voxel as isize - self.start).clamp(0, self.len as isize) as usize
    }

    /// Returns the voxels of the run that lie in a grid.
    fn voxels_in_grid(self, grid_side: usize) -> std::ops::Range<usize> {
        let inside = |end: isize| end.clamp(0, grid_side as isize) as usize;
        inside(self.start)..inside(self.start + self.len as isize)
    }

    /// Returns the offset, from the run's start, of its first voxel in the grid.
    const fn offset_of_first_voxel_in_grid(self) -> usize {
        self.start.unsigned_abs() * (self.start < 0) as usize
    }
}

impl VoxelWindow {
    pub(super) const fn new() -> Self {
        VoxelWindow { rows: [[0; WINDOW_ROWS]; WINDOW_ROWS] }
    }

    /// Returns a bit row along x, by the window's own y and z, from 0.
    #[inline]
    pub(super) fn row(&self, window_y: usize, window_z: usize) -> u64 {
        self.rows[window_z][window_y]
    }

    /// Intersects the three range maps around a box of texels into bit rows.
    pub(super) fn load_voxels<const N: usize, const K: usize>(
        &mut self,
        maps: &RangeMaps<N, K>,
        extent: TexelBox,
    ) {
        let around = |axis: usize, margin: usize| VoxelSpan {
            start: extent.lo[axis] as isize - (PAD + margin) as isize,
            len: extent.size()[axis] + 2 * margin,
        };
        let (x, y, z) = (around(0, MARGIN_X), around(1, REACH), around(2, REACH));
        for rows in &mut self.rows[..z.len] {
            rows[..y.len].fill(0);
        }
        let (of_y, of_z) = (ColumnClassifier::new(y, N), ColumnClassifier::new(z, N));
        for (i, grid_z) in z.voxels_in_grid(N).enumerate() {
            self.fill_slice_from_y_map(
                maps,
                x,
                &of_y,
                z.offset_of_first_voxel_in_grid() + i,
                grid_z,
            );
        }
        // Rows beside the grid stay empty.
        for window_y in 0..y.len {
            let grid_y = (y.start + window_y as isize).max(0) as usize;
            if grid_y < N {
                self.intersect_layer_with_z_and_x_maps(maps, x, &of_z, window_y, grid_y);
            }
        }
    }

    /// Sets, in a slice of equal z, the voxels that the Y map's columns hold, by a parity fill from the
    /// columns' ends.
    fn fill_slice_from_y_map<const N: usize, const K: usize>(
        &mut self,
        maps: &RangeMaps<N, K>,
        x: VoxelSpan,
        along_y: &ColumnClassifier,
        window_z: usize,
        grid_z: usize,
    ) {
        let columns = &maps.line(Axis::Y, grid_z)[x.voxels_in_grid(N)];
        let y = along_y.span;
        let ColumnEnds { mut toggles, full } = find_column_ends(columns, x, along_y, |range| {
            // A column that stands on the ground is continued below it.
            let first = if range.first() == 0 { 0 } else { y.clamped_offset(range.first()) };
            first..y.clamped_offset(range.last() + 1)
        });
        // Full columns are continued below the ground, and not above the grid.
        toggles[0] ^= full;
        toggles[y.clamped_offset(N)] ^= full;
        let mut inside = 0;
        for (row, toggled) in self.rows[window_z][..y.len].iter_mut().zip(toggles) {
            inside ^= toggled;
            *row = inside;
        }
    }

    /// Keeps, in a layer of equal y, only the voxels that the Z and X maps' columns hold too.
    fn intersect_layer_with_z_and_x_maps<const N: usize, const K: usize>(
        &mut self,
        maps: &RangeMaps<N, K>,
        x: VoxelSpan,
        along_z: &ColumnClassifier,
        window_y: usize,
        grid_y: usize,
    ) {
        let columns = &maps.line(Axis::Z, grid_y)[x.voxels_in_grid(N)];
        let z = along_z.span;
        let ColumnEnds { toggles, full } = find_column_ends(columns, x, along_z, |range| {
            z.clamped_offset(range.first())..z.clamped_offset(range.last() + 1)
        });
        let mut inside = full;
        for (rows, toggled) in self.rows[..z.len].iter_mut().zip(toggles) {
            inside ^= toggled;
            rows[window_y] &= inside;
        }
        let line = maps.line(Axis::X, grid_y);
        for (rows, column) in self.rows[z.offset_of_first_voxel_in_grid()..]
            .iter_mut()
            .zip(&line[z.voxels_in_grid(N)])
        {
            if rows[window_y] != 0 {
                rows[window_y] &=
                    column.ranges().into_iter().fold(0, |bits, range| bits | range_bits(range, x));
            }
        }
    }
}

/// The ends of columns side by side along x, a bit for each column.
struct ColumnEnds {
    /// Indexed by row of the window: the columns with an interval that begins or ends before that row.
    toggles: [u64; WINDOW_ROWS + 1],
    /// The columns that hold all rows; `toggles` leaves them out.
    full: u64,
}

/// Finds the ends of columns side by side along x, from a span's first voxel in the grid on. `window_rows`
/// maps a range to rows of the window.
#[inline(always)]
fn find_column_ends<const K: usize>(
    columns: &[Column<K>],
    x: VoxelSpan,
    classifier: &ColumnClassifier,
    window_rows: impl Fn(Range) -> std::ops::Range<usize>,
) -> ColumnEnds {
    let mut toggles = [0u64; WINDOW_ROWS + 1];
    let mut full = 0;
    for (i, columns) in columns.chunks(8).enumerate() {
        let bit = x.offset_of_first_voxel_in_grid() + 8 * i;
        match classifier.classify_eight(columns) {
            ColumnCoverage::Empty => {}
            ColumnCoverage::Full => full |= (u64::MAX >> (64 - columns.len())) << bit,
            ColumnCoverage::Mixed => {
                for (bit, column) in (bit..).zip(columns) {
                    for range in column.intervals() {
                        let rows = window_rows(range);
                        toggles[rows.start] ^= 1 << bit;
                        toggles[rows.end] ^= 1 << bit;
                    }
                }
            }
        }
    }
    ColumnEnds { toggles, full }
}

/// Coverage of a run of voxels by eight columns.
enum ColumnCoverage {
    Empty,
    /// All of the run that lies in the grid.
    Full,
    Mixed,
}

/// Classifier of columns by their coverage of a span: bounds to compare the ends of eight columns at once,
/// in the bytes in which a range stores them.
struct ColumnClassifier {
    span: VoxelSpan,
    /// Lower bounds of the ends of a column that holds all of the run, unless the column has a gap.
    full: [u8; 16],
    /// Upper bounds of the ends of a column that holds nothing of the run, because it lies behind it, or
    /// before it.
    behind: [u8; 16],
    before: [u8; 16],
}

impl ColumnClassifier {
    fn new(span: VoxelSpan, grid_side: usize) -> Self {
        let voxels = span.voxels_in_grid(grid_side);
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
        ColumnClassifier { span, full: pairs(full), behind: pairs(behind), before: pairs(before) }
    }

    #[inline]
    fn classify_eight<const K: usize>(&self, columns: &[Column<K>]) -> ColumnCoverage {
        let Some(columns) = columns.first_chunk::<8>() else { return ColumnCoverage::Mixed };
        let (mut ends, mut has_gap) = ([0; 16], false);
        for (i, column) in columns.iter().enumerate() {
            [ends[2 * i], ends[2 * i + 1]] = column.hull().to_bytes();
            has_gap |= column.has_gaps();
        }
        // Free of branches, so that the compiler vectorises it.
        let (mut full, mut behind, mut before) = (true, true, true);
        for (i, end) in ends.into_iter().enumerate() {
            full &= end >= self.full[i];
            behind &= end <= self.behind[i];
            before &= end <= self.before[i];
        }
        match (behind | before, full & !has_gap) {
            (true, _) => ColumnCoverage::Empty,
            (_, true) => ColumnCoverage::Full,
            _ => ColumnCoverage::Mixed,
        }
    }
}

/// Returns the voxels of a span that a range holds, a bit each, the span's first voxel lowest. The span has
/// at most 64 voxels.
fn range_bits(range: Range, span: VoxelSpan) -> u64 {
    if range.is_empty() {
        return 0;
    }
    let below = |offset: usize| if offset >= 64 { u64::MAX } else { (1 << offset) - 1 };
    below(span.clamped_offset(range.last() + 1)) & !below(span.clamped_offset(range.first()))
}
