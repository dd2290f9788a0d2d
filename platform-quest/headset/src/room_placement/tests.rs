//! Room placement for arbitrary heads: the stool is in front of the visitor, the floor stays, and an invalid
//! pose never moves the room.

use core::f32::consts::{FRAC_PI_2, PI};

use glam::{Quat, Vec3};
use paros_core::internals::{RoomPose, STOOL_TOP};

use super::{PATIENCE_TICKS, PlacementNeed, RoomPlacement, RoomTransform, STEADY_TICKS};
use paros_shell::headset::height_step::HeightStep;

/// A linear congruential generator: the same numbers in each run.
struct Dice(u32);

impl Dice {
    fn within(&mut self, low: f32, high: f32) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        low + (high - low) * (self.0 >> 8) as f32 / (1 << 24) as f32
    }
}

fn head(position: Vec3, yaw: f32, pitch: f32, roll: f32) -> RoomPose {
    let rotation =
        Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch) * Quat::from_rotation_z(roll);
    (position, rotation)
}

/// Places the room by a head that doesn't move. Returns the number of ticks that it took.
fn place(placement: &mut RoomPlacement, in_runtime: RoomPose) -> Option<u32> {
    (1..=PATIENCE_TICKS).find(|_| {
        let seen = placement.room().to_room(in_runtime);
        placement.observe_head(Some(seen)).is_some()
    })
}

/// Asserts that the stool is in front of a head of this yaw, within a centimetre and a degree, and at its own
/// height.
fn assert_stool_is_before(room: RoomTransform, in_runtime: RoomPose, yaw: f32) {
    let (stool, turn) = room.to_runtime((STOOL_TOP, Quat::IDENTITY));
    let below = Vec3::new(in_runtime.0.x, 0.0, in_runtime.0.z);
    let expected = below + Quat::from_rotation_y(yaw) * STOOL_TOP;
    assert!(stool.distance(expected) < 0.01, "{stool} and not {expected}");
    let off = turn.angle_between(Quat::from_rotation_y(yaw));
    assert!(off < PI / 180.0, "off by {off} at {yaw}");
    assert!((stool.y - STOOL_TOP.y).abs() < 1e-5, "the floor is kept");
    // Up stays up.
    assert!((turn * Vec3::Y).distance(Vec3::Y) < 1e-5);
}

#[test]
fn the_stool_is_before_any_head() {
    let mut dice = Dice(7);
    for i in 0..20_000 {
        let height = dice.within(0.3, 2.5);
        let position = Vec3::new(dice.within(-5.0, 5.0), height, dice.within(-5.0, 5.0));
        let (yaw, pitch) = (dice.within(-PI, PI), dice.within(-1.3, 1.3));
        let in_runtime = head(position, yaw, pitch, dice.within(-1.2, 1.2));
        let mut placement = RoomPlacement::default();
        if i % 2 == 0 {
            // The room has been placed before.
            let before = head(position + Vec3::X, dice.within(-PI, PI), 0.0, 0.0);
            placement.request(PlacementNeed::Anyhow);
            place(&mut placement, before).expect("a place");
        }
        placement.request(PlacementNeed::Anyhow);
        let ticks = place(&mut placement, in_runtime).expect("a place");
        assert!(ticks >= STEADY_TICKS);
        assert_stool_is_before(placement.room(), in_runtime, yaw);
        let seen = placement.room().to_room(in_runtime);
        assert!(seen.0.distance(Vec3::Y * height) < 0.01, "above the origin: {}", seen.0);
        assert_eq!(placement.observe_head(Some(seen)), None, "once");
    }
}

#[test]
fn a_head_that_looks_straight_up_or_down_has_a_heading() {
    for i in 0..360u16 {
        let yaw = f32::from(i).to_radians() - PI;
        for pitch in [-FRAC_PI_2, -1.5, -1.32, 1.32, 1.5, FRAC_PI_2] {
            let in_runtime = head(Vec3::new(1.0, 1.6, -2.0), yaw, pitch, 0.0);
            let mut placement = RoomPlacement::default();
            placement.request(PlacementNeed::Anyhow);
            // The placement waits for a better pose until its patience ends.
            assert_eq!(place(&mut placement, in_runtime), Some(PATIENCE_TICKS));
            assert_stool_is_before(placement.room(), in_runtime, yaw);
        }
    }
}

