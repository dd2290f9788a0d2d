//! The sculpture is turned in a real browser.

use std::collections::HashSet;

use serde_json::Value;

use crate::chromium::{Chromium, Picture};
use crate::rig::BoothFolder;
use crate::staff::Browser;
use crate::visitors::{scan, start, with_sculpture};

/// The part of pixels that differ clearly.
fn difference(a: &Picture, b: &Picture) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let is_other = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|k| a[k].abs_diff(b[k]) > 12);
    let count = a.pixels.iter().zip(&b.pixels).filter(is_other).count();
    count as f64 / a.pixels.len() as f64
}

/// The part of pixels that aren't the ground's colour.
fn coverage(picture: &Picture) -> f64 {
    // Not at its very corner, which is round.
    let ground = picture.pixels[9 * picture.width + 9];
    let is_other = |pixel: &&[u8; 3]| (0..3).any(|k| pixel[k].abs_diff(ground[k]) > 12);
    picture.pixels.iter().filter(is_other).count() as f64 / picture.pixels.len() as f64
}

#[test]
fn a_sculpture_is_drawn_and_turns_with_mouse_and_keys() {
    let Some(mut chromium) = Chromium::start("viewer-chromium", (390, 1400)) else { return };
    let folder = BoothFolder::new("viewer");
    let (booth, at) = start(&folder, &[]);
    let page = with_sculpture(&booth.client, &folder);
    let browser = Browser::first(&booth.client, &booth.first_code().expect("a code"));
    let path = scan(&browser.get(&format!("{page}/slip"))).expect("a code");
    chromium.open(&format!("http://{at}{path}?language=en"));
    chromium.wait_for("document.querySelector('.viewer button') !== null");
    chromium.evaluate("window.faults = []; addEventListener('securitypolicyviolation', (e) => faults.push(e.blockedURI))");
    chromium.evaluate("document.querySelector('.viewer button').click()");
    chromium.wait_for("document.querySelector('.viewer canvas').dataset.ready === 'yes'");
    let corner = chromium.evaluate(
        "(() => { const r = document.querySelector('.viewer canvas').getBoundingClientRect(); \
         return [r.x + scrollX, r.y + scrollY, r.width, r.height]; })()",
    );
    let place = [0, 1, 2, 3].map(|k| corner[k].as_f64().expect("a number"));
    let middle = [place[0] + place[2] / 2.0, place[1] + place[3] / 2.0];
    let whole = chromium.picture("viewer-page", [0.0, 0.0, 390.0, 1400.0]);
    assert!(coverage(&whole) > 0.1);
    let is_hidden = "getComputedStyle(document.querySelector('.viewer button')).display === 'none'";
    assert_eq!(chromium.evaluate(is_hidden), true);
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
    assert_eq!(chromium.evaluate("faults.length"), Value::from(0), "the page's own rules hold");
}
