//! Dirty rectangles: no column outside them has changed, and their area is bounded by the area of the
//! changes.

use std::sync::{Mutex, PoisonError};

use glam::IVec3;
use paros_core::edit::{EditOperation, EditScratch, SUBUNITS_PER_VOXEL};
use paros_core::limits::MAX_DIRTY_RECTS;
use paros_core::volume::{Axis, ColumnRect, DirtyRects};
use paros_core::{Brush, Edit, RangeMaps, Volume, apply_edit};
use paros_models::cases::random_cases;
use paros_models::dense::closed_volumes;
use proptest::prelude::*;

struct DirtyHarness {
    volume: Volume<16>,
    mask: RangeMaps<16>,
    scratch: EditScratch<16>,
    /// The maps of a view that copies only dirty rectangles.
    stale: RangeMaps<16>,
    before: RangeMaps<16>,
}

static HARNESS: Mutex<DirtyHarness> = Mutex::new(DirtyHarness {
    volume: Volume::new(),
    mask: RangeMaps::new(),
    scratch: EditScratch::new(),
    stale: RangeMaps::new(),
    before: RangeMaps::new(),
});

/// Returns the bounding rectangle of the columns in which two maps differ.
fn changed_rect(axis: Axis, a: &RangeMaps<16>, b: &RangeMaps<16>) -> Option<ColumnRect> {
    let all = (0..16 * 16).map(|i| (i / 16, i % 16));
    let differing = all.filter(|&at| a.column(axis, at) != b.column(axis, at));
    differing.map(ColumnRect::of_column).reduce(ColumnRect::union)
}

fn total_area(rects: &[ColumnRect]) -> u32 {
    rects.iter().map(|rect| rect.area()).sum()
}

/// Centre, radius, depth, and `true` if mirrored.
type Ball = ([i32; 3], i32, usize, bool);

/// A strategy for ticks of several edits, each a ball.
fn any_ticks() -> impl Strategy<Value = Vec<Vec<Ball>>> {
    let edit = (
        [0..16 * SUBUNITS_PER_VOXEL, 0..16 * SUBUNITS_PER_VOXEL, 0..16 * SUBUNITS_PER_VOXEL],
        0..6 * SUBUNITS_PER_VOXEL,
        0..3usize,
        any::<bool>(),
    );
    proptest::collection::vec(proptest::collection::vec(edit, 0..12), 1..4)
}

proptest! {
    #![proptest_config(random_cases(150))]

    #[test]
    fn a_stale_copy_follows(start in closed_volumes(16), ticks in any_ticks()) {
        let harness = &mut *HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
        let DirtyHarness { volume, mask, scratch, stale, before } = harness;
        volume.set_voxels(|plane| start.insert_into_empty_bits(plane));
        stale.copy_from(volume.maps());
        let mut dirty = DirtyRects::new();
        for tick in ticks {
            dirty.clear();
            prop_assert!(dirty.is_empty());
            before.copy_from(volume.maps());
            let edits = tick.len();
            for (at, radius, kind, mirrored) in tick {
                let operation = [EditOperation::Carve { depth: 2 }, EditOperation::Fill { depth: 2 }, EditOperation::Smooth { radius: 3, dither: None }][kind];
                let brush = Brush::sphere(IVec3::from_array(at), radius);
                let edit = Edit { brush: &brush, operation, mirrored };
                // A ball across a grid of 16 can be too large to smooth: then nothing changes.
                let _ = apply_edit(volume, mask, &edit, scratch, &mut dirty);
                dirty.end_edit();
            }
            for axis in Axis::ALL {
                let rects = dirty.rects(axis);
                for rect in rects {
                    for line in rect.first.0..=rect.last.0 {
                        let line = usize::from(line);
                        for place in usize::from(rect.first.1)..=rect.last.1.into() {
                            stale.set_column(axis, (line, place), volume.maps().column(axis, (line, place)));
                        }
                    }
                }
                let bounds = changed_rect(axis, before, volume.maps());
                if let Some(bounds) = bounds {
                    let whole = rects.iter().copied().reduce(ColumnRect::union).expect("a change is dirty");
                    prop_assert_eq!(whole.union(bounds), whole);
                    if edits == 1 {
                        prop_assert_eq!(rects, &[bounds], "one edit is its bounds");
                    }
                }
                // Edits may cancel each other, so the area is compared with that of the reported rectangles.
                if let Some(whole) = rects.iter().copied().reduce(ColumnRect::union) {
                    prop_assert!(total_area(rects) <= 4 * whole.area(), "{:?}", rects);
                }
            }
            prop_assert_eq!(&*stale, volume.maps());
        }
    }
}

