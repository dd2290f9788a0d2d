//! Leases of badge blocks.

use paros_protocol::{BlockSerial, HeldBlock};

use crate::record::record;
use crate::time::BoothTime;

record! {
    /// A block of 64 badge numbers that is leased, or rests after a lease. A block without a row is free.
    pub struct BadgeBlock in "badge_blocks", key 1 {
        /// The number of the block.
        pub block: u16,
        /// The headset that holds the lease, or held it last.
        pub headset: u32,
        /// The serial of the lease: the day of the lease, and a MAC that only the site can make.
        pub serial: [u8; 8],
        /// The headset's epoch at the lease.
        pub epoch: u64,
        /// The index of the next unused number, as last reported; `None` until the headset has reported the
        /// block. After the first report, a report without the block means that the headset has lost it.
        pub next: Option<u8>,
        /// The time of the lease, or of its first report after a restore.
        pub leased_at: BoothTime,
        /// The first day on which a resting block may be free; `None` while it is leased.
        pub free_on: Option<u32>,
    }
}

record! {
    /// The state of leasing: a single row.
    pub struct BadgeCursor in "badge_cursor", key 1 {
        /// Always 0.
        pub row: u8,
        /// The turn of the next block to try.
        pub turn: u16,
        /// The day of the last lease.
        pub day: u32,
        /// Number of blocks that may still be leased on that day.
        pub left_today: u16,
        /// The day until which no block is leased.
        pub closed_until: u32,
        /// After a restore: the time of the backup, until the blocks that may have been leased since are
        /// passed over. No block is leased meanwhile.
        pub copied_at: Option<BoothTime>,
        /// `true` if no free block was found. Reset by the next daily sweep.
        pub is_used_up: bool,
        /// The last day on which resting blocks were swept.
        pub swept_on: u32,
        /// The time of the last restore from a backup; 0 for never.
        pub restored_at: BoothTime,
    }
}

impl BadgeCursor {
    /// Makes the row of a booth that has never leased a block.
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
    /// Makes the row of a block that is leased to a headset in an epoch, from now on.
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

    /// Returns the block in the form that headset and booth exchange.
    #[must_use]
    pub fn held(&self) -> HeldBlock {
        let next = self.next.unwrap_or_default();
        HeldBlock { block: self.block, serial: BlockSerial(self.serial), next }
    }
}
