//! Tests of backups while the booth serves, and of their restore.

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use paros_core::badge::BadgeNumber;
use paros_protocol::*;

use crate::rig::{
    BoothFolder, BoothProcess, Client, Headset, Parcel, figure, heartbeat, mail_arguments,
};
use crate::staff::Browser;

/// Backs a booth up. Returns the path of the backup.
fn back_up(folder: &BoothFolder) -> PathBuf {
    let file = folder.path().with_file_name("booth.backup");
    folder.run(&["backup", file.to_str().expect("text")]).expect("a backup");
    file
}

/// Restores a backup into a folder beside the first one.
fn restore(from: &BoothFolder, name: &str, with_log: bool) -> Result<BoothFolder, String> {
    let to = BoothFolder::new(name);
    let file = from.path().with_file_name("booth.backup");
    let log = from.path().join("deletions");
    let mut arguments = vec!["restore", file.to_str().expect("text")];
    if with_log {
        arguments.extend(["--deletions", log.to_str().expect("text")]);
    }
    to.run(&arguments).map(|_| to)
}

/// Shows the next badges that a headset has leased, and reports them.
fn show(client: &Client, headset: &Headset, badges: &mut BadgeReport, shown: &mut BTreeSet<u32>) {
    for _ in 0..9 {
        let Some(held) = badges.blocks.iter_mut().find(|held| !held.is_used_up()) else { break };
        let number = BadgeNumber::of_block(held.block, held.next).expect("a number");
        held.next += 1;
        assert!(shown.insert(number.get()), "{number:?} is shown again");
    }
    let beat = Heartbeat { badges: badges.clone(), ..heartbeat(headset.number) };
    let answer = client.ask("POST", "/v1/heartbeat", &[headset.bearer()], &beat.to_json());
    let answer = HeartbeatAnswer::from_json(&answer.expect("an answer").body).expect("a message");
    badges.blocks = answer.badges;
}

fn delete(booth: &BoothProcess, cookie: &str, parcel: &Parcel) {
    let browser = Browser { client: &booth.client, cookie: cookie.to_owned() };
    let at = format!("/staff/sculptures/{}", parcel.facts.id);
    assert_eq!(browser.click(&at, &format!("{at}/delete")).status, 303);
}

/// Backs a booth up while sculptures are added and deleted.
fn back_up_under_way(
    folder: &BoothFolder,
    booth: &BoothProcess,
    cookie: &str,
    headset: &Headset,
    parcels: &[Parcel],
) -> PathBuf {
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let is_over = &is_over;
        let sent = scope.spawn(move || {
            for parcel in parcels.iter().cycle().take_while(|_| !is_over.load(Ordering::Relaxed)) {
                let sent = headset.upload(&booth.client, parcel).unwrap().expect("kept");
                if sent == ParcelOutcome::Kept {
                    delete(booth, cookie, parcel);
                }
            }
        });
        let file = back_up(folder);
        is_over.store(true, Ordering::Relaxed);
        sent.join().expect("nothing fails");
        file
    })
}

