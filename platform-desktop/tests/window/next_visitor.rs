//! Visitors of a window who know only what it shows.

use std::fs;
use std::process::{Child, Stdio};
use std::thread;
use std::time::Duration;

use paros_shaders::panel::Message;
use paros_shaders::panel::layout;
use paros_shell::require::{MissingDependency, require_or_skip};
use paros_visit::PanelSpot;

use super::exhibition::{SETTINGS, choose_the_owl, click, cut_and_finish};
use super::rig::{
    HEIGHT, STROKE, ScriptedWindow, WIDTH, XvfbDisplay, check_program, count_differing,
    empty_folder, paros_command,
};

/// Opens a window with visits on a display, and waits for its stone.
fn open_visits(display: &XvfbDisplay) -> ScriptedWindow {
    let settings = display.folder.join("paros.toml");
    fs::write(&settings, SETTINGS).expect("settings");
    let settings = settings.display().to_string();
    let mut command = paros_command(&display.folder);
    let command = command.env("DISPLAY", &display.name);
    let mut visit = ScriptedWindow::spawn_with(command, &["--settings", &settings]);
    visit.do_all(&["size 700 490", "wait 10"]);
    visit
}

#[test]
fn who_comes_while_the_last_one_is_thanked_begins_a_visit() -> Result<(), MissingDependency> {
    let folder = empty_folder("next-visitor");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = open_visits(&display);
    choose_the_owl(&mut visit, &display);
    cut_and_finish(&mut visit, &display);
    assert!(visit.ask_state("visit").starts_with("Thanks"), "{}", visit.ask_state("visit"));
    visit.screenshot(&display, "11-thanks");
    let print = folder.join("Paros/sculpture-001.stl");
    assert!(print.exists(), "the last visitor's is kept first");
    let button = layout::notice_button(0, Message::NewVisit, 0, 1).rect;
    click(&mut visit, PanelSpot::Caption, [1000.0, 650.0], button);
    assert_eq!(visit.ask_state("visit"), "Welcome TakeTool");
    assert_eq!(visit.ask_state("session"), "Sculpting");
    visit.screenshot(&display, "12-welcome-again");
    let (code, complaints) = visit.close();
    assert_eq!((code, complaints.lines().count()), (Some(0), 1), "{complaints}");
    Ok(())
}

/// Each step of the guide ends with the action that it asks for; the last step has two such actions.
#[test]
fn the_guides_steps_end_by_what_they_ask_for() -> Result<(), MissingDependency> {
    let folder = empty_folder("look-around");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    for way in ["a drag with the right button", "a key"] {
        let mut visit = open_visits(&display);
        choose_the_owl(&mut visit, &display);
        visit.do_all(&["move 3 60", "key 1", "wait 6"]);
        assert_eq!(visit.ask_state("visit"), "Guided Touch", "beside the stone");
        visit.do_all(&["move 45 45", "wait 20"]);
        assert_eq!(visit.ask_state("visit"), "Guided Cut", "over it");
        visit.do_step("press left");
        visit.do_all(&["move 55 47", "wait 60", "release left", "wait 8", "key 4", "wait 4"]);
        visit.do_all(&["press left", "move 45 45", "wait 60", "release left", "wait 20"]);
        assert_eq!(visit.ask_state("visit"), "Guided Undo", "{way}");
        visit.do_all(&["press right", "move 80 45", "release right", "wait 4", "key z", "wait 4"]);
        assert_eq!(visit.ask_state("visit"), "Guided TurnStool", "{way}: it looked before");
        visit.screenshot(&display, way);
        match way {
            "a key" => visit.do_all(&["down a", "wait 4", "up a", "wait 4"]),
            _ => {
                visit.do_all(&["press right", "move 78 45", "wait 4"]);
                assert_eq!(visit.ask_state("visit"), "Guided TurnStool", "hardly another side");
                visit.do_all(&["move 50 45", "wait 4", "release right", "wait 4"]);
            }
        }
        assert!(visit.ask_state("visit").starts_with("Sculpting"), "{way}");
        assert_eq!(visit.close().0, Some(0));
        fs::remove_dir_all(folder.join("data")).expect("it is there");
    }
    Ok(())
}

#[test]
fn a_kiosk_keeps_what_its_visitor_left_and_then_shows_the_start() -> Result<(), MissingDependency> {
    let folder = empty_folder("kiosk");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let settings = folder.join("paros.toml");
    fs::write(&settings, "kiosk_seconds = 30\n").expect("settings");
    let settings = settings.display().to_string();
    let mut command = paros_command(&folder);
    let command = command.env("DISPLAY", &display.name);
    let mut visit = ScriptedWindow::spawn_with(command, &["--kiosk", "--settings", &settings]);
    visit.do_all(&["start free", "wait 4", "wheel 6"]);
    visit.do_all(&STROKE);
    visit.do_all(&["move 3 97", "wait 2000"]);
    visit.screenshot(&display, "1-countdown");
    assert_eq!(visit.ask_state("session"), "Sculpting", "28 seconds");
    visit.do_step("wait 160");
    assert_eq!(visit.ask_state("session"), "Finished", "30 seconds");
    let finished = visit.screenshot(&display, "2-finished");
    visit.do_all(&["settle", "wait 1440"]);
    let start = visit.screenshot(&display, "3-start");
    let pixels = count_differing(&finished, &start, [0, WIDTH], [0, HEIGHT]);
    assert!(pixels > 20_000, "the start is seen in {pixels} pixels");
    assert!(folder.join("Paros/sculpture-001.stl").exists(), "no print");
    let (code, complaints) = visit.close();
    assert_eq!((code, complaints.lines().count()), (Some(0), 1), "the setting alone: {complaints}");
    Ok(())
}

/// A process that is killed when dropped.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        // The process may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_window_is_no_larger_than_a_small_screen() -> Result<(), MissingDependency> {
    let folder = empty_folder("small-screen");
    let Some(display) = require_or_skip(XvfbDisplay::with_size(&folder, [1024, 768]))? else {
        return Ok(());
    };
    let Some(()) = require_or_skip(check_program("xdotool", "--version"))? else { return Ok(()) };
    let mut command = paros_command(&folder);
    command.env("DISPLAY", &display.name).args(["window", "--visits", "--size", "128"]);
    let command = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let _window = Ended(command.spawn().expect("it starts"));
    let size = display.ask_xdotool("search --sync --onlyvisible --name Paros getwindowgeometry");
    assert!(size.contains("Geometry: 1008x688"), "{size}");
    thread::sleep(Duration::from_secs(8));
    display.save_screenshot("attract");
    Ok(())
}
