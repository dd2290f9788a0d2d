//! Capacity of the undo ring, and its handling of invalid bytes.

use std::sync::Mutex;

use glam::IVec3;
use paros_core::Brush;
use paros_core::codec::ByteReader;
use paros_core::edit::{EditOperation, SUBUNITS_PER_VOXEL, UndoCounts};
use paros_core::limits::UNDO_ENTRIES;
use paros_core::volume::{Grid, Size};
use paros_models::save_to_bytes;
use paros_models::undo_harness::{IslandClearing, SphereEdit, UndoHarness, apply_stroke};

/// Each stroke changes every column. Asserts that at least two strokes can be undone.
fn check_worst_case<const N: usize>(harness: &Mutex<UndoHarness<N>>)
where
    Grid<N>: Size,
{
    let mut harness = harness.lock().unwrap();
    let everywhere = Brush::sphere(
        IVec3::splat(N as i32 * SUBUNITS_PER_VOXEL / 2),
        N as i32 * SUBUNITS_PER_VOXEL,
    );
    harness
        .volume
        .set_voxels(|plane| (0..N).for_each(|y| plane.layer_mut(y).fill(Grid::<N>::FULL)));
    let full = harness.volume.maps().clone();
    for _ in 0..4 {
        for operation in [EditOperation::Carve { depth: 1 }, EditOperation::Fill { depth: 4 }] {
            harness.undo.begin_stroke();
            assert!(harness.apply_edit(&everywhere, operation).unwrap().changed_volume());
        }
        assert!(harness.volume.maps() == &full, "filled up again");
    }
    assert!(harness.undo.undo_counts().undoable >= 2);
    assert!(harness.undo.undo_counts().undoable < 8, "every column is in every entry");
    harness.check_save_round_trip().unwrap();
    assert!(harness.try_undo_checked().unwrap() && harness.try_undo_checked().unwrap());
    harness.check_volume_equals(&full).unwrap();
    assert!(harness.try_redo_checked().unwrap() && harness.try_redo_checked().unwrap());
    harness.check_volume_equals(&full).unwrap();
}

#[test]
fn worst_case_16() {
    static HARNESS: Mutex<UndoHarness<16>> = Mutex::new(UndoHarness::new());
    check_worst_case(&HARNESS);
}

#[test]
fn worst_case_128() {
    static HARNESS: Mutex<UndoHarness<128>> = Mutex::new(UndoHarness::new());
    check_worst_case(&HARNESS);
}

#[test]
fn worst_case_256() {
    static HARNESS: Mutex<UndoHarness<256>> = Mutex::new(UndoHarness::new());
    check_worst_case(&HARNESS);
}

/// Typical strokes, a dent each: dozens can be undone, and never more than the table's length.
#[test]
fn dents() {
    static HARNESS: Mutex<UndoHarness<128>> = Mutex::new(UndoHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let mut history = harness.reset_to_block();
    for i in 0..300 {
        let touch =
            SphereEdit { at: [i * 7 % 128, 96, 4 + i * 11 % 120], radius: 14, fill: i % 3 == 0 };
        apply_stroke(&mut harness, &mut history, &[touch], IslandClearing::AtEnd);
    }
    let undoable = harness.undo.undo_counts().undoable;
    assert!((48..=UNDO_ENTRIES + 1).contains(&undoable), "{undoable} dents");
    history.drop_oldest_until_undoable(undoable);
    while let Some(maps) = history.undo() {
        assert!(harness.try_undo_checked().unwrap());
        harness.check_volume_equals(maps).unwrap();
    }
}

/// Strokes of a single voxel: the table's length is the limit.
#[test]
fn full_table() {
    static HARNESS: Mutex<UndoHarness<32>> = Mutex::new(UndoHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let mut history = harness.reset_to_block();
    for i in 0..(UNDO_ENTRIES as i32 + 50) {
        let touch = SphereEdit { at: [i % 32, 23, 2 + i / 32], radius: 0, fill: false };
        apply_stroke(&mut harness, &mut history, &[touch], IslandClearing::Never);
    }
    assert!(harness.undo.undo_counts().undoable <= UNDO_ENTRIES + 1);
    assert!(harness.undo.undo_counts().undoable > 20);
    harness.check_save_round_trip().unwrap();
}

/// Loads truncated or changed bytes: the result is an error without entries, or a ring that can be walked.
#[test]
fn bad_bytes() {
    static HARNESS: Mutex<UndoHarness<16>> = Mutex::new(UndoHarness::new());
    let mut harness = HARNESS.lock().unwrap();
    let mut history = harness.reset_to_block();
    for i in 0..5 {
        let touch = SphereEdit { at: [3 * i, 10, 8], radius: 4, fill: i == 3 };
        apply_stroke(&mut harness, &mut history, &[touch], IslandClearing::AtEnd);
    }
    let bytes = save_to_bytes(|out| harness.undo.save(out));
    for len in 0..bytes.len() {
        assert!(harness.undo.load(&mut ByteReader::new(&bytes[..len])).is_err(), "cut at {len}");
        assert_eq!(harness.undo.undo_counts(), UndoCounts { undoable: 0, redoable: 0 });
    }
    let mut refused = 0;
    for at in 0..bytes.len() {
        for flip in [1, 2, 8, 64, 255] {
            let mut bytes = bytes.clone();
            bytes[at] ^= flip;
            match harness.undo.load(&mut ByteReader::new(&bytes)) {
                Ok(()) => {
                    assert_eq!(harness.undo.digest(), harness.undo.recompute_digest());
                    while harness.try_undo_checked().unwrap() {}
                    while harness.try_redo_checked().unwrap() {}
                }
                Err(error) => {
                    assert!(error.offset() <= bytes.len());
                    assert_eq!(harness.undo.undo_counts(), UndoCounts { undoable: 0, redoable: 0 });
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > bytes.len(), "most flips are refused, not {refused}");
}
