//! A ledger that comes back from a copy: what was handed out since is unknown, and set aside.
//!
//! A badge has no room for the number of a generation: its 27 bits are spent. But blocks are handed out in turn, and so many
//! a day at most. So those are known that can have been handed out since the copy: what headsets held when it was made, and
//! the next ones, as many as all days since had. Their numbers count as shown just now, and the generation begins behind
//! them. A copy of yesterday costs a ninth of all numbers at most, one of two weeks all, until nothing of them can be kept.

use crate::badge::code::LEASED_BLOCKS;
use crate::badge::ledger::{BadgeLedger, block_of_turn};
use crate::limits::{BLOCK_NUMBERS, DAY_BLOCKS, RESTORE_BLOCKS};

impl BadgeLedger {
    /// Sets aside what may have been handed out since this ledger was saved, and takes all leases back. Headsets that hold
    /// one are told that it is void, and may show numbers of it until then: they count for twice as long as sculptures
    /// are kept, as those of a headset that was retired.
    ///
    /// Both times, that of the copy and of now, are in seconds of the booth's clock. Where now is a day before the copy,
    /// everything is set aside.
    pub fn begin_generation(&mut self, copied_at: u64, now: u64) {
        let (today, days) = (Self::day_of(now), 2 * u32::from(self.retention_days));
        // Nothing was handed out between the last report and the copy.
        let copied_on = Self::day_of(copied_at).max(Self::day_of(self.now));
        let mut most = self.count_blocks_until(today, copied_on);
        self.set_clock(now);
        while !self.headsets.is_empty() {
            self.spend(0, u32::MAX, days);
            self.headsets.remove(0);
        }
        let free_on = today.saturating_add(days).saturating_add(1);
        for _ in 0..LEASED_BLOCKS {
            if most == 0 {
                break;
            }
            let state = &mut self.blocks[usize::from(block_of_turn(self.next_turn))];
            self.next_turn = (self.next_turn + 1) % LEASED_BLOCKS as u16;
            // What became free since may have been handed out, or passed over before.
            most -= u32::from(state.is_to_be_had(copied_on));
            if state.is_to_be_had(today) {
                state.spent = BLOCK_NUMBERS as u8;
                state.free_on = free_on;
            }
        }
        (self.lease_day, self.blocks_left) = (today, RESTORE_BLOCKS);
    }

    /// Blocks that the ledger that this is a copy of can have handed out by the end of a day; more than there are where that is
    /// before the copy's. Each day may have been one of a restore too.
    fn count_blocks_until(&self, today: u32, copied_on: u32) -> u32 {
        let copied_on = self.lease_day.max(copied_on);
        let Some(days) = today.checked_sub(copied_on) else { return u32::MAX };
        let rest = if self.lease_day == copied_on { self.blocks_left } else { DAY_BLOCKS };
        let of_days = days.saturating_mul(u32::from(DAY_BLOCKS) + u32::from(RESTORE_BLOCKS));
        of_days.saturating_add(u32::from(rest))
    }
}
