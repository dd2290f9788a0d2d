//! Capacities of badges.

/// Badge numbers in a block, the unit in which numbers are assigned to a headset. 64 is more than a headset's
/// visits in a day, so one block a day is enough, and it is one symbol of the badge's code.
pub const BLOCK_NUMBERS: usize = 64;

/// Maximum number of candidates when correcting a mistyped badge: one for each of three swaps, one for
/// another colour, one for each of four pictograms.
pub const BADGE_CANDIDATES: usize = 8;
