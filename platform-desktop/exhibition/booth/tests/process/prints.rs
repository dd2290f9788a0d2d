//! Tests of prints: orders, slicing, steps by hand, and slips.

use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;

use paros_core::badge::{BadgeNumber, Language, write_words};
use paros_shell::require::require_or_skip;

use crate::rig::{Answer, BoothFolder, BoothProcess, Client, Headset, Parcel};
use crate::smtp_sink::wait_until;
use crate::staff::{Browser, post_form};

/// Makes a program that replaces the slicer from a shell script.
pub(crate) fn stand_in(folder: &BoothFolder, script: &str) -> PathBuf {
    let program = folder.path().with_file_name("slicer");
    std::fs::write(&program, format!("#!/bin/sh\n{script}\n")).expect("room on the disk");
    std::fs::set_permissions(&program, PermissionsExt::from_mode(0o755)).unwrap();
    program
}

/// A slicer whose print time in seconds is the square of the height in millimetres. The model is 120 mm high:
/// a print of 60 mm takes an hour, one of 120 mm four.
const QUADRATIC: &str = r#"
while test "$1" != --scale; do shift; done
seconds=$(awk "BEGIN { h = 120 * $2; printf \"%d\", h * h }")
printf '; total filament used [g] = 29.41\n; estimated printing time (normal mode) = %ss\n' $seconds >print.gcode
"#;

/// Makes the program that replaces the slicer.
pub(crate) fn slicer_by(folder: &BoothFolder) -> PathBuf {
    stand_in(folder, QUADRATIC)
}

/// Sends a sculpture. Returns the address of its page.
pub(crate) fn with_sculpture(client: &Client, folder: &BoothFolder, number: u32) -> String {
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(number);
    headset.upload(client, &parcel).unwrap().expect("it is taken");
    format!("/staff/sculptures/{}", parcel.facts.id)
}

/// Fills a page's form in, and sends it.
pub(crate) fn send_form(browser: &Browser<'_>, page: &str, action: &str, fields: &str) -> Answer {
    let text = browser.get(page);
    let token = text.text().split("name=\"form\" value=\"").nth(1).expect("a form");
    let form = format!("form={}&{fields}", &token[..32]);
    post_form(browser.client, action, &browser.cookie, &form)
}

/// Counts the slices in the folders of a booth's processes.
fn slices(folder: &BoothFolder) -> usize {
    let of_process = |name: String| folder.files(&format!("slices/{name}"));
    let all = folder.files("slices").into_iter().flat_map(of_process);
    // Slices' folders have numbers as names; beside them is a lock file.
    all.filter(|name| name.parse::<u64>().is_ok()).count()
}

fn browser(booth: &BoothProcess) -> Browser<'_> {
    Browser::first(&booth.client, &booth.first_code().expect("a code"))
}

/// Returns the address of the first form in the queue that does a step.
pub(crate) fn action_of(browser: &Browser<'_>, step: &str) -> Option<String> {
    let queue = browser.get("/staff/prints");
    let actions = queue.text().split("action=\"").skip(1).filter_map(|rest| rest.split('"').next());
    actions
        .filter(|action| action.starts_with("/staff/prints/"))
        .find(|action| action.ends_with(step))
        .map(str::to_owned)
}

pub(crate) fn take_step(browser: &Browser<'_>, step: &str) -> u16 {
    let action = action_of(browser, step).unwrap_or_else(|| panic!("no form to {step}"));
    send_form(browser, "/staff/prints", &action, "").status
}

#[test]
fn a_print_goes_from_its_order_to_done_by_hand() {
    let folder = BoothFolder::new("prints");
    let slicer = stand_in(&folder, QUADRATIC);
    let booth = folder.start_with(&["--slicer", slicer.to_str().unwrap()]);
    let at = with_sculpture(&booth.client, &folder, 77);
    let browser = browser(&booth);
    let order = "height=60%2C5&minutes=&filament=%3Cb%3Ewhite&note=by+five";
    assert_eq!(send_form(&browser, &at, &format!("{at}/print"), order).status, 303);
    let queue = |text: &str| browser.get("/staff/prints").text().contains(text);
    wait_until(|| queue("ready to print").then_some(()));
    for text in ["60.5 mm", "1 h 1 min, 29.5 g", "&lt;b&gt;white", "by five", &at] {
        assert!(queue(text), "{text}: {}", browser.get("/staff/prints").text());
    }
    assert!(browser.get(&at).text().contains("ready to print"));
    // A form token that is invalid, or of another page, is refused.
    let start = action_of(&browser, "/start").expect("it can begin");
    assert_eq!(post_form(&booth.client, &start, &browser.cookie, "form=00").status, 403);
    assert_eq!(take_step(&browser, "/start"), 303);
    assert!(queue("<strong>printing</strong>"));
    assert_eq!(send_form(&browser, "/staff/prints", &start, "").status, 409, "it has begun");
    assert_eq!(take_step(&browser, "/finish"), 303);
    assert!(queue("<strong>done</strong>") && action_of(&browser, "/cancel").is_none());
    assert_eq!(take_step(&browser, "/retry"), 303);
    wait_until(|| queue("ready to print").then_some(()));
    assert_eq!(take_step(&browser, "/cancel"), 303);
    assert!(queue("<strong>cancelled</strong>"));
    for order in ["height=5", "height=2000", "height=x", "minutes=1", ""] {
        let order = send_form(&browser, &at, &format!("{at}/print"), order);
        assert_eq!(order.status, 400, "{order:?}");
    }
    assert_eq!(browser.get("/staff/prints/12345/slip").status, 404);
    assert_eq!(slices(&folder), 0, "nothing of a slice stays");
}

