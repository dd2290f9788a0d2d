//! Saved worlds: a loaded world continues exactly as if uninterrupted, and corrupt bytes are rejected.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use paros_core::codec::{BadBytes, BadSave};
use paros_core::internals::checksum;
use paros_core::limits::max_save_bytes;
use paros_core::session::{SessionMode, SessionState, commands};
use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, World};
use paros_models::cases::random_cases;
use paros_models::random_visitor::{RandomSource, RandomVisitor};
use paros_models::world_harness::{WorldHarness, maps_are_equal};
use proptest::prelude::*;

static HARNESSES: Mutex<[WorldHarness<64>; 2]> = Mutex::new([const { WorldHarness::new() }; 2]);

/// Byte offsets of the checksum, and of the bytes that it covers.
const SUM: usize = 8;
const BODY: usize = 16;

fn save_to_vec<const K: usize>(world: &World<64, K>) -> Vec<u8> {
    let mut bytes = vec![0; world.save(&mut [])];
    let len = world.save(&mut bytes);
    assert_eq!(len, bytes.len());
    assert!(len <= max_save_bytes(64, K), "{len} bytes");
    bytes
}

/// Returns `true` inside a comb of sheets, joined at alternating edges: an island pass over it takes many
/// ticks.
fn is_in_sheets([x, _, z]: [usize; 3]) -> bool {
    z % 2 == 0 || x == if z % 4 == 1 { 0 } else { 63 }
}

/// Starts a session: 0 from the lump, 1 with a hidden figure, else from a comb whose island pass takes long.
fn start_session_of_kind<const K: usize>(harness: &mut WorldHarness<64, K>, kind: u64) {
    match kind {
        0 => harness.start_session(SessionMode::FreeForm),
        1 => harness.start_session(SessionMode::Constrained { figure: 0 }),
        _ => harness.start_from_voxels(|[x, y, z]| is_in_sheets([z, x, y]) && (z < 63 || y > 5)),
    };
}

/// The longest save's length is the sum of its parts: two volumes' maps, undo entries, the newest entry,
/// islands, and 1 KiB.
#[test]
fn the_longest_save_is_the_sum_of_its_parts() {
    let parts = [
        (128, 1, 2 * 98_304 + 131_584 + 104_544 + 266_240 + 2048),
        (128, 2, 2 * 196_608 + 262_656 + 202_848 + 266_240 + 2048),
        (256, 1, 2 * 393_216 + 524_800 + 418_176 + 2_113_536 + 2048),
    ];
    for (grid_side, intervals, sum) in parts {
        assert_eq!(max_save_bytes(grid_side, intervals), sum);
    }
}

/// On every tick, loads the save of `BACK` ticks ago into another world and replays up to the present.
#[test]
fn a_world_loaded_goes_on_as_if_uninterrupted() {
    const BACK: usize = 6;
    let mut harnesses = HARNESSES.lock().unwrap_or_else(PoisonError::into_inner);
    let [one, other] = &mut *harnesses;
    let (mut in_flight, mut in_stroke) = (0, 0);
    for kind in 0..3 {
        start_session_of_kind(one, kind);
        start_session_of_kind(other, kind);
        let idle = one.world.part_digests()[3].1;
        let mut visitor = RandomVisitor::new(50 + kind);
        let mut past: VecDeque<(Vec<u8>, TickInput, u64)> = VecDeque::new();
        for tick in 0..220 {
            let input = visitor.next_input();
            let before = save_to_vec(&one.world);
            in_flight += u32::from(one.world.part_digests()[3].1 != idle);
            in_stroke +=
                u32::from(one.world.hand_state(0).trigger || one.world.hand_state(1).trigger);
            one.step(&input);
            past.push_back((before, input, one.world.digest()));
            if past.len() < BACK {
                continue;
            }
            other.world.load(&past[0].0).expect("a saved world");
            for (_, input, digest) in &past {
                other.step(input);
                assert_eq!(other.world.digest(), *digest, "kind {kind}, tick {tick}");
            }
            assert_eq!(other.world.events(), one.world.events());
            past.pop_front();
        }
        assert!(maps_are_equal(other.world.volume().maps(), one.world.volume().maps()));
        assert_eq!(save_to_vec(&other.world), save_to_vec(&one.world));
        other.check_invariants();
    }
    assert!(in_flight > 20 && in_stroke > 100, "{in_flight} mid-pass, {in_stroke} mid-stroke");
}

