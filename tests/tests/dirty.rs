//! Dirty rectangles: what they leave out hasn't changed, and they aren't much larger than it.

use std::sync::{Mutex, PoisonError};

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::dirty::{Dirty, Rect};
use paros_core::edit::{Edit, EditScratch, Operation, apply};
use paros_core::limits::DIRTY_RECTS;
use paros_core::maps::{Axis, Maps};
use paros_core::pose::SUB;
use paros_core::volume::Volume;
use paros_tests::models::dense::volumes;
use proptest::prelude::*;

struct Studio {
    volume: Volume<16>,
    mask: Maps<16>,
    scratch: EditScratch<16>,
    /// What a view that only follows dirty rectangles holds.
    stale: Maps<16>,
    before: Maps<16>,
}

static STUDIO: Mutex<Studio> = Mutex::new(Studio {
    volume: Volume::new(),
    mask: Maps::new(),
    scratch: EditScratch::new(),
    stale: Maps::new(),
    before: Maps::new(),
});

/// The bounding rectangle of the columns in which two maps differ.
fn changed(axis: Axis, a: &Maps<16>, b: &Maps<16>) -> Option<Rect> {
    let all = (0..16 * 16).map(|i| (i / 16, i % 16));
    let differing = all.filter(|&at| a.column(axis, at) != b.column(axis, at));
    differing.map(Rect::at).reduce(Rect::union)
}

fn area(rects: &[Rect]) -> u32 {
    rects.iter().map(|rect| rect.area()).sum()
}

/// Centre, radius, depth and whether it is mirrored.
type Ball = ([i32; 3], i32, usize, bool);

/// Ticks of several edits, each a ball.
fn ticks() -> impl Strategy<Value = Vec<Vec<Ball>>> {
    let edit = ([0..16 * SUB, 0..16 * SUB, 0..16 * SUB], 0..6 * SUB, 0..3usize, any::<bool>());
    proptest::collection::vec(proptest::collection::vec(edit, 0..12), 1..4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn a_stale_copy_follows(start in volumes(16), ticks in ticks()) {
        let studio = &mut *STUDIO.lock().unwrap_or_else(PoisonError::into_inner);
        let Studio { volume, mask, scratch, stale, before } = studio;
        volume.set_voxels(|plane| start.write_plane(plane));
        stale.copy_from(volume.maps());
        let mut dirty = Dirty::new();
        for tick in ticks {
            dirty.clear();
            prop_assert!(dirty.is_empty());
            before.copy_from(volume.maps());
            let edits = tick.len();
            for (at, radius, kind, mirrored) in tick {
                let operation = [Operation::Carve { depth: 2 }, Operation::Fill { depth: 2 }, Operation::Smooth][kind];
                let brush = Brush::sphere(IVec3::from_array(at), radius);
                let edit = Edit { brush: &brush, operation, mirrored };
                // A ball across a grid of 16 can be too large to smooth: then nothing changes.
                let _ = apply(volume, mask, &edit, scratch, &mut dirty);
                dirty.close();
            }
            for axis in Axis::ALL {
                let rects = dirty.rects(axis);
                for rect in rects {
                    for line in rect.lo.0..=rect.hi.0 {
                        let line = usize::from(line);
                        for place in usize::from(rect.lo.1)..=rect.hi.1.into() {
                            stale.set_column(axis, (line, place), volume.maps().column(axis, (line, place)));
                        }
                    }
                }
                let bounds = changed(axis, before, volume.maps());
                if let Some(bounds) = bounds {
                    let whole = rects.iter().copied().reduce(Rect::union).expect("a change is dirty");
                    prop_assert_eq!(whole.union(bounds), whole);
                    if edits == 1 {
                        prop_assert_eq!(rects, &[bounds], "one edit is its bounds");
                    }
                }
                // Edits may undo one another: bound the area by what was noted.
                if let Some(whole) = rects.iter().copied().reduce(Rect::union) {
                    prop_assert!(area(rects) <= 4 * whole.area(), "{:?}", rects);
                }
            }
            prop_assert_eq!(&*stale, volume.maps());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Any edits at all, more than there is room for: nothing is lost, nothing grows beyond four
    /// times the bounds.
    #[test]
    fn more_edits_than_room_merge(
        edits in proptest::collection::vec(
            proptest::collection::vec((0..3usize, 0..256usize, 0..256usize), 0..5), 0..4 * DIRTY_RECTS),
    ) {
        let mut dirty = Dirty::new();
        for edit in &edits {
            edit.iter().for_each(|&(axis, line, place)| dirty.note(Axis::ALL[axis], (line, place)));
            dirty.close();
        }
        for axis in Axis::ALL {
            let rects = dirty.rects(axis);
            let noted: Vec<_> = edits.iter().flatten().filter(|note| Axis::ALL[note.0] == axis).collect();
            for &&(_, line, place) in &noted {
                prop_assert!(rects.iter().any(|rect| rect.contains((line, place))), "{}, {} lost", line, place);
            }
            let bounds = noted.iter().map(|&&(_, line, place)| Rect::at((line, place))).reduce(Rect::union);
            prop_assert_eq!(bounds, rects.iter().copied().reduce(Rect::union));
            if let Some(bounds) = bounds {
                prop_assert!(area(rects) <= 4 * bounds.area(), "{:?}", rects);
            }
        }
        prop_assert_eq!(dirty.is_empty(), edits.iter().all(Vec::is_empty));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Edits that overlap, up to all over one another.
    #[test]
    fn overlapping_edits_stay_within_four_times_their_bounds(
        edits in proptest::collection::vec(
            (0..40usize, 0..40usize, 120..200usize, 120..200usize), 0..3 * DIRTY_RECTS),
    ) {
        let mut dirty = Dirty::new();
        for &(line, place, lines, places) in &edits {
            dirty.note(Axis::Y, (line, place));
            dirty.note(Axis::Y, (line + lines - 1, place + places - 1));
            dirty.close();
        }
        let rects = dirty.rects(Axis::Y);
        let at = |&(line, place, lines, places): &(usize, usize, usize, usize)| {
            Rect::at((line, place)).union(Rect::at((line + lines - 1, place + places - 1)))
        };
        for edit in edits.iter().map(at) {
            prop_assert!(rects.iter().any(|rect| rect.union(edit) == *rect), "{:?} lost", edit);
        }
        if let Some(bounds) = edits.iter().map(at).reduce(Rect::union) {
            prop_assert!(area(rects) <= 4 * bounds.area(), "{:?}", rects);
        }
    }
}

#[test]
fn the_same_edit_over_and_over_is_one_rectangle() {
    let mut dirty = Dirty::new();
    for _ in 0..5 {
        dirty.note(Axis::Z, (2, 3));
        dirty.note(Axis::Z, (9, 7));
        dirty.close();
    }
    assert_eq!(dirty.rects(Axis::Z), [Rect { lo: (2, 3), hi: (9, 7) }]);
}

#[test]
fn everything_is_one_rectangle() {
    let mut dirty = Dirty::new();
    dirty.note(Axis::X, (3, 4));
    dirty.note_all(256);
    for axis in Axis::ALL {
        assert_eq!(dirty.rects(axis), [Rect { lo: (0, 0), hi: (255, 255) }]);
        assert_eq!(dirty.rects(axis)[0].area(), 1 << 16);
    }
}