#[test]
fn to_the_runtime_and_back_is_the_same_pose() {
    let mut dice = Dice(3);
    for _ in 0..1000 {
        let mut any = |far: f32| {
            let position = Vec3::new(dice.within(-far, far), 1.5, dice.within(-far, far));
            head(position, dice.within(-PI, PI), dice.within(-1.0, 1.0), dice.within(-1.0, 1.0))
        };
        let (room, pose) = (RoomTransform::before_head(any(5.0)).expect("a head"), any(2.0));
        let (position, rotation) = room.to_room(room.to_runtime(pose));
        assert!(position.distance(pose.0) < 1e-5 && rotation.angle_between(pose.1) < 2e-3);
    }
}

#[test]
fn what_is_no_pose_never_moves_the_room_nor_spreads() {
    let level = head(Vec3::new(2.0, 1.6, 1.0), 1.0, 0.0, 0.0);
    let nan = Quat::from_xyzw(f32::NAN, 0.0, 0.0, 1.0);
    let bad: [RoomPose; 7] = [
        (Vec3::NAN, Quat::IDENTITY),
        (Vec3::new(f32::INFINITY, 1.6, 0.0), Quat::IDENTITY),
        (Vec3::new(0.0, f32::NAN, 0.0), Quat::IDENTITY),
        (Vec3::new(1e6, 1.6, 0.0), Quat::IDENTITY),
        (Vec3::Y, nan),
        (Vec3::Y, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0)),
        // On its side and looking down its own shoulder line: it has no heading.
        (Vec3::Y, Quat::from_rotation_x(-FRAC_PI_2) * Quat::from_rotation_y(FRAC_PI_2)),
    ];
    for (i, pose) in bad.into_iter().enumerate().take(6) {
        let mut placement = RoomPlacement::default();
        placement.request(PlacementNeed::Anyhow);
        for _ in 0..2 * PATIENCE_TICKS {
            assert_eq!(placement.observe_head(Some(pose)), None, "case {i}");
        }
        assert_eq!(placement.room(), RoomTransform::default());
        assert!(place(&mut placement, level).is_some());
        assert_stool_is_before(placement.room(), level, 1.0);
    }
    for pose in bad {
        let room = RoomTransform::before_head(pose).unwrap_or_default();
        assert!(room.yaw.is_finite() && room.origin.is_finite());
    }
}

#[test]
fn a_head_that_is_being_put_on_is_waited_for() {
    let mut dice = Dice(11);
    let mut placement = RoomPlacement::default();
    placement.request(PlacementNeed::Anyhow);
    for _ in 0..200 {
        // The headset is taken from a table and turned about.
        let position = Vec3::new(dice.within(-0.5, 0.5), dice.within(0.7, 1.6), 0.0);
        let seen = head(position, dice.within(-1.0, 1.0), dice.within(-1.0, 1.0), 0.0);
        assert_eq!(placement.observe_head(Some(seen)), None);
    }
    let worn = head(Vec3::new(0.5, 1.6, 0.5), 0.7, -0.1, 0.0);
    for _ in 1..STEADY_TICKS {
        assert_eq!(placement.observe_head(Some(worn)), None);
    }
    // A loss of tracking restarts the wait.
    assert_eq!(placement.observe_head(None), None);
    assert_eq!(place(&mut placement, worn), Some(STEADY_TICKS));
    assert_stool_is_before(placement.room(), worn, 0.7);
}

#[test]
fn the_head_of_the_last_moment_counts() {
    let mut placement = RoomPlacement::default();
    placement.request(PlacementNeed::Anyhow);
    for i in 1..STEADY_TICKS {
        let swaying = head(Vec3::new(0.001 * i as f32, 1.6, 0.0), 0.002 * i as f32, 0.0, 0.0);
        assert_eq!(placement.observe_head(Some(swaying)), None);
    }
    let last = head(Vec3::new(0.05, 1.6, 0.0), 0.1, 0.0, 0.0);
    assert!(placement.observe_head(Some(last)).is_some());
    assert_stool_is_before(placement.room(), last, 0.1);
}

