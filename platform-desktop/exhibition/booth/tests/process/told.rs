//! Tests of the pages' messages: confirmations and reasons are on the right page and in its language.

use paros_core::badge::{BadgeNumber, Language};

use crate::prints::with_sculpture;
use crate::rig::{Answer, BoothFolder, BoothProcess, mail_arguments};
use crate::staff::{Browser, cookie_of, post_form};

/// Words in Latin letters that a Greek page may contain: names, formats, addresses.
const SHARED: [&str; 13] = [
    "", "Paros", "English", "ana", "example", "org", "e", "mail", "STL", "MF", "GLB", "mm", "https",
];

/// Starts a booth whose mail server doesn't exist, with a sculpture and a login.
fn start(name: &str) -> (BoothFolder, BoothProcess, String, String) {
    let folder = BoothFolder::new(name);
    let booth =
        folder.start_with(&[&mail_arguments("127.0.0.1:9")[..], &["--slicer", "none"]].concat());
    let at = with_sculpture(&booth.client, &folder, 77);
    let cookie = Browser::first(&booth.client, &booth.first_code().expect("a code")).cookie;
    (folder, booth, at, cookie)
}

fn in_greek(cookie: &str) -> String {
    format!("{cookie}; language=el")
}

/// Returns the text of a page and of its labels for screen readers, without the values of fields.
fn text_of(page: &str) -> String {
    let body = page.split_once("<main>").map_or(page, |(_, body)| body);
    let mut text = String::new();
    for piece in body.split('<') {
        let (tag, words) = piece.split_once('>').unwrap_or(("", piece));
        let label = tag.split("aria-label=\"").nth(1).and_then(|rest| rest.split('"').next());
        text += &format!(" {} {words}", label.unwrap_or_default());
    }
    text
}

fn english_words(page: &str) -> Vec<String> {
    let text = text_of(page);
    let words = text.split(|letter: char| !letter.is_ascii_alphabetic());
    words.filter(|word| !SHARED.contains(word)).map(str::to_owned).collect()
}

/// Checks that an error is a page with the menu and a link back, without an English word.
fn check_error(answer: &Answer, status: u16, back: &str) {
    let page = answer.text();
    assert_eq!(answer.status, status, "{page}");
    assert!(page.contains("<nav ") && page.contains("href=\"/staff/headsets\""), "{page}");
    assert!(page.contains("role=\"alert\""), "{page}");
    assert!(page.contains(&format!("class=\"button\" href=\"{back}\"")), "{back}: {page}");
    assert!(page.contains("<html lang=\"el\""), "{page}");
    assert_eq!(english_words(page), [""; 0], "{page}");
    assert!(answer.head.contains("content-security-policy: "), "{}", answer.head);
}

#[test]
fn errors_keep_the_menu_the_way_back_and_the_language() {
    let (_folder, booth, at, cookie) = start("told-errors");
    let browser = Browser { client: &booth.client, cookie: in_greek(&cookie) };
    let nowhere = format!("/staff/sculptures/{}", "0".repeat(32));
    for (path, status, back) in [
        ("/staff/nothing/here", 404, "/staff"),
        (&nowhere, 404, "/staff"),
        (&format!("{nowhere}/model.stl"), 404, &nowhere),
        ("/staff/prints/12345/slip", 404, "/staff/prints"),
        ("/staff/prints/none/slip", 400, "/staff/prints"),
        ("/staff/badges/99999999", 404, "/staff"),
    ] {
        check_error(&browser.get(path), status, back);
    }
    let page = browser.get(&at);
    let token =
        page.text().split("name=\"form\" value=\"").nth(1).expect("a form")[..32].to_owned();
    let send = |path: &str, form: &str| post_form(&booth.client, path, &browser.cookie, form);
    let with_token = format!("form={token}");
    for (path, form, status, back) in [
        (format!("{at}/withdraw"), "form=00", 403, at.as_str()),
        (format!("{at}/mail"), "form=00", 403, &at),
        (format!("{at}/nothing"), &with_token, 404, &at),
        (format!("{nowhere}/withdraw"), &with_token, 404, &nowhere),
        (format!("{nowhere}/mail"), &with_token, 404, &nowhere),
        ("/staff/headsets/9/0".into(), &with_token, 404, "/staff/headsets"),
        ("/staff/headsets/1/0".into(), &with_token, 409, "/staff/headsets"),
        ("/staff/headsets/1/9".into(), &with_token, 404, "/staff/headsets"),
        ("/staff/headsets/x/9".into(), &with_token, 400, "/staff/headsets"),
        ("/staff/prints/5/start".into(), &with_token, 404, "/staff/prints"),
        ("/staff/prints/5/send/0".into(), &with_token, 404, "/staff/prints"),
        ("/staff/admin/accounts/bob/disable".into(), &with_token, 404, "/staff/admin"),
        ("/staff/admin/accounts/ana/disable".into(), &with_token, 409, "/staff/admin"),
        ("/staff/admin/tokens/5/revoke".into(), &with_token, 404, "/staff/admin"),
    ] {
        check_error(&send(&path, form), status, back);
    }
    // A GET of a form's address redirects to the form's page.
    let to = browser.get(&format!("{at}/mail"));
    assert!(to.status == 303 && to.head.contains(&format!("location: {at}\r\n")), "{to:?}");
    // Errors without a login are pages too. Errors for headsets and monitoring are plain text.
    let greek = [("Accept-Language", "el".to_owned())];
    let answer = booth.client.ask("GET", "/nothing", &greek, &[]).expect("an answer");
    assert_eq!((answer.status, english_words(answer.text())), (404, Vec::new()));
    assert!(!booth.client.get("/v1/nothing").text().contains('<'));
}

