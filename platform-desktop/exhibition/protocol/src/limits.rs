//! Capacities of the messages, each with its reason.

use crate::ContentHash;

/// Announcements of a heartbeat: a day of 50 visits without the booth. More take turns. The answer repeats them: 64 take 6 KB
/// of [`MAX_ANSWER_BYTES`].
pub const MAX_ANNOUNCEMENTS: usize = 64;

/// Blocks of badges' numbers that a headset holds: 65 to 128 numbers, more than a day of 50 visits. While one is used up,
/// the other is there.
pub const MAX_HELD_BLOCKS: usize = 2;

/// Milliseconds that a command of the booth lives at most: whoever pressed the button still stands there.
pub const MAX_COMMAND_MS: u16 = 10_000;

/// Bytes of a parcel's head at most: eight times what its fields take.
pub const MAX_HEAD_BYTES: usize = 4096;

/// Bytes of a parcel's volume at most, unpacked: an `.rmap` at 256 with
/// [`MAX_INTERVALS`](paros_core::limits::MAX_INTERVALS) takes 1.5 MiB.
pub const MAX_PARCEL_VOLUME_BYTES: u32 = 2 << 20;

/// Bytes of a parcel's trace at most, unpacked: two hours, which is where a recording ends, at 116 bytes a tick take
/// 57 MiB.
pub const MAX_PARCEL_TRACE_BYTES: u32 = 64 << 20;

/// Bytes by which a packed file may be longer than it was, beside a thousandth: deflate stores what it can't make
/// shorter, in blocks with a head.
pub const MAX_PACKED_SURPLUS: u32 = 64;

/// Bytes of a whole parcel at most, without its hash: a trace packs to a hundredth, and at worst to a half.
pub const MAX_PARCEL_BYTES: u64 = 32 << 20;

/// Bytes of a parcel's file at most: the parcel and its hash.
pub const MAX_PARCEL_FILE_BYTES: u64 = MAX_PARCEL_BYTES + ContentHash::BYTES as u64;

/// Bytes of an answer's body at most: no answer of the booth has more.
pub const MAX_ANSWER_BYTES: usize = 8192;
