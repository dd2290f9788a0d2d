//! The booth's side: who holds which numbers, and which may be given out again.
//!
//! Of each block it knows how many numbers, from the front, are spent: shown, or maybe shown; and the day from which
//! no sculpture with one of them is kept. A block that nobody holds is handed out as a whole from that day on, and its
//! tail at any time.

use core::fmt;

use heapless::Vec;

use crate::badge::code::{BadgeNumber, LEASED_BLOCKS};
use crate::badge::exchange::{LeaseAnswer, LeaseReport, LeasedBlock, LeasedBlocks};
use crate::limits::{
    ALLOWANCE_SECONDS, BLOCK_NUMBERS, DAY_BLOCKS, FORMER_EPOCHS, MAX_ALLOWANCE, MAX_HEADSETS,
    MAX_LEASED_BLOCKS, MAX_REPORT_SECONDS, RESERVE_NUMBERS, SHORTEST_TAIL,
};

/// Seconds of a day of the ledger.
pub const DAY_SECONDS: u64 = 86_400;

/// Colours whose numbers are leased.
const LEASED_COLOURS: usize = 7;

/// What a booth knows of all leased numbers.
///
/// Of the same calls with the same arguments the same ledger follows, bit for bit. It is some 250 KB large: it lives
/// in a static, or is read where it shall live. An answer is sent once the ledger that it led to is saved.
#[derive(Debug)]
pub struct BadgeLedger {
    pub(crate) blocks: [BlockState; LEASED_BLOCKS],
    /// By their numbers.
    pub(crate) headsets: Vec<HeadsetLease, MAX_HEADSETS>,
    /// The turn at which the look for a block goes on; see [`block_of_turn`].
    pub(crate) next_turn: u16,
    /// The last day on which a block was looked for, and how many may yet be handed out on it. So it is known how far a
    /// ledger can have come that this one is a copy of.
    pub(crate) lease_day: u32,
    pub(crate) blocks_left: u16,
    /// When it was last told the time.
    pub(crate) now: u64,
    /// How long sculptures are kept, in days.
    pub(crate) retention_days: u16,
}

/// A block of numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct BlockState {
    /// Numbers spent, from the front.
    pub(crate) spent: u8,
    /// Whether a headset holds those that are not.
    pub(crate) is_held: bool,
    /// The first day on which no sculpture with a spent number is kept.
    pub(crate) free_on: u32,
}

/// What a headset holds.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct HeadsetLease {
    pub(crate) headset: u32,
    pub(crate) epoch: u64,
    /// When its epoch began here.
    pub(crate) begun_at: u64,
    /// The epochs before, the last one first; 0 where there was none.
    pub(crate) former: [u64; FORMER_EPOCHS],
    /// The newest report, and what it said.
    pub(crate) report: u32,
    pub(crate) taken: u32,
    /// When that was taken; `None` where the clock was set back since.
    pub(crate) reported_at: Option<u64>,
    /// In the order of their use.
    pub(crate) blocks: Vec<u16, MAX_LEASED_BLOCKS>,
}

/// Why a report isn't answered.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LedgerRefusal {
    /// It is older than one that was taken. A headset that is told so twice has a lease brought back from a copy, and
    /// begins a new one.
    Stale,
    /// It says that more numbers were taken than were handed out.
    NeverLeased,
    /// It is of an unknown epoch, and another began less than [`MAX_REPORT_SECONDS`] ago: it may be older than that
    /// one, and late. A headset that was wiped twice so soon asks again.
    TooSoon,
    /// There are [`MAX_HEADSETS`] others.
    TooManyHeadsets,
}

/// How the leased numbers are distributed. All five together are [`LEASED_NUMBERS`](super::LEASED_NUMBERS).
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct LedgerTotals {
    /// To be handed out.
    pub free: u32,
    /// Held by headsets, and not known to be spent.
    pub held: u32,
    /// Spent, in blocks that headsets hold.
    pub spent_of_held: u32,
    /// Spent, and kept until no sculpture has them.
    pub kept: u32,
    /// Tails that are too short to be handed out before their block is free.
    pub resting: u32,
}

