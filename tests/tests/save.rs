//! Saved worlds: they go on as if uninterrupted, and bytes that are none are turned away.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use paros_core::checksum;
use paros_core::input::{Input, Mode, commands};
use paros_core::limits::save_bytes;
use paros_core::size::{Grid, Size};
use paros_core::world::{Session, World};
use paros_tests::models::studio::{Studio, same};
use paros_tests::models::visitor::{Dice, Visitor};
use proptest::prelude::*;

static STUDIOS: Mutex<[Studio<64>; 2]> = Mutex::new([const { Studio::new() }; 2]);

/// Where the checksum lies, and what it covers begins.
const SUM: usize = 8;
const BODY: usize = 16;

fn save(world: &World<64>) -> Vec<u8> {
    let mut bytes = vec![0; world.save(&mut [])];
    let len = world.save(&mut bytes);
    assert_eq!(len, bytes.len());
    assert!(len <= save_bytes(64), "{len} bytes");
    bytes
}

/// Sheets joined at one edge in turn: a search for islands takes many ticks.
fn sheets([x, _, z]: [usize; 3]) -> bool {
    z % 2 == 0 || x == if z % 4 == 1 { 0 } else { 63 }
}

/// A lump, a figure in a lump, a comb that keeps a pass in flight.
fn begin(studio: &mut Studio<64>, kind: u64) {
    match kind {
        0 => studio.start(Mode::FreeForm),
        1 => studio.start(Mode::Constrained { figure: 0 }),
        _ => studio.start_from(|[x, y, z]| sheets([z, x, y]) && (z < 63 || y > 5)),
    };
}

/// Goes back `BACK` ticks on every tick and comes forward again, in another world, from bytes.
#[test]
fn a_world_loaded_goes_on_as_if_uninterrupted() {
    const BACK: usize = 6;
    let mut studios = STUDIOS.lock().unwrap_or_else(PoisonError::into_inner);
    let [one, other] = &mut *studios;
    let (mut in_flight, mut in_stroke) = (0, 0);
    for kind in 0..3 {
        begin(one, kind);
        begin(other, kind);
        let idle = one.world.part_digests()[3].1;
        let mut visitor = Visitor::new(50 + kind);
        let mut past: VecDeque<(Vec<u8>, Input, u64)> = VecDeque::new();
        for tick in 0..220 {
            let input = visitor.act();
            let before = save(&one.world);
            in_flight += u32::from(one.world.part_digests()[3].1 != idle);
            in_stroke += u32::from(one.world.hand(0).trigger || one.world.hand(1).trigger);
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
        assert!(same(other.world.volume().maps(), one.world.volume().maps()));
        assert_eq!(save(&other.world), save(&one.world));
        other.check();
    }
    assert!(in_flight > 20 && in_stroke > 100, "{in_flight} mid-pass, {in_stroke} mid-stroke");
}

#[test]
fn after_a_load_everything_is_dirty_until_the_next_tick() {
    let mut studios = STUDIOS.lock().unwrap_or_else(PoisonError::into_inner);
    let studio = &mut studios[0];
    begin(studio, 0);
    let bytes = save(&studio.world);
    studio.step(&Input::default());
    studio.world.load(&bytes).expect("a saved world");
    assert!(!studio.world.dirty().is_empty() && studio.world.events().is_empty());
    studio.step(&Input::default());
    assert!(studio.world.dirty().is_empty());
}

/// What the bound leaves for all that is of one length, beside two sets of maps.
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
    assert!(rest(&LARGE) <= 1024, "{} bytes", rest(&LARGE));
}

#[test]
fn a_buffer_too_small_is_told_by_the_length() {
    let mut studios = STUDIOS.lock().unwrap_or_else(PoisonError::into_inner);
    let studio = &mut studios[0];
    begin(studio, 1);
    let bytes = save(&studio.world);
    for short in [0, 1, BODY, bytes.len() / 2, bytes.len() - 1] {
        assert_eq!(studio.world.save(&mut vec![0; short]), bytes.len());
    }
    let mut long = vec![7; bytes.len() + 9];
    assert_eq!(studio.world.save(&mut long), bytes.len());
    assert!(long[..bytes.len()] == bytes && long[bytes.len()..] == [7; 9]);
}

/// Plays a while, so that there is something to lose.
fn lived_in(studio: &mut Studio<64>, seed: u64) -> Vec<u8> {
    begin(studio, seed % 3);
    let mut visitor = Visitor::new(seed);
    (0..120).for_each(|_| studio.step(&visitor.act()));
    save(&studio.world)
}

