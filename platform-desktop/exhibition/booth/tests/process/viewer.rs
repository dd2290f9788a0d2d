//! Tests of the 3D viewer and of printed slips in a real browser.

use std::collections::HashSet;

use serde_json::{Value, json};

use crate::chromium::{Chromium, Picture};
use crate::prints::{send_form, slicer_by};
use crate::rig::BoothFolder;
use crate::smtp_sink::wait_until;
use crate::staff::Browser;
use crate::visitors::{scan, start, with_sculpture};

/// Returns the share of pixels that differ clearly.
fn difference(a: &Picture, b: &Picture) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let is_other = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|k| a[k].abs_diff(b[k]) > 12);
    let count = a.pixels.iter().zip(&b.pixels).filter(is_other).count();
    count as f64 / a.pixels.len() as f64
}

/// Returns the share of pixels that don't have the background's colour.
fn coverage(picture: &Picture) -> f64 {
    // Not the very corner, which is rounded.
    let ground = picture.pixels[9 * picture.width + 9];
    let is_other = |pixel: &&[u8; 3]| (0..3).any(|k| pixel[k].abs_diff(ground[k]) > 12);
    picture.pixels.iter().filter(is_other).count() as f64 / picture.pixels.len() as f64
}

#[test]
fn a_sculpture_is_drawn_and_turns_with_mouse_and_keys() {
    let Some(mut chromium) = Chromium::start("viewer") else { return };
    chromium.resize((390, 1400), false);
    let folder = BoothFolder::new("viewer");
    let (booth, at) = start(&folder, &[]);
    let page = with_sculpture(&booth.client, &folder);
    let browser = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    let path = scan(&browser.get(&format!("{page}/slip"))).expect("a code");
    chromium.open(&format!("http://{at}{path}?language=en"));
    chromium.wait_for("document.querySelector('.viewer button') !== null");
    chromium.ask("window.faults = []; addEventListener('securitypolicyviolation', (e) => faults.push(e.blockedURI))");
    chromium.ask("document.querySelector('.viewer button').click()");
    chromium.wait_for("document.querySelector('.viewer canvas').dataset.ready === 'yes'");
    let corner = chromium.ask(
        "(() => { const r = document.querySelector('.viewer canvas').getBoundingClientRect(); \
         return [r.x + scrollX, r.y + scrollY, r.width, r.height]; })()",
    );
    let place = [0, 1, 2, 3].map(|k| corner[k].as_f64().expect("a number"));
    let middle = [place[0] + place[2] / 2.0, place[1] + place[3] / 2.0];
    let whole = chromium.picture("viewer-page", [0.0, 0.0, 390.0, 1400.0]);
    assert!(coverage(&whole) > 0.1);
    let is_hidden = "getComputedStyle(document.querySelector('.viewer button')).display === 'none'";
    assert_eq!(chromium.ask(is_hidden), true);
    let first = chromium.picture("viewer-first", place);
    let colours: HashSet<[u8; 3]> = first.pixels.iter().copied().collect();
    let covered = coverage(&first);
    assert!(colours.len() > 40 && (0.08..0.9).contains(&covered), "{} {covered}", colours.len());

    chromium.mouse("mousePressed", middle);
    for k in 1..=6 {
        chromium.mouse("mouseMoved", [middle[0] + 15.0 * f64::from(k), middle[1]]);
    }
    chromium.mouse("mouseReleased", [middle[0] + 90.0, middle[1]]);
    let dragged = chromium.picture("viewer-dragged", place);
    assert!(difference(&first, &dragged) > 0.02, "dragging turns it");
    chromium.press_key("ArrowUp");
    let turned = chromium.picture("viewer-key", place);
    assert!(difference(&dragged, &turned) > 0.01, "so do keys");
    for _ in 0..4 {
        chromium.press_key("+");
    }
    let near = chromium.picture("viewer-near", place);
    assert!(coverage(&near) > 1.2 * coverage(&turned), "and come closer");
    assert_eq!(chromium.ask("faults.length"), Value::from(0), "the page's own rules hold");
}

/// The pages about prints fit a telephone; when a slip's page is printed, only the slip is on paper.
#[test]
fn prints_fit_a_telephone_and_a_slip_is_alone_on_paper() {
    let Some(mut chromium) = Chromium::start("slip") else { return };
    chromium.resize((390, 844), false);
    let folder = BoothFolder::new("slip-page");
    let slicer = slicer_by(&folder);
    let (booth, _) = start(&folder, &["--slicer", slicer.to_str().unwrap()]);
    let page = with_sculpture(&booth.client, &folder);
    let browser = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    let order = "height=60&filament=white&note=by+five";
    assert_eq!(send_form(&browser, &page, &format!("{page}/print"), order).status, 303);
    wait_until(|| browser.get(&page).text().contains("ready to print").then_some(()));
    let host = format!("https://{}", booth.client.address);
    chromium.call("Security.setIgnoreCertificateErrors", &json!({ "ignore": true }));
    let (name, value) = browser.cookie.split_once('=').expect("a pair");
    let cookie = json!({ "name": name, "value": value, "url": host, "path": "/", "secure": true });
    chromium.call("Network.setCookie", &cookie);
    for (name, path) in [
        ("prints-page", "/staff/prints".to_owned()),
        ("sculpture-page", page.clone()),
        ("slip-page", format!("{page}/slip")),
    ] {
        chromium.open(&format!("{host}{path}"));
        chromium.wait_for("document.querySelector('main h1') !== null");
        chromium.ask("document.querySelectorAll('details').forEach((d) => { d.open = true; })");
        let fits = "document.scrollingElement.scrollWidth <= innerWidth";
        assert_eq!(chromium.ask(fits), true, "{path} is wider than a telephone");
        chromium.picture(name, [0.0, 0.0, 390.0, 1600.0]);
    }
    let is_seen =
        |what: &str| format!("document.querySelector('{what}').getClientRects().length > 0");
    assert_eq!(chromium.ask(&is_seen("header")), true);
    chromium.call("Emulation.setEmulatedMedia", &json!({ "media": "print" }));
    for (what, expected) in
        [("header", false), ("#print-slip", false), (".slip .badge svg", true), (".slip .qr", true)]
    {
        assert_eq!(chromium.ask(&is_seen(what)), expected, "{what}");
    }
    chromium.picture("slip-paper", [0.0, 0.0, 390.0, 844.0]);
}
