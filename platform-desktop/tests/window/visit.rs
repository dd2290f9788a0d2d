//! A session from the first click to the print.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use paros_shell::require::{MissingDependency, require_or_skip};

use super::rig::{
    HEIGHT, STROKE, ScriptedWindow, WIDTH, XvfbDisplay, check_program, count_differing,
    empty_folder, paros_command,
};

#[test]
fn a_visitor_carves_undoes_and_finishes() -> Result<(), MissingDependency> {
    let folder = empty_folder("visit");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    let start = visit.screenshot(&display, "1-start");
    visit.do_all(&["start free", "wait 4", "wheel 6", "move 3 97"]);
    let whole = visit.voxel_count();
    let stone = visit.screenshot(&display, "2-stone");
    assert!(count_differing(&start, &stone, [0, WIDTH], [0, HEIGHT]) > 20_000, "the stone is seen");
    visit.do_all(&STROKE);
    visit.do_step("move 3 97");
    let left = visit.voxel_count();
    assert!(left + 300 < whole, "{left} voxels are left of {whole}");
    let carved = visit.screenshot(&display, "3-carved");
    let middle = ([340, 660], [180, 440]);
    let groove = count_differing(&stone, &carved, middle.0, middle.1);
    assert!(groove > 500, "the groove is seen in {groove} pixels");
    visit.do_step("key z");
    visit.do_step("wait 2");
    assert_eq!(visit.voxel_count(), whole);
    let undone = visit.screenshot(&display, "4-undone");
    let still = count_differing(&stone, &undone, middle.0, middle.1);
    assert!(still * 20 < groove, "{still} pixels are still another");
    visit.do_all(&["key y", "wait 2"]);
    assert_eq!(visit.voxel_count(), left);
    let plain = visit.screenshot(&display, "5-redone");
    for (key, name, least) in [("key f1", "5-help", 20_000), ("key f2", "5-graph", 2_000)] {
        visit.do_step(key);
        let shown = visit.screenshot(&display, name);
        let pixels = count_differing(&plain, &shown, [0, WIDTH], [0, HEIGHT]);
        assert!(pixels > least, "{name} is seen in {pixels} pixels");
        visit.do_step(key);
    }
    // The first press asks, the second confirms.
    visit.do_all(&["key enter", "wait 4"]);
    assert_eq!(visit.ask_state("session"), "Sculpting");
    visit.do_all(&["key enter", "wait 4", "settle"]);
    assert_eq!(visit.ask_state("session"), "Finished");
    visit.screenshot(&display, "6-finished");
    let print = PathBuf::from(visit.ask_state("printed"));
    visit.do_step("key r");
    visit.do_step("settle");
    let (code, complaints) = visit.close();
    assert_eq!((code, &*complaints), (Some(0), ""));
    assert!(print.starts_with(folder.join("Paros")), "{}", print.display());
    for ending in ["png", "rmap"] {
        assert!(print.with_extension(ending).exists(), "no {ending}");
    }
    let played =
        paros_command(&folder).arg("play").arg(folder.join("Paros/session-001.trace")).output();
    let played = String::from_utf8_lossy(&played.expect("it can be started").stdout).into_owned();
    assert!(played.contains(&format!("{left} voxels")), "{played}");
    check_print(&print)
}

/// Checks that the print has triangles, and that `admesh` finds nothing to repair.
pub(crate) fn check_print(print: &Path) -> Result<(), MissingDependency> {
    assert!(fs::metadata(print).expect("the print").len() > 84);
    let checked = Command::new("admesh").arg(print).output();
    let Some(report) = require_or_skip(checked.map_err(|error| format!("no admesh: {error}")))?
    else {
        return Ok(());
    };
    let report = String::from_utf8_lossy(&report.stdout);
    for what in ["Total disconnected facets", "Facets added", "Edges fixed"] {
        let line = report.lines().find(|line| line.starts_with(what));
        let zero = line
            .and_then(|line| line.split(':').nth(1))
            .map(|rest| rest.split_whitespace().next() == Some("0"));
        assert_eq!(zero, Some(true), "{what} in {report}");
    }
    Ok(())
}

