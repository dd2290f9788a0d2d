//! Capacities of badges.

/// Numbers of a block, which a headset is handed at once: more than a day's visits to it, so that a block a day is
/// enough; and a symbol of the badge's code.
pub const BLOCK_NUMBERS: usize = 64;

/// Badges that may have been meant by a wrong one, at most: one for each of three swaps, one of another colour, one for
/// each of four pictograms.
pub const BADGE_CANDIDATES: usize = 8;
