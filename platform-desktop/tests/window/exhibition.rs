//! Visits in a window, by the mouse alone: from the attract phase to the badge.

use std::fs;
use std::time::Duration;

use glam::{Quat, Vec2, Vec3};
use paros_shaders::panel::PanelRect;
use paros_shaders::panel::layout;
use paros_shaders::panel::{Icon, Message};
use paros_shell::last_use::LastUse;
use paros_shell::require::{MissingDependency, require_or_skip};
use paros_visit::{PanelSpot, WindowView};

use super::rig::{
    HEIGHT, ScriptedWindow, WIDTH, XvfbDisplay, count_differing, empty_folder, paros_command,
};

/// Tangent of half the vertical angle of a picture without a covering tool bar, as in the window's camera.
const HALF: f32 = 0.376_4;

/// Sizes of panels in millimetres.
const WELCOME: [f32; 2] = [1080.0, 476.0];
const CHOICE: [f32; 2] = [1020.0, 580.0];

/// Clicks on the middle of a panel's button that nothing covers.
pub(crate) fn click(
    visit: &mut ScriptedWindow,
    spot: PanelSpot,
    size: [f32; 2],
    button: PanelRect,
) {
    let right = HALF * WIDTH as f32 / HEIGHT as f32;
    let view = WindowView {
        position: Vec3::ZERO,
        rotation: Quat::IDENTITY,
        left: -right,
        right,
        up: HALF,
        down: -HALF,
    };
    let pose = view.panel_pose(spot, size);
    let at = (button.middle() - 0.5 * Vec2::from_array(size)) * 1e-3 * pose.scale;
    let seen = pose.middle + Vec3::new(at.x, -at.y, 0.0);
    let [x, y] = [seen.x / -seen.z / right, -seen.y / -seen.z / HALF];
    let to = format!("move {} {}", 50.0 + 50.0 * x, 50.0 + 50.0 * y);
    // A button that has just appeared can't be pressed yet.
    visit.do_all(&[&to, "wait 24", "press left", "wait 2", "release left", "wait 4"]);
}

/// Short durations, so that the test also runs on a machine without a GPU.
pub(crate) const SETTINGS: &str = "visits = true
hands_off_seconds = 1
badge_least_seconds = 2
thanks_seconds = 5
ready_seconds = 3
";

#[test]
fn a_visitor_comes_and_leaves_with_a_badge() -> Result<(), MissingDependency> {
    let folder = empty_folder("exhibition");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let settings = folder.join("paros.toml");
    fs::write(&settings, SETTINGS).expect("settings");
    let settings = settings.display().to_string();
    let mut visit = ScriptedWindow::spawn_with(
        paros_command(&folder).env("DISPLAY", &display.name),
        &["--settings", &settings],
    );
    visit.do_all(&["size 700 490", "wait 10"]);
    assert_eq!(visit.ask_state("visit"), "Attract TakeTool");
    let stone = visit.voxel_count();
    visit.screenshot(&display, "1-attract");
    visit.do_step("wait 400");
    assert!(visit.voxel_count() < stone, "nobody carves");
    visit.screenshot(&display, "2-attract-later");
    choose_the_owl(&mut visit, &display);
    cut_and_finish(&mut visit, &display);
    for phase in ["Thanks", "Handover", "Attract"] {
        let wait = if phase == "Thanks" { "wait 4" } else { "wait 380" };
        visit.do_step(wait);
        visit.screenshot(&display, phase);
        assert!(visit.ask_state("visit").starts_with(phase), "{}", visit.ask_state("visit"));
    }
    // The mouse was not idle: the next visitor presses once, and again as the welcome appears.
    visit.do_all(&["move 50 68", "wait 4", "press left", "wait 2", "release left", "wait 4"]);
    visit.do_all(&["press left", "wait 2", "release left", "wait 4"]);
    assert_eq!(visit.ask_state("visit"), "Welcome TakeTool", "it has not been read");
    let (code, complaints) = visit.close();
    assert_eq!(code, Some(0), "{complaints}");
    assert_eq!(complaints.lines().count(), 1, "the settings and nothing else: {complaints}");
    let print = folder.join("Paros/sculpture-001.stl");
    assert!(print.exists(), "no print of the visitor's");
    assert!(!folder.join("Paros/sculpture-002.stl").exists(), "a print of nobody's");
    Ok(())
}

/// Plays a visit from the first movement of the mouse to the guided cut.
pub(crate) fn choose_the_owl(visit: &mut ScriptedWindow, display: &XvfbDisplay) {
    visit.do_all(&["move 50 50", "wait 4"]);
    assert_eq!(visit.ask_state("visit"), "Welcome TakeTool");
    let english = visit.screenshot(display, "3-welcome");
    let welcome = layout::welcome_buttons(0, 1);
    click(visit, PanelSpot::Main, WELCOME, welcome[1].rect);
    let greek = visit.screenshot(display, "4-welcome-greek");
    let pixels = count_differing(&english, &greek, [0, WIDTH], [0, HEIGHT]);
    assert!(pixels > 5_000, "the language is seen in {pixels} pixels");
    click(visit, PanelSpot::Main, WELCOME, welcome[0].rect);
    click(visit, PanelSpot::Main, WELCOME, welcome[6].rect);
    assert_eq!(visit.ask_state("visit"), "Choice TakeTool");
    see_living_previews(visit, display);
    let cards = layout::choice_buttons(0, &[(Message::ChoiceFree, Icon::Stone); 3]);
    click(visit, PanelSpot::Main, CHOICE, cards[1].rect);
    assert_eq!(visit.ask_state("visit"), "Guided TakeTool");
    assert!(visit.ask_state("mode").starts_with("Constrained"), "the owl's card");
    visit.screenshot(display, "6-guided");
}

