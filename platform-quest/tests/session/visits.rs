//! Visits: from putting the headset on to the badge, of a visitor who leaves early, and across a restart of
//! the program. Pictures of every screen stay in the tests' folders.

use std::fs;
use std::path::Path;
use std::time::Duration;

use glam::{Quat, Vec3};
use paros_core::session::Tool;
use paros_shell::last_use::LastUse;
use paros_shell::require::require_or_skip;

use super::handover::finished_sculptures;
use super::layered::{assert_no_violations, find_rig, inject_event, read_log};
use super::monado::{
    MonadoService, MonadoTree, RemoteHand, RemoteHands, ShellEnd, ShellProcess, StatusLine,
    wait_for,
};
use super::{
    LEFT_REST, REST, RIGHT, assert_replays_alike, carve_voxels, compare_frames, eyes_at, take_tool,
};

/// A plan whose phases have long timeouts, as a software device is slow.
const PATIENT: &str = "Welcome=900,Choice=900,Guided=900,Length=900,OffBeforeCut=900,OffAfter=900,Export=900,\
     BadgeMost=900,HandsOff=1,BadgeLeast=1,Thanks=2,Handover=900";

/// The visitor's head, in front of the stool.
const HEAD: Vec3 = Vec3::new(0.0, 1.55, 0.0);

/// Turns the head ahead or aside, by an angle in radians, and puts both hands at rest.
fn look(hands: &mut RemoteHands, yaw: f32) {
    let rotation = Quat::from_rotation_y(yaw) * Quat::from_rotation_x(-0.05);
    hands.place_eyes(&eyes_at(HEAD, rotation));
    hands.place_hand(0, LEFT_REST);
    hands.place_hand(RIGHT, REST);
}

fn start(monado: &MonadoService, layer: &Path, plan: &str, args: &[&str]) -> ShellProcess {
    let visits = ["--visits", "--visits-pin", "2026", "--visits-plan", plan];
    monado.start_layered_shell(layer, &[&visits, args].concat())
}

/// Returns the position of a button's middle in the room.
fn find_button(said: &StatusLine, action: &str) -> Option<Vec3> {
    let named = |button: &str| {
        let (name, at) = button.split_once('@')?;
        let at: Vec<f32> = at.split(' ').map(|number| number.parse().expect("a number")).collect();
        (name == action).then(|| Vec3::from_slice(&at))
    };
    said.field("buttons").split('|').find_map(named)
}

/// Returns a pose of the right hand that is aimed at a button.
fn aim_at(shell: &mut ShellProcess, action: &str) -> RemoteHand {
    let said = shell.wait_until(action, |said| find_button(said, action).is_some());
    let target = find_button(&said, action).expect("it was there");
    let from = RemoteHand::at(0.3, 1.35, -0.1);
    let rotation = Quat::from_rotation_arc(Vec3::NEG_Z, (target - from.position).normalize());
    RemoteHand { rotation, ..from }
}

/// Aims at a button, and pulls the trigger. Returns the aim.
fn aim_and_pull(hands: &mut RemoteHands, shell: &mut ShellProcess, action: &str) -> RemoteHand {
    let aimed = aim_at(shell, action);
    hands.place_hand(RIGHT, aimed);
    // A button that has just appeared can't be pressed yet.
    let now = shell.query_status().number("ticks");
    shell.wait_until("aimed", |said| said.number("ticks") > now + 24);
    hands.place_hand(RIGHT, RemoteHand { trigger: 1.0, ..aimed });
    aimed
}

/// Aims at a button, pulls the trigger, and waits for a phase of the visit.
fn press(hands: &mut RemoteHands, shell: &mut ShellProcess, action: &str, phase: &str) {
    let aimed = aim_and_pull(hands, shell, action);
    shell.wait_frames(2);
    hands.place_hand(RIGHT, aimed);
    shell.wait_until(phase, |said| said.field("visit") == phase);
    hands.place_hand(RIGHT, REST);
    shell.wait_frames(2);
}

/// Puts the headset on, and waits until the room is placed for its visitor.
fn put_on(monado: &MonadoService, hands: &mut RemoteHands, shell: &mut ShellProcess) {
    look(hands, 0.0);
    inject_event(monado, "presence 1");
    let said = shell.wait_until("Welcome", |said| said.field("visit") == "Welcome");
    let now = said.number("ticks");
    let said = shell.wait_until("the room", |said| said.number("ticks") > now + 80);
    let room: Vec<f32> =
        said.field("room").split(' ').map(|number| number.parse().expect("a number")).collect();
    assert!(room.iter().all(|number| number.abs() < 0.02), "the visitor stands well: {room:?}");
}