#[test]
fn a_mouse_and_keys_do_what_the_help_says() -> Result<(), MissingDependency> {
    let folder = empty_folder("devices");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let Some(()) = require_or_skip(check_program("xdotool", "--version"))? else { return Ok(()) };
    let x = |arguments: &str| display.xdotool(arguments);
    let mut visit = ScriptedWindow::new(&display);
    visit.do_step("frames 2");
    // Clicks the first button of the start panel.
    let window = "search --name Paros windowfocus --sync";
    x(window);
    x("mousemove 440 250");
    visit.do_step("frames 3");
    x("click 1");
    visit.do_step("frames 4");
    assert_eq!(
        (visit.ask_state("session"), visit.ask_state("mode")),
        ("Sculpting".into(), "FreeForm".into())
    );
    let whole = visit.voxel_count();
    x("mousemove 430 300");
    visit.do_step("wait 20");
    x("mousedown 1");
    visit.do_step("wait 30");
    x("mousemove 520 320");
    visit.do_step("wait 60");
    x("mouseup 1");
    visit.do_step("wait 8");
    let left = visit.voxel_count();
    assert!(left + 100 < whole, "{left} voxels are left of {whole}");
    x("key z");
    visit.do_step("frames 4");
    assert_eq!(visit.voxel_count(), whole);
    x("key ctrl+shift+z");
    visit.do_step("frames 4");
    assert_eq!(visit.voxel_count(), left);
    for (key, held) in
        [("3", "paste nozzle"), ("1", "medium ball burr"), ("shift+3", "large ball burr")]
    {
        x(&format!("key {key}"));
        visit.do_step("frames 4");
        assert_eq!(visit.ask_state("holds"), held);
    }
    let before = visit.screenshot(&display, "1-before");
    x("mousedown 3");
    x("mousemove 700 260");
    x("mouseup 3");
    let turned = visit.screenshot(&display, "2-orbited");
    assert!(
        count_differing(&before, &turned, [200, 800], [100, 560]) > 20_000,
        "the eye went round"
    );
    let (code, complaints) = visit.close();
    assert_eq!((code, &*complaints), (Some(0), ""));
    Ok(())
}

/// Best-practice warnings of the validation layer that we ignore, with the reasons.
const PRACTICES: [&str; 5] = [
    // The buffers are the scene's; the sculpture's pipeline, drawn between, uses none.
    "DrawState-VtxIndexOutOfBounds",
    // A submission without semaphores to signal has an empty list of them, with an address.
    "SemaphoreCount",
    // A fixed, small number of memory blocks is allocated at the start, each for one purpose.
    "vkAllocateMemory-small-allocation",
    "vkBindMemory-small-dedicated-allocation",
    // Two command buffers are recorded again in each frame.
    "vkCreateCommandPool-command-buffer-reset",
];

#[test]
fn best_practices_have_nothing_new_to_say() -> Result<(), MissingDependency> {
    let folder = empty_folder("practices");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut command = paros_command(&folder);
    command
        .env("DISPLAY", &display.name)
        .env("VK_LAYER_ENABLES", "VK_VALIDATION_FEATURE_ENABLE_BEST_PRACTICES_EXT");
    let mut visit = ScriptedWindow::spawn(&mut command);
    visit.do_all(&["size 500 400", "start free", "wait 4", "frames 3"]);
    visit.do_all(&STROKE);
    visit.do_all(&["size 600 400", "frames 6"]);
    let (_, complaints) = visit.close();
    let mut others = Vec::new();
    for line in complaints.lines() {
        let id = line.split("BestPractices-").nth(1).and_then(|rest| rest.split(' ').next());
        if id.is_none_or(|id| !PRACTICES.contains(&id)) {
            others.push(line);
        }
    }
    assert!(others.is_empty(), "{others:#?}");
    Ok(())
}

/// The tool bar, the start panel and the help fit completely in the smallest supported window.
#[test]
fn the_smallest_window_shows_whole_panels() -> Result<(), MissingDependency> {
    let folder = empty_folder("smallest");
    let Some(display) = require_or_skip(XvfbDisplay::with_size(&folder, [640, 420]))? else {
        return Ok(());
    };
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["size 640 420", "frames 3"]);
    visit.screenshot(&display, "1-start");
    visit.do_all(&["start free", "wait 4", "move 3 50"]);
    let bar = visit.screenshot(&display, "2-tools");
    // The bar's background is dark, and the room on both sides of it isn't.
    let is_panel = |x: usize| bar.pixel(x, 365).iter().all(|channel| *channel < 40);
    assert!((40..600).any(is_panel), "the tool bar is seen");
    assert!(!is_panel(2) && !is_panel(637), "the tool bar ends within the window");
    visit.do_step("key f1");
    visit.screenshot(&display, "3-help");
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}

#[test]
fn the_mirror_shows_its_plane_while_it_works() -> Result<(), MissingDependency> {
    let folder = empty_folder("mirror");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    // Beside the stone, so that no bit is shown.
    visit.do_all(&["start free", "wait 4", "size 1000 700", "move 3 60", "wait 90", "settle"]);
    let plain = visit.screenshot(&display, "1-plain");
    visit.do_all(&["key m", "wait 4"]);
    let mirrored = visit.screenshot(&display, "2-mirrored");
    visit.do_all(&["key m", "wait 4"]);
    let again = visit.screenshot(&display, "3-again");
    // The panels are below this area, and the status line above it.
    let differing = |image| count_differing(&plain, image, [300, 700], [100, 500]);
    let lines = differing(&mirrored);
    assert!((300..6000).contains(&lines), "{lines} pixels are of the plane");
    assert!(differing(&again) < 20, "{} pixels are others", differing(&again));
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}
