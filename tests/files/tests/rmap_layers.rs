//! The `.rmap` file with several intervals a column: a round trip preserves it, a wrong column is named in
//! the error, and maps with more or fewer intervals can read it.

use std::sync::{Mutex, PoisonError};

use paros_core::edit::{EditOperation, EditScratch, SUBUNITS_PER_VOXEL};
use paros_core::limits::MAX_INTERVALS;
use paros_core::volume::{Axis, BitGrid, Column, Grid, Range, Size};
use paros_core::{Brush, Edit, RangeMaps, Volume, apply_edit};
use paros_models::cases::scaled_cases;
use paros_models::dense::{DenseVolume, any_voxels};
use paros_models::layers::LayeredVolume;
use paros_models::random_visitor::RandomSource;
use paros_shell::rmap::{self, RmapFault, RmapFaultAt};
use proptest::prelude::*;

const N: usize = 16;
const HEADER: usize = 12;
const CHECKSUM: usize = 4;

type Address = (usize, usize);

fn all_columns() -> impl Iterator<Item = (Axis, Address)> {
    Axis::ALL.into_iter().flat_map(|axis| (0..N * N).map(move |i| (axis, (i / N, i % N))))
}

/// Returns the maps after a history: the closure of the first volume, with the other volumes alternately
/// removed and added.
fn maps_of_history<const K: usize>(history: &[DenseVolume]) -> RangeMaps<N, K> {
    let mut model = LayeredVolume::new(&history[0], K);
    for (i, voxels) in history[1..].iter().enumerate() {
        let exact = if i % 2 == 0 {
            model.voxels().difference(voxels)
        } else {
            model.voxels().union(voxels)
        };
        model.become_closure_of(&exact);
    }
    let mut maps = RangeMaps::new();
    model.write_maps(&mut maps);
    maps
}

fn voxels_of<const K: usize>(maps: &RangeMaps<N, K>) -> DenseVolume {
    DenseVolume::from_fn(N, |voxel| maps.contains(voxel.map(|i| i as usize)))
}

/// Returns `true` if no range of the maps is loose, and no column has room for another gap.
fn are_tight_and_saturated<const K: usize>(maps: &RangeMaps<N, K>) -> bool {
    let mut volume = Volume::<N, K>::new();
    volume.set_maps(maps);
    volume.are_ranges_tight() && volume.is_saturated()
}

fn update_checksum(bytes: &mut [u8]) {
    let at = bytes.len() - CHECKSUM;
    let step = |crc: u32| crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 };
    let sum = !bytes[..at]
        .iter()
        .fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), |crc, _| step(crc)));
    bytes[at..].copy_from_slice(&sum.to_le_bytes());
}

/// Returns maps that a rejected file must leave unchanged.
fn marked_maps<const K: usize>() -> RangeMaps<N, K> {
    maps_of_history(&[DenseVolume::from_fn(N, |[x, y, z]| x + y + z < 9)])
}

fn refusal<const K: usize>(bytes: &[u8]) -> RmapFaultAt {
    let mut maps = marked_maps::<K>();
    let refused = rmap::decode(bytes, &mut maps).expect_err("must be refused");
    assert!(maps == marked_maps(), "a refused file left its mark");
    refused
}

fn check_round_trip<const K: usize>(history: &[DenseVolume]) {
    let maps = maps_of_history::<K>(history);
    let bytes = rmap::encode(&maps);
    assert_eq!(bytes.len(), HEADER + 3 * N * N * 2 * K + CHECKSUM);
    let version = if K == 1 { 1 } else { 2 };
    assert_eq!(bytes[..HEADER], [b'R', b'M', b'A', b'P', version, 0, 16, 0, K as u8, 0, 0, 0]);
    for ((axis, address), stored) in all_columns().zip(bytes[HEADER..].chunks(2 * K)) {
        for (range, stored) in maps.column(axis, address).ranges().iter().zip(stored.chunks(2)) {
            let empty = range.first() > range.last();
            let written = [!(range.first() as u8), range.last() as u8];
            assert_eq!(stored, if empty { [0, 0] } else { written });
        }
    }
    let mut read = marked_maps::<K>();
    assert_eq!(rmap::decode(&bytes, &mut read), Ok(()));
    assert!(read == maps);
    let mut read = marked_maps::<K>();
    assert_eq!(rmap::decode_closed(&bytes, &mut read), Ok(0));
    assert!(read == maps);
}

