//! Tests of the data about a visitor: display, export and deletion.

use std::io::{Cursor, Read as _};

use zip::ZipArchive;

use crate::rig::{BoothFolder, Headset, Parcel, figure, mail_arguments};
use crate::smtp_sink::{SmtpSink, wait_until};
use crate::staff::Browser;

#[test]
fn all_that_is_known_of_a_badge_is_shown_exported_and_deleted() {
    let (folder, sink) = (BoothFolder::new("privacy"), SmtpSink::start());
    let server = sink.address.to_string();
    let booth = folder.start_with(&mail_arguments(&server));
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::with_trace(77);
    headset.upload(client, &parcel).unwrap().expect("it is taken");
    wait_until(|| (client.metric("paros_booth_exports_queued") == 0).then_some(()));
    let ana = Browser::first(client, &booth.first_code().expect("a code"));
    let (id, at) = (parcel.facts.id, format!("/staff/sculptures/{}", parcel.facts.id));
    let agreed = "&keep=yes&address=eleni%40example.org";
    assert_eq!(ana.fill(&at, &format!("{at}/mail"), agreed).status, 303);
    let mail = sink.wait_for(1).remove(0);
    assert!(mail.text.contains("As you agreed"), "{}", &mail.text[..900]);
    wait_until(|| ana.get(&at).text().contains("mail sent").then_some(()));
    assert!(ana.get(&at).text().contains("href=\"/staff/badges/77\""));

    let page = ana.get("/staff/badges/77");
    for told in ["eleni@example.org", "With the motion of the hands", "mail", &id.to_string()] {
        assert!(page.text().contains(told), "{told}: {}", page.text());
    }
    let export = ana.get("/staff/badges/77/export.zip");
    assert!(export.head.contains("attachment; filename=\"paros-badge-77.zip\""));
    let mut zip = ZipArchive::new(Cursor::new(export.body)).expect("an archive");
    let mut file = |name: &str| {
        let mut bytes = Vec::new();
        zip.by_name(name).expect(name).read_to_end(&mut bytes).expect("whole");
        bytes
    };
    assert!(file(&format!("{id}.stl")) == figure().stl);
    assert_eq!(&file(&format!("{id}.png"))[..4], b"\x89PNG");
    let trace = include_bytes!("../../../../../core/examples/replay/groove.trace");
    assert!(file(&format!("{id}.trace")) == trace);
    let known: serde_json::Value = serde_json::from_slice(&file("known.json")).expect("JSON");
    assert_eq!(known["number"], 77);
    assert_eq!(known["sculptures"][0]["mails"][0]["address"], "eleni@example.org");
    assert_eq!(known["sculptures"][0]["visit"]["language"], "en");

    assert_eq!(ana.click("/staff/badges/77", "/staff/badges/77/delete").status, 303);
    let page = ana.get("/staff/badges/77");
    assert!(page.text().contains("Deleted on") && !page.text().contains("eleni"));
    assert_eq!(folder.files("sculptures"), [""; 0]);
    assert_eq!(ana.get(&at).status, 404);
    assert!(!folder.log().contains("eleni"), "{}", folder.log());
    let log = std::fs::read_to_string(folder.path().join("deletions")).expect("a log");
    assert!(log.starts_with(&format!("{id} 1 ")) && log.lines().count() == 1, "{log}");
    assert_eq!(ana.get("/staff/badges/99999999").status, 404);
    drop(booth);
    check_database_forgot(&folder);
}

/// Checks that deleted data isn't in the database's free pages either, after a checkpoint of its log.
fn check_database_forgot(folder: &BoothFolder) {
    let database = rusqlite::Connection::open(folder.path().join("booth.sqlite")).unwrap();
    let written = database.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |row| row.get(0));
    assert_eq!(written, Ok(0));
    let bytes = std::fs::read(folder.path().join("booth.sqlite")).unwrap();
    assert!(!bytes.windows(5).any(|bytes| bytes == b"eleni"), "the address is there still");
}

#[test]
fn everybody_reads_what_is_kept_and_for_how_long() {
    let folder = BoothFolder::new("privacy-page");
    let booth = folder.start_with(&["--keep-days", "33"]);
    let page = booth.client.get("/privacy");
    assert_eq!(page.status, 200);
    for told in ["33 days", "14 days", "7 days", "180 days"] {
        assert!(page.text().contains(told), "{told}");
    }
    let greek = [("Accept-Language", "el".to_owned())];
    let page = booth.client.ask("GET", "/privacy", &greek, &[]).unwrap();
    assert!(page.text().contains("33 ημέρες") && page.text().contains("<html lang=\"el\""));
}
