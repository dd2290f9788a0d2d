//! Tests of the staff's pages in a real browser, with mouse and keyboard, on phone and tablet sizes. axe-core
//! must find no accessibility violations.

use paros_core::badge::{Badge, BadgeNumber, Language, write_words};

use crate::chromium::Chromium;
use crate::rig::{BoothFolder, BoothProcess, mail_arguments};
use crate::smtp_sink::{SmtpSink, wait_until};

const PHONE: (u32, u32) = (390, 844);
const TABLET: (u32, u32) = (820, 1180);

/// axe-core, the accessibility checker.
const AXE: &str = include_str!("../data/axe-core/axe.min.js");

/// Returns the accessibility violations in the current page.
fn find_violations(browser: &mut Chromium) -> serde_json::Value {
    browser.ask(AXE);
    browser.ask(
        "axe.run().then((found) => found.violations.map((wrong) => wrong.id + ': ' + wrong.help
         + ' ' + wrong.nodes.map((node) => node.html + ' ' + node.failureSummary).join(' | ')))",
    )
}

/// Checks the current page, and takes a screenshot.
pub(crate) fn look_at(browser: &mut Chromium, name: &str) {
    assert_eq!(find_violations(browser), serde_json::json!([]), "{name}");
    // No horizontal scrolling.
    let width = "document.documentElement.scrollWidth - document.documentElement.clientWidth";
    assert_eq!(browser.ask(width), 0, "{name} is too wide");
    browser.draw(name);
}

/// Returns the badge of a sculpture of the demo.
fn a_badge(folder: &BoothFolder) -> (BadgeNumber, Badge) {
    let database = rusqlite::Connection::open(folder.path().join("booth.sqlite")).unwrap();
    let query = "SELECT badge FROM sculptures ORDER BY received_at LIMIT 1";
    let number: u32 = database.query_row(query, [], |row| row.get(0)).unwrap();
    let number = BadgeNumber::new(number).expect("a number");
    (number, number.badge())
}

fn start(folder: &BoothFolder, sink: &SmtpSink) -> BoothProcess {
    let server = sink.address.to_string();
    let booth = folder.start_with(&[&["--demo"], &mail_arguments(&server)[..]].concat());
    wait_until(|| (booth.client.metric("paros_booth_exports_queued") == 0).then_some(()));
    booth
}

/// Creates the first account, which logs it in.
pub(crate) fn add_first_account(browser: &mut Chromium, booth: &BoothProcess) {
    browser.open(&format!("https://{}", booth.client.address));
    look_at(browser, "first");
    browser.fill("input[name=code]", &booth.first_code().expect("a code"));
    browser.fill("input[name=name]", "ana");
    browser.fill("input[name=password]", "correct horse battery");
    browser.follow("main button");
}

#[test]
fn staff_log_in_find_by_badge_mail_withdraw_and_undo_in_a_browser() {
    let Some(mut browser) = Chromium::start("staff") else { return };
    let (folder, sink) = (BoothFolder::new("page"), SmtpSink::start());
    let booth = start(&folder, &sink);
    let at = format!("https://{}", booth.client.address);
    browser.resize(PHONE, true);
    add_first_account(&mut browser, &booth);
    browser.follow("header form button");
    look_at(&mut browser, "login");
    browser.fill("input[name=name]", "ana");
    browser.fill("input[name=password]", "correct horse battery");
    browser.enter();
    assert!(browser.has(".thumbs a"));

    // Search by tapping: a colour and four pictures.
    let (_, badge) = a_badge(&folder);
    browser.follow("a[href='/staff/find']");
    browser.click(&format!("[data-colour='{}']", badge.colour as u8));
    for pictogram in &badge.pictograms[..3] {
        browser.click(&format!("[data-picture='{}']", pictogram.number()));
    }
    look_at(&mut browser, "find-phone");
    browser.follow(&format!("[data-picture='{}']", badge.pictograms[3].number()));
    look_at(&mut browser, "found-phone");
    browser.follow(".cards .card a");
    look_at_the_sculpture_on_a_desktop(&mut browser);
    let mut words = String::new();
    write_words(&mut words, &badge, Language::English).expect("text");
    assert_eq!(browser.ask("document.querySelector('h1').textContent"), words);
    look_at(&mut browser, "sculpture-phone");

    browser.fill("input[name=address]", "eleni@example.org");
    browser.follow("form[action$='/mail'] button");
    // The confirmation is shown and announced once, and not again after a reload.
    let told = "document.getElementById('done')?.textContent.startsWith('The mail waits')";
    browser.wait_for(told);
    look_at(&mut browser, "done-phone");
    let at_sculpture = browser.ask("location.href").as_str().expect("an address").to_owned();
    assert!(!at_sculpture.contains('?'), "{at_sculpture}");
    browser.open(&at_sculpture);
    assert!(!browser.has("#done"), "it was told");
    assert!(sink.wait_for(1)[0].to[0].contains("eleni@example.org"));
    // The page updates itself.
    browser.wait_for("document.body.innerText.includes('mail sent')");

    browser.follow("form[action$='/withdraw'] button");
    assert!(browser.text().contains("It can be brought back until"));
    look_at(&mut browser, "sculpture-withdrawn-phone");
    browser.open(&format!("{at}/staff"));
    let thumbnail = format!(".thumbs [aria-label='{words}']");
    assert!(!browser.has(&thumbnail), "it is hidden");
    browser.open(&format!("{at}/staff?state=withdrawn"));
    look_at(&mut browser, "withdrawn-phone");
    browser.follow(".thumbs a");
    browser.follow("form[action$='/bring-back'] button");
    browser.open(&format!("{at}/staff"));
    assert!(browser.has(&thumbnail), "it is back");

    // Search by words, with the keyboard only.
    browser.open(&format!("{at}/staff/find"));
    browser.fill("input[name=words]", &words);
    browser.enter();
    assert!(browser.has(".cards .card a"));
    browser.follow("header form button");
    assert!(browser.has("form[action='/staff/login']"));
}