#[test]
fn a_room_that_is_near_enough_stays_unless_another_visitor_has_come() {
    let mut placement = RoomPlacement::default();
    let near = head(Vec3::new(0.1, 1.6, 0.35), 0.3, -0.3, 0.0);
    let far = head(Vec3::new(0.1, 1.6, 0.6), 0.3, -0.3, 0.0);
    let aside = head(Vec3::new(0.1, 1.6, 0.2), 0.8, -0.3, 0.0);
    placement.request(PlacementNeed::IfFar);
    assert_eq!(place(&mut placement, near), None);
    for (pose, yaw) in [(far, 0.3), (aside, 0.8)] {
        placement.request(PlacementNeed::IfFar);
        assert!(place(&mut placement, pose).is_some());
        assert_stool_is_before(placement.room(), pose, yaw);
        assert_eq!(placement.restart_in_new_space(), Some(RoomTransform::default()));
        assert_eq!(placement.room(), RoomTransform::default());
        assert_eq!(placement.restart_in_new_space(), None, "it lies there already");
    }
    placement.request(PlacementNeed::Anyhow);
    placement.request(PlacementNeed::IfFar);
    assert!(place(&mut placement, near).is_some(), "the greater need counts");
}

/// Heights of the eyes of seated, standing and tall people, in metres above the floor, and the room's height
/// step for them.
const EYES: [(f32, HeightStep); 6] = [
    (1.10, HeightStep::Low),
    (1.27, HeightStep::Low),
    (1.41, HeightStep::Middle),
    (1.62, HeightStep::Middle),
    (1.75, HeightStep::High),
    (1.95, HeightStep::High),
];

fn eyes_at(height: f32) -> RoomPose {
    head(Vec3::new(0.5, height, -1.0), 0.4, -0.2, 0.0)
}

#[test]
fn each_visitor_has_the_room_at_one_of_the_steps_whatever_it_was_before() {
    let mut placement = RoomPlacement::new(true);
    for (before, _) in EYES {
        for (eyes, step) in EYES {
            for height in [before, eyes] {
                placement.request(PlacementNeed::Anyhow);
                assert_eq!(place(&mut placement, eyes_at(height)), Some(STEADY_TICKS));
            }
            let room = placement.room();
            assert_eq!(room.height, step, "{eyes} after {before}");
            let seen = room.to_room(eyes_at(eyes)).0;
            assert!(seen.distance(Vec3::Y * (eyes - step.offset_metres())) < 0.01, "{seen}");
        }
    }
    // Without height steps the floor is the real one.
    let mut placement = RoomPlacement::new(false);
    for (eyes, _) in EYES {
        placement.request(PlacementNeed::Anyhow);
        place(&mut placement, eyes_at(eyes)).expect("a place");
        assert_eq!(placement.room().height, HeightStep::Middle);
    }
}

/// Visitors who stand up, sit down or recentre during a visit are not lifted or lowered.
#[test]
fn a_height_stays_until_the_next_visitor() {
    let mut placement = RoomPlacement::new(true);
    placement.request(PlacementNeed::Anyhow);
    place(&mut placement, eyes_at(1.2)).expect("a place");
    let seated = placement.room();
    for i in 0..20 * PATIENCE_TICKS {
        let seen = seated.to_room(eyes_at(1.1 + 0.01 * (i % 90) as f32));
        assert_eq!(placement.observe_head(Some(seen)), None);
    }
    // A recentring by the runtime: the room follows a step aside, and keeps its height.
    let level = RoomTransform { height: HeightStep::Low, ..RoomTransform::default() };
    assert_eq!(placement.restart_in_new_space(), Some(level));
    place(&mut placement, eyes_at(1.75)).expect("it is far");
    assert_eq!(placement.room(), seated);
    let near = head(Vec3::Y * 1.75, 0.0, 0.0, 0.0);
    assert_eq!(placement.restart_in_new_space(), Some(level));
    assert_eq!(place(&mut placement, near), None, "it is near");
    assert_eq!(placement.room(), level);
    placement.request(PlacementNeed::Anyhow);
    place(&mut placement, near).expect("another visitor");
    assert_eq!(placement.room().height, HeightStep::High);
}

/// Before the first visitor, the first head chooses the height, even if it is near the place.
#[test]
fn the_first_head_chooses_a_height_and_one_on_a_table_does_not() {
    let mut placement = RoomPlacement::new(true);
    assert_eq!(placement.restart_in_new_space(), None);
    assert_eq!(place(&mut placement, head(Vec3::Y * 0.4, 0.0, 0.0, 0.0)), None, "on a table");
    assert_eq!(placement.restart_in_new_space(), None);
    assert!(place(&mut placement, head(Vec3::Y * 1.2, 0.0, 0.0, 0.0)).is_some());
    assert_eq!(placement.room().height, HeightStep::Low);
    // The next head is near and the height is chosen already: nothing moves.
    placement.request(PlacementNeed::IfFar);
    assert_eq!(place(&mut placement, head(Vec3::Y * 1.75, 0.0, 0.0, 0.0)), None);
}
