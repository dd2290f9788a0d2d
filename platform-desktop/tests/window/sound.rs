//! A visitor's actions make sound: a mock of ALSA's library reports the first continuous sound.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread;
use std::time::{Duration, Instant};

use paros_shell::require::{MissingDependency, require_or_skip};

use super::rig::{STROKE, ScriptedWindow, XvfbDisplay, empty_folder, paros_command};

/// Compiles the mock that the window loads as `libasound.so.2`, into a folder.
fn build_library(folder: &Path) {
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/sound/tests/devices/mock_alsa.c");
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-DTELLS", "-o"]).arg(folder.join("libasound.so.2")).arg(source);
    assert!(cc.status().expect("a C compiler").success(), "cc makes the library");
}

#[test]
fn a_stroke_is_heard_unless_sound_is_off() -> Result<(), MissingDependency> {
    for (name, percent) in [("sound", 70), ("sound-off", 0)] {
        let folder = empty_folder(name);
        let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
        build_library(&folder);
        let (settings, heard) = (folder.join("paros.toml"), folder.join("heard"));
        fs::write(&settings, format!("sound_percent = {percent}\n")).expect("it is written");
        let mut paros = paros_command(&folder);
        paros.env("DISPLAY", &display.name).env("LD_LIBRARY_PATH", &folder);
        paros.env("PAROS_MOCK_HEARD", &heard);
        let settings = settings.to_str().expect("UTF-8");
        let mut visit = ScriptedWindow::spawn_with(&mut paros, &["--settings", settings]);
        visit.do_all(&["start free", "wait 72"]);
        assert!(!heard.exists(), "nothing was done");
        visit.do_all(&STROKE);
        let begun = Instant::now();
        while percent > 0 && !heard.exists() && begun.elapsed() < Duration::from_secs(10) {
            thread::sleep(Duration::from_millis(10));
        }
        assert_eq!(heard.exists(), percent > 0, "at {percent}");
        if percent > 0 {
            thread::sleep(Duration::from_millis(100));
            assert_eq!(fs::read_to_string(&heard).expect("what was heard"), "0 wrong\n");
        }
        let (code, said) = visit.close();
        assert_eq!(code, Some(0), "{said}");
        assert!(!said.contains("no sound"), "{said}");
    }
    Ok(())
}
