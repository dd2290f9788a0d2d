//! Badges: the code that a visitor takes away and says at the booth, four pictograms on a coloured ground.
//!
//! Inputs: numbers. Outputs: badges, their words and shapes. Independent of the network, files, clocks and
//! sculptures, which are the shells' task.
//!
//! A badge shows 27 bits: 18 of its number, three of the colour, and six of a check. The numbers of seven
//! colours are *leased*: the booth assigns them to headsets in blocks of 64. The eighth colour, black, is
//! *provisional*: its numbers are drawn at random if there is no lease. They may repeat, and the booth then
//! shows every sculpture with that badge.
//!
//! ```
//! use paros_core::badge::{BadgeNumber, Language, write_words};
//!
//! let badge = BadgeNumber::of_block(0, 0).expect("a leased number").badge();
//! let mut words = String::new();
//! write_words(&mut words, &badge, Language::English)?;
//! assert_eq!(words, "red: pizza, mushroom, rocket, chair");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod code;
mod gf64;
mod shapes;
mod words;

pub use code::{
    Badge, BadgeColour, BadgeNumber, LEASED_BLOCKS, LEASED_NUMBERS, NUMBERS_OF_COLOUR, Pictogram,
    WrongBadge,
};
pub use shapes::{BadgePart, BadgePoint, BadgeShape, POINT_STEPS, covers_point};
pub use words::{Language, write_words};
