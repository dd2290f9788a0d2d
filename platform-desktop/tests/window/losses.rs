//! Window sizes, invalid files, and losses: of the device, of the display.

use std::fs;

use paros_shell::require::{MissingDependency, require_or_skip};

use super::rig::{
    DRIVER, STROKE, ScriptedWindow, TETRAHEDRON, XvfbDisplay, empty_folder, paros_command,
};

#[test]
fn sizes_files_and_losses_are_survived() -> Result<(), MissingDependency> {
    let folder = empty_folder("survived");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start owl", "wait 4"]);
    visit.do_all(&STROKE);
    let voxels = visit.voxel_count();
    for (size, name) in [("700 500", "1-small"), ("1000 620", "2-wide"), ("120 90", "3-tiny")] {
        visit.do_step(&format!("size {size}"));
        visit.do_step("frames 2");
        visit.screenshot(&display, name);
        assert_eq!(visit.ask_state("size"), size.replace(' ', "x"));
    }
    visit.do_all(&["size 1000 700", "frames 3", "minimise", "wait 60", "restore", "frames 3"]);
    fs::write(folder.join("notes.obj"), "a letter, no mesh\n").expect("a file");
    fs::write(folder.join("notes.txt"), "a letter\n").expect("a file");
    for name in ["notes.obj", "notes.txt", "gone.stl"] {
        visit.do_step(&format!("open {}", folder.join(name).display()));
        visit.do_step("settle");
        visit.do_step("wait 4");
        let note = visit.ask_state("note");
        assert!(note.contains(name), "{note}");
        assert_eq!(visit.voxel_count(), voxels);
    }
    visit.screenshot(&display, "4-no-mesh");
    visit.do_all(&["lose", "frames 3"]);
    assert!(visit.ask_state("note").contains("lost and is back"));
    assert_eq!(visit.voxel_count(), voxels);
    let back = visit.screenshot(&display, "5-back");
    assert!(back.pixel(500, 300)[0] > 90, "the stone is in the middle");
    // A mesh becomes the start of a session.
    fs::write(folder.join("mesh.obj"), TETRAHEDRON).expect("a file");
    visit.do_step(&format!("open {}", folder.join("mesh.obj").display()));
    visit.do_all(&["settle", "key enter", "frames 2", "wait 8"]);
    assert_eq!(visit.ask_state("mode"), "Own");
    visit.screenshot(&display, "6-mesh");
    let (code, complaints) = visit.close();
    assert_eq!((code, &*complaints), (Some(0), ""));
    // The session that was left for the mesh's session is kept beside it.
    assert!(folder.join("data/paros/session-128.before.save").exists());
    Ok(())
}

#[test]
fn a_window_that_is_pulled_about_goes_on_carving() -> Result<(), MissingDependency> {
    let folder = empty_folder("pulled");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start free", "wait 4", "move 42 42", "wait 8", "press left"]);
    let whole = visit.voxel_count();
    let mut random = 1u32;
    let mut next = |most: u32| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        1 + (random >> 16) % most
    };
    for _ in 0..40 {
        visit.do_step(&format!("size {} {}", next(1200), next(900)));
        visit.do_step(&format!("wait {}", next(6)));
    }
    for size in ["1 1", "2400 10", "10 1800", "2600 1900", "900 600"] {
        visit.do_step(&format!("size {size}"));
        visit.do_step("frames 2");
        assert_eq!(visit.ask_state("size"), size.replace(' ', "x"));
    }
    visit.do_all(&["move 50 46", "wait 20", "release left", "wait 4"]);
    assert!(visit.voxel_count() < whole);
    visit.screenshot(&display, "1-after");
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}

#[test]
fn a_vanished_display_loses_no_sculpture() -> Result<(), MissingDependency> {
    let folder = empty_folder("vanished");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start cat", "wait 4"]);
    visit.do_all(&STROKE);
    visit.do_all(&["wait 100", "settle"]);
    let saved = visit.voxel_count();
    // Carve more than the last save holds.
    visit.do_all(&["press left", "move 46 52", "wait 30"]);
    let voxels = visit.voxel_count();
    assert!(voxels < saved);
    drop(display);
    let (code, complaints) = visit.wait_for_exit();
    assert_eq!(code, Some(1), "{complaints}");
    assert!(complaints.contains("display is gone"), "{complaints}");
    let display = XvfbDisplay::new(&folder).expect("it was there before");
    let mut visit = ScriptedWindow::new(&display);
    // The window may have carved on until it noticed the loss, for at most as long as it had carved before.
    let resumed = visit.voxel_count();
    let least = voxels - (saved - voxels);
    assert!((least..=voxels).contains(&resumed), "{resumed}, {voxels}, {saved}");
    assert_eq!(visit.ask_state("mode"), "Constrained { figure: 9 }");
    visit.screenshot(&display, "1-resumed");
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}

#[test]
fn without_a_display_or_a_device_a_line_says_so() -> Result<(), MissingDependency> {
    let folder = empty_folder("without");
    let output =
        paros_command(&folder).arg("window").env_remove("DISPLAY").output().expect("it starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("no display") && text.lines().count() == 1, "{text}");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let window = |driver: &str, script: &str| {
        fs::write(folder.join("script"), script).expect("a file");
        let mut window = paros_command(&folder);
        window.env("DISPLAY", &display.name).env("VK_DRIVER_FILES", driver).arg("window");
        let output = window.arg("--script").arg(folder.join("script")).output();
        let output = output.expect("it starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = window("/nowhere.json", "quit\n");
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("no window can be opened"), "{text}");
    let (code, text) = window(DRIVER, "wait 1\njump 3\n");
    assert_eq!(code, Some(2), "{text}");
    assert!(text.contains("line 2: no step: jump 3"), "{text}");
    Ok(())
}

/// If device memory runs out once, the window retries with a new device. If memory stays unavailable, the
/// session is saved and the window reports it.
#[test]
fn memory_that_runs_out_loses_no_sculpture() -> Result<(), MissingDependency> {
    let folder = empty_folder("starved");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start owl", "wait 4"]);
    visit.do_all(&STROKE);
    let voxels = visit.voxel_count();
    visit.do_all(&["starve 1", "size 700 500", "frames 3", "size 1000 700", "frames 3"]);
    assert!(visit.ask_state("note").contains("lost and is back"));
    let back = visit.screenshot(&display, "1-back");
    assert!(back.pixel(500, 300)[0] > 90, "the stone is in the middle");
    assert_eq!(visit.close(), (Some(0), String::new()));
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&STROKE);
    let left = visit.voxel_count();
    assert_ne!(left, voxels);
    visit.do_all(&["starve 100000", "size 700 500"]);
    let complaints = visit.read_stderr();
    assert_eq!(visit.window.wait().expect("it ends").code(), Some(1), "{complaints}");
    assert!(complaints.contains("memory") && complaints.contains("is saved in"), "{complaints}");
    assert_eq!(complaints.lines().count(), 1, "{complaints}");
    let mut visit = ScriptedWindow::new(&display);
    assert_eq!(visit.voxel_count(), left);
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}
