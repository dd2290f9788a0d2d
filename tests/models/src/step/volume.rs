//! A volume of K intervals a column, as one boolean a voxel and a column for each address, edited by the
//! definition. Only columns through changed voxels are recomputed, so that large grids are possible too.

use std::collections::BTreeSet;
use std::sync::Arc;

use paros_core::edit::{ANY_DEPTH, EditOperation, EditReport, SUBUNITS_PER_VOXEL};
use paros_core::internals::ColumnAddress;
use paros_core::limits::SHELL_DEPTH;
use paros_core::volume::{Axis, Column, Range, VoxelBox};
use paros_core::{Brush, RangeMaps};

use crate::dense::DenseVolume;
use crate::flattening::Flattening;
use crate::layers::closed_intervals;
use crate::smoothing::Smoothing;

/// A voxel.
pub type Voxel = [i32; 3];

/// The columns along x, y and z, by line and place.
pub type Columns<const K: usize> = [Vec<Column<K>>; 3];

/// A column's name: the number of its axis, and its address.
pub type ColumnName = (usize, ColumnAddress);

/// A column changed by an edit, with its old value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ChangedColumn<const K: usize> {
    /// The column's name.
    pub name: ColumnName,
    /// Its old value.
    pub old: Column<K>,
}

/// The changes of an edit or a removal.
#[derive(Clone, Debug)]
pub struct VolumeChange<const K: usize> {
    /// The changed columns.
    pub columns: Vec<ChangedColumn<K>>,
    /// The voxels added.
    pub added: Vec<Voxel>,
    /// The voxels removed.
    pub removed: Vec<Voxel>,
    /// The voxels that the operation removed and closure restored.
    pub back: Vec<Voxel>,
}

/// A volume of K intervals a column.
#[derive(Clone, PartialEq, Debug)]
pub struct StepVolume<const K: usize> {
    voxels: Arc<DenseVolume>,
    columns: Columns<K>,
}

impl<const K: usize> StepVolume<K> {
    /// Returns an empty volume of `side`^3 voxels.
    pub fn empty(side: usize) -> Self {
        let columns = Axis::ALL.map(|_| vec![Column::EMPTY; side * side]);
        StepVolume { voxels: Arc::new(DenseVolume::empty(side)), columns }
    }

    /// Returns the volume of the given maps.
    pub fn from_maps<const N: usize>(maps: &RangeMaps<N, K>) -> Self {
        let columns =
            Axis::ALL.map(|axis| (0..N).flat_map(|line| *maps.line(axis, line)).collect());
        let mut volume = StepVolume { columns, ..StepVolume::empty(N) };
        let along_x = (0..N * N).map(|at| (Axis::X as usize, (at / N, at % N)));
        volume.intersect_along(along_x);
        volume
    }

    /// Returns the occupied voxels.
    pub fn voxels(&self) -> &Arc<DenseVolume> {
        &self.voxels
    }

    /// Returns all columns.
    pub fn columns(&self) -> &Columns<K> {
        &self.columns
    }

    /// Returns a column.
    pub fn column(&self, (axis, (line, place)): ColumnName) -> Column<K> {
        self.columns[axis][line * self.voxels.side() + place]
    }

    /// Replaces all columns, as an undo does. Returns the names of those that differ.
    pub fn replace_columns(&mut self, columns: &Columns<K>) -> Vec<ColumnName> {
        let n = self.voxels.side();
        let mut changed = Vec::new();
        for (axis, (ours, theirs)) in self.columns.iter_mut().zip(columns).enumerate() {
            for (at, (ours, theirs)) in ours.iter_mut().zip(theirs).enumerate() {
                if ours != theirs {
                    *ours = *theirs;
                    changed.push((axis, (at / n, at % n)));
                }
            }
        }
        self.intersect_along(changed.iter().copied());
        changed
    }

    /// Applies an edit to the voxels of `brush`, which contains the mirror image if the edit is mirrored, and
    /// no voxel twice: the boolean operation, then closure.
    pub fn apply_edit(
        &mut self,
        mask: &DenseVolume,
        brush: &[Voxel],
        operation: EditOperation,
        is_mirrored: bool,
    ) -> (EditReport, VolumeChange<K>) {
        let mut report = EditReport::default();
        let mut flips = Vec::new();
        let mut filled = BTreeSet::new();
        for &voxel in brush {
            match self.verdict_on(voxel, operation, is_mirrored) {
                Verdict::Stays => {}
                Verdict::TooDeep => report.refused_by_depth += 1,
                Verdict::Flips if mask.contains(voxel) => report.refused_by_mask += 1,
                Verdict::Flips => {
                    flips.push(voxel);
                    if !self.voxels.contains(voxel) {
                        filled.insert(voxel);
                    }
                }
            }
        }
        let change = self.become_closure_of_flipped(&flips);
        report.removed = change.removed.len() as u32;
        report.added = filled.len() as u32;
        report.closed = change.added.iter().filter(|voxel| !filled.contains(*voxel)).count() as u32;
        report.refused_by_closure = change.back.len() as u32;
        report.closure_box = box_around(&change.back);
        (report, change)
    }

