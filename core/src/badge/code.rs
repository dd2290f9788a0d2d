//! The code of a badge: converts a number to four pictograms and a colour, and back.
//!
//! # From a number to a badge
//! Three of a number's 21 bits are the colour; the other 18 are three symbols of six bits: one for the place
//! in its block, two for the block. A matrix over GF(64) maps the three symbols and the colour to three
//! pictograms; the fourth pictogram is the check symbol. The matrix with the check's row below it has no
//! singular square submatrix (it is an MDS code). Compare two numbers in four symbols: the place in the
//! block, either half of the block's number, and the colour. If they differ in one symbol, they have no
//! pictogram in common at the same position; if in two, at most one; and any two numbers at most two. So
//! numbers of a block, which one headset shows in sequence, never have a pictogram in common, and the last of
//! a block and the first of the next have at most one.
//!
//! # The check
//! `1 p0 + 2 p1 + 4 p2 + 8 p3 + colour = 0` in GF(64), with the distinct non-zero factors 1, x, x^2, x^3. A
//! wrong pictogram at position k changes the sum by `w[k] (p - p')`, a wrong colour by the difference of two
//! colours, and a swap of two neighbours by `(w[k] - w[k + 1]) (p - p')`. None of these is zero if something
//! was changed, as a field has no zero divisors. The integers modulo 64 have zero divisors: to make the
//! differences of neighbours odd, the factors must alternate between odd and even, and an even factor misses
//! a pictogram that is off by 32.

use core::fmt;

use heapless::Vec;

use crate::badge::gf64::{Gf64, dot};
use crate::limits::{BADGE_CANDIDATES, BLOCK_NUMBERS};

/// Number of badge numbers of a colour: three pictograms out of 64.
pub const NUMBERS_OF_COLOUR: u32 = 1 << 18;

/// The first provisional number. All lower numbers are leased.
pub const LEASED_NUMBERS: u32 = 7 * NUMBERS_OF_COLOUR;

/// Number of blocks of leased numbers.
pub const LEASED_BLOCKS: usize = LEASED_NUMBERS as usize / BLOCK_NUMBERS;

/// The factors of the pictograms in the check, by position: 1, x, x^2, x^3.
const WEIGHTS: [u8; 4] = [1, 2, 4, 8];

/// Salt that is combined with a number's 18 bits, so that the very first badge isn't four times the same
/// pictogram.
const SALT: u32 = 0o25_7163;

/// The matrix from a number's three symbols, the lowest first, and its colour to the first three pictograms.
const SCRAMBLE: [[u8; 4]; 3] = [[24, 7, 3, 9], [32, 14, 17, 62], [44, 28, 50, 41]];

/// The inverse of the scramble's first three columns.
const UNSCRAMBLE: [[u8; 3]; 3] = [[25, 36, 37], [1, 61, 5], [15, 63, 45]];

/// One of 64 pictures, a symbol of the code, identified by its number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Pictogram(u8);

/// The colour of a badge. Sky blue, violet and brown are missing: they are too similar to others in speech,
/// or to a colour-blind eye.
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
    /// Provisional: for random numbers, which may repeat.
    Black,
}

/// The number that a badge encodes: 21 bits, of which the upper three are the colour. A badge shows 27 bits:
/// these and six bits of the check.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct BadgeNumber(u32);

/// A badge as shown or said. It may be invalid.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Badge {
    /// The colour of its ground.
    pub colour: BadgeColour,
    /// Its pictures, in reading order: row by row from the top, from left to right.
    pub pictograms: [Pictogram; 4],
}

/// The error of reading a badge with a wrong check: a pictogram or the colour is wrong, or pictograms are in
/// the wrong order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WrongBadge {
    /// The badge as read.
    pub badge: Badge,
}

impl Pictogram {
    /// Number of pictograms.
    pub const COUNT: usize = 64;

