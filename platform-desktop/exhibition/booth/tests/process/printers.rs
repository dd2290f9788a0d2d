//! Tests of prints on simulated printers that speak Moonraker's and PrusaLink's published protocols.

use std::fmt::Write as _;
use std::path::PathBuf;

use crate::printer_stand_in::{Protocol, StandIn};
use crate::prints::{action_of, send_form, slicer_by, take_step, with_sculpture};
use crate::rig::{BoothFolder, BoothProcess};
use crate::smtp_sink::wait_until;
use crate::staff::Browser;

/// Writes a printers file.
fn printers_file(folder: &BoothFolder, printers: &[(&str, &StandIn)]) -> PathBuf {
    let mut text = String::new();
    for (name, printer) in printers {
        let kind = match printer.protocol {
            Protocol::Moonraker => "moonraker",
            Protocol::PrusaLink => "prusalink",
        };
        write!(
            text,
            "[[printer]]\nname = \"{name}\"\nkind = \"{kind}\"\naddress = \"http://{}\"\nkey = \"s3cret-{kind}\"\n",
            printer.address
        )
        .unwrap();
    }
    let path = folder.path().with_file_name("printers.toml");
    std::fs::write(&path, text).expect("room on the disk");
    path
}

fn start(folder: &BoothFolder, printers: &[(&str, &StandIn)]) -> BoothProcess {
    let (slicer, printers) = (slicer_by(folder), printers_file(folder, printers));
    folder.start_with(&[
        "--slicer",
        slicer.to_str().unwrap(),
        "--printers",
        printers.to_str().unwrap(),
    ])
}

/// Orders a print, and waits until it is sliced.
fn order(browser: &Browser<'_>, at: &str) {
    assert_eq!(send_form(browser, at, &format!("{at}/print"), "height=60").status, 303);
    wait_until(|| shows(browser, "ready to print").then_some(()));
}

fn shows(browser: &Browser<'_>, text: &str) -> bool {
    browser.get("/staff/prints").text().contains(text)
}

fn staff(booth: &BoothProcess) -> Browser<'_> {
    Browser::first(&booth.client, &booth.first_code().expect("a code"))
}

fn a_print_is_sent_and_comes_to_its_end(protocol: Protocol, name: &str) {
    let (folder, printer) = (BoothFolder::new(name), StandIn::start(protocol));
    let booth = start(&folder, &[("Left <b>", &printer)]);
    let at = with_sculpture(&booth.client, &folder, 77);
    let browser = staff(&booth);
    order(&browser, &at);
    wait_until(|| shows(&browser, "Left &lt;b&gt;: free").then_some(()));
    assert_eq!(take_step(&browser, "/send/0"), 303);
    let file = wait_until(|| printer.printing());
    assert!(file.starts_with("paros-") && file.ends_with(".gcode"), "{file}");
    assert!(printer.received(&file).ends_with("estimated printing time (normal mode) = 3600s\n"));
    assert!(printer.received(&file).starts_with("; total filament"), "{}", printer.received(&file));
    wait_until(|| shows(&browser, "<strong>printing</strong>").then_some(()));
    assert_eq!(action_of(&browser, "/send/0"), None);
    printer.finish();
    wait_until(|| shows(&browser, "<strong>done</strong>").then_some(()));
    // A second print, which staff cancel.
    order(&browser, &at);
    assert_eq!(take_step(&browser, "/send/0"), 303);
    wait_until(|| printer.printing().filter(|other| *other != file));
    assert_eq!(take_step(&browser, "/cancel"), 303);
    wait_until(|| printer.printing().is_none().then_some(()));
    assert_eq!(printer.stopped(), 1);
    assert_eq!(printer.wrong_keys(), 0);
    assert!(!folder.log().contains("s3cret"), "{}", folder.log());
}

#[test]
fn moonraker_gets_a_print() {
    a_print_is_sent_and_comes_to_its_end(Protocol::Moonraker, "printer-moonraker");
}

#[test]
fn prusalink_gets_a_print() {
    a_print_is_sent_and_comes_to_its_end(Protocol::PrusaLink, "printer-prusalink");
}

/// A printer that is off, hangs, sends invalid or endless responses, or refuses doesn't disturb the booth.
#[test]
fn a_printer_that_fails_harms_nobody() {
    let folder = BoothFolder::new("printer-fails");
    let (off, deaf, mad) = (
        StandIn::start(Protocol::Moonraker),
        StandIn::start(Protocol::PrusaLink),
        StandIn::start(Protocol::Moonraker),
    );
    off.turn_off();
    deaf.refuse();
    mad.rave();
    let mut booth = start(&folder, &[("Off", &off), ("Deaf", &deaf), ("Mad", &mad)]);
    let at = with_sculpture(&booth.client, &folder, 77);
    {
        let browser = staff(&booth);
        order(&browser, &at);
        wait_until(|| shows(&browser, "Deaf: free").then_some(()));
        assert!(
            shows(&browser, "Off: doesn&#39;t answer") || shows(&browser, "Off: doesn't answer")
        );
        assert!(shows(&browser, "Mad: doesn"));
        assert_eq!(take_step(&browser, "/send/1"), 303);
        wait_until(|| shows(&browser, "<strong>failed</strong>").then_some(()));
        assert!(shows(&browser, "the printer said 409"));
        assert!(!shows(&browser, "not now"), "none of its words");
        assert_eq!(take_step(&browser, "/retry"), 303);
        wait_until(|| shows(&browser, "ready to print").then_some(()));
        assert_eq!(take_step(&browser, "/send/0"), 303);
        assert!(shows(&browser, ", Off"));
        assert_eq!(take_step(&browser, "/start"), 303, "somebody prints it by hand");
        assert!(!shows(&browser, ", Off"));
        // Ends the booth while another print is being sent to a printer that hangs.
        assert_eq!(take_step(&browser, "/cancel"), 303);
        order(&browser, &at);
        assert_eq!(take_step(&browser, "/send/0"), 303);
    }
    let start = std::time::Instant::now();
    assert_eq!(booth.terminate(), Some(0));
    assert!(start.elapsed() < std::time::Duration::from_secs(8), "the end waits for no printer");
}

#[test]
fn a_file_of_printers_that_is_wrong_is_told_without_its_keys() {
    let folder = BoothFolder::new("printer-file");
    let (path, slicer) = (folder.path().with_file_name("printers.toml"), slicer_by(&folder));
    let told = |text: &str, slicer: &str| {
        std::fs::write(&path, text).unwrap();
        folder.run(&["--slicer", slicer, "--printers", path.to_str().unwrap()]).expect_err("wrong")
    };
    let wrong = "[[printer]]\nname = \"A\"\nkind = \"moonraker\"\naddress = \"10.0.0.7\"\nkey = \"s3cret\"\n";
    let why = told(wrong, slicer.to_str().unwrap());
    assert!(why.contains("printers.toml: printer 1: expected an address"), "{why}");
    assert!(!why.contains("s3cret"), "{why}");
    let why = told("key = \"s3cret", slicer.to_str().unwrap());
    assert!(why.contains("printers.toml: line 1") && !why.contains("s3cret"), "{why}");
    let right = wrong.replace("10.0", "http://10.0");
    assert!(told(&right, "none").contains("expected a slicer"));
}
