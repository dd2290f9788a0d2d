//! Bare hands as Meta's runtime reports them, which the tests' layer imitates: as a simple controller with a
//! valid grip or through `XR_EXT_hand_interaction`, frozen after tracking is lost, and beside controllers.

use std::fs;
use std::path::Path;

use glam::{Quat, Vec3};
use paros_core::internals::STOOL_TOP;
use paros_core::session::Tool;
use paros_shell::require::require_or_skip;
use paros_shell::trace::Trace;

use super::layered::{assert_no_violations, find_rig, read_log};
use super::monado::{
    MonadoService, MonadoTree, RemoteHand, RemoteHands, ShellEnd, ShellProcess, wait_for,
};
use super::{REST, RIGHT, hands_at_rest, take_tool};

const HAND_INTERACTION: &str = "/interaction_profiles/ext/hand_interaction_ext";
const SIMPLE: &str = "/interaction_profiles/khr/simple_controller";

/// Starts a shell whose runtime refuses these profiles, with the layer's hands in the state that `word`
/// names.
fn start_with_hands(
    monado: &MonadoService,
    layer: &Path,
    refused: &[&str],
    word: &str,
    args: &[&str],
) -> ShellProcess {
    let command = monado.layered_command(layer, args);
    let folder = monado.folder.join("layer");
    fs::write(folder.join("refuse-profiles"), refused.join(" ")).expect("a wish");
    fs::write(folder.join("hands"), word).expect("a wish");
    let mut shell = ShellProcess::start(command);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    shell
}

/// Changes the state of the layer's hands, and waits until the shell has run ticks with them.
fn change_hands(monado: &MonadoService, shell: &mut ShellProcess, word: &str) {
    let folder = monado.folder.join("layer");
    let count = || read_log(monado).lines().filter(|line| *line == format!("hands {word}")).count();
    let before = count();
    fs::write(folder.join("draft"), word).expect("a wish");
    fs::rename(folder.join("draft"), folder.join("hands")).expect("a wish");
    wait_for(word, || count() > before);
    shell.wait_frames(1);
}

#[test]
fn hands_by_their_own_profile_and_controllers_hand_over_to_each_other() {
    hand_over_and_back("own-profile", &[], "[HandInteraction, HandInteraction]");
}

#[test]
fn hands_offered_as_simple_controllers_are_read_by_their_joints() {
    hand_over_and_back("simple-profile", &[HAND_INTERACTION], "[Joints, Joints]");
}

#[test]
fn hands_without_a_profile_are_read_by_their_joints() {
    hand_over_and_back("no-profile", &[HAND_INTERACTION, SIMPLE], "[Joints, Joints]");
}

/// Takes a tool with a controller and hands it over to a bare hand, which runs it, is lost and found again.
/// Then hands it back to the controller, which releases it; a fist takes it again. If the runtime refuses the
/// profiles in `refused`, bare hands are read from `sources`.
fn hand_over_and_back(name: &str, refused: &[&str], sources: &str) {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let controllers = "[Controller, Controller]";
    let monado = MonadoService::start(&tree, name);
    let mut hands = hands_at_rest(&monado);
    let mut shell = start_with_hands(&monado, &layer, refused, "", &["--record", "live.trace"]);
    let said = shell.wait_until("hands", |said| said.field("tracked") == "[true, true]");
    assert_eq!(said.field("sources"), controllers);
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    hands.place_hand(RIGHT, REST);
    shell.wait_frames(2);
    // A hand is half closed when it leaves a controller.
    for (word, read_from) in
        [("fist", sources), ("bare", sources), ("", controllers), ("bare", sources)]
    {
        change_hands(&monado, &mut shell, word);
        let said = shell.wait_frames(2);
        let hand = (said.field("sources"), said.field("tracked"));
        assert_eq!(hand, (read_from, "[true, true]"), "{word}");
        assert!(said.field("holds").contains("burr"), "{word}: {}", said.text());
    }
    cut_stone(&mut hands, &mut shell);
    for lost in ["frozen", "gone"] {
        assert_lost_hands_vanish(&monado, &mut hands, &mut shell, lost, sources);
    }
    change_hands(&monado, &mut shell, "");
    cut_stone(&mut hands, &mut shell);
    assert_eq!(shell.query_status().field("sources"), controllers);
    hands.place_hand(RIGHT, RemoteHand { squeeze: 1.0, ..REST });
    shell.wait_until("an empty hand", |said| !said.field("holds").contains("burr"));
    hands.place_hand(RIGHT, REST);
    change_hands(&monado, &mut shell, "bare");
    shell.wait_until("what fell to be back", |said| said.field("sources") == sources);
    take_tool(&mut hands, &mut shell, Tool::Impact);

    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(errors.matches("refuses").count(), refused.len(), "{errors}");
    assert_grip_unturned(&monado.folder.join("live.trace"));
    assert_no_violations(&read_log(&monado));
}

