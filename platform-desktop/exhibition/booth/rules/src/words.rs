//! Parses badges as people say them: "green: owl, kite, anchor, bell", or in Greek; also without accents,
//! with typing errors, in another order, or incomplete.

use paros_core::badge::{Badge, BadgeColour, Language, Pictogram};

use crate::limits::{LEAST_HEARD, MAX_SLIPS};

/// The recognised parts of a badge: a colour, pictograms, or both.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct HeardBadge {
    colour: Option<BadgeColour>,
    pictograms: Vec<Pictogram>,
    /// The words that weren't recognised.
    pub unknown: Vec<String>,
}

/// The comparison of a badge with its description.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BadgeComparison {
    /// The pictograms of the description that the badge has, in the order of the description.
    pub right: Vec<Pictogram>,
    /// The pictograms of the description that the badge doesn't have.
    pub wrong: Vec<Pictogram>,
    /// `true` if the right pictograms are in the badge's order.
    pub is_in_order: bool,
    /// `true` if the badge has the described colour, or no colour was described.
    pub is_colour_right: bool,
}

/// The reason why a description isn't a badge.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum WordsFault {
    /// No word was recognised. Holds the first unknown word.
    #[error("\"{0}\" is no colour and no picture of a badge")]
    UnknownWord(String),
    /// More than one colour.
    #[error("{0} colours; expected one")]
    Colours(usize),
    /// The number of pictograms isn't 1 to 4.
    #[error("{0} pictures; expected one to four")]
    Pictograms(usize),
}

/// The meaning of a word.
#[derive(Clone, Copy)]
enum Meaning {
    Colour(BadgeColour),
    Pictogram(Pictogram),
}

impl HeardBadge {
    /// Parses words in either language, or in both: up to one colour and up to four pictograms, in any order.
    /// Tolerates one or two wrong, missing or additional letters, and plurals.
    ///
    /// # Errors
    /// Too many colours or pictograms. If nothing was recognised, the first unknown word.
    pub fn parse(text: &str) -> Result<Self, WordsFault> {
        let (mut colours, mut pictograms, mut unknown) = (Vec::new(), Vec::new(), Vec::new());
        // Accents may be separate (combining) characters.
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

    /// Makes a description of a known colour and known pictograms.
    #[must_use]
    pub const fn new(colour: Option<BadgeColour>, pictograms: Vec<Pictogram>) -> Self {
        HeardBadge { colour, pictograms, unknown: Vec::new() }
    }

    /// Returns the colour, if there is one.
    #[must_use]
    pub const fn colour(&self) -> Option<BadgeColour> {
        self.colour
    }

    /// Returns the pictograms, in the order of the description.
    #[must_use]
    pub fn pictograms(&self) -> &[Pictogram] {
        &self.pictograms
    }

    /// `true` if there are enough pictograms to search similar badges.
    #[must_use]
    pub const fn is_nearly_whole(&self) -> bool {
        self.pictograms.len() >= LEAST_HEARD
    }

    /// Returns the badge if there are a colour and four pictograms. Doesn't verify its check pictogram.
    #[must_use]
    pub fn badge(&self) -> Option<Badge> {
        let pictograms = self.pictograms.as_slice().try_into().ok()?;
        Some(Badge { colour: self.colour?, pictograms })
    }

    /// Returns the valid badges with at least three of the pictograms, in any order, sorted by the number of
    /// mistakes. These are some hundreds, as any of the eight colours is tried.
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

    /// Compares the description with a badge.
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

    /// Returns `true` if a badge has the described colour and all described pictograms.
    pub(crate) fn is_part_of(&self, badge: &Badge) -> bool {
        let BadgeComparison { wrong, is_colour_right, .. } = self.compare(badge);
        wrong.is_empty() && is_colour_right
    }

    /// Counts the differences to a badge: the colour, each missing pictogram, and the order.
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

/// Returns the set of pictograms as bits: bit N for pictogram number N.
pub(crate) fn picture_bits(pictograms: &[Pictogram]) -> u64 {
    pictograms.iter().fold(0, |bits, pictogram| bits | 1 << pictogram.number())
}

/// Finds the valid badge that equals `badge` except at one place.
fn complete(badge: Badge, place: usize) -> Option<Badge> {
    let with = |pictogram| {
        let mut badge = badge;
        badge.pictograms[place] = pictogram;
        badge
    };
    Pictogram::all().map(with).find(Badge::is_valid)
}

/// Words to ignore in a description.
const FILLERS: [&str; 22] = [
    "an", "the", "and", "with", "on", "it", "is", "was", "και", "ενα", "ενασ", "εναν", "μια", "με",
    "το", "τον", "την", "τη", "τα", "οι", "σε", "ηταν",
];

/// Greek accents as separate characters.
const ACCENTS: [char; 3] = ['\u{301}', '\u{308}', '\u{384}'];

/// Returns the meaning whose name is nearest to a word; `None` for a tie, or if no name is near enough.
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

/// Returns the distance of a word from a name; `None` if it is too far. Short words tolerate fewer errors, as
/// names of few letters are close to each other.
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

/// Returns `true` if `many` is an English plural of `one`.
fn is_form_of(many: &str, one: &str) -> bool {
    const ENDINGS: [(&str, &str); 6] =
        [("s", ""), ("es", ""), ("ies", "y"), ("ves", "f"), ("men", "man"), ("i", "us")];
    ENDINGS.iter().any(|(of_many, of_one)| {
        let stem = many.strip_suffix(of_many);
        stem.is_some_and(|stem| stem.is_ascii() && one.strip_suffix(of_one) == Some(stem))
    })
}

/// Returns a Greek word without its ending of case, gender and number.
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

/// Returns the word in lower case, without Greek accents and with a single form of sigma.
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
