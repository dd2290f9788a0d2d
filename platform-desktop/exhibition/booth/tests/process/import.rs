//! Tests of the import of parcels from a headset's disk: by the command, and by the admins' page.

use std::fs;
use std::path::Path;

use crate::rig::{BoothFolder, Headset, Parcel};
use crate::staff::{Browser, cookie_of, post_form};

/// Writes a parcel's file into a copied outbox.
fn write(outbox: &Path, parcel: &Parcel, end: &str, file: &[u8]) {
    fs::write(outbox.join(format!("{}.{end}", parcel.facts.id)), file).expect("room on the disk");
}

/// Lists the names and bytes of all files in a folder.
fn list(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file"));
    let read = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().expect("text");
        (name, fs::read(entry.path()).unwrap_or_default())
    };
    let mut files: Vec<_> = entries.map(read).collect();
    files.sort();
    files
}

/// Makes another parcel with the same id.
fn other_parcel_of(parcel: &Parcel) -> Parcel {
    let mut facts = parcel.facts;
    facts.finished_at += 1;
    parcel.with_facts(facts)
}

#[test]
fn a_command_takes_a_copied_outbox_and_names_what_it_cannot_take() {
    let folder = BoothFolder::new("import-command");
    let booth = folder.start();
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    let outbox = folder.path().with_file_name("outbox");
    let import = |outbox: &Path, number: u32, more: &[&str]| {
        let (outbox, number) = (outbox.display().to_string(), number.to_string());
        let arguments = [&["import-spool", &outbox, "--headset", &number], more].concat();
        let done = folder.command(&arguments).output().expect("the program");
        let text = |bytes| String::from_utf8(bytes).expect("text");
        (done.status.code(), text(done.stdout), text(done.stderr))
    };
    let (code, _, why) = import(&outbox, headset.number, &[]);
    assert!(code == Some(2) && why.contains("outbox: No such file"), "{code:?}: {why}");
    fs::create_dir(&outbox).expect("a folder");
    fs::write(outbox.join("badges.lease"), "no parcel").expect("room");
    let (code, _, why) = import(&outbox, headset.number, &[]);
    assert!(code == Some(2) && why.contains("ID.parcel"), "{code:?}: {why}");

    let [first, second, third] = [1, 2, 3].map(Parcel::volume);
    write(&outbox, &first, "parcel", &first.file());
    write(&outbox, &second, "sent", &second.file());
    let (code, _, why) = import(&outbox, headset.number + 1, &[]);
    assert!(code == Some(2) && why.contains("--headset 2: no headset"), "{code:?}: {why}");
    let summary = |taken: u8, known: u8, refused: u8| {
        format!("{taken} taken, {known} there already, 0 deleted before, {refused} not taken\n")
    };
    let done = |text: String| (Some(0), text, String::new());
    assert_eq!(import(&outbox, headset.number, &[]), done(summary(2, 0, 0)));
    assert_eq!(import(&outbox, headset.number, &[]), done(summary(0, 2, 0)));
    let kept = folder.path().join("sculptures");
    assert!(first.is_kept_in(&kept) && second.is_kept_in(&kept));
    // The headset is repaired and sends its parcels again: the booth acknowledges them.
    assert!(headset.upload(&booth.client, &first).expect("an answer").is_ok());

    // A third parcel is taken. The others are refused: another parcel of the first sculpture, a truncated
    // file, a parcel under another id, and a folder.
    write(&outbox, &first, "parcel", &other_parcel_of(&first).file());
    write(&outbox, &second, "sent", &second.file()[..900]);
    write(&outbox, &third, "refused", &third.file());
    write(&outbox, &Parcel::volume(4), "parcel", &Parcel::volume(5).file());
    fs::create_dir(outbox.join(format!("{}.parcel", Parcel::volume(6).facts.id))).expect("room");
    let before = list(&outbox);
    let (code, told, why) = import(&outbox, headset.number, &[]);
    assert!(code == Some(2) && why.ends_with("outbox: 4 files were not taken\n"), "{why}");
    assert!(told.ends_with(&summary(1, 0, 4)), "{told}");
    for (parcel, cause) in [
        (&first, "parcel: not taken: another parcel of this sculpture was taken before"),
        (&second, "sent: not taken: byte 868: expected the SHA-256 of the bytes before"),
        (&Parcel::volume(4), "parcel: not taken: no sculpture: its head is of another sculpture"),
        (&Parcel::volume(6), "parcel: not taken: "),
    ] {
        assert!(told.contains(&format!("{}.{cause}", parcel.facts.id)), "{cause}: {told}");
    }
    assert!(third.is_kept_in(&kept) && first.is_kept_in(&kept));
    let (code, told, _) = import(&outbox, headset.number, &["--json"]);
    let told: serde_json::Value = serde_json::from_str(&told).expect("JSON");
    assert_eq!((code, told["known"].as_array().map(Vec::len)), (Some(2), Some(1)));
    assert_eq!(told["refused"][0]["file"], format!("{}.parcel", first.facts.id));
    assert_eq!(list(&outbox), before, "nothing in the folder is changed");
}

