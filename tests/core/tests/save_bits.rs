//! Each bit of a save is part of the digest: a save with one bit flipped is rejected or has another digest.

use std::sync::{Mutex, PoisonError};

use paros_core::World;
use paros_core::codec::ByteReader;
use paros_core::edit::UndoCounts;
use paros_core::internals::{IslandSearch, checksum};
use paros_core::limits::STATE_BYTES;
use paros_core::volume::{Grid, Size};
use paros_models::cases::sample_cases;
use paros_models::random_visitor::RandomVisitor;
use paros_models::world_harness::WorldHarness;

/// Byte offsets of the checksum, and of the bytes that it covers.
const SUM: usize = 8;
const BODY: usize = 16;

fn save_to_vec<const N: usize, const K: usize>(world: &World<N, K>) -> Vec<u8>
where
    Grid<N>: Size,
{
    let mut bytes = vec![0; world.save(&mut [])];
    assert_eq!(world.save(&mut bytes), bytes.len());
    bytes
}

/// Flips the given bits of the body one by one and loads each save. Returns the number of loaded saves.
fn flip_bits<const N: usize, const K: usize>(
    world: &mut World<N, K>,
    saved: &[u8],
    bits: impl Iterator<Item = usize>,
) -> usize
where
    Grid<N>: Size,
{
    world.load(saved).expect("the save itself");
    let (digest, mut loaded) = (world.digest(), 0);
    let mut bytes = saved.to_vec();
    for bit in bits {
        let (at, flip) = (BODY + bit / 8, 1 << (bit % 8));
        bytes[at] ^= flip;
        let sum = checksum(&bytes[BODY..]);
        bytes[SUM..BODY].copy_from_slice(&sum.to_le_bytes());
        if world.load(&bytes).is_ok() {
            assert_ne!(world.digest(), digest, "bit {} of byte {at}", bit % 8);
            loaded += 1;
        }
        bytes[at] ^= flip;
    }
    loaded
}

/// Returns two saves of a session: with a pass in flight over strokes that can be undone, and with a pass
/// that waits because some strokes can be redone.
fn play_two_saves<const N: usize, const K: usize>(harness: &mut WorldHarness<N, K>) -> [Vec<u8>; 2]
where
    Grid<N>: Size,
{
    harness.reset();
    let idle = harness.world.part_digests()[3];
    // Sheets joined at alternating edges, over which a pass takes several ticks.
    harness.start_from_voxels(|[_, y, z]| y % 2 == 0 || z == if y % 4 == 1 { 0 } else { N - 1 });
    let mut visitor = RandomVisitor::new(5);
    let mut saves = [Vec::new(), Vec::new()];
    while saves[0].is_empty() || saves[1].is_empty() {
        assert!(harness.world.tick() < 4000, "{:?}", saves.map(|save| save.len()));
        harness.step(&visitor.next_input());
        let is_busy = harness.world.part_digests()[3] != idle;
        let UndoCounts { undoable, redoable } = harness.world.undo_counts();
        if is_busy && undoable > 2 && redoable == 0 && saves[0].is_empty() {
            saves[0] = save_to_vec(&harness.world);
        }
        if is_busy && undoable > 0 && redoable > 0 {
            saves[1] = save_to_vec(&harness.world);
        }
    }
    saves
}

/// Tests a sixteenth of the bits of volume and mask, and of the second save a fourth of the other bits; the
/// nightly run tests all bits.
#[test]
fn every_bit_of_a_save_at_16_counts_in_the_digest() {
    static HARNESS: Mutex<WorldHarness<16>> = Mutex::new(WorldHarness::new());
    let harness = &mut *HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    let maps = STATE_BYTES..STATE_BYTES + 2 * 3 * 16 * 16 * 2;
    for (save, step) in play_two_saves(harness).iter().zip([1, 4]) {
        let in_maps = sample_cases(8 * maps.start..8 * maps.end, 16);
        flip_bits(&mut harness.world, save, in_maps);
        let body = 8 * (save.len() - BODY);
        let beside = sample_cases((0..8 * maps.start).chain(8 * maps.end..body), step);
        let loaded = flip_bits(&mut harness.world, save, beside);
        assert!(loaded > 4000 / step as usize, "{loaded} of {} bytes", save.len());
    }
}

/// Tests all bits except those of volume and mask, most of which are rejected. The state has the same layout
/// at every size, so only a sixty-fourth of it is tested, and a third in the nightly run.
#[test]
fn every_bit_of_a_save_at_32_counts_in_the_digest() {
    static HARNESS: Mutex<WorldHarness<32, 2>> = Mutex::new(WorldHarness::new());
    let harness = &mut *HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    let [save, _] = play_two_saves(harness);
    let maps = 2 * 3 * 32 * 32 * 2 * 2;
    let state = flip_bits(&mut harness.world, &save, sample_cases(0..8 * STATE_BYTES, 64));
    let rest = 8 * (STATE_BYTES + maps)..8 * (save.len() - BODY);
    let rest = flip_bits(&mut harness.world, &save, sample_cases(rest, 16));
    assert!(state > 60 && rest > 60, "{state} and {rest} of {} bytes", save.len());
}

/// Every bit of a row of reached voxels and of a row of queued rows changes the digest, at any place and
/// size.
#[test]
fn each_row_of_a_search_counts_in_the_digest() {
    static SEARCH: Mutex<IslandSearch<256>> = Mutex::new(IslandSearch::new());
    let mut search = SEARCH.lock().unwrap_or_else(PoisonError::into_inner);
    let mut digest_of = |y: usize, z: usize, queued: Option<usize>, reached: Option<usize>| {
        let mut bytes = vec![1];
        bytes.extend([0; 9]);
        for layer in 0..256 {
            let row_of = |bit: Option<usize>| {
                let mut row = [0u8; 32];
                if let Some(bit) = bit.filter(|_| layer == y) {
                    row[bit / 8] |= 1 << (bit % 8);
                }
                row
            };
            bytes.extend(row_of(queued));
            bytes.extend(row_of(reached.map(|_| z)));
            if layer == y && reached.is_some() {
                bytes.extend(row_of(reached));
            }
        }
        let mut reader = ByteReader::new(&bytes);
        search.load(&mut reader).expect("a search");
        reader.expect_end().expect("all of it");
        search.digest()
    };
    let none = digest_of(0, 0, None, None);
    for y in 0..256 {
        for bit in [0, 31, 62, 63, 64, 126, 127, 128, 190, 191, 192, 254, 255] {
            assert_ne!(digest_of(y, 0, Some(bit), None), none, "queued row {bit} of layer {y}");
            let z = (y * 37 + bit) % 256;
            assert_ne!(digest_of(y, z, None, Some(bit)), none, "voxel {bit} of row ({y}, {z})");
        }
    }
}
