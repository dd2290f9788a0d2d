//! Saves with an impossible column, forged with a valid checksum, are rejected with that column's place.

use std::sync::{Mutex, PoisonError};

use paros_core::codec::{BadBytes, BadSave};
use paros_core::internals::{checksum, maps_digest};
use paros_core::limits::{STATE_BYTES, max_save_bytes};
use paros_core::session::{SessionMode, commands};
use paros_core::volume::{Axis, Column, Range};
use paros_core::{RangeMaps, TickInput, World};
use paros_models::random_visitor::RandomVisitor;
use paros_models::world_harness::WorldHarness;

const N: usize = 64;

/// Byte offsets of the checksum, of the bytes that it covers, and of the volume's columns.
const SUM: usize = 8;
const BODY: usize = 16;
const MAPS: usize = BODY + STATE_BYTES;

const DISJOINT: &str = "disjoint ranges within the grid, the lowest first";

type Address = (usize, usize);

fn save_to_vec<const K: usize>(world: &World<N, K>) -> Vec<u8> {
    let mut bytes = vec![0; max_save_bytes(N, K)];
    let len = world.save(&mut bytes);
    bytes.truncate(len);
    bytes
}

/// Returns the offset of a column in maps that begin at `start`.
fn column_offset<const K: usize>(start: usize, axis: Axis, (line, place): Address) -> usize {
    start + 2 * K * ((axis as usize * N + line) * N + place)
}

/// Returns the offset of the mask's columns, and the offset of the undo history.
fn mask_offset<const K: usize>() -> usize {
    column_offset::<K>(MAPS, Axis::X, (0, 0)) + 6 * N * N * K
}

fn undo_offset<const K: usize>() -> usize {
    mask_offset::<K>() + 6 * N * N * K
}

fn write_column<const K: usize>(bytes: &mut [u8], at: usize, column: Column<K>) {
    bytes[at..at + 2 * K].copy_from_slice(column.to_bytes().as_flattened());
}

/// Writes a valid checksum and loads the bytes.
fn load_forged<const K: usize>(world: &mut World<N, K>, bytes: &mut [u8]) -> Result<(), BadSave> {
    let sum = checksum(&bytes[BODY..]);
    bytes[SUM..BODY].copy_from_slice(&sum.to_le_bytes());
    world.load(bytes)
}

fn bad_column(axis: Axis, address: Address, offset: usize, expected: &'static str) -> BadSave {
    BadSave::Column { bad: BadBytes { offset, expected }, axis, address }
}

fn range(first: usize, last: usize) -> Range {
    if first > last { Range::EMPTY } else { Range::new(first, last) }
}

