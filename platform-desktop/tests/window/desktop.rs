//! Events of a desktop: files dropped on the window, minimise and restore, a changed scale.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use paros_shell::require::{MissingDependency, require_or_skip};
use x11rb::CURRENT_TIME;
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ConnectionExt as _, PropMode};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use super::rig::{
    STROKE, ScriptedWindow, TETRAHEDRON, XvfbDisplay, check_program, count_differing, empty_folder,
    paros_command,
};
use super::xdnd::{self, drop_files};

/// A window manager, stopped when dropped.
pub(crate) struct WindowManager(Child);

impl WindowManager {
    pub(crate) fn new(display: &XvfbDisplay) -> Result<Self, String> {
        let manager = Command::new("openbox")
            .env("DISPLAY", &display.name)
            .env("HOME", &display.folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("no openbox: {error}"))?;
        // The manager takes over the screen before it handles windows.
        thread::sleep(Duration::from_millis(500));
        Ok(WindowManager(manager))
    }
}

impl Drop for WindowManager {
    fn drop(&mut self) {
        // The manager may have ended with its display.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn dropped_files_become_the_stone_or_are_refused() -> Result<(), MissingDependency> {
    let folder = empty_folder("dropped");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start cat", "wait 4"]);
    visit.do_all(&STROKE);
    let voxels = visit.voxel_count();
    let drop = |visit: &mut ScriptedWindow, names: &[&str]| {
        let paths: Vec<_> = names.iter().map(|name| folder.join(name)).collect();
        let paths: Vec<&Path> = paths.iter().map(|path| &**path).collect();
        let taken = thread::scope(|scope| {
            let dropping =
                scope.spawn(|| drop_files(&display.name, &paths).map_err(|e| e.to_string()));
            // The window only receives the drop while it draws.
            while !dropping.is_finished() {
                visit.do_step("frames 1");
            }
            dropping.join().expect("no panic")
        });
        assert_eq!(taken, Ok(true), "{names:?}");
        visit.do_all(&["settle", "wait 8", "settle"]);
    };
    fs::write(folder.join("a letter.obj"), "no mesh\n").expect("a file");
    fs::write(folder.join("a letter.txt"), "no mesh\n").expect("a file");
    fs::create_dir(folder.join("a folder.stl")).expect("a folder");
    for name in ["a letter.obj", "a letter.txt", "a folder.stl"] {
        drop(&mut visit, &[name]);
        let note = visit.ask_state("note");
        assert!(note.contains(name), "{note}");
        assert_eq!(
            (visit.voxel_count(), &*visit.ask_state("mode")),
            (voxels, "Constrained { figure: 9 }")
        );
    }
    visit.screenshot(&display, "1-refused");
    fs::write(folder.join("a shape.obj"), TETRAHEDRON).expect("a file");
    drop(&mut visit, &["a shape.obj"]);
    assert_eq!(visit.voxel_count(), voxels, "it is asked first");
    visit.do_all(&["key enter", "frames 2", "wait 8"]);
    let shape = visit.voxel_count();
    assert_eq!(visit.ask_state("mode"), "Own");
    assert!(shape != voxels && shape > 1000, "{shape}");
    visit.screenshot(&display, "2-mesh");
    let baked = paros_command(&folder)
        .args(["bake", "a shape.obj", "-o", "b.rmap"])
        .current_dir(&folder)
        .output()
        .expect("it starts");
    assert!(baked.status.success(), "{baked:?}");
    visit.do_all(&["start free", "wait 4"]);
    assert_ne!(visit.voxel_count(), shape);
    // Of several files the first is read, and the others are named.
    drop(&mut visit, &["b.rmap", "a shape.obj"]);
    assert_eq!((visit.voxel_count(), &*visit.ask_state("mode")), (shape, "Own"));
    assert!(visit.ask_state("note").contains("a shape.obj: not opened"));
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}

#[test]
fn minimised_it_draws_nothing_and_goes_on_after() -> Result<(), MissingDependency> {
    let folder = empty_folder("minimised");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let Some(()) = require_or_skip(check_program("xdotool", "--version"))? else { return Ok(()) };
    let Some(_manager) = require_or_skip(WindowManager::new(&display))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    // The cursor is placed outside, so that it doesn't enter the window again.
    display.xdotool("mousemove 990 690");
    visit.do_all(&["start owl", "wait 4", "size 900 600", "frames 4"]);
    let whole = visit.voxel_count();
    visit.do_all(&STROKE);
    // Wait until the chips, which live for up to 2.4 seconds, are gone.
    visit.do_all(&["move 3 97", "wait 240"]);
    let voxels = visit.voxel_count();
    assert!(voxels < whole);
    // Wait until the resolution scale fits the device's speed.
    visit.do_step("frames 12");
    let shown = visit.screenshot(&display, "1-shown");
    for _ in 0..3 {
        display.xdotool("search --onlyvisible --name Paros windowminimize --sync");
        // Frames in flight may still be drawn.
        visit.do_all(&["wait 4"; 3]);
        let frames = visit.ask_state("frames");
        visit.do_step("wait 60");
        assert_eq!((visit.ask_state("frames"), visit.voxel_count()), (frames, voxels));
        display.xdotool("search --name Paros windowmap --sync");
        visit.do_step("frames 4");
    }
    visit.do_all(&["move 3 97", "frames 12"]);
    let back = visit.screenshot(&display, "2-back");
    let far = count_differing(&shown, &back, [0, 1000], [0, 700]);
    assert!(far < 20, "{far} pixels are others");
    // A window without area draws nothing either, and requests no frames.
    visit.do_step("size 0 0");
    let frames = visit.ask_state("frames");
    visit.do_all(&["wait 12", "move 50 50", "press left", "wait 12", "release left"]);
    assert_eq!((visit.ask_state("frames"), visit.voxel_count()), (frames, voxels));
    visit.do_all(&["size 0 400", "wait 12", "size 700 500", "frames 4"]);
    assert_eq!(visit.ask_state("size"), "700x500");
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}

#[test]
fn on_a_fine_screen_all_is_larger_and_under_the_same_cursor() -> Result<(), MissingDependency> {
    let plain = empty_folder("plain");
    let Some(display) = require_or_skip(XvfbDisplay::with_size(&plain, [1180, 800]))? else {
        return Ok(());
    };
    let Some(()) = require_or_skip(check_program("xdotool", "--version"))? else { return Ok(()) };
    let mut visit = ScriptedWindow::new(&display);
    let (once, voxels) = carve_at_scale(&mut visit, &display, 1);
    assert_eq!(visit.close(), (Some(0), String::new()));
    let fine_folder = empty_folder("fine");
    let Some(display) = require_or_skip(XvfbDisplay::with_size(&fine_folder, [2360, 1600]))? else {
        return Ok(());
    };
    let mut command = paros_command(&fine_folder);
    let mut visit = ScriptedWindow::spawn(
        command.env("DISPLAY", &display.name).env("WINIT_X11_SCALE_FACTOR", "2"),
    );
    let (twice, fine_voxels) = carve_at_scale(&mut visit, &display, 2);
    assert_eq!(visit.close(), (Some(0), String::new()));
    // The same rays, except for rounding.
    assert!(fine_voxels.abs_diff(voxels) < 100, "{fine_voxels}, {voxels}");
    let block = |x: usize, y: usize, k: usize| {
        let all = [(0, 0), (1, 0), (0, 1), (1, 1)];
        all.map(|(dx, dy)| i32::from(twice.pixel(2 * x + dx, 2 * y + dy)[k]))
    };
    let pixels = || (0..800).flat_map(|y| (0..1180).map(move |x| (x, y)));
    let far = |(x, y): &(usize, usize)| {
        (0..3).any(|k| {
            let mean = block(*x, *y, k).iter().sum::<i32>() / 4;
            mean.abs_diff(i32::from(once.pixel(*x, *y)[k])) > 40
        })
    };
    let others = pixels().filter(far).count();
    assert!(others < 1180 * 800 / 100, "{others} pixels show another thing");
    let split = pixels().filter(|(x, y)| {
        let block = block(*x, *y, 1);
        block.iter().any(|value| value.abs_diff(block[0]) > 8)
    });
    let split = split.count();
    assert!(split > 20_000, "only {split} pixels are finer than before");
    Ok(())
}

/// Starts a session by a click, and carves. Returns the picture and the number of voxels left.
fn carve_at_scale(
    visit: &mut ScriptedWindow,
    display: &XvfbDisplay,
    scale: usize,
) -> (paros_shaders::Image, u64) {
    visit.do_step("frames 4");
    assert_eq!(visit.ask_state("size"), format!("{}x{}", 1180 * scale, 800 * scale));
    // Clicks the first button of the start panel.
    display.xdotool(&format!("mousemove {} {}", 440 * scale, 250 * scale));
    visit.do_step("frames 3");
    display.xdotool("click 1");
    visit.do_step("frames 4");
    assert_eq!(visit.ask_state("mode"), "FreeForm");
    visit.do_all(&STROKE);
    visit.do_step("move 3 97");
    // Neither the tool nor dust is in the picture.
    visit.do_step("wait 100");
    visit.do_step("frames 6");
    let picture = display.save_screenshot("carved");
    (picture, visit.voxel_count())
}

#[test]
fn a_scale_that_changes_is_followed() -> Result<(), MissingDependency> {
    let folder = empty_folder("scale");
    let Some(display) = require_or_skip(XvfbDisplay::with_size(&folder, [2360, 1600]))? else {
        return Ok(());
    };
    let mut settings = XSettings::new(&display.name).expect("the display takes settings");
    let mut visit = ScriptedWindow::new(&display);
    visit.do_all(&["start free", "frames 4"]);
    display.save_screenshot("1-once");
    for (dpi, scale, size) in [(192, "2", "2360x1600"), (144, "1.5", "1770x1200")] {
        settings.set_dpi(dpi).expect("it is set");
        visit.do_step("frames 6");
        assert_eq!((&*visit.ask_state("scale"), &*visit.ask_state("size")), (scale, size));
        display.save_screenshot(&format!("2-{dpi}"));
    }
    let whole = visit.voxel_count();
    visit.do_all(&STROKE);
    assert!(visit.voxel_count() + 300 < whole);
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}

/// A desktop's settings, as its daemon publishes them (XSETTINGS).
struct XSettings {
    connection: RustConnection,
    window: u32,
    property: u32,
}

impl XSettings {
    fn new(display: &str) -> Result<Self, Box<dyn Error>> {
        let (connection, screen) = x11rb::connect(Some(display))?;
        let atom = |name: &str| {
            Ok::<_, Box<dyn Error>>(connection.intern_atom(false, name.as_bytes())?.reply()?.atom)
        };
        let (owned, property) = (atom("_XSETTINGS_S0")?, atom("_XSETTINGS_SETTINGS")?);
        let window = xdnd::hidden_window(&connection, connection.setup().roots[screen].root)?;
        connection.set_selection_owner(window, owned, CURRENT_TIME)?;
        let mut settings = XSettings { connection, window, property };
        settings.set_dpi(96)?;
        Ok(settings)
    }

    fn set_dpi(&mut self, dpi: u32) -> Result<(), Box<dyn Error>> {
        let mut bytes = vec![0; 8];
        bytes.extend(1u32.to_le_bytes());
        // An integer, and its name of seven bytes.
        bytes.extend([0, 0, 7, 0]);
        bytes.extend(b"Xft/DPI\0\0\0\0\0");
        bytes.extend((dpi * 1024).to_le_bytes());
        let (to, property) = (self.window, self.property);
        self.connection
            .change_property8(PropMode::REPLACE, to, property, property, &bytes)?
            .check()?;
        Ok(())
    }
}
