//! A visitor of a window that is enrolled at a booth.

use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use paros_booth_process::{BoothProcess, find_booth};
use paros_protocol::{Parcel, UploadFacts};
use paros_shell::require::{MissingDependency, require_or_skip};

use super::exhibition::{SETTINGS, choose_the_owl, cut_and_see_badge};
use super::rig::{ScriptedWindow, XvfbDisplay, empty_folder, paros_command};

#[test]
fn a_visitor_s_sculpture_is_kept_here_and_at_the_booth() -> Result<(), MissingDependency> {
    let folder = empty_folder("booth");
    let Some(display) = require_or_skip(XvfbDisplay::new(&folder))? else { return Ok(()) };
    let Some(program) = find_booth() else { return Ok(()) };
    let booth = BoothProcess::start(&program, &folder, None);
    let fleet = folder.join("fleet.toml");
    fs::write(&fleet, booth.make_fleet_file()).expect("a file");
    let enrolled = paros_command(&folder).arg("enrol").arg("--fleet-file").arg(&fleet).output();
    let enrolled = enrolled.expect("it runs");
    assert!(enrolled.status.success(), "{}", String::from_utf8_lossy(&enrolled.stderr));
    let settings = folder.join("paros.toml");
    let long = "badge_most_seconds = 600\n";
    fs::write(&settings, format!("{SETTINGS}{long}")).expect("settings");
    let settings = settings.display().to_string();
    let mut command = paros_command(&folder);
    let command = command.env("DISPLAY", &display.name);
    let mut visit = ScriptedWindow::spawn_with(command, &["--settings", &settings]);
    visit.do_all(&["size 700 490", "wait 10"]);
    choose_the_owl(&mut visit, &display);
    cut_and_see_badge(&mut visit, &display);
    let kept = wait_for_sculpture(&folder.join("booth/sculptures"));
    let (facts, _) = UploadFacts::split_head(&kept).expect("a head");
    let volume = fs::read(folder.join("Paros/sculpture-001.rmap")).expect("the visitor's volume");
    let parcel = Parcel::pack(&facts, &volume, None).expect("a volume");
    assert!(parcel.file_bytes().starts_with(&kept), "the visitor's own volume");
    let words = fs::read_to_string(folder.join("Paros/sculpture-001.txt")).expect("the badge");
    let badge = facts.badge.expect("a badge");
    assert!(words.contains(&format!("badge {}\n", badge.get())), "{words}");
    assert!(!badge.is_provisional(), "the booth has leased it");
    // The booth's answer is shown at the next poll.
    thread::sleep(Duration::from_secs(1));
    visit.do_step("wait 4");
    visit.screenshot(&display, "11-kept-at-booth");
    let (code, complaints) = visit.close();
    assert_eq!((code, complaints.lines().count()), (Some(0), 1), "{complaints}");
    Ok(())
}

/// Waits for the file of a sculpture at the booth, with header and packed volume.
fn wait_for_sculpture(folder: &Path) -> Vec<u8> {
    let begun = Instant::now();
    loop {
        let names = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut paths = names.map(|entry| -> PathBuf { entry.path() });
        let kept = paths.find(|path| path.extension() == Some("sculpture".as_ref()));
        if let Some(path) = kept {
            return fs::read(path).expect("a file");
        }
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing comes to the booth");
        thread::sleep(Duration::from_millis(50));
    }
}
