//! What the staff asks of a headset from the booth's page.

use serde::{Deserialize, Serialize};

use crate::limits::MAX_COMMAND_MS;
use crate::{ProtocolError, expect};

/// What is asked.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[repr(u8)]
pub enum CommandKind {
    /// "Which one is this?": it glows and beeps.
    Identify = 0,
    /// A minute more.
    Extend = 1,
    /// Hands off, now.
    End = 2,
    /// The stool before the visitor.
    Recentre = 3,
    /// The visitor has gone: what was sculpted is kept, the next one is welcome.
    Reset = 4,
}

/// A command of the booth, which rides on a heartbeat's answer, on each until its outcome is reported. A headset
/// carries it out at most once.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct BoothCommand {
    /// From 1, greater than those of all commands before to this headset.
    pub id: u64,
    /// The headset's start that it is for. For another start it does nothing.
    pub boot_id: u64,
    /// The visit that it is for, 0 for none. For a visit that has ended it does nothing.
    pub session_id: u64,
    /// What is asked.
    pub kind: CommandKind,
    /// What is left of its life in milliseconds, 1 to [`MAX_COMMAND_MS`], from when the heartbeat was sent whose answer
    /// carries it.
    pub lives_ms: u16,
}

/// The outcome of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CommandOutcome {
    /// It was carried out.
    Done,
    /// It came too late: its life, its visit or its start is over.
    Expired,
    /// The headset can't do it now, as to extend a visit that has no clock.
    Refused,
}

/// The last command that a headset took, and its outcome.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct CommandReport {
    /// Of the command.
    pub id: u64,
    /// The command's outcome.
    pub outcome: CommandOutcome,
}

impl CommandKind {
    /// By number.
    pub const ALL: [CommandKind; 5] = [
        CommandKind::Identify,
        CommandKind::Extend,
        CommandKind::End,
        CommandKind::Recentre,
        CommandKind::Reset,
    ];

    /// `true` if it is about the visit under way, and does nothing in another.
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
