//! What a runtime refuses or a device lacks is said in one line, with what to do; the sculpture is
//! the same afterwards.

use std::fs;
use std::path::Path;

use paros_core::size::Grid;
use paros_core::tools::Tool;
use paros_shell::require::require;
use paros_shell::statics::Resident;

use super::layered::{example, log};
use super::monado::{Monado, Shell, Tree};
use super::{carve, hands_at_rest, take};

/// What is refused from the start: the functions, and what the last line says.
const REFUSALS: [(&str, [&str; 2]); 3] = [
    ("xrCreateSession", ["could not make a session: ERROR_LIMIT_REACHED", "; end what else"]),
    (
        "xrCreateSwapchain",
        ["make a swapchain: ERROR_FEATURE_UNSUPPORTED", "start its runtime anew"],
    ),
    (
        "xrSuggestInteractionProfileBindings xrCreateHandTrackerEXT",
        ["takes no profile of controllers, expected Touch,", "choose another runtime"],
    ),
];

#[test]
fn what_is_refused_is_said_and_loses_nothing() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let Some(layer) = require(example("liblayer.so")).unwrap() else { return };
    let monado = Monado::start(&tree, "refusals");
    let saved = a_frame_is_refused_in_the_midst(&monado, &layer);
    let fails = |shell: Shell, words: [&str; 2]| {
        let (code, errors) = shell.over();
        fails_well(code, &errors, words);
        assert_eq!(sculpture(&monado), saved, "{errors}");
    };
    for (functions, words) in REFUSALS {
        refuse(&monado, functions);
        fails(monado.layered_shell(&layer, &[]), words);
    }
    refuse(&monado, "");
    fails(without_multiview(&monado, &layer), ["has no multiview", "must draw by Vulkan 1.1"]);
    let mut command = monado.layered_command(&layer, &[]);
    command.env("XR_RUNTIME_JSON", "/nonexistent");
    fails(Shell::start(command), ["no OpenXR runtime answers", "start one, or name another"]);

    // Bare hands are enough.
    refuse(&monado, "xrSuggestInteractionProfileBindings");
    let mut shell = monado.layered_shell(&layer, &[]);
    shell.until("focus", |said| said.field("life") == "focused");
    let (code, errors) = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    let (tick, digest, _) = saved;
    let goes_on = format!("a session goes on from tick {tick}, digest {digest:016x}\n");
    assert!(errors.contains(&goes_on), "{goes_on} in: {errors}");
    assert!(errors.contains("or simple ones: bare hands sculpt\n"), "{errors}");
    let log = log(&monado);
    assert!(!log.contains("violation"), "{log}");
}

/// The compositor takes no picture any more: the shell tries anew, and gives up after a while. The
/// sculpture that it leaves.
fn a_frame_is_refused_in_the_midst(monado: &Monado, layer: &Path) -> (u64, u64, u64) {
    let mut hands = hands_at_rest(monado);
    let mut shell = monado.layered_shell(layer, &[]);
    shell.until("a session", |said| said.field("session") == "Sculpting");
    take(&mut hands, &mut shell, Tool::Rotary);
    carve(&mut hands, &mut shell, 500);
    let voxels = shell.say().number("voxels");
    refuse(monado, "xrEndFrame");
    let (code, errors) = shell.over();
    fails_well(
        code,
        &errors,
        ["could not end an empty frame", ": ERROR_LAYER_INVALID; end what else"],
    );
    assert_eq!(errors.matches("the sculpture is kept, and a new session is made").count(), 5);
    let saved = sculpture(monado);
    assert_eq!(saved.2, voxels, "{errors}");
    saved
}

/// Has functions refused from now on.
fn refuse(monado: &Monado, functions: &str) {
    let folder = monado.folder.join("layer");
    fs::write(folder.join("draft"), functions).expect("a wish");
    fs::rename(folder.join("draft"), folder.join("refuse")).expect("a wish");
}

/// The saved session's tick, digest and voxels.
fn sculpture(monado: &Monado) -> (u64, u64, u64) {
    let saved = fs::read(monado.folder.join("files/sessions/session-128.save")).expect("a save");
    let mut world = Grid::<128>::world();
    world.load(&saved).expect("a whole save");
    (world.tick(), world.digest(), world.volume().count())
}

/// It failed, said why in its last line, and neither panicked nor called wrongly.
fn fails_well(code: Option<i32>, errors: &str, words: [&str; 2]) {
    assert_eq!(code, Some(1), "{errors}");
    let last = errors.lines().last().unwrap_or_default();
    assert!(last.starts_with("paros-quest: "), "{errors}");
    assert!(words.iter().all(|word| last.contains(word)), "{words:?}: {errors}");
    assert!(!errors.contains("panicked") && !errors.contains("validation: "), "{errors}");
}

/// The shell on a device without multiview, as the layer has it.
fn without_multiview(monado: &Monado, layer: &Path) -> Shell {
    fs::write(monado.folder.join("layer/one-view"), "").expect("a wish");
    monado.mapped_shell(layer, &[])
}
