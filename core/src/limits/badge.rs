//! Capacities of badges and their ledger.

/// Numbers of a block, which a headset is handed at once: more than a day's visits to it, so that a block a day is
/// enough; and a symbol of the badge's code.
pub const BLOCK_NUMBERS: usize = 64;

/// Badges that may have been meant by a wrong one, at most: one for each of three swaps, one of another colour, one for
/// each of four pictograms.
pub const BADGE_CANDIDATES: usize = 8;

/// Numbers that a headset should have left: three days of 50 visits, so that a booth's network that fails on a
/// Friday is mended on Monday.
pub const RESERVE_NUMBERS: u32 = 150;

/// Blocks that a headset holds at most, used up or not. With less than its reserve left it has the block in use and
/// five of the shortest tails; there is room for one more.
pub const MAX_LEASED_BLOCKS: usize = 6;

/// Numbers of a block's tail that is worth a place in a lease. A shorter one rests until the whole block is free: 7
/// numbers for each wiped headset in the mean, where some 70 are spent that nobody may have seen.
pub const SHORTEST_TAIL: u8 = BLOCK_NUMBERS as u8 / 2;

/// Leased numbers that a headset may show at once without having heard from the booth: visits of a morning that is
/// busier than the mean.
pub const MAX_ALLOWANCE: u8 = 12;

/// Seconds in which a headset that hears nothing from the booth may show one leased number more: 60 in a day of ten
/// hours. It bounds what a wiped headset can have shown since its last report: 99 in a night of fourteen hours,
/// where it holds 150 to 213.
pub const ALLOWANCE_SECONDS: u32 = 600;

/// Seconds from when a report is made to when the booth takes it, at most. A report that is older is dropped and made
/// anew.
pub const MAX_REPORT_SECONDS: u32 = 600;

/// Blocks that a ledger hands out in a day at most. 200 headsets with 50 visits a day, half of them wiped daily, need 919 at
/// most in a year. It bounds what a ledger can have handed out since a copy was made of it.
pub const DAY_BLOCKS: u16 = 1024;

/// Blocks that a ledger hands out on the day on which it came back from a copy: the reserves of all headsets.
pub const RESTORE_BLOCKS: u16 = 1024;

/// Headsets that a ledger knows: 200, and spares that take the place of broken ones.
pub const MAX_HEADSETS: usize = 256;

/// Former epochs of a headset by which a late report is told from one of a new epoch. They last three wipes, and a
/// report is ten minutes late at most.
pub const FORMER_EPOCHS: usize = 3;