#[test]
fn a_size_is_found_for_a_time() {
    let folder = BoothFolder::new("prints-minutes");
    let slicer = stand_in(&folder, QUADRATIC);
    let booth = folder.start_with(&["--slicer", slicer.to_str().unwrap()]);
    let at = with_sculpture(&booth.client, &folder, 77);
    let browser = browser(&booth);
    let order = "height=120&minutes=60&filament=&note=";
    assert_eq!(send_form(&browser, &at, &format!("{at}/print"), order).status, 303);
    let page = wait_until(|| {
        let page = browser.get(&at).text().to_owned();
        page.contains("ready to print").then_some(page)
    });
    let height = page.split(" mm<br>").next().and_then(|rest| rest.rsplit('>').next());
    let height: f32 = height.and_then(|height| height.parse().ok()).expect("a height");
    assert!((58.0..=60.0).contains(&height), "{height} mm take {} s", height * height);
}

#[test]
fn a_slicer_that_breaks_or_hangs_harms_nobody() {
    let folder = BoothFolder::new("prints-broken");
    let slicer = stand_in(
        &folder,
        "echo '<script>secret' >&2; test -e ../../../../hang && sleep 600; exit 7",
    );
    let mut booth = folder.start_with(&["--slicer", slicer.to_str().unwrap()]);
    let at = with_sculpture(&booth.client, &folder, 77);
    {
        let browser = browser(&booth);
        assert_eq!(send_form(&browser, &at, &format!("{at}/print"), "height=60").status, 303);
        wait_until(|| {
            browser.get(&at).text().contains("the slicer ended with code 7").then_some(())
        });
        assert!(!folder.log().contains("secret") && !browser.get(&at).text().contains("secret"));
        assert_eq!(take_step(&browser, "/start"), 303, "it is printed by hand all the same");
        std::fs::write(folder.path().with_file_name("hang"), "").unwrap();
        assert_eq!(send_form(&browser, &at, &format!("{at}/print"), "height=60").status, 303);
        wait_until(|| (slices(&folder) > 0).then_some(()));
        assert_eq!(browser.get(&at).status, 200);
    }
    let start = std::time::Instant::now();
    assert_eq!(booth.terminate(), Some(0));
    assert!(start.elapsed() < std::time::Duration::from_secs(10), "the end waits for no slice");
}

#[test]
fn a_booth_without_a_slicer_works_by_hand() {
    let folder = BoothFolder::new("prints-by-hand");
    let booth = folder.start_with(&["--slicer", "none"]);
    let at = with_sculpture(&booth.client, &folder, 77);
    let browser = browser(&booth);
    assert!(!browser.get(&at).text().contains("name=\"minutes\""));
    assert_eq!(send_form(&browser, &at, &format!("{at}/print"), "minutes=60").status, 400);
    assert_eq!(send_form(&browser, &at, &format!("{at}/print"), "height=60").status, 303);
    assert!(browser.get("/staff/prints").text().contains("time and material unknown"));
    assert_eq!(take_step(&browser, "/start"), 303);
    assert_eq!(take_step(&browser, "/fail"), 303);
    let folder = BoothFolder::new("prints-nowhere");
    let told = folder.run(&["--slicer", "/nowhere/slicer"]).expect_err("it doesn't start");
    assert!(told.contains("--slicer /nowhere/slicer: expected a program"), "{told}");
}

#[test]
fn a_slip_has_the_badge_and_its_words_and_nothing_for_staff_alone() {
    let folder = BoothFolder::new("slip");
    let booth = folder.start_with(&["--slicer", "none"]);
    let at = with_sculpture(&booth.client, &folder, 77);
    let browser = browser(&booth);
    let mut words = String::new();
    let badge = BadgeNumber::new(77).expect("a number").badge();
    write_words(&mut words, &badge, Language::English).expect("text");
    let slip = browser.get(&format!("{at}/slip"));
    for text in [words.as_str(), "<svg", "id=\"print-slip\""] {
        assert!(slip.text().contains(text), "{text}: {}", slip.text());
    }
    assert!(!slip.text().contains("Number"), "{}", slip.text());
    assert_eq!(
        send_form(
            &browser,
            &at,
            &format!("{at}/print"),
            "height=60&filament=blue&note=loud+father"
        )
        .status,
        303
    );
    let of_order = browser.get("/staff/prints");
    assert!(of_order.text().contains("loud father"), "{}", of_order.text());
    let link =
        of_order.text().split("href=\"").find(|rest| rest.contains("/slip\"")).expect("a link");
    let slip = browser.get(link.split('"').next().unwrap());
    assert!(slip.text().contains("blue") && slip.text().contains(&words), "{}", slip.text());
    assert!(!slip.text().contains("loud father"), "staff's notes are theirs: {}", slip.text());
    assert!(booth.client.get(&format!("{at}/slip")).head.contains("location: /staff/login"));
}

/// Runs the real PrusaSlicer on a sculpture.
#[test]
fn prusa_slicer_tells_time_and_material() {
    let found = std::process::Command::new("prusa-slicer").arg("--help").output();
    let found = found.map_err(|error| format!("prusa-slicer: {error}"));
    if require_or_skip(found).expect("PrusaSlicer (Debian: prusa-slicer)").is_none() {
        return;
    }
    let folder = BoothFolder::new("prints-prusa");
    let booth = folder.start();
    let at = with_sculpture(&booth.client, &folder, 77);
    let browser = browser(&booth);
    assert_eq!(send_form(&browser, &at, &format!("{at}/print"), "height=40").status, 303);
    let page = wait_until(|| {
        let page = browser.get(&at).text().to_owned();
        page.contains("ready to print").then_some(page)
    });
    assert!(page.contains(" g</p>") && page.contains(" h "), "{page}");
}
