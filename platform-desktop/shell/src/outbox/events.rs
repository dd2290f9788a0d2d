//! What a driver tells the shell around it, and asks it.

use std::io;

use paros_core::badge::{LeaseAnswer, LeaseReport};
use paros_core::outbox::messages::SculptureId;
use paros_core::outbox::{DueCommand, HeadsetStatus, OutboxRefusal};

/// The shell around a driver.
pub trait OutboxHost {
    /// Milliseconds of a clock that goes on while the device sleeps and that nobody sets.
    fn now_ms(&mut self) -> u64;

    /// Random bits.
    fn random(&mut self) -> u32;

    /// How the headset is.
    fn status(&mut self) -> HeadsetStatus;

    /// A report of the badges' lease, where one is due and the lease is on the disk; it is sent at once.
    fn lease_report(&mut self) -> Option<LeaseReport>;

    /// Takes what has happened.
    fn on_event(&mut self, event: OutboxEvent);
}

/// What has happened.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum OutboxEvent {
    /// *Kept here*: the parcel is on the disk.
    KeptHere(SculptureId),
    /// *Kept at the booth*: it signed.
    KeptAtBooth(SculptureId),
    /// The booth says that it was deleted there; it is deleted here too.
    DeletedAtBooth(SculptureId),
    /// The booth can't take it. It stays here; the staff must look.
    RefusedByBooth(SculptureId),
    /// Its parcel is gone or damaged.
    Lost(SculptureId),
    /// The booth knew it as another's: it has a new id.
    Renewed {
        /// The id before.
        old: SculptureId,
        /// The id now.
        new: SculptureId,
    },
    /// The booth asks this now; what comes of it goes to
    /// [`OutboxDriver::note_command_done`](super::OutboxDriver::note_command_done).
    Command {
        /// What is asked.
        command: DueCommand,
        /// The visit under way as it came.
        session_id: u64,
        /// When its life ends, in milliseconds of the host's clock.
        ends_ms: u64,
    },
    /// The booth's answer to a report of the badges' lease.
    Lease(LeaseAnswer),
    /// The booth doesn't know this headset: it must be enrolled anew.
    UnknownToken,
    /// The booth's staff have shut this headset out.
    ShutOut,
    /// The journal can't be written. It is tried again.
    JournalUnwritten(io::ErrorKind),
    /// The journal was damaged. What the parcels say is known again.
    JournalDamaged,
}

/// Why a driver doesn't do what it was asked. Nothing has changed.
#[derive(Debug, thiserror::Error)]
pub enum OutboxError {
    /// The outbox refused.
    #[error(transparent)]
    Refused(#[from] OutboxRefusal),
    /// The disk did.
    #[error("the outbox's {name}: {source}")]
    Disk {
        /// The file.
        name: String,
        /// The system's reason.
        source: io::Error,
    },
}
