//! Badges as people say them: "green: owl, kite, anchor, bell", or in Greek, without accents, with a slip, in another
//! order, or without what was forgotten.

use paros_core::badge::{Badge, BadgeColour, Language, Pictogram};

use crate::limits::{LEAST_HEARD, MAX_SLIPS};

/// The parts of a badge that were understood: a colour, pictograms, or both.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct HeardBadge {
    colour: Option<BadgeColour>,
    pictograms: Vec<Pictogram>,
    /// Words that are neither.
    pub unknown: Vec<String>,
}

/// A badge compared with what was said of it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BadgeComparison {
    /// The pictograms that are in the badge, in the order in which they were said.
    pub right: Vec<Pictogram>,
    /// The pictograms that aren't.
    pub wrong: Vec<Pictogram>,
    /// `true` if the right ones were said in the badge's order.
    pub is_in_order: bool,
    /// `true` if the badge has the colour that was said, or none was.
    pub is_colour_right: bool,
}

/// Why words are no badge.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum WordsFault {
    /// A word that is neither a colour nor a pictogram, and none that is.
    #[error("\"{0}\" is no colour and no picture of a badge")]
    UnknownWord(String),
    /// More than one colour.
    #[error("{0} colours; expected one")]
    Colours(usize),
    /// Not one to four pictograms.
    #[error("{0} pictures; expected one to four")]
    Pictograms(usize),
}

/// What a word is.
#[derive(Clone, Copy)]
enum Meaning {
    Colour(BadgeColour),
    Pictogram(Pictogram),
}

impl HeardBadge {
    /// Reads words in either language, or in both: a colour anywhere, or none, and up to four pictograms in any order. A letter or
    /// two may be wrong, missing or too many, and one of a thing may be several of it.
    ///
    /// # Errors
    /// Too many colours or pictograms; or none of them, then the first unknown word.
    pub fn parse(text: &str) -> Result<Self, WordsFault> {
        let (mut colours, mut pictograms, mut unknown) = (Vec::new(), Vec::new(), Vec::new());
        // An accent may come as a letter of its own.
        let text: String = text.chars().filter(|letter| !ACCENTS.contains(letter)).collect();
        for word in text.split(|letter: char| !letter.is_alphabetic()) {
            let folded = fold(word);
            if folded.chars().count() < 2 || FILLERS.contains(&folded.as_str()) {
                continue;
            }
            match find_meaning(&folded) {
                Some(Meaning::Colour(colour)) => colours.push(colour),
                Some(Meaning::Pictogram(pictogram)) => pictograms.push(pictogram),
                None => unknown.push(word.to_owned()),
            }
        }
        if colours.len() > 1 {
            return Err(WordsFault::Colours(colours.len()));
        }
        if pictograms.len() > 4 {
            return Err(WordsFault::Pictograms(pictograms.len()));
        }
        if colours.is_empty() && pictograms.is_empty() {
            let fault = WordsFault::Pictograms(0);
            return Err(unknown.into_iter().next().map_or(fault, WordsFault::UnknownWord));
        }
        Ok(HeardBadge { colour: colours.first().copied(), pictograms, unknown })
    }

    /// Makes a badge of which a colour and pictograms are known.
    #[must_use]
    pub const fn new(colour: Option<BadgeColour>, pictograms: Vec<Pictogram>) -> Self {
        HeardBadge { colour, pictograms, unknown: Vec::new() }
    }

    /// The colour, if one was said.
    #[must_use]
    pub const fn colour(&self) -> Option<BadgeColour> {
        self.colour
    }

    /// The pictograms, in the order in which they were said.
    #[must_use]
    pub fn pictograms(&self) -> &[Pictogram] {
        &self.pictograms
    }

    /// `true` if there are pictograms enough to look for the badges that may be meant.
    #[must_use]
    pub const fn is_nearly_whole(&self) -> bool {
        self.pictograms.len() >= LEAST_HEARD
    }

    /// The badge, where a colour and four pictograms were said. Whether its check fits is not looked at.
    #[must_use]
    pub fn badge(&self) -> Option<Badge> {
        let pictograms = self.pictograms.as_slice().try_into().ok()?;
        Some(Badge { colour: self.colour?, pictograms })
    }

    /// Right badges that have three of the pictograms at least, in any order: first those at the fewest mistakes. Some
    /// hundreds, as without a colour any of the eight may be meant.
    #[must_use]
    pub(crate) fn candidates(&self) -> Vec<Badge> {
        let heard = &self.pictograms;
        let mut candidates: Vec<Badge> = Vec::new();
        let places = 0..heard.len();
        let orders = places.clone().flat_map(|a| {
            let others = places.clone().filter(move |b| *b != a);
            others.flat_map(move |b| (0..heard.len()).map(move |c| [a, b, c]))
        });
        for [a, b, c] in orders.filter(|[a, b, c]| c != a && c != b) {
            for missing in 0..4 {
                for colour in BadgeColour::ALL {
                    let mut three = [heard[a], heard[b], heard[c]].into_iter();
                    let pictograms = [0, 1, 2, 3].map(|place| {
                        let known = if place == missing { None } else { three.next() };
                        known.unwrap_or(heard[a])
                    });
                    candidates.extend(complete(Badge { colour, pictograms }, missing));
                }
            }
        }
        candidates.sort_by_key(|badge| (self.mistakes(badge), badge.colour, badge.pictograms));
        candidates.dedup();
        candidates
    }