/// Reads a file of F intervals into maps of more: voxels and gaps stay the same.
fn check_widened<const F: usize, const K: usize>(history: &[DenseVolume]) {
    let file = maps_of_history::<F>(history);
    let mut maps = marked_maps::<K>();
    assert_eq!(rmap::decode(&rmap::encode(&file), &mut maps), Ok(()));
    assert!(voxels_of(&maps) == voxels_of(&file) && are_tight_and_saturated(&maps));
    for (axis, address) in all_columns() {
        let (column, held) = (maps.column(axis, address), file.column(axis, address));
        assert_eq!(column.hull(), held.hull());
        assert!((0..N).all(|i| held.contains(i) || !column.contains(i)), "a gap isn't held");
    }
    if F == 1 {
        let mut expected = RangeMaps::new();
        let mut bits = BitGrid::<N>::new();
        bits.set_from_maps(&file);
        bits.write_closure(&mut expected);
        assert!(maps == expected);
    }
}

/// Reads a file of F intervals into maps of fewer: it is rejected, or closed on request.
fn check_narrowed<const F: usize, const K: usize>(history: &[DenseVolume]) {
    let file = maps_of_history::<F>(history);
    let bytes = rmap::encode(&file);
    let fault = RmapFault::OtherIntervals { found: F, expected: K };
    assert_eq!(refusal::<K>(&bytes), RmapFaultAt { offset: 8, fault });
    let mut maps = marked_maps::<K>();
    let added = rmap::decode_closed(&bytes, &mut maps).expect("a file");
    let voxels = voxels_of(&file);
    assert!(maps == maps_of_history(std::slice::from_ref(&voxels)), "the closure of its voxels");
    assert_eq!(added, u64::from(voxels_of(&maps).count() - voxels.count()));
}

