//! The badge's code in both directions, and its detection of every single mistake.

use std::collections::HashSet;

use paros_core::badge::{
    Badge, BadgeColour, BadgeNumber, LEASED_NUMBERS, Language, NUMBERS_OF_COLOUR, Pictogram,
    WrongBadge, write_words,
};
use paros_core::limits::BLOCK_NUMBERS;
use paros_models::badge::{count_shared, list_mistakes, multiply, sum_check};
use paros_models::cases::random_cases;
use proptest::prelude::*;

fn badge_of(number: u32) -> Badge {
    BadgeNumber::new(number).expect("a number").badge()
}

fn any_badge() -> impl Strategy<Value = Badge> {
    let pictograms = prop::array::uniform4(0..64u8);
    (0..8usize, pictograms).prop_map(|(colour, pictograms)| Badge {
        colour: BadgeColour::ALL[colour],
        pictograms: pictograms.map(|number| Pictogram::new(number).expect("a pictogram")),
    })
}

/// A strategy for pairs of numbers, adjacent or far apart.
fn any_pair() -> impl Strategy<Value = (u32, u32)> {
    let number = 0..BadgeNumber::COUNT;
    let far = (number.clone(), number.clone());
    let near = (number, 1..100u32).prop_map(|(n, by)| (n, (n + by) % BadgeNumber::COUNT));
    prop_oneof![far, near]
}

#[test]
fn every_number_has_a_badge_of_its_own_and_comes_back() {
    for number in 0..BadgeNumber::COUNT {
        let badge = badge_of(number);
        assert_eq!(badge.number().map(BadgeNumber::get), Ok(number), "{badge:?}");
    }
    assert_eq!(BadgeNumber::new(BadgeNumber::COUNT), None);
    assert_eq!(Pictogram::new(64), None);
}

#[test]
fn the_colour_tells_what_is_provisional() {
    for (i, colour) in (0..).zip(BadgeColour::ALL) {
        let ends = [i * NUMBERS_OF_COLOUR, (i + 1) * NUMBERS_OF_COLOUR - 1];
        for number in ends.map(|n| BadgeNumber::new(n).expect("a number")) {
            assert_eq!((number.colour(), number.badge().colour), (colour, colour));
            assert_eq!(number.is_provisional(), colour.is_provisional());
        }
    }
    assert!(BadgeNumber::new(LEASED_NUMBERS).is_some_and(BadgeNumber::is_provisional));
    assert!(BadgeNumber::provisional(u32::MAX).get() < BadgeNumber::COUNT);
    assert_eq!(BadgeNumber::provisional(5).get(), LEASED_NUMBERS + 5);
}

/// Any two numbers of a block have no pictogram in common at the same place, as one headset shows them one
/// after the other. The test checks every 61st block of all colours; the rest follow because the code is
/// linear.
#[test]
fn numbers_of_a_block_have_no_pictogram_in_common() {
    let block = BLOCK_NUMBERS as u32;
    for first in (0..BadgeNumber::COUNT).step_by(BLOCK_NUMBERS * 61) {
        let badges: Vec<_> = (first..first + block).map(badge_of).collect();
        for (i, a) in badges.iter().enumerate() {
            assert!(badges[..i].iter().all(|b| count_shared(a, b) == 0), "the block of {first}");
        }
    }
}

#[test]
fn a_number_and_the_next_have_nothing_in_common_within_a_block_and_at_most_one_beyond() {
    let mut worst = [0; 2];
    for number in 1..BadgeNumber::COUNT {
        let is_first = number.is_multiple_of(BLOCK_NUMBERS as u32);
        let shared = count_shared(&badge_of(number - 1), &badge_of(number));
        worst[usize::from(is_first)] = worst[usize::from(is_first)].max(shared);
    }
    assert_eq!(worst, [0, 1]);
}

#[test]
fn the_check_is_the_models() {
    for a in 0..64 {
        for b in 0..64 {
            // The check is a weighted sum: with a single non-zero pictogram it is that pictogram times 1, 2,
            // 4 or 8.
            let alone = |place: usize, number: u8| {
                let mut pictograms = [Pictogram::new(0).expect("a pictogram"); 4];
                pictograms[place] = Pictogram::new(number).expect("a pictogram");
                Badge { colour: BadgeColour::Red, pictograms }
            };
            (0..4)
                .for_each(|place| assert_eq!(sum_check(&alone(place, a)), multiply(1 << place, a)));
            let mut both = alone(0, a);
            both.pictograms[1] = Pictogram::new(b).expect("a pictogram");
            assert_eq!(both.is_valid(), sum_check(&both) == 0);
        }
    }
}