/// Plays a visit from the welcome to a first cut, and skips all steps of the guide.
fn begin_sculpting(hands: &mut RemoteHands, shell: &mut ShellProcess) -> u64 {
    press(hands, shell, "Press(Confirm)", "Choice");
    press(hands, shell, "Choose(FreeForm)", "Guided");
    for step in 0..6 {
        let next = if step < 5 { "Guided" } else { "Sculpting" };
        press(hands, shell, "Press(Skip { all: false })", next);
    }
    take_tool(hands, shell, Tool::Rotary);
    carve_voxels(hands, shell, 500);
    shell.query_status().number("voxels")
}

/// Captures a screen with the left eye, which looks ahead.
fn picture(monado: &MonadoService, shell: &mut ShellProcess, name: &str) -> std::path::PathBuf {
    shell.wait_frames(2);
    let [left, _] = shell.capture_eyes(&monado.folder, name);
    left
}

/// Asserts that the pictures on the cards of the choice change, as the starts turn.
fn see_living_previews(monado: &MonadoService, shell: &mut ShellProcess) {
    let choice = picture(monado, shell, "choice");
    let lives = (0..30).any(|_| {
        shell.wait_frames(20);
        compare_frames(&choice, &picture(monado, shell, "choice-later")).count > 150
    });
    assert!(lives, "nothing lives on the cards");
}

#[test]
fn a_visitor_goes_from_attract_to_the_badge_and_hands_over() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "visits");
    let mut hands = monado.connect_hands();
    look(&mut hands, 0.0);
    let mut shell = start(&monado, &layer, PATIENT, &["--record", "live.trace"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    inject_event(&monado, "presence 0");
    let whole = shell.wait_until("attract", |said| said.field("visit") == "Attract");
    // The attract mode's own hand works on the stone.
    shell.wait_until("a cut", |said| said.number("voxels") < whole.number("voxels"));
    let attract = picture(&monado, &mut shell, "attract");
    hands.place_eyes(&eyes_at(HEAD, Quat::from_rotation_x(-0.6)));
    picture(&monado, &mut shell, "attract-stone");
    assert!(!read_log(&monado).contains("pulse"), "nobody feels what nobody does");

    put_on(&monado, &mut hands, &mut shell);
    let welcome = picture(&monado, &mut shell, "welcome");
    assert!(compare_frames(&attract, &welcome).count > 20_000, "a panel before the visitor");
    let aimed = aim_at(&mut shell, "Press(WorkingHand(0))");
    hands.place_hand(RIGHT, aimed);
    let pointed = picture(&monado, &mut shell, "welcome-pointed");
    assert!(
        compare_frames(&welcome, &pointed).count > 300,
        "a hand, a beam, and a button that glows"
    );
    wait_for("a tap", || read_log(&monado).contains("pulse"));
    press(&mut hands, &mut shell, "Press(Language(1))", "Welcome");
    picture(&monado, &mut shell, "welcome-greek");
    press(&mut hands, &mut shell, "Press(Language(0))", "Welcome");
    press(&mut hands, &mut shell, "Press(Confirm)", "Choice");
    see_living_previews(&monado, &mut shell);
    press(&mut hands, &mut shell, "Choose(FreeForm)", "Guided");
    picture(&monado, &mut shell, "guided");
    for step in 0..6 {
        let next = if step < 5 { "Guided" } else { "Sculpting" };
        press(&mut hands, &mut shell, "Press(Skip { all: false })", next);
    }
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    carve_voxels(&mut hands, &mut shell, 800);
    look(&mut hands, -0.6);
    picture(&monado, &mut shell, "sculpting-aside");
    look(&mut hands, 0.0);
    let sculpting = picture(&monado, &mut shell, "sculpting");
    press(&mut hands, &mut shell, "Ask(Finish)", "Sculpting");
    let asked = picture(&monado, &mut shell, "finish");
    assert!(compare_frames(&sculpting, &asked).count > 10_000, "the question is seen");
    assert!(finished_sculptures(&monado, "stl").is_empty());
    press(&mut hands, &mut shell, "Press(Finish)", "Badge");
    wait_for("the print", || finished_sculptures(&monado, "stl").len() == 1);
    shell.wait_until("a way on", |said| find_button(said, "Press(Confirm)").is_some());
    picture(&monado, &mut shell, "badge");
    aim_and_pull(&mut hands, &mut shell, "Press(Confirm)");
    shell.wait_until("thanks", |said| said.field("visit") == "Thanks");
    hands.place_hand(RIGHT, REST);
    picture(&monado, &mut shell, "thanks");
    shell.wait_until("handover", |said| said.field("visit") == "Handover");
    inject_event(&monado, "presence 0");
    picture(&monado, &mut shell, "handover");
    put_on(&monado, &mut hands, &mut shell);

    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_no_violations(&read_log(&monado));
    assert_replays_alike(&monado.folder);
}

#[test]
fn who_takes_the_headset_off_while_sculpting_is_gone_and_leaves_a_sculpture() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "visits-left");
    let mut hands = monado.connect_hands();
    look(&mut hands, 0.0);
    let plan = format!("{PATIENT},OffSculpting=4");
    let mut shell = start(&monado, &layer, &plan, &[]);
    shell.wait_until("attract", |said| said.field("visit") == "Attract");
    put_on(&monado, &mut hands, &mut shell);
    begin_sculpting(&mut hands, &mut shell);
    inject_event(&monado, "presence 0");
    inject_event(&monado, "presence 1");
    look(&mut hands, 0.1);
    let now = shell.query_status().number("ticks");
    let said = shell.wait_until("some seconds", |said| said.number("ticks") > now + 320);
    assert_eq!(said.field("visit"), "Sculpting", "put on again");
    inject_event(&monado, "presence 0");
    shell.wait_until("handover", |said| said.field("visit") == "Handover");
    wait_for("the print", || finished_sculptures(&monado, "stl").len() == 1);
    put_on(&monado, &mut hands, &mut shell);
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
}

