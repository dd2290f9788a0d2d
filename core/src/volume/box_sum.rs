//! The box filter on bit rows: how many voxels of the cube around each voxel are occupied, in bit-sliced counters,
//! as many voxels at a time as a row has.
//!
//! One axis after the other: along y the counts of a row go up with the layers, by the row that comes into the
//! filter's reach and the one that leaves it; then along x, within the row; then along z, by the rows of a layer.

use crate::limits::MAX_SMOOTHING_RADIUS;
use crate::volume::row::{BitRow, BitSet};

/// Counts of a row's voxels: bit i of plane p is bit p of the count of voxel i.
pub(crate) type Planes<R, const P: usize> = [R; P];

/// Bits of a count along an axis: 15 voxels at most.
pub(crate) const LINE_PLANES: usize = 4;

/// Bits of a count in a run of counts along an axis: 8 x 15 voxels at most.
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
    /// A filter of a radius of 0, 1, 3 or 7, or else of the next lower of them: its runs are added up by doubling.
    pub(crate) const fn new(radius: usize) -> Self {
        let most = MAX_SMOOTHING_RADIUS;
        let radius = if radius < most { radius } else { most };
        BoxFilter { radius: (1 << (radius + 1).ilog2()) - 1 }
    }

    /// How far it reaches from its middle.
    pub(crate) const fn radius(self) -> usize {
        self.radius
    }

    /// Voxels along a side.
    pub(crate) const fn side(self) -> u32 {
        2 * self.radius as u32 + 1
    }

    /// Voxels of a layer.
    pub(crate) const fn layer_voxels(self) -> u32 {
        self.side() * self.side()
    }

    /// The counts of squares along y and x, from those along y: of the run that begins with a voxel, and of the one
    /// that ends with it, less the voxel's own, which is in both.
    fn square_counts<const W: usize>(
        self,
        along_y: &Planes<BitRow<W>, LINE_PLANES>,
    ) -> Planes<BitRow<W>, SQUARE_PLANES> {
        let mut counts = widen_planes(self.run_counts(along_y, BitRow::shifted_down_by));
        add_counts(&mut counts, &self.run_counts(along_y, BitRow::shifted_up_by));
        subtract_counts(&mut counts, along_y);
        counts
    }

    /// The counts of `radius` + 1 voxels together: of each voxel, and of those that `shift` brings to its place.
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

/// The sums of one row of a layer after the other: those of the last (2 `radius` + 1) rows that were given.
#[derive(Debug)]
pub(crate) struct RowSums<const W: usize> {
    filter: BoxFilter,
    /// The counts in squares of those rows, each in the place of the one that it followed.
    squares: [SquareCounts<W>; 2 * MAX_SMOOTHING_RADIUS + 1],
    next: usize,
    sums: Planes<BitRow<W>, SUM_PLANES>,
}

/// The counts in squares of a row.
#[derive(Clone, Copy, Debug)]
struct SquareCounts<const W: usize> {
    /// Of no meaning where all are 0.
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

    /// Goes on by a row, whose counts along y are given. Returns the sums of the row `radius` before it.
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

/// The counts of runs of twice the length, of which `shift` brings the other half. `Q` is `P` + 1, which holds them.
#[inline]
fn double_run<const W: usize, const P: usize, const Q: usize>(
    counts: &Planes<BitRow<W>, P>,
    shift: impl Fn(BitRow<W>) -> BitRow<W>,
) -> Planes<BitRow<W>, Q> {
    let mut run = widen_planes(*counts);
    add_counts(&mut run, &counts.map(shift));
    run
}

/// The same counts in more planes.
#[inline]
fn widen_planes<const W: usize, const P: usize, const Q: usize>(
    counts: Planes<BitRow<W>, P>,
) -> Planes<BitRow<W>, Q> {
    let mut wide = [BitRow::EMPTY; Q];
    wide[..P].copy_from_slice(&counts);
    wide
}

/// Adds counts, each to that of the same voxel. A sum beyond the planes loses its highest bits.
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

/// Subtracts counts that are at most as large.
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

/// The same count for every voxel.
pub(crate) fn equal_counts<R: BitSet, const P: usize>(count: u32) -> Planes<R, P> {
    core::array::from_fn(|i| if count >> i & 1 != 0 { !R::EMPTY } else { R::EMPTY })
}

/// The voxels whose count is greater than a number.
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

/// The count of one voxel.
pub(crate) fn count_at<R: BitSet, const P: usize>(counts: &Planes<R, P>, voxel: usize) -> u32 {
    counts.iter().rev().fold(0, |count, plane| count << 1 | u32::from(plane.contains(voxel)))
}

#[cfg(test)]
mod tests {
    use core::array;

    use super::*;
    use crate::codec::digest::mix_bits;

    /// A layer of rows of 128 voxels, of which 40 are in the grid; of no pattern.
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
            // All rows along y are alike.
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
