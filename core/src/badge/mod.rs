//! Badges: what a visitor leaves with and says at the booth, four pictograms on a colour, and the leases by which no
//! badge is given out twice.
//!
//! Takes numbers, random bits, seconds and reports; gives badges, their words and shapes, and answers. Doesn't know
//! the network, files, clocks, or what a sculpture is: shells bring these.
//!
//! A badge shows 27 bits: 18 of its number, three of the colour, six of a check. The numbers of seven colours are
//! *leased*: the booth's [`BadgeLedger`] hands them to headsets in blocks of 64, each headset's [`BadgeLease`] uses
//! them in order. The eighth colour, black, is *provisional*: drawn at random where there is no lease, it may
//! repeat, and the booth then shows every sculpture with that badge.

mod code;
mod gf64;
mod words;

pub use code::{
    Badge, BadgeColour, BadgeNumber, LEASED_BLOCKS, LEASED_NUMBERS, NUMBERS_OF_COLOUR, Pictogram,
    WrongBadge,
};
pub use words::{BadgeLanguage, write_words};
