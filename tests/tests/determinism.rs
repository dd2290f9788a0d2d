//! Sessions at random: what must hold after every tick, and that nothing but the input decides.

use std::sync::{Mutex, PoisonError};

use glam::{Quat, Vec3};
use paros_core::codec::{Reader, Writer};
use paros_core::events::Event;
use paros_core::input::{HandInput, Input, Mode, RawPose};
use paros_core::world::Session;
use paros_tests::models::studio::{Studio, same};
use paros_tests::models::visitor::{Dice, Visitor, anything};

static SMALL: Mutex<[Studio<64>; 2]> = Mutex::new([const { Studio::new() }; 2]);
static LARGE: Mutex<Studio<128>> = Mutex::new(Studio::new());

const MODES: [Mode; 3] = [Mode::FreeForm, Mode::Constrained { figure: 0 }, Mode::Creative];

/// What a session came to, so that a visitor who never touches the stone is found out.
#[derive(Default, Debug)]
struct Tally {
    edits: u32,
    islands: u32,
    rewinds: u32,
    took: u32,
    finished: u32,
}

impl Tally {
    fn count(&mut self, events: &[Event]) {
        for event in events {
            match event {
                Event::Edited { report, .. } if report.changed() => self.edits += 1,
                Event::Islands(report) if report.removed > 0 => self.islands += 1,
                Event::Undone | Event::Redone => self.rewinds += 1,
                Event::Took { .. } => self.took += 1,
                Event::Finished => self.finished += 1,
                _ => {}
            }
        }
    }
}

#[test]
fn volumes_and_digests_hold_after_every_tick_of_restless_sessions() {
    let mut studios = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let studio = &mut studios[0];
    let mut tally = Tally::default();
    for (seed, mode) in (0..12).zip(MODES.into_iter().chain([Mode::Own]).cycle()) {
        match mode {
            // Spindly things, of which pieces come off.
            Mode::Own => {
                studio.start_from(|[x, y, z]| y < 4 || x % 9 < 2 && (z % 7 < 2 || y % 16 == 15))
            }
            mode => studio.start(mode),
        };
        let mut visitor = Visitor::new(seed);
        for _ in 0..400 {
            studio.step(&visitor.act());
            studio.check();
            tally.count(studio.world.events());
        }
    }
    assert!(
        tally.edits > 300 && tally.islands > 0 && tally.rewinds > 10 && tally.took > 50,
        "{tally:?}"
    );
}

#[test]
fn all_tools_on_the_lump_at_the_size_that_counts() {
    let mut studio = LARGE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut tally = Tally::default();
    for (seed, mode) in [(21, Mode::FreeForm), (22, Mode::Constrained { figure: 0 })] {
        studio.start(mode);
        let mut visitor = Visitor::new(seed);
        for _ in 0..250 {
            studio.step(&visitor.act());
            studio.check();
            tally.count(studio.world.events());
        }
    }
    assert!(tally.edits > 30, "{tally:?}");
}

/// Overflow checks are on in this profile.
#[test]
fn any_input_at_all_is_survived() {
    let mut studios = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let studio = &mut studios[0];
    studio.start(Mode::FreeForm);
    let mut dice = Dice::new(5);
    let mut tally = Tally::default();
    for tick in 0..8000 {
        let mut input = anything(&mut dice);
        if studio.world.session() != Session::Sculpting && dice.one_in(10) {
            input.start = MODES[dice.roll(3) as usize];
        }
        studio.step(&input);
        tally.count(studio.world.events());
        if tick % 8 == 0 {
            studio.check();
        }
    }
    assert!(tally.edits > 100 && tally.took > 100 && tally.finished > 5, "{tally:?}");
}

