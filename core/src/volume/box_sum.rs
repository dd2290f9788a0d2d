//! The box filter on bit rows: counts the occupied voxels in the cube around each voxel, in bit-sliced
//! counters that process all voxels of a row at once.
//!
//! The filter runs along one axis after another: along y, the counts of a row are updated from layer to layer
//! by the row that enters the filter's reach and the row that leaves it; then along x, within the row; then
//! along z, over the rows of a layer.

use crate::limits::MAX_SMOOTHING_RADIUS;
use crate::volume::row::{BitRow, BitSet};

/// Bit-sliced counts of a row's voxels: bit i of plane p is bit p of the count of voxel i.
pub(crate) type Planes<R, const P: usize> = [R; P];

/// Bits of a count along an axis: 15 voxels at most.
pub(crate) const LINE_PLANES: usize = 4;

/// Bits of the sum of a run of counts along an axis: 8 x 15 voxels at most.
const RUN_PLANES: usize = 7;

/// Bits of a count in a square: 15 x 15 voxels at most.
const SQUARE_PLANES: usize = 8;

/// Bits of a sum: 15^3 voxels at most.
pub(crate) const SUM_PLANES: usize = 12;

/// A cube of voxels about its middle one, (2 `radius` + 1)^3 of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoxFilter {
    radius: usize,
}

impl BoxFilter {
    /// Creates a filter. The radius is rounded down to 0, 1, 3 or 7, as runs are added up by doubling.
    pub(crate) const fn new(radius: usize) -> Self {
        let most = MAX_SMOOTHING_RADIUS;
        let radius = if radius < most { radius } else { most };
        BoxFilter { radius: (1 << (radius + 1).ilog2()) - 1 }
    }

    /// Returns the filter's reach to each side of its middle.
    pub(crate) const fn radius(self) -> usize {
        self.radius
    }

    /// Returns the voxels along a side.
    pub(crate) const fn side(self) -> u32 {
        2 * self.radius as u32 + 1
    }

    /// Returns the voxels of a layer.
    pub(crate) const fn layer_voxels(self) -> u32 {
        self.side() * self.side()
    }

    /// Returns the counts of squares along y and x, from the counts along y: the sum of the run that begins
    /// with a voxel and the run that ends with it, minus the voxel's own count, which is in both.
    fn square_counts<const W: usize>(
        self,
        along_y: &Planes<BitRow<W>, LINE_PLANES>,
    ) -> Planes<BitRow<W>, SQUARE_PLANES> {
        let mut counts = widen_planes(self.run_counts(along_y, BitRow::shifted_down_by));
        add_counts(&mut counts, &self.run_counts(along_y, BitRow::shifted_up_by));
        subtract_counts(&mut counts, along_y);
        counts
    }

    /// Returns the sum of `radius` + 1 counts: each voxel's own and those that `shift` brings to its place.
    #[inline]
    fn run_counts<const W: usize>(
        self,
        counts: &Planes<BitRow<W>, LINE_PLANES>,
        shift: impl Fn(BitRow<W>, u32) -> BitRow<W>,
    ) -> Planes<BitRow<W>, RUN_PLANES> {
        if self.radius == 0 {
            return widen_planes(*counts);
        }
        let run_of_2 = double_run::<W, 4, 5>(counts, |plane| shift(plane, 1));
        if self.radius == 1 {
            return widen_planes(run_of_2);
        }
        let run_of_4 = double_run::<W, 5, 6>(&run_of_2, |plane| shift(plane, 2));
        if self.radius == 3 {
            return widen_planes(run_of_4);
        }
        double_run(&run_of_4, |plane| shift(plane, 4))
    }
}

/// A running sum over the rows of a layer: the sums of the last (2 `radius` + 1) rows given.
#[derive(Debug)]
pub(crate) struct RowSums<const W: usize> {
    filter: BoxFilter,
    /// The counts in squares of those rows, in a ring buffer.
    squares: [SquareCounts<W>; 2 * MAX_SMOOTHING_RADIUS + 1],
    next: usize,
    sums: Planes<BitRow<W>, SUM_PLANES>,
}

/// The counts in squares of a row.
#[derive(Clone, Copy, Debug)]
struct SquareCounts<const W: usize> {
    /// Undefined if all counts are 0.
    counts: Planes<BitRow<W>, SQUARE_PLANES>,
    has_none: bool,
}

impl<const W: usize> RowSums<W> {
    /// Sums of empty rows.
    pub(crate) const fn new(filter: BoxFilter) -> Self {
        let none = SquareCounts { counts: [BitRow([0; W]); SQUARE_PLANES], has_none: true };
        RowSums {
            filter,
            squares: [none; 2 * MAX_SMOOTHING_RADIUS + 1],
            next: 0,
            sums: [BitRow([0; W]); SUM_PLANES],
        }
    }

    /// Advances by a row, given its counts along y. Returns the sums of the row `radius` rows earlier.
    pub(crate) fn advance(
        &mut self,
        along_y: &Planes<BitRow<W>, LINE_PLANES>,
    ) -> &Planes<BitRow<W>, SUM_PLANES> {
        let square = &mut self.squares[self.next];
        self.next = (self.next + 1) % (2 * self.filter.radius + 1);
        if !square.has_none {
            subtract_counts(&mut self.sums, &square.counts);
        }
        square.has_none = along_y.iter().all(BitSet::is_empty);
        if !square.has_none {
            square.counts = self.filter.square_counts(along_y);
            add_counts(&mut self.sums, &square.counts);
        }
        &self.sums
    }
}

