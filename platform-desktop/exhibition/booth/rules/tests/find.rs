//! Searches for sculptures, by staff and by visitors.

use super::common::*;
use paros_booth_rules::{BadgeComparison, FoundByBadge, HeardBadge, LinkToken, WordsFault};
use paros_core::badge::{Badge, BadgeColour, BadgeNumber, Language, Pictogram, write_words};
use paros_protocol::SculptureId;
use proptest::prelude::*;

fn found(rig: &Rig, badge: &Badge) -> Vec<SculptureId> {
    match rig.booth.find_by_badge(&(*badge).into()).unwrap() {
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
    let provisional = BadgeNumber::provisional(77);
    let held = rig.lease(&device, 1, START)[0];
    let own = Parcel::of_block(1, &held, 9);
    let number = own.facts.badge.expect("a number");
    rig.upload(&device, &own, START).unwrap();
    for (k, badge) in
        [leased(10), Some(provisional), Some(provisional), None].into_iter().enumerate()
    {
        let parcel = Parcel::new(k as u8 + 2, badge);
        rig.upload(&device, &parcel, seconds(k as u64 + 1)).unwrap();
    }
    let id = |byte| SculptureId([byte; 16]);
    assert_eq!(found(&rig, &number.badge()), [id(1)]);
    assert_eq!(found(&rig, &provisional.badge()), [id(4), id(3)], "the newest first");
    assert_eq!(found(&rig, &leased(11).unwrap().badge()), []);
    // A sculpture with a lapsed badge comes last, though it is newer.
    rig.upload(&other, &Parcel::new(50, Some(number)), seconds(50)).unwrap();
    assert_eq!(found(&rig, &number.badge()), [id(1), id(50)]);
    let newest = rig.list(false);
    assert_eq!(newest[..2].iter().map(|kept| kept.id[0]).collect::<Vec<_>>(), [50, 5]);
}

#[test]
fn a_badge_is_compared_with_what_was_said_of_it() {
    let badge = BadgeNumber::new(77).expect("a number").badge();
    let [a, b, c, _] = badge.pictograms;
    let other = Pictogram::all().find(|shown| !badge.pictograms.contains(shown)).unwrap();
    let other_colour = BadgeColour::ALL.into_iter().find(|colour| *colour != badge.colour);
    for (colour, said, right, wrong, is_in_order, is_colour_right) in [
        (None, vec![a, b, c], vec![a, b, c], vec![], true, true),
        (Some(badge.colour), vec![b, a, other], vec![b, a], vec![other], false, true),
        (other_colour, vec![other, c], vec![c], vec![other], true, false),
        // No badge has a picture twice.
        (None, vec![a, a], vec![a], vec![a], true, true),
    ] {
        let compared = HeardBadge::new(colour, said).compare(&badge);
        assert_eq!(compared, BadgeComparison { right, wrong, is_in_order, is_colour_right });
    }
}

#[test]
fn a_wrong_badge_finds_the_nearest_that_something_has() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    rig.upload(&device, &Parcel::new(1, leased(9)), START).unwrap();
    let announced = Parcel::new(2, leased(700)).announcement(paros_protocol::UploadStatus::Kept);
    rig.beat(&device, &announcing(&heartbeat(device.headset), &[announced]), START);
    for number in [9, 700] {
        let right = leased(number).unwrap().badge();
        let mut swapped = right;
        swapped.pictograms.swap(1, 2);
        match rig.booth.find_by_badge(&swapped.into()).unwrap() {
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
        for words in [words.clone(), words.to_uppercase()] {
            let heard = HeardBadge::parse(&words).unwrap();
            prop_assert_eq!((heard.badge(), heard.unknown.len()), (Some(badge), 0));
        }
    }

    #[test]
    fn no_words_panic(text in ".{0,80}") {
        let _ = HeardBadge::parse(&text);
    }
}

fn read(words: &str) -> Option<Badge> {
    HeardBadge::parse(words).unwrap().badge()
}

#[test]
fn words_are_read_with_a_slip() {
    let badge = read("red: pizza, mushroom, rocket, chair");
    assert!(badge.is_some());
    for words in [
        "pizza mushroom rocket chair red",
        "a piza and a mushrom, the roket, chairs - red",
        "κοκκινο πιτσα μανιταρι πυραυλος καρεκλα",
        "ΚΌΚΚΙΝΟ: πίτσα, mushroom, πύραυλος και καρέκλα",
        "μια κόκκινη πίτσα, μανιτάρια, ένας πύραυλος και δύο καρέκλες",
        "κο\u{301}κκινο πι\u{301}τσα μανιτα\u{301}ρι πυ\u{301}ραυλος καρε\u{301}κλα",
    ] {
        assert_eq!(read(words), badge, "{words}");
    }
    let unknown = WordsFault::UnknownWord("dragon".into());
    assert_eq!(HeardBadge::parse("a dragon and a wizard"), Err(unknown));
    let heard = HeardBadge::parse("red pizza dragon rocket chair").unwrap();
    assert_eq!((heard.badge(), heard.unknown), (None, vec!["dragon".to_owned()]));
    let parse = |words| HeardBadge::parse(words).map(drop);
    assert_eq!(parse("pizza mushroom rocket chair"), Ok(()));
    assert_eq!(parse("red blue pizza"), Err(WordsFault::Colours(2)));
    assert_eq!(parse("with the"), Err(WordsFault::Pictograms(0)));
    assert_eq!(parse("owl cat fish snail duck"), Err(WordsFault::Pictograms(5)));
}

#[test]
fn a_part_of_a_badge_is_understood() {
    for (words, colour, pictures, is_nearly_whole) in [
        ("pizza", None, 1, false),
        ("κόκκινο", Some(BadgeColour::Red), 0, false),
        ("a red badge, mushroom and pizza", Some(BadgeColour::Red), 2, false),
        ("pizza mushroom rocket", None, 3, true),
    ] {
        let heard = HeardBadge::parse(words).unwrap();
        assert_eq!((heard.colour(), heard.pictograms().len()), (colour, pictures), "{words}");
        assert_eq!((heard.badge(), heard.is_nearly_whole()), (None, is_nearly_whole), "{words}");
    }
}

/// Plurals and other spoken forms mean the same picture.
#[test]
fn several_of_a_thing_are_the_thing() {
    const ENGLISH: &str = "owls cats fishes snails butterflies ducks rabbits snakes turtles spiders whales elephants \
        crabs trees leaves flowers mushrooms cacti suns moons stars clouds lightnings mountains drops fires snowmen \
        apples bananas cherries carrots cakes pizzas cups bottles kites anchors bells keys umbrellas crowns glass \
        books scissor hammers ladders clocks bones balloons drums guitars hearts flags houses castles buses ships \
        rockets bicycles aeroplanes forks chairs hands ghosts";
    const GREEK: &str = "κουκουβάγιες γάτες ψάρια σαλιγκάρια πεταλούδες πάπιες κουνέλια φίδια χελώνες αράχνες φάλαινες \
        ελέφαντες κάβουρες δέντρα φύλλα λουλούδια μανιτάρια κάκτους ήλιο φεγγάρια αστέρια σύννεφα αστραπές βουνά \
        σταγόνες φωτιές χιονάνθρωπο μήλα μπανάνες κεράσια καρότα τούρτες πίτσες φλιτζάνια μπουκάλια χαρταετοί άγκυρες \
        καμπάνες κλειδιά ομπρέλες κορώνες γυαλί βιβλία ψαλίδια σφυριά σκάλες ρολόγια κόκαλα μπαλόνια τύμπανα κιθάρες \
        καρδιές σημαίες σπίτια κάστρα λεωφορεία πλοία πύραυλους ποδήλατα αεροπλάνα πιρούνια καρέκλες χέρια φαντάσματα";
    let pictograms: Vec<Pictogram> = Pictogram::all().collect();
    for said in [ENGLISH, GREEK] {
        let said: Vec<&str> = said.split_whitespace().collect();
        assert_eq!(said.len(), pictograms.len());
        for (four, shown) in said.chunks(4).zip(pictograms.chunks(4)) {
            let badge = read(&format!("μαύρη {}", four.join(", ")));
            let badge = badge.unwrap_or_else(|| panic!("{four:?}"));
            assert_eq!(badge.pictograms, shown, "{four:?}");
        }
    }
}

/// Three of the four pictures are given, in any order, with or without the colour, in both languages.
#[test]
fn who_remembers_three_pictures_finds_the_sculpture() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    for number in 1..=40 {
        rig.upload(&device, &Parcel::new(number, leased(number.into())), START).unwrap();
    }
    let right = leased(9).unwrap().badge();
    for language in Language::ALL {
        let names = right.pictograms.map(|pictogram| pictogram.name(language));
        for forgotten in 0..4 {
            for order in [[0, 1, 2], [2, 0, 1], [2, 1, 0]] {
                let mut known: Vec<&str> = names.to_vec();
                known.remove(forgotten);
                let said = order.map(|k| known[k]).join(" ");
                for said in [said.clone(), format!("{said} {}", right.colour.name(language))] {
                    let heard = HeardBadge::parse(&said).unwrap();
                    match rig.booth.find_by_badge(&heard).unwrap() {
                        FoundByBadge::Nearest(nearest) => {
                            assert_eq!(nearest.first().map(|near| near.0), Some(right), "{said}");
                        }
                        FoundByBadge::Exact(matches) => panic!("{said}: {matches:?}"),
                    }
                }
            }
        }
    }
}

