//! Disk faults: a full disk, two windows on one folder, damaged files, a missing folder.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use paros_shell::require::{MissingDependency, require_or_skip};

use super::desktop::WindowManager;
use super::rig::{
    STROKE, ScriptedWindow, TETRAHEDRON, XvfbDisplay, check_program, empty_folder, paros_command,
};
use super::visit::check_print;

const FINISH: [&str; 5] = ["key enter", "wait 4", "key enter", "wait 4", "settle"];

/// A small disk, unmounted when dropped.
struct TmpfsDisk(PathBuf);

impl TmpfsDisk {
    fn new(at: &Path, size: &str) -> Result<Self, String> {
        fs::create_dir_all(at).map_err(|error| error.to_string())?;
        let mut mount = Command::new("mount");
        let mounted = mount.args(["-t", "tmpfs", "-o", &format!("size={size}"), "tmpfs"]).arg(at);
        match mounted.output() {
            Ok(output) if output.status.success() => Ok(TmpfsDisk(at.to_owned())),
            Ok(output) => Err(String::from_utf8_lossy(&output.stderr).trim().to_owned()),
            Err(error) => Err(format!("no mount: {error}")),
        }
    }

    /// Fills the disk to the last byte.
    fn fill(&self) {
        let size = |bytes: usize| vec![0; bytes];
        let file = self.0.join("filler");
        fs::write(&file, size(1)).expect("it fits");
        // The part that fits stays on the disk.
        fs::write(&file, size(80 << 20)).expect_err("it is smaller");
    }

    fn free(&self) {
        fs::remove_file(self.0.join("filler")).expect("it is there");
    }
}

