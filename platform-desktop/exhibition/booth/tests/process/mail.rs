//! Tests of mails, with an SMTP server.

use paros_protocol::*;

use crate::rig::{BoothFolder, BoothProcess, Client, Headset, Parcel, figure, mail_arguments};
use crate::smtp_sink::{Heard, SinkTls, SmtpSink, wait_until};
use crate::staff::{Browser, post_form};

/// Starts a booth that sends its mails to the sink.
fn start(folder: &BoothFolder, sink: &SmtpSink) -> BoothProcess {
    let server = sink.address.to_string();
    folder.start_with(&mail_arguments(&server))
}

/// Sends the sculpture of a Greek-speaking visitor, and waits for its picture. Returns the address of its
/// page.
fn with_sculpture(client: &Client, folder: &BoothFolder) -> String {
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(77);
    let facts = UploadFacts { language: *b"el", ..parcel.facts };
    let parcel = parcel.with_facts(facts);
    headset.upload(client, &parcel).unwrap().expect("it is taken");
    wait_until(|| (client.metric("paros_booth_exports_queued") == 0).then_some(()));
    format!("/staff/sculptures/{}", parcel.facts.id)
}

/// Fills the mail form in, with every character percent-encoded, and sends it.
fn ask(browser: &Browser<'_>, at: &str, address: &str) -> u16 {
    let page = browser.get(at);
    let token = page.text().split("name=\"form\" value=\"").nth(1).expect("a form");
    let address: String = address.bytes().map(|byte| format!("%{byte:02X}")).collect();
    let form = format!("form={}&address={address}", &token[..32]);
    post_form(browser.client, &format!("{at}/mail"), &browser.cookie, &form).status
}

/// Decodes the base64 attachment with a name.
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
    // The attachment has the same bytes as the download.
    let model = attachment(&mail.text, "sculpture.3mf");
    assert!(model == browser.get(&format!("{at}/model.3mf")).body);
    assert!(model.starts_with(b"PK\x03\x04") && model.len() < figure().stl.len() / 3);
    assert_eq!(&attachment(&mail.text, "sculpture.png")[..8], b"\x89PNG\r\n\x1a\n");
    // "Το γλυπτό" as a base64 encoded word.
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

/// A booth that uses TLS and a login for its mail server.
struct SecureMail {
    folder: BoothFolder,
    booth: BoothProcess,
    at: String,
}

impl SecureMail {
    /// Starts a booth that trusts an authority and logs in with a password.
    fn start(name: &str, sink: &SmtpSink, how: &str, (ca_pem, password): (&str, &str)) -> Self {
        let folder = BoothFolder::new(name);
        let write = |name: &str, text: &str| {
            let path = folder.path().with_file_name(name);
            std::fs::write(&path, text).expect("room on the disk");
            path.to_str().expect("a path").to_owned()
        };
        let (ca, password) = (write("mail-ca.pem", ca_pem), write("password", password));
        let booth = folder.start_with(&[
            "--smtp",
            &sink.address.to_string(),
            "--smtp-tls",
            how,
            "--smtp-ca",
            &ca,
            "--smtp-user",
            USER,
            "--smtp-password-file",
            &password,
            "--mail-from",
            "booth@example.org",
        ]);
        let at = with_sculpture(&booth.client, &folder);
        SecureMail { folder, booth, at }
    }

    /// Orders a mail, and waits until its page shows a state.
    fn ask_until(&self, says: &str) {
        let browser = Browser::first(&self.booth.client, &self.booth.first_code().expect("a code"));
        assert_eq!(ask(&browser, &self.at, "ana@example.org"), 303);
        wait_until(|| {
            let page = browser.get(&self.at).text().replace("&#39;", "'");
            page.contains(says).then_some(())
        });
        for secret in [PASSWORD, WRONG, USER, "ana@"] {
            assert!(!browser.get(&self.at).text().contains(secret), "the page says {secret}");
            assert!(!self.folder.log().contains(secret), "{}", self.folder.log());
        }
    }
}

const USER: &str = "booth-at-fair";
const PASSWORD: &str = "päss wörd\\9";
const WRONG: &str = "hunter2-but-not";

