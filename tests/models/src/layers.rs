//! Model of a volume of K intervals a column: three lists of intervals and one boolean a voxel, with the
//! closure rule by its naive definition.

use paros_core::RangeMaps;
use paros_core::volume::{Axis, Column, Range};

use crate::dense::DenseVolume;

/// The intervals of a column, lowest first, each as first and last voxel.
pub type Intervals = Vec<(usize, usize)>;

/// A volume with its maps. The maps depend on the history: which gaps a column holds follows from earlier
/// edits.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LayeredVolume {
    layers: usize,
    voxels: DenseVolume,
    /// The intervals, by axis, line and place.
    columns: [Vec<Intervals>; 3],
}

impl LayeredVolume {
    /// Returns the closure of `voxels` in columns of at most `layers` intervals without earlier gaps.
    pub fn new(voxels: &DenseVolume, layers: usize) -> Self {
        let n = voxels.side();
        let columns = Axis::ALL.map(|_| vec![Vec::new(); n * n]);
        let mut volume = LayeredVolume { layers, voxels: DenseVolume::empty(n), columns };
        volume.become_closure_of(voxels);
        volume
    }

    /// Returns the occupied voxels.
    pub fn voxels(&self) -> &DenseVolume {
        &self.voxels
    }

    /// Returns the intervals of the column at (line, place).
    pub fn column(&self, axis: Axis, (line, place): (usize, usize)) -> &Intervals {
        &self.columns[axis as usize][line * self.voxels.side() + place]
    }

    /// Writes the columns to maps with the same number of intervals.
    ///
    /// # Panics
    /// The maps have another size or number of intervals.
    pub fn write_maps<const N: usize, const K: usize>(&self, maps: &mut RangeMaps<N, K>) {
        assert_eq!((N, K), (self.voxels.side(), self.layers), "voxels a side, intervals a column");
        for axis in Axis::ALL {
            for at in (0..N * N).map(|at| (at / N, at % N)) {
                let mut column = Column::EMPTY;
                for (i, &(lo, hi)) in self.column(axis, at).iter().enumerate() {
                    column.set_range(i, Range::new(lo, hi));
                }
                maps.set_column(axis, at, column);
            }
        }
    }

    /// Applies an edit whose exact result is `exact`: recomputes the columns that differ from it by the
    /// closure rule, then the voxels that lie in all three of their columns.
    pub fn become_closure_of(&mut self, exact: &DenseVolume) {
        let n = self.voxels.side();
        for (axis, i) in Axis::ALL.into_iter().flat_map(|axis| (0..n * n).map(move |i| (axis, i))) {
            let at = (i / n, i % n);
            if !exact.column(axis, at).eq(self.voxels.column(axis, at)) {
                let bits: Vec<_> = exact.column(axis, at).collect();
                let column = &mut self.columns[axis as usize][i];
                *column = closed_intervals(&bits, column, self.layers);
            }
        }
        self.voxels = DenseVolume::from_columns(n, |axis, at| {
            self.column(axis, at).iter().map(|&(lo, hi)| Range::new(lo, hi))
        });
    }

    /// Asserts the invariants of every volume: each interval is tight, and a column with fewer than K - 1
    /// gaps has no other empty run inside its hull.
    ///
    /// # Panics
    /// An invariant is violated.
    pub fn assert_tight_and_saturated(&self) {
        let n = self.voxels.side();
        for axis in Axis::ALL {
            for at in (0..n * n).map(|at| (at / n, at % n)) {
                let column = self.column(axis, at);
                let occupied = |i| self.voxels.contains(axis.voxel_at(at, i).map(|i| i as i32));
                for &(lo, hi) in column {
                    assert!(occupied(lo) && occupied(hi), "{axis:?} {at:?} isn't tight");
                    if column.len() < self.layers {
                        assert!((lo..=hi).all(occupied), "{axis:?} {at:?} isn't saturated");
                    }
                }
            }
        }
    }
}

/// Applies the closure rule to one column: the hull of `bits` without the first `layers - 1` of its empty
/// runs. The runs are sorted by (touches a gap of `before`: first; length, longest first; lowest coordinate).
pub(crate) fn closed_intervals(bits: &[bool], before: &Intervals, layers: usize) -> Intervals {
    let Some(first) = bits.iter().position(|&bit| bit) else {
        return Vec::new();
    };
    let last = bits.iter().rposition(|&bit| bit).unwrap_or(first);
    let held = |i: &usize| {
        let inside = before.iter().any(|&(lo, hi)| lo <= *i && *i <= hi);
        let between = before.first().is_some_and(|&(lo, _)| lo < *i)
            && before.last().is_some_and(|&(_, hi)| *i < hi);
        between && !inside
    };
    let mut runs = Vec::new();
    let mut i = first;
    while i <= last {
        let end = (i..=last).find(|&j| bits[j] != bits[i]).unwrap_or(last + 1);
        if !bits[i] {
            runs.push((i, end - 1));
        }
        i = end;
    }
    runs.sort_by_key(|&(lo, hi)| (!(lo..=hi).any(|i| held(&i)), std::cmp::Reverse(hi - lo), lo));
    runs.truncate(layers - 1);
    runs.sort_unstable();
    let mut intervals = Vec::new();
    let mut start = first;
    for (lo, hi) in runs {
        intervals.push((start, lo - 1));
        start = hi + 1;
    }
    intervals.push((start, last));
    intervals
}