#[test]
fn bytes_that_were_hurt_leave_the_world_as_it_was() {
    let mut studios = STUDIOS.lock().unwrap_or_else(PoisonError::into_inner);
    let studio = &mut studios[0];
    let bytes = lived_in(studio, 6);
    studio.step(&Input::default());
    let digest = studio.world.digest();
    let mut dice = Dice::new(9);
    let mut refuse = |bytes: &[u8], what: &str| {
        assert!(studio.world.load(bytes).is_err(), "{what}");
        assert_eq!(studio.world.digest(), digest, "{what}");
    };
    for at in (0..40).chain((0..160).map(|_| dice.roll(bytes.len() as u64) as usize)) {
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
    assert_eq!((bad.offset, bad.expected), (6, "this world's size"));
    studio.world.load(&bytes).expect("the whole bytes");
    studio.check();
}

/// Makes the checksum right.
fn forge(bytes: &mut [u8]) {
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

fn forgeries() -> impl Strategy<Value = Forgery> {
    let at = any::<prop::sample::Index>;
    prop_oneof![
        4 => (at(), 0..8u8).prop_map(|(at, bit)| Forgery::Flip(at, bit)),
        3 => (at(), prop_oneof![Just(0), Just(255), any::<u8>()]).prop_map(|(at, v)| Forgery::Set(at, v)),
        1 => at().prop_map(Forgery::Cut),
        2 => (at(), at()).prop_map(|(a, b)| Forgery::Swap(a, b)),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// No panic, now or later; what is turned away leaves the empty world.
    #[test]
    fn forged_bytes_never_panic(
        kind in 0..3u64,
        early in any::<bool>(),
        forgeries in proptest::collection::vec(forgeries(), 1..6),
        seed in any::<u64>(),
    ) {
        static LIVED: Mutex<[Vec<u8>; 3]> = Mutex::new([const { Vec::new() }; 3]);
        let mut studios = STUDIOS.lock().unwrap_or_else(PoisonError::into_inner);
        let studio = &mut studios[0];
        let mut lived = LIVED.lock().unwrap_or_else(PoisonError::into_inner);
        if lived[kind as usize].is_empty() {
            lived[kind as usize] = lived_in(studio, 12 + kind);
        }
        let mut bytes = lived[kind as usize].clone();
        // The state comes first, and is where most of what can be wrong is.
        let range = if early { 600 } else { bytes.len() - BODY };
        for forgery in forgeries {
            let at = |index: prop::sample::Index| BODY + index.index(range.min(bytes.len() - BODY).max(1));
            match forgery {
                Forgery::Flip(i, bit) => { let i = at(i); bytes[i] ^= 1 << bit }
                Forgery::Set(i, value) => { let i = at(i); bytes[i] = value }
                Forgery::Swap(i, j) => { let (i, j) = (at(i), at(j)); bytes.swap(i, j) }
                Forgery::Cut(i) => { let len = at(i) + 1; bytes.truncate(len.max(BODY + 1)) }
            }
        }
        forge(&mut bytes);
        studio.world.clear();
        let empty = studio.world.digest();
        match studio.world.load(&bytes) {
            Err(bad) => {
                prop_assert!(bad.offset <= bytes.len());
                prop_assert_eq!(studio.world.digest(), empty);
                prop_assert_eq!(studio.world.session(), Session::Waiting);
            }
            Ok(()) => prop_assert_eq!(studio.world.digest(), studio.world.recompute_digest()),
        }
        let mut visitor = Visitor::new(seed);
        for tick in 0..12 {
            let mut input = visitor.act();
            input.commands |= [commands::UNDO, commands::REDO, 0][tick % 3];
            studio.step(&input);
        }
    }

    /// Whatever is saved is part of the digest: what loads from other bytes has another.
    #[test]
    fn each_saved_bit_counts_in_the_digest(
        kind in 0..3u64,
        early in any::<bool>(),
        at in any::<prop::sample::Index>(),
        bit in 0..8u8,
    ) {
        static LIVED: Mutex<[(Vec<u8>, u64); 3]> = Mutex::new([const { (Vec::new(), 0) }; 3]);
        let mut studios = STUDIOS.lock().unwrap_or_else(PoisonError::into_inner);
        let studio = &mut studios[0];
        let mut lived = LIVED.lock().unwrap_or_else(PoisonError::into_inner);
        if lived[kind as usize].0.is_empty() {
            let bytes = lived_in(studio, 15 + kind);
            lived[kind as usize] = (bytes, studio.world.digest());
        }
        let (bytes, digest) = &lived[kind as usize];
        let mut bytes = bytes.clone();
        let range = if early { 600 } else { bytes.len() - BODY };
        bytes[BODY + at.index(range)] ^= 1 << bit;
        forge(&mut bytes);
        if studio.world.load(&bytes).is_ok() {
            prop_assert_ne!(studio.world.digest(), *digest);
            prop_assert!(save(&studio.world) == bytes, "what was loaded is saved as it was");
        }
    }
}
