//! Saves with a valid checksum that break one invariant are rejected, with the place of the fault.
//!
//! Planted faults (tried by hand), each caught by the test of its name: the applied or the undone entries
//! aren't walked; the rows aren't rebuilt after an entry; the box of its changes lacks a layer; saturation or
//! the mask isn't checked; a search may lack ground, mask or a row beside a reached row; a bench may have two
//! tools in a hand; a frozen pose may lack a rotation.

use std::sync::{Mutex, PoisonError};

use paros_core::codec::{BadBytes, BadSave};
use paros_core::internals::{BENCH_ITEMS, ByteWriter};
use paros_core::session::{SessionMode, ToolBit, commands};
use paros_core::volume::{Axis, BitSet, Column, Range};
use paros_core::{TickInput, World};
use paros_models::random_visitor::RandomVisitor;
use paros_models::save_layout::{BODY, MAPS, SaveLayout, save_to_vec, write_checksum};
use paros_models::world_harness::WorldHarness;

const N: usize = 16;

type Harness<const K: usize> = Mutex<WorldHarness<N, K>>;

const TIGHT: &str = "tight ranges";
const SATURATED: &str = "a column without empty voxels where a gap has room";

fn load_forged<const K: usize>(world: &mut World<N, K>, bytes: &mut [u8]) -> Result<(), BadSave> {
    write_checksum(bytes);
    world.load(bytes)
}

fn expected_value(refused: Result<(), BadSave>) -> &'static str {
    match refused {
        Err(BadSave::Value(BadBytes { expected, .. })) => expected,
        other => panic!("{other:?}"),
    }
}

fn command(commands: u8) -> TickInput {
    TickInput { commands, ..TickInput::default() }
}

/// Sculpts until four strokes can be undone, and lets the hands rest.
fn sculpt<const K: usize>(harness: &mut WorldHarness<N, K>, mode: SessionMode, seed: u64) {
    harness.start_session(mode);
    let mut visitor = RandomVisitor::new(seed);
    while harness.world.undo_counts().undoable < 4 || harness.world.undo_counts().redoable > 0 {
        harness.step(&visitor.next_input());
    }
    (0..20).for_each(|_| harness.step(&TickInput::default()));
}

/// Forges values of each entry by `change`, one at a time, and counts the saves rejected as `expected` for
/// the changed column. No other error may name the entry's own column.
fn count_refused<const K: usize>(
    harness: &mut WorldHarness<N, K>,
    expected: &'static str,
    change: impl Fn(Axis, Column<K>) -> Option<Column<K>>,
) -> Vec<usize> {
    let bytes = save_to_vec(&harness.world);
    let layout = SaveLayout::of::<N, K>(&bytes).expect("a save");
    let mut counts = Vec::new();
    for entry in 0..layout.entries.len() {
        let offset = layout.entries[entry].start;
        let columns = layout.columns_of_entry::<N, K>(&bytes, entry);
        let mut is_refused = |&(axis, address, at): &(Axis, (usize, usize), usize)| {
            let saved = *bytes[at..].as_chunks::<2>().0.first_chunk().expect("a column");
            let column = Column::from_bytes(saved, N).expect("a column that was saved");
            let Some(changed) = change(axis, column) else { return false };
            let mut forged = bytes.clone();
            forged[at..at + 2 * K].copy_from_slice(changed.to_bytes().as_flattened());
            let bad = BadBytes { offset, expected };
            let refused = load_forged(&mut harness.world, &mut forged);
            refused == Err(BadSave::Entry { entry, bad, axis, address })
        };
        counts.push(columns.iter().filter(|column| is_refused(column)).count());
    }
    assert_eq!(harness.world.load(&bytes), Ok(()));
    counts
}

/// Returns the column with its last voxel moved one farther.
fn lengthened<const K: usize>(mut column: Column<K>) -> Option<Column<K>> {
    let (i, last) = column.intervals().enumerate().last()?;
    if last.last() + 1 == N {
        return None;
    }
    column.set_range(i, Range::new(last.first(), last.last() + 1));
    Some(column)
}

fn check_loosened<const K: usize>(harness: &Harness<K>) {
    let harness = &mut harness.lock().unwrap_or_else(PoisonError::into_inner);
    for undone in [0, 2, 4] {
        sculpt(harness, SessionMode::FreeForm, 5);
        (0..undone).for_each(|_| harness.step(&command(commands::UNDO)));
        let counts = count_refused(harness, TIGHT, |_, column| lengthened(column));
        let named = counts.iter().filter(|count| **count > 0).count();
        assert!(named >= 3, "{undone} undone: {counts:?}");
    }
}

#[test]
fn an_entry_that_loosens_a_column_is_named() {
    static ONE: Harness<1> = Mutex::new(WorldHarness::new());
    static TWO: Harness<2> = Mutex::new(WorldHarness::new());
    check_loosened(&ONE);
    check_loosened(&TWO);
    let bad = BadBytes { offset: 812, expected: TIGHT };
    let bad = BadSave::Entry { entry: 3, bad, axis: Axis::Z, address: (7, 9) };
    assert_eq!(bad.offset(), 812);
    let text = "expected tight ranges of the volume that undo entry 3 leads to, at byte 812 \
                (column along Z, line 7, place 9)";
    assert_eq!(bad.to_string(), text);
}

