//! Random sessions: the invariants hold after every tick, and the input alone decides the result.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::codec::ByteReader;
use paros_core::internals::ByteWriter;
use paros_core::session::{RawPose, SessionMode, SessionState};
use paros_core::{HandInput, TickInput, WorldEvent};
use paros_models::random_visitor::{RandomSource, RandomVisitor, arbitrary_input};
use paros_models::world_harness::{WorldHarness, maps_are_equal};

static SMALL: Mutex<[WorldHarness<64>; 2]> = Mutex::new([const { WorldHarness::new() }; 2]);
static LARGE: Mutex<WorldHarness<128>> = Mutex::new(WorldHarness::new());

const MODES: [SessionMode; 3] =
    [SessionMode::FreeForm, SessionMode::Constrained { figure: 0 }, SessionMode::Creative];

/// Counts of a session's events: the test fails if the visitor hardly touches the stone.
#[derive(Default, Debug)]
struct EventTally {
    edits: u32,
    islands: u32,
    rewinds: u32,
    took: u32,
    finished: u32,
}

impl EventTally {
    fn count(&mut self, events: &[WorldEvent]) {
        for event in events {
            match event {
                WorldEvent::Edited { report, .. } if report.changed_volume() => self.edits += 1,
                WorldEvent::Islands(report) if report.removed > 0 => self.islands += 1,
                WorldEvent::Undone | WorldEvent::Redone => self.rewinds += 1,
                WorldEvent::Took { .. } => self.took += 1,
                WorldEvent::Finished => self.finished += 1,
                _ => {}
            }
        }
    }
}

#[test]
fn volumes_and_digests_hold_after_every_tick_of_restless_sessions() {
    let mut harnesses = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let harness = &mut harnesses[0];
    let mut tally = EventTally::default();
    for (seed, mode) in (0..12).zip(MODES.into_iter().chain([SessionMode::Own]).cycle()) {
        match mode {
            // Thin structures, from which pieces come off.
            SessionMode::Own => harness
                .start_from_voxels(|[x, y, z]| y < 4 || x % 9 < 2 && (z % 7 < 2 || y % 16 == 15)),
            mode => harness.start_session(mode),
        };
        let mut visitor = RandomVisitor::new(seed);
        for _ in 0..400 {
            harness.step(&visitor.next_input());
            harness.check_invariants();
            tally.count(harness.world.events());
        }
    }
    assert!(
        tally.edits > 300 && tally.islands > 0 && tally.rewinds > 10 && tally.took > 50,
        "{tally:?}"
    );
}

#[test]
fn all_tools_on_the_lump_at_the_size_that_counts() {
    let mut harness = LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut tally = EventTally::default();
    for (seed, mode) in [(26, SessionMode::FreeForm), (27, SessionMode::Constrained { figure: 0 })]
    {
        harness.start_session(mode);
        let mut visitor = RandomVisitor::new(seed);
        for _ in 0..400 {
            harness.step(&visitor.next_input());
            harness.check_invariants();
            tally.count(harness.world.events());
        }
    }
    assert!(tally.edits > 30, "{tally:?}");
}

/// Feeds arbitrary inputs; overflow checks are on in this profile.
#[test]
fn any_input_at_all_is_survived() {
    let mut harnesses = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let harness = &mut harnesses[0];
    harness.start_session(SessionMode::FreeForm);
    let mut dice = RandomSource::new(5);
    let mut tally = EventTally::default();
    for tick in 0..8000 {
        let mut input = arbitrary_input(&mut dice);
        if harness.world.session_state() != SessionState::Sculpting && dice.one_in(10) {
            input.start = MODES[dice.below(3) as usize];
        }
        harness.step(&input);
        tally.count(harness.world.events());
        if tick % 8 == 0 {
            harness.check_invariants();
        }
    }
    // Most poses are in the stone, where the bit can't move.
    assert!(tally.edits > 50 && tally.took > 100 && tally.finished > 5, "{tally:?}");
}

/// Fuzzes with arbitrary bytes that parse as an input.
#[test]
fn any_bytes_that_are_an_input_are_survived() {
    let mut harnesses = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let harness = &mut harnesses[0];
    harness.start_session(SessionMode::FreeForm);
    let mut dice = RandomSource::new(6);
    let mut read = 0;
    for _ in 0..20_000 {
        let mut bytes: Vec<u8> = (0..TickInput::BYTES).map(|_| dice.next_bits() as u8).collect();
        // Narrows the pointer command's kind and the mode, which random bytes seldom hit.
        (bytes[110], bytes[114]) = (bytes[110] % 5, bytes[114] % 9);
        // Narrows the visit's presence and command, and zeroes the bytes after it.
        (bytes[116], bytes[117]) = (bytes[116] % 8, bytes[117] % 10);
        bytes[118..].fill(0);
        if let Ok(input) = TickInput::read(&mut ByteReader::new(&bytes)) {
            let mut again = vec![0; TickInput::BYTES];
            input.write(&mut ByteWriter::new(&mut again));
            assert_eq!(TickInput::read(&mut ByteReader::new(&again)), Ok(input));
            harness.step(&input);
            read += 1;
        }
    }
    harness.check_invariants();
    assert!(read > 2, "{read} of the bytes were inputs");
}

