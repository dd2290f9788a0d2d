//! The interface between a sender and its host: identity, requests and events.

use paros_protocol::{CommandKind, HeadsetStatus, SculptureId, SiteId};

/// The identity of an outbox, which an enrolment assigns.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct OutboxOwner {
    /// The site whose booth keeps the sculptures.
    pub site: SiteId,
    /// The number of the headset at the site, from 1.
    pub headset: u32,
}

/// A command of the booth to carry out now, only in its visit. Report its outcome with
/// [`Sender::note_command_done`](super::Sender::note_command_done).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RemoteCommand {
    /// The command's number.
    pub id: u64,
    /// The kind of the command.
    pub kind: CommandKind,
    /// The visit under way when the command arrived.
    pub session_id: u64,
}

/// The booth's response to this device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BoothContact {
    /// The last heartbeat wasn't answered, or none was sent yet.
    Silent,
    /// The booth answers heartbeats.
    Open,
    /// The booth doesn't know this device, which must enrol again.
    Forgotten,
    /// The booth's staff have excluded this device.
    ShutOut,
}

/// The host of a sender: clock, random bits, status and event handler.
pub trait OutboxHost {
    /// Returns the milliseconds of a monotonic clock that also runs while the device sleeps.
    fn now_ms(&mut self) -> u64;

    /// Returns random bits.
    fn random(&mut self) -> u32;

    /// Returns the status of the headset.
    fn status(&mut self) -> HeadsetStatus;

    /// Handles an event.
    fn on_event(&mut self, event: OutboxEvent);
}

/// An event of a sender.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum OutboxEvent {
    /// *Kept at the booth*.
    KeptAtBooth(SculptureId),
    /// The sculpture was deleted at the booth; its parcel is deleted here too.
    DeletedAtBooth(SculptureId),
    /// The booth refused the parcel. It stays here, and staff must look at it.
    RefusedByBooth(SculptureId),
    /// The parcel is gone or damaged.
    Lost(SculptureId),
    /// The booth sent a command to carry out now.
    Command {
        /// The command.
        command: RemoteCommand,
        /// The time when the command expires, in milliseconds of the host's clock.
        ends_ms: u64,
    },
}