/// Checks that the picture and the 3D view are side by side, and visible without scrolling.
fn look_at_the_sculpture_on_a_desktop(browser: &mut Chromium) {
    browser.resize((1280, 800), false);
    browser.click(".viewer button");
    browser.wait_for("document.querySelector('.viewer canvas').dataset.ready === 'yes'");
    let place =
        "(() => { const at = (what) => document.querySelector(what).getBoundingClientRect();
         const [picture, view] = [at('.sculpture img'), at('.viewer canvas')];
         return picture.right < view.left && view.bottom < innerHeight && view.top >= 0; })()";
    assert_eq!(browser.ask(place), true);
    browser.draw("sculpture-desktop");
    browser.resize(PHONE, true);
}

/// Checks refused forms, missing pages, and badges that are remembered in part.
fn look_at_what_goes_wrong(browser: &mut Chromium, at: &str, sculpture: &str, name: &str) {
    for (form, field, typed) in [("mail", "address", "ana at home"), ("print", "height", "5")] {
        browser.open(&format!("{at}{sculpture}"));
        // Disables the browser's own validation.
        browser.ask(&format!(
            "(() => {{ const form = document.querySelector(\"form[action$='/{form}']\");
             form.noValidate = true; if (form.closest('details')) form.closest('details').open = true;
             form.elements['{field}'].value = '{typed}'; }})()"
        ));
        browser.follow(&format!("form[action$='/{form}'] button"));
        assert!(browser.has("nav") && browser.has("[aria-invalid]"), "{}", browser.text());
        let kept = format!("document.querySelector(\"[name='{field}']\").getAttribute('value')");
        assert_eq!(browser.ask(&kept), typed);
        let at_field = "document.activeElement.matches('[aria-invalid]')
            && document.activeElement.getBoundingClientRect().bottom < innerHeight";
        assert_eq!(browser.ask(at_field), true, "one is where one was");
        look_at(browser, &format!("refused-{form}-{name}"));
    }
    browser.open(&format!("{at}/staff/nothing"));
    look_at(browser, &format!("error-{name}"));
    let is_greek = browser.ask("document.documentElement.lang") == "el";
    browser.open(&format!("{at}{sculpture}"));
    let heading = browser.ask("document.querySelector('h1').textContent");
    let heading = heading.as_str().expect("words").replace([':', ','], "");
    let known: Vec<&str> = heading.split(' ').skip(2).collect();
    let unknown = if is_greek { "δράκος" } else { "dragon" };
    browser.open(&format!("{at}/staff/find"));
    browser.fill("input[name=words]", &format!("{} {unknown}", known.join(" ")));
    browser.enter();
    assert!(browser.has(&format!(".cards a[href='{sculpture}']")), "{}", browser.text());
    look_at(browser, &format!("nearest-{name}"));
}

#[test]
fn every_page_is_for_everybody_on_a_phone_and_a_tablet() {
    let Some(mut browser) = Chromium::start("pages") else { return };
    let (folder, sink) = (BoothFolder::new("pages"), SmtpSink::start());
    let booth = start(&folder, &sink);
    let at = format!("https://{}", booth.client.address);
    let (number, _) = a_badge(&folder);
    browser.resize(TABLET, false);
    add_first_account(&mut browser, &booth);
    folder.fleet_token();
    // Checks that axe-core finds a real violation.
    browser.ask("document.querySelector('main').append(document.createElement('img'))");
    let found = find_violations(&mut browser).to_string();
    assert!(found.contains("image-alt"), "{found}");
    let sculpture = browser.ask("document.querySelector('.thumbs a').getAttribute('href')");
    let sculpture = sculpture.as_str().expect("an address").to_owned();
    let known = format!("/staff/badges/{}", number.get());
    for (language, heading) in [("en", "Sculptures"), ("el", "Γλυπτά")] {
        browser.open(&format!("{at}/staff/language/{language}"));
        assert_eq!(browser.ask("document.querySelector('h1').textContent"), heading);
        for (name, path) in [
            ("list", "/staff"),
            ("find", "/staff/find"),
            ("sculpture", &sculpture),
            ("missing", "/staff?state=missing"),
            ("headsets", "/staff/headsets"),
            ("account", "/staff/account"),
            ("admin", "/staff/admin"),
            ("audit", "/staff/audit"),
            ("badge", &known),
            ("privacy", "/privacy"),
        ] {
            for (size, place, is_phone) in [("tablet", TABLET, false), ("phone", PHONE, true)] {
                browser.resize(place, is_phone);
                browser.open(&format!("{at}{path}"));
                browser
                    .ask("document.querySelectorAll('details').forEach((all) => all.open = true)");
                look_at(&mut browser, &format!("{name}-{size}-{language}"));
            }
        }
        for (size, place, is_phone) in [("tablet", TABLET, false), ("phone", PHONE, true)] {
            browser.resize(place, is_phone);
            look_at_what_goes_wrong(&mut browser, &at, &sculpture, &format!("{size}-{language}"));
        }
    }
}