#[test]
fn an_entry_that_leaves_a_column_unsaturated_is_named() {
    static TWO: Harness<2> = Mutex::new(WorldHarness::new());
    let harness = &mut TWO.lock().unwrap_or_else(PoisonError::into_inner);
    let mut refused = [0; 3];
    for seed in 0..20 {
        sculpt(harness, SessionMode::FreeForm, seed);
        for (axis, refused) in Axis::ALL.into_iter().zip(&mut refused) {
            let closed = |of, column: Column<2>| {
                (of == axis && column.has_gaps()).then(|| Column::from_range(column.hull()))
            };
            *refused += count_refused(harness, SATURATED, closed).iter().sum::<usize>();
        }
    }
    let has_each = refused.iter().all(|count| *count > 0);
    assert!(has_each, "columns whose gap other columns leave empty, by axis: {refused:?}");
}

/// Makes the present volume the mask, so that a redo removes a part of the mask.
#[test]
fn an_entry_that_takes_the_mask_is_named() {
    static TWO: Harness<2> = Mutex::new(WorldHarness::new());
    let harness = &mut TWO.lock().unwrap_or_else(PoisonError::into_inner);
    let taken = (0..20).find_map(|seed| {
        sculpt(harness, SessionMode::FreeForm, seed);
        while harness.world.undo_counts().undoable > 0 {
            harness.step(&command(commands::UNDO));
        }
        harness.step(&command(commands::REDO));
        let after = harness.world.volume().rows().clone();
        harness.step(&command(commands::UNDO));
        let before = harness.world.volume().rows();
        let mut rows = (0..N * N).map(|i| (i / N, i % N));
        rows.find(|&(y, z)| !(before.row(y, z) & !after.row(y, z)).is_empty())
    });
    let taken = taken.expect("an oldest stroke that removes something");
    let mut bytes = save_to_vec(&harness.world);
    let layout = SaveLayout::of::<N, 2>(&bytes).expect("a save");
    bytes.copy_within(MAPS..layout.mask, layout.mask);
    bytes[BODY + 11] |= 1;
    bytes[MAPS - 8..MAPS].copy_from_slice(&harness.world.volume().digest().to_le_bytes());
    let entry = 0;
    let bad = BadBytes { offset: layout.entries[entry].start, expected: "all of the mask" };
    let refused = load_forged(&mut harness.world, &mut bytes);
    assert_eq!(refused, Err(BadSave::Entry { entry, bad, axis: Axis::X, address: taken }));
    // With nothing to redo, the same mask is valid if no undo removes a part of it.
    harness.start_session(SessionMode::FreeForm);
    let mut bytes = save_to_vec(&harness.world);
    bytes.copy_within(MAPS..layout.mask, layout.mask);
    bytes[BODY + 11] |= 1;
    bytes[MAPS - 8..MAPS].copy_from_slice(&harness.world.volume().digest().to_le_bytes());
    assert_eq!(load_forged(&mut harness.world, &mut bytes), Ok(()));
    harness.check_invariants();
}

/// Offsets in a saved search: each layer's queue, and each reached row with its place.
struct SavedSearch {
    queues: Vec<usize>,
    reached: Vec<((usize, usize), usize)>,
}

/// Sculpts until a search is in progress with rows left to visit.
fn save_in_search(harness: &mut WorldHarness<N, 2>, mode: SessionMode) -> (Vec<u8>, SavedSearch) {
    harness.start_session(mode);
    let mut visitor = RandomVisitor::new(5);
    for _ in 0..3000 {
        harness.step(&visitor.next_input());
        let bytes = save_to_vec(&harness.world);
        let at = SaveLayout::of::<N, 2>(&bytes).expect("a save").islands;
        if bytes[at] & 1 == 0 {
            continue;
        }
        let word = |at: usize| u64::from_le_bytes(*bytes[at..].first_chunk().expect("a word"));
        let mut search = SavedSearch { queues: Vec::new(), reached: Vec::new() };
        let mut next = at + 10;
        for y in 0..N {
            search.queues.push(next);
            let held = word(next + 8);
            next += 16;
            for z in (0..N).filter(|z| held >> z & 1 == 1) {
                search.reached.push(((y, z), next));
                next += 8;
            }
        }
        assert_eq!(next, bytes.len(), "where the search ends");
        if search.queues.iter().any(|at| word(*at) != 0) {
            return (bytes, search);
        }
    }
    panic!("no search was under way");
}

fn clear_bits(bytes: &mut [u8], at: usize, bits: u64) -> bool {
    let word = u64::from_le_bytes(*bytes[at..].first_chunk().expect("a word"));
    bytes[at..at + 8].copy_from_slice(&(word & !bits).to_le_bytes());
    word & bits != 0 && word & !bits != 0
}

