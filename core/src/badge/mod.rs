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
//!
//! ```
//! use paros_core::badge::{AnswerOutcome, Language, BadgeLease, BadgeLedger, write_words};
//!
//! // The booth's, which keeps sculptures for 90 days, and headset 17's, with a random epoch.
//! let mut ledger = Box::new(BadgeLedger::new(90));
//! let mut lease = BadgeLease::new(17, 0x1db7_5aa9_40e6_12f3);
//! let answer = ledger.answer_report(&lease.make_report(), 1_790_000_000)?;
//! assert_eq!(lease.take_answer(&answer), AnswerOutcome::Taken);
//! // The end of a visit: the lease is saved, then the badge shown.
//! let badge = lease.take_number(0).badge();
//! let mut words = String::new();
//! write_words(&mut words, &badge, Language::English)?;
//! assert_eq!(words, "red: pizza, mushroom, rocket, chair");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What shells must keep
//! That no leased badge is shown twice while a sculpture has it rests on this:
//! - A headset's number is its own, and is the same after its app's data was wiped (the device's serial number, or
//!   one that the staff gives). Two headsets with one number take each other's lease away.
//! - An epoch is 64 random bits, not zero, drawn where there is no lease to load. A lease is never brought back from a
//!   backup, and not copied to another headset.
//! - A lease is on disk before the badge that it gave is shown, and before its report is sent.
//! - A report is on its way for ten minutes at most ([`MAX_REPORT_SECONDS`](crate::limits::MAX_REPORT_SECONDS)); it is
//!   dropped then, and another made. What is refused as too soon is reported again after ten minutes.
//! - A headset's seconds, by a clock that nobody sets, are at most a hundredth too many; too few do no harm.
//! - A headset that was retired longer ago than sculptures are kept is wiped before it is used again.
//! - The booth's clock goes on while it is off, and isn't set forward by mistake. Set back, it costs numbers, no more.
//! - A ledger that is brought back from a copy begins a generation ([`BadgeLedger::begin_generation`]) before it answers
//!   anybody, and of one copy no more than one a day. The one before answers nobody any more, and the
//!   clock isn't set back between a copy and its return.
//! - The ledger is on disk before an answer is sent, and the booth tells it of every sculpture that arrives, and of
//!   each that is kept for longer ([`BadgeLedger::keep_until`]).

mod code;
mod exchange;
mod gf64;
mod lease;
mod ledger;
mod ledger_generation;
mod ledger_save;
mod shapes;
mod words;

pub use code::{
    Badge, BadgeColour, BadgeNumber, LEASED_BLOCKS, LEASED_NUMBERS, NUMBERS_OF_COLOUR, Pictogram,
    WrongBadge,
};
pub use exchange::{LeaseAnswer, LeaseReport, LeasedBlock, LeasedBlocks};
pub use lease::{AnswerOutcome, BadgeLease};
pub use ledger::{BadgeLedger, DAY_SECONDS, LedgerRefusal, LedgerTotals};
pub use ledger_save::MAX_LEDGER_BYTES;
pub use shapes::{BadgePart, BadgePoint, BadgeShape, POINT_STEPS, covers_point};
pub use words::{Language, write_words};
