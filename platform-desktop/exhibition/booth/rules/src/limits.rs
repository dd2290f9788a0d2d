//! Capacities and durations of the booth, each with its reason.

use std::ops::RangeInclusive;
use std::time::Duration;

/// Largest number of active headsets: 200, and spares that replace broken ones.
pub const MAX_HEADSETS: u64 = 256;

/// Days that a block rests before its numbers are used again. Uploads within them still own their badges.
pub const LATE_DAYS: u32 = 10;

/// Largest number of badge blocks that are leased in a day. 200 headsets with 50 visits a day, of which 100
/// lose their data daily, need 278. It bounds how many blocks may have been leased since a backup.
pub const DAY_BLOCKS: u16 = 512;

/// Largest clock step between two sweeps, five minutes apart, that needs no admin's confirmation.
pub const MAX_CLOCK_STEP: Duration = Duration::from_secs(3600);

/// Longest gap between two starts that needs no admin's confirmation: a booth packed up for two weeks.
pub const MAX_CLOCK_GAP: Duration = Duration::from_secs(14 * 86_400);

/// Largest number of blocks that one headset is leased in a day: thirty times what visits take. It limits
/// what a headset that lies about losses takes from the others.
pub const MAX_HEADSET_DAY_BLOCKS: usize = 32;

/// Longest retention in days: with [`LATE_DAYS`], the 28,672 blocks last for 103 days of 278 blocks.
pub const MAX_RETENTION_DAYS: u16 = 93;

/// Silence after which a headset may have been wiped, so that a device that enrols with its hint gets its
/// number. A headset sends a heartbeat every two seconds, and restarts in half a minute.
pub const SILENCE_OF_WIPED: Duration = Duration::from_secs(15);

/// Largest age of a headset's stored state. Within that time, only a changed heartbeat is written.
pub const STATUS_LIFE: Duration = Duration::from_secs(10);

/// Lifetime of a command: after it, the visitor's situation may have changed.
pub const COMMAND_LIFE: Duration =
    Duration::from_millis(paros_protocol::limits::MAX_COMMAND_MS as u64);

/// Largest number of waiting commands of a headset.
pub const MAX_WAITING_COMMANDS: u64 = 8;

/// Largest number of stored announcements of a headset: thirty times those of a day. A headset that announces
/// more is faulty, and further announcements aren't acknowledged.
pub const MAX_ANNOUNCED: u64 = 1500;

/// Largest number of sculptures on a page of a list.
pub const MAX_LISTED: usize = 200;

/// Largest number of mails of a sculpture: for a family, and a mistake or two.
pub const MAX_MAILS_OF_ONE: u64 = 8;

/// Wait between the first and the second try of a mail, doubled with each further try.
pub const MIN_RETRY_WAIT: Duration = Duration::from_secs(60);

/// Longest wait between two tries of a mail.
pub const MAX_RETRY_WAIT: Duration = Duration::from_secs(3600);

/// Largest number of tries of a mail: some three days, as a booth may be without the Internet for a weekend.
pub const MAX_MAIL_TRIES: u32 = 80;

/// Days for which the audit log is kept: a season, and the one after it.
pub const AUDIT_DAYS: u16 = 400;

/// Largest number of sculptures in an export of a badge. A leased badge has one sculpture, of some 16 MB.
pub const MAX_EXPORTED: usize = 32;

/// Lease of a process on a mesh or a mail, after which another process may restart it. A mesh takes a minute
/// at most, as does the timeout of a mail server. Work that takes longer, such as slicing, renews its lease.
pub const WORK_LIFE: Duration = Duration::from_secs(150);

/// Largest number of processes on the same records. A search for work skips as many pieces that others hold.
pub const MAX_WORKERS: usize = 16;

/// Records of a sweep in one transaction. Small batches let requests run in between.
pub const SWEEP_BATCH: usize = 64;

/// Longest login: a day at the booth.
pub const SESSION_LIFE: Duration = Duration::from_secs(14 * 3600);

/// Idle timeout of a login, such as of a tablet that is left on a table.
pub const SESSION_IDLE: Duration = Duration::from_secs(2 * 3600);

/// Largest number of prints of a sculpture: for a family, and a mistake or two.
pub const MAX_PRINTS_OF_ONE: u64 = 8;

/// Height of a print in tenths of a millimetre: from what a nozzle can draw to the largest printers.
pub const PRINT_TENTHS_MM: RangeInclusive<u32> = 100..=10_000;

/// Duration of a print whose size follows from the duration, in minutes: up to a week.
pub const PRINT_MINUTES: RangeInclusive<u32> = 5..=10_080;

/// Longest name of a filament's colour, in characters.
pub const MAX_FILAMENT_CHARS: usize = 40;

/// Longest note of a print, in characters: what fits on its slip.
pub const MAX_NOTE_CHARS: usize = 300;

/// Smallest number of pictograms for a search of similar badges: two match too many badges.
pub const LEAST_HEARD: usize = 3;

/// Largest number of wrong letters in a long word. Any two names differ in two letters, long names in more.
pub const MAX_SLIPS: usize = 2;

/// Largest number of similar badges with matches in a result: a page.
pub const MAX_NEAREST: usize = 12;

/// Largest number of slicer runs that search the size for a duration, each up to a processor minute.
pub const MAX_SIZE_SLICES: u32 = 6;

/// Timeout of a sent print that its printer hasn't answered: the sender still stands at the printer and knows
/// that its bed is empty.
pub const SENDING_LIFE: Duration = Duration::from_secs(600);

/// Time that a printer has to start a print that it received: it reads the file and heats up.
pub const LIFE_AT_PRINTER: Duration = Duration::from_secs(60);
