//! Who is let in.

mod common;

use common::*;
use paros_booth_rules::limits::{ATTEMPT_LIFE, SILENCE_OF_WIPED};
use paros_booth_rules::{Booth, EnrolBits, hash_of};
use paros_core::outbox::messages::*;

fn bits(attempt: u64) -> EnrolBits {
    EnrolBits { attempt, booth_nonce: EnrolNonce([attempt as u8; 32]) }
}

/// A device that enrols by hand: its nonce and token are of its byte.
struct ByHand {
    nonce: EnrolNonce,
    token_hash: ContentHash,
    commit: EnrolCommit,
}

impl ByHand {
    fn new(byte: u8) -> Self {
        let (nonce, token_hash) = (EnrolNonce([byte; 32]), hash_of(&[byte; 32]));
        let commitment = hash_of(&nonce_commitment(&nonce, &token_hash));
        let name = DeviceName::new("Quest").expect("a name");
        let commit = EnrolCommit { commitment, hint: DeviceHint([byte; 16]), name };
        ByHand { nonce, token_hash, commit }
    }

    fn reveal(&self, attempt: u64) -> EnrolReveal {
        EnrolReveal { attempt, nonce: self.nonce, token_hash: self.token_hash }
    }

    fn poll(&self, booth: &Booth, attempt: u64, now: u64) -> (EnrolState, u32) {
        let asked = EnrolPoll { attempt, token_hash: self.token_hash };
        let answer = booth.poll_enrolment(&asked, seconds(now)).expect("a store");
        (answer.state, answer.headset)
    }

    /// Up to where staff have to look.
    fn wait(&self, booth: &Booth, attempt: u64) -> EnrolCommitAnswer {
        let answer = booth.commit_enrolment(&self.commit, bits(attempt), START).expect("room");
        let revealed = booth.reveal_enrolment(&self.reveal(attempt), START).expect("a store");
        assert_eq!(revealed.state, EnrolState::Waiting);
        answer
    }
}

#[test]
fn a_fleets_token_lets_so_many_in_until_it_expires_or_is_revoked() {
    let Rig { booth, .. } = Rig::new();
    let token = EnrolmentToken([1; 32]);
    booth.add_enrol_token(&token, (2, seconds(100)), "two", None, START).unwrap();
    let ask = |byte| FleetEnrolment { enrolment_token: token, ..fleet_enrolment(byte) };
    let first = booth.enrol_fleet(&ask(1), START).expect("the first of two");
    assert_eq!((first.headset, first.site), (1, SITE));
    // The answer was lost: the same again, and not counted.
    assert_eq!(booth.enrol_fleet(&ask(1), START).expect("known"), first);
    assert_eq!(booth.enrol_fleet(&ask(2), START).expect("the second of two").headset, 2);
    assert_eq!(status(booth.enrol_fleet(&ask(3), START)), 401, "used up");

    let other = EnrolmentToken([2; 32]);
    booth.add_enrol_token(&other, (9, seconds(100)), "expires", None, START).unwrap();
    let ask = |byte| FleetEnrolment { enrolment_token: other, ..fleet_enrolment(byte) };
    booth.enrol_fleet(&ask(4), seconds(99)).expect("in time");
    assert_eq!(status(booth.enrol_fleet(&ask(5), seconds(100))), 401, "expired");
    booth.revoke_enrol_token(&hash_of(&other.0).0, "ana", START).unwrap();
    assert_eq!(status(booth.enrol_fleet(&ask(6), START)), 401, "revoked");
    booth.authenticate(&DeviceToken([4; 32])).expect("who was let in stays");
}

#[test]
fn a_token_is_known_by_its_hash_until_it_is_taken_away() {
    let rig = Rig::new();
    let device = rig.enrol(3);
    assert_eq!(device.token_hash, hash_of(&[3; 32]).0);
    assert_eq!(status(rig.booth.authenticate(&DeviceToken([4; 32]))), 401);
    assert_eq!(status(rig.booth.authenticate(&DeviceToken(device.token_hash))), 401);
    rig.booth.revoke_device(device.headset, "ana", START).unwrap();
    // One that isn't known enrols anew by itself; one that was shut out doesn't.
    assert_eq!(status(rig.booth.authenticate(&DeviceToken([3; 32]))), 403);
    // Its number is never another headset's.
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
    // It may have lost its token alone: that it was wiped its heartbeats say.
    assert_eq!(device.wiped_at, None);
}

