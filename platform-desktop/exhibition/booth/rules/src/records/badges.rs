//! Who holds which numbers of badges.

use paros_protocol::{BlockSerial, HeldBlock};

use crate::record::record;
use crate::time::BoothTime;

record! {
    /// A block of 64 numbers that is leased, or rests after a lease. A block without a row is free.
    pub struct BadgeBlock in "badge_blocks", key 1 {
        /// The block.
        pub block: u16,
        /// The headset that it is leased to, or was.
        pub headset: u32,
        /// Names this lease: the day of the lease, and what only the site can make of it.
        pub serial: [u8; 8],
        /// The headset's epoch in which it was leased.
        pub epoch: u64,
        /// The place of the next number, as the headset last reported it; `None` until it has reported the block. From then
        /// on a report without the block says that the headset doesn't have it any more.
        pub next: Option<u8>,
        /// When it was leased, or first heard of after a restore.
        pub leased_at: BoothTime,
        /// For a block that rests: the first day on which it may be free. `None` while it is leased.
        pub free_on: Option<u32>,
    }
}

record! {
    /// Where the leasing of blocks stands: a single row.
    pub struct BadgeCursor in "badge_cursor", key 1 {
        /// Always 0.
        pub row: u8,
        /// The turn of the block that is looked at next.
        pub turn: u16,
        /// The day of the last lease.
        pub day: u32,
        /// Blocks that may yet be leased on that day.
        pub left_today: u16,
        /// Until this day no block is leased.
        pub closed_until: u32,
        /// For a booth that came back from a backup, and hasn't passed over what may have been leased since: when the backup
        /// was made. No block is leased.
        pub copied_at: Option<BoothTime>,
        /// Whether no block was free when one was looked for; until the next sweep.
        pub is_used_up: bool,
        /// The last day on which resting blocks were looked at.
        pub swept_on: u32,
        /// When the booth last came back from a backup; 0 if it never did.
        pub restored_at: BoothTime,
    }
}

impl BadgeCursor {
    /// The row of a booth that leased nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        BadgeCursor {
            row: 0,
            turn: 0,
            day: 0,
            left_today: 0,
            closed_until: 0,
            copied_at: None,
            is_used_up: false,
            swept_on: 0,
            restored_at: BoothTime(0),
        }
    }
}

impl Default for BadgeCursor {
    fn default() -> Self {
        Self::new()
    }
}

impl BadgeBlock {
    /// A block that is leased to a headset from now on, in an epoch of its.
    pub(crate) const fn leased(
        (block, serial): (u16, BlockSerial),
        (headset, epoch): (u32, u64),
        now: BoothTime,
    ) -> Self {
        BadgeBlock {
            block,
            headset,
            serial: serial.0,
            epoch,
            next: None,
            leased_at: now,
            free_on: None,
        }
    }

    /// The block, as headset and booth tell each other of it.
    #[must_use]
    pub fn held(&self) -> HeldBlock {
        let next = self.next.unwrap_or_default();
        HeldBlock { block: self.block, serial: BlockSerial(self.serial), next }
    }
}
