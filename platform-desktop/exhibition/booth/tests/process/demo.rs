//! Tests of the demo booth, and of the systemd unit.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use paros_shell::require::require_or_skip;

use crate::rig::{BoothFolder, Headset};
use crate::smtp_sink::wait_until;
use crate::staff::Browser;

#[test]
fn a_demo_has_ten_sculptures_with_badges() {
    let folder = BoothFolder::new("demo");
    let mut booth = folder.start_with(&["--demo"]);
    let client = booth.client.clone();
    assert_eq!(client.metric("paros_booth_sculptures"), 10);
    wait_until(|| (client.metric("paros_booth_exports_queued") == 0).then_some(()));
    let browser = Browser::first(&client, &booth.first_code().expect("a code"));
    let page = browser.get("/staff");
    assert_eq!(page.text().matches("role=\"img\"").count(), 10, "{}", page.text());
    assert_eq!(folder.files("sculptures").iter().filter(|name| name.ends_with(".png")).count(), 10);
    // Each sculpture has a badge and a mesh.
    let badges = || {
        let database = rusqlite::Connection::open(folder.path().join("booth.sqlite")).unwrap();
        let mut rows =
            database.prepare("SELECT DISTINCT badge, id FROM sculptures WHERE export = 1").unwrap();
        let rows = rows.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
        rows.collect::<Result<Vec<(u32, [u8; 16])>, _>>().unwrap()
    };
    let first = badges();
    assert_eq!(first.len(), 10);
    // A restart in the same folder adds no sculptures. A folder with real headsets is refused.
    assert_eq!(booth.terminate(), Some(0));
    let booth = folder.start_with(&["--demo"]);
    assert_eq!(badges(), first);
    let other = BoothFolder::new("demo-real");
    let real = other.start();
    Headset::enrol(&real.client, other.fleet_token(), 1);
    drop((booth, real));
    let told = other.run(&["--demo", "--listen", "127.0.0.1:0"]).expect_err("it is used");
    assert!(told.contains("--demo: headsets were enrolled"), "{told}");
}

/// Without `--folder`, the demo uses a temporary folder, which is removed at its end.
#[test]
fn a_demo_leaves_nothing() {
    let home = BoothFolder::new("demo-alone").path();
    fs::create_dir_all(&home).unwrap();
    let mut booth = Command::new(env!("CARGO_BIN_EXE_paros-booth"))
        .args(["--demo", "--listen", "127.0.0.1:0"])
        .env("TMPDIR", &home)
        .current_dir(&home)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the program");
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(booth.stdout.take().unwrap()));
    for expected in ["https://127.0.0.1:", "certificate authority", "first account: https://"] {
        let line = lines.next().expect("a line").expect("text");
        assert!(line.starts_with(expected), "{line}");
    }
    assert_eq!(fs::read_dir(&home).unwrap().count(), 1);
    let told = Command::new("kill").args(["-TERM", &booth.id().to_string()]).status();
    assert!(told.expect("kill").success());
    assert_eq!(booth.wait().expect("it ends").code(), Some(0));
    assert_eq!(fs::read_dir(&home).unwrap().count(), 0);
}

#[test]
fn the_unit_is_one_that_systemd_takes() {
    let found = Command::new("systemd-analyze").arg("--version").output();
    let Some(_) = require_or_skip(found.map_err(|_| "no systemd-analyze")).expect("systemd") else {
        return;
    };
    let unit = include_str!("../../paros-booth.service");
    let started = "ExecStart=/usr/local/bin/paros-booth ";
    assert!(unit.contains(started));
    // The test uses the built program, as none is installed.
    let unit = unit.replace(started, &format!("ExecStart={} ", env!("CARGO_BIN_EXE_paros-booth")));
    let folder: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("unit");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("paros-booth.service");
    fs::write(&path, unit).unwrap();
    let checked = Command::new("systemd-analyze").args(["verify", "--man=no"]).arg(&path).output();
    let checked = checked.expect("it was found");
    let told = String::from_utf8_lossy(&checked.stderr);
    let is_ours = |line: &&str| line.contains("paros-booth");
    assert_eq!(told.lines().filter(is_ours).collect::<Vec<_>>(), [""; 0]);
    assert!(checked.status.success(), "{told}");
}