/// Returns `true` if only the greeting and STARTTLS were sent without TLS.
fn is_nothing(heard: &Heard) -> bool {
    heard
        .in_clear
        .iter()
        .all(|line| ["EHLO paros-booth.invalid", "STARTTLS", "QUIT"].contains(&line.as_str()))
}

#[test]
fn the_booth_logs_in_over_both_kinds_of_tls() {
    for (tls, how, way) in [
        (SinkTls::Starttls, "starttls", "PLAIN"),
        (SinkTls::Starttls, "starttls", "LOGIN"),
        (SinkTls::Implicit, "tls", "PLAIN"),
        (SinkTls::Implicit, "tls", "LOGIN"),
    ] {
        let sink = SmtpSink::start_with(tls, Some((USER, PASSWORD, way)));
        // Only the first line of the file is the password.
        let password = format!("{PASSWORD}\nmore\n");
        let name = format!("mail-login-{how}-{}", way.to_lowercase());
        let mail = SecureMail::start(&name, &sink, how, (&sink.ca_pem, &password));
        mail.ask_until("mail sent");
        let heard = sink.heard();
        assert_eq!(heard.logins, [format!("\0{USER}\0{PASSWORD}")], "{how} {way}");
        assert_eq!(heard.mails.len(), 1, "{how} {way}");
        assert!(heard.mails[0].to[0].contains("<ana@example.org>"), "{:?}", heard.mails[0].to);
        assert!(is_nothing(&heard), "in clear: {:?}", heard.in_clear);
        assert_eq!(heard.in_clear.is_empty(), tls == SinkTls::Implicit);
    }
}

/// A server in between presents another certificate, or offers no TLS and asks for the password.
#[test]
fn neither_password_nor_address_goes_to_a_server_that_is_not_the_right_one() {
    let login = Some((USER, PASSWORD, "PLAIN"));
    let another = SmtpSink::start_with(SinkTls::Implicit, None).ca_pem;
    let waits = |why: &str| format!("mail waiting (the mail server {why}), again at");
    for (name, tls, how, why) in [
        (
            "ca-starttls",
            SinkTls::Starttls,
            "starttls",
            "shows a certificate that isn't to be trusted",
        ),
        ("ca-tls", SinkTls::Implicit, "tls", "shows a certificate that isn't to be trusted"),
        ("no-starttls", SinkTls::None, "starttls", "offers no TLS"),
        ("no-tls", SinkTls::None, "tls", "can't be spoken with by TLS"),
    ] {
        let sink = SmtpSink::start_with(tls, login);
        let mail = SecureMail::start(&format!("mail-{name}"), &sink, how, (&another, PASSWORD));
        mail.ask_until(&waits(why));
        let heard = sink.heard();
        assert_eq!((heard.mails.len(), heard.logins.len()), (0, 0), "{name}");
        // With implicit TLS, the server without TLS reads the handshake as text.
        let all = heard.in_clear.concat();
        assert!(!all.contains("example.org") && !all.contains(USER), "{name}: {all}");
        assert!(how == "tls" || is_nothing(&heard), "{name}: {:?}", heard.in_clear);
    }
}

#[test]
fn a_login_that_is_refused_says_so_and_waits() {
    let sink = SmtpSink::start_with(SinkTls::Starttls, Some((USER, PASSWORD, "LOGIN")));
    let mail = SecureMail::start("mail-wrong", &sink, "starttls", (&sink.ca_pem, WRONG));
    mail.ask_until("mail waiting (the mail server refuses the booth's login, by 535), again at");
    let heard = sink.heard();
    assert_eq!((heard.mails.len(), heard.logins.len()), (0, 1));
    assert!(is_nothing(&heard), "in clear: {:?}", heard.in_clear);
    let sink = SmtpSink::start_with(SinkTls::Implicit, Some((USER, PASSWORD, "CRAM-MD5")));
    let mail = SecureMail::start("mail-no-way", &sink, "tls", (&sink.ca_pem, PASSWORD));
    mail.ask_until("mail waiting (the mail server offers no login by a password), again at");
    let heard = sink.heard();
    assert_eq!((heard.mails.len(), heard.logins.len()), (0, 0));
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
