//! The words of a badge as staff type or say them: read, or rejected with the unknown word named. The badge
//! that was read is unchanged by a round trip.

use paros_booth_rules::{HeardBadge, WordsFault};
use paros_core::badge::{Badge, BadgeNumber, Language, write_words};

use crate::engine::FuzzTarget;

/// The input is text; invalid UTF-8 is replaced, as in a browser's form.
pub(super) const WORDS: FuzzTarget = FuzzTarget {
    name: "words",
    seeds,
    words: &[b" and ", b", ", b": ", "\u{301}".as_bytes(), "ς".as_bytes(), b"\xff", b"a"],
    longest: 400,
    runs: 1_000,
    run,
};

fn seeds() -> Vec<Vec<u8>> {
    let numbers = [0, 1, 77, 1_000_003].map(|number| BadgeNumber::new(number).expect("a number"));
    let all = Language::ALL
        .iter()
        .flat_map(|language| numbers.map(|number| write(&number.badge(), *language).into_bytes()));
    all.collect()
}

fn write(badge: &Badge, language: Language) -> String {
    let mut words = String::new();
    write_words(&mut words, badge, language).expect("text");
    words
}

fn run(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let heard = match HeardBadge::parse(&text) {
        Ok(heard) => heard,
        Err(fault) => {
            if let WordsFault::UnknownWord(word) = &fault {
                check_is_said(&text, word);
            }
            return match fault {
                WordsFault::UnknownWord(_) => "unknown word".into(),
                WordsFault::Colours(count) => format!("{} colours", count > 0),
                WordsFault::Pictograms(count) => format!("{} pictograms", count.min(6)),
            };
        }
    };
    heard.unknown.iter().for_each(|word| check_is_said(&text, word));
    let Some(badge) = heard.badge() else { return "a part of a badge".into() };
    for &language in &Language::ALL {
        let again = HeardBadge::parse(&write(&badge, language)).map(|heard| heard.badge());
        assert_eq!(again, Ok(Some(badge)), "{text:?}");
    }
    match badge.number() {
        Ok(_) => "a badge".into(),
        Err(_) => {
            for candidate in badge.nearest_candidates() {
                assert!(candidate.number().is_ok() && candidate != badge, "{candidate:?}");
            }
            "a wrong badge".into()
        }
    }
}

/// Ignores accents that are separate characters.
fn check_is_said(text: &str, word: &str) {
    let plain: String =
        text.chars().filter(|letter| !"\u{301}\u{308}\u{384}".contains(*letter)).collect();
    assert!(plain.contains(word), "{word:?} isn't in {text:?}");
}
