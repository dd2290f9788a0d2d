//! Capacities and times of the booth, each with its reason.

use std::ops::RangeInclusive;
use std::time::Duration;

/// Headsets that are let in at once: 200, and spares that take the place of broken ones.
pub const MAX_HEADSETS: u64 = 256;

/// Days for which an upload may wait, and still has its badge: a block rests so long before its numbers are used again.
pub const LATE_DAYS: u32 = 10;

/// Blocks of badges' numbers that are leased in a day at most. 200 headsets with 50 visits a day, of which 100 lose their
/// data daily, need 278. It bounds what can have been leased since a backup was made.
pub const DAY_BLOCKS: u16 = 512;

/// The longest step of the clock between two sweeps, which are five minutes apart, that no admin has to confirm.
pub const MAX_CLOCK_STEP: Duration = Duration::from_secs(3600);

/// The longest time between two starts that no admin has to confirm: a booth that is packed up for two weeks.
pub const MAX_CLOCK_GAP: Duration = Duration::from_secs(14 * 86_400);

/// Blocks that one headset is leased in a day at most: thirty times what visits take. A headset that lies about its losses
/// takes no more from the others.
pub const MAX_HEADSET_DAY_BLOCKS: usize = 32;

/// Days for which sculptures are kept at most: with [`LATE_DAYS`] the 28,672 blocks last for 103 days of 278.
pub const MAX_RETENTION_DAYS: u16 = 93;

/// From when on a headset that says nothing may have been wiped, and its number goes to one that enrols with its hint.
/// It says something every two seconds, and takes half a minute for a restart.
pub const SILENCE_OF_WIPED: Duration = Duration::from_secs(15);

/// How old what is kept of a headset's state may be: more often its heartbeats are written down only if it changed.
pub const STATUS_LIFE: Duration = Duration::from_secs(10);

/// How long a command lives: the visitor's situation isn't the same for longer.
pub const COMMAND_LIFE: Duration =
    Duration::from_millis(paros_protocol::limits::MAX_COMMAND_MS as u64);

/// Commands of a headset that wait at once.
pub const MAX_WAITING_COMMANDS: u64 = 8;

/// Announcements of a headset that are remembered: thirty times what a day brings. A headset that announces more is
/// out of order, and isn't told that they are noted.
pub const MAX_ANNOUNCED: u64 = 1500;

/// Sculptures that a list shows at once.
pub const MAX_LISTED: usize = 200;

/// Mails of a sculpture: a family's, and a mistake or two.
pub const MAX_MAILS_OF_ONE: u64 = 8;

/// How long it is from the first try of a mail to the second; then twice that, and so on.
pub const MIN_RETRY_WAIT: Duration = Duration::from_secs(60);

/// The longest time between two tries of a mail.
pub const MAX_RETRY_WAIT: Duration = Duration::from_secs(3600);

/// Tries of a mail: some three days, as a booth may be without the Internet for a weekend.
pub const MAX_MAIL_TRIES: u32 = 80;

/// Days for which the audit is kept: a season, and the one after it.
pub const AUDIT_DAYS: u16 = 400;

/// Sculptures of an export of all that is known under a badge: a leased one has one, and each is some 16 MB.
pub const MAX_EXPORTED: usize = 32;

/// How long a process has for a mesh, or for a mail, before another one begins it anew: a mesh takes a minute at most,
/// and a mail server is waited for that long. What may take longer, as a slice, it renews.
pub const WORK_LIFE: Duration = Duration::from_secs(150);

/// Processes that may be at the same records: so many pieces of work that others do are passed over.
pub const MAX_WORKERS: usize = 16;

/// Records that a sweep deals with in one transaction, so that requests find a gap between two.
pub const SWEEP_BATCH: usize = 64;

/// How long a login lasts that is used: a day at the booth.
pub const SESSION_LIFE: Duration = Duration::from_secs(14 * 3600);

/// How long a login lasts that isn't used: a tablet is left on a table.
pub const SESSION_IDLE: Duration = Duration::from_secs(2 * 3600);

/// Prints of a sculpture: a family's, and a mistake or two.
pub const MAX_PRINTS_OF_ONE: u64 = 8;

/// How high a print may be, in tenths of a millimetre: from what a nozzle can draw to the largest printers.
pub const PRINT_TENTHS_MM: RangeInclusive<u32> = 100..=10_000;

/// How long a print may take where its size follows from that, in minutes: up to a week.
pub const PRINT_MINUTES: RangeInclusive<u32> = 5..=10_080;

/// Letters of a filament's colour.
pub const MAX_FILAMENT_CHARS: usize = 40;

/// Letters of a print's note: what fits on its slip.
pub const MAX_NOTE_CHARS: usize = 300;

/// Pictograms from which on the badges that may be meant are looked for: with two there are too many.
pub const LEAST_HEARD: usize = 3;

/// Letters of a long word that may be wrong: any two names differ in two at least, long ones in more.
pub const MAX_SLIPS: usize = 2;

/// Badges that may be meant, and something has: a page of them.
pub const MAX_NEAREST: usize = 12;

/// Slices by which a size is found for a time: each takes up to a minute of a processor.
pub const MAX_SIZE_SLICES: u32 = 6;

/// How long a print that was sent waits for its printer to answer: whoever sent it stands before it, and has seen that
/// its bed is empty.
pub const SENDING_LIFE: Duration = Duration::from_secs(600);

/// How long a printer may be at something else after it got a print: it takes a file in, and heats.
pub const LIFE_AT_PRINTER: Duration = Duration::from_secs(60);
