//! Capacities of parcels, the outbox that sends them and what it hears.

/// Announcements of a heartbeat: all of half a day without the booth. More take turns.
pub const MAX_ANNOUNCEMENTS: usize = 32;

/// Milliseconds that a command of the booth lives at most: whoever pressed the button still stands there.
pub const MAX_COMMAND_MS: u16 = 10_000;

/// Bytes of a parcel's volume at most, unpacked: an `.rmap` at 256 with [`MAX_INTERVALS`](super::MAX_INTERVALS) takes 1.5 MiB.
pub const MAX_PARCEL_VOLUME_BYTES: u32 = 2 << 20;

/// Bytes of a parcel's trace at most, unpacked: two hours, which is where a recording ends, at 116 bytes a tick take
/// 57 MiB.
pub const MAX_PARCEL_TRACE_BYTES: u32 = 64 << 20;

/// Bytes by which a packed file may be longer than it was, beside a thousandth: deflate stores what it can't make
/// shorter, in blocks with a head.
pub const MAX_PACKED_SURPLUS: u32 = 64;

/// Bytes of a whole parcel at most: a trace packs to a hundredth, and at worst to a half.
pub const MAX_PARCEL_BYTES: u64 = 32 << 20;

/// Sculptures that an outbox knows: five days of 50 visits without the booth, and some.
pub const MAX_OUTBOX_ENTRIES: usize = 256;

/// Percent of an outbox's table beyond which what is signed for leaves before its grace ends, if the booth said in this start
/// that it has it: the last fifth is for what comes, a day's visits.
pub const MAX_SIGNED_PERCENT: u8 = 80;

/// The same of its bytes: the largest parcel finds room where the smallest setting is set, 64 MB.
pub const MAX_SIGNED_BYTES_PERCENT: u8 = 45;

/// Percent of either beyond which it leaves though the booth didn't say so: what is owed comes first.
pub const MAX_UNASKED_PERCENT: u8 = 95;

/// Bytes of a parcel that are sent at once: a second of a weak radio link, which is lost where it fails.
pub const MAX_CHUNK_BYTES: u32 = 256 << 10;

/// Milliseconds without an answer after which a request has failed: a part at 35 kbit/s.
pub const UPLOAD_TIMEOUT_MS: u64 = 60_000;

/// Milliseconds after the first request that came to nothing; twice as long after each more.
pub const UPLOAD_WAIT_MS: u64 = 2_000;

/// Milliseconds between requests that come to nothing, at most: a visitor waits no longer at the booth once it is back.
pub const MAX_UPLOAD_WAIT_MS: u64 = 60_000;

/// Seconds that a booth may ask to be left alone, at most.
pub const MAX_RETRY_AFTER_SECONDS: u32 = 600;

/// Milliseconds until what the booth refused is tried again, once somebody may have mended the booth: six hours.
pub const REFUSED_RETRY_MS: u64 = 6 * 3600 * 1000;

/// Milliseconds between heartbeats: what a press on the staff's page waits at most.
pub const HEARTBEAT_MS: u64 = 2_000;

/// Milliseconds after which a headset asks again whether the booth has what it signed for, as long as it is here too: what a
/// booth lost that came back from a copy is on its way again in a minute or two, and a day's sculptures of all headsets cost
/// it a few look-ups a second.
pub const CONFIRM_MS: u64 = 60_000;

/// Milliseconds without an answer after which a heartbeat has failed: a command in it would be dead.
pub const HEARTBEAT_TIMEOUT_MS: u64 = MAX_COMMAND_MS as u64;

/// Milliseconds between heartbeats that aren't answered, at most: as long as a command lives.
pub const MAX_HEARTBEAT_WAIT_MS: u64 = MAX_COMMAND_MS as u64;