#[test]
fn an_admin_brings_files_on_a_page_and_an_attendant_does_not() {
    let folder = BoothFolder::new("import-page");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let ana = Browser::first(client, &booth.first_code().expect("a code"));
    let bob = "&name=bob&password=battery+horse+correct&role=attendant";
    assert_eq!(ana.fill("/staff/admin", "/staff/admin/accounts", bob).status, 303);
    let bob = post_form(client, "/staff/login", "", "name=bob&password=battery+horse+correct");
    let bob = Browser { client, cookie: cookie_of(&bob) };
    assert!(ana.get("/staff/admin").text().contains("/staff/import"));
    let token_of = |browser: &Browser<'_>, page: &str| {
        let page = browser.get(page);
        let token = page.text().split("name=\"form\" value=\"").nth(1).expect("a form");
        token[..32].to_owned()
    };
    let token = token_of(&ana, "/staff/import");
    let put = |browser: &Browser<'_>, token: &str, name: &str, file: &[u8]| {
        let path = format!("/staff/import/{}/{name}", headset.number);
        let headers = [("Cookie", browser.cookie.clone()), ("Form", token.to_owned())];
        client.ask("PUT", &path, &headers, file).expect("an answer")
    };
    let parcel = Parcel::volume(1);
    let name = format!("{}.parcel", parcel.facts.id);
    let told = |file: &[u8]| {
        let answer = put(&ana, &token, &name, file);
        (answer.status, answer.text().to_owned())
    };
    // Refused: not an admin, not logged in, a form token of another login.
    assert_eq!(bob.get("/staff/import").status, 403);
    let of_bob = token_of(&bob, "/staff/account");
    assert_eq!(put(&bob, &of_bob, &name, &parcel.file()).status, 403);
    assert_eq!(put(&ana, &of_bob, &name, &parcel.file()).status, 403);
    assert_eq!(client.ask("PUT", "/staff/import/1/x", &[], b"").expect("an answer").status, 303);
    assert!(folder.files("sculptures").is_empty());

    assert_eq!(told(&parcel.file()), (200, "Taken.".into()));
    assert_eq!(told(&parcel.file()), (200, "The booth has it already.".into()));
    assert!(parcel.is_kept_in(&folder.path().join("sculptures")));
    assert!(ana.get("/staff/audit").text().contains("import"));
    let (status, page) = told(&other_parcel_of(&parcel).file());
    assert!(status == 409 && page.contains("Another parcel of this sculpture"), "{page}");
    let (status, page) = told(&parcel.file()[..900]);
    assert!(status == 400 && page.contains("class=\"note\""), "{page}");
    assert_eq!(put(&ana, &token, "badges.lease", b"{}").status, 400);
    // Too large: refused before the body is read.
    let path = format!("/staff/import/{}/{name}", headset.number);
    let length = ("Content-Length", ((32u64 << 20) + 33).to_string());
    let headers = [("Cookie", ana.cookie.clone()), ("Form", token.clone()), length];
    assert_eq!(client.ask("PUT", &path, &headers, b"").expect("an answer").status, 413);
    let large = Parcel::large(2);
    assert!(large.file().len() > 3 << 20, "other forms take less");
    let answer = put(&ana, &token, &format!("{}.sent", large.facts.id), &large.file());
    assert_eq!((answer.status, answer.text()), (200, "Taken."));
    let elsewhere = "/staff/import/9/".to_owned() + &name;
    let headers = [("Cookie", ana.cookie.clone()), ("Form", token)];
    let answer = client.ask("PUT", &elsewhere, &headers, &parcel.file()).expect("an answer");
    assert_eq!(answer.status, 404, "no headset has this number");
}
