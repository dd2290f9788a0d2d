//! Sculptures go to a mail server that speaks SMTP.

use paros_core::outbox::messages::*;

use crate::rig::{BoothFolder, Client, Headset, Parcel, figure};
use crate::smtp_sink::{SmtpSink, wait_until};
use crate::staff::{Browser, post_form};

/// Starts a booth that sends its mails there.
fn start(folder: &BoothFolder, sink: &SmtpSink) -> crate::rig::BoothProcess {
    let server = sink.address.to_string();
    folder.start_with(&[
        "--smtp",
        &server,
        "--smtp-tls",
        "none",
        "--mail-from",
        "booth@example.org",
    ])
}

/// Sends a Greek's sculpture, and waits for its picture. Returns where its page is.
fn with_sculpture(client: &Client, folder: &BoothFolder) -> String {
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::new(headset.number, 77, ParcelKind::Volume);
    let facts = UploadFacts { language: *b"el", ..parcel.facts };
    let parcel = Parcel::of_packed(facts, &parcel.bytes[UploadFacts::BYTES..], &[]);
    headset.upload(client, &parcel).unwrap().expect("a receipt");
    wait_until(|| (client.metric("paros_booth_exports_queued") == 0).then_some(()));
    format!("/staff/sculptures/{}", parcel.facts.id)
}

/// Fills the form in, as letters that HTML's forms turn into percent signs.
fn ask(browser: &Browser<'_>, at: &str, address: &str) -> u16 {
    let page = browser.get(at);
    let token = page.text().split("name=\"form\" value=\"").nth(1).expect("a form");
    let address: String = address.bytes().map(|byte| format!("%{byte:02X}")).collect();
    let form = format!("form={}&address={address}", &token[..32]);
    post_form(browser.client, &format!("{at}/mail"), &browser.cookie, &form).status
}