/// Inputs as a trace has them: any bytes that are inputs at all.
#[test]
fn any_bytes_that_are_an_input_are_survived() {
    let mut studios = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let studio = &mut studios[0];
    studio.start(Mode::FreeForm);
    let mut dice = Dice::new(6);
    let mut read = 0;
    for _ in 0..20_000 {
        let mut bytes: Vec<u8> = (0..Input::BYTES).map(|_| dice.bits() as u8).collect();
        // The kinds of the pointer's command and the mode, which few bytes are.
        (bytes[110], bytes[114]) = (bytes[110] % 5, bytes[114] % 9);
        if let Ok(input) = Input::read(&mut Reader::new(&bytes)) {
            let mut again = vec![0; Input::BYTES];
            input.write(&mut Writer::new(&mut again));
            assert_eq!(Input::read(&mut Reader::new(&again)), Ok(input));
            studio.step(&input);
            read += 1;
        }
    }
    studio.check();
    assert!(read > 2, "{read} of the bytes were inputs");
}

#[test]
fn two_worlds_make_the_same_digests() {
    let mut studios = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let [one, other] = &mut *studios;
    // What was in a world before it was opened again leaves no trace.
    other.start(Mode::Constrained { figure: 0 });
    let mut stranger = Visitor::new(99);
    (0..200).for_each(|_| other.step(&stranger.act()));
    one.start(Mode::FreeForm);
    other.start(Mode::FreeForm);
    let (mut a, mut b) = (Visitor::new(31), Visitor::new(31));
    for tick in 0..500 {
        one.step(&a.act());
        other.step(&b.act());
        assert_eq!(one.world.digest(), other.world.digest(), "tick {tick}");
        assert_eq!(one.world.events(), other.world.events());
    }
    assert!(same(one.world.volume().maps(), other.world.volume().maps()));
}

fn poses(hand: &mut HandInput) -> [&mut RawPose; 2] {
    [&mut hand.grip, &mut hand.aim]
}

/// A pose that can't be used is as good as the last one that could.
#[test]
fn unusable_poses_keep_the_last_good_one() {
    let mut studios = SMALL.lock().unwrap_or_else(PoisonError::into_inner);
    let [one, other] = &mut *studios;
    one.start(Mode::FreeForm);
    other.start(Mode::FreeForm);
    let mut visitor = Visitor::new(41);
    let mut dice = Dice::new(42);
    let bad = [[0, 0, 0, 0], [1, 0, 0, -1], [3, -4, 5, 2], [0, 18, 18, 0]];
    let mut last = [[RawPose::default(); 2]; 2];
    let mut edits = 0;
    for tick in 0..600 {
        let good = visitor.act();
        let (mut broken, mut repaired) = (good, good);
        for (i, last) in last.iter_mut().enumerate() {
            let pairs = poses(&mut broken.hands[i]).into_iter().zip(poses(&mut repaired.hands[i]));
            for ((broken, repaired), last) in pairs.zip(last) {
                if tick > 0 && dice.one_in(4) {
                    broken.rotation = bad[dice.roll(4) as usize];
                    broken.position = [0; 3].map(|_: i32| dice.bits() as i32);
                }
                if broken.metres().is_none() {
                    *repaired = *last;
                } else if good.hands[i].tracked {
                    *last = *broken;
                }
            }
        }
        one.step(&broken);
        other.step(&repaired);
        assert_eq!(one.world.digest(), other.world.digest(), "tick {tick}");
        edits += one.world.events().iter().filter(|e| matches!(e, Event::Edited { .. })).count();
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
        assert_eq!(RawPose::new(Vec3::ONE, rotation).metres(), None, "{rotation}");
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(RawPose::new(Vec3::new(0.0, bad, 0.0), ok).metres(), None);
    }
    let (far, _) = RawPose::new(Vec3::splat(f32::MAX), ok).metres().expect("a pose, held in reach");
    assert_eq!(far, Vec3::splat(16.0));
    let turned = Quat::from_xyzw(0.1, -0.2, 0.3, 0.4);
    let (position, rotation) =
        RawPose::new(Vec3::new(0.1, 1.2, -0.3), turned).metres().expect("a pose");
    assert!(position.distance(Vec3::new(0.1, 1.2, -0.3)) < 2e-5);
    assert!(rotation.dot(turned.normalize()) > 0.999_999);
}
