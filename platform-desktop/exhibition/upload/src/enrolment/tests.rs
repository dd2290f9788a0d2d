//! Enrolment files, and enrolment at booths with scripted answers.

use std::collections::VecDeque;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::PathBuf;

use base64ct::{Base64, Encoding as _};
use paros_protocol::{EnrolAnswer, EnrolmentToken};

use super::*;
use crate::LinkError;

struct Booth {
    answers: VecDeque<Vec<u8>>,
    asked: Vec<String>,
}

impl BoothCaller for Booth {
    fn call(&mut self, request: &HttpRequest<'_>) -> Result<HttpAnswer, LinkError> {
        self.asked.push(request.path.clone());
        let gone = LinkError { fault: LinkFault::Unreachable, why: String::new() };
        let body = self.answers.pop_front().ok_or(gone)?;
        Ok(HttpAnswer { status: 200, retry_after: None, body })
    }
}

fn booth(answers: impl IntoIterator<Item = Vec<u8>>) -> Booth {
    Booth { answers: answers.into_iter().collect(), asked: Vec::new() }
}

fn device() -> NewDevice {
    NewDevice::draw(None, DeviceName::new("desk").expect("a name")).expect("random bits")
}

fn file(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("paros-enrolment-{name}-{}", std::process::id()))
}

const SITE: SiteId = SiteId([7; 16]);

#[test]
fn what_is_written_is_read_again_and_is_its_owners_alone() {
    let path = file("kept");
    let enrolment = Enrolment {
        address: "https://10.0.0.7:8443".into(),
        ca: vec![0x30, 0x82, 0, 0xff],
        token: device().token,
        owner: OutboxOwner { site: SITE, headset: 3 },
    };
    assert!(Enrolment::read(&path).expect("no file is no fault").is_none());
    enrolment.write(&path).expect("room on the disk");
    assert_eq!(fs::metadata(&path).expect("a file").permissions().mode() & 0o777, 0o600);
    assert_eq!(Enrolment::read(&path).expect("whole"), Some(enrolment.clone()));
    let token = enrolment.token.token().reveal().to_string();
    assert!(!format!("{enrolment:?}").contains(&token));
    let whole = fs::read_to_string(&path).expect("text");
    for (from, to, told) in [
        ("headset = 3", "headset = 0", "headset: expected a number from 1"),
        ("https://10", "http://10", "address: expected https:// and an address"),
        ("token = \"", "token = \"z", "token: expected 64 hexadecimal digits"),
        ("ca = \"3", "ca = \"", "ca: expected a certificate in hexadecimal digits"),
        ("site = ", "site ", "line 3: expected TOML"),
    ] {
        fs::write(&path, whole.replacen(from, to, 1)).expect("room on the disk");
        let told_now = Enrolment::read(&path).expect_err(from).to_string();
        assert!(told_now.contains(told) && told_now.contains("paros-enrolment"), "{told_now}");
    }
    fs::remove_file(path).expect("it is there");
}

#[test]
fn a_fleet_enrols_at_its_own_site_alone() {
    let fleet = FleetFile {
        address: "https://booth.test:1".into(),
        site: SITE,
        enrolment_token: EnrolmentToken([1; 32]),
        ca: vec![1, 2],
    };
    let answer = |site| EnrolAnswer { headset: 4, site }.to_json();
    let enrolled = enrol_by_fleet(&mut booth([answer(SITE)]), &fleet, &device());
    assert_eq!(enrolled.expect("its site").owner, OutboxOwner { site: SITE, headset: 4 });
    let other = enrol_by_fleet(&mut booth([answer(SiteId([9; 16]))]), &fleet, &device());
    assert!(matches!(other, Err(EnrolError::AnotherSite)), "{other:?}");
}

#[test]
fn an_address_is_of_https_and_ends_in_no_slash() {
    assert_eq!(check_address("https://b:1/").as_deref(), Some("https://b:1"));
    for bad in ["http://b", "https://", "https://b/c", "https://b\n", "https://u@b", "b:1"] {
        assert_eq!(check_address(bad), None, "{bad}");
    }
}

const FLEET: &str = "address = \"https://10.0.0.7:8443/\"\nsite = \"07070707070707070707070707070707\"\n\
    enrolment_token = \"0909090909090909090909090909090909090909090909090909090909090909\"\n\
    ca = \"\"\"\n-----BEGIN CERTIFICATE-----\nMIIB\n-----END CERTIFICATE-----\n\"\"\"\n";

#[test]
fn a_fleets_file_comes_through_a_form_that_keeps_no_lines() {
    let read = |text: &str| FleetFile::parse_text("managed configuration", text);
    let plain = read(FLEET).expect("a fleet's file");
    assert_eq!((plain.site, plain.ca.len()), (SITE, 3));
    let letters = Base64::encode_string(FLEET.as_bytes());
    let cut = letters.replace('a', "a\n ");
    for text in [&letters, &cut] {
        assert_eq!(read(text).expect("the same").address, "https://10.0.0.7:8443");
    }
    for (text, why) in [
        (FLEET.replace('\n', " "), "managed configuration: line 1: expected TOML"),
        (Base64::encode_string(b"address = 1"), "managed configuration: ca: expected a value"),
        (Base64::encode_string(&[0xff]), "managed configuration: expected text in UTF-8"),
    ] {
        let told = read(&text).expect_err(why).to_string();
        assert!(told.starts_with(why), "{told}");
    }
}

#[test]
fn an_enrolment_moves_with_its_booth_and_not_to_another_site() {
    let fleet = FleetFile::parse("fleet", FLEET.as_bytes()).expect("a fleet's file");
    let kept = Enrolment {
        address: "https://10.0.0.6:8443".into(),
        ca: vec![1],
        token: device().token,
        owner: OutboxOwner { site: SITE, headset: 3 },
    };
    let moved = kept.moved_to(&fleet).expect("the same site");
    let (address, ca) = (fleet.address.clone(), fleet.ca.clone());
    assert_eq!(moved, Enrolment { address, ca, ..kept.clone() });
    let of_other = FleetFile { site: SiteId([1; 16]), ..fleet };
    assert_eq!(kept.moved_to(&of_other), None);
}

#[test]
fn a_hint_is_of_the_devices_name_and_doesnt_tell_it() {
    let hint = hint_of_device("9774d56d682e549c");
    assert_eq!(hint, hint_of_device("9774d56d682e549c"));
    assert!(hint != hint_of_device("9774d56d682e549d"));
    assert!(hint.0 != *b"9774d56d682e549c");
}
