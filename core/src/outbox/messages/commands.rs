//! What the staff asks of a headset from the booth's page.

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::limits::MAX_COMMAND_MS;
use crate::outbox::messages::fields::read_numbered;

/// What is asked.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
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
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
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

/// What became of a command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum CommandOutcome {
    /// It was carried out.
    Done = 0,
    /// It came too late: its life, its visit or its start is over.
    Expired = 1,
    /// The headset can't do it now, as to extend a visit that has no clock.
    Refused = 2,
}

/// The last command that a headset took, and what became of it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CommandReport {
    /// Of the command.
    pub id: u64,
    /// What became of it.
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

    /// Whether it is about the visit under way, and does nothing in another.
    #[must_use]
    pub const fn is_for_visit(self) -> bool {
        matches!(self, CommandKind::Extend | CommandKind::End | CommandKind::Reset)
    }
}

impl CommandOutcome {
    /// By number.
    pub const ALL: [CommandOutcome; 3] =
        [CommandOutcome::Done, CommandOutcome::Expired, CommandOutcome::Refused];
}

impl BoothCommand {
    /// Length of a written command in bytes.
    pub(super) const BYTES: usize = 27;

    pub(super) fn write(&self, to: &mut ByteWriter<'_>) {
        to.u64(self.id);
        to.u64(self.boot_id);
        to.u64(self.session_id);
        to.u8(self.kind as u8);
        to.u16(self.lives_ms);
    }

    pub(super) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let id = read_command_id(from)?;
        let (boot_id, session_id) = (from.u64()?, from.u64()?);
        let kind = read_numbered(from, &CommandKind::ALL, "a command, 0 to 4")?;
        let bad = from.error_here("a command's life, 1 to 10,000 ms");
        let lives_ms = from.u16()?;
        if lives_ms == 0 || lives_ms > MAX_COMMAND_MS {
            return Err(bad);
        }
        Ok(BoothCommand { id, boot_id, session_id, kind, lives_ms })
    }
}

impl CommandReport {
    /// Length of a written report in bytes.
    pub(super) const BYTES: usize = 9;

    pub(super) fn write(&self, to: &mut ByteWriter<'_>) {
        to.u64(self.id);
        to.u8(self.outcome as u8);
    }

    pub(super) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let id = read_command_id(from)?;
        let expected = "what became of a command, 0 to 2";
        let outcome = read_numbered(from, &CommandOutcome::ALL, expected)?;
        Ok(CommandReport { id, outcome })
    }
}

fn read_command_id(from: &mut ByteReader<'_>) -> Result<u64, BadBytes> {
    let bad = from.error_here("a command's id, from 1");
    Some(from.u64()?).filter(|&id| id != 0).ok_or(bad)
}
