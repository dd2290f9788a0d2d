//! Worlds of several intervals a column: the invariants after every tick, save and load, and size.

use std::mem::size_of;
use std::sync::{Mutex, PoisonError};

use paros_core::World;
use paros_core::codec::{BadBytes, BadSave};
use paros_core::limits::max_save_bytes;
use paros_core::session::SessionMode;
use paros_core::volume::{Grid, Size};
use paros_models::random_visitor::RandomVisitor;
use paros_models::world_harness::WorldHarness;

/// Runs random visitors in every mode. Each session is saved once and continues identically in another world.
fn check_sessions<const N: usize, const K: usize>(harnesses: &Mutex<[WorldHarness<N, K>; 2]>)
where
    Grid<N>: Size,
{
    let [harness, other] = &mut *harnesses.lock().unwrap_or_else(PoisonError::into_inner);
    let mut gaps = 0;
    for (seed, mode) in
        [SessionMode::FreeForm, SessionMode::Constrained { figure: 0 }, SessionMode::Creative]
            .into_iter()
            .cycle()
            .take(6)
            .enumerate()
    {
        harness.start_session(mode);
        let mut visitor = RandomVisitor::new(seed as u64);
        for tick in 0..400 {
            harness.step(&visitor.next_input());
            if tick % 20 == 0 {
                harness.check_invariants();
            }
        }
        gaps += count_gaps(&harness.world);
        let mut bytes = vec![0; max_save_bytes(N, K)];
        let len = harness.world.save(&mut bytes);
        other.start_session(mode);
        other.world.load(&bytes[..len]).unwrap();
        for _ in 0..60 {
            let input = visitor.next_input();
            harness.step(&input);
            other.step(&input);
            assert_eq!(harness.world.digest(), other.world.digest(), "seed {seed}");
        }
        other.check_invariants();
    }
    assert!((K == 1) == (gaps == 0), "{gaps} gaps in worlds of {K} intervals");
}

fn count_gaps<const N: usize, const K: usize>(world: &World<N, K>) -> usize
where
    Grid<N>: Size,
{
    let axes = paros_core::volume::Axis::ALL.into_iter();
    let lines =
        axes.flat_map(|axis| (0..N).map(move |line| world.volume().maps().line(axis, line)));
    lines.flatten().filter(|column| column.has_gaps()).count()
}

#[test]
fn sessions_of_one_interval() {
    static HARNESSES: Mutex<[WorldHarness<64, 1>; 2]> =
        Mutex::new([const { WorldHarness::new() }; 2]);
    check_sessions(&HARNESSES);
}

#[test]
fn sessions_of_two_intervals() {
    static HARNESSES: Mutex<[WorldHarness<64, 2>; 2]> =
        Mutex::new([const { WorldHarness::new() }; 2]);
    check_sessions(&HARNESSES);
}

#[test]
fn sessions_of_four_intervals() {
    static HARNESSES: Mutex<[WorldHarness<64, 4>; 2]> =
        Mutex::new([const { WorldHarness::new() }; 2]);
    check_sessions(&HARNESSES);
}

/// A save states its number of intervals, and a world with another number rejects it.
#[test]
fn a_save_of_other_intervals_is_refused() {
    static ONE: World<16, 1> = World::new();
    static TWO: Mutex<World<16, 2>> = Mutex::new(World::new());
    let mut bytes = vec![0; max_save_bytes(16, 2)];
    let len = ONE.save(&mut bytes);
    let mut two = TWO.lock().unwrap_or_else(PoisonError::into_inner);
    let error = two.load(&bytes[..len]).unwrap_err();
    assert_eq!((error, error.offset()), (BadSave::Intervals { saved: 1, here: 2 }, 4));
    assert_eq!(error.to_string(), "intervals a column: 1 as saved, 2 here");
    let len = two.save(&mut bytes);
    assert_eq!(two.load(&bytes[..len]), Ok(()));
    static FOUR: Mutex<World<16, 4>> = Mutex::new(World::new());
    let mut four = FOUR.lock().unwrap_or_else(PoisonError::into_inner);
    let error = BadSave::Intervals { saved: 2, here: 4 };
    assert_eq!(four.load(&bytes[..len]), Err(error));
    for version in [2, 6, 6 << 8, 6 << 8 | 1, 6 << 8 | 5, 4 << 8 | 2] {
        bytes[4..6].copy_from_slice(&u16::to_le_bytes(version));
        let expected = "save version 5, or 6 of 2 to 4 intervals a column";
        let bad = BadBytes { offset: 4, expected };
        assert_eq!(two.load(&bytes[..len]), Err(BadSave::Value(bad)), "{version:#x}");
    }
}

#[test]
fn a_world_of_two_intervals_fits_its_memory() {
    let sizes = (size_of::<World<128, 2>>(), size_of::<World<256, 2>>());
    println!("World<128, 2> is {} bytes, World<256, 2> {}", sizes.0, sizes.1);
    assert!(sizes.0 <= 3 << 19 && sizes.1 <= 8 << 20, "{sizes:?}");
}
