//! Tests of the staff's pages, by the HTML and the headers of responses.

use std::io::Read as _;

use paros_core::badge::{BadgeNumber, Language, write_words};
use paros_protocol::*;

use crate::rig::{
    Answer, BoothFolder, Client, Headset, Parcel, figure, heartbeat, read_body, read_head,
    write_request,
};
use crate::smtp_sink::wait_until;

/// A client that is logged in.
pub(crate) struct Browser<'a> {
    pub(crate) client: &'a Client,
    pub(crate) cookie: String,
}

impl<'a> Browser<'a> {
    /// Creates the first account, which logs it in.
    pub(crate) fn first(client: &'a Client, code: &str) -> Self {
        let form = format!("code={code}&name=ana&password=correct+horse+battery");
        let answer = post_form(client, "/staff/first", "", &form);
        assert_eq!(answer.status, 303, "{answer:?}");
        Browser { client, cookie: cookie_of(&answer) }
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        self.client.ask("GET", path, &[("Cookie", self.cookie.clone())], &[]).expect("an answer")
    }

    /// Sends the form of a page that posts to `action`, as a click on its button does.
    pub(crate) fn click(&self, page: &str, action: &str) -> Answer {
        self.fill(page, action, "")
    }

    /// Fills a form in, and sends it. `fields` follow its token.
    pub(crate) fn fill(&self, page: &str, action: &str, fields: &str) -> Answer {
        let page = self.get(page);
        let form =
            page.text().split("<form").find(|form| form.contains(&format!("action=\"{action}\"")));
        let token = form.expect("a form").split("name=\"form\" value=\"").nth(1).expect("a token");
        post_form(self.client, action, &self.cookie, &format!("form={}{fields}", &token[..32]))
    }
}

pub(crate) fn post_form(client: &Client, path: &str, cookie: &str, form: &str) -> Answer {
    let kind = ("Content-Type", "application/x-www-form-urlencoded".to_owned());
    let headers = [kind, ("Cookie", cookie.to_owned())];
    client.ask("POST", path, &headers, form.as_bytes()).expect("an answer")
}

pub(crate) fn cookie_of(answer: &Answer) -> String {
    let cookie = answer.head.lines().find_map(|line| line.strip_prefix("set-cookie: "));
    let cookie = cookie.expect("a cookie");
    for word in ["path=/", "secure", "httponly", "samesite=strict"] {
        assert!(cookie.contains(word), "{cookie}");
    }
    // Restores the cookie's name, as heads are read in lower case.
    cookie.split(';').next().expect("a pair").replace("__host-paros", "__Host-paros")
}

#[test]
fn staff_make_the_first_account_and_log_in_and_out() {
    let folder = BoothFolder::new("accounts");
    let mut booth = folder.start();
    let code = booth.first_code().expect("there is no account");
    let client = &booth.client;
    assert!(client.get("/").head.contains("location: /staff\r\n"));
    assert!(client.get("/staff").head.contains("location: /staff/first\r\n"));
    let form = "code=0000-0000-0000&name=eve&password=correct+horse+battery";
    assert_eq!(post_form(client, "/staff/first", "", form).status, 403);
    let short = format!("code={code}&name=ana&password=short");
    assert_eq!(post_form(client, "/staff/first", "", &short).status, 400);
    let browser = Browser::first(client, &code);
    let page = browser.get("/staff");
    assert_eq!(page.status, 200);
    for header in [
        "content-security-policy: default-src 'none';",
        "x-content-type-options: nosniff",
        "referrer-policy: same-origin",
        "cache-control: no-store",
    ] {
        assert!(page.head.contains(header), "{header}: {}", page.head);
    }
    assert!(!page.text().contains("http:") && !page.text().contains("https:"), "a foreign host");
    let again = format!("code={code}&name=eve&password=correct+horse+battery");
    assert_eq!(post_form(client, "/staff/first", "", &again).status, 403, "the code is used up");
    assert_eq!(post_form(client, "/staff/logout", &browser.cookie, "").status, 303);
    assert!(browser.get("/staff").head.contains("location: /staff/login\r\n"));

    let log_in = |name: &str, password: &str| {
        post_form(client, "/staff/login", "", &format!("name={name}&password={password}"))
    };
    assert_eq!(log_in("ana", "wrong+horse+battery").status, 403);
    assert_eq!(log_in("nobody", "correct+horse+battery").status, 403);
    let answer = log_in("ana", "correct+horse+battery");
    assert_eq!(answer.status, 303);
    // Logins survive a restart of the booth.
    let cookie = cookie_of(&answer);
    assert_eq!(booth.terminate(), Some(0));
    let booth = folder.start();
    assert_eq!(booth.first_code(), None);
    let browser = Browser { client: &booth.client, cookie };
    assert_eq!(browser.get("/staff").status, 200);
}

