//! What headset and booth tell each other: every message comes back from its bytes, no two bytes are the same message,
//! and what no writer makes is refused where it stands.

mod any_messages;
mod refusals;

use paros_core::codec::BadBytes;
use paros_core::outbox::messages::{
    ContentHash, DeviceHint, DeviceName, DeviceToken, EnrolCommit, EnrolCommitAnswer, EnrolNonce,
    EnrolPollAnswer, EnrolReveal, EnrolState, ReceiptKey, SculptureId, SiteId,
    enrolment_pictograms, enrolment_transcript, nonce_commitment,
};
use paros_models::cases::random_cases;
use paros_models::random_visitor::RandomSource;
use proptest::prelude::*;

use self::any_messages::{HEADSET, Written, bytes, bytes_of, list_messages, pick};
use self::refusals::check_refused;

/// What is read is written as it was; what is refused is refused within the bytes.
fn check_read((name, _, again): &Written, bytes: &[u8]) {
    match again(bytes) {
        Ok(written) => assert_eq!(written, bytes, "{name}"),
        Err(bad) => assert!(bad.offset <= bytes.len() && !bad.expected.is_empty(), "{name}"),
    }
}

proptest! {
    #![proptest_config(random_cases(500))]

    #[test]
    fn messages_come_back_from_their_bytes_and_from_no_others(seed: u64) {
        let dice = &mut RandomSource::new(seed);
        for message in list_messages(dice) {
            let (name, bytes, again) = &message;
            prop_assert_eq!(&again(bytes), &Ok(bytes.clone()), "{}", name);
            let cut = dice.next_bits() as usize % bytes.len();
            prop_assert!(again(&bytes[..cut]).is_err(), "{} of {} bytes", name, cut);
            let mut longer = bytes.clone();
            longer.push(0);
            let end = BadBytes { offset: bytes.len(), expected: "the end" };
            prop_assert_eq!(again(&longer), Err(end), "{}", name);
            let mut other = bytes.clone();
            other[0] = 2;
            prop_assert_eq!(again(&other).map_err(|bad| bad.offset), Err(0), "{}", name);
        }
    }

    #[test]
    fn bytes_of_any_kind_are_refused_or_read_as_what_they_are(seed: u64) {
        let dice = &mut RandomSource::new(seed);
        for mut message in list_messages(dice) {
            for _ in 0..20 {
                let at = dice.next_bits() as usize % message.1.len();
                let before = message.1[at];
                message.1[at] = pick(dice, &[0, 1, before ^ 1 << (seed % 8), 128, 255]);
                let bytes = message.1.clone();
                check_read(&message, &bytes);
                if dice.next_bits() & 3 != 0 {
                    message.1[at] = before;
                }
            }
            let mut noise = message.1.clone();
            noise.iter_mut().skip(1).for_each(|byte| *byte = dice.next_bits() as u8);
            check_read(&message, &noise);
        }
    }
}

#[test]
fn enrolments_by_hand_show_24_bits_of_all_that_was_said() {
    let dice = &mut RandomSource::new(5);
    let (nonce, token_hash) = (EnrolNonce(bytes(dice)), ContentHash(bytes(dice)));
    let name = DeviceName::new("Red 3").expect("a name");
    let committed = nonce_commitment(&nonce, &token_hash);
    assert_eq!(committed, [nonce.0, token_hash.0].concat()[..]);
    let commit =
        EnrolCommit { commitment: ContentHash(bytes(dice)), hint: DeviceHint([1; 16]), name };
    let answer = EnrolCommitAnswer {
        attempt: 6,
        booth_nonce: EnrolNonce(bytes(dice)),
        ca_hash: ContentHash(bytes(dice)),
        receipt_key: ReceiptKey(bytes(dice)),
        site: SiteId(bytes(dice)),
    };
    let reveal = EnrolReveal { attempt: 6, nonce, token_hash };
    let said =
        [&b"paros enrol v1\0"[..], &commit.to_bytes(), &answer.to_bytes(), &reveal.to_bytes()];
    assert_eq!(enrolment_transcript(&commit, &answer, &reveal)[..], said.concat());
    let mut hash = [0; 32];
    hash[..4].copy_from_slice(&[0b0000_0100, 0b0010_0000, 0b1111_1111, 0b1111_1111]);
    let shown = enrolment_pictograms(&ContentHash(hash)).map(|pictogram| pictogram.number());
    assert_eq!(shown, [1, 2, 3, 63]);
    let accepted = EnrolPollAnswer { state: EnrolState::Accepted, headset: HEADSET };
    let faults: &[(usize, &[u8], &str)] = &[
        (1, &[0], "where it is accepted"),
        (2, &[0; 4], "where it is accepted"),
        (1, &[4], "stands"),
    ];
    check_refused(&accepted.to_bytes(), EnrolPollAnswer::from_bytes, faults);
}

#[test]
fn names_are_text_that_fits() {
    let cut = DeviceName::new("Ακρόπολη, τρίτη αίθουσα").expect("a name");
    assert_eq!(cut.as_str(), "Ακρόπολη, τρίτη α", "whole characters alone");
    assert_eq!(DeviceName::new("a\nb"), None);
    assert_eq!(DeviceName::new("a\0b"), None);
    let commit =
        EnrolCommit { commitment: ContentHash([1; 32]), hint: DeviceHint([1; 16]), name: cut };
    let faults: &[(usize, &[u8], &str)] = &[
        (49, &[0xff], "a name"),
        (49, b"\n", "a name"),
        (50, b"\0a\0b", "a name"),
        (80, &[0xc3], "a name"),
    ];
    check_refused(&commit.to_bytes(), EnrolCommit::from_bytes, faults);
}

#[test]
fn ids_are_read_as_they_are_shown_and_secrets_are_not_shown() {
    let id = SculptureId(bytes_of(0xa5));
    assert_eq!(id.to_string(), "a5".repeat(16));
    assert_eq!(SculptureId::parse_hex(&id.to_string()), Some(id));
    assert_eq!(SculptureId::parse_hex(&"A5".repeat(16)), Some(id));
    assert_eq!(format!("{id:?}"), format!("SculptureId({id})"));
    for text in ["", "a5", &"a5".repeat(17), &"g5".repeat(16), &"é".repeat(16), &"+5".repeat(16)] {
        assert_eq!(SculptureId::parse_hex(text), None, "{text}");
    }
    let token = DeviceToken([0xb7; 32]);
    assert_eq!(format!("{token:?}"), "DeviceToken(not shown)");
    assert_eq!(token.reveal().to_string(), "b7".repeat(32));
}