#[test]
fn after_a_load_everything_is_dirty_until_the_next_tick() {
    let mut harnesses = HARNESSES.lock().unwrap_or_else(PoisonError::into_inner);
    let harness = &mut harnesses[0];
    start_session_of_kind(harness, 0);
    let bytes = save_to_vec(&harness.world);
    harness.step(&TickInput::default());
    harness.world.load(&bytes).expect("a saved world");
    assert!(!harness.world.dirty_rects().is_empty() && harness.world.events().is_empty());
    harness.step(&TickInput::default());
    assert!(harness.world.dirty_rects().is_empty());
}

/// Measures the size of the fixed-length rest of a save beside two sets of maps.
#[test]
fn a_world_in_which_nothing_has_happened_is_short() {
    fn rest<const N: usize>(world: &World<N>) -> usize
    where
        Grid<N>: Size,
    {
        world.save(&mut []) - 2 * 3 * N * N * 2
    }
    static SMALL: World<16> = World::new();
    static LARGE: World<256> = World::new();
    assert_eq!(rest(&SMALL), rest(&LARGE));
    assert!(rest(&LARGE) <= 2048, "{} bytes", rest(&LARGE));
}

#[test]
fn a_buffer_too_small_is_told_by_the_length() {
    let mut harnesses = HARNESSES.lock().unwrap_or_else(PoisonError::into_inner);
    let harness = &mut harnesses[0];
    start_session_of_kind(harness, 1);
    let bytes = save_to_vec(&harness.world);
    for short in [0, 1, BODY, bytes.len() / 2, bytes.len() - 1] {
        assert_eq!(harness.world.save(&mut vec![0; short]), bytes.len());
    }
    let mut long = vec![7; bytes.len() + 9];
    assert_eq!(harness.world.save(&mut long), bytes.len());
    assert!(long[..bytes.len()] == bytes && long[bytes.len()..] == [7; 9]);
}

/// Runs a random visitor's session and saves it.
fn save_after_visit<const K: usize>(harness: &mut WorldHarness<64, K>, seed: u64) -> Vec<u8> {
    start_session_of_kind(harness, seed % 3);
    let mut visitor = RandomVisitor::new(seed);
    (0..120).for_each(|_| harness.step(&visitor.next_input()));
    save_to_vec(&harness.world)
}

#[test]
fn bytes_that_were_hurt_leave_the_world_as_it_was() {
    let mut harnesses = HARNESSES.lock().unwrap_or_else(PoisonError::into_inner);
    let harness = &mut harnesses[0];
    let bytes = save_after_visit(harness, 6);
    harness.step(&TickInput::default());
    let digest = harness.world.digest();
    let mut dice = RandomSource::new(9);
    let mut refuse = |bytes: &[u8], what: &str| {
        assert!(harness.world.load(bytes).is_err(), "{what}");
        assert_eq!(harness.world.digest(), digest, "{what}");
    };
    for at in (0..40).chain((0..160).map(|_| dice.below(bytes.len() as u64) as usize)) {
        let mut hurt = bytes.clone();
        hurt[at] ^= 1 << (at % 8);
        refuse(&hurt, &format!("a bit of byte {at} flipped"));
    }
    for len in (0..40).chain((0..60).map(|i| bytes.len() * i / 60)).chain([bytes.len() - 1]) {
        refuse(&bytes[..len], &format!("cut to {len} bytes"));
    }
    let mut longer = bytes.clone();
    longer.push(0);
    refuse(&longer, "a byte too many");
    static OTHER: Mutex<World<32>> = Mutex::new(World::new());
    let mut other = OTHER.lock().unwrap_or_else(PoisonError::into_inner);
    let bad = other.load(&bytes).expect_err("another size");
    assert_eq!(bad, BadSave::Value(BadBytes { offset: 6, expected: "this world's size" }));
    harness.world.load(&bytes).expect("the whole bytes");
    harness.check_invariants();
}

/// Writes the checksum of the changed bytes.
fn write_checksum(bytes: &mut [u8]) {
    let sum = checksum(&bytes[BODY..]);
    bytes[SUM..BODY].copy_from_slice(&sum.to_le_bytes());
}

#[derive(Clone, Debug)]
enum Forgery {
    Flip(prop::sample::Index, u8),
    Set(prop::sample::Index, u8),
    Cut(prop::sample::Index),
    Swap(prop::sample::Index, prop::sample::Index),
}

impl Forgery {
    /// Changes one of the first `range` bytes of the body.
    fn apply_to(&self, bytes: &mut Vec<u8>, range: usize) {
        let range = range.min(bytes.len() - BODY).max(1);
        let at = |index: &prop::sample::Index| BODY + index.index(range);
        match self {
            Forgery::Flip(i, bit) => bytes[at(i)] ^= 1 << bit,
            Forgery::Set(i, value) => bytes[at(i)] = *value,
            Forgery::Swap(i, j) => bytes.swap(at(i), at(j)),
            Forgery::Cut(i) => bytes.truncate((at(i) + 1).max(BODY + 1)),
        }
    }
}

