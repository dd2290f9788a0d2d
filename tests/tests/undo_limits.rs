//! How much the undo ring holds, and what it makes of bytes that are no ring.

use std::sync::Mutex;

use glam::IVec3;
use paros_core::brush::Brush;
use paros_core::codec::Reader;
use paros_core::edit::Operation;
use paros_core::limits::UNDO_ENTRIES;
use paros_core::pose::SUB;
use paros_core::size::{Grid, Size};
use paros_tests::models::saved;
use paros_tests::models::undo_bench::{Bench, Clear, Touch, stroke};

/// Each stroke changes every column. Two are always there to be undone.
fn worst_case<const N: usize>(bench: &Mutex<Bench<N>>)
where
    Grid<N>: Size,
{
    let mut bench = bench.lock().unwrap();
    let everywhere = Brush::sphere(IVec3::splat(N as i32 * SUB / 2), N as i32 * SUB);
    bench.volume.set_voxels(|plane| (0..N).for_each(|y| plane.layer_mut(y).fill(Grid::<N>::FULL)));
    let full = bench.volume.maps().clone();
    for _ in 0..4 {
        for operation in [Operation::Carve { depth: 1 }, Operation::Fill { depth: 4 }] {
            bench.undo.begin_stroke();
            assert!(bench.edit(&everywhere, operation));
        }
        assert!(bench.volume.maps() == &full, "filled up again");
    }
    assert!(bench.undo.counts().0 >= 2);
    assert!(bench.undo.counts().0 < 8, "every column is in every entry");
    bench.check_saved().unwrap();
    assert!(bench.step(true).unwrap() && bench.step(true).unwrap());
    bench.check(&full).unwrap();
    assert!(bench.step(false).unwrap() && bench.step(false).unwrap());
    bench.check(&full).unwrap();
}

#[test]
fn worst_case_16() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    worst_case(&BENCH);
}

#[test]
fn worst_case_128() {
    static BENCH: Mutex<Bench<128>> = Mutex::new(Bench::new());
    worst_case(&BENCH);
}

#[test]
fn worst_case_256() {
    static BENCH: Mutex<Bench<256>> = Mutex::new(Bench::new());
    worst_case(&BENCH);
}

/// Usual strokes, a dent each: dozens can be undone, and never more than the table holds.
#[test]
fn dents() {
    static BENCH: Mutex<Bench<128>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let mut history = bench.reset();
    for i in 0..300 {
        let touch = Touch { at: [i * 7 % 128, 96, 4 + i * 11 % 120], radius: 14, fill: i % 3 == 0 };
        stroke(&mut bench, &mut history, &[touch], Clear::AtEnd);
    }
    let (undoable, _) = bench.undo.counts();
    assert!((48..=UNDO_ENTRIES + 1).contains(&undoable), "{undoable} dents");
    history.forget(undoable);
    while let Some(maps) = history.undo() {
        assert!(bench.step(true).unwrap());
        bench.check(maps).unwrap();
    }
}

/// Single voxels: the table's length is the limit.
#[test]
fn full_table() {
    static BENCH: Mutex<Bench<32>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let mut history = bench.reset();
    for i in 0..(UNDO_ENTRIES as i32 + 50) {
        let touch = Touch { at: [i % 32, 23, 2 + i / 32], radius: 0, fill: false };
        stroke(&mut bench, &mut history, &[touch], Clear::Never);
    }
    assert!(bench.undo.counts().0 <= UNDO_ENTRIES + 1);
    assert!(bench.undo.counts().0 > 20);
    bench.check_saved().unwrap();
}

/// Cut short or with bytes changed: an error and no entries, or a ring that can be walked.
#[test]
fn bad_bytes() {
    static BENCH: Mutex<Bench<16>> = Mutex::new(Bench::new());
    let mut bench = BENCH.lock().unwrap();
    let mut history = bench.reset();
    for i in 0..5 {
        let touch = Touch { at: [3 * i, 10, 8], radius: 4, fill: i == 3 };
        stroke(&mut bench, &mut history, &[touch], Clear::AtEnd);
    }
    let bytes = saved(|out| bench.undo.save(out));
    for len in 0..bytes.len() {
        assert!(bench.undo.load(&mut Reader::new(&bytes[..len])).is_err(), "cut at {len}");
        assert_eq!(bench.undo.counts(), (0, 0));
    }
    let mut refused = 0;
    for at in 0..bytes.len() {
        for flip in [1, 2, 8, 64, 255] {
            let mut bytes = bytes.clone();
            bytes[at] ^= flip;
            match bench.undo.load(&mut Reader::new(&bytes)) {
                Ok(()) => {
                    assert_eq!(bench.undo.digest(), bench.undo.recompute_digest());
                    while bench.step(true).unwrap() {}
                    while bench.step(false).unwrap() {}
                }
                Err(error) => {
                    assert!(error.offset <= bytes.len());
                    assert_eq!(bench.undo.counts(), (0, 0));
                    refused += 1;
                }
            }
        }
    }
    assert!(refused > bytes.len(), "most flips are refused, not {refused}");
}