#[test]
fn a_search_that_missed_ground_or_mask_or_a_row_is_refused() {
    static TWO: Harness<2> = Mutex::new(WorldHarness::new());
    let harness = &mut TWO.lock().unwrap_or_else(PoisonError::into_inner);
    let (bytes, search) = save_in_search(harness, SessionMode::FreeForm);
    let support = "an island search that has reached ground and mask";
    let of_ground = search.reached.iter().filter(|((y, _), _)| *y == 0);
    let mut tried = 0;
    for &((y, z), at) in of_ground {
        let lowest = harness.world.volume().rows().row(y, z).first();
        let mut forged = bytes.clone();
        if lowest.is_some_and(|x| clear_bits(&mut forged, at, 1 << x)) {
            tried += 1;
            let refused = load_forged(&mut harness.world, &mut forged);
            assert_eq!(expected_value(refused), support);
            assert_eq!(harness.world.load(&bytes), Ok(()));
        }
    }
    assert!(tried > 0, "no row of the ground has two voxels");
    // Clears the queue, so that no row is left to visit.
    let mut forged = bytes.clone();
    search.queues.iter().for_each(|at| forged[*at..at + 8].fill(0));
    let expected = "an island search that has queued the rows beside what it reached";
    assert_eq!(expected_value(load_forged(&mut harness.world, &mut forged)), expected);

    let (bytes, search) = save_in_search(harness, SessionMode::Constrained { figure: 0 });
    let mut tried = 0;
    // A queued row may not have been visited yet, and its part of the mask neither.
    let is_queued = |y: usize, z: usize| bytes[search.queues[y] + z / 8] >> (z % 8) & 1 != 0;
    for &((y, z), at) in search.reached.iter().filter(|((y, z), _)| *y > 0 && !is_queued(*y, *z)) {
        let all = harness.world.volume().rows().row(y, z);
        let masked = harness.world.mask().occupied_among((y, z), all).first();
        let mut forged = bytes.clone();
        // A queued row's mask is read when the row is visited.
        clear_bits(&mut forged, search.queues[y], 1 << z);
        if masked.is_some_and(|x| clear_bits(&mut forged, at, 1 << x)) {
            tried += 1;
            let refused = load_forged(&mut harness.world, &mut forged);
            assert_eq!(expected_value(refused), support);
            assert_eq!(harness.world.load(&bytes), Ok(()));
        }
    }
    assert!(tried > 0, "no row above the ground has two reached voxels, one of the mask");
}

#[test]
fn a_state_that_no_world_has_is_refused() {
    static TWO: Harness<2> = Mutex::new(WorldHarness::new());
    let harness = &mut TWO.lock().unwrap_or_else(PoisonError::into_inner);
    harness.start_session(SessionMode::FreeForm);
    let bytes = save_to_vec(&harness.world);
    const HAND: usize = BODY + 15 + 28;
    const ITEM: usize = HAND + 2 * 469;
    const SIZES: usize = ITEM + 31 * BENCH_ITEMS;
    let possible = "a bench with one tool a hand and one bit a tool";
    let (hand, reach) = ("flags of a hand", "a pose within reach, with a unit rotation or none");
    let plane = "a plane within reach";
    let held = |item: usize| (ITEM + 31 * item, vec![1, 0, 0]);
    let mounted = |item: usize| (ITEM + 31 * item, vec![2, 0, 0]);
    let far = |at: usize| (at, 1e9f32.to_le_bytes().to_vec());
    for (changes, expected) in [
        // Tools 0 and 1, bits 0 and 1 of the rotary tool: items 0, 1, 4 and 5.
        (vec![held(0), held(1)], possible),
        (vec![held(4)], possible),
        (vec![mounted(0)], possible),
        (vec![mounted(4), mounted(5)], possible),
        (vec![(ITEM + 31 * 4, vec![3, 0, 0])], possible),
        (vec![(HAND + 112, vec![16])], hand),
        // A trigger that both counts and waits; an open hand that holds the stool.
        (vec![(HAND + 112, vec![66])], hand),
        (vec![(HAND + 112, vec![128])], hand),
        (vec![(BODY + 12, vec![41])], "a string's millimetres, 40 at most"),
        (vec![(HAND + 117, vec![19])], "ticks of a stick's push, 18 at most"),
        (vec![(HAND + 455, 16_385i16.to_le_bytes().to_vec())], plane),
        (vec![(HAND + 461, i64::MAX.to_le_bytes().to_vec())], plane),
        (vec![(SIZES + ToolBit::DiscSaw as usize, vec![1])], "a size that the bit comes in"),
        (vec![far(BODY + 15)], reach),
        (vec![far(ITEM + 3)], reach),
        (vec![far(ITEM + 31 * 2 + 3 + 12)], reach),
        (vec![far(HAND)], reach),
    ] {
        let mut forged = bytes.clone();
        for (at, value) in changes {
            ByteWriter::new(&mut forged[at..]).bytes(&value);
        }
        assert_eq!(expected_value(load_forged(&mut harness.world, &mut forged)), expected);
    }
    let mut forged = bytes.clone();
    ByteWriter::new(&mut forged[held(1).0..]).bytes(&held(1).1);
    assert_eq!(load_forged(&mut harness.world, &mut forged), Ok(()));
}
