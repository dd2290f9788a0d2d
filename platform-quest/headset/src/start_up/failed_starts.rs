//! The record of consecutive failed starts on the disk. A start counts as failed until its first frame, so
//! that a start that crashes the process, for instance in a driver, counts too.

use std::time::Duration;

use paros_core::codec::BadBytes;

use paros_shell::headset::sealed::{SEAL_BYTES, SealedFormat};
use paros_shell::last_use::{BootId, LastUse};

/// Consecutive failed starts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FailedStarts {
    /// The number of failed starts, at least 1.
    count: u32,
    /// The time and the boot of the last failure.
    last: LastUse,
}

/// The longest delay of a start.
const LONGEST_PAUSE: Duration = Duration::from_secs(60);

/// The time after the last failure from which older failures are ignored.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(600);

const FORMAT: SealedFormat = SealedFormat { magic: *b"PFST", expected: "PFST, starts that failed" };

impl FailedStarts {
    /// The length of an encoded record.
    pub const BYTES: usize = SEAL_BYTES + 4 + LastUse::BYTES;

    /// Returns the record with one more failure at `now`. Failures of another boot, or of long ago, are
    /// ignored.
    #[must_use]
    pub fn after_failure(before: Option<Self>, boot: BootId, now: Duration) -> Self {
        let before = before.filter(|before| before.is_remembered(boot, now));
        let count = before.map_or(1, |before| before.count.saturating_add(1));
        FailedStarts { count, last: LastUse { boot, since_boot: now } }
    }

    /// Returns the same record with the time of the last failure set to `now`.
    #[must_use]
    pub const fn failed_at(self, now: Duration) -> Self {
        FailedStarts { last: LastUse { since_boot: now, ..self.last }, ..self }
    }

    /// Returns the time at which the next start is due; `None` if it is due already. The pauses are 1, 2, 4
    /// .. 60 seconds.
    #[must_use]
    pub fn next_start(&self, boot: BootId, now: Duration) -> Option<Duration> {
        let seconds = 1u64.checked_shl(self.count.saturating_sub(1)).unwrap_or(u64::MAX);
        let pause = Duration::from_secs(seconds).min(LONGEST_PAUSE);
        let due = self.last.since_boot + pause;
        (self.is_remembered(boot, now) && due > now).then_some(due)
    }

    /// Returns the number of failed starts.
    #[must_use]
    pub const fn count(&self) -> u32 {
        self.count
    }

    fn is_remembered(&self, boot: BootId, now: Duration) -> bool {
        let ago = now.checked_sub(self.last.since_boot);
        self.last.boot == boot && ago.is_some_and(|ago| ago < FORGOTTEN_AFTER)
    }

    /// Encodes the record, with a checksum at the end.
    #[must_use]
    pub fn encode(&self) -> [u8; Self::BYTES] {
        FORMAT.seal(|to| {
            to.u32(self.count);
            to.bytes(&self.last.encode());
        })
    }

    /// Decodes a record.
    ///
    /// # Errors
    /// The first position at which the bytes are not as [`Self::encode`] writes them.
    pub fn decode(bytes: &[u8]) -> Result<Self, BadBytes> {
        FORMAT.open(bytes, |from| {
            let bad = from.error_here("a count from 1");
            let count = from.u32()?;
            if count == 0 {
                return Err(bad);
            }
            let last = LastUse::decode(from.bytes(LastUse::BYTES)?)?;
            Ok(FailedStarts { count, last })
        })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{BootId, FORGOTTEN_AFTER, FailedStarts};

    const BOOT: BootId = BootId::from_count(7);

    #[test]
    fn pauses_double_up_to_a_minute() {
        let (mut now, mut row, mut pauses) = (Duration::from_secs(1000), None, Vec::new());
        for _ in 0..9 {
            let failed = FailedStarts::after_failure(row, BOOT, now);
            let due = failed.next_start(BOOT, now).expect("a pause");
            pauses.push((due - now).as_secs());
            assert_eq!(failed.next_start(BOOT, due), None);
            (now, row) = (due, Some(failed));
        }
        assert_eq!(pauses, [1, 2, 4, 8, 16, 32, 60, 60, 60]);
        assert_eq!(row.map(|row| row.count()), Some(9));
        let many = FailedStarts { count: u32::MAX, ..row.expect("a row") };
        assert_eq!(FailedStarts::after_failure(Some(many), BOOT, now).count(), u32::MAX);
        assert!(many.next_start(BOOT, many.last.since_boot).is_some());
    }

    #[test]
    fn another_boot_and_a_long_time_are_a_fresh_start() {
        let then = Duration::from_secs(1000);
        let failed = FailedStarts::after_failure(None, BOOT, then).failed_at(then);
        let other = BootId::from_count(8);
        assert_eq!(failed.next_start(other, then), None);
        assert_eq!(FailedStarts::after_failure(Some(failed), other, then).count(), 1);
        assert_eq!(FailedStarts::after_failure(Some(failed), BOOT, then).count(), 2);
        let later = then + FORGOTTEN_AFTER;
        assert_eq!(FailedStarts::after_failure(Some(failed), BOOT, later).count(), 1);
        // A failure in the future can't be from this boot.
        assert_eq!(failed.next_start(BOOT, Duration::from_secs(5)), None);
    }

    #[test]
    fn what_is_written_is_read_and_each_changed_bit_is_seen() {
        let then = Duration::from_millis(123_456_789);
        let failed = FailedStarts::after_failure(None, BOOT, then);
        let failed = FailedStarts::after_failure(Some(failed), BOOT, then);
        let bytes = failed.encode();
        assert_eq!(FailedStarts::decode(&bytes), Ok(failed));
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes;
            changed[bit / 8] ^= 1 << (bit % 8);
            FailedStarts::decode(&changed).expect_err("a changed bit");
        }
        for length in 0..bytes.len() {
            FailedStarts::decode(&bytes[..length]).expect_err("a part");
        }
        FailedStarts::decode(&[&bytes[..], &[0]].concat()).expect_err("more than there is");
    }
}