/// A refused form, with its input.
struct Case<'a> {
    page: &'a str,
    action: String,
    fields: &'a str,
    status: u16,
    /// The input that the page shows again.
    typed: &'a [&'a str],
    why: [&'a str; 2],
}

/// Returns refused forms of a sculpture's page and of the admins' page.
fn refused_forms(at: &str) -> Vec<Case<'_>> {
    vec![
        Case {
            page: at,
            action: format!("{at}/mail"),
            fields: "&address=ana+at+home&keep=yes",
            status: 400,
            typed: &[
                "value=\"ana at home\"",
                "value=\"yes\" checked",
                "aria-describedby=\"reason\"",
            ],
            why: ["Expected an e-mail address", "μια διεύθυνση e-mail"],
        },
        Case {
            page: at,
            action: format!("{at}/print"),
            fields: "&height=5&filament=%3Cgold%3E&note=by+five",
            status: 400,
            typed: &[
                "value=\"5\"",
                "value=\"&lt;gold&gt;\"",
                "value=\"by five\"",
                "<details open>",
            ],
            why: ["Expected a height of 10 to 1000 mm", "ύψος από 10 ως 1000 mm"],
        },
        Case {
            page: "/staff/admin",
            action: "/staff/admin/accounts".into(),
            fields: "&name=b+b&password=battery+horse+correct&role=admin",
            status: 400,
            typed: &["value=\"b b\"", "value=\"admin\" selected", "aria-invalid=\"true\""],
            why: ["Expected a name of letters", "ένα όνομα με γράμματα"],
        },
        Case {
            page: "/staff/admin",
            action: "/staff/admin/accounts".into(),
            fields: "&name=ana&password=battery+horse+correct&role=attendant",
            status: 409,
            typed: &["value=\"ana\"", "<details open>"],
            why: ["The name is taken", "Το όνομα υπάρχει ήδη"],
        },
        Case {
            page: "/staff/admin",
            action: "/staff/admin/tokens".into(),
            fields: "&note=wall&uses=7&days=400&address=https://booth",
            status: 400,
            typed: &["value=\"wall\"", "value=\"7\"", "value=\"400\"", "value=\"https://booth\""],
            why: ["1 to 365 days", "από 1 ως 365 ημέρες"],
        },
        Case {
            page: "/staff/account",
            action: "/staff/account/password".into(),
            fields: "&old=wrong+horse&new=staple+horse+correct",
            status: 403,
            typed: &["name=\"old\" type=\"password\""],
            why: ["The password of now is another", "Ο τωρινός κωδικός είναι άλλος"],
        },
    ]
}

#[test]
fn a_refused_form_comes_back_with_what_was_typed_and_the_reason() {
    let (_folder, booth, at, cookie) = start("told-forms");
    let cases = refused_forms(&at);
    for (k, cookie) in [cookie.clone(), in_greek(&cookie)].into_iter().enumerate() {
        let browser = Browser { client: &booth.client, cookie };
        for Case { page, action, fields, status, typed, why } in &cases {
            let back = browser.fill(page, action, fields);
            assert_eq!(back.status, *status, "{action}: {}", back.text());
            for expected in typed.iter().chain([&"<nav ", &why[k], &"role=\"alert\""]) {
                assert!(back.text().contains(expected), "{action}: {expected}: {}", back.text());
            }
            assert!(!back.text().contains("horse"), "passwords aren't sent back");
            assert!(back.text().contains(&format!("action=\"{action}\"")), "it is its page");
        }
    }
    let log_in = |form: &str| {
        let back = post_form(&booth.client, "/staff/login", "language=el", form);
        (back.status, back.text().to_owned())
    };
    let (status, page) = log_in("name=eve&password=wrong+horse+battery");
    assert!(status == 403 && page.contains("value=\"eve\""), "{page}");
    assert!(page.contains("Λάθος όνομα ή κωδικός") && !page.contains("horse"), "{page}");
    let again = post_form(
        &booth.client,
        "/staff/first",
        "language=el",
        "code=0000&name=eve&password=correct+horse+battery",
    );
    assert_eq!(again.status, 403);
    assert!(again.text().contains("value=\"0000\"") && again.text().contains("value=\"eve\""));
}