/// Builds two voxels on the ground, at 2 and 6 along x, replaces the saved column along x by each of the
/// given columns, and compares the errors with the expected ones.
fn check_volume<const K: usize>(
    harness: &mut WorldHarness<N, K>,
    cases: &[([(usize, usize); K], &'static str)],
) {
    harness.start_from_voxels(|voxel| [[2, 0, 5], [6, 0, 5]].contains(&voxel));
    let bytes = save_to_vec(&harness.world);
    let (axis, address) = (Axis::X, (0, 5));
    let at = column_offset::<K>(MAPS, axis, address);
    let saved = harness.world.volume().maps().column(axis, address).to_bytes();
    assert_eq!(&bytes[at..at + 2 * K], saved.as_flattened(), "where the columns lie");
    for (column, expected) in cases {
        let mut forged = bytes.clone();
        let column = Column::new(column.map(|(first, last)| range(first, last)));
        write_column(&mut forged, at, column);
        let refused = load_forged(&mut harness.world, &mut forged);
        assert_eq!(refused, Err(bad_column(axis, address, at, expected)), "{column:?}");
        assert!(harness.world.volume().maps().is_empty(), "the empty world is left");
    }
    assert_eq!(harness.world.load(&bytes), Ok(()));
}

#[test]
fn a_bad_column_of_the_volume_is_named() {
    static ONE: Mutex<WorldHarness<N, 1>> = Mutex::new(WorldHarness::new());
    static TWO: Mutex<WorldHarness<N, 2>> = Mutex::new(WorldHarness::new());
    let one = &mut ONE.lock().unwrap_or_else(PoisonError::into_inner);
    check_volume(one, &[([(2, 64)], DISJOINT), ([(2, 7)], "tight ranges")]);
    let two = &mut TWO.lock().unwrap_or_else(PoisonError::into_inner);
    let (none, unsaturated) = ((1, 0), "a column without empty voxels where a gap has room");
    check_volume(
        two,
        &[
            ([(2, 2), (3, 6)], DISJOINT),
            ([(2, 6), (6, 7)], DISJOINT),
            ([(6, 6), (2, 2)], DISJOINT),
            ([none, (6, 6)], DISJOINT),
            ([(2, 2), (6, 64)], DISJOINT),
            ([(2, 2), (6, 7)], "tight ranges"),
            ([(2, 6), none], unsaturated),
        ],
    );
    let bad = bad_column(Axis::Z, (7, 9), 812, "tight ranges");
    assert_eq!(bad.offset(), 812);
    let text = "expected tight ranges at byte 812 (column along Z, line 7, place 9)";
    assert_eq!(bad.to_string(), text);
}

/// Changes the saved mask and its digest in the saved state.
fn forge_mask<const K: usize>(
    bytes: &mut [u8],
    mask: &RangeMaps<N, K>,
    columns: &[(Axis, Address, Column<K>)],
) {
    let mut forged = RangeMaps::new();
    forged.copy_from(mask);
    for (axis, address, column) in columns {
        write_column(bytes, column_offset::<K>(mask_offset::<K>(), *axis, *address), *column);
        forged.set_column(*axis, *address, *column);
    }
    let digest = MAPS - 8..MAPS;
    assert_eq!(bytes[digest.clone()], maps_digest(mask).to_le_bytes(), "where the digest lies");
    bytes[digest].copy_from_slice(&maps_digest(&forged).to_le_bytes());
}

fn check_mask<const K: usize>(harness: &mut WorldHarness<N, K>) {
    harness.start_session(SessionMode::Constrained { figure: 0 });
    let bytes = save_to_vec(&harness.world);
    let mut mask = RangeMaps::<N, K>::new();
    mask.copy_from(harness.world.mask());
    // Moves a column's last voxel by one.
    let address = (0..N * N).map(|i| (i / N, i % N)).rfind(|address| {
        let last = mask.column(Axis::Z, *address).hull().last();
        0 < last && last < N - 1
    });
    let address = address.expect("a column of the figure");
    let mut loose = mask.column(Axis::Z, address);
    let (i, interval) = loose.intervals().enumerate().last().expect("an interval");
    loose.set_range(i, Range::new(interval.first(), interval.last() + 1));
    let mut forged = bytes.clone();
    forge_mask(&mut forged, &mask, &[(Axis::Z, address, loose)]);
    let at = column_offset::<K>(mask_offset::<K>(), Axis::Z, address);
    let refused = load_forged(&mut harness.world, &mut forged);
    assert_eq!(refused, Err(bad_column(Axis::Z, address, at, "tight ranges of the mask")));

    // Adds mask voxels where the lump has none: one voxel, and two in one interval along x, with room for a
    // gap between them if the format allows a second interval.
    assert_eq!(harness.world.load(&bytes), Ok(()));
    let beyond = "a mask within the volume";
    let unsaturated = "a column of the mask without empty voxels where a gap has room";
    for (last_x, expected) in [(0, beyond), (4, if K == 1 { beyond } else { unsaturated })] {
        let voxel = |x: usize| [x, N - 1, 0];
        assert!((0..=last_x).all(|x| !harness.world.volume().rows().contains(voxel(x))));
        let address = Axis::X.column_address(voxel(0));
        let mut columns = vec![(Axis::X, address, Column::from_range(Range::new(0, last_x)))];
        for x in [0, last_x] {
            columns.extend([Axis::Y, Axis::Z].map(|axis| {
                let i = voxel(x)[axis as usize];
                (axis, axis.column_address(voxel(x)), Column::from_range(Range::new(i, i)))
            }));
        }
        assert!(columns.iter().all(|(axis, at, _)| mask.column(*axis, *at) == Column::EMPTY));
        let mut forged = bytes.clone();
        forge_mask(&mut forged, &mask, &columns);
        let at = column_offset::<K>(mask_offset::<K>(), Axis::X, address);
        let refused = load_forged(&mut harness.world, &mut forged);
        assert_eq!(refused, Err(bad_column(Axis::X, address, at, expected)));
        assert_eq!(harness.world.load(&bytes), Ok(()));
    }
}

#[test]
fn a_bad_column_of_the_mask_is_named() {
    static ONE: Mutex<WorldHarness<N, 1>> = Mutex::new(WorldHarness::new());
    static TWO: Mutex<WorldHarness<N, 2>> = Mutex::new(WorldHarness::new());
    check_mask(&mut ONE.lock().unwrap_or_else(PoisonError::into_inner));
    check_mask(&mut TWO.lock().unwrap_or_else(PoisonError::into_inner));
}

/// Returns the offset of the last byte of the newest undo entry, and the end of the history.
fn undo_end<const K: usize>(bytes: &[u8]) -> usize {
    let at = undo_offset::<K>();
    let packed = u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    assert_eq!(bytes[at + 4] & 1, 1, "there is a newest entry");
    (0..=packed).fold(at + 5, |at, _| {
        let cells = u32::from_le_bytes(*bytes[at..].first_chunk().expect("a length"));
        at + 4 + 2 * cells as usize
    })
}

fn check_undo<const K: usize>(harness: &mut WorldHarness<N, K>, bad: Column<K>) {
    harness.start_session(SessionMode::FreeForm);
    let mut visitor = RandomVisitor::new(3);
    while harness.world.undo_counts().undoable < 3 || harness.world.undo_counts().redoable > 0 {
        harness.step(&visitor.next_input());
    }
    // Waits until the hands are at rest.
    (0..20).for_each(|_| harness.step(&TickInput::default()));
    let bytes = save_to_vec(&harness.world);
    let mut before = RangeMaps::<N, K>::new();
    before.copy_from(harness.world.volume().maps());
    harness.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
    // An entry contains the columns that it exchanges, in the order of the maps.
    let after = harness.world.volume().maps();
    let mut all =
        Axis::ALL.into_iter().flat_map(|axis| (0..N * N).map(move |i| (axis, i / N, i % N)));
    let last = all.rfind(|&(axis, l, p)| before.column(axis, (l, p)) != after.column(axis, (l, p)));
    let (axis, line, place) = last.expect("an undo changes columns");
    let mut forged = bytes.clone();
    let at = undo_end::<K>(&bytes) - 2 * K;
    let saved = after.column(axis, (line, place)).to_bytes();
    assert_eq!(&bytes[at..at + 2 * K], saved.as_flattened(), "where the column lies");
    write_column(&mut forged, at, bad);
    let refused = load_forged(&mut harness.world, &mut forged);
    assert_eq!(refused, Err(bad_column(axis, (line, place), at, DISJOINT)));
    assert_eq!(harness.world.load(&bytes), Ok(()));
}

#[test]
fn a_bad_column_of_an_undo_entry_is_named() {
    static ONE: Mutex<WorldHarness<N, 1>> = Mutex::new(WorldHarness::new());
    static TWO: Mutex<WorldHarness<N, 2>> = Mutex::new(WorldHarness::new());
    let one = &mut ONE.lock().unwrap_or_else(PoisonError::into_inner);
    check_undo(one, Column::new([Range::new(2, N)]));
    let two = &mut TWO.lock().unwrap_or_else(PoisonError::into_inner);
    check_undo(two, Column::new([Range::new(2, 2), Range::new(3, 6)]));
}
