//! The shell's requests to the runtime at its start, and its log lines for refused ones.

use std::collections::BTreeSet;
use std::fs;

use paros_core::session::Tool;
use paros_shell::require::require_or_skip;

use super::layered::{assert_no_violations, find_rig, read_log};
use super::monado::{MonadoService, MonadoTree, ShellEnd, ShellProcess};
use super::{hands_at_rest, take_tool};

/// An interaction profile's path, and its bindings: action, component path, and hands.
type BoundProfile = (&'static str, &'static [(&'static str, &'static str, BoundHands)]);

#[derive(Clone, Copy)]
enum BoundHands {
    Left,
    Right,
    Both,
}
use BoundHands::{Both, Left, Right};

/// The bindings that all kinds of Touch controllers share.
const TOUCH: &[(&str, &str, BoundHands)] = &[
    ("aim", "input/aim/pose", Both),
    ("grip", "input/grip/pose", Both),
    ("run", "input/trigger/value", Both),
    ("take", "input/squeeze/value", Both),
    ("turn", "input/thumbstick", Both),
    ("mirror", "input/thumbstick/click", Both),
    ("feel", "output/haptic", Both),
    ("undo", "input/x/click", Left),
    ("redo", "input/y/click", Left),
    ("undo", "input/a/click", Right),
    ("redo", "input/b/click", Right),
    ("menu", "input/menu/click", Left),
];

/// The profiles and components with the names of OpenXR 1.1: "Interaction Profile Paths", the extensions
/// `XR_META_touch_controller_plus`, `XR_FB_touch_controller_pro` and `XR_EXT_hand_interaction`, and `xr.xml`.
/// The right Touch's menu button belongs to the system, and so does an Index's only one.
const PROFILES: [BoundProfile; 6] = [
    ("/interaction_profiles/oculus/touch_controller", TOUCH),
    ("/interaction_profiles/meta/touch_controller_plus", TOUCH),
    ("/interaction_profiles/facebook/touch_controller_pro", TOUCH),
    (
        "/interaction_profiles/valve/index_controller",
        &[
            ("aim", "input/aim/pose", Both),
            ("grip", "input/grip/pose", Both),
            ("run", "input/trigger/value", Both),
            ("take", "input/squeeze/value", Both),
            ("turn", "input/thumbstick", Both),
            ("mirror", "input/thumbstick/click", Both),
            ("feel", "output/haptic", Both),
            ("undo", "input/a/click", Both),
            ("redo", "input/b/click", Both),
        ],
    ),
    (
        "/interaction_profiles/khr/simple_controller",
        &[
            ("aim", "input/aim/pose", Both),
            ("grip", "input/grip/pose", Both),
            ("run", "input/select/click", Both),
            ("take", "input/menu/click", Both),
            ("feel", "output/haptic", Both),
        ],
    ),
    (
        "/interaction_profiles/ext/hand_interaction_ext",
        &[
            ("aim", "input/aim/pose", Both),
            ("grip", "input/grip/pose", Both),
            ("run", "input/pinch_ext/value", Both),
            ("take", "input/grasp_ext/value", Both),
        ],
    ),
];

/// The actions and their types. A button bound to a float action gives 0 or 1.
const ACTIONS: [(&str, &str); 9] = [
    ("aim", "POSE_INPUT"),
    ("grip", "POSE_INPUT"),
    ("run", "FLOAT_INPUT"),
    ("take", "FLOAT_INPUT"),
    ("turn", "VECTOR2F_INPUT"),
    ("undo", "BOOLEAN_INPUT"),
    ("redo", "BOOLEAN_INPUT"),
    ("mirror", "BOOLEAN_INPUT"),
    ("menu", "BOOLEAN_INPUT"),
];

/// Returns the log's lines of a kind, and asserts that each occurs once.
fn log_entries(log: &str, kind: &str) -> BTreeSet<String> {
    let lines: Vec<String> =
        log.lines().filter(|line| line.starts_with(kind)).map(str::to_owned).collect();
    let set: BTreeSet<String> = lines.iter().cloned().collect();
    assert_eq!(set.len(), lines.len(), "a line twice in {lines:#?}");
    set
}

#[test]
fn controllers_are_bound_as_openxr_names_them() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "bound");
    let errors = seen(monado.start_layered_shell(&layer, &[]));
    assert!(!errors.contains("no profile") && !errors.contains("refuses"), "{errors}");
    let log = read_log(&monado);
    let mut expected = BTreeSet::new();
    for (profile, bindings) in PROFILES {
        for (action, component, hands) in bindings {
            let hands: &[&str] = match hands {
                Left => &["left"],
                Right => &["right"],
                Both => &["left", "right"],
            };
            for hand in hands {
                expected.insert(format!("bind {profile} /user/hand/{hand}/{component} {action}"));
            }
        }
    }
    assert_eq!(log_entries(&log, "bind "), expected);
    let actions = ACTIONS.into_iter().chain([("feel", "VIBRATION_OUTPUT")]);
    let actions = actions.map(|(name, kind)| format!("action {name} {kind}")).collect();
    assert_eq!(log_entries(&log, "action "), actions);
    assert_no_violations(&log);
}

