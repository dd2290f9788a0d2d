//! A booth and a shell as processes: what visits leave comes there, whoever is killed in between.

mod kills;
mod rig;

use std::collections::BTreeSet;

use paros_booth_process::find_booth;
use paros_core::badge::Language;
use paros_core::outbox::messages::DeviceName;
use paros_outbox_link::{HttpsCaller, fetch_shown_authority};
use paros_shell::outbox::enrolment::{
    ByHandState, ENROL_TIMEOUT, EnrolError, HandEnrolment, NewDevice,
};

use rig::{Place, wait_for_log};

#[test]
fn visits_sculptures_come_to_a_booth_with_the_same_meshes() {
    let Some(booth) = find_booth() else { return };
    let place = Place::new("visits", booth);
    let running = place.start_booth();
    place.enrol_by_fleet_file(&running);
    let told = place.run_shell_to_the_end(2, 7);
    let kept: BTreeSet<_> = told.kept.iter().collect();
    assert_eq!((kept.len(), told.signed.is_empty()), (2, false), "{told:?}");
    let parcels = place.parcels_at_booth();
    assert_eq!(
        parcels.iter().map(|parcel| parcel.facts().id.to_string()).collect::<BTreeSet<_>>(),
        kept.into_iter().cloned().collect()
    );
    // What the visitor's print is, and what the booth makes anew of the volume, are the same bytes.
    let hashes: BTreeSet<_> = parcels.iter().map(|parcel| parcel.facts().stl_hash).collect();
    assert_eq!(hashes, place.print_hashes());
    wait_for_log(&running, "state=Equal", 2);
    assert!(!running.read_log().contains("state=Different"));
    // The second badge is leased: the booth was heard by then.
    let badges: Vec<_> =
        parcels.iter().map(|parcel| parcel.facts().badge.expect("shown")).collect();
    assert_ne!(badges[0], badges[1]);
}

#[test]
fn a_device_enrols_by_hand_once_staff_accept_the_same_pictograms() {
    let Some(booth) = find_booth() else { return };
    let place = Place::new("by-hand", booth);
    let running = place.start_booth();
    let device = NewDevice::draw(None, DeviceName::new("desk").expect("a name")).expect("bits");
    let ca = fetch_shown_authority(running.address()).expect("it shows one");
    let mut link = HttpsCaller::new(running.address(), &ca, ENROL_TIMEOUT);
    let begun = HandEnrolment::begin(&mut link, (running.address(), &ca), &device).expect("begun");
    assert_eq!(begun.poll(&mut link).expect("an answer"), ByHandState::Waiting);
    let attempts = running.run(&["attempts"]);
    let shown = begun.pictograms().map(|pictogram| pictogram.name(Language::English)).join(", ");
    let (attempt, rest) = attempts.split_once(": ").expect("one attempt");
    assert_eq!(rest, format!("{shown} (desk)\n"));
    let _ = running.run(&["accept", attempt]);
    let ByHandState::Accepted(enrolment) = begun.poll(&mut link).expect("an answer") else {
        panic!("it was accepted")
    };
    enrolment.write(&place.enrolment_file()).expect("room on the disk");
    assert_eq!(place.run_shell_to_the_end(1, 3).signed.len(), 1);
    assert_eq!(place.parcels_at_booth().len(), 1);
}

#[test]
fn another_authority_is_told_and_nothing_is_sent_there() {
    let Some(booth) = find_booth() else { return };
    let (place, other) = (Place::new("pinned", booth.clone()), Place::new("other", booth));
    let (running, stranger) = (place.start_booth(), other.start_booth());
    let ca = fetch_shown_authority(running.address()).expect("it shows one");
    let mut link = HttpsCaller::new(stranger.address(), &ca, ENROL_TIMEOUT);
    let device = NewDevice::draw(None, DeviceName::new("desk").expect("a name")).expect("bits");
    let begun = HandEnrolment::begin(&mut link, (stranger.address(), &ca), &device);
    let told = begun.expect_err("its authority is another").to_string();
    assert!(told.contains("isn't the booth"), "{told}");
    assert_eq!(stranger.run(&["attempts"]), "");
    let gone = fetch_shown_authority("https://127.0.0.1:1").map_err(EnrolError::Link);
    assert_eq!(gone.expect_err("nobody is there").to_string(), "the booth isn't reached");
}
