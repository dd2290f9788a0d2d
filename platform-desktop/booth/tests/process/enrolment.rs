//! Who is let in, and what the program's other commands say.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;

use paros_booth_rules::hash_of;
use paros_core::badge::Language;
use paros_core::outbox::messages::*;

use crate::rig::{BoothFolder, Headset, Parcel};

#[test]
fn a_headset_enrols_by_hand_while_staff_compare_pictograms() {
    let folder = BoothFolder::new("by-hand");
    let booth = folder.start();
    let client = &booth.client;
    let (token, nonce) = (DeviceToken([1; 32]), EnrolNonce([2; 32]));
    let token_hash = hash_of(&token.0);
    let commit = EnrolCommit {
        commitment: hash_of(&nonce_commitment(&nonce, &token_hash)),
        hint: DeviceHint([3; 16]),
        name: DeviceName::new("<b>'; DROP TABLE devices; --").expect("a name"),
    };
    let answer = client.post("/v1/enrol/commit", &commit.to_bytes());
    let answer = EnrolCommitAnswer::from_bytes(&answer.body).expect("a message");
    let again = client.post("/v1/enrol/commit", &commit.to_bytes());
    assert_eq!((again.status, again.head.contains("retry-after: 180")), (429, true));
    let reveal = EnrolReveal { attempt: answer.attempt, nonce, token_hash };
    let revealed = client.post("/v1/enrol/reveal", &reveal.to_bytes());
    let revealed = EnrolRevealAnswer::from_bytes(&revealed.body).expect("a message");
    assert_eq!(revealed.state, EnrolState::Waiting);
    let transcript = enrolment_transcript(&commit, &answer, &reveal);
    let shown = enrolment_pictograms(&hash_of(&transcript));
    let shown = shown.map(|shown| shown.name(Language::English)).join(", ");
    let list = folder.run(&["attempts"]).expect("a list");
    assert_eq!(list, format!("{}: {shown} ({})\n", answer.attempt, commit.name.as_str()));
    let poll = EnrolPoll { attempt: answer.attempt, token_hash };
    let state = || {
        let polled = client.post("/v1/enrol/poll", &poll.to_bytes());
        EnrolPollAnswer::from_bytes(&polled.body).expect("a message")
    };
    assert_eq!(state().state, EnrolState::Waiting);
    let attempt = answer.attempt.to_string();
    assert_eq!(folder.run(&["accept", &attempt]).expect("it waits"), "headset 1\n");
    assert_eq!(state(), EnrolPollAnswer { state: EnrolState::Accepted, headset: 1 });
    let headset = Headset { token, number: 1, receipt_key: answer.receipt_key };
    headset.upload(client, &Parcel::volume(1, 1)).unwrap().expect("a receipt");
    let error = folder.run(&["decline", &attempt]).expect_err("it was accepted");
    assert_eq!(error, "paros-booth: no enrolment waits under this number\n");
}

#[test]
fn a_second_start_is_the_same_site_and_keys_are_their_owners() {
    let folder = BoothFolder::new("keys");
    drop(folder.start());
    let keys = folder.path().join("keys");
    let read = |name| fs::read(keys.join(name)).expect("it was made");
    let before = ["site.key", "ca.key", "ca.pem"].map(read);
    drop(folder.start());
    assert_eq!(["site.key", "ca.key", "ca.pem"].map(read), before);
    assert_eq!(fs::metadata(&keys).unwrap().permissions().mode() & 0o777, 0o700);
    for name in ["site.key", "ca.key"] {
        assert_eq!(fs::metadata(keys.join(name)).unwrap().permissions().mode() & 0o777, 0o600);
    }
    // Without its keys a booth would sign in another's name: it doesn't start.
    fs::remove_file(keys.join("site.key")).unwrap();
    let error = folder.run(&["attempts"]).expect_err("no keys");
    assert!(error.contains("site.key: its keys are missing"), "{error}");
}

#[test]
fn health_metrics_logs_and_the_end() {
    let folder = BoothFolder::new("health");
    let mut booth = folder.start_with(&["--json"]);
    assert_eq!(booth.client.get("/healthz").text(), "ok\n");
    assert_eq!(booth.client.metric("paros_booth_headsets"), 0);
    assert_eq!(booth.client.get("/nothing").status, 404);
    assert_eq!(booth.terminate(), Some(0), "told to end it ends well");
    let log = folder.log();
    assert!(log.lines().all(|line| line.starts_with('{') && line.ends_with('}')), "{log}");
    assert!(log.contains("\"message\":\"ended\""), "{log}");
}