/// Proves by the weights, for all badges at once: a mistake changes the sum by a product of two non-zero
/// factors.
#[test]
fn no_single_mistake_keeps_the_sum() {
    let weights = [1, 2, 4, 8];
    for difference in 1..64 {
        for (k, weight) in weights.iter().enumerate() {
            assert_ne!(multiply(*weight, difference), 0, "another pictogram");
            if k > 0 {
                assert_ne!(multiply(weight ^ weights[k - 1], difference), 0, "a swap");
            }
        }
    }
}

proptest! {
    #![proptest_config(random_cases(2000))]

    #[test]
    fn a_badge_is_valid_where_the_models_sum_is_zero(badge in any_badge()) {
        prop_assert_eq!(badge.is_valid(), sum_check(&badge) == 0);
        match badge.number() {
            Ok(number) => prop_assert_eq!(number.badge(), badge),
            Err(wrong) => prop_assert_eq!(wrong, WrongBadge { badge }),
        }
    }

    #[test]
    fn two_badges_have_at_most_two_pictograms_in_common((a, b) in any_pair()) {
        prop_assume!(a != b);
        let shared = count_shared(&badge_of(a), &badge_of(b));
        let digits = |n: u32| [n & 63, n >> 6 & 63, n >> 12 & 63, n >> 18];
        let differing = digits(a).iter().zip(digits(b)).filter(|(x, y)| **x != *y).count();
        prop_assert!(shared < differing, "{} shared, {} differ", shared, differing);
        prop_assert!(shared <= 2 || badge_of(a).colour != badge_of(b).colour);
    }
}

proptest! {
    #![proptest_config(random_cases(300))]

    #[test]
    fn every_single_mistake_is_caught_and_the_right_badge_is_a_candidate(
        number in 0..BadgeNumber::COUNT,
    ) {
        let right = badge_of(number);
        prop_assert!(right.nearest_candidates().is_empty());
        for wrong in list_mistakes(&right) {
            prop_assert!(wrong.number().is_err(), "{:?} for {:?}", wrong, right);
            prop_assert!(wrong.nearest_candidates().contains(&right), "{:?} for {:?}", wrong, right);
        }
    }

    #[test]
    fn the_candidates_are_all_valid_badges_at_one_mistake(badge in any_badge()) {
        prop_assume!(!badge.is_valid());
        let candidates = badge.nearest_candidates();
        let mut expected: Vec<_> = list_mistakes(&badge);
        expected.retain(|other| sum_check(other) == 0);
        let found: HashSet<_> = candidates.iter().copied().collect();
        prop_assert_eq!(found.len(), candidates.len(), "one twice");
        prop_assert_eq!(&found, &expected.into_iter().collect());
        // Swaps come before wrong colours.
        let kind = |other: &Badge| {
            let differing = 4 - count_shared(other, &badge);
            if differing == 2 { 0 } else { 1 + differing }
        };
        prop_assert!(candidates.is_sorted_by_key(kind), "{:?}", candidates);
    }
}

fn words_of(number: u32, language: Language) -> String {
    let mut words = String::new();
    write_words(&mut words, &badge_of(number), language).expect("a string takes all");
    words
}

#[test]
fn a_badge_is_said_in_words() {
    assert_eq!(words_of(0, Language::English), "red: pizza, mushroom, rocket, chair");
    assert_eq!(words_of(123_456, Language::English), "red: chair, snowman, butterfly, bicycle");
    assert_eq!(
        words_of(123_456, Language::Greek),
        "κόκκινο: καρέκλα, χιονάνθρωπος, πεταλούδα, ποδήλατο"
    );
}

#[test]
fn names_differ_in_two_letters_at_least() {
    for language in Language::ALL {
        let pictograms = Pictogram::all().map(|pictogram| pictogram.name(language));
        let names: Vec<_> =
            pictograms.chain(BadgeColour::ALL.map(|colour| colour.name(language))).collect();
        for (i, a) in names.iter().enumerate() {
            assert!(!a.is_empty() && a.chars().all(|c| c.is_lowercase()), "{a}");
            for b in &names[..i] {
                assert!(edit_distance(a, b) >= 2, "{a}, {b}");
            }
        }
    }
}

/// Returns the Levenshtein distance of two words, ignoring accents.
fn edit_distance(a: &str, b: &str) -> usize {
    let letters = |word: &str| -> Vec<char> {
        let plain = |c| match c {
            'ά' => 'α',
            'έ' => 'ε',
            'ή' => 'η',
            'ί' => 'ι',
            'ό' => 'ο',
            'ύ' => 'υ',
            'ώ' => 'ω',
            _ => c,
        };
        word.chars().map(plain).collect()
    };
    let (a, b) = (letters(a), letters(b));
    let mut row: Vec<_> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let exchanged = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = exchanged.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