#[test]
fn forms_of_other_sites_are_refused() {
    let folder = BoothFolder::new("staff-origin");
    let booth = folder.start();
    let client = &booth.client;
    let browser = Browser::first(client, &booth.first_code().expect("a code"));
    let send = |path: &str, form: &str, headers: &[(&str, &str)]| {
        let kind = ("Content-Type", "application/x-www-form-urlencoded".to_owned());
        let more = headers.iter().map(|&(name, value)| (name, value.to_owned()));
        let headers: Vec<_> =
            [kind, ("Cookie", browser.cookie.clone())].into_iter().chain(more).collect();
        client.ask("POST", path, &headers, form.as_bytes()).expect("an answer")
    };
    let login = "name=ana&password=correct+horse+battery";
    for foreign in [
        &[("Origin", "https://evil.example")][..],
        &[("Origin", "http://booth")],
        &[("Origin", "https://booth:8443")],
        &[("Origin", "https://booth.evil.example")],
        &[("Origin", "null")],
        &[("Sec-Fetch-Site", "cross-site")],
        &[("Sec-Fetch-Site", "same-site")],
        &[("Origin", "https://booth"), ("Sec-Fetch-Site", "cross-site")],
        &[("Origin", "https://booth"), ("Origin", "https://evil.example")],
    ] {
        let refused = send("/staff/login", login, foreign);
        assert_eq!(refused.status, 403, "{foreign:?}");
        assert!(refused.text().contains("another site"), "{foreign:?}: {}", refused.text());
        assert_eq!(send("/staff/logout", "", foreign).status, 403, "{foreign:?}");
        assert_eq!(browser.get("/staff").status, 200, "{foreign:?}: still logged in");
    }
    // The rig sends "booth" as the host.
    for own in [
        &[][..],
        &[("Origin", "https://booth")],
        &[("Origin", "https://Booth"), ("Sec-Fetch-Site", "same-origin")],
        &[("Sec-Fetch-Site", "none")],
    ] {
        assert_eq!(send("/staff/login", login, own).status, 303, "{own:?}");
    }
    let followed = [("Cookie", browser.cookie.clone()), ("Sec-Fetch-Site", "cross-site".into())];
    let page = client.ask("GET", "/staff", &followed, &[]).expect("an answer");
    assert_eq!(page.status, 200, "a link of another site's page leads here");
    let gone = send("/staff/logout", "", &[("Origin", "https://booth")]);
    assert_eq!(gone.status, 303);
}

