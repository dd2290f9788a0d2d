//! Model of an edit: a boolean operation on the voxels within the brush, then closure, by its naive
//! definition.

use paros_core::edit::{ANY_DEPTH, EditOperation, EditReport};
use paros_core::volume::Axis;

use crate::dense::DenseVolume;
use crate::flattening::Flattening;
use crate::smoothing::Smoothing;

/// The expected result of an edit.
#[derive(Clone, Debug)]
pub struct ExpectedEdit {
    /// The volume afterwards.
    pub after: DenseVolume,
    /// The counts.
    pub report: EditReport,
}

/// Returns the volume after an edit of the voxels of `brush`, and the counts of its report.
pub fn expected_edit(
    volume: &DenseVolume,
    mask: &DenseVolume,
    brush: &DenseVolume,
    operation: EditOperation,
    mirrored: bool,
) -> ExpectedEdit {
    let edit = exact_edit(volume, mask, brush, operation, mirrored);
    let after = edit.exact.closure();
    let report = edit.expected_report(volume, &after);
    ExpectedEdit { after, report }
}

/// An edit before closure.
#[derive(Clone, Debug)]
pub struct ExactEdit {
    /// The voxels after the operation, without closure.
    pub exact: DenseVolume,
    filled: DenseVolume,
    refused_by_mask: u32,
    refused_by_depth: u32,
}

impl ExactEdit {
    /// Returns the counts of the report if closure of the exact voxels turns `before` into `after`.
    pub fn expected_report(&self, before: &DenseVolume, after: &DenseVolume) -> EditReport {
        let back = before.difference(&self.exact).intersection(after);
        EditReport {
            removed: before.difference(after).count(),
            added: self.filled.count(),
            closed: after.difference(before).difference(&self.filled).count(),
            refused_by_mask: self.refused_by_mask,
            refused_by_depth: self.refused_by_depth,
            refused_by_closure: back.count(),
            closure_box: back.bounding_box(),
            dropped_ticks: 0,
        }
    }
}

/// Applies the boolean operation of an edit, without closure.
pub fn exact_edit(
    volume: &DenseVolume,
    mask: &DenseVolume,
    brush: &DenseVolume,
    operation: EditOperation,
    mirrored: bool,
) -> ExactEdit {
    let brush = if mirrored { brush.union(&brush.mirrored_in_x()) } else { brush.clone() };
    let none = DenseVolume::empty(volume.side());
    let (removed, filled, too_deep) = match operation {
        EditOperation::Carve { depth: ANY_DEPTH } => {
            (brush.intersection(volume), none.clone(), none)
        }
        EditOperation::Fill { depth: ANY_DEPTH } => (none.clone(), brush.difference(volume), none),
        EditOperation::Carve { depth } => {
            let wanted = brush.intersection(volume);
            let reached = wanted.intersection(&volume.within_steps_of_empty(depth));
            (reached.clone(), none, wanted.difference(&reached))
        }
        EditOperation::Fill { depth } => {
            let wanted = brush.difference(volume);
            let reached = wanted.intersection(&volume.within_steps_of_occupied(depth));
            (none, reached.clone(), wanted.difference(&reached))
        }
        EditOperation::Smooth { .. } | EditOperation::Flatten { .. } => {
            let smoothing = Smoothing::of(operation, mirrored);
            let flattening = Flattening::of(operation, mirrored);
            let mut after = none;
            for voxel in brush.occupied() {
                let smooth = smoothing.is_some_and(|rule| rule.is_occupied_after(volume, voxel));
                let flat = flattening.is_some_and(|rule| rule.is_occupied_after(volume, voxel));
                after.set(voxel, smooth || flat);
            }
            let removed = brush.intersection(volume).difference(&after);
            (removed, after.difference(volume), DenseVolume::empty(volume.side()))
        }
    };
    ExactEdit {
        exact: volume.difference(&removed.difference(mask)).union(&filled),
        filled,
        refused_by_mask: removed.intersection(mask).count(),
        refused_by_depth: too_deep.count(),
    }
}

/// Asserts the invariants of every edit, independently of its definition: the mask stays, nothing outside the
/// brush is removed, and additions lie in columns that cross the brush.
///
/// # Panics
/// An invariant is violated.
pub fn assert_edit_invariants(
    before: &DenseVolume,
    mask: &DenseVolume,
    brush: &DenseVolume,
    operation: EditOperation,
    mirrored: bool,
    after: &DenseVolume,
) {
    let brush = if mirrored { brush.union(&brush.mirrored_in_x()) } else { brush.clone() };
    assert!(mask.is_within(after), "a masked voxel is lost");
    assert!(before.difference(after).is_within(&brush), "a voxel beside the brush was removed");
    let added = after.difference(before);
    match operation {
        EditOperation::Carve { .. } => assert!(added.is_empty(), "a carve added"),
        EditOperation::Fill { .. } => assert!(before.is_within(after), "a fill removed"),
        EditOperation::Smooth { .. } | EditOperation::Flatten { .. } => {}
    }
    let held = Axis::ALL.map(|axis| {
        move |brush: &DenseVolume, voxel: [i32; 3]| {
            brush.column_hull(axis, axis.column_address(voxel.map(|i| i as usize))).is_some()
        }
    });
    for voxel in added.occupied() {
        assert!(held.iter().any(|held| held(&brush, voxel)), "{voxel:?} is in no beam");
    }
}

/// Asserts that a mirrored edit of a symmetric volume leaves a symmetric volume. This holds only for one
/// interval a column: with several intervals, the rule prefers the lower of two runs of equal length.
///
/// # Panics
/// The result isn't symmetric.
pub fn assert_mirror_is_kept(before: &DenseVolume, mask: &DenseVolume, after: &DenseVolume) {
    if before == &before.mirrored_in_x() && mask == &mask.mirrored_in_x() {
        assert_eq!(after, &after.mirrored_in_x(), "the mirror is broken");
    }
}
