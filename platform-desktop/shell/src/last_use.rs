//! The time of the last use of a device that visitors share, stored beside the save of a session: the time
//! since boot, and an identifier of the boot. A wall clock is unsuitable, as a headset's may be set at any
//! time.

use std::fs;
use std::time::Duration;

use paros_core::codec::BadBytes;

use crate::headset::sealed::{SEAL_BYTES, SealedFormat};

/// The greatest age of the stored time of the last use while the device is used.
const STAMP_INTERVAL: Duration = Duration::from_secs(5);

/// An identifier of one boot of a device, unique among all devices.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BootId(u128);

/// The time of the last use.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LastUse {
    /// The boot from which the time is counted.
    pub boot: BootId,
    /// The time since that boot, including sleep; stored in whole milliseconds.
    pub since_boot: Duration,
}

/// The time of the last use, and the last time that was returned to be stored. Both are times of one clock.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct UseClock {
    /// `None` until the device is used.
    pub last_use: Option<Duration>,
    stamped: Option<Duration>,
}

const FORMAT: SealedFormat =
    SealedFormat { magic: *b"PLUS", expected: "PLUS, the time of the last use" };

impl BootId {
    /// Parses a UUID as in `/proc/sys/kernel/random/boot_id`: 32 hexadecimal digits with hyphens among them.
    /// Returns `None` for any other text.
    #[must_use]
    pub fn parse_uuid(text: &str) -> Option<Self> {
        let digits: String = text.trim_end().chars().filter(|letter| *letter != '-').collect();
        let is_hex = digits.len() == 32 && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        is_hex.then(|| u128::from_str_radix(&digits, 16).ok().map(BootId)).flatten()
    }

    /// Reads the kernel's identifier of this boot. Returns `None` if it can't be read.
    #[must_use]
    pub fn read_from_kernel() -> Option<Self> {
        BootId::parse_uuid(&fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?)
    }

    /// Returns the identifier for a boot counter. It can't equal a UUID's, as no UUID is so small.
    #[must_use]
    pub const fn from_count(boots: u32) -> Self {
        BootId(boots as u128)
    }
}

impl LastUse {
    /// The length of an encoded time in bytes.
    pub const BYTES: usize = SEAL_BYTES + 16 + 8;

    /// Returns a use at this moment, from the kernel's files. `/proc/uptime` includes sleep, and is in
    /// hundredths of a second. Returns `None` on systems without these files.
    #[must_use]
    pub fn read_now() -> Option<Self> {
        let uptime = fs::read_to_string("/proc/uptime").ok()?;
        let seconds = uptime.split(' ').next()?.parse().ok()?;
        let since_boot = Duration::try_from_secs_f64(seconds).ok()?;
        Some(LastUse { boot: BootId::read_from_kernel()?, since_boot })
    }

    /// Returns the time from this use to `now`, a time since `boot`; `None` if the use was in another boot,
    /// or the boot is unknown.
    #[must_use]
    pub fn time_until(&self, boot: Option<BootId>, now: Duration) -> Option<Duration> {
        let is_same = boot == Some(self.boot);
        now.checked_sub(self.since_boot).filter(|_| is_same)
    }

    /// Encodes the time, with a checksum at the end.
    #[must_use]
    pub fn encode(&self) -> [u8; Self::BYTES] {
        FORMAT.seal(|to| {
            to.bytes(&self.boot.0.to_le_bytes());
            to.u64(u64::try_from(self.since_boot.as_millis()).unwrap_or(u64::MAX));
        })
    }

    /// Decodes a time.
    ///
    /// # Errors
    /// Returns the first place at which the bytes differ from what [`Self::encode`] writes.
    pub fn decode(bytes: &[u8]) -> Result<Self, BadBytes> {
        FORMAT.open(bytes, |from| {
            let id = from.bytes(16)?.iter().rev().fold(0, |id, byte| id << 8 | u128::from(*byte));
            let since_boot = Duration::from_millis(from.u64()?);
            Ok(LastUse { boot: BootId(id), since_boot })
        })
    }
}

impl UseClock {
    /// Notes a use. Returns the time since the use before it.
    pub fn note_use(&mut self, now: Duration) -> Option<Duration> {
        self.last_use.replace(now).map(|last| now.saturating_sub(last))
    }

