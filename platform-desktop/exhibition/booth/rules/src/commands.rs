//! Commands of staff to headsets.

use paros_protocol::CommandKind;

use crate::audit::{Subject, note};
use crate::booth::Booth;
use crate::heartbeat::device_status;
use crate::limits::{COMMAND_LIFE, MAX_WAITING_COMMANDS};
use crate::reason::Reason;
use crate::records::{Command, CommandState, Device};
use crate::refusal::Refusal;
use crate::time::BoothTime;

impl Booth {
    /// Queues a command for a headset, for the visit of its last heartbeat. The next heartbeat's answer
    /// carries the command. Returns its number.
    ///
    /// # Errors
    /// There is no such headset or visit, or too many commands wait; or a store error.
    pub fn ask_command(
        &self,
        headset: u32,
        kind: CommandKind,
        account: &str,
        now: BoothTime,
    ) -> Result<u64, Refusal> {
        self.update(|tx| {
            let device: Option<Device> = tx.get(&[&headset])?;
            let device = device.ok_or(Refusal::NotFound(Reason::NoHeadset))?;
            let last = device_status(&device)?.ok_or(Refusal::Conflict(Reason::NeverCame))?;
            let session_id = last.status.session_id;
            if kind.is_for_visit() && session_id == 0 {
                return Err(Refusal::Conflict(Reason::NotWorn));
            }
            let of_headset = "WHERE headset = ?1 AND state = ?2";
            let waiting = tx.count::<Command>(of_headset, &[&headset, &CommandState::Waiting])?;
            if waiting >= MAX_WAITING_COMMANDS {
                return Err(Refusal::Busy { what: "commands wait", retry_after: 10 });
            }
            let newest: Option<Command> =
                tx.find_first("WHERE headset = ?1 ORDER BY command DESC", &[&headset])?;
            // Derived from the clock, so that the numbers also increase after a restore that lacks the last
            // commands. A headset ignores numbers below its last one.
            let command = newest.map_or(0, |newest| newest.command.saturating_add(1)).max(now.0);
            tx.put(&Command {
                headset,
                command,
                boot: last.boot_id,
                session: if kind.is_for_visit() { session_id } else { 0 },
                kind: kind as u8,
                asked_at: now,
                state: CommandState::Waiting,
            })?;
            let subject = Subject { headset: Some(headset), ..Subject::default() };
            note(tx, now, Some(account), command_name(kind), subject)?;
            Ok(command)
        })
    }

    /// Returns a headset's commands and their states, the newest first.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_commands(
        &self,
        headset: u32,
        limit: usize,
        now: BoothTime,
    ) -> Result<Vec<Command>, Refusal> {
        let newest = "WHERE headset = ?1 ORDER BY command DESC LIMIT ?2";
        let mut commands: Vec<Command> = self.view(|tx| tx.find(newest, &[&headset, &limit]))?;
        for command in &mut commands {
            let is_open = matches!(command.state, CommandState::Waiting | CommandState::Sent);
            // The headset may be silent. It may still report later that it carried the command out in time.
            if is_open && now.since(command.asked_at) >= COMMAND_LIFE {
                command.state = CommandState::Expired;
            }
        }
        Ok(commands)
    }
}

/// Returns the name of a command for the audit log.
const fn command_name(kind: CommandKind) -> &'static str {
    match kind {
        CommandKind::Identify => "identify",
        CommandKind::Extend => "extend",
        CommandKind::End => "end",
        CommandKind::Recentre => "recentre",
        CommandKind::Reset => "reset",
    }
}
