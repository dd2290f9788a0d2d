//! The window on Wayland, in headless Weston.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use paros_shell::require::{MissingDependency, require_or_skip};

use super::rig::{DRIVER, LAYER, STROKE, ScriptedWindow, check_files, empty_folder, paros_command};
use super::visit::check_print;

/// A compositor, stopped when dropped.
struct Weston {
    server: Child,
    folder: PathBuf,
}

impl Weston {
    /// Starts Weston with a shell, the part that places windows.
    fn new(folder: &Path, shell: &str) -> Result<Self, String> {
        check_files(&[DRIVER, LAYER])?;
        let run = folder.join("run");
        // The socket of a compositor that was ended still exists.
        let _ = fs::remove_dir_all(&run);
        fs::create_dir_all(&run).map_err(|error| error.to_string())?;
        fs::set_permissions(&run, fs::Permissions::from_mode(0o700))
            .map_err(|error| error.to_string())?;
        let server = Command::new("weston")
            .args(["--backend=headless-backend.so", "--use-pixman", "--no-config", "--debug"])
            .args(["--idle-time=0", "--width=1180", "--height=800", "--socket=paros"])
            .arg(format!("--shell={shell}-shell.so"))
            .env("XDG_RUNTIME_DIR", &run)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .map_err(|error| format!("no weston: {error}"))?;
        let weston = Weston { server, folder: folder.to_owned() };
        let begun = Instant::now();
        while !run.join("paros").exists() {
            if begun.elapsed() > Duration::from_secs(20) {
                return Err("weston does not listen".into());
            }
            thread::sleep(Duration::from_millis(50));
        }
        Ok(weston)
    }

    fn open_window(&self) -> ScriptedWindow {
        let mut command = paros_command(&self.folder);
        ScriptedWindow::spawn(self.as_client(&mut command))
    }

    fn as_client<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command
            .env_remove("DISPLAY")
            .env("WAYLAND_DISPLAY", "paros")
            .env("XDG_RUNTIME_DIR", self.folder.join("run"))
    }

    /// Saves a screenshot in the folder.
    fn save_screenshot(&self) -> bool {
        let mut shooter = Command::new("weston-screenshooter");
        let shot = self.as_client(&mut shooter).current_dir(&self.folder).status();
        shot.is_ok_and(|status| status.success())
    }
}

impl Drop for Weston {
    fn drop(&mut self) {
        // The compositor may have ended by itself.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

#[test]
fn on_wayland_a_visitor_carves_and_finishes() -> Result<(), MissingDependency> {
    let folder = empty_folder("wayland");
    let Some(weston) = require_or_skip(Weston::new(&folder, "desktop"))? else { return Ok(()) };
    let mut visit = weston.open_window();
    visit.do_all(&["frames 4", "start free", "wait 4"]);
    assert_eq!(visit.ask_state("size"), "1180x800");
    let whole = visit.voxel_count();
    visit.do_all(&STROKE);
    assert!(visit.voxel_count() + 300 < whole);
    visit.do_step("frames 4");
    assert!(weston.save_screenshot(), "a picture of the screen");
    visit.do_all(&["key z", "wait 2"]);
    assert_eq!(visit.voxel_count(), whole);
    visit.do_all(&["key y", "key enter", "wait 4", "key enter", "wait 4", "settle"]);
    let print = PathBuf::from(visit.ask_state("printed"));
    check_print(&print)?;
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}

#[test]
fn unseen_on_wayland_it_goes_on_and_saves_when_the_compositor_ends() -> Result<(), MissingDependency>
{
    let folder = empty_folder("unseen");
    // The kiosk shell shows no window without a seat, so that no frame is ever requested.
    let Some(weston) = require_or_skip(Weston::new(&folder, "kiosk"))? else { return Ok(()) };
    let mut visit = weston.open_window();
    visit.do_all(&["wait 20", "start free", "wait 4"]);
    let whole = visit.voxel_count();
    visit.do_all(&STROKE);
    let frames = visit.ask_state("frames");
    visit.do_step("wait 200");
    assert_eq!(visit.ask_state("frames"), frames);
    let left = visit.voxel_count();
    assert!(left + 300 < whole);
    drop(weston);
    let (code, complaints) = visit.wait_for_exit();
    assert_eq!(code, Some(1), "{complaints}");
    assert!(complaints.contains("the display is gone; the session is saved"), "{complaints}");
    let Some(weston) = require_or_skip(Weston::new(&folder, "desktop"))? else { return Ok(()) };
    let mut visit = weston.open_window();
    visit.do_step("frames 4");
    assert_eq!(visit.voxel_count(), left);
    assert_eq!(visit.close(), (Some(0), String::new()));
    Ok(())
}