/// Returns the counts of runs of twice the length; `shift` brings the other half. `Q` is `P` + 1, enough to
/// hold them.
#[inline]
fn double_run<const W: usize, const P: usize, const Q: usize>(
    counts: &Planes<BitRow<W>, P>,
    shift: impl Fn(BitRow<W>) -> BitRow<W>,
) -> Planes<BitRow<W>, Q> {
    let mut run = widen_planes(*counts);
    add_counts(&mut run, &counts.map(shift));
    run
}

/// Copies counts into more planes.
#[inline]
fn widen_planes<const W: usize, const P: usize, const Q: usize>(
    counts: Planes<BitRow<W>, P>,
) -> Planes<BitRow<W>, Q> {
    let mut wide = [BitRow::EMPTY; Q];
    wide[..P].copy_from_slice(&counts);
    wide
}

/// Adds counts voxel by voxel. A sum beyond the planes loses its highest bits.
#[inline]
pub(crate) fn add_counts<R: BitSet, const P: usize, const Q: usize>(
    to: &mut Planes<R, P>,
    counts: &Planes<R, Q>,
) {
    let mut carry = R::EMPTY;
    for (plane, &other) in to.iter_mut().zip(counts) {
        let half = *plane ^ other;
        let next = *plane & other | carry & half;
        *plane = half ^ carry;
        carry = next;
    }
    for plane in to.iter_mut().skip(Q) {
        let next = *plane & carry;
        *plane ^= carry;
        carry = next;
    }
}

/// Subtracts counts that are at most as large as those subtracted from.
#[inline]
pub(crate) fn subtract_counts<R: BitSet, const P: usize, const Q: usize>(
    from: &mut Planes<R, P>,
    counts: &Planes<R, Q>,
) {
    let mut borrow = R::EMPTY;
    for (plane, &other) in from.iter_mut().zip(counts) {
        let half = *plane ^ other;
        let next = other & !*plane | borrow & !half;
        *plane = half ^ borrow;
        borrow = next;
    }
    for plane in from.iter_mut().skip(Q) {
        let next = borrow & !*plane;
        *plane ^= borrow;
        borrow = next;
    }
}

/// Returns counts that are the same for every voxel.
pub(crate) fn equal_counts<R: BitSet, const P: usize>(count: u32) -> Planes<R, P> {
    core::array::from_fn(|i| if count >> i & 1 != 0 { !R::EMPTY } else { R::EMPTY })
}

/// Returns the voxels whose count is greater than a number.
#[inline]
pub(crate) fn counts_above<R: BitSet, const P: usize>(counts: &Planes<R, P>, number: u32) -> R {
    let (mut above, mut equal) = (R::EMPTY, !R::EMPTY);
    for (i, plane) in counts.iter().enumerate().rev() {
        if number >> i & 1 == 0 {
            above |= equal & *plane;
            equal &= !*plane;
        } else {
            equal &= *plane;
        }
    }
    above
}

/// Returns the count of one voxel.
pub(crate) fn count_at<R: BitSet, const P: usize>(counts: &Planes<R, P>, voxel: usize) -> u32 {
    counts.iter().rev().fold(0, |count, plane| count << 1 | u32::from(plane.contains(voxel)))
}

#[cfg(test)]
mod tests {
    use core::array;

    use super::*;
    use crate::codec::digest::mix_bits;

    /// Returns a pseudo-random layer of rows of 128 voxels, 40 of them in the grid.
    fn row_at(z: isize) -> BitRow<2> {
        match z {
            0..40 => BitRow([mix_bits(z as u64), mix_bits(!z as u64) | mix_bits(z as u64 + 99)]),
            _ => BitRow::EMPTY,
        }
    }

    #[test]
    fn sums_are_those_of_counting() {
        for radius in [0, 1, 3, 7] {
            let filter = BoxFilter::new(radius);
            // All rows along y are equal.
            let counts = |z| {
                array::from_fn(|i| match filter.side() >> i & 1 {
                    0 => BitRow::EMPTY,
                    _ => row_at(z),
                })
            };
            let mut row_sums = RowSums::new(filter);
            let radius = radius as isize;
            for z in -radius..40 + radius {
                let sums = row_sums.advance(&counts(z));
                for x in (0..128).filter(|_| z >= radius) {
                    let reach = |i: isize| i - radius..=i + radius;
                    let is_set =
                        |x: isize, z| (0..128).contains(&x) && row_at(z).contains(x as usize);
                    let places = reach(z - radius).flat_map(|z| reach(x).map(move |x| (x, z)));
                    let count = places.filter(|&(x, z)| is_set(x, z)).count() as u32;
                    let sum = filter.side() * count;
                    assert_eq!(count_at(sums, x as usize), sum, "{x} before {z}, {radius}");
                }
            }
        }
    }

    #[test]
    fn what_is_added_and_taken_away_leaves_nothing() {
        let counts: Planes<BitRow<2>, 8> = array::from_fn(|i| row_at(i as isize));
        let mut sums: Planes<BitRow<2>, SUM_PLANES> = equal_counts(3375 - 255);
        add_counts(&mut sums, &counts);
        for x in 0..128 {
            assert_eq!(count_at(&sums, x), 3375 - 255 + count_at(&counts, x));
        }
        for number in [0, 3119, 3120, 3200, 3374, 3375, 4095] {
            let above = counts_above(&sums, number);
            assert!((0..128).all(|x| above.contains(x) == (count_at(&sums, x) > number)));
        }
        subtract_counts(&mut sums, &counts);
        assert_eq!(sums, equal_counts(3375 - 255));
    }
}
