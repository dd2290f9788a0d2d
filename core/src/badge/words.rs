//! A badge in words: "green: owl, kite, anchor, bell".
//!
//! The nouns are words that a child knows, a single word in each language. Any two differ in at least two
//! letters, ignoring accents, so that a badge can be dictated on the telephone.

use core::fmt;

use crate::badge::code::{Badge, BadgeColour, Pictogram};

/// A language of visitors, used in panels and badges.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default, Debug)]
#[repr(u8)]
pub enum Language {
    /// British English.
    #[default]
    English,
    /// Modern Greek, with accents.
    Greek,
}

/// English and Greek names, indexed by [`BadgeColour`].
const COLOURS: [[&str; 2]; 8] = [
    ["red", "κόκκινο"],
    ["orange", "πορτοκαλί"],
    ["yellow", "κίτρινο"],
    ["green", "πράσινο"],
    ["blue", "μπλε"],
    ["pink", "ροζ"],
    ["white", "άσπρο"],
    ["black", "μαύρο"],
];

/// English and Greek names, indexed by the pictogram's number, like the shapes.
const PICTOGRAMS: [[&str; 2]; Pictogram::COUNT] = [
    ["owl", "κουκουβάγια"],
    ["cat", "γάτα"],
    ["fish", "ψάρι"],
    ["snail", "σαλιγκάρι"],
    ["butterfly", "πεταλούδα"],
    ["duck", "πάπια"],
    ["rabbit", "κουνέλι"],
    ["snake", "φίδι"],
    ["turtle", "χελώνα"],
    ["spider", "αράχνη"],
    ["whale", "φάλαινα"],
    ["elephant", "ελέφαντας"],
    ["crab", "κάβουρας"],
    ["tree", "δέντρο"],
    ["leaf", "φύλλο"],
    ["flower", "λουλούδι"],
    ["mushroom", "μανιτάρι"],
    ["cactus", "κάκτος"],
    ["sun", "ήλιος"],
    ["moon", "φεγγάρι"],
    ["star", "αστέρι"],
    ["cloud", "σύννεφο"],
    ["lightning", "αστραπή"],
    ["mountain", "βουνό"],
    ["drop", "σταγόνα"],
    ["fire", "φωτιά"],
    ["snowman", "χιονάνθρωπος"],
    ["apple", "μήλο"],
    ["banana", "μπανάνα"],
    ["cherry", "κεράσι"],
    ["carrot", "καρότο"],
    ["cake", "τούρτα"],
    ["pizza", "πίτσα"],
    ["cup", "φλιτζάνι"],
    ["bottle", "μπουκάλι"],
    ["kite", "χαρταετός"],
    ["anchor", "άγκυρα"],
    ["bell", "καμπάνα"],
    ["key", "κλειδί"],
    ["umbrella", "ομπρέλα"],
    ["crown", "κορώνα"],
    ["glasses", "γυαλιά"],
    ["book", "βιβλίο"],
    ["scissors", "ψαλίδι"],
    ["hammer", "σφυρί"],
    ["ladder", "σκάλα"],
    ["clock", "ρολόι"],
    ["bone", "κόκαλο"],
    ["balloon", "μπαλόνι"],
    ["drum", "τύμπανο"],
    ["guitar", "κιθάρα"],
    ["heart", "καρδιά"],
    ["flag", "σημαία"],
    ["house", "σπίτι"],
    ["castle", "κάστρο"],
    ["bus", "λεωφορείο"],
    ["ship", "πλοίο"],
    ["rocket", "πύραυλος"],
    ["bicycle", "ποδήλατο"],
    ["aeroplane", "αεροπλάνο"],
    ["fork", "πιρούνι"],
    ["chair", "καρέκλα"],
    ["hand", "χέρι"],
    ["ghost", "φάντασμα"],
];

impl Language {
    /// All languages, in the order of their numbers.
    pub const ALL: [Language; 2] = [Language::English, Language::Greek];
}

impl Pictogram {
    /// Returns the name of the picture, a word in lower case.
    #[must_use]
    pub const fn name(self, language: Language) -> &'static str {
        PICTOGRAMS[self.number()][language as usize]
    }
}

impl BadgeColour {
    /// Returns the name of the colour, a word in lower case.
    #[must_use]
    pub const fn name(self, language: Language) -> &'static str {
        COLOURS[self as usize][language as usize]
    }
}

/// Writes the colour, a colon and the four pictograms, in spoken order.
///
/// # Errors
/// Returns the error of `to`.
pub fn write_words(to: &mut impl fmt::Write, badge: &Badge, language: Language) -> fmt::Result {
    to.write_str(badge.colour.name(language))?;
    for (k, pictogram) in badge.pictograms.iter().enumerate() {
        to.write_str(if k == 0 { ": " } else { ", " })?;
        to.write_str(pictogram.name(language))?;
    }
    Ok(())
}