/// Checks that pictures appear on the cards, and change as the starts turn.
fn see_living_previews(visit: &mut ScriptedWindow, display: &XvfbDisplay) {
    let mut seen = visit.screenshot(display, "5-choice");
    for name in ["5-choice-pictures", "5-choice-later"] {
        let mut is_changed = || {
            visit.do_step("wait 30");
            let now = visit.screenshot(display, name);
            let pixels = count_differing(&seen, &now, [0, WIDTH], [0, HEIGHT]);
            // The previews alone cover several times this area; a highlighted button covers less.
            let is_changed = pixels > 4_000;
            if is_changed {
                seen = now;
            }
            is_changed
        };
        assert!((0..20).any(|_| is_changed()), "{name}: nothing lives on the cards");
    }
}

/// Plays a visit from the tool in hand until the visitor leaves the badge.
pub(crate) fn cut_and_finish(visit: &mut ScriptedWindow, display: &XvfbDisplay) {
    cut_and_see_badge(visit, display);
    visit.do_all(&["move 20 20", "wait 150"]);
    let next = layout::badge_buttons(0)[0].rect;
    click(visit, PanelSpot::Beside, [1000.0, 936.0], next);
}

/// Plays a visit from the tool in hand to the badge.
pub(crate) fn cut_and_see_badge(visit: &mut ScriptedWindow, display: &XvfbDisplay) {
    visit.do_all(&["key 1", "wait 4", "move 45 45", "wait 20"]);
    visit.do_all(&["press left", "move 55 47", "wait 60", "release left", "wait 20"]);
    let done = visit.ask_state("visit");
    visit.screenshot(display, "7-cut");
    assert_eq!(done, "Guided Smooth");
    visit.do_all(&["key enter", "wait 4"]);
    visit.screenshot(display, "8-question");
    assert_eq!(visit.ask_state("visit"), "Guided Smooth", "asked once");
    visit.do_all(&["key escape", "wait 2", "key enter", "wait 4"]);
    assert_eq!(visit.ask_state("visit"), "Guided Smooth", "asked once again");
    visit.do_all(&["key enter", "wait 4"]);
    assert_eq!(visit.ask_state("visit"), "HandsOff Smooth");
    visit.screenshot(display, "9-hands-off");
    visit.do_all(&["wait 100", "settle", "wait 6"]);
    assert_eq!(visit.ask_state("visit"), "Badge Smooth");
    visit.screenshot(display, "10-badge");
}

/// A visit resumes if its window was killed or closed a short time ago. After a longer time than a visitor
/// may be away, the sculpture counts as a former visitor's, and is kept.
#[test]
fn a_visit_that_is_found_goes_on_or_was_a_former_visitors() -> Result<(), MissingDependency> {
    let folder = empty_folder("found");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let settings = folder.join("paros.toml");
    let short = "welcome_seconds = 5\nchoice_seconds = 5\n";
    fs::write(&settings, format!("{SETTINGS}{short}")).expect("settings");
    let settings = settings.display().to_string();
    let open = || {
        let mut command = paros_command(&folder);
        let command = command.env("DISPLAY", &display.name);
        let mut visit = ScriptedWindow::spawn_with(command, &["--settings", &settings]);
        visit.do_step("wait 12");
        visit
    };
    let mut visit = open();
    visit.do_all(&["move 50 50", "wait 4", "move 51 50", "wait 760", "move 45 45", "wait 4"]);
    assert!(visit.ask_state("visit").starts_with("Guided"), "{}", visit.ask_state("visit"));
    visit.do_all(&["key 1", "wait 4", "press left", "move 55 47", "wait 60", "release left"]);
    visit.do_all(&["wait 8", "settle", "wait 400", "settle"]);
    let (found, voxels) = (visit.ask_state("visit"), visit.voxel_count());
    visit.window.kill().expect("it ran");
    let _ = visit.window.wait();
    let mut visit = open();
    assert_eq!((visit.ask_state("visit"), visit.voxel_count()), (found, voxels), "killed");
    visit.close();
    let stamp = folder.join("data/paros/session-128.last-use");
    let bytes = fs::read(&stamp).expect("it is kept beside the save");
    let used = LastUse::decode(&bytes).expect("a time");
    let since_boot = used.since_boot.checked_sub(Duration::from_secs(60)).expect("a minute");
    fs::write(&stamp, LastUse { since_boot, ..used }.encode()).expect("it is written");
    let mut visit = open();
    assert!(visit.ask_state("visit").starts_with("HandsOff"), "{}", visit.ask_state("visit"));
    visit.do_all(&["wait 100", "settle", "wait 6"]);
    assert!(visit.ask_state("visit").starts_with("Handover"), "{}", visit.ask_state("visit"));
    visit.do_step("wait 300");
    assert!(visit.ask_state("visit").starts_with("Attract"), "{}", visit.ask_state("visit"));
    assert!(folder.join("Paros/sculpture-001.stl").exists(), "no print of the former visitor's");
    visit.close();
    Ok(())
}
