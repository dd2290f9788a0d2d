//! Enrolment and exclusion.

use super::common::*;
use paros_booth_rules::limits::SILENCE_OF_WIPED;
use paros_protocol::ContentHash;

#[test]
fn a_fleets_token_lets_so_many_in_until_it_expires_or_is_revoked() {
    let Rig { booth, .. } = Rig::new();
    let token = EnrolmentToken([1; 32]);
    booth.add_enrol_token(&token, (2, seconds(100)), "two", None, START).unwrap();
    let ask = |byte| FleetEnrolment { enrolment_token: token, ..fleet_enrolment(byte) };
    let first = booth.enrol_fleet(&ask(1), START).expect("the first of two");
    assert_eq!((first.headset, first.site), (1, SITE));
    // The answer was lost: the retry gets the same answer, and isn't counted.
    assert_eq!(booth.enrol_fleet(&ask(1), START).expect("known"), first);
    assert_eq!(booth.enrol_fleet(&ask(2), START).expect("the second of two").headset, 2);
    assert_eq!(status(booth.enrol_fleet(&ask(3), START)), 401, "used up");

    let other = EnrolmentToken([2; 32]);
    booth.add_enrol_token(&other, (9, seconds(100)), "expires", None, START).unwrap();
    let ask = |byte| FleetEnrolment { enrolment_token: other, ..fleet_enrolment(byte) };
    booth.enrol_fleet(&ask(4), seconds(99)).expect("in time");
    assert_eq!(status(booth.enrol_fleet(&ask(5), seconds(100))), 401, "expired");
    booth.revoke_enrol_token(&ContentHash::of(&other.0).0, "ana", START).unwrap();
    assert_eq!(status(booth.enrol_fleet(&ask(6), START)), 401, "revoked");
    booth.authenticate(&DeviceToken([4; 32])).expect("who was let in stays");
}

#[test]
fn a_token_is_known_by_its_hash_until_it_is_taken_away() {
    let rig = Rig::new();
    let device = rig.enrol(3);
    assert_eq!(device.token_hash, ContentHash::of(&[3; 32]).0);
    assert_eq!(status(rig.booth.authenticate(&DeviceToken([4; 32]))), 401);
    assert_eq!(status(rig.booth.authenticate(&DeviceToken(device.token_hash))), 401);
    rig.booth.revoke_device(device.headset, "ana", START).unwrap();
    // An unknown device enrols again by itself; an excluded one doesn't.
    assert_eq!(status(rig.booth.authenticate(&DeviceToken([3; 32]))), 403);
    // The number isn't assigned to another headset.
    assert_eq!(rig.enrol(4).headset, device.headset + 1);
}

#[test]
fn a_wiped_headset_keeps_its_number_and_one_that_talks_keeps_its_token() {
    let rig = Rig::new();
    let device = rig.enrol(3);
    rig.beat(&device, &heartbeat(device.headset), START);
    let same_hint = |byte| FleetEnrolment { hint: DeviceHint([3; 16]), ..fleet_enrolment(byte) };
    let talking = rig.booth.enrol_fleet(&same_hint(4), seconds(5)).unwrap();
    assert_ne!(talking.headset, device.headset, "a hint is no credential");
    rig.booth.authenticate(&DeviceToken([3; 32])).expect("it goes on");

    let rig = Rig::new();
    let device = rig.enrol(3);
    rig.beat(&device, &heartbeat(device.headset), START);
    let later = START.after(SILENCE_OF_WIPED * 2);
    let wiped = rig.booth.enrol_fleet(&same_hint(4), later).unwrap();
    assert_eq!(wiped.headset, device.headset);
    assert_eq!(status(rig.booth.authenticate(&DeviceToken([3; 32]))), 401, "the old token");
    let device = rig.booth.authenticate(&DeviceToken([4; 32])).expect("the new token");
    // The device may have lost only its token. Its heartbeats report a wipe.
    assert_eq!(device.wiped_at, None);
}