#[test]
fn a_backup_while_it_serves_comes_back_without_what_was_deleted_since() {
    let folder = BoothFolder::new("backup");
    let mut booth = folder.start();
    let client = booth.client.clone();
    let cookie = Browser::first(&client, &booth.first_code().expect("a code")).cookie;
    let fleet = folder.fleet_token();
    let headsets: Vec<Headset> = (1..=2).map(|byte| Headset::enrol(&client, fleet, byte)).collect();
    let mut leases = vec![BadgeReport { epoch: 7, blocks: Vec::new() }; headsets.len()];
    let mut shown = BTreeSet::new();
    for (headset, lease) in headsets.iter().zip(&mut leases) {
        show(&client, headset, lease, &mut shown);
    }
    let headset = &headsets[0];
    let parcels: Vec<Parcel> = (1..=40).map(Parcel::with_trace).collect();
    let send = |parcel: &Parcel| headset.upload(&client, parcel).unwrap().expect("it is taken");
    parcels[..4].iter().for_each(|parcel| assert_eq!(send(parcel), ParcelOutcome::Kept));
    delete(&booth, &cookie, &parcels[0]);
    let file = back_up_under_way(&folder, &booth, &cookie, headset, &parcels[4..39]);
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);
    // After the backup: one more sculpture is kept, one is deleted, and badges are handed out.
    assert_eq!(send(&parcels[39]), ParcelOutcome::Kept);
    delete(&booth, &cookie, &parcels[1]);
    for (headset, lease) in headsets.iter().zip(&mut leases) {
        (0..3).for_each(|_| show(&client, headset, lease, &mut shown));
    }
    booth.terminate();

    let again = restore(&folder, "backup-again", true).expect("a booth");
    let booth = again.start();
    assert_eq!(booth.first_code(), None, "its accounts are there");
    let client = &booth.client;
    // The sculptures before the backup are known, and the deleted ones are reported as deleted.
    for (parcel, outcome) in parcels[..4].iter().zip([false, false, true, true]) {
        let sent = headset.upload(client, parcel).unwrap().expect("it is known");
        assert_eq!(sent == ParcelOutcome::Kept, outcome);
    }
    // A sculpture from after the backup is unknown. Its headset may send it again, with the same outcome.
    let sent = headset.upload(client, &parcels[39]).unwrap().expect("it is taken");
    assert_eq!(sent, ParcelOutcome::Kept);
    assert_eq!(client.metric("paros_booth_sculptures"), 3);
    let staff = Browser { client, cookie };
    assert!(staff.get("/staff").head.contains("location: /staff/login"), "logins are over");
    for (headset, lease) in headsets.iter().zip(&mut leases) {
        (0..3).for_each(|_| show(client, headset, lease, &mut shown));
        assert_eq!(lease.blocks.len(), 2, "it leases again");
    }
    let kept = again.files("sculptures");
    assert_eq!(kept.iter().filter(|name| name.ends_with(".sculpture")).count(), 3);
}

/// The header of a backup by a newer program.
const NEWER: &str = "backup of a Paros booth, version 2\nsomething = else\n";

/// Makes an archive of one file.
fn zip_of(name: &str, text: &str) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    zip.start_file(name, zip::write::SimpleFileOptions::default()).expect("a name");
    std::io::Write::write_all(&mut zip, text.as_bytes()).expect("room");
    zip.finish().expect("an archive").into_inner()
}

/// Two booths restored from one backup would hand out the same badges.
#[test]
fn a_backup_is_restored_once_a_day() {
    let folder = BoothFolder::new("backup-twice");
    let booth = folder.start();
    let file = back_up(&folder);
    restore(&folder, "backup-twice-1", false).expect("a booth");
    let told = restore(&folder, "backup-twice-2", false).err().expect("a second one");
    assert!(told.contains("booth.backup: it was restored today already"), "{told}");
    let second = folder.path().parent().unwrap().with_file_name("backup-twice-2");
    assert_eq!(fs::read_dir(second).unwrap().count(), 0);
    let third = BoothFolder::new("backup-twice-3");
    third.run(&["restore", file.to_str().unwrap(), "--again"]).expect("it was said");
    // A newer backup with the same name isn't affected.
    back_up(&folder);
    restore(&folder, "backup-twice-4", false).expect("a booth");
    // On another day the restore is allowed.
    let note = file.with_file_name("booth.backup.restored");
    let text = fs::read_to_string(&note).unwrap();
    let (copied, day) = text.trim_end().rsplit_once(' ').expect("a day");
    let yesterday = day.parse::<u32>().expect("a number") - 1;
    fs::write(&note, format!("{copied} {yesterday}\n")).unwrap();
    restore(&folder, "backup-twice-5", false).expect("a booth");
    drop(booth);
}

