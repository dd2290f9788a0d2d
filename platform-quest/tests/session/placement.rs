//! The room's place: the stool is in front of the next visitor, wherever they stand. The visitor's view,
//! reach and recorded poses are all in that room.

use std::fs;

use glam::{Quat, Vec3};
use paros_core::internals::RoomPose;
use paros_core::session::{BenchItem, RawPose, Tool};
use paros_headset::room_placement::RoomTransform;
use paros_shell::headset::height_step::HeightStep;
use paros_shell::require::require_or_skip;
use paros_shell::trace::Trace;

use super::layered::find_rig;
use super::monado::{MonadoService, MonadoTree, RemoteHand, RemoteHands, ShellEnd};
use super::{LEFT_REST, REST, RIGHT, compare_frames, eyes_at};

const HEAD: Vec3 = Vec3::new(0.0, 1.5, 0.0);

/// Places head and hands of a visitor in front of the stool, for this place of the room in the runtime's
/// space.
fn place_visitor(hands: &mut RemoteHands, room: RoomTransform) {
    let (head, rotation) = room.to_runtime((HEAD, Quat::from_rotation_x(-0.3)));
    hands.place_eyes(&eyes_at(head, rotation));
    for (hand, rest) in [LEFT_REST, REST].into_iter().enumerate() {
        hands.place_hand(hand, in_runtime(room, rest));
    }
}

fn in_runtime(room: RoomTransform, hand: RemoteHand) -> RemoteHand {
    RemoteHand { position: room.to_runtime((hand.position, Quat::IDENTITY)).0, ..hand }
}

fn metres(pose: RawPose) -> RoomPose {
    pose.to_clamped_metres().expect("a tracked pose")
}

#[test]
fn the_stool_is_before_the_next_visitor() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(sleeper) = require_or_skip(find_rig("sleeper")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "placement");
    let mut hands = monado.connect_hands();
    place_visitor(&mut hands, RoomTransform::default());
    let mut shell = monado.start_program(&sleeper, &["files", "clock", "live.trace"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    // The first visitor moves, and so counts as present.
    hands.place_eyes(&eyes_at(HEAD + Vec3::X * 0.03, Quat::from_rotation_x(-0.3)));
    shell.wait_frames(3);
    place_visitor(&mut hands, RoomTransform::default());
    assert_eq!(shell.wait_frames(10).field("room"), "0.000 0.0000 0.0000", "it lies well");
    let here = shell.capture_eyes(&monado.folder, "here");

    // The next visitor sits across the hall and looks another way.
    let origin = glam::Vec2::new(1.2, -0.7);
    let there = RoomTransform { yaw: 1.8, origin, height: HeightStep::Low };
    fs::write(monado.folder.join("clock"), "60").expect("a clock");
    place_visitor(&mut hands, there);
    let said = shell.wait_until("the room", |said| said.field("room") != "0.000 0.0000 0.0000");
    let told: Vec<f32> =
        said.field("room").split(' ').map(|number| number.parse().expect("a number")).collect();
    let off = glam::Vec2::new(told[1], told[2]).distance(origin);
    assert!((told[0] - there.yaw).abs() < 0.0174 && off < 0.01, "{told:?}");
    shell.wait_frames(5);
    let seen = shell.capture_eyes(&monado.folder, "there");
    for eye in 0..2 {
        let changed = compare_frames(&here[eye], &seen[eye]).count;
        assert!(changed < 100, "eye {eye}: {changed} pixels: both see the same from their places");
    }

    // An item on the bench is taken where it is seen.
    let home = BenchItem::Tool(Tool::Impact).home_position();
    let at_bench = in_runtime(there, RemoteHand { position: home, ..REST });
    hands.place_hand(RIGHT, at_bench);
    shell.wait_frames(3);
    hands.place_hand(RIGHT, RemoteHand { squeeze: 1.0, ..at_bench });
    shell.wait_until("the tool", |said| said.field("holds") != "[\"nothing\", \"nothing\"]");
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(
        errors.contains("the room is turned by 103 degrees, moved by 1.39 m, raised by -0.20 m"),
        "{errors}"
    );

    let trace = Trace::read(&monado.folder.join("live.trace")).expect("a trace");
    let last = trace.records().last().expect("a tick").input;
    let (head, rotation) = metres(last.head);
    assert!(head.distance(HEAD) < 0.01, "the head is above the room's origin: {head}");
    let ahead = rotation * Vec3::NEG_Z;
    assert!(ahead.x.atan2(-ahead.z).abs() < 0.0174, "it faces the stool: {ahead}");
    let (grip, turn) = metres(last.hands[RIGHT].grip);
    assert!(grip.distance(home) < 0.01, "the hand is at the tool: {grip}");
    // The driver's hand is not turned in the runtime's space, and so turned back in the room.
    assert!(turn.angle_between(there.rotation().conjugate()) < 0.0174);
    let (aim, _) = metres(last.hands[RIGHT].aim);
    assert!(aim.distance(home) < 0.05, "and so is where it aims from: {aim}");
}
