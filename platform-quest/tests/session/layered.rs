//! What only an API layer sees or can do: pulses, the order of calls, and what the runtime tells
//! when a headset is put off, grows hot, or is lost.

use std::fs;
use std::path::{Path, PathBuf};

use paros_core::tools::Tool;
use paros_shell::require::require;

use super::monado::{Monado, Shell, Tree, wait_for};
use super::{REST, RIGHT, carve, hands_at_rest, take};

/// The layer, or the program that counts, which `cargo test` builds as examples.
pub(crate) fn example(name: &str) -> Result<PathBuf, String> {
    let quest = Path::new(env!("CARGO_BIN_EXE_paros-quest"));
    let path = quest.with_file_name("examples").join(name);
    let found = path.exists().then_some(path);
    found.ok_or_else(|| format!("no {name}: cargo build -p paros-quest --examples"))
}

/// Has the runtime tell something, and waits until it has.
pub(crate) fn inject(monado: &Monado, wish: &str) {
    let folder = monado.folder.join("layer");
    fs::write(folder.join("draft"), wish).expect("a wish");
    fs::rename(folder.join("draft"), folder.join("inject")).expect("a wish");
    wait_for(wish, || log(monado).lines().any(|line| line == format!("injected {wish}")));
}

pub(crate) fn log(monado: &Monado) -> String {
    fs::read_to_string(monado.folder.join("layer/log")).unwrap_or_default()
}

/// The shell's session is another one, seen, and of the same sculpture.
fn is_back(monado: &Monado, shell: &mut Shell, sessions: usize, voxels: u64) {
    let made = || log(monado).lines().filter(|line| *line == "session").count();
    wait_for("another session", || made() == sessions);
    let said = shell.until("focus", |said| said.field("life") == "focused");
    assert_eq!(said.number("voxels"), voxels, "the sculpture is kept");
    assert!(said.field("holds").contains("burr"), "and so is the tool");
    shell.frames(2);
}

#[test]
fn hands_feel_the_stone_and_losses_lose_nothing() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let Some(layer) = require(example("liblayer.so")).unwrap() else { return };
    let monado = Monado::start(&tree, "layered");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.layered_shell(&layer, &["--depth"]);
    shell.until("focus", |said| said.field("life") == "focused");
    shell.until("a session", |said| said.field("session") == "Sculpting");
    let asked = log(&monado);
    for line in [
        "own extensions 8",
        "rate 72",
        "level CPU SUSTAINED_HIGH",
        "level GPU SUSTAINED_HIGH",
        "thread APPLICATION_MAIN its own",
        "thread RENDERER_MAIN its own",
    ] {
        assert!(asked.lines().any(|asked| asked == line), "{line}: {asked}");
    }
    take(&mut hands, &mut shell, Tool::Rotary);
    hands.hold(RIGHT, REST);
    shell.frames(3);
    assert!(!log(&monado).contains("pulse"), "the air is not felt");
    carve(&mut hands, &mut shell, 1500);
    pulses_are_of_one_hand(&log(&monado));

    let voxels = shell.say().number("voxels");
    inject(&monado, "heat");
    inject(&monado, "presence 0");
    inject(&monado, "presence 1");
    for (i, loss) in ["lose session", "lose instance", "fail"].into_iter().enumerate() {
        inject(&monado, loss);
        is_back(&monado, &mut shell, i + 2, voxels);
    }
    let (code, errors) = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert!(errors.contains("the headset is hot"), "{errors}");
    assert_eq!(errors.matches("the sculpture is kept").count(), 3, "{errors}");
    let log = log(&monado);
    nothing_is_violated(&log);
    assert!(!log.contains("oveation"), "this device has no density maps");
    assert!(log.contains("depth\n"), "the compositor was to get depth");
}

/// All calls came in their order, and with what belongs to them.
pub(crate) fn nothing_is_violated(log: &str) {
    let violations: Vec<&str> = log.lines().filter(|line| line.contains("violation")).collect();
    assert!(violations.is_empty(), "{violations:#?}");
}

/// One pulse a frame, of the hand that carves, as strong as can be and as long as the frame's ticks.
fn pulses_are_of_one_hand(log: &str) {
    let pulses: Vec<Vec<&str>> = log
        .lines()
        .filter(|line| line.starts_with("pulse"))
        .map(|line| line.split(' ').collect())
        .collect();
    assert!(pulses.len() > 5, "{} pulses", pulses.len());
    for pulse in &pulses {
        let &[_, _, hand, _, amplitude, _, nanos, frame] = &pulse[..] else { panic!("{pulse:?}") };
        assert_eq!((hand, frame), (pulses[0][2], "Begun"));
        let amplitude: f32 = amplitude.parse().expect("a number");
        let ticks = nanos.parse::<f64>().expect("a number") * 72e-9;
        assert!(amplitude > 0.0 && amplitude <= 1.0, "{pulse:?}");
        assert!((0.99..4.01).contains(&ticks), "{ticks} ticks");
    }
}