#[test]
fn a_killed_shell_goes_on_with_its_visit_unless_the_visitor_has_gone() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "visits-killed");
    let mut hands = monado.connect_hands();
    look(&mut hands, 0.0);
    let mut shell = start(&monado, &layer, PATIENT, &[]);
    shell.wait_until("attract", |said| said.field("visit") == "Attract");
    put_on(&monado, &mut hands, &mut shell);
    let voxels = begin_sculpting(&mut hands, &mut shell);
    let stamp = monado.folder.join("files/sessions/session-128.last-use");
    wait_for("the time of the last use", || stamp.exists());
    shell.kill();

    let mut shell = start(&monado, &layer, PATIENT, &[]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    inject_event(&monado, "presence 1");
    let said = shell.wait_frames(10);
    assert_eq!((said.field("visit"), said.number("voxels")), ("Sculpting", voxels));
    assert!(said.number("undo") > 0 && said.number("left") > 800, "{}", said.text());
    let errors = shell.kill();
    assert!(errors.contains("a visit goes on: Sculpting, unused for"), "{errors}");

    // The visit is found almost a minute later, and another visitor puts the headset on.
    let mut last_use = LastUse::decode(&fs::read(&stamp).expect("a stamp")).expect("a stamp");
    last_use.since_boot -= Duration::from_secs(50);
    fs::write(&stamp, last_use.encode()).expect("it is written");
    let mut shell = start(&monado, &layer, PATIENT, &[]);
    inject_event(&monado, "presence 1");
    shell.wait_until("the next visitor", |said| said.field("visit") == "Welcome");
    wait_for("the print", || finished_sculptures(&monado, "stl").len() == 1);
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
}

/// The position of the index finger's tip relative to the grip, for the bare hand that the tests' layer makes
/// from the driver's.
const FINGERTIP: Vec3 = Vec3::new(0.015, -0.115, -0.03);

#[test]
fn a_bare_hand_presses_by_touch_and_by_a_pinch() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "visits-bare");
    let mut hands = monado.connect_hands();
    look(&mut hands, 0.0);
    let mut shell = start(&monado, &layer, PATIENT, &[]);
    fs::write(monado.folder.join("layer/hands"), "bare").expect("a wish");
    let sources = "[HandInteraction, HandInteraction]";
    shell.wait_until("bare hands", |said| said.field("sources") == sources);
    put_on(&monado, &mut hands, &mut shell);
    for (action, phase) in [("Press(Confirm)", "Choice"), ("Choose(FreeForm)", "Guided")] {
        let said = shell.wait_until(action, |said| find_button(said, action).is_some());
        let there = find_button(&said, action).expect("it was there") - FINGERTIP;
        hands.place_hand(RIGHT, RemoteHand { position: there + Vec3::Z * 0.08, ..REST });
        let before = shell.wait_frames(3);
        assert_ne!(before.field("visit"), phase, "not yet touched");
        hands.place_hand(RIGHT, RemoteHand { position: there, ..REST });
        shell.wait_until(phase, |said| said.field("visit") == phase);
        hands.place_hand(RIGHT, REST);
        shell.wait_frames(2);
    }
    let first = picture(&monado, &mut shell, "first-step");
    press(&mut hands, &mut shell, "Press(Skip { all: false })", "Guided");
    let second = picture(&monado, &mut shell, "second-step");
    assert!(compare_frames(&first, &second).count > 500, "another picture and another text");
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
}
