//! Fault injection: if the runtime refuses a call or the device lacks a feature, the shell ends with one line
//! that names the cause and a remedy, and the saved sculpture is unchanged.

use std::fs;
use std::path::Path;

use paros_core::limits::INTERVALS;
use paros_core::session::Tool;
use paros_core::volume::Grid;
use paros_shell::require::require_or_skip;
use paros_shell::statics::Resident;

use super::layered::{find_rig, read_log};
use super::monado::{MonadoService, MonadoTree, ShellEnd, ShellProcess};
use super::{carve_voxels, hands_at_rest, take_tool};

/// The functions that are refused from the start, and words of the last line.
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
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "refusals");
    let saved = save_after_refused_frames(&monado, &layer);
    let fails = |shell: ShellProcess, words: [&str; 2]| {
        let ShellEnd { code, errors } = shell.wait_for_end();
        assert_fails_cleanly(code, &errors, words);
        assert_eq!(load_saved_session(&monado), saved, "{errors}");
        // Remove the record, so that the next start needn't wait.
        fs::remove_file(monado.folder.join("files/cache/failed-starts")).expect("a failed start");
    };
    for (functions, words) in REFUSALS {
        refuse_functions(&monado, functions);
        fails(monado.start_layered_shell(&layer, &[]), words);
    }
    refuse_functions(&monado, "");
    fails(
        start_without_multiview(&monado, &layer),
        ["has no multiview", "must draw by Vulkan 1.1"],
    );
    let mut command = monado.layered_command(&layer, &[]);
    command.env("XR_RUNTIME_JSON", "/nonexistent");
    fails(
        ShellProcess::start(command),
        ["no OpenXR runtime answers", "start one, or name another"],
    );

    // Bare hands are enough.
    refuse_functions(&monado, "xrSuggestInteractionProfileBindings");
    let mut shell = monado.start_layered_shell(&layer, &[]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    let SavedSession { tick, digest, .. } = saved;
    let goes_on = format!("a session goes on from tick {tick}, digest {digest:016x}\n");
    assert!(errors.contains(&goes_on), "{goes_on} in: {errors}");
    assert!(errors.contains("or hands' interaction: bare hands sculpt\n"), "{errors}");
    let log = read_log(&monado);
    assert!(!log.contains("violation"), "{log}");
}

/// Refuses every `xrEndFrame` in a running session: the shell retries, and stops after five losses. Returns
/// the saved session.
fn save_after_refused_frames(monado: &MonadoService, layer: &Path) -> SavedSession {
    let mut hands = hands_at_rest(monado);
    let mut shell = monado.start_layered_shell(layer, &[]);
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    carve_voxels(&mut hands, &mut shell, 500);
    let voxels = shell.query_status().number("voxels");
    refuse_functions(monado, "xrEndFrame");
    let ShellEnd { code, errors } = shell.wait_for_end();
    assert_fails_cleanly(
        code,
        &errors,
        ["could not end an empty frame", ": ERROR_LAYER_INVALID; end what else"],
    );
    assert_eq!(errors.matches("the sculpture is kept, and a new session is made").count(), 5);
    let saved = load_saved_session(monado);
    assert_eq!(saved.voxels, voxels, "{errors}");
    saved
}

/// Makes the layer refuse functions from now on, given by their names, separated by spaces.
fn refuse_functions(monado: &MonadoService, functions: &str) {
    let folder = monado.folder.join("layer");
    fs::write(folder.join("draft"), functions).expect("a wish");
    fs::rename(folder.join("draft"), folder.join("refuse")).expect("a wish");
}

/// The saved session.
#[derive(PartialEq, Debug)]
struct SavedSession {
    tick: u64,
    digest: u64,
    voxels: u64,
}

fn load_saved_session(monado: &MonadoService) -> SavedSession {
    let saved = fs::read(monado.folder.join("files/sessions/session-128.save")).expect("a save");
    let world = &mut <Grid<128> as Resident<128, INTERVALS>>::lock_world().world;
    world.load(&saved).expect("a whole save");
    SavedSession {
        tick: world.tick(),
        digest: world.digest(),
        voxels: world.volume().count_voxels(),
    }
}

/// Asserts exit code 1, a last line with these words, no panic and no validation message.
fn assert_fails_cleanly(code: Option<i32>, errors: &str, words: [&str; 2]) {
    assert_eq!(code, Some(1), "{errors}");
    let last = errors.lines().last().unwrap_or_default();
    assert!(last.starts_with("paros-quest: "), "{errors}");
    assert!(words.iter().all(|word| last.contains(word)), "{words:?}: {errors}");
    assert!(!errors.contains("panicked") && !errors.contains("validation: "), "{errors}");
}

/// Starts the shell on a device without multiview.
fn start_without_multiview(monado: &MonadoService, layer: &Path) -> ShellProcess {
    fs::write(monado.folder.join("layer/one-view"), "").expect("a wish");
    monado.start_mapped_shell(layer, &[])
}