#[test]
fn a_visitors_link_is_its_sculptures_until_it_is_taken_back() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcels = [1, 2].map(|id| Parcel::new(id, leased(id.into())));
    for parcel in &parcels {
        rig.upload(&device, parcel, START).unwrap();
    }
    let [first, second] = parcels.map(|parcel| parcel.id);
    let opens = |id, token| rig.booth.find_by_link(&id, &token).is_ok();
    let token = rig.booth.link_token(&first).unwrap();
    assert!(opens(first, token));
    assert!(!opens(second, token));
    for bit in 0..128 {
        let mut other = token;
        other.0[bit / 8] ^= 1 << (bit % 8);
        assert!(!opens(first, other));
    }
    assert!(!opens(SculptureId([3; 16]), LinkToken([0; 16])));
    assert!(rig.booth.link_token(&first).unwrap() == token, "printed again");
    rig.booth.revoke_link(&first, "ana", START).unwrap();
    assert!(!opens(first, token));
    assert_eq!(rig.booth.link_token(&first).err().map(|error| error.status()), Some(404));
    let renewed = rig.booth.renew_link(&first, "ana", START).expect("another");
    assert!(opens(first, renewed) && !opens(first, token));
    rig.booth.withdraw(&first, "ana", START).unwrap();
    assert!(!opens(first, renewed), "what is withdrawn is hidden from all");
    rig.booth.bring_back(&first, "ana", START).unwrap();
    assert!(opens(first, renewed));
    rig.booth.delete(&first, "ana", START).unwrap();
    assert!(!opens(first, renewed));
}
