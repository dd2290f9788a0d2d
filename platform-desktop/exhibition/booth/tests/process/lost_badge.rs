//! Staff find the sculpture of a lost badge among 400 by one picture and the hour, in a real browser.

use paros_booth_rules::BoothTime;
use paros_booth_rules::records::Sculpture;
use paros_core::badge::{BadgeNumber, Language};
use paros_protocol::SculptureId;

use crate::chromium::Chromium;
use crate::many::{add_sculptures, now, sculpture, write_day};
use crate::page::{add_first_account, look_at};
use crate::rig::BoothFolder;
use crate::smtp_sink::wait_until;

/// The sculptures of a day: from eight o'clock, 50 an hour.
const COUNT: u32 = 400;

const SIZES: [(&str, (u32, u32)); 3] =
    [("upright", (820, 1180)), ("desktop", (1280, 800)), ("phone", (390, 844))];

/// Sets a field of the filter.
fn choose(browser: &mut Chromium, field: &str, value: &str) {
    let set = format!("document.querySelector(\"[name='{field}']\").value = '{value}'");
    assert_eq!(browser.ask(&set), value, "{field}");
}

#[test]
fn a_lost_badge_is_found_by_a_picture_and_the_hour() {
    let Some(mut browser) = Chromium::start("lost-badge") else { return };
    let folder = BoothFolder::new("lost-badge");
    let booth = folder.start_with(&["--demo"]);
    wait_until(|| (booth.client.metric("paros_booth_exports_queued") == 0).then_some(()));
    let yesterday = now().day() - 1;
    let morning = BoothTime::of_day(yesterday).0 + 8 * 3_600_000;
    let day: Vec<Sculpture> =
        (0..COUNT).map(|k| sculpture(k, BoothTime(morning + u64::from(k) * 72_000))).collect();
    add_sculptures(&folder, &day);
    let lost = &day[273];
    let badge = BadgeNumber::new(lost.badge.expect("it has one")).expect("a number").badge();
    let at = format!("https://{}", booth.client.address);
    browser.resize((1280, 800), false);
    add_first_account(&mut browser, &booth);
    for (language, code) in [(Language::English, "en"), (Language::Greek, "el")] {
        browser.open(&format!("{at}/staff/language/{code}"));
        for (size, place) in SIZES {
            browser.resize(place, size == "phone");
            browser.open(&format!("{at}/staff"));
            look_at(&mut browser, &format!("list-{size}-{code}"));
            // Search by the thumbnails of the hour from 13:00.
            choose(&mut browser, "day", &write_day(&folder, yesterday));
            choose(&mut browser, "hour", "13");
            browser.follow(".filter button");
            let thumbnails = "document.querySelectorAll('.thumbs a').length";
            assert_eq!(browser.ask(thumbnails), 50);
            look_at(&mut browser, &format!("hour-{size}-{code}"));
            // Search by one picture's name, then filter the matches by the hour.
            browser.follow("nav a[href='/staff/find']");
            browser.fill("input[name=words]", badge.pictograms[1].name(language));
            browser.enter();
            choose(&mut browser, "day", &write_day(&folder, yesterday));
            choose(&mut browser, "hour", "13");
            browser.follow(".filter button");
            let found = browser.ask(thumbnails).as_u64().expect("a number");
            assert!((1..=8).contains(&found), "{found}");
            look_at(&mut browser, &format!("lost-{size}-{code}"));
        }
    }
    browser.follow(&format!(".thumbs a[href='/staff/sculptures/{}']", SculptureId(lost.id)));
    assert!(browser.has("form[action$='/withdraw']"), "its page");
    // Search by one tapped picture.
    browser.resize((820, 1180), false);
    browser.open(&format!("{at}/staff/find"));
    browser.click(&format!("[data-picture='{}']", badge.pictograms[1].number()));
    look_at(&mut browser, "find-upright-el");
    browser.follow("#search");
    let kept = browser.ask("document.querySelector('.filter [name=words]').value");
    assert_eq!(kept, badge.pictograms[1].name(Language::Greek));
}
