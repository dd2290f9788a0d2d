//! Commands that staff send to a headset from the booth's page.

use serde::{Deserialize, Serialize};

use crate::limits::MAX_COMMAND_MS;
use crate::{ProtocolError, expect};

/// The kind of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum CommandKind {
    /// The headset glows and beeps, so that staff can find it.
    Identify = 0,
    /// Adds a minute to the visit.
    Extend = 1,
    /// Ends sculpting now: hands off.
    End = 2,
    /// Moves the stool in front of the visitor.
    Recentre = 3,
    /// Ends the visit of a visitor who has gone. The sculpture is kept, and the next visitor can start.
    Reset = 4,
}

/// A command of the booth. Every heartbeat answer repeats the command until the headset reports its outcome.
/// A headset carries it out at most once.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct BoothCommand {
    /// A number from 1, greater than the ids of all earlier commands to this headset.
    pub id: u64,
    /// The program start (`boot_id`) of the headset that the command is for. Other starts ignore the command.
    pub boot_id: u64,
    /// The visit that the command is for, or 0 for none. Without effect after that visit has ended.
    pub session_id: u64,
    /// The kind of the command.
    pub kind: CommandKind,
    /// The remaining lifetime in milliseconds, 1 to [`MAX_COMMAND_MS`], counted from when the headset sent
    /// the heartbeat.
    pub lives_ms: u16,
}

/// The outcome of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CommandOutcome {
    /// The command was carried out.
    Done,
    /// The command came too late: its lifetime, its visit or its program start is over.
    Expired,
    /// The headset can't do it now, such as to extend a visit without a time limit.
    Refused,
}

/// The last command that a headset received, and its outcome.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct CommandReport {
    /// The id of the command.
    pub id: u64,
    /// The outcome of the command.
    pub outcome: CommandOutcome,
}

impl CommandKind {
    /// All kinds, in the order of their numbers.
    pub const ALL: [CommandKind; 5] = [
        CommandKind::Identify,
        CommandKind::Extend,
        CommandKind::End,
        CommandKind::Recentre,
        CommandKind::Reset,
    ];

    /// `true` if the command applies to the visit under way, and has no effect in another visit.
    #[must_use]
    pub const fn is_for_visit(self) -> bool {
        matches!(self, CommandKind::Extend | CommandKind::End | CommandKind::Reset)
    }
}

impl BoothCommand {
    pub(crate) fn check(&self) -> Result<(), ProtocolError> {
        expect(self.id != 0, "command.id", "a number from 1")?;
        let is_alive = (1..=MAX_COMMAND_MS).contains(&self.lives_ms);
        expect(is_alive, "command.lives_ms", "1 to 10,000 ms")
    }
}

impl CommandReport {
    pub(crate) const fn check(&self) -> Result<(), ProtocolError> {
        expect(self.id != 0, "last_command.id", "a number from 1")
    }
}