/// Moves the running tool of the right hand into the stone until it cuts, and back to rest.
fn cut_stone(hands: &mut RemoteHands, shell: &mut ShellProcess) {
    let whole = shell.query_status().number("voxels");
    let mut z = 0.3;
    while shell.wait_frames(1).number("voxels") == whole {
        assert!(z > -0.5, "nothing is cut");
        let ahead = RemoteHand::at(0.05, STOOL_TOP.y + 0.27, z);
        hands.place_hand(RIGHT, RemoteHand { trigger: 1.0, ..ahead });
        z -= 0.04;
    }
    hands.place_hand(RIGHT, REST);
    shell.wait_frames(2);
}

/// Loses both hands as runtimes do, with the right hand's pinch closed before it is in the stone.
fn assert_lost_hands_vanish(
    monado: &MonadoService,
    hands: &mut RemoteHands,
    shell: &mut ShellProcess,
    lost: &str,
    sources: &str,
) {
    let pinch = RemoteHand { trigger: 1.0, ..REST };
    hands.place_hand(RIGHT, pinch);
    // Counts strokes, not voxels, as loose pieces may still disappear.
    let before = shell.wait_frames(2).number("undo");
    change_hands(monado, shell, lost);
    let said = shell.query_status();
    let vanished = (said.field("tracked"), said.field("sources"));
    assert_eq!(vanished, ("[false, false]", "[None, None]"), "{lost}");
    hands.place_hand(RIGHT, RemoteHand { position: STOOL_TOP + Vec3::Y * 0.2, ..pinch });
    let said = shell.wait_frames(3);
    assert_eq!((said.number("undo"), said.field("tracked")), (before, "[false, false]"));
    assert!(said.field("holds").contains("burr"), "what it holds is kept");
    hands.place_hand(RIGHT, REST);
    shell.wait_frames(2);
    change_hands(monado, shell, "bare");
    let said = shell.wait_until("hands", |said| said.field("tracked") == "[true, true]");
    assert_eq!(said.field("sources"), sources);
}

/// Asserts that the right hand's grip, which rests for most of this trace, has the driver's position and
/// rotation, whatever source it is read from.
fn assert_grip_unturned(path: &Path) {
    let trace = Trace::read(path).expect("a trace");
    let mut at_rest = 0;
    for record in trace.records() {
        let hand = &record.input.hands[RIGHT];
        let Some((position, rotation)) = hand.grip.to_clamped_metres() else { continue };
        assert!(rotation.angle_between(Quat::IDENTITY) < 0.01, "{rotation} at {position}");
        at_rest += u32::from(position.distance(REST.position) < 0.001);
    }
    assert!(at_rest > 50, "{at_rest} ticks at rest");
}

#[test]
fn a_controller_on_a_table_is_no_hand() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "table");
    let _hands = hands_at_rest(&monado);
    let mut shell = start_with_hands(&monado, &layer, &[], "around", &[]);
    let (controllers, joints) = ("[Controller, Controller]", "[Joints, Joints]");
    let said = shell.wait_until("hands", |said| said.field("tracked") == "[true, true]");
    assert_eq!(said.field("sources"), controllers, "joints of hands that hold them");
    for (word, sources) in [("beside", joints), ("around", controllers), ("beside", joints)] {
        change_hands(&monado, &mut shell, word);
        let said = shell.wait_frames(1);
        let read = (said.field("sources"), said.field("tracked"));
        assert_eq!(read, (sources, "[true, true]"), "{word}");
    }
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_no_violations(&read_log(&monado));
}