    /// Removes voxels as the end of an island pass does, then applies closure.
    pub fn remove_voxels(&mut self, voxels: &[Voxel]) -> VolumeChange<K> {
        self.become_closure_of_flipped(voxels)
    }

    /// Asserts that each interval is tight, and that a column with room for a gap has no empty voxel inside
    /// its hull.
    ///
    /// # Panics
    /// An invariant is violated.
    pub fn assert_tight_and_saturated(&self) {
        let n = self.voxels.side();
        for (axis, at) in
            Axis::ALL.into_iter().flat_map(|axis| (0..n * n).map(move |at| (axis, at)))
        {
            let occupied =
                |i: usize| self.voxels.contains(to_voxel(axis.voxel_at((at / n, at % n), i)));
            let intervals = intervals_of(&self.columns[axis as usize][at]);
            for &(first, last) in &intervals {
                assert!(occupied(first) && occupied(last), "{axis:?} {at} isn't tight");
                let solid = (first..=last).all(occupied);
                assert!(intervals.len() == K || solid || K == 1, "{axis:?} {at} isn't saturated");
            }
        }
    }

    /// Returns the effect of an operation on a voxel of its brush.
    fn verdict_on(&self, voxel: Voxel, operation: EditOperation, is_mirrored: bool) -> Verdict {
        let occupied = |at: Voxel| self.voxels.contains(at);
        match operation {
            EditOperation::Carve { .. } if !occupied(voxel) => Verdict::Stays,
            EditOperation::Carve { depth: ANY_DEPTH } => Verdict::Flips,
            EditOperation::Carve { depth } => {
                // Outside the grid counts as empty.
                Verdict::of_depth(is_any_within_steps(voxel, depth, |at| !occupied(at)))
            }
            EditOperation::Fill { .. } if occupied(voxel) => Verdict::Stays,
            EditOperation::Fill { depth: ANY_DEPTH } => Verdict::Flips,
            EditOperation::Fill { depth } => {
                Verdict::of_depth(is_any_within_steps(voxel, depth, |at| at[1] < 0 || occupied(at)))
            }
            EditOperation::Smooth { .. } => {
                let smoothing = Smoothing::of(operation, is_mirrored).expect("it smooths");
                let after = smoothing.is_occupied_after(&self.voxels, voxel);
                if after == occupied(voxel) { Verdict::Stays } else { Verdict::Flips }
            }
            EditOperation::Flatten { .. } => {
                let flattening = Flattening::of(operation, is_mirrored).expect("it flattens");
                let after = flattening.is_occupied_after(&self.voxels, voxel);
                if after == occupied(voxel) { Verdict::Stays } else { Verdict::Flips }
            }
        }
    }

    /// Flips voxels, then applies closure: the closure rule to columns through them, and then the
    /// intersection of all three.
    fn become_closure_of_flipped(&mut self, flips: &[Voxel]) -> VolumeChange<K> {
        let before = Arc::clone(&self.voxels);
        let mut touched = BTreeSet::new();
        for &voxel in flips {
            Arc::make_mut(&mut self.voxels).set(voxel, !before.contains(voxel));
            touched.extend(columns_through(voxel));
        }
        let mut columns = Vec::new();
        for &name in &touched {
            let old = self.column(name);
            let new = self.closed_column(name);
            if new != old {
                columns.push(ChangedColumn { name, old });
                let (axis, (line, place)) = name;
                self.columns[axis][line * before.side() + place] = new;
            }
        }
        let exact = Arc::clone(&self.voxels);
        self.intersect_along(touched.iter().copied());
        let mut change = VolumeChange { columns, added: vec![], removed: vec![], back: vec![] };
        let voxels = touched.iter().flat_map(|&name| self.voxels_of(name));
        for voxel in voxels.filter(|&voxel| {
            let held = self.voxels.contains(voxel);
            held != before.contains(voxel) || held != exact.contains(voxel)
        }) {
            let [was, is] = [&before, &self.voxels].map(|voxels| voxels.contains(voxel));
            match (was, is) {
                (false, true) => change.added.push(voxel),
                (true, false) => change.removed.push(voxel),
                _ => change.back.push(voxel),
            }
        }
        for voxels in [&mut change.added, &mut change.removed, &mut change.back] {
            // Each voxel was listed for its three columns.
            voxels.sort_unstable();
            voxels.dedup();
        }
        change
    }

