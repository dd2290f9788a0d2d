//! Badges as people say them: "green: owl, kite, anchor, bell", or in Greek, without accents and with a slip.

use std::fmt;

use paros_core::badge::{Badge, BadgeColour, Language, Pictogram};

/// Why words are no badge.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum WordsFault {
    /// A word that is neither a colour nor a pictogram.
    UnknownWord(String),
    /// No colour, or more than one.
    Colours(usize),
    /// Not four pictograms.
    Pictograms(usize),
}

/// What a word is.
#[derive(Clone, Copy)]
enum Meaning {
    Colour(BadgeColour),
    Pictogram(Pictogram),
}

/// Reads a badge of words in either language, or in both: a colour anywhere, and four pictograms in their order. A
/// letter may be wrong, missing or too many. Whether the check fits is not looked at.
///
/// # Errors
/// The first word that is unknown, or what is missing or too much.
pub fn parse_badge_words(text: &str) -> Result<Badge, WordsFault> {
    let (mut colours, mut pictograms) = (Vec::new(), Vec::new());
    for word in text.split(|letter: char| !letter.is_alphabetic()) {
        let folded = fold(word);
        if folded.is_empty() || FILLERS.contains(&folded.as_str()) {
            continue;
        }
        match find_meaning(&folded).ok_or_else(|| WordsFault::UnknownWord(word.to_owned()))? {
            Meaning::Colour(colour) => colours.push(colour),
            Meaning::Pictogram(pictogram) => pictograms.push(pictogram),
        }
    }
    let [colour] = colours[..] else { return Err(WordsFault::Colours(colours.len())) };
    let wrong = |pictograms: Vec<_>| WordsFault::Pictograms(pictograms.len());
    Ok(Badge { colour, pictograms: pictograms.try_into().map_err(wrong)? })
}

/// Words between those of a badge.
const FILLERS: [&str; 10] = ["a", "an", "the", "and", "και", "ενα", "ενας", "μια", "ο", "η"];

/// The meaning of a word: the word itself, or the only one at a letter from it.
fn find_meaning(folded: &str) -> Option<Meaning> {
    let colours = BadgeColour::ALL.into_iter().map(Meaning::Colour);
    let all: Vec<Meaning> = colours.chain(Pictogram::all().map(Meaning::Pictogram)).collect();
    let at_distance = |most: usize| {
        let mut near = all.iter().copied().filter(|meaning| {
            Language::ALL.iter().any(|&language| {
                let name = fold(meaning.name(language));
                // Short words are too near to others' slips.
                name == folded
                    || most > 0
                        && folded.chars().count() > 3
                        && strsim::osa_distance(&name, folded) <= most
            })
        });
        near.next().filter(|_| near.next().is_none())
    };
    at_distance(0).or_else(|| at_distance(1))
}

impl Meaning {
    const fn name(self, language: Language) -> &'static str {
        match self {
            Meaning::Colour(colour) => colour.name(language),
            Meaning::Pictogram(pictogram) => pictogram.name(language),
        }
    }
}

/// Small letters without Greek accents, and one sigma.
fn fold(word: &str) -> String {
    let without_accent = |letter: char| match letter {
        'ά' => 'α',
        'έ' => 'ε',
        'ή' => 'η',
        'ί' | 'ϊ' | 'ΐ' => 'ι',
        'ό' => 'ο',
        'ύ' | 'ϋ' | 'ΰ' => 'υ',
        'ώ' => 'ω',
        'ς' => 'σ',
        other => other,
    };
    word.chars().flat_map(char::to_lowercase).map(without_accent).collect()
}

impl fmt::Display for WordsFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WordsFault::UnknownWord(word) => {
                write!(f, "\"{word}\" is no colour and no picture of a badge")
            }
            WordsFault::Colours(count) => write!(f, "{count} colours; expected one"),
            WordsFault::Pictograms(count) => write!(f, "{count} pictures; expected four"),
        }
    }
}

impl std::error::Error for WordsFault {}
