//! What headset and booth tell each other: every message comes back from its bytes, no two bytes are the same message,
//! and what no writer makes is refused where it stands.

mod any_messages;
mod refusals;

use paros_core::codec::BadBytes;
use paros_core::outbox::messages::{
    ContentHash, DeviceHint, DeviceName, DeviceToken, EnrolmentToken, FleetEnrolment, SculptureId,
};
use paros_models::cases::random_cases;
use paros_models::random_visitor::RandomSource;
use proptest::prelude::*;

use self::any_messages::{Written, bytes_of, list_messages, pick};
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
fn names_are_text_that_fits() {
    let cut = DeviceName::new("Ακρόπολη, τρίτη αίθουσα").expect("a name");
    assert_eq!(cut.as_str(), "Ακρόπολη, τρίτη α", "whole characters alone");
    assert_eq!(DeviceName::new("a\nb"), None);
    assert_eq!(DeviceName::new("a\0b"), None);
    let enrolment = FleetEnrolment {
        enrolment_token: EnrolmentToken([1; 32]),
        token_hash: ContentHash([1; 32]),
        hint: DeviceHint([1; 16]),
        name: cut,
    };
    let faults: &[(usize, &[u8], &str)] = &[
        (81, &[0xff], "a name"),
        (81, b"\n", "a name"),
        (82, b"\0a\0b", "a name"),
        (112, &[0xc3], "a name"),
    ];
    check_refused(&enrolment.to_bytes(), FleetEnrolment::from_bytes, faults);
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