/// Changes bytes of a file: it is rejected, or read as valid maps that encode to the same bytes.
fn check_forged<const K: usize>(history: &[DenseVolume], changes: &[Change]) {
    let mut bytes = rmap::encode(&maps_of_history::<K>(history));
    let columns = bytes.len() - HEADER - CHECKSUM;
    for change in changes {
        match *change {
            Change::Flip(at, bit) => bytes[HEADER + at.index(columns)] ^= 1 << bit,
            Change::Range(at, first, last) => {
                let at = HEADER + 2 * at.index(columns / 2);
                bytes[at..at + 2].copy_from_slice(&Range::new(first, last).to_bytes());
            }
            Change::Swap(a, b) => {
                let size = 2 * K;
                let [a, b] = [a, b].map(|at| HEADER + size * at.index(columns / size));
                (0..size).for_each(|i| bytes.swap(a + i, b + i));
            }
        }
    }
    update_checksum(&mut bytes);
    let mut expected = RangeMaps::<N, K>::new();
    let mut valid = true;
    for ((axis, address), stored) in all_columns().zip(bytes[HEADER..].chunks(2 * K)) {
        let intervals = std::array::from_fn(|i| [stored[2 * i], stored[2 * i + 1]]);
        match Column::from_bytes(intervals, N) {
            Some(column) => expected.set_column(axis, address, column),
            None => valid = false,
        }
    }
    let mut read = marked_maps::<K>();
    let result = rmap::decode(&bytes, &mut read);
    assert_eq!(result.is_ok(), valid && are_tight_and_saturated(&expected), "{result:?}");
    match result {
        Ok(()) => assert!(read == expected && rmap::encode(&read) == bytes),
        Err(RmapFaultAt { offset, fault }) => {
            assert!((HEADER..bytes.len() - CHECKSUM).contains(&offset), "{offset}: {fault}");
            assert!(fault.to_string().contains("line "), "{fault}");
            assert!(read == marked_maps());
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Change {
    Flip(prop::sample::Index, u8),
    Range(prop::sample::Index, usize, usize),
    Swap(prop::sample::Index, prop::sample::Index),
}

fn any_changes() -> impl Strategy<Value = Vec<Change>> {
    let at = any::<prop::sample::Index>;
    let change = prop_oneof![
        2 => (at(), 0..8u8).prop_map(|(at, bit)| Change::Flip(at, bit)),
        2 => (at(), 0..N, 0..N).prop_map(|(at, first, last)| Change::Range(at, first, last)),
        1 => (at(), at()).prop_map(|(a, b)| Change::Swap(a, b)),
    ];
    prop::collection::vec(change, 0..4)
}

fn any_history() -> impl Strategy<Value = Vec<DenseVolume>> {
    prop::collection::vec(any_voxels(N), 1..5)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(scaled_cases(60)))]

    #[test]
    fn what_is_written_is_read(history in any_history()) {
        check_round_trip::<1>(&history);
        check_round_trip::<2>(&history);
        check_round_trip::<3>(&history);
        check_round_trip::<MAX_INTERVALS>(&history);
    }

    #[test]
    fn fewer_intervals_are_read_into_more_exactly(history in any_history()) {
        check_widened::<1, 2>(&history);
        check_widened::<1, 3>(&history);
        check_widened::<2, 3>(&history);
        check_widened::<2, 4>(&history);
    }

    #[test]
    fn more_intervals_are_closed_if_that_is_asked_for(history in any_history()) {
        check_narrowed::<2, 1>(&history);
        check_narrowed::<3, 1>(&history);
        check_narrowed::<3, 2>(&history);
        check_narrowed::<4, 2>(&history);
    }

    #[test]
    fn changed_columns_are_read_if_they_are_a_volume(
        history in any_history(),
        changes in any_changes(),
    ) {
        check_forged::<1>(&history, &changes);
        check_forged::<2>(&history, &changes);
        check_forged::<3>(&history, &changes);
    }
}

/// Returns a block of N voxels a side after edits by balls at random places.
fn edited_block<const N: usize, const K: usize>(seed: u64) -> Box<Volume<N, K>>
where
    Grid<N>: Size,
{
    let mut volume = Box::new(Volume::<N, K>::new());
    let (no_mask, mut scratch) = (Box::new(RangeMaps::new()), Box::new(EditScratch::new()));
    volume.set_voxels(|rows| (0..N).for_each(|y| rows.layer_mut(y).fill(Grid::<N>::FULL)));
    let mut dice = RandomSource::new(seed);
    for i in 0..300 {
        let place = [0; 3].map(|_| dice.below(N as u64) as i32 * SUBUNITS_PER_VOXEL);
        let radius = (2 + dice.below(N as u64 / 6) as i32) * SUBUNITS_PER_VOXEL;
        let brush = Brush::sphere(place.into(), radius);
        let operation = match i % 4 {
            0 => EditOperation::Fill { depth: 4 },
            _ => EditOperation::Carve { depth: 4 },
        };
        let edit = Edit { brush: &brush, operation, mirrored: false };
        apply_edit(&mut volume, &no_mask, &edit, &mut scratch, &mut ()).expect("a small brush");
    }
    volume
}

/// Tests sizes whose rows have a word or more; the core's own closure is the model.
fn check_edited_block<const N: usize>(seed: u64)
where
    Grid<N>: Size,
{
    let volume = edited_block::<N, 2>(seed);
    let bytes = rmap::encode(volume.maps());
    let mut read = Box::new(RangeMaps::<N, 2>::new());
    assert_eq!(rmap::decode(&bytes, &mut read), Ok(()));
    assert!(*read == *volume.maps());
    let (mut one, mut closed) =
        (Box::new(RangeMaps::<N, 1>::new()), Box::new(RangeMaps::<N, 1>::new()));
    let added = rmap::decode_closed(&bytes, &mut closed).expect("a file");
    volume.rows().write_closure(&mut one);
    assert!(one == closed && added > 0);
    let mut voxels = Box::new(BitGrid::<N>::new());
    voxels.set_from_maps(&one);
    assert_eq!(added, voxels.count_voxels() - volume.count_voxels());
    assert_eq!(rmap::decode(&rmap::encode(&one), &mut read), Ok(()));
    let mut widened = Box::new(RangeMaps::<N, 2>::new());
    voxels.write_closure(&mut widened);
    assert!(read == widened);
}

#[test]
fn edited_blocks_of_all_widths_come_back() {
    (0..3).for_each(check_edited_block::<32>);
    (0..3).for_each(check_edited_block::<64>);
    (0..2).for_each(check_edited_block::<128>);
}

/// In a bar, a voxel was cut first, and then two longer runs, for which the column along x had no room. Read
/// into three intervals, that column has room for one of them beside its first gap.
#[test]
fn a_short_gap_of_a_file_is_held_in_more_intervals() {
    let of_bar =
        |is_in: fn(i32) -> bool| DenseVolume::from_fn(N, |[x, y, z]| (y, z) == (5, 5) && is_in(x));
    let cuts =
        [of_bar(|x| x == 3), of_bar(|_| false), of_bar(|x| [5, 6, 7, 9, 10, 11].contains(&x))];
    let history = [vec![of_bar(|_| true)], cuts.to_vec()].concat();
    let held = maps_of_history::<2>(&history).column(Axis::X, (5, 5)).ranges();
    assert_eq!(held, [Range::new(0, 2), Range::new(4, 15)]);
    check_widened::<2, 3>(&history);
}

/// The column along x of the volume of [`encode_two_voxels`].
const ALONG_X: (Axis, Address) = (Axis::X, (5, 5));

/// Encodes two voxels, at 2 and 6 along x, with the column along x replaced.
fn encode_two_voxels(column: [(usize, usize); 2]) -> Vec<u8> {
    let occupied = |voxel| [[2, 5, 5], [6, 5, 5]].contains(&voxel);
    let mut maps = maps_of_history::<2>(&[DenseVolume::from_fn(N, occupied)]);
    let column = column.map(|(first, last)| match (first, last) {
        (255, 0) => Range::EMPTY,
        _ => Range::new(first, last),
    });
    maps.set_column(ALONG_X.0, ALONG_X.1, Column::new(column));
    rmap::encode(&maps)
}

#[test]
fn each_fault_is_named_with_its_column_and_offset() {
    let none = (255, 0);
    let (at, (axis, address)) = (HEADER + 4 * (5 * N + 5), ALONG_X);
    let order = |below: (usize, usize), found: (usize, usize)| {
        let below = if below == none { Range::EMPTY } else { Range::new(below.0, below.1) };
        let found = Range::new(found.0, found.1);
        (at + 2, RmapFault::Order { axis, address, below, found })
    };
    let loose = RmapFault::Loose { axis, voxel: [7, 5, 5], missing: Axis::Y };
    let range = RmapFault::Range { axis, address, bytes: [!6, 16] };
    let unsaturated = RmapFault::Unsaturated { axis, voxel: [3, 5, 5] };
    let cases = [
        ([(2, 6), (6, 8)], order((2, 6), (6, 8)), "a range behind 2..=6 and a gap, found 6..=8"),
        ([(2, 2), (3, 6)], order((2, 2), (3, 6)), "a range behind 2..=2 and a gap, found 3..=6"),
        ([(6, 6), (2, 2)], order((6, 6), (2, 2)), "a range behind 6..=6 and a gap, found 2..=2"),
        ([none, (6, 6)], order(none, (6, 6)), "no range behind an empty one, found 6..=6"),
        ([(2, 2), (6, 7)], (at + 3, loose), "its end voxel [7, 5, 5]"),
        ([(2, 2), (6, 16)], (at + 2, range), "found 6..=16"),
        ([(2, 6), none], (at, unsaturated), "voxel [3, 5, 5]"),
    ];
    for (column, (offset, fault), text) in cases {
        assert_eq!(refusal::<2>(&encode_two_voxels(column)), RmapFaultAt { offset, fault });
        let message = fault.to_string();
        assert!(message.contains(text), "{message}");
        assert!(message.ends_with("(column along X, line 5, place 5)"), "{message}");
    }
    let good = encode_two_voxels([(2, 2), (6, 6)]);
    assert_eq!(rmap::decode(&good, &mut RangeMaps::<N, 2>::new()), Ok(()));
}

#[test]
fn versions_hold_their_numbers_of_intervals() {
    let good = encode_two_voxels([(2, 2), (6, 6)]);
    let change = |version, layers| {
        let mut bytes = good.clone();
        (bytes[4], bytes[8]) = (version, layers);
        update_checksum(&mut bytes);
        let RmapFaultAt { offset, fault } = refusal::<2>(&bytes);
        (offset, fault, fault.to_string())
    };
    let layers = |version, found| RmapFault::Layers { version, found };
    let says = |text: &str| text.to_owned();
    let one = says("expected 1 interval a column, found 2");
    assert_eq!(change(1, 2), (8, layers(1, 2), one));
    let many = |found| format!("expected 2 to 4 intervals a column in version 2, found {found}");
    for found in [0, 1, MAX_INTERVALS as u8 + 1, 255] {
        assert_eq!(change(2, found), (8, layers(2, found), many(found)));
    }
    assert_eq!(change(3, 2), (4, RmapFault::Version(3), says("expected version 1 or 2, found 3")));
    let fault = RmapFault::OtherIntervals { found: 4, expected: 2 };
    let message = says("expected columns of at most 2 intervals, found 4");
    assert_eq!(change(2, 4), (8, fault, message));
    let fault = RmapFault::OtherIntervals { found: 2, expected: 1 };
    assert_eq!(fault.to_string(), "expected columns of 1 interval, found columns of 2");
}

/// Tests a block with two holes in a line along x. The columns across represent both holes, the column along
/// x only one.
#[test]
fn the_checksum_names_maps_and_not_voxels() {
    static MAPS: Mutex<[RangeMaps<N, 2>; 2]> = Mutex::new([const { RangeMaps::new() }; 2]);
    let mut both = MAPS.lock().unwrap_or_else(PoisonError::into_inner);
    for (hole, maps) in [3, 8].into_iter().zip(&mut *both) {
        maps.fill_block();
        for axis in [Axis::Y, Axis::Z] {
            for x in [3, 8] {
                let column = Column::new([Range::new(0, 4), Range::new(6, 15)]);
                maps.set_column(axis, axis.column_address([x, 5, 5]), column);
            }
        }
        let column = Column::new([Range::new(0, hole - 1), Range::new(hole + 1, 15)]);
        maps.set_column(Axis::X, (5, 5), column);
        let mut read = RangeMaps::new();
        assert_eq!(rmap::decode(&rmap::encode(maps), &mut read), Ok(()));
        assert!(read == *maps, "what is held is kept");
    }
    let [one, other] = &*both;
    assert!(voxels_of(one) == voxels_of(other));
    assert_ne!(rmap::volume_checksum(one), rmap::volume_checksum(other));
}
