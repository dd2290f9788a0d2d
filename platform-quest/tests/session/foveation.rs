//! Density maps and their levels: the layer hands out what Monado has not, and a layer of Vulkan
//! says that lavapipe reads it, which draws all alike. What is proved is what the shell asks for,
//! in which order, and that Vulkan's validation finds nothing wrong with it.

use std::fs;

use paros_core::frame::STOOL;
use paros_core::tools::Tool;
use paros_shell::require::require;

use super::layered::{example, inject, log, nothing_is_violated};
use super::monado::{Hand, Monado, Shell, Tree, wait_for};
use super::{RIGHT, hands_at_rest, take};

/// The levels that were set, in their order.
fn levels(monado: &Monado) -> Vec<String> {
    let log = log(monado);
    log.lines().filter_map(|line| line.strip_prefix("foveation ")).map(str::to_owned).collect()
}

#[test]
fn heat_raises_foveation_between_strokes() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let Some(layer) = require(example("liblayer.so")).unwrap() else { return };
    let monado = Monado::start(&tree, "foveated");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.mapped_shell(&layer, &["--foveation", "low"]);
    shell.until("a session", |said| said.field("session") == "Sculpting");
    let asked = log(&monado);
    assert!(asked.contains("density maps 1\n"), "the device's extension is enabled: {asked}");
    assert!(asked.contains("mapped swapchain\n"), "{asked}");
    assert_eq!(levels(&monado), ["LOW"]);

    take(&mut hands, &mut shell, Tool::Rotary);
    let stroke = Hand { trigger: 1.0, ..Hand::at(0.05, STOOL.y + 0.27, 0.1) };
    hands.hold(RIGHT, stroke);
    shell.frames(3);
    inject(&monado, "heat");
    shell.frames(5);
    assert_eq!(levels(&monado), ["LOW"], "in the middle of a stroke");
    hands.hold(RIGHT, Hand { trigger: 0.0, ..stroke });
    wait_for("the level", || levels(&monado) == ["LOW", "HIGH"]);
    inject(&monado, "cool");
    wait_for("the level", || levels(&monado) == ["LOW", "HIGH", "LOW"]);
    // One that is made anew is set anew, and its maps are its own.
    inject(&monado, "lose session");
    wait_for("the level", || levels(&monado) == ["LOW", "HIGH", "LOW", "LOW"]);
    shell.until("focus", |said| said.field("life") == "focused");
    shell.frames(3);

    let (code, errors) = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(errors.matches("paros-quest: foveation low\n").count(), 3, "{errors}");
    assert!(!errors.contains("no foveation"), "{errors}");
    nothing_is_violated(&log(&monado));
}

/// Depth is handed over with one sample a pixel, and a framebuffer for each pair of images.
#[test]
fn depth_goes_together_with_density_maps() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let Some(layer) = require(example("liblayer.so")).unwrap() else { return };
    let monado = Monado::start(&tree, "foveated-depth");
    let mut shell = monado.mapped_shell(&layer, &["--foveation", "high", "--depth"]);
    shell.until("focus", |said| said.field("life") == "focused");
    shell.frames(5);
    let (code, errors) = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(levels(&monado), ["HIGH"]);
    assert!(log(&monado).contains("depth\n"), "the compositor was to get depth");
    nothing_is_violated(&log(&monado));
}

#[test]
fn what_is_asked_for_and_missing_is_told_in_a_line() {
    let Some(tree) = require(Tree::find()).unwrap() else { return };
    let Some(layer) = require(example("liblayer.so")).unwrap() else { return };
    let monado = Monado::start(&tree, "unfoveated");
    let told = |mut shell: Shell| {
        shell.until("a session", |said| said.field("session") == "Sculpting");
        let (code, errors) = shell.quit();
        assert_eq!(code, Some(0), "{errors}");
        let line = errors.lines().find(|line| line.contains("though"));
        line.unwrap_or_default().to_owned()
    };
    let asks = ["--foveation", "medium"];
    let runtime = told(monado.shell(&asks));
    let start = "paros-quest: no foveation, though medium is asked for: Monado";
    assert!(runtime.starts_with(start), "{runtime}");
    for name in paros_quest::foveation::EXTENSIONS {
        assert!(runtime.contains(name), "{runtime}");
    }
    let device = told(monado.layered_shell(&layer, &asks));
    assert!(
        device.contains("llvmpipe") && device.contains("VK_EXT_fragment_density_map"),
        "{device}"
    );
    assert_eq!(told(monado.layered_shell(&layer, &[])), "", "nobody asked");
    fs::write(monado.folder.join("layer/no-depth"), "").expect("a wish");
    let depth = told(monado.layered_shell(&layer, &["--depth"]));
    let start = "paros-quest: no depth for the compositor, though it is asked for: Monado";
    assert!(depth.starts_with(start) && depth.ends_with("takes no D32_SFLOAT"), "{depth}");
    // Left off, it is not even asked of a runtime that has it.
    let asked = log(&monado);
    assert_eq!(told(monado.layered_shell(&layer, &["--foveation", "off"])), "");
    assert!(log(&monado)[asked.len()..].contains("own extensions 4\n"));
    assert_eq!(levels(&monado), [""; 0]);
}