impl BadgeLedger {
    /// All numbers free. Sculptures are kept for `retention_days` after the day on which their badge was heard of.
    #[must_use]
    pub const fn new(retention_days: u16) -> Self {
        BadgeLedger {
            blocks: [BlockState { spent: 0, is_held: false, free_on: 0 }; LEASED_BLOCKS],
            headsets: Vec::new(),
            next_turn: 0,
            lease_day: 0,
            blocks_left: DAY_BLOCKS,
            now: 0,
            retention_days,
        }
    }

    /// Takes a headset's report at `now`, in seconds of the booth's clock, and fills its reserve up. What a lease of
    /// an epoch before can have taken since its last report is spent with it, and its tail returns.
    ///
    /// # Errors
    /// [`LedgerRefusal`], and nothing was changed but the clock.
    pub fn answer_report(
        &mut self,
        report: &LeaseReport,
        now: u64,
    ) -> Result<LeaseAnswer, LedgerRefusal> {
        self.set_clock(now);
        let row = match self.headsets.binary_search_by_key(&report.headset, |row| row.headset) {
            Ok(row) => row,
            Err(_) if report.taken > 0 => return Ok(void_answer(report)),
            Err(row) => {
                let new = HeadsetLease::new(report, now);
                self.headsets.insert(row, new).map_err(|_| LedgerRefusal::TooManyHeadsets)?;
                row
            }
        };
        let lease = &self.headsets[row];
        if report.epoch != lease.epoch {
            // An epoch begins with nothing taken: what says otherwise was handed out by another ledger.
            if report.taken > 0 || lease.former.contains(&report.epoch) {
                return Ok(void_answer(report));
            }
            if now.saturating_sub(lease.begun_at) <= u64::from(MAX_REPORT_SECONDS) {
                return Err(LedgerRefusal::TooSoon);
            }
            self.begin_epoch(row, report);
        } else if report.report < lease.report
            || report.report == lease.report && report.taken != lease.taken
        {
            return Err(LedgerRefusal::Stale);
        }
        let lease = &self.headsets[row];
        let taken_since = report.taken.saturating_sub(lease.taken);
        if taken_since > self.count_held(row) {
            return Err(LedgerRefusal::NeverLeased);
        }
        self.spend(row, taken_since, u32::from(self.retention_days));
        let lease = &mut self.headsets[row];
        lease.taken += taken_since;
        lease.report = report.report;
        lease.reported_at = Some(now);
        self.fill_reserve(row);
        Ok(self.make_answer(row))
    }

    /// Takes a headset out that was lost, broken or sent home. All that it holds is spent, for twice as long as
    /// sculptures are kept: it may come back as long as they are, and show it before the booth tells it that its
    /// lease is void.
    ///
    /// Returns whether it was known.
    pub fn retire_headset(&mut self, headset: u32, now: u64) -> bool {
        self.set_clock(now);
        let found = self.headsets.binary_search_by_key(&headset, |row| row.headset);
        if let Ok(row) = found {
            self.spend(row, u32::MAX, 2 * u32::from(self.retention_days));
            self.headsets.remove(row);
        }
        found.is_ok()
    }

    /// Notes that a sculpture with this number is kept until the end of `last_day` at least: when it arrives, and when
    /// somebody wants it kept for longer. Of a provisional number nothing is noted.
    pub fn keep_until(&mut self, number: BadgeNumber, last_day: u32) {
        let Some((block, place)) = number.block_and_place() else { return };
        let today = Self::day_of(self.now);
        let state = &mut self.blocks[usize::from(block)];
        let was_to_be_had = state.is_to_be_had(today);
        state.free_on = state.free_on.max(last_day.saturating_add(1));
        // A sculpture may be here before the report of its number. Of a block that nobody holds there is none to come.
        if !state.is_held {
            state.spent = state.spent.max(place + 1);
        }
        // A copy of this ledger counts the block among those that may have been handed out since.
        if was_to_be_had && !state.is_to_be_had(today) {
            self.blocks_left = self.blocks_left.saturating_sub(1);
        }
    }