#[test]
fn two_worlds_make_the_same_digests() {
    let mut harnesses = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let [one, other] = &mut *harnesses;
    // An earlier session in the same world leaves no trace.
    other.start_session(SessionMode::Constrained { figure: 0 });
    let mut stranger = RandomVisitor::new(99);
    (0..200).for_each(|_| other.step(&stranger.next_input()));
    one.start_session(SessionMode::FreeForm);
    other.start_session(SessionMode::FreeForm);
    let (mut a, mut b) = (RandomVisitor::new(31), RandomVisitor::new(31));
    for tick in 0..500 {
        one.step(&a.next_input());
        other.step(&b.next_input());
        assert_eq!(one.world.digest(), other.world.digest(), "tick {tick}");
        assert_eq!(one.world.events(), other.world.events());
    }
    assert!(maps_are_equal(one.world.volume().maps(), other.world.volume().maps()));
}

fn grip_and_aim(hand: &mut HandInput) -> [&mut RawPose; 2] {
    [&mut hand.grip, &mut hand.aim]
}

/// An unusable pose is replaced by the last usable pose.
#[test]
fn unusable_poses_keep_the_last_good_one() {
    let mut harnesses = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let [one, other] = &mut *harnesses;
    one.start_session(SessionMode::FreeForm);
    other.start_session(SessionMode::FreeForm);
    let mut visitor = RandomVisitor::new(43);
    let mut dice = RandomSource::new(42);
    let bad = [[0, 0, 0, 0], [1, 0, 0, -1], [3, -4, 5, 2], [0, 18, 18, 0]];
    let mut last = [[RawPose::default(); 2]; 2];
    let mut edits = 0;
    for tick in 0..600 {
        let good = visitor.next_input();
        let (mut broken, mut repaired) = (good, good);
        for (i, last) in last.iter_mut().enumerate() {
            let pairs = grip_and_aim(&mut broken.hands[i])
                .into_iter()
                .zip(grip_and_aim(&mut repaired.hands[i]));
            for ((broken, repaired), last) in pairs.zip(last) {
                if tick > 0 && dice.one_in(4) {
                    broken.rotation = bad[dice.below(4) as usize];
                    broken.position = [0; 3].map(|_: i32| dice.next_bits() as i32);
                }
                if broken.to_clamped_metres().is_none() {
                    *repaired = *last;
                } else if good.hands[i].tracked {
                    *last = *broken;
                }
            }
        }
        one.step(&broken);
        other.step(&repaired);
        assert_eq!(one.world.digest(), other.world.digest(), "tick {tick}");
        edits +=
            one.world.events().iter().filter(|e| matches!(e, WorldEvent::Edited { .. })).count();
    }
    assert!(edits > 20, "{edits} edits");
}

#[test]
fn poses_that_are_no_poses_become_the_unusable_one() {
    let ok = Quat::IDENTITY;
    let rotations = [
        Quat::from_xyzw(0.0, 0.0, 0.0, 0.0),
        Quat::from_xyzw(1e-40, -1e-42, 1e-45, 0.0),
        Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0),
        Quat::from_xyzw(0.0, f32::INFINITY, 0.0, 1.0),
        Quat::from_xyzw(f32::MAX, f32::MAX, 0.0, 1.0),
    ];
    for rotation in rotations {
        assert_eq!(RawPose::quantise(Vec3::ONE, rotation).to_clamped_metres(), None, "{rotation}");
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(RawPose::quantise(Vec3::new(0.0, bad, 0.0), ok).to_clamped_metres(), None);
    }
    let (far, _) = RawPose::quantise(Vec3::splat(f32::MAX), ok)
        .to_clamped_metres()
        .expect("a pose, held in reach");
    assert_eq!(far, Vec3::splat(16.0));
    let turned = Quat::from_xyzw(0.1, -0.2, 0.3, 0.4);
    let (position, rotation) =
        RawPose::quantise(Vec3::new(0.1, 1.2, -0.3), turned).to_clamped_metres().expect("a pose");
    assert!(position.distance(Vec3::new(0.1, 1.2, -0.3)) < 2e-5);
    assert!(rotation.dot(turned.normalize()) > 0.999_999);
}
