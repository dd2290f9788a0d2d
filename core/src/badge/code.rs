//! The code of a badge: from a number to four pictograms and a colour, and back.
//!
//! # From a number to a badge
//! Of the 21 bits of a number three are the colour, and the other 18 are three symbols of six bits: which number of
//! its block, and which block. A matrix over GF(64) makes three pictograms of the three symbols and the colour; the
//! fourth is the check symbol. The matrix and the check's row below it have no singular square part (it is an MDS
//! code), so that two numbers that differ in one of the four (number of the block, either half of the block's,
//! colour) have no pictogram at the same place in common, two that differ in two of them at most one, and any two at
//! most two. Numbers of a block, which one headset shows one after the other, never have one in common, and the last
//! of a block and the first of the next at most one.
//!
//! # The check
//! `1 p0 + 2 p1 + 4 p2 + 8 p3 + colour = 0` in GF(64), whose factors 1, x, x^2, x^3 are distinct and not zero. A wrong
//! pictogram at place k changes the sum by `w[k] (p - p')`, a wrong colour by the difference of two colours, the swap
//! of two neighbours by `(w[k] - w[k + 1]) (p - p')`: none is zero where something was changed, as a field has no
//! divisors of zero. Modulo 64 it has: factors whose differences are all odd must be odd and even by turns, and
//! an even factor misses a pictogram that is 32 off.

use core::fmt;

use heapless::Vec;

use crate::badge::gf64::{Gf64, dot};
use crate::limits::{BADGE_CANDIDATES, BLOCK_NUMBERS};

/// Numbers of a colour: three pictograms out of 64.
pub const NUMBERS_OF_COLOUR: u32 = 1 << 18;

/// Numbers below this one are leased, those from it on provisional.
pub const LEASED_NUMBERS: u32 = 7 * NUMBERS_OF_COLOUR;

/// Blocks of leased numbers.
pub const LEASED_BLOCKS: usize = LEASED_NUMBERS as usize / BLOCK_NUMBERS;

/// What the pictograms count in the check, by place: 1, x, x^2, x^3.
const WEIGHTS: [u8; 4] = [1, 2, 4, 8];

/// What is added to a number's 18 bits first, so that the first badge of all isn't four times the same pictogram.
const SALT: u32 = 0o25_7163;

/// The first three pictograms, of a number's three symbols, the lowest first, and its colour.
const SCRAMBLE: [[u8; 4]; 3] = [[24, 7, 3, 9], [32, 14, 17, 62], [44, 28, 50, 41]];

/// The inverse of the scramble's first three columns.
const UNSCRAMBLE: [[u8; 3]; 3] = [[25, 36, 37], [1, 61, 5], [15, 63, 45]];

/// One of 64 pictures, by its number: the symbol of the code.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Pictogram(u8);

/// The colour of a badge. Sky blue, violet and brown are missing: in speech, or to a colour-blind eye, they are
/// too near to others.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
#[repr(u8)]
pub enum BadgeColour {
    /// Leased.
    Red,
    /// Leased.
    Orange,
    /// Leased.
    Yellow,
    /// Leased.
    Green,
    /// Leased.
    Blue,
    /// Leased.
    Pink,
    /// Leased.
    White,
    /// Provisional: of random numbers, which may repeat.
    Black,
}

/// What a badge stands for: 21 bits, of which the upper three are the colour. The 27 bits that are shown
/// have the six of the check beside them.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct BadgeNumber(u32);

/// A badge as it is shown or said. Not every one is valid.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Badge {
    /// The colour of its ground.
    pub colour: BadgeColour,
    /// Its pictures, as they are read: row by row from the upper one on, from left to right.
    pub pictograms: [Pictogram; 4],
}

/// The error of reading a badge whose check doesn't fit: a pictogram or the colour is wrong, or pictograms are in
/// another order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WrongBadge {
    /// What was read.
    pub badge: Badge,
}

impl Pictogram {
    /// How many there are.
    pub const COUNT: usize = 64;

    /// The pictogram of this number; `None` from 64 on.
    #[must_use]
    pub const fn new(number: u8) -> Option<Self> {
        if number < Self::COUNT as u8 { Some(Pictogram(number)) } else { None }
    }

    /// All of them.
    pub fn all() -> impl Iterator<Item = Pictogram> {
        (0..Self::COUNT as u8).map(Pictogram)
    }

    /// Its number, 0 to 63.
    #[must_use]
    pub const fn number(self) -> usize {
        self.0 as usize
    }

    const fn symbol(self) -> Gf64 {
        Gf64::new(self.0)
    }
}

impl BadgeColour {
    /// By number.
    pub const ALL: [BadgeColour; 8] = [
        BadgeColour::Red,
        BadgeColour::Orange,
        BadgeColour::Yellow,
        BadgeColour::Green,
        BadgeColour::Blue,
        BadgeColour::Pink,
        BadgeColour::White,
        BadgeColour::Black,
    ];

    /// Whether its numbers are drawn at random and may repeat.
    #[must_use]
    pub const fn is_provisional(self) -> bool {
        matches!(self, BadgeColour::Black)
    }

    const fn symbol(self) -> Gf64 {
        Gf64::new(self as u8)
    }
}

