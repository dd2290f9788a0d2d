//! Edits as the definition has them: an exact boolean operation on voxels, then closure.

use paros_core::edit::{EditReport, Operation};
use paros_core::maps::Axis;

use super::dense::Dense;

/// The volume after an edit of the voxels of `brush`, and what happened to how many.
pub fn edited(
    volume: &Dense,
    mask: &Dense,
    brush: &Dense,
    operation: Operation,
    mirrored: bool,
) -> (Dense, EditReport) {
    let brush = if mirrored { brush.or(&brush.mirrored()) } else { brush.clone() };
    let none = Dense::new(volume.n());
    let (removed, filled, too_deep) = match operation {
        Operation::Carve { depth } => {
            let wanted = brush.and(volume);
            let reached = wanted.and(&volume.near_empty(depth));
            (reached.clone(), none, wanted.without(&reached))
        }
        Operation::Fill { depth } => {
            let wanted = brush.without(volume);
            let reached = wanted.and(&volume.near_occupied(depth));
            (none, reached.clone(), wanted.without(&reached))
        }
        Operation::Smooth => {
            let most = majority(volume);
            let removed = brush.and(volume).without(&most);
            (removed, brush.and(&most).without(volume), none)
        }
    };
    let after = volume.without(&removed.without(mask)).or(&filled).closure();
    let report = EditReport {
        removed: volume.without(&after).count(),
        added: filled.count(),
        closed: after.without(volume).without(&filled).count(),
        refused_by_mask: removed.and(mask).count(),
        refused_by_depth: too_deep.count(),
        refused_by_closure: removed.without(mask).and(&after).count(),
    };
    (after, report)
}

/// What the design promises of every edit, said without the definition.
pub fn stays_in_reach(
    volume: &Dense,
    mask: &Dense,
    after: &Dense,
    brush: &Dense,
    operation: Operation,
    mirrored: bool,
) {
    let brush = if mirrored { brush.or(&brush.mirrored()) } else { brush.clone() };
    assert!(mask.is_within(after), "a masked voxel is lost");
    assert!(volume.without(after).is_within(&brush), "a voxel beside the brush was removed");
    let added = after.without(volume);
    match operation {
        Operation::Carve { .. } => assert!(added.is_empty(), "a carve added"),
        Operation::Fill { .. } => assert!(volume.is_within(after), "a fill removed"),
        Operation::Smooth => {}
    }
    let held = Axis::ALL.map(|axis| {
        move |brush: &Dense, voxel: [i32; 3]| {
            brush.hull(axis, axis.address(voxel.map(|i| i as usize))).is_some()
        }
    });
    for voxel in added.occupied() {
        assert!(held.iter().any(|held| held(&brush, voxel)), "{voxel:?} is in no beam");
    }
    if mirrored && volume == &volume.mirrored() && mask == &mask.mirrored() {
        assert_eq!(after, &after.mirrored(), "the mirror is broken");
    }
}

/// The voxels whose 27 neighbours, themselves among them, are mostly occupied.
fn majority(volume: &Dense) -> Dense {
    Dense::from_fn(volume.n(), |[x, y, z]| {
        let mut occupied = 0;
        for k in 0..27 {
            let place = [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1];
            let inside = (0..3).all(|i| (0..volume.n() as i32).contains(&place[i]));
            occupied += i32::from(place[1] < 0 || inside && volume.contains(place));
        }
        occupied >= 14
    })
}
