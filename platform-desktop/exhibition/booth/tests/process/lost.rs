//! Tests of a wrong clock, and of the rescue of a booth whose database is lost.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use paros_shell::require::require_or_skip;

use crate::rig::{BoothFolder, Headset, Parcel};
use crate::staff::Browser;

/// Reads all files below a folder, by path.
fn read_tree(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("a file").path();
        if path.is_dir() {
            files.extend(read_tree(&path));
        } else {
            files.insert(path.display().to_string(), fs::read(&path).expect("a file"));
        }
    }
    files
}

#[test]
fn a_clock_three_years_ahead_deletes_nothing_and_asks() {
    // Only the library of `faketime` is used, as the program itself would outlive a booth that is killed.
    let library =
        Command::new("faketime").args(["-f", "+1095d", "printenv", "LD_PRELOAD"]).output();
    let Some(library) = require_or_skip(library.map_err(|_| "no faketime")).expect("faketime")
    else {
        return;
    };
    let library = String::from_utf8(library.stdout).expect("text");
    let folder = BoothFolder::new("clock-ahead");
    let parcel = Parcel::with_trace(1);
    let mut booth = folder.start();
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    assert!(headset.upload(&booth.client, &parcel).expect("an answer").is_ok());
    let ana = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    assert!(!ana.get("/staff").text().contains("/staff/admin/clock"));
    let cookie = ana.cookie;
    booth.terminate();
    let files = folder.files("sculptures").len();

    // Clients reject the certificate, as it isn't valid yet. The sweep runs at once.
    let log = fs::File::create(folder.path().with_file_name("ahead.log")).expect("room");
    let mut ahead = folder.command(&["--listen", "127.0.0.1:0"]);
    let ahead = ahead.env("LD_PRELOAD", library.trim()).env("FAKETIME", "+1095d");
    let mut ahead = ahead
        .env("FAKETIME_DONT_FAKE_MONOTONIC", "1")
        .stdout(Stdio::null())
        .stderr(log)
        .spawn()
        .expect("it starts");
    let told = || fs::read_to_string(folder.path().with_file_name("ahead.log")).expect("a log");
    let start = Instant::now();
    while !told().contains("the clock jumped") {
        assert!(start.elapsed() < Duration::from_secs(60), "{}", told());
        sleep(Duration::from_millis(50));
    }
    let _ = ahead.kill();
    let _ = ahead.wait();
    assert_eq!(folder.files("sculptures").len(), files);
    let booth = folder.start();
    let ana = Browser { client: &booth.client, cookie };
    let page = ana.get(&format!("/staff/sculptures/{}", parcel.facts.id));
    assert!(page.status == 200 && page.text().contains("/withdraw"), "{page:?}");
}

#[test]
fn an_admin_answers_for_a_clock_that_jumped() {
    let folder = BoothFolder::new("clock-question");
    let mut booth = folder.start();
    let cookie = Browser::first(&booth.client, &booth.first_code().expect("a code")).cookie;
    booth.terminate();
    // Simulates a booth that was off for 20 days.
    let database = rusqlite::Connection::open(folder.path().join("booth.sqlite")).unwrap();
    let moved = "UPDATE seen_time SET seen_at = seen_at - 20 * 86400000";
    assert_eq!(database.execute(moved, []).unwrap(), 1);
    let booth = folder.start();
    let ana = Browser { client: &booth.client, cookie };
    let page = ana.get("/staff");
    assert!(page.text().contains("The clock of this machine jumped"), "{page:?}");
    assert!(ana.get("/staff/admin").text().contains("/staff/admin/clock"));
    assert_eq!(ana.click("/staff", "/staff/admin/clock").status, 303);
    assert!(!ana.get("/staff").text().contains("/staff/admin/clock"));
    assert!(ana.get("/staff/audit").text().contains("confirm clock"));
}

#[test]
fn a_booth_is_made_of_the_files_of_one_that_lost_its_database() {
    let folder = BoothFolder::new("rescue-lost");
    let parcels =
        [Parcel::volume(1), Parcel::with_trace(2), Parcel::with_trace(3), Parcel::volume(4)];
    let booth = folder.start();
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    for parcel in &parcels {
        assert!(headset.upload(&booth.client, parcel).expect("an answer").is_ok());
    }
    drop(booth);
    let lost = folder.path();
    let kept = |k: usize, end| {
        lost.join(format!("sculptures/{}-{}.{end}", parcels[k].facts.id, parcels[k].hash))
    };
    for name in ["booth.sqlite", "booth.sqlite-wal", "booth.sqlite-shm"] {
        let _ = fs::remove_file(lost.join(name));
    }
    // One trace has expired, and one file is damaged.
    fs::remove_file(kept(2, "trace")).unwrap();
    fs::write(kept(3, "sculpture"), &fs::read(kept(3, "sculpture")).unwrap()[..99]).unwrap();
    let refusal = folder.run(&["--listen", "127.0.0.1:0"]).expect_err("its records are gone");
    assert!(refusal.contains("paros-booth rescue"), "{refusal}");

    let before = read_tree(&lost);
    let new = BoothFolder::new("rescue-new");
    let told = new.run(&["rescue", lost.to_str().unwrap()]).expect("a booth");
    assert!(told.contains(": 3 sculptures\n"), "{told}");
    let damaged = format!("{}-{}.sculpture: left out: ", parcels[3].facts.id, parcels[3].hash);
    assert!(told.contains(&damaged), "{told}");
    assert_eq!(read_tree(&lost), before, "nothing in the folder is changed");
    let again = new.run(&["rescue", lost.to_str().unwrap()]).expect_err("the folder isn't free");
    assert!(again.contains("expected a folder that isn't there yet"), "{again}");
    let booth = new.start();
    let ana = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    let page = ana.get("/staff");
    for parcel in &parcels[..3] {
        assert!(page.text().contains(&parcel.facts.id.to_string()), "{page:?}");
    }
    // If a headset sends a rescued sculpture again, the booth acknowledges it.
    let headset = Headset::enrol(&booth.client, new.fleet_token(), 1);
    assert!(headset.upload(&booth.client, &parcels[1]).expect("an answer").is_ok());

    let empty = BoothFolder::new("rescue-empty");
    fs::create_dir_all(empty.path().join("sculptures")).unwrap();
    let to = BoothFolder::new("rescue-of-nothing");
    let error = to.run(&["rescue", empty.path().to_str().unwrap()]).expect_err("nothing there");
    assert!(error.contains("no sculpture can be read") && !to.path().exists(), "{error}");
}