proptest! {
    #![proptest_config(random_cases(400))]

    /// More edits than fit in the list: no change is lost, and the area stays within four times the bounds.
    #[test]
    fn more_edits_than_room_merge(
        edits in proptest::collection::vec(
            proptest::collection::vec((0..3usize, 0..256usize, 0..256usize), 0..5), 0..4 * MAX_DIRTY_RECTS),
    ) {
        let mut dirty = DirtyRects::new();
        for edit in &edits {
            edit.iter().for_each(|&(axis, line, place)| dirty.mark_column(Axis::ALL[axis], (line, place)));
            dirty.end_edit();
        }
        for axis in Axis::ALL {
            let rects = dirty.rects(axis);
            let noted: Vec<_> = edits.iter().flatten().filter(|note| Axis::ALL[note.0] == axis).collect();
            for &&(_, line, place) in &noted {
                prop_assert!(rects.iter().any(|rect| rect.contains((line, place))), "{}, {} lost", line, place);
            }
            let bounds = noted.iter().map(|&&(_, line, place)| ColumnRect::of_column((line, place))).reduce(ColumnRect::union);
            prop_assert_eq!(bounds, rects.iter().copied().reduce(ColumnRect::union));
            if let Some(bounds) = bounds {
                prop_assert!(total_area(rects) <= 4 * bounds.area(), "{:?}", rects);
            }
        }
        prop_assert_eq!(dirty.is_empty(), edits.iter().all(Vec::is_empty));
    }
}

proptest! {
    #![proptest_config(random_cases(400))]

    /// Edits that overlap, up to complete overlap.
    #[test]
    fn overlapping_edits_stay_within_four_times_their_bounds(
        edits in proptest::collection::vec(
            (0..40usize, 0..40usize, 120..200usize, 120..200usize), 0..3 * MAX_DIRTY_RECTS),
    ) {
        let mut dirty = DirtyRects::new();
        for &(line, place, lines, places) in &edits {
            dirty.mark_column(Axis::Y, (line, place));
            dirty.mark_column(Axis::Y, (line + lines - 1, place + places - 1));
            dirty.end_edit();
        }
        let rects = dirty.rects(Axis::Y);
        let at = |&(line, place, lines, places): &(usize, usize, usize, usize)| {
            ColumnRect::of_column((line, place)).union(ColumnRect::of_column((line + lines - 1, place + places - 1)))
        };
        for edit in edits.iter().map(at) {
            prop_assert!(rects.iter().any(|rect| rect.union(edit) == *rect), "{:?} lost", edit);
        }
        if let Some(bounds) = edits.iter().map(at).reduce(ColumnRect::union) {
            prop_assert!(total_area(rects) <= 4 * bounds.area(), "{:?}", rects);
        }
    }
}

#[test]
fn the_same_edit_over_and_over_is_one_rectangle() {
    let mut dirty = DirtyRects::new();
    for _ in 0..5 {
        dirty.mark_column(Axis::Z, (2, 3));
        dirty.mark_column(Axis::Z, (9, 7));
        dirty.end_edit();
    }
    assert_eq!(dirty.rects(Axis::Z), [ColumnRect { first: (2, 3), last: (9, 7) }]);
}

#[test]
fn everything_is_one_rectangle() {
    let mut dirty = DirtyRects::new();
    dirty.mark_column(Axis::X, (3, 4));
    dirty.mark_all(256);
    for axis in Axis::ALL {
        assert_eq!(dirty.rects(axis), [ColumnRect { first: (0, 0), last: (255, 255) }]);
        assert_eq!(dirty.rects(axis)[0].area(), 1 << 16);
    }
}