#[test]
fn staff_find_download_withdraw_and_delete_a_sculpture() {
    let folder = BoothFolder::new("staff-sculptures");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(77);
    headset.upload(client, &parcel).unwrap().expect("it is taken");
    let at = format!("/staff/sculptures/{}", parcel.facts.id);
    for path in [at.clone(), format!("{at}/model.stl"), format!("{at}/picture.png")] {
        let answer = client.get(&path);
        assert_eq!((answer.status, answer.body.len()), (303, 0), "{path}");
    }
    let browser = Browser::first(client, &booth.first_code().expect("a code"));
    let badge = BadgeNumber::new(77).expect("a number").badge();
    let mut words = String::new();
    write_words(&mut words, &badge, Language::English).expect("text");
    assert!(browser.get("/staff").text().contains(&words));
    let asked = words.replace([':', ','], "").replace(' ', "+");
    let found = browser.get(&format!("/staff/find?words={asked}"));
    assert!(found.text().contains(&format!("href=\"{at}\"")), "{}", found.text());
    let pictures = badge.pictograms.map(|shown| shown.number().to_string()).join("-");
    let tapped =
        browser.get(&format!("/staff/find?colour={}&pictures={pictures}", badge.colour as u8));
    assert!(tapped.text().contains(&format!("href=\"{at}\"")));
    let hostile = browser.get("/staff/find?words=%3Cscript%3Ealert(1)%3C/script%3E");
    assert!(hostile.text().contains("&lt;script&gt;") && !hostile.text().contains("<script>alert"));

    let stl = browser.get(&format!("{at}/model.stl"));
    assert!(stl.head.contains("content-disposition: attachment"));
    assert!(stl.body == figure().stl, "the mesh that the headset exported");
    // Until the picture is drawn, a placeholder is sent.
    wait_until(|| {
        let picture = browser.get(&format!("{at}/picture.png"));
        assert_eq!(picture.status, 200);
        picture.body.starts_with(b"\x89PNG\r\n\x1a\n").then_some(())
    });

    // The event stream ends with its login. If it didn't, it would take minutes to reach this many bytes.
    let mut stream = client.connect().expect("a connection").take(2 << 10);
    let cookie = ("Cookie", browser.cookie.clone());
    write_request(stream.get_mut(), "GET", "/staff/changes", &[cookie], &[]).expect("a request");
    let head = read_head(&mut stream).expect("a head");
    withdraw_and_delete(&browser, &at, &words);
    assert_eq!(post_form(client, "/staff/logout", &browser.cookie, "").status, 303);
    let stream = read_body(head, &mut stream).expect("a stream that ends");
    assert!(stream.head.contains("text/event-stream"), "{}", stream.head);
    assert!(stream.text().contains("event: ended\ndata:\n\n"), "{}", stream.text());
    assert_eq!(folder.files("sculptures"), [""; 0]);
    let late = headset.upload(client, &parcel).unwrap().expect("it is taken");
    assert_eq!(late, ParcelOutcome::Deleted);
}

fn withdraw_and_delete(browser: &Browser<'_>, at: &str, words: &str) {
    // A form token that is invalid is refused.
    let forged = post_form(browser.client, &format!("{at}/withdraw"), &browser.cookie, "form=00");
    assert_eq!(forged.status, 403);
    assert_eq!(browser.click(at, &format!("{at}/withdraw")).status, 303);
    assert!(!browser.get("/staff").text().contains(words));
    assert!(browser.get("/staff?state=withdrawn").text().contains(words));
    assert_eq!(browser.click(at, &format!("{at}/bring-back")).status, 303);
    assert!(browser.get("/staff").text().contains(words));
    assert_eq!(browser.click(at, &format!("{at}/delete")).status, 303);
    assert_eq!(browser.get(at).status, 404);
}

#[test]
fn staff_command_headsets_and_let_them_in() {
    let folder = BoothFolder::new("staff-headsets");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let browser = Browser::first(client, &booth.first_code().expect("a code"));
    let beat = |last_command| {
        let status = HeadsetStatus { session_id: 5, ..HeadsetStatus::default() };
        let beat = Heartbeat { last_command, status, ..heartbeat(headset.number) };
        let answer = client.ask("POST", "/v1/heartbeat", &[headset.bearer()], &beat.to_json());
        HeartbeatAnswer::from_json(&answer.expect("an answer").body).expect("a message").command
    };
    assert_eq!(beat(None), None);
    let number = headset.number;
    let action = format!("/staff/headsets/{number}/{}", CommandKind::Extend as u8);
    assert_eq!(browser.click("/staff/headsets", &action).status, 303);
    let command = beat(None).expect("it was asked");
    assert_eq!((command.kind, command.session_id), (CommandKind::Extend, 5));
    assert!(browser.get("/staff/headsets").text().contains("A minute more: sent"));
    beat(Some(CommandReport { id: command.id, outcome: CommandOutcome::Done }));
    assert!(browser.get("/staff/headsets").text().contains("A minute more: done"));
    let greek = [("Cookie", browser.cookie.clone()), ("Accept-Language", "el-GR".to_owned())];
    let page = client.ask("GET", "/staff/headsets", &greek, &[]).unwrap();
    assert!(
        page.text().contains("Ένα λεπτό ακόμη: έγινε") && page.text().contains("<html lang=\"el\"")
    );
}