impl BadgeNumber {
    /// How many there are: 8 colours of 2^18.
    pub const COUNT: u32 = LEASED_NUMBERS + NUMBERS_OF_COLOUR;

    /// The number, if it is below [`BadgeNumber::COUNT`].
    #[must_use]
    pub const fn new(number: u32) -> Option<Self> {
        if number < Self::COUNT { Some(BadgeNumber(number)) } else { None }
    }

    /// A provisional number: the lower 18 of these bits, which the caller draws at random.
    #[must_use]
    pub const fn provisional(random_bits: u32) -> Self {
        BadgeNumber(LEASED_NUMBERS + random_bits % NUMBERS_OF_COLOUR)
    }

    /// Number `place` of a block; `None` where there is no such block or place.
    pub fn of_block(block: u16, place: u8) -> Option<Self> {
        let is_valid = usize::from(block) < LEASED_BLOCKS && usize::from(place) < BLOCK_NUMBERS;
        is_valid.then(|| BadgeNumber(u32::from(block) * BLOCK_NUMBERS as u32 + u32::from(place)))
    }

    /// The block that it lies in, and its place there; `None` for a provisional number.
    pub fn block_and_place(self) -> Option<(u16, u8)> {
        let (block, place) = (self.0 / BLOCK_NUMBERS as u32, self.0 % BLOCK_NUMBERS as u32);
        (!self.is_provisional()).then_some((block as u16, place as u8))
    }

    /// From 0.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }

    /// Its colour.
    #[must_use]
    pub const fn colour(self) -> BadgeColour {
        BadgeColour::ALL[(self.0 / NUMBERS_OF_COLOUR) as usize % 8]
    }

    /// Whether it was drawn at random, so that another visitor may have the same.
    #[must_use]
    pub const fn is_provisional(self) -> bool {
        self.0 >= LEASED_NUMBERS
    }

    /// The badge that shows it.
    #[must_use]
    pub fn badge(self) -> Badge {
        let colour = self.colour();
        let symbol = |shift: u32| Gf64::new(((self.0 ^ SALT) >> shift) as u8);
        let symbols = [symbol(0), symbol(6), symbol(12), colour.symbol()];
        let [a, b, c] = SCRAMBLE.map(|row| dot(&row, &symbols));
        let with_check = |check: Gf64| {
            let pictograms = [a, b, c, check].map(|symbol| Pictogram(symbol.bits()));
            Badge { colour, pictograms }
        };
        let syndrome = with_check(Gf64::ZERO).syndrome();
        with_check(syndrome.over(Gf64::new(WEIGHTS[3])))
    }
}

impl Badge {
    /// The number that it shows.
    ///
    /// # Errors
    /// [`WrongBadge`] where the check doesn't fit. [`Badge::nearest_candidates`] has what may have been meant.
    pub fn number(&self) -> Result<BadgeNumber, WrongBadge> {
        if !self.is_valid() {
            return Err(WrongBadge { badge: *self });
        }
        let colour = self.colour.symbol();
        let mut scrambled = [Gf64::ZERO; 3];
        for (k, row) in SCRAMBLE.iter().enumerate() {
            scrambled[k] = self.pictograms[k].symbol().plus(Gf64::new(row[3]).times(colour));
        }
        let [low, middle, high] = UNSCRAMBLE.map(|row| u32::from(dot(&row, &scrambled).bits()));
        let within_colour = (high << 12 | middle << 6 | low) ^ SALT;
        Ok(BadgeNumber(self.colour as u32 * NUMBERS_OF_COLOUR + within_colour))
    }

    /// Whether the check fits.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.syndrome() == Gf64::ZERO
    }

    /// The valid badges at one mistake from a wrong one: first those that swap two neighbours back, the first places
    /// first, then the one of another colour, then one for each place at which a pictogram may be wrong. None where
    /// the badge is valid, mostly four or five otherwise; whoever knows which were ever shown keeps the few of them that were.
    #[must_use]
    pub fn nearest_candidates(&self) -> Vec<Badge, BADGE_CANDIDATES> {
        let mut candidates = Vec::new();
        let syndrome = self.syndrome();
        if syndrome == Gf64::ZERO {
            return candidates;
        }
        // It never has more than there is room for: three swaps, a colour, four pictograms.
        let mut push = |badge: Badge| _ = candidates.push(badge);
        for k in 0..3 {
            let mut swapped = *self;
            swapped.pictograms.swap(k, k + 1);
            if swapped.is_valid() {
                push(swapped);
            }
        }
        let colour = self.colour.symbol().plus(syndrome).bits();
        if let Some(&colour) = BadgeColour::ALL.get(usize::from(colour)) {
            push(Badge { colour, ..*self });
        }
        for (k, weight) in WEIGHTS.iter().enumerate() {
            let mut mended = *self;
            let right = self.pictograms[k].symbol().plus(syndrome.over(Gf64::new(*weight)));
            mended.pictograms[k] = Pictogram(right.bits());
            push(mended);
        }
        candidates
    }

    /// The check's sum, which is zero for a valid badge.
    fn syndrome(&self) -> Gf64 {
        dot(&WEIGHTS, &self.pictograms.map(Pictogram::symbol)).plus(self.colour.symbol())
    }
}

impl fmt::Display for WrongBadge {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no badge has these pictures in this order and colour")
    }
}

impl core::error::Error for WrongBadge {}
