//! Capacities of the messages, each with its reason.

use crate::ContentHash;

/// Announcements of a heartbeat: a day of 50 visits without the booth. If there are more, they take turns.
/// The answer repeats them: 64 take 6 KB of [`MAX_ANSWER_BYTES`].
pub const MAX_ANNOUNCEMENTS: usize = 64;

/// Blocks of badge numbers that a headset holds: 65 to 128 numbers, more than a day of 50 visits. When one
/// block is used up, the other is still there.
pub const MAX_HELD_BLOCKS: usize = 2;

/// Longest lifetime of a command in milliseconds: the staff member who pressed the button is still there.
pub const MAX_COMMAND_MS: u16 = 10_000;

/// Largest head of a parcel in bytes: eight times what its fields take.
pub const MAX_HEAD_BYTES: usize = 4096;

/// Largest unpacked volume of a parcel in bytes: an `.rmap` at 256 with
/// [`MAX_INTERVALS`](paros_core::limits::MAX_INTERVALS) takes 1.5 MiB.
pub const MAX_PARCEL_VOLUME_BYTES: u32 = 2 << 20;

/// Largest unpacked trace of a parcel in bytes. A recording ends after two hours: at 116 bytes a tick it
/// takes 57 MiB.
pub const MAX_PARCEL_TRACE_BYTES: u32 = 64 << 20;

/// Largest overhead of deflate in bytes, besides a thousandth of the length: it stores incompressible data in
/// blocks with headers.
pub const MAX_PACKED_SURPLUS: u32 = 64;

/// Largest parcel in bytes, without its hash. A trace packs to a hundredth, at worst to a half.
pub const MAX_PARCEL_BYTES: u64 = 32 << 20;

/// Largest parcel file in bytes: the parcel and its hash.
pub const MAX_PARCEL_FILE_BYTES: u64 = MAX_PARCEL_BYTES + ContentHash::BYTES as u64;

/// Largest body of an answer in bytes. No answer of the booth is longer.
pub const MAX_ANSWER_BYTES: usize = 8192;