    /// Whether a number may be handed out, now or once its block is free: nobody holds it, and no sculpture that is kept
    /// can have it. Not so of provisional numbers. At the booth, what is free is no candidate for a badge that was
    /// misheard.
    #[must_use]
    pub fn is_free(&self, number: BadgeNumber) -> bool {
        let Some((block, place)) = number.block_and_place() else { return false };
        let state = &self.blocks[usize::from(block)];
        !state.is_held && (place >= state.spent || Self::day_of(self.now) >= state.free_on)
    }

    /// The day of a time of the booth's clock.
    #[must_use]
    pub const fn day_of(time: u64) -> u32 {
        let day = time / DAY_SECONDS;
        if day > u32::MAX as u64 { u32::MAX } else { day as u32 }
    }

    /// Counts what became of all numbers, as of the time that it was last told.
    #[must_use]
    pub fn totals(&self) -> LedgerTotals {
        let mut totals = LedgerTotals::default();
        for state in &self.blocks {
            let (spent, rest) = (u32::from(state.spent), state.rest());
            if state.is_held {
                totals.spent_of_held += spent;
                totals.held += rest;
            } else if Self::day_of(self.now) >= state.free_on {
                totals.free += spent + rest;
            } else {
                totals.kept += spent;
                let is_worth_it = rest >= u32::from(SHORTEST_TAIL);
                *(if is_worth_it { &mut totals.free } else { &mut totals.resting }) += rest;
            }
        }
        totals
    }

    /// A clock that was set back says nothing of how long ago a report was: until the next one, a headset may have
    /// shown all that it holds.
    pub(crate) fn set_clock(&mut self, now: u64) {
        if now < self.now {
            for lease in &mut self.headsets {
                (lease.reported_at, lease.begun_at) = (None, now);
            }
        }
        self.now = now;
    }

    /// Replaces a headset's lease, whose data is lost: what it may have shown is spent, the rest returns.
    fn begin_epoch(&mut self, row: usize, report: &LeaseReport) {
        let lease = &self.headsets[row];
        let silent = lease.reported_at.map(|time| self.now.saturating_sub(time));
        let most_taken = silent.map_or(u32::MAX, most_taken_within);
        self.spend(row, most_taken, u32::from(self.retention_days));
        let lease = &mut self.headsets[row];
        for block in &lease.blocks {
            self.blocks[usize::from(*block)].is_held = false;
        }
        let mut former = lease.former;
        former.rotate_right(1);
        former[0] = lease.epoch;
        *lease = HeadsetLease { former, ..HeadsetLease::new(report, self.now) };
    }

    /// Spends the first `count` numbers that a headset holds, or all, for so many days after this one.
    pub(crate) fn spend(&mut self, row: usize, mut count: u32, days: u32) {
        let free_on = Self::day_of(self.now).saturating_add(days).saturating_add(1);
        let lease = &mut self.headsets[row];
        while count > 0
            && let Some(&block) = lease.blocks.first()
        {
            let state = &mut self.blocks[usize::from(block)];
            let spent_now = count.min(state.rest());
            state.spent += spent_now as u8;
            state.free_on = state.free_on.max(free_on);
            count -= spent_now;
            if state.rest() == 0 {
                state.is_held = false;
                lease.blocks.remove(0);
            }
        }
    }

    /// Hands blocks to a headset until it has its reserve; fewer where it holds as many as it can, or none is left.
    fn fill_reserve(&mut self, row: usize) {
        while self.count_held(row) < RESERVE_NUMBERS
            && !self.headsets[row].blocks.is_full()
            && let Some(block) = self.find_block()
        {
            let today = Self::day_of(self.now);
            let state = &mut self.blocks[usize::from(block)];
            if today >= state.free_on {
                state.spent = 0;
            }
            state.is_held = true;
            // There is room: it was looked for above.
            let _ = self.headsets[row].blocks.push(block);
        }
    }