    /// Returns the pictogram with this number, or `None` from 64 on.
    #[must_use]
    pub const fn new(number: u8) -> Option<Self> {
        if number < Self::COUNT as u8 { Some(Pictogram(number)) } else { None }
    }

    /// Iterates over all pictograms.
    pub fn all() -> impl Iterator<Item = Pictogram> {
        (0..Self::COUNT as u8).map(Pictogram)
    }

    /// Returns its number, 0 to 63.
    #[must_use]
    pub const fn number(self) -> usize {
        self.0 as usize
    }

    const fn symbol(self) -> Gf64 {
        Gf64::new(self.0)
    }
}

impl BadgeColour {
    /// All colours, in the order of their numbers.
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

    /// Returns `true` if its numbers are drawn at random and may repeat.
    #[must_use]
    pub const fn is_provisional(self) -> bool {
        matches!(self, BadgeColour::Black)
    }

    const fn symbol(self) -> Gf64 {
        Gf64::new(self as u8)
    }
}

impl BadgeNumber {
    /// Number of badge numbers: 8 colours of 2^18.
    pub const COUNT: u32 = LEASED_NUMBERS + NUMBERS_OF_COLOUR;

    /// Creates the number, if it is below [`BadgeNumber::COUNT`].
    #[must_use]
    pub const fn new(number: u32) -> Option<Self> {
        if number < Self::COUNT { Some(BadgeNumber(number)) } else { None }
    }

    /// Creates a provisional number from the lower 18 of these bits, which the caller draws at random.
    #[must_use]
    pub const fn provisional(random_bits: u32) -> Self {
        BadgeNumber(LEASED_NUMBERS + random_bits % NUMBERS_OF_COLOUR)
    }

    /// Returns the number at a place of a block, or `None` if there is no such block or place.
    pub fn of_block(block: u16, place: u8) -> Option<Self> {
        let is_valid = usize::from(block) < LEASED_BLOCKS && usize::from(place) < BLOCK_NUMBERS;
        is_valid.then(|| BadgeNumber(u32::from(block) * BLOCK_NUMBERS as u32 + u32::from(place)))
    }

    /// Returns its block, and its place there; `None` for a provisional number.
    pub fn block_and_place(self) -> Option<(u16, u8)> {
        let (block, place) = (self.0 / BLOCK_NUMBERS as u32, self.0 % BLOCK_NUMBERS as u32);
        (!self.is_provisional()).then_some((block as u16, place as u8))
    }

    /// Returns the number, counted from 0.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }

    /// Returns its colour.
    #[must_use]
    pub const fn colour(self) -> BadgeColour {
        BadgeColour::ALL[(self.0 / NUMBERS_OF_COLOUR) as usize % 8]
    }

    /// Returns `true` if it was drawn at random, so that another visitor may have the same number.
    #[must_use]
    pub const fn is_provisional(self) -> bool {
        self.0 >= LEASED_NUMBERS
    }

    /// Returns the badge that shows it.
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
    /// Decodes the number that it shows.
    ///
    /// # Errors
    /// [`WrongBadge`] if the check doesn't fit. [`Badge::nearest_candidates`] returns the badges that may
    /// have been meant.
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

    /// Returns `true` if the check fits.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.syndrome() == Gf64::ZERO
    }

    /// Returns the valid badges that are one mistake away from a wrong one. First come the badges with two
    /// neighbours swapped back, in the order of their positions, then the badge with another colour, then one
    /// for each position at which a pictogram may be wrong. The result is empty if the badge is valid, and
    /// otherwise has mostly four or five candidates. A caller that knows which badges were ever issued keeps
    /// only those.
    #[must_use]
    pub fn nearest_candidates(&self) -> Vec<Badge, BADGE_CANDIDATES> {
        let mut candidates = Vec::new();
        let syndrome = self.syndrome();
        if syndrome == Gf64::ZERO {
            return candidates;
        }
        // Cannot fail: there is room for three swaps, a colour and four pictograms.
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

    /// Returns the check's sum, which is zero for a valid badge.
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
