//! Density maps and their levels: the OpenXR layer provides what Monado lacks, and a Vulkan layer claims that
//! lavapipe, which shades everything equally, reads density maps. The tests prove the shell's requests and
//! their order, and that Vulkan's validation finds no fault.

use std::fs;

use paros_core::internals::STOOL_TOP;
use paros_core::session::Tool;
use paros_shell::require::require_or_skip;

use super::layered::{assert_no_violations, find_rig, inject_event, read_log};
use super::monado::{MonadoService, MonadoTree, RemoteHand, ShellEnd, ShellProcess, wait_for};
use super::{RIGHT, hands_at_rest, take_tool};

/// Returns the levels that were set, in order.
fn logged_levels(monado: &MonadoService) -> Vec<String> {
    let log = read_log(monado);
    log.lines().filter_map(|line| line.strip_prefix("foveation ")).map(str::to_owned).collect()
}

#[test]
fn heat_raises_foveation_between_strokes() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "foveated");
    let mut hands = hands_at_rest(&monado);
    let mut shell = monado.start_mapped_shell(&layer, &["--foveation", "low"]);
    shell.wait_until("a session", |said| said.field("session") == "Sculpting");
    let asked = read_log(&monado);
    assert!(asked.contains("density maps 1\n"), "the device's extension is enabled: {asked}");
    assert!(asked.contains("mapped swapchain\n"), "{asked}");
    assert!(asked.contains("subsampled swapchain\n"), "{asked}");
    assert_eq!(logged_levels(&monado), ["LOW"]);

    take_tool(&mut hands, &mut shell, Tool::Rotary);
    let stroke = RemoteHand { trigger: 1.0, ..RemoteHand::at(0.05, STOOL_TOP.y + 0.27, 0.1) };
    hands.place_hand(RIGHT, stroke);
    shell.wait_frames(3);
    inject_event(&monado, "heat");
    shell.wait_frames(5);
    assert_eq!(logged_levels(&monado), ["LOW"], "in the middle of a stroke");
    hands.place_hand(RIGHT, RemoteHand { trigger: 0.0, ..stroke });
    wait_for("the level", || logged_levels(&monado) == ["LOW", "HIGH"]);
    inject_event(&monado, "cool");
    wait_for("the level", || logged_levels(&monado) == ["LOW", "HIGH", "LOW"]);
    // A recreated swapchain gets its level again, and has density maps of its own.
    inject_event(&monado, "lose session");
    wait_for("the level", || logged_levels(&monado) == ["LOW", "HIGH", "LOW", "LOW"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_frames(3);

    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(errors.matches("paros-quest: foveation low\n").count(), 3, "{errors}");
    assert!(!errors.contains("no foveation"), "{errors}");
    assert_no_violations(&read_log(&monado));
}

/// Depth is submitted with one sample a pixel, and a framebuffer for each pair of images.
#[test]
fn depth_goes_together_with_density_maps() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "foveated-depth");
    let mut shell = monado.start_mapped_shell(&layer, &["--foveation", "high", "--depth"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_frames(5);
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    assert_eq!(logged_levels(&monado), ["HIGH"]);
    assert!(read_log(&monado).contains("depth\n"), "the compositor was to get depth");
    assert_no_violations(&read_log(&monado));
}

#[test]
fn what_is_asked_for_and_missing_is_told_in_a_line() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "unfoveated");
    let told = |mut shell: ShellProcess| {
        shell.wait_until("a session", |said| said.field("session") == "Sculpting");
        let ShellEnd { code, errors } = shell.quit();
        assert_eq!(code, Some(0), "{errors}");
        let line = errors.lines().find(|line| line.contains("though"));
        line.unwrap_or_default().to_owned()
    };
    let asks = ["--foveation", "medium"];
    let runtime = told(monado.start_shell(&asks));
    let start = "paros-quest: no foveation, though medium is asked for: Monado";
    assert!(runtime.starts_with(start), "{runtime}");
    for name in paros_quest::foveation::FOVEATION_EXTENSIONS {
        assert!(runtime.contains(name), "{runtime}");
    }
    let device = told(monado.start_layered_shell(&layer, &asks));
    assert!(
        device.contains("llvmpipe") && device.contains("VK_EXT_fragment_density_map"),
        "{device}"
    );
    assert_eq!(told(monado.start_layered_shell(&layer, &[])), "", "nobody asked");
    fs::write(monado.folder.join("layer/no-depth"), "").expect("a wish");
    let depth = told(monado.start_layered_shell(&layer, &["--depth"]));
    let start = "paros-quest: no depth for the compositor, though it is asked for: Monado";
    assert!(depth.starts_with(start) && depth.ends_with("takes no D32_SFLOAT"), "{depth}");
    // If foveation is off, it isn't even requested from a runtime that has it.
    let asked = read_log(&monado);
    assert_eq!(told(monado.start_layered_shell(&layer, &["--foveation", "off"])), "");
    assert!(read_log(&monado)[asked.len()..].contains("own extensions 6\n"));
    assert_eq!(logged_levels(&monado), [""; 0]);
}

/// The runtime may refuse subsampled images, or not know the extension: the images are then ordinary ones.
#[test]
fn images_are_whole_where_the_runtime_refuses_subsampled_ones() {
    let Some(tree) = require_or_skip(MonadoTree::find()).unwrap() else { return };
    let Some(layer) = require_or_skip(find_rig("liblayer.so")).unwrap() else { return };
    let monado = MonadoService::start(&tree, "not-subsampled");
    fs::create_dir_all(monado.folder.join("layer")).expect("a folder");
    fs::write(monado.folder.join("layer/no-subsampling"), "").expect("a wish");
    let mut shell = monado.start_mapped_shell(&layer, &["--foveation", "low"]);
    shell.wait_until("focus", |said| said.field("life") == "focused");
    shell.wait_frames(3);
    let ShellEnd { code, errors } = shell.quit();
    assert_eq!(code, Some(0), "{errors}");
    let log = read_log(&monado);
    assert!(log.contains("subsampled swapchain refused\nmapped swapchain\n"), "{log}");
    assert!(!log.contains("subsampled swapchain\n"), "{log}");
    assert_eq!(logged_levels(&monado), ["LOW"]);
    assert_no_violations(&log);
}
