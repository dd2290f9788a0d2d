//! Tests with an API layer that checks the order of calls, logs haptic pulses, and injects the runtime's
//! events: user presence, heat, and losses.

use std::fs;
use std::path::{Path, PathBuf};

use paros_core::session::Tool;
use paros_shell::require::require_or_skip;

use super::monado::{MonadoService, MonadoTree, ShellEnd, ShellProcess, wait_for};
use super::{REST, RIGHT, carve_voxels, hands_at_rest, take_tool};

/// Finds a program of `tests/rigs` or the layer's library, which `cargo test` builds as examples.
pub(crate) fn find_rig(name: &str) -> Result<PathBuf, String> {
    let quest = Path::new(env!("CARGO_BIN_EXE_paros-quest"));
    let path = quest.with_file_name("examples").join(name);
    let found = path.exists().then_some(path);
    found.ok_or_else(|| format!("no {name}: cargo build -p paros-quest --examples"))
}

/// Makes the layer inject an event, and waits until its log confirms it.
pub(crate) fn inject_event(monado: &MonadoService, wish: &str) {
    let folder = monado.folder.join("layer");
    fs::write(folder.join("draft"), wish).expect("a wish");
    fs::rename(folder.join("draft"), folder.join("inject")).expect("a wish");
    wait_for(wish, || read_log(monado).lines().any(|line| line == format!("injected {wish}")));
}

/// Reads the layer's log so far; empty if there is none.
pub(crate) fn read_log(monado: &MonadoService) -> String {
    fs::read_to_string(monado.folder.join("layer/log")).unwrap_or_default()
}

/// Asserts that the shell has created session number `sessions`, with focus and the same sculpture.
fn assert_session_resumes(
    monado: &MonadoService,
    shell: &mut ShellProcess,
    sessions: usize,
    voxels: u64,
) {
    let made = || read_log(monado).lines().filter(|line| *line == "session").count();
    wait_for("another session", || made() == sessions);
    let said = shell.wait_until("focus", |said| said.field("life") == "focused");
    assert_eq!(said.number("voxels"), voxels, "the sculpture is kept");
    assert!(said.field("holds").contains("burr"), "and so is the tool");
    shell.wait_frames(2);
}

#[test]
fn hands_feel_the_stone_and_losses_lose_nothing() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "layered");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.start_layered_shell(&layer, &["--depth"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    let asked = read_log(&monado);
    for line in [
        "own extensions 11",
        "rate 72",
        "level CPU SUSTAINED_HIGH",
        "level GPU SUSTAINED_HIGH",
        "thread APPLICATION_MAIN its own",
        "thread RENDERER_MAIN its own",
    ] {
        assert!(asked.lines().any(|asked| asked == line), "{line}: {asked}");
    }
    take_tool(&mut hands, &mut shell, Tool::Rotary);
    hands.place_hand(RIGHT, REST);
    shell.wait_frames(3);
    assert!(!read_log(&monado).contains("pulse"), "the air is not felt");
    carve_voxels(&mut hands, &mut shell, 1500);
    assert_pulses_of_one_hand(&read_log(&monado));
    hands.place_hand(RIGHT, REST);
    // First the bit moves out of the stone. A frame of four ticks outlasts a pulse, which then needs no stop.
    shell.wait_frames(10);
    let pulses = || read_log(&monado).matches("pulse").count();
    let felt = pulses();
    shell.wait_frames(4);
    assert_eq!(pulses(), felt, "the air is not felt any more");

    let voxels = shell.query_status().number("voxels");
    inject_event(&monado, "heat");
    inject_event(&monado, "presence 0");
    inject_event(&monado, "presence 1");
    fs::write(monado.folder.join("layer/refuse-levels"), "").expect("it is written");
    for (i, loss) in ["lose session", "lose instance", "fail"].into_iter().enumerate() {
        inject_event(&monado, loss);
        assert_session_resumes(&monado, &mut shell, i + 2, voxels);
    }
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("the headset is hot"), "{errors}");
    assert_eq!(errors.matches("the sculpture is kept").count(), 3, "{errors}");
    let log = read_log(&monado);
    assert_levels_after_each_begin(&log);
    for domain in ["CPU", "GPU"] {
        let refused = format!("no sustained high performance of the {domain}");
        assert_eq!(errors.matches(&refused).count(), 3, "{errors}");
    }
    assert_no_violations(&log);
    assert!(!log.contains("oveation"), "this device has no density maps");
    assert!(log.contains("depth\n"), "the compositor was to get depth");
}

/// Asserts that the performance levels of CPU and GPU were requested after each begin of a session, and not
/// before.
fn assert_levels_after_each_begin(log: &str) {
    let is_about = |line: &&str| *line == "begin" || line.starts_with("level");
    let asked: Vec<&str> = log.lines().filter(is_about).collect();
    let each = ["begin", "level CPU SUSTAINED_HIGH", "level GPU SUSTAINED_HIGH"];
    assert_eq!(asked, each.repeat(4), "{asked:?}");
}

/// Asserts that the layer found no call out of order or with wrong structures.
pub(crate) fn assert_no_violations(log: &str) {
    let violations: Vec<&str> = log.lines().filter(|line| line.contains("violation")).collect();
    assert!(violations.is_empty(), "{violations:#?}");
}

/// Asserts one pulse a frame, all on one hand, with an amplitude in (0, 1] and the length of three ticks.
/// Only the pulse of a refusal has a frequency, and lasts nine ticks.
fn assert_pulses_of_one_hand(log: &str) {
    let pulses: Vec<Vec<&str>> = log
        .lines()
        .filter(|line| line.starts_with("pulse"))
        .map(|line| line.split(' ').collect())
        .collect();
    assert!(pulses.len() > 5, "{} pulses", pulses.len());
    for pulse in &pulses {
        let &[_, _, hand, _, amplitude, _, nanos, _, frequency, frame] = &pulse[..] else {
            panic!("{pulse:?}")
        };
        assert_eq!((hand, frame), (pulses[0][2], "Begun"));
        let amplitude: f32 = amplitude.parse().expect("a number");
        let ticks = nanos.parse::<f64>().expect("a number") * 72e-9;
        assert!(amplitude > 0.0 && amplitude <= 1.0, "{pulse:?}");
        let expected = if frequency == "0" { 2.99..3.01 } else { 8.99..9.01 };
        assert!(expected.contains(&ticks), "{ticks} ticks at {frequency} Hz");
    }
}