fn any_forgeries() -> impl Strategy<Value = Forgery> {
    let at = any::<prop::sample::Index>;
    prop_oneof![
        4 => (at(), 0..8u8).prop_map(|(at, bit)| Forgery::Flip(at, bit)),
        3 => (at(), prop_oneof![Just(0), Just(255), any::<u8>()]).prop_map(|(at, v)| Forgery::Set(at, v)),
        1 => at().prop_map(Forgery::Cut),
        2 => (at(), at()).prop_map(|(a, b)| Forgery::Swap(a, b)),
    ]
}

/// A harness with saved sessions of each kind.
struct Lives<const K: usize> {
    harness: WorldHarness<64, K>,
    saves: [Vec<u8>; 3],
}

impl<const K: usize> Lives<K> {
    const fn new() -> Self {
        Lives { harness: WorldHarness::new(), saves: [const { Vec::new() }; 3] }
    }
}

fn load_forged<const K: usize>(
    lives: &Mutex<Lives<K>>,
    kind: u64,
    early: bool,
    forgeries: &[Forgery],
    seed: u64,
) -> Result<(), TestCaseError> {
    let Lives { harness, saves } = &mut *lives.lock().unwrap_or_else(PoisonError::into_inner);
    let save = &mut saves[kind as usize];
    if save.is_empty() {
        *save = save_after_visit(harness, 12 + kind);
    }
    let mut bytes = save.clone();
    // The state comes first, and contains most of the values that can be invalid.
    let range = if early { 600 } else { bytes.len() - BODY };
    forgeries.iter().for_each(|forgery| forgery.apply_to(&mut bytes, range));
    write_checksum(&mut bytes);
    harness.world.clear();
    let empty = harness.world.digest();
    match harness.world.load(&bytes) {
        Err(bad) => {
            prop_assert!(bad.offset() <= bytes.len());
            prop_assert_eq!(harness.world.digest(), empty);
            prop_assert_eq!(harness.world.session_state(), SessionState::Waiting);
        }
        Ok(()) => {
            prop_assert_eq!(harness.world.digest(), harness.world.recompute_digest());
            let volume = harness.world.volume();
            prop_assert!(volume.are_ranges_tight() && volume.is_saturated());
        }
    }
    let mut visitor = RandomVisitor::new(seed);
    for tick in 0..12 {
        let mut input = visitor.next_input();
        input.commands |= [commands::UNDO, commands::REDO, 0][tick % 3];
        harness.step(&input);
    }
    Ok(())
}

proptest! {
    #![proptest_config(random_cases(40))]

    /// Forged bytes cause no panic, neither on loading nor later. A rejected save leaves the empty world.
    #[test]
    fn forged_bytes_never_panic(
        kind in 0..3u64,
        early in any::<bool>(),
        forgeries in proptest::collection::vec(any_forgeries(), 1..6),
        seed in any::<u64>(),
    ) {
        static LIVED: Mutex<Lives<1>> = Mutex::new(Lives::new());
        static LIVED_IN_TWO: Mutex<Lives<2>> = Mutex::new(Lives::new());
        load_forged(&LIVED, kind, early, &forgeries, seed)?;
        load_forged(&LIVED_IN_TWO, kind, early, &forgeries, seed)?;
    }

    /// Every saved byte is part of the digest: a changed save that loads has another digest.
    #[test]
    fn each_saved_bit_counts_in_the_digest(
        kind in 0..3u64,
        early in any::<bool>(),
        at in any::<prop::sample::Index>(),
        bit in 0..8u8,
    ) {
        static LIVED: Mutex<[(Vec<u8>, u64); 3]> = Mutex::new([const { (Vec::new(), 0) }; 3]);
        let mut harnesses = HARNESSES.lock().unwrap_or_else(PoisonError::into_inner);
        let harness = &mut harnesses[0];
        let mut lived = LIVED.lock().unwrap_or_else(PoisonError::into_inner);
        if lived[kind as usize].0.is_empty() {
            let bytes = save_after_visit(harness, 15 + kind);
            lived[kind as usize] = (bytes, harness.world.digest());
        }
        let (bytes, digest) = &lived[kind as usize];
        let mut bytes = bytes.clone();
        let range = if early { 600 } else { bytes.len() - BODY };
        bytes[BODY + at.index(range)] ^= 1 << bit;
        write_checksum(&mut bytes);
        if harness.world.load(&bytes).is_ok() {
            prop_assert_ne!(harness.world.digest(), *digest);
            prop_assert!(save_to_vec(&harness.world) == bytes, "what was loaded is saved as it was");
        }
    }
}