/// The file of a name in a mail, out of base64.
fn attachment(text: &str, name: &str) -> Vec<u8> {
    let part = text.split(&format!("filename=\"{name}\"")).nth(1).expect("the file");
    let letters = part.split("\n\n").nth(1).expect("a body").split("\n--").next().expect("lines");
    let (mut bytes, mut bits, mut count) = (Vec::new(), 0u32, 0);
    for letter in letters.bytes().filter(|letter| !b"=\n".contains(letter)) {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            _ => 63,
        };
        (bits, count) = ((bits << 6 | u32::from(value)) & 0xffff, count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    bytes
}

#[test]
fn a_mail_goes_out_with_picture_and_model_and_its_address_is_forgotten() {
    let (folder, sink) = (BoothFolder::new("mail"), SmtpSink::start());
    let booth = start(&folder, &sink);
    let client = &booth.client;
    let at = with_sculpture(client, &folder);
    let browser = Browser::first(client, &booth.first_code().expect("a code"));
    assert_eq!(ask(&browser, &at, "o'brien&co@example.org"), 303);
    let mail = sink.wait_for(1).remove(0);
    assert!(mail.from.contains("<booth@example.org>"), "{}", mail.from);
    assert_eq!(mail.to.len(), 1);
    assert!(mail.to[0].contains("<o'brien&co@example.org>"), "{:?}", mail.to);
    // Its bytes are those that the page gives.
    let model = attachment(&mail.text, "sculpture.3mf");
    assert!(model == browser.get(&format!("{at}/model.3mf")).body);
    assert!(model.starts_with(b"PK\x03\x04") && model.len() < figure().stl.len() / 3);
    assert_eq!(&attachment(&mail.text, "sculpture.png")[..8], b"\x89PNG\r\n\x1a\n");
    // "Το γλυπτό", in base64 as heads have it.
    assert!(mail.text.contains("Subject: =?utf-8?b?zqTOvyDOs867z4XPgM"), "{}", &mail.text[..600]);
    wait_until(|| browser.get(&at).text().contains("mail sent").then_some(()));
    assert!(!browser.get(&at).text().contains("brien"));
    assert!(!folder.log().contains("brien"), "{}", folder.log());
    let database = rusqlite::Connection::open(folder.path().join("booth.sqlite")).unwrap();
    let count = "SELECT count(*) FROM mail_orders WHERE address IS NOT NULL";
    assert_eq!(database.query_row(count, [], |row| row.get(0)), Ok(0));
    assert_eq!(sink.mails().len(), 1, "it went once");
}

#[test]
fn a_mail_that_is_refused_says_why_and_one_that_is_put_off_waits() {
    let (folder, sink) = (BoothFolder::new("mail-refused"), SmtpSink::start());
    let booth = start(&folder, &sink);
    let client = &booth.client;
    let at = with_sculpture(client, &folder);
    let browser = Browser::first(client, &booth.first_code().expect("a code"));
    assert_eq!(ask(&browser, &at, "nobody@example.org"), 303);
    let says = |text: &str| {
        wait_until(|| browser.get(&at).text().contains(text).then_some(()));
    };
    says("mail failed (the mail server said 550)");
    assert_eq!(ask(&browser, &at, "later@example.org"), 303);
    says("mail waiting (the mail server said 451), again at");
    assert_eq!((sink.refused().len(), sink.mails().len()), (2, 0));
    assert!(!browser.get(&at).text().contains("example.org"), "pages show no address");
    assert!(!folder.log().contains("example.org"), "{}", folder.log());
}

/// A server that takes no TLS, as one that somebody put in between, hears no address.
#[test]
fn nothing_is_said_without_tls_where_that_was_asked() {
    let (folder, sink) = (BoothFolder::new("mail-starttls"), SmtpSink::start());
    let server = sink.address.to_string();
    let booth = folder.start_with(&["--smtp", &server, "--mail-from", "booth@example.org"]);
    let client = &booth.client;
    let at = with_sculpture(client, &folder);
    let browser = Browser::first(client, &booth.first_code().expect("a code"));
    assert_eq!(ask(&browser, &at, "nobody@example.org"), 303);
    let waits = "mail waiting (the mail server can&#39;t be reached, or TLS failed)";
    let waits = [waits, &waits.replace("&#39;", "'")];
    wait_until(|| {
        let page = browser.get(&at);
        waits.iter().any(|waits| page.text().contains(waits)).then_some(())
    });
    assert_eq!((sink.refused().len(), sink.mails().len()), (0, 0));
}

#[test]
fn what_is_no_address_goes_nowhere() {
    let (folder, sink) = (BoothFolder::new("mail-hostile"), SmtpSink::start());
    let booth = start(&folder, &sink);
    let client = &booth.client;
    let at = with_sculpture(client, &folder);
    let browser = Browser::first(client, &booth.first_code().expect("a code"));
    for address in [
        "ana@example.org\r\nBcc: eve@example.org",
        "ana@example.org>\r\nRCPT TO:<eve@example.org",
        "ana@example.org, eve@example.org",
        "<script>alert(1)</script>@example.org",
        "'); DROP TABLE mail_orders; --",
        "",
    ] {
        assert_eq!(ask(&browser, &at, address), 400, "{address}");
    }
    let page = browser.get(&at);
    let forged = post_form(client, &format!("{at}/mail"), &browser.cookie, "form=00&address=a@b.c");
    assert_eq!((forged.status, page.status), (403, 200));
    assert!(!page.text().contains("<li>"), "no order was made");
    assert_eq!((sink.refused().len(), sink.mails().len()), (0, 0));
}

#[test]
fn a_server_that_the_booth_must_not_trust_is_refused_at_the_start() {
    let folder = BoothFolder::new("mail-plain");
    for arguments in [
        ["--smtp", "mail.example.org:25", "--smtp-tls", "none", "--mail-from", "booth@example.org"],
        ["--smtp", "mail.example.org", "--smtp-tls", "tls", "--mail-from", "booth@example.org"],
        ["--smtp", "127.0.0.1:25", "--smtp-tls", "none", "--mail-from", "nobody"],
    ] {
        let told = folder.run(&arguments).expect_err("it doesn't start");
        assert!(told.contains("--smtp") || told.contains("--mail-from"), "{told}");
    }
}
