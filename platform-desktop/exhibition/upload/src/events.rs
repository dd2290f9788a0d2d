//! What a sender asks the shell around it, and reports to it.

use paros_protocol::{CommandKind, HeadsetStatus, SculptureId, SiteId};

/// Whose outbox it is. An enrolment gives both.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct OutboxOwner {
    /// The site whose booth keeps the sculptures.
    pub site: SiteId,
    /// The headset's number there, from 1.
    pub headset: u32,
}

/// A command of the booth to carry out now, in its visit alone. Its outcome goes to
/// [`Sender::note_command_done`](super::Sender::note_command_done).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RemoteCommand {
    /// The command's number.
    pub id: u64,
    /// What is asked.
    pub kind: CommandKind,
    /// The visit under way as the command came.
    pub session_id: u64,
}

/// How the booth answers this device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BoothContact {
    /// No answer came to the last heartbeat, or none was sent yet.
    Silent,
    /// The booth answers heartbeats.
    Open,
    /// The booth doesn't know this device, which must enrol again.
    Forgotten,
    /// The booth's staff have shut this device out.
    ShutOut,
}

/// The shell around a sender.
pub trait OutboxHost {
    /// Milliseconds of a clock that runs on while the device sleeps and that nobody sets.
    fn now_ms(&mut self) -> u64;

    /// Random bits.
    fn random(&mut self) -> u32;

    /// How the headset is.
    fn status(&mut self) -> HeadsetStatus;

    /// Takes an event.
    fn on_event(&mut self, event: OutboxEvent);
}

/// What has happened.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum OutboxEvent {
    /// *Kept at the booth*.
    KeptAtBooth(SculptureId),
    /// The sculpture was deleted at the booth; its parcel is deleted here too.
    DeletedAtBooth(SculptureId),
    /// The booth can't take the parcel. It stays here; staff must look.
    RefusedByBooth(SculptureId),
    /// The parcel is gone or damaged.
    Lost(SculptureId),
    /// The booth asks for this now.
    Command {
        /// The command.
        command: RemoteCommand,
        /// When the command's life ends, in milliseconds of the host's clock.
        ends_ms: u64,
    },
}