    /// Returns the column of the present voxels by the closure rule.
    fn closed_column(&self, name: ColumnName) -> Column<K> {
        let bits: Vec<_> = self.voxels_of(name).map(|voxel| self.voxels.contains(voxel)).collect();
        let mut column = Column::EMPTY;
        let closed = closed_intervals(&bits, &intervals_of(&self.column(name)), K);
        for (i, (first, last)) in closed.into_iter().enumerate() {
            column.set_range(i, Range::new(first, last));
        }
        column
    }

    /// Sets the voxels of these columns to the intersection of all three columns through them.
    fn intersect_along(&mut self, names: impl Iterator<Item = ColumnName>) {
        for name in names {
            let is_empty = self.column(name) == Column::EMPTY;
            for voxel in self.voxels_of(name) {
                if is_empty && !self.voxels.contains(voxel) {
                    continue;
                }
                let holds = |name: &ColumnName| self.column(*name).contains(voxel[name.0] as usize);
                let held = columns_through(voxel).iter().all(holds);
                if self.voxels.contains(voxel) != held {
                    Arc::make_mut(&mut self.voxels).set(voxel, held);
                }
            }
        }
    }

    /// Returns the voxels of a column, empty ones included.
    fn voxels_of(&self, (axis, at): ColumnName) -> impl Iterator<Item = Voxel> + use<K> {
        (0..self.voxels.side()).map(move |i| to_voxel(Axis::ALL[axis].voxel_at(at, i)))
    }
}

/// The effect of an operation on a voxel of its brush.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Stays,
    Flips,
    /// It would flip, but lies deeper below the surface than the operation reaches, in steps.
    TooDeep,
}

impl Verdict {
    fn of_depth(within: bool) -> Self {
        if within { Verdict::Flips } else { Verdict::TooDeep }
    }
}

/// Returns `true` if a place at most `depth` six-neighbour steps away is wanted. The depth is capped at
/// [`SHELL_DEPTH`].
fn is_any_within_steps([x, y, z]: Voxel, depth: usize, wanted: impl Fn(Voxel) -> bool) -> bool {
    let depth = depth.min(SHELL_DEPTH) as i32;
    (-depth..=depth).any(|i| {
        let left = depth - i.abs();
        (-left..=left).any(|j| {
            let left = left - j.abs();
            (-left..=left).any(|k| wanted([x + i, y + j, z + k]))
        })
    })
}

/// Returns the three columns through a voxel.
fn columns_through(voxel: Voxel) -> [ColumnName; 3] {
    Axis::ALL.map(|axis| (axis as usize, axis.column_address(voxel.map(|i| i as usize))))
}

fn intervals_of<const K: usize>(column: &Column<K>) -> Vec<(usize, usize)> {
    column.intervals().map(|range| (range.first(), range.last())).collect()
}

fn to_voxel(place: [usize; 3]) -> Voxel {
    place.map(|i| i as i32)
}

fn box_around(voxels: &[Voxel]) -> VoxelBox {
    VoxelBox::new([0, 1, 2].map(|i| {
        let along = || voxels.iter().map(|voxel| voxel[i] as usize);
        along().min().zip(along().max()).map_or(Range::EMPTY, |(lo, hi)| Range::new(lo, hi))
    }))
}

/// Returns the voxels whose centres are in a brush, or in its mirror image if mirrored, each once.
pub(super) fn voxels_of_brush(brush: &Brush, side: usize, is_mirrored: bool) -> Vec<Voxel> {
    let mut voxels = Vec::new();
    for piece in brush.pieces() {
        let Some(bounds) = piece.bounds(side) else { continue };
        for y in bounds.lo[1]..=bounds.hi[1] {
            for z in bounds.lo[2]..=bounds.hi[2] {
                if let Some(row) = piece.x_range(y, z, side) {
                    voxels.extend((row.first()..=row.last()).map(|x| [x, y, z].map(|i| i as i32)));
                }
            }
        }
    }
    if is_mirrored {
        let mirrored: Vec<_> =
            voxels.iter().map(|&[x, y, z]| [side as i32 - 1 - x, y, z]).collect();
        voxels.extend(mirrored);
    }
    voxels.sort_unstable();
    voxels.dedup();
    voxels
}

/// Returns a length in subunits as voxels, rounded up.
pub(super) fn whole_voxels(subunits: i32) -> usize {
    (subunits as usize).div_ceil(SUBUNITS_PER_VOXEL as usize)
}
