//! The voxels around a box of texels, as bit rows of one word each.

use paros_core::maps::{Axis, Maps, Range};

use super::extent::Extent;
use super::{PAD, REACH};

/// Rows of a window along y and along z, at most.
pub(super) const ROWS: usize = super::blur::MOST[1] + 2 * REACH;
/// Voxels of a row left of the box's first texel; one more than needed, to round the box to.
pub(super) const LEFT: usize = 4;

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

    /// The voxels of the stretch that a grid of `n` has, with their places.
    fn inside(self, n: usize) -> impl Iterator<Item = (usize, usize)> {
        let voxels =
            self.start.clamp(0, n as isize)..(self.start + self.len as isize).clamp(0, n as isize);
        voxels.map(move |voxel| ((voxel - self.start) as usize, voxel as usize))
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
        for (at, voxel) in z.inside(N) {
            self.follow_y(maps, x, y, (at, voxel));
        }
        // Rows beside the grid stay empty.
        for at in 0..y.len {
            let voxel = (y.start + at as isize).max(0) as usize;
            if voxel < N {
                self.meet_z_and_x(maps, x, z, (at, voxel));
            }
        }
    }

    /// Sets, in a slice of equal z, the voxels that the Y map's columns hold.
    fn follow_y<const N: usize>(
        &mut self,
        maps: &Maps<N>,
        x: Stretch,
        y: Stretch,
        (at, voxel): (usize, usize),
    ) {
        let mut ends = [0u64; ROWS + 1];
        let line = maps.line(Axis::Y, voxel);
        for (bit, place) in x.inside(N) {
            let range = line[place].hull();
            if !range.is_empty() {
                // A column that stands on the ground goes on below it.
                let first = if range.lo() == 0 { 0 } else { y.place(range.lo()) };
                ends[first] ^= 1 << bit;
                ends[y.place(range.hi() + 1)] ^= 1 << bit;
            }
        }
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
        z: Stretch,
        (at, voxel): (usize, usize),
    ) {
        let mut ends = [0u64; ROWS + 1];
        let line = maps.line(Axis::Z, voxel);
        for (bit, place) in x.inside(N) {
            let range = line[place].hull();
            if !range.is_empty() {
                ends[z.place(range.lo())] ^= 1 << bit;
                ends[z.place(range.hi() + 1)] ^= 1 << bit;
            }
        }
        let mut inside = 0;
        for (rows, end) in self.rows[..z.len].iter_mut().zip(ends) {
            inside ^= end;
            rows[at] &= inside;
        }
        let line = maps.line(Axis::X, voxel);
        for (place, z) in z.inside(N) {
            self.rows[place][at] &= span(line[z].hull(), x);
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