#[test]
fn what_was_done_is_told_once_on_the_next_page() {
    let (_folder, booth, at, cookie) = start("told-done");
    let browser = Browser { client: &booth.client, cookie };
    for (page, action, fields, english, greek) in [
        (
            at.as_str(),
            format!("{at}/mail"),
            "&address=a%40b.org",
            "The mail waits",
            "Το μήνυμα περιμένει",
        ),
        (
            &at,
            format!("{at}/print"),
            "&height=60",
            "The print is ordered",
            "Η εκτύπωση παραγγέλθηκε",
        ),
        (&at, format!("{at}/withdraw"), "", "is withdrawn", "αποσύρθηκε"),
        (&at, format!("{at}/bring-back"), "", "is back", "επανήλθε"),
        (
            "/staff/admin",
            "/staff/admin/accounts".into(),
            "&name=bob&password=battery+horse+correct&role=attendant",
            "account is made",
            "λογαριασμός δημιουργήθηκε",
        ),
        (
            "/staff/admin",
            "/staff/admin/accounts/bob/disable".into(),
            "",
            "is shut out",
            "αποκλείστηκε",
        ),
        ("/staff/admin", "/staff/admin/accounts/bob/enable".into(), "", "let in again", "επανήλθε"),
        (&at, format!("{at}/delete"), "", "is deleted", "διαγράφηκε"),
    ] {
        let answer = browser.fill(page, &action, fields);
        assert_eq!(answer.status, 303, "{action}: {}", answer.text());
        let to = answer.head.split("location: ").nth(1).and_then(|rest| rest.lines().next());
        let to = to.expect("it leads on").to_owned();
        assert!(!to.contains('?'), "nothing is in the address: {to}");
        let done = cookie_of(&answer);
        assert!(done.starts_with("done=") && answer.head.contains("max-age=60"), "{done}");
        for (language, text) in [("en", english), ("el", greek)] {
            let cookie = format!("{}; {done}; language={language}", browser.cookie);
            let next = Browser { client: &booth.client, cookie }.get(&to);
            let told = next.text().split("role=\"status\"").nth(1).expect("it is told");
            let told = &told[..told.find("</p>").expect("a paragraph")];
            assert!(told.contains(text), "{action}: {told}");
            assert!(next.head.contains("set-cookie: done=;") && next.head.contains("max-age=0"));
        }
        assert!(!browser.get(&to).text().contains("role=\"status\""), "{action}: told once");
    }
    let forged = format!("{}; done=%3Cb%3Eyou+won", browser.cookie);
    let page = Browser { client: &booth.client, cookie: forged }.get("/staff");
    assert!(!page.text().contains("you won") && !page.text().contains("role=\"status\""));
}

#[test]
fn a_withdrawn_sculpture_says_until_when_it_comes_back() {
    let (folder, booth, at, cookie) = start("told-withdrawn");
    let browser = Browser { client: &booth.client, cookie };
    assert!(!browser.get(&at).text().contains("brought back until"));
    browser.click(&at, &format!("{at}/withdraw"));
    let database = rusqlite::Connection::open(folder.path().join("booth.sqlite")).unwrap();
    let week = 7 * 86_400;
    let query =
        "SELECT strftime('%Y-%m-%d %H:%M', withdrawn_at / 1000 + ?, 'unixepoch') FROM sculptures";
    let until: String = database.query_row(query, [week], |row| row.get(0)).unwrap();
    let page = browser.get(&at);
    assert!(
        page.text().contains(&format!("brought back until {until}.")),
        "{until}: {}",
        page.text()
    );
}

/// A booth in Kathmandu, 5:45 ahead of UTC, shows times, filters hours and names files in its local time.
#[test]
fn times_are_those_of_the_booths_zone() {
    let zone = ("TZ".to_owned(), "Asia/Kathmandu".to_owned());
    let folder = BoothFolder::new("told-zone").sharing(&[], vec![zone]);
    let booth = folder.start_with(&["--slicer", "none"]);
    let at = with_sculpture(&booth.client, &folder, 77);
    let browser = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    let database = rusqlite::Connection::open(folder.path().join("booth.sqlite")).unwrap();
    // 20:30 UTC on 31 March.
    let received = "UPDATE sculptures SET received_at = 1774989000000";
    assert_eq!(database.execute(received, []).unwrap(), 1);
    assert!(browser.get(&at).text().contains("2026-04-01 02:15"), "{}", browser.get(&at).text());
    for (day, hour, is_there) in [
        ("2026-04-01", "2", true),
        ("2026-04-01", "", true),
        ("2026-04-01", "3", false),
        ("2026-03-31", "", false),
        ("2026-03-31", "20", false),
    ] {
        let list = browser.get(&format!("/staff?day={day}&hour={hour}"));
        assert_eq!(list.text().contains(&at), is_there, "{day} {hour}");
    }
    let file = browser.get(&format!("{at}/model.stl")).head;
    let name = file.split("filename=\"paros-").nth(1).expect("a name").split('"').next().unwrap();
    let pictures = BadgeNumber::new(77).expect("a number").badge().pictograms;
    assert!(name.starts_with(pictures[0].name(Language::English)), "{name}");
    assert!(name.ends_with("-2026-04-01.stl"), "{name}");
}
