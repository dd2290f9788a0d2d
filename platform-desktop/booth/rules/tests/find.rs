//! How a sculpture is found, by staff and by its visitor.

mod common;

use common::*;
use paros_booth_rules::{FoundByBadge, LinkToken, WordsFault, parse_badge_words};
use paros_core::badge::{Badge, BadgeNumber, Language, write_words};
use paros_core::outbox::messages::SculptureId;
use proptest::prelude::*;

fn found(rig: &Rig, badge: &Badge) -> Vec<SculptureId> {
    match rig.booth.find_by_badge(badge, seconds(99)).unwrap() {
        FoundByBadge::Exact(matches) => {
            matches.kept.iter().map(|kept| SculptureId(kept.id)).collect()
        }
        FoundByBadge::Nearest(nearest) => panic!("{nearest:?}"),
    }
}

#[test]
fn a_badge_finds_its_sculpture_and_a_provisional_one_all() {
    let rig = Rig::new();
    let (device, other) = (rig.enrol(1), rig.enrol(2));
    rig.grant(&device, leased(9).unwrap());
    let provisional = BadgeNumber::provisional(77);
    for (k, badge) in
        [leased(9), leased(10), Some(provisional), Some(provisional), None].into_iter().enumerate()
    {
        let parcel = Parcel::new(device.headset, k as u8 + 1, badge);
        rig.upload(&device, &parcel, seconds(k as u64)).unwrap();
    }
    let id = |byte| SculptureId([byte; 16]);
    assert_eq!(found(&rig, &leased(9).unwrap().badge()), [id(1)]);
    assert_eq!(found(&rig, &provisional.badge()), [id(4), id(3)], "the newest first");
    assert_eq!(found(&rig, &leased(11).unwrap().badge()), []);
    // One in doubt stands behind, though it is newer.
    rig.upload(&other, &Parcel::new(other.headset, 50, leased(9)), seconds(50)).unwrap();
    assert_eq!(found(&rig, &leased(9).unwrap().badge()), [id(1), id(50)]);
    let newest = rig.booth.list_newest(2, seconds(99)).unwrap();
    assert_eq!(newest.iter().map(|kept| kept.id[0]).collect::<Vec<_>>(), [50, 5]);
}

#[test]
fn a_wrong_badge_finds_the_nearest_that_something_has() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    rig.upload(&device, &Parcel::new(device.headset, 1, leased(9)), START).unwrap();
    let announced = Parcel::new(device.headset, 2, leased(700))
        .announcement(paros_core::outbox::messages::AnnouncementState::Kept);
    rig.beat(&device, &announcing(&heartbeat(device.headset), &[announced]), START);
    for number in [9, 700] {
        let right = leased(number).unwrap().badge();
        let mut swapped = right;
        swapped.pictograms.swap(1, 2);
        match rig.booth.find_by_badge(&swapped, START).unwrap() {
            FoundByBadge::Nearest(nearest) => {
                assert_eq!(nearest.len(), 1, "others that nobody has are no candidates");
                assert_eq!(nearest[0].0, right);
                assert_eq!(nearest[0].1.kept.len() + nearest[0].1.missing.len(), 1);
            }
            FoundByBadge::Exact(matches) => panic!("{matches:?}"),
        }
    }
}

proptest! {
    #[test]
    fn words_are_read_as_they_are_said(number in 0..BadgeNumber::COUNT, greek: bool) {
        let badge = BadgeNumber::new(number).unwrap().badge();
        let mut words = String::new();
        write_words(&mut words, &badge, Language::ALL[usize::from(greek)]).unwrap();
        prop_assert_eq!(parse_badge_words(&words), Ok(badge));
        prop_assert_eq!(parse_badge_words(&words.to_uppercase()), Ok(badge));
    }

    #[test]
    fn no_words_panic(text in ".{0,80}") {
        let _ = parse_badge_words(&text);
    }
}

#[test]
fn words_are_read_with_a_slip() {
    let badge = parse_badge_words("red: pizza, mushroom, rocket, chair").unwrap();
    for words in [
        "pizza mushroom rocket chair red",
        "a piza and a mushrom, the roket, chairs - red",
        "κοκκινο πιτσα μανιταρι πυραυλος καρεκλα",
        "ΚΌΚΚΙΝΟ: πίτσα, mushroom, πύραυλος και καρέκλα",
    ] {
        assert_eq!(parse_badge_words(words), Ok(badge), "{words}");
    }
    let unknown = WordsFault::UnknownWord("dragon".into());
    assert_eq!(parse_badge_words("red pizza dragon rocket chair"), Err(unknown));
    assert_eq!(parse_badge_words("pizza mushroom rocket chair"), Err(WordsFault::Colours(0)));
    assert_eq!(parse_badge_words("red blue pizza"), Err(WordsFault::Colours(2)));
    assert_eq!(parse_badge_words("red pizza mushroom"), Err(WordsFault::Pictograms(2)));
}

#[test]
fn a_visitors_link_is_its_sculptures_until_it_is_taken_back() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcels = [1, 2].map(|id| Parcel::new(device.headset, id, leased(id.into())));
    for parcel in &parcels {
        rig.upload(&device, parcel, START).unwrap();
    }
    let [first, second] = parcels.map(|parcel| parcel.id);
    let opens = |id, token| rig.booth.find_by_link(&id, &token, START).is_ok();
    let token = rig.booth.link_token(&first, START).unwrap();
    assert!(opens(first, token));
    assert!(!opens(second, token));
    for bit in 0..128 {
        let mut other = token;
        other.0[bit / 8] ^= 1 << (bit % 8);
        assert!(!opens(first, other));
    }
    assert!(!opens(SculptureId([3; 16]), LinkToken([0; 16])));
    assert!(rig.booth.link_token(&first, START).unwrap() == token, "printed again");
    rig.booth.revoke_link(&first, "ana", START).unwrap();
    assert!(!opens(first, token));
    assert_eq!(rig.booth.link_token(&first, START).err().map(|error| error.status()), Some(404));
    let renewed = rig.booth.renew_link(&first, "ana", START).expect("another");
    assert!(opens(first, renewed) && !opens(first, token));
    rig.booth.withdraw(&first, "ana", START).unwrap();
    assert!(!opens(first, renewed), "what is withdrawn is hidden from all");
    rig.booth.bring_back(&first, "ana", START).unwrap();
    assert!(opens(first, renewed));
    rig.booth.delete(&first, "ana", START).unwrap();
    assert!(!opens(first, renewed));
}