#[test]
fn what_is_no_backup_or_no_free_folder_is_refused_and_nothing_is_left() {
    let folder = BoothFolder::new("backup-damaged");
    let told = folder.run(&["backup", "/nowhere/x"]).expect_err("there is no booth");
    assert!(told.contains("there is no booth"), "{told}");
    let booth = folder.start();
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    headset.upload(&booth.client, &Parcel::volume(5)).unwrap().expect("it is taken");
    let file = back_up(&folder);
    let whole = fs::read(&file).unwrap();
    assert!(whole.len() > figure().rmap.len() / 10);
    let again = restore(&folder, "backup-taken", true).expect("a booth");
    let into_taken = again.run(&["restore", file.to_str().unwrap()]).expect_err("it is taken");
    assert!(into_taken.contains("is empty"), "{into_taken}");

    let sum = whole.len() / 2;
    for (name, bytes, why) in [
        ("cut", whole[..whole.len() - 30].to_vec(), "a backup that is cut short or damaged"),
        ("half", whole[..whole.len() / 2].to_vec(), "a backup that is cut short or damaged"),
        ("turned", [&whole[..sum], &[!whole[sum]], &whole[sum + 1..]].concat(), ""),
        ("none", b"PK".to_vec(), "no ZIP archive"),
        ("empty", Vec::new(), "no ZIP archive"),
        ("model", crate::rig::deflate(&whole), "no ZIP archive"),
        ("text", b"Dear diary,\n".repeat(99), "no ZIP archive"),
        ("other", zip_of("notes.txt", "Dear diary"), "a ZIP archive of something else"),
        ("newer", zip_of("backup.txt", NEWER), "a backup of version 2, of a newer program"),
        ("strange", zip_of("backup.txt", "Dear diary"), "its backup.txt is damaged"),
    ] {
        fs::write(&file, bytes).unwrap();
        let parent = format!("backup-{name}");
        let told = restore(&folder, &parent, true).err().expect("no backup");
        assert!(told.contains(&format!("booth.backup: {why}")), "{name}: {told}");
        assert!(
            !told.contains("nvalid Zip") || told.contains("expected a backup"),
            "{name}: {told}"
        );
        let left = again.path().parent().unwrap().with_file_name(&parent);
        assert_eq!(fs::read_dir(left).unwrap().count(), 0, "{name}");
    }
    fs::write(&file, &whole).unwrap();
    fs::write(folder.path().join("deletions"), "no deletion\n").unwrap();
    let told = restore(&folder, "backup-log", true).err().expect("no log");
    assert!(told.contains("deletions: line 1: expected a deletion"), "{told}");
}

/// An address is kept only until its mail is accepted. A backup, which may be stored anywhere for years,
/// contains no addresses.
#[test]
fn no_address_is_in_a_backup() {
    let folder = BoothFolder::new("backup-address");
    // The mail server doesn't exist, so the mail waits.
    let booth = folder.start_with(&mail_arguments("127.0.0.1:9"));
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(5);
    headset.upload(&booth.client, &parcel).unwrap().expect("it is taken");
    let browser = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    let at = format!("/staff/sculptures/{}", parcel.facts.id);
    let asked = browser.fill(&at, &format!("{at}/mail"), "&address=eleni%40example.org");
    assert_eq!(asked.status, 303, "{asked:?}");
    let file = back_up(&folder);
    let has = |path: PathBuf| fs::read(path).unwrap().windows(5).any(|bytes| bytes == b"eleni");
    let live = ["booth.sqlite", "booth.sqlite-wal"].map(|name| has(folder.path().join(name)));
    assert!(live.contains(&true), "the test looks where it is");
    let again = restore(&folder, "backup-address-again", false).expect("a booth");
    assert!(!has(again.path().join("booth.sqlite")));
    let mut zip = zip::ZipArchive::new(fs::File::open(&file).unwrap()).expect("an archive");
    let copy = folder.path().with_file_name("copy.sqlite");
    let mut entry = zip.by_name("booth.sqlite").expect("the database");
    std::io::copy(&mut entry, &mut fs::File::create(&copy).unwrap()).expect("whole");
    assert!(!has(copy), "it is in the backup");
    // The restored booth asks staff to order the waiting mail again.
    let booth = again.start();
    let log_in = crate::staff::post_form(
        &booth.client,
        "/staff/login",
        "",
        "name=ana&password=correct+horse+battery",
    );
    let browser = Browser { client: &booth.client, cookie: crate::staff::cookie_of(&log_in) };
    assert!(browser.get(&at).text().contains("mail failed (it may have been sent"));
}