impl Drop for TmpfsDisk {
    fn drop(&mut self) {
        // A failed test may still use the disk.
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

#[test]
fn on_a_full_disk_the_window_stays_until_all_is_saved() -> Result<(), MissingDependency> {
    let folder = empty_folder("full");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let Some(()) = require_or_skip(check_program("xdotool", "--version"))? else { return Ok(()) };
    let Some(_manager) = require_or_skip(WindowManager::new(&display))? else { return Ok(()) };
    let Some(disk) = require_or_skip(TmpfsDisk::new(&folder.join("disk"), "64m"))? else {
        return Ok(());
    };
    let mut command = paros_command(&folder);
    command.env("DISPLAY", &display.name).env("HOME", &disk.0);
    let mut visit = ScriptedWindow::spawn(command.env("XDG_DATA_HOME", disk.0.join("data")));
    disk.fill();
    visit.do_all(&["start free", "wait 4"]);
    visit.do_all(&STROKE);
    visit.do_all(&["wait 230", "settle", "wait 4"]);
    assert!(visit.ask_state("fault").contains("session-128.save"));
    display.save_screenshot("1-not-saved");
    visit.do_all(&FINISH);
    visit.do_step("wait 4");
    assert_eq!(visit.ask_state("printed"), "");
    visit.do_step("frames 4");
    display.save_screenshot("2-not-written");
    display.xdotool("search --onlyvisible --name Paros windowfocus --sync key alt+F4");
    // The key press passes through the window manager.
    let mut notes = (0..20).map(|_| {
        visit.do_step("frames 8");
        visit.ask_state("note")
    });
    assert!(notes.any(|note| note.contains("Close the window again")), "the close isn't held up");
    display.save_screenshot("3-not-closed");
    disk.free();
    let left = visit.voxel_count();
    display.xdotool("search --onlyvisible --name Paros windowfocus --sync key alt+F4");
    let (code, complaints) = visit.wait_for_exit();
    assert_eq!((code, &*complaints), (Some(0), ""));
    check_print(&disk.0.join("Paros/sculpture-001.stl"))?;
    let mut command = paros_command(&folder);
    command.env("DISPLAY", &display.name).env("HOME", &disk.0);
    let mut visit = ScriptedWindow::spawn(command.env("XDG_DATA_HOME", disk.0.join("data")));
    assert_eq!((visit.voxel_count(), &*visit.ask_state("session")), (left, "Finished"));
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}

#[test]
fn without_a_folder_or_a_home_the_print_goes_elsewhere() -> Result<(), MissingDependency> {
    let folder = empty_folder("elsewhere");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    fs::write(folder.join("Paros"), "no folder").expect("a file");
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start cat", "wait 4"]);
    visit.do_all(&STROKE);
    visit.do_all(&FINISH);
    let print = PathBuf::from(visit.ask_state("printed"));
    assert_eq!(print, folder.join("data/paros/sculpture-001.stl"));
    check_print(&print)?;
    assert!(visit.ask_state("note").contains("Paros: cannot make the folder"));
    assert_eq!(visit.close(), (Some(0), String::new()));
    fs::remove_file(folder.join("Paros")).expect("a file");
    let mut command = paros_command(&folder);
    command.env_remove("XDG_DATA_HOME").env_remove("XDG_CACHE_HOME").env("HOME", "no/where");
    let mut visit =
        ScriptedWindow::spawn(command.current_dir(&folder).env("DISPLAY", &display.name));
    visit.do_all(&["start creative", "wait 4"]);
    visit.do_all(&FINISH);
    let print = PathBuf::from(visit.ask_state("printed"));
    assert_eq!(print, folder.join("Paros/sculpture-001.stl"));
    assert_eq!(visit.close(), (Some(0), String::new()));
    assert!(folder.join(".local/share/paros/session-128.save").exists());
    Ok(())
}

#[test]
fn two_windows_keep_two_sessions_and_all_their_prints() -> Result<(), MissingDependency> {
    let folder = empty_folder("two");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visits = [ScriptedWindow::new(&display), ScriptedWindow::new(&display)];
    for visit in &mut visits {
        visit.do_step("wait 4");
    }
    // The first window has the studio's session.
    if visits[0].ask_state("note").contains("another window") {
        visits.swap(0, 1);
    }
    assert!(visits[1].ask_state("note").contains("session-128-2.save"));
    for (visit, start) in visits.iter_mut().zip(["start cat", "start owl"]) {
        visit.do_all(&[start, "wait 4"]);
        visit.do_all(&STROKE);
    }
    let voxels = visits.each_mut().map(ScriptedWindow::voxel_count);
    for step in &FINISH[..4] {
        for visit in &mut visits {
            visit.do_step(step);
        }
    }
    let prints = visits.each_mut().map(|visit| {
        visit.do_step("settle");
        visit.ask_state("printed")
    });
    assert_ne!(prints[0], prints[1]);
    for print in &prints {
        check_print(Path::new(print))?;
    }
    for visit in visits {
        assert_eq!(visit.close(), (Some(0), String::new()));
    }
    let mut visit = ScriptedWindow::new(&display);
    assert_eq!(
        (visit.voxel_count(), &*visit.ask_state("mode")),
        (voxels[0], "Constrained { figure: 9 }")
    );
    let mut second = ScriptedWindow::new(&display);
    assert_eq!(
        (second.voxel_count(), &*second.ask_state("mode")),
        (voxels[1], "Constrained { figure: 8 }")
    );
    for visit in [visit, second] {
        assert_eq!(visit.close(), (Some(0), String::new()));
    }
    Ok(())
}

#[test]
fn a_session_that_cannot_be_read_is_kept() -> Result<(), MissingDependency> {
    let folder = empty_folder("unreadable");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start free", "wait 4"]);
    visit.do_all(&STROKE);
    assert_eq!(visit.close(), (Some(0), String::new()));
    let session = folder.join("data/paros/session-128.save");
    let good = fs::read(&session).expect("it was saved");
    let mut newer = good.clone();
    newer[4] = 99;
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    let cases = [
        (newer, "2 to 4 intervals a column at byte 4"),
        (flipped, "checksum"),
        (good[..good.len() / 2].to_vec(), "checksum"),
        (Vec::new(), "at byte 0"),
    ];
    for (number, (bytes, expected)) in cases.into_iter().enumerate() {
        fs::write(&session, &bytes).expect("a file");
        let mut visit = ScriptedWindow::new(&display);
        visit.do_step("wait 4");
        let note = visit.ask_state("note");
        let kept = format!("session-128.unreadable-{}", number + 1);
        assert!(note.contains(expected) && note.contains(&kept), "{note}");
        assert_eq!(visit.ask_state("session"), "Waiting");
        assert_eq!(visit.close(), (Some(0), String::new()));
        assert_eq!(fs::read(session.with_file_name(kept)).expect("it is kept"), bytes);
        assert!(!session.exists());
    }
    // Something that isn't a file is moved out of the way too.
    fs::create_dir(&session).expect("a folder");
    let mut visit = ScriptedWindow::new(&display);
    visit.do_step("wait 4");
    assert!(visit.ask_state("note").contains("unreadable-5"));
    visit.do_all(&["start free", "wait 4"]);
    assert_eq!(visit.close(), (Some(0), String::new()));
    assert!(session.is_file());
    Ok(())
}

#[test]
fn a_file_opened_while_the_print_is_made_costs_no_print() -> Result<(), MissingDependency> {
    let folder = empty_folder("while-finishing");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    fs::write(folder.join("mesh.obj"), TETRAHEDRON).expect("a file");
    let mesh = format!("open {}", folder.join("mesh.obj").display());
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start owl", "wait 4"]);
    visit.do_all(&STROKE);
    let left = visit.voxel_count();
    visit.do_all(&["key enter", "wait 4", "key enter", &mesh, "frames 2", "settle", "wait 8"]);
    assert_eq!((&*visit.ask_state("mode"), &*visit.ask_state("session")), ("Own", "Sculpting"));
    // Finished again immediately: two prints are in progress.
    visit.do_all(&FINISH);
    assert_eq!(visit.close(), (Some(0), String::new()));
    for number in 1..=2 {
        check_print(&folder.join(format!("Paros/sculpture-00{number}.stl")))?;
    }
    let told =
        paros_command(&folder).arg("info").arg(folder.join("Paros/sculpture-001.rmap")).output();
    let told = String::from_utf8_lossy(&told.expect("it starts").stdout).into_owned();
    assert!(told.replace(',', "").contains(&left.to_string()), "{told}");
    Ok(())
}

#[test]
fn what_is_wrong_with_the_settings_is_seen_in_the_window() -> Result<(), MissingDependency> {
    let folder = empty_folder("settings");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    fs::write(folder.join("wrong.toml"), "handover = 60\n").expect("a file");
    let open = |arguments: &[&str]| {
        let mut command = paros_command(&folder);
        command.current_dir(&folder).env("DISPLAY", &display.name);
        ScriptedWindow::spawn_with(&mut command, arguments)
    };
    let mut visit = open(&["--settings", "wrong.toml"]);
    visit.do_step("wait 4");
    let note = visit.ask_state("note");
    assert!(note.contains("wrong.toml:1:1") && note.contains("handover_seconds"), "{note}");
    visit.screenshot(&display, "1-settings");
    assert_eq!(visit.close().0, Some(0));
    // A kiosk's visitor can't correct faulty settings.
    let mut visit = open(&["--settings", "wrong.toml", "--kiosk"]);
    visit.do_step("wait 4");
    assert!(!visit.ask_state("note").contains("wrong.toml"));
    assert_eq!(visit.close().0, Some(0));
    Ok(())
}