    /// The next block to be handed out. They take turns, so that what was spent longest ago comes first, and a short
    /// round needs no list of what is free.
    fn find_block(&mut self) -> Option<u16> {
        let today = Self::day_of(self.now);
        if today > self.lease_day {
            (self.lease_day, self.blocks_left) = (today, DAY_BLOCKS);
        }
        if self.blocks_left == 0 {
            return None;
        }
        for _ in 0..LEASED_BLOCKS {
            let block = block_of_turn(self.next_turn);
            self.next_turn = (self.next_turn + 1) % LEASED_BLOCKS as u16;
            if self.blocks[usize::from(block)].is_to_be_had(today) {
                self.blocks_left -= 1;
                return Some(block);
            }
        }
        None
    }

    fn count_held(&self, row: usize) -> u32 {
        self.headsets[row].blocks.iter().map(|block| self.blocks[usize::from(*block)].rest()).sum()
    }

    fn make_answer(&self, row: usize) -> LeaseAnswer {
        let HeadsetLease { headset, epoch, report, taken, .. } = self.headsets[row];
        let tail = |block: &u16| LeasedBlock::new(*block, self.blocks[usize::from(*block)].spent);
        let blocks = self.headsets[row].blocks.iter().filter_map(tail).collect();
        LeaseAnswer { headset, epoch, report, taken, is_void: false, blocks }
    }
}

impl BlockState {
    /// Whether a headset may get its numbers on a day: all, or a tail that is worth it.
    pub(crate) const fn is_to_be_had(&self, today: u32) -> bool {
        !self.is_held && (today >= self.free_on || self.rest() >= SHORTEST_TAIL as u32)
    }

    /// Numbers that are not spent.
    pub(crate) const fn rest(&self) -> u32 {
        (BLOCK_NUMBERS as u32).saturating_sub(self.spent as u32)
    }
}

impl HeadsetLease {
    /// Holding nothing.
    const fn new(report: &LeaseReport, now: u64) -> Self {
        HeadsetLease {
            headset: report.headset,
            epoch: report.epoch,
            begun_at: now,
            former: [0; FORMER_EPOCHS],
            report: 0,
            taken: 0,
            reported_at: None,
            blocks: Vec::new(),
        }
    }
}

/// Numbers that a headset may have taken since it made its last report, which was taken so many seconds ago: its
/// allowance and what was added to it, by a clock that is up to a hundredth faster than the booth's.
pub(crate) const fn most_taken_within(seconds: u64) -> u32 {
    let seconds = seconds.saturating_add(MAX_REPORT_SECONDS as u64);
    let gained = seconds.saturating_add(seconds / 100 + 1).div_ceil(ALLOWANCE_SECONDS as u64);
    // Part of the next one may have been gained before.
    let most = gained.saturating_add(1 + MAX_ALLOWANCE as u64);
    if most > u32::MAX as u64 { u32::MAX } else { most as u32 }
}

/// The blocks take turns by colour, so that visitors of a day have badges of all.
pub(crate) const fn block_of_turn(turn: u16) -> u16 {
    let (turn, of_colour) = (turn as usize, LEASED_BLOCKS / LEASED_COLOURS);
    (turn % LEASED_COLOURS * of_colour + turn / LEASED_COLOURS) as u16
}

/// The answer to a lease whose numbers this ledger doesn't know, or took back.
const fn void_answer(report: &LeaseReport) -> LeaseAnswer {
    let LeaseReport { headset, epoch, report, taken } = *report;
    LeaseAnswer { headset, epoch, report, taken, is_void: true, blocks: LeasedBlocks::new() }
}

impl fmt::Display for LedgerRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LedgerRefusal::Stale => f.write_str("a newer report of this headset was taken"),
            LedgerRefusal::NeverLeased => f.write_str("more numbers were taken than were leased"),
            LedgerRefusal::TooSoon => f.write_str("another lease of this headset has just begun"),
            LedgerRefusal::TooManyHeadsets => write!(f, "{MAX_HEADSETS} other headsets are known"),
        }
    }
}

impl core::error::Error for LedgerRefusal {}