#[test]
fn staff_let_in_by_hand_who_shows_the_same_pictograms() {
    let Rig { booth, .. } = Rig::new();
    let device = ByHand::new(9);
    let answer = device.wait(&booth, 33);
    assert_eq!(answer.receipt_key, booth.keys().receipt_key());
    assert_eq!(device.poll(&booth, 33, 1), (EnrolState::Waiting, 0));
    let seen = booth.list_attempts(seconds(1)).unwrap();
    let transcript = enrolment_transcript(&device.commit, &answer, &device.reveal(33));
    let shown = enrolment_pictograms(&hash_of(&transcript)).map(|shown| shown.number() as u8);
    assert_eq!((seen[0].attempt, seen[0].pictograms), (33, shown));
    let headset = booth.accept_attempt(33, None, "ana", seconds(2)).expect("it waits");
    assert_eq!(device.poll(&booth, 33, 3), (EnrolState::Accepted, headset));
    booth.authenticate(&DeviceToken([9; 32])).expect("it is in");
    // Once.
    assert_eq!(status(booth.accept_attempt(33, None, "ana", seconds(3))), 404);
}

#[test]
fn who_reveals_something_else_or_is_declined_stays_out() {
    let Rig { booth, .. } = Rig::new();
    let device = ByHand::new(9);
    booth.commit_enrolment(&device.commit, bits(1), START).unwrap();
    let other = EnrolReveal { token_hash: ContentHash([1; 32]), ..device.reveal(1) };
    let state = booth.reveal_enrolment(&other, START).unwrap().state;
    assert_eq!(state, EnrolState::Declined);
    // A second guess isn't looked at.
    let state = booth.reveal_enrolment(&device.reveal(1), START).unwrap().state;
    assert_eq!(state, EnrolState::Declined);
    assert_eq!(status(booth.accept_attempt(1, None, "ana", START)), 404);

    let device = ByHand::new(10);
    device.wait(&booth, 2);
    booth.decline_attempt(2, "ana", START).unwrap();
    assert_eq!(device.poll(&booth, 2, 1), (EnrolState::Declined, 0));
    assert_eq!(status(booth.authenticate(&DeviceToken([10; 32]))), 401);
    assert_eq!(status(booth.authenticate(&DeviceToken([9; 32]))), 401);
}

#[test]
fn one_attempt_of_a_device_is_open_and_none_for_long() {
    let Rig { booth, .. } = Rig::new();
    let device = ByHand::new(9);
    device.wait(&booth, 1);
    assert_eq!(status(booth.commit_enrolment(&device.commit, bits(2), seconds(1))), 429);
    let late = ATTEMPT_LIFE.as_secs();
    assert_eq!(device.poll(&booth, 1, late), (EnrolState::Expired, 0));
    assert_eq!(status(booth.accept_attempt(1, None, "ana", seconds(late))), 404);
    assert_eq!(booth.list_attempts(seconds(late)).unwrap(), []);
    booth.commit_enrolment(&device.commit, bits(2), seconds(late)).expect("the last one is over");
    // Another device's token learns nothing.
    assert_eq!(ByHand::new(8).poll(&booth, 2, late), (EnrolState::Expired, 0));
    for k in 103..118 {
        booth.commit_enrolment(&ByHand::new(k).commit, bits(k.into()), seconds(late)).unwrap();
    }
    let full = booth.commit_enrolment(&ByHand::new(200).commit, bits(200), seconds(late));
    assert_eq!(status(full), 429);
}

#[test]
fn staff_say_which_wiped_headset_it_is() {
    let rig = Rig::new();
    let device = rig.enrol(9);
    let again = ByHand::new(9);
    // The hint is the same; the token is drawn anew.
    let again = ByHand { token_hash: hash_of(b"new"), ..again };
    let commitment = hash_of(&nonce_commitment(&again.nonce, &again.token_hash));
    let again = ByHand { commit: EnrolCommit { commitment, ..again.commit }, ..again };
    again.wait(&rig.booth, 1);
    let seen = rig.booth.list_attempts(START).unwrap();
    assert_eq!(seen[0].maybe_headset, Some(device.headset));
    let headset = rig.booth.accept_attempt(1, seen[0].maybe_headset, "ana", START).unwrap();
    assert_eq!(headset, device.headset);
    assert_eq!(status(rig.booth.authenticate(&DeviceToken([9; 32]))), 401);
    assert_eq!(rig.booth.list_devices().unwrap().len(), 1);
}