#[test]
fn a_refused_profile_costs_no_other() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "refused-profile");
    let mut hands = hands_at_rest(&monado);
    let refused = "/interaction_profiles/facebook/touch_controller_pro";
    let mut shell = {
        let command = monado.layered_command(&layer, &[]);
        fs::write(monado.folder.join("layer/refuse-profiles"), refused).expect("a wish");
        ShellProcess::start(command)
    };
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    let line =
        format!("paros-quest: the OpenXR runtime refuses {refused}: ERROR_PATH_UNSUPPORTED\n");
    assert!(errors.contains(&line) && errors.matches("refuses").count() == 1, "{errors}");
    let log = read_log(&monado);
    for (profile, _) in PROFILES {
        assert!(log.contains(&format!("bind {profile} ")), "{profile}: {log}");
    }
    assert_no_violations(&log);
}

#[test]
fn a_rate_is_asked_for_where_it_is_offered() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "rates");
    let mut asked = 0;
    let mut asks = |rate: &str, line: &str| {
        let errors = seen(monado.start_layered_shell(&layer, &["--rate", rate]));
        assert!(errors.contains(&format!("paros-quest: {line}\n")), "{line}: {errors}");
        let log = read_log(&monado);
        let rates: Vec<_> = log.lines().filter_map(|line| line.strip_prefix("rate ")).collect();
        let new: Vec<String> = rates[asked..].iter().map(ToString::to_string).collect();
        asked = rates.len();
        new
    };
    assert_eq!(asks("90", "the display is asked for 90 Hz"), ["90"]);
    let line = "the display has no 120 Hz, only 60, 72, 90 Hz: it is asked for 90 Hz";
    assert_eq!(asks("120", line), ["90"]);
    fs::write(monado.folder.join("layer/no-rates"), "").expect("a wish");
    let line = "the display offers no rates: it is asked for none, 90 Hz or another";
    assert_eq!(asks("90", line), [""; 0]);
    fs::remove_file(monado.folder.join("layer/no-rates")).expect("it is ours");
    fs::write(monado.folder.join("layer/refuse"), "xrRequestDisplayRefreshRateFB").expect("a wish");
    let why = "ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB";
    let line = format!("the display was asked for 90 Hz, and refused: {why}");
    assert_eq!(asks("90", &line), [""; 0]);
    assert_no_violations(&read_log(&monado));
    // Without the layer: Monado's null compositor itself.
    let errors = seen(monado.start_shell(&["--rate", "90"]));
    let line = "paros-quest: the display has no 90 Hz, only 20 Hz: it is asked for 20 Hz\n";
    assert!(errors.contains(line), "{errors}");
}

#[test]
fn without_a_floor_under_the_visitor_the_stage_is_taken() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "floor");
    let mut noted = 0;
    let mut room = || {
        let errors = seen(monado.start_layered_shell(&layer, &[]));
        let log = read_log(&monado);
        // The spaces of the head and of a notice always exist.
        let is_room = |line: &&str| !["space VIEW 0", "space LOCAL 0"].contains(line);
        let spaces = log[noted..].lines().filter(|line| line.starts_with("space "));
        let rooms: Vec<String> = spaces.filter(is_room).map(str::to_owned).collect();
        noted = log.len();
        let line = errors.lines().find(|line| line.contains("floor")).map(str::to_owned);
        (rooms, line.unwrap_or_default())
    };
    assert_eq!(room(), (vec!["space LOCAL_FLOOR 0".into()], String::new()));
    fs::write(monado.folder.join("layer/no-floor"), "").expect("a wish");
    let (rooms, line) = room();
    assert_eq!(rooms, ["space STAGE 0"]);
    assert!(line.starts_with("paros-quest: Monado"), "{line}");
    assert!(line.ends_with(" has no LOCAL_FLOOR: the floor is the stage's"), "{line}");
    fs::write(monado.folder.join("layer/no-stage"), "").expect("a wish");
    let (rooms, line) = room();
    assert_eq!(rooms, ["space LOCAL -1.6"]);
    let end = " has no LOCAL_FLOOR and no STAGE: the floor is held to be 1.6 m below where the eyes began";
    assert!(line.ends_with(end), "{line}");
    assert_no_violations(&read_log(&monado));
}

/// Runs a shell with focus for some frames until it exits without an error. Returns its standard error.
fn seen(mut shell: ShellProcess) -> String {
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_frames(3);
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    errors
}