    /// Compares what was said with a badge.
    #[must_use]
    pub fn compare(&self, badge: &Badge) -> BadgeComparison {
        let mut left = badge.pictograms.to_vec();
        let (mut right, mut wrong) = (Vec::new(), Vec::new());
        for pictogram in &self.pictograms {
            if let Some(place) = left.iter().position(|other| other == pictogram) {
                right.push(left.remove(place));
            } else {
                wrong.push(*pictogram);
            }
        }
        let mut rest = badge.pictograms.iter();
        let is_in_order = right.iter().all(|pictogram| rest.any(|other| other == pictogram));
        let is_colour_right = self.colour.is_none_or(|colour| colour == badge.colour);
        BadgeComparison { right, wrong, is_in_order, is_colour_right }
    }

    /// Returns `true` if a badge has the colour and all pictograms.
    pub(crate) fn is_part_of(&self, badge: &Badge) -> bool {
        let BadgeComparison { wrong, is_colour_right, .. } = self.compare(badge);
        wrong.is_empty() && is_colour_right
    }

    /// Counts what is otherwise in a badge: its colour, each pictogram that wasn't said, and the order.
    fn mistakes(&self, badge: &Badge) -> usize {
        let BadgeComparison { right, is_in_order, is_colour_right, .. } = self.compare(badge);
        4 - right.len() + usize::from(!is_in_order) + usize::from(!is_colour_right)
    }
}

impl From<Badge> for HeardBadge {
    fn from(badge: Badge) -> Self {
        HeardBadge::new(Some(badge.colour), badge.pictograms.to_vec())
    }
}

/// Returns a bit for each pictogram's number.
pub(crate) fn picture_bits(pictograms: &[Pictogram]) -> u64 {
    pictograms.iter().fold(0, |bits, pictogram| bits | 1 << pictogram.number())
}

/// The right badge that differs from one at a place at most.
fn complete(badge: Badge, place: usize) -> Option<Badge> {
    let with = |pictogram| {
        let mut badge = badge;
        badge.pictograms[place] = pictogram;
        badge
    };
    Pictogram::all().map(with).find(Badge::is_valid)
}

/// Words between those of a badge.
const FILLERS: [&str; 22] = [
    "an", "the", "and", "with", "on", "it", "is", "was", "και", "ενα", "ενασ", "εναν", "μια", "με",
    "το", "τον", "την", "τη", "τα", "οι", "σε", "ηταν",
];

/// Accents of Greek letters that are written as letters of their own.
const ACCENTS: [char; 3] = ['\u{301}', '\u{308}', '\u{384}'];

/// The meaning of a word: the only one that is nearest to it.
fn find_meaning(folded: &str) -> Option<Meaning> {
    let colours = BadgeColour::ALL.into_iter().map(Meaning::Colour);
    let all = colours.chain(Pictogram::all().map(Meaning::Pictogram));
    let distance = |meaning: &Meaning| {
        let names = Language::ALL.map(|language| distance(folded, &fold(meaning.name(language))));
        names.into_iter().flatten().min()
    };
    let mut near: Vec<(usize, Meaning)> =
        all.filter_map(|meaning| Some((distance(&meaning)?, meaning))).collect();
    near.sort_by_key(|(distance, _)| *distance);
    match near[..] {
        [(_, only)] => Some(only),
        [(first, nearest), (second, _), ..] if first < second => Some(nearest),
        _ => None,
    }
}

/// How far a word is from a name; `None` where it is too far to mean it. Short words are near to others' slips.
fn distance(word: &str, name: &str) -> Option<usize> {
    if word == name {
        return Some(0);
    }
    if is_form_of(word, name) || is_form_of(name, word) || stem(word) == stem(name) {
        return Some(1);
    }
    let most = match word.chars().count() {
        0..=3 => 0,
        4..=6 => 1,
        _ => MAX_SLIPS,
    };
    let slips = strsim::osa_distance(name, word);
    (slips <= most).then_some(slips + 1)
}

/// Whether an English word is several of what another one is.
fn is_form_of(many: &str, one: &str) -> bool {
    const ENDINGS: [(&str, &str); 6] =
        [("s", ""), ("es", ""), ("ies", "y"), ("ves", "f"), ("men", "man"), ("i", "us")];
    ENDINGS.iter().any(|(of_many, of_one)| {
        let stem = many.strip_suffix(of_many);
        stem.is_some_and(|stem| stem.is_ascii() && one.strip_suffix(of_one) == Some(stem))
    })
}

/// A Greek word without what case, gender and number change.
fn stem(word: &str) -> &str {
    const ENDINGS: [&str; 22] = [
        "ατων", "ατοσ", "ατα", "ιουσ", "ιων", "ιεσ", "ουσ", "ων", "ια", "εσ", "οι", "οσ", "ησ",
        "ασ", "ου", "ο", "α", "η", "ι", "υ", "ε", "ω",
    ];
    let stems = ENDINGS.iter().filter_map(|ending| word.strip_suffix(ending));
    stems.into_iter().find(|stem| stem.chars().count() >= 3).unwrap_or(word)
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