    /// Returns the time of the last use if the stored one is too old.
    pub fn take_due_stamp(&mut self) -> Option<Duration> {
        let last = self.last_use?;
        let is_due = self.stamped.is_none_or(|stamped| last >= stamped + STAMP_INTERVAL);
        is_due.then(|| *self.stamped.insert(last))
    }

    /// Returns the time of the last use unless it is stored already. Call it before the process may end or
    /// the device may sleep.
    pub fn take_last_stamp(&mut self) -> Option<Duration> {
        let last = self.last_use?;
        (self.stamped != Some(last)).then(|| *self.stamped.insert(last))
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{BootId, LastUse, STAMP_INTERVAL, UseClock};

    const UUID: &str = "6af84ad0-079a-4d3a-a5d5-bbed09b02c54\n";

    #[test]
    fn boots_are_told_apart_by_their_uuid() {
        let boot = BootId::parse_uuid(UUID).expect("a boot");
        assert_eq!(BootId::parse_uuid(UUID.trim()), Some(boot));
        let other = BootId::parse_uuid("6af84ad0-079a-4d3a-a5d5-bbed09b02c55");
        assert!(other.is_some() && other != Some(boot));
        for text in ["", "\n", "6af84ad0-079a", "+af84ad0079a4d3aa5d5bbed09b02c54", &UUID.repeat(2)]
        {
            assert_eq!(BootId::parse_uuid(text), None, "{text:?}");
        }
    }

    #[test]
    fn a_time_is_long_ago_in_its_own_boot_alone() {
        let (boot, since_boot) = (BootId::from_count(3), Duration::from_secs(50));
        let used = LastUse { boot, since_boot };
        let until = |boot, seconds| used.time_until(boot, Duration::from_secs(seconds));
        assert_eq!(until(Some(boot), 72), Some(Duration::from_secs(22)));
        assert_eq!(until(Some(boot), 49), None, "it is later than now");
        assert_eq!(until(Some(BootId::from_count(4)), 72), None);
        assert_eq!(until(None, 72), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_kernel_tells_of_now() {
        let first = LastUse::read_now().expect("Linux has both files");
        assert!(first.since_boot > Duration::ZERO);
        let again = LastUse::read_now().expect("still");
        let between = first.time_until(Some(again.boot), again.since_boot);
        assert!(between.is_some_and(|between| between < Duration::from_secs(60)), "{between:?}");
    }

    #[test]
    fn what_is_written_is_read_and_each_changed_bit_is_seen() {
        let boot = BootId::parse_uuid(UUID).expect("a boot");
        let used = LastUse { boot, since_boot: Duration::from_millis(123_456_789) };
        let bytes = used.encode();
        assert_eq!(LastUse::decode(&bytes), Ok(used));
        for bit in 0..8 * bytes.len() {
            let mut changed = bytes;
            changed[bit / 8] ^= 1 << (bit % 8);
            let bad = LastUse::decode(&changed).expect_err("a changed bit");
            assert!(bad.offset < bytes.len());
        }
        for len in 0..bytes.len() {
            assert!(LastUse::decode(&bytes[..len]).is_err(), "{len} bytes");
        }
        assert!(LastUse::decode(&[&bytes[..], &[0]].concat()).is_err(), "a byte more");
    }

    #[test]
    fn a_stamp_is_due_after_five_seconds_of_use_and_the_last_one_whenever_it_is_new() {
        let mut clock = UseClock::default();
        assert_eq!((clock.take_due_stamp(), clock.take_last_stamp()), (None, None), "no use yet");
        let [first, soon, later] = [7, 8, 12].map(Duration::from_secs);
        assert_eq!(clock.note_use(first), None);
        assert_eq!([clock.take_due_stamp(), clock.take_due_stamp()], [Some(first), None]);
        assert_eq!(clock.note_use(soon), Some(soon - first));
        assert_eq!(clock.take_due_stamp(), None, "the one on the disk is hardly older");
        assert_eq!([clock.take_last_stamp(), clock.take_last_stamp()], [Some(soon), None]);
        clock.note_use(later);
        assert_eq!(clock.take_due_stamp(), None);
        clock.note_use(soon + STAMP_INTERVAL);
        assert_eq!(clock.take_due_stamp(), Some(soon + STAMP_INTERVAL));
    }
}
