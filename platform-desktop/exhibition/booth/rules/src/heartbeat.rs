//! Heartbeats of headsets, and the commands that their answers carry.
//!
//! A heartbeat without news is answered without a write. Otherwise the changes are planned in a read-only
//! transaction first, and planned again in the transaction that writes them.

use paros_core::badge::BadgeNumber;
use paros_protocol::{
    BadgeReport, BoothCommand, CommandKind, CommandOutcome, HeadsetStatus, Heartbeat,
    HeartbeatAnswer, UploadStatus,
};

use crate::badges::{BadgePlan, store_epoch};
use crate::booth::{Booth, Tx};
use crate::limits::{COMMAND_LIFE, MAX_ANNOUNCED, STATUS_LIFE};
use crate::reason::Reason;
use crate::records::{Announcement, Command, CommandState, Device, Sculpture, Tombstone};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;

/// The changes and the answer that follow from a heartbeat.
#[derive(Default)]
struct HeartbeatPlan {
    device: Option<Device>,
    commands: Vec<Command>,
    announcements: Vec<Announcement>,
    /// The acknowledged announcements, valid once the changes are written.
    noted: Vec<paros_protocol::Announcement>,
    badges: BadgePlan,
    store_epoch: u64,
    /// The command of the answer.
    command: Option<BoothCommand>,
}

impl Booth {
    /// Answers a heartbeat. All changes that the answer reports are stored before this returns.
    ///
    /// # Errors
    /// The heartbeat names another headset; or a store error.
    pub fn take_heartbeat(
        &self,
        device: &Device,
        beat: &Heartbeat,
        now: BoothTime,
    ) -> Result<HeartbeatAnswer, Refusal> {
        if beat.headset != device.headset {
            return Err(Refusal::Forbidden(Reason::ForeignHeartbeat));
        }
        let plan = self.view(|tx| self.plan_heartbeat(tx, device, beat, now))?;
        let plan = if plan.changes_nothing() {
            plan
        } else {
            self.update(|tx| {
                let plan = self.plan_heartbeat(tx, device, beat, now)?;
                plan.write(tx)?;
                Ok(plan)
            })?
        };
        Ok(HeartbeatAnswer {
            site: self.keys.site,
            headset: beat.headset,
            boot_id: beat.boot_id,
            number: beat.number,
            booth_time: now.seconds(),
            store_epoch: plan.store_epoch,
            badges: plan.badges.held,
            command: plan.command,
            noted: plan.noted,
        })
    }

    fn plan_heartbeat(
        &self,
        tx: &mut Tx<'_>,
        device: &Device,
        beat: &Heartbeat,
        now: BoothTime,
    ) -> Result<HeartbeatPlan, StoreError> {
        let mut plan = HeartbeatPlan { store_epoch: store_epoch(tx)?, ..HeartbeatPlan::default() };
        // Read the device again: it may have been excluded or enrolled again since.
        let is_same =
            |known: &Device| known.revoked_at.is_none() && known.token_hash == device.token_hash;
        let known: Option<Device> = tx.get(&[&device.headset])?;
        if let Some(device) = known.filter(is_same) {
            plan.device = plan_status(device, beat, now)?;
            plan.badges = self.plan_badges(tx, beat.headset, &beat.badges, now)?;
        }
        plan_commands(tx, beat, now, &mut plan)?;
        plan_announcements(tx, beat, now, &mut plan)?;
        Ok(plan)
    }
}

impl HeartbeatPlan {
    const fn changes_nothing(&self) -> bool {
        self.device.is_none()
            && self.commands.is_empty()
            && self.announcements.is_empty()
            && self.badges.changes_nothing()
    }

    fn write(&self, tx: &mut Tx<'_>) -> Result<(), StoreError> {
        if let Some(device) = &self.device {
            tx.put(device)?;
        }
        self.badges.write(tx)?;
        self.commands.iter().try_for_each(|command| tx.put(command))?;
        self.announcements.iter().try_for_each(|announcement| tx.put(announcement))
    }
}

/// Returns the last heartbeat that was stored for a device.
///
/// # Errors
/// The stored bytes aren't a heartbeat, which the booth never writes.
pub fn device_status(device: &Device) -> Result<Option<Heartbeat>, StoreError> {
    if device.status.is_empty() {
        return Ok(None);
    }
    let bad = StoreError::BadRow { table: "devices", column: "status" };
    Heartbeat::from_json(&device.status).map(Some).map_err(|_| bad)
}

/// Returns the device record to store, or `None` if the stored one is still good enough.
fn plan_status(
    mut device: Device,
    beat: &Heartbeat,
    now: BoothTime,
) -> Result<Option<Device>, StoreError> {
    let status = Heartbeat {
        number: 1,
        // The blocks are stored in their own table.
        badges: BadgeReport { epoch: 1, blocks: Vec::new() },
        last_command: None,
        announcements: Vec::new(),
        ..beat.clone()
    };
    // A status of another protocol version is ignored.
    let last = device_status(&device).unwrap_or_default();
    // The passing of seconds alone is no news.
    let is_same = last.as_ref().is_some_and(|last| {
        let worn_seconds = status.status.worn_seconds;
        let now = HeadsetStatus { worn_seconds, ..last.status };
        Heartbeat { status: now, ..last.clone() } == status
    });
    let is_fresh =
        device.seen_at.is_some_and(|seen_at| now >= seen_at && now.since(seen_at) < STATUS_LIFE);
    if is_same && is_fresh {
        return Ok(None);
    }
    let is_other_start = last.is_some_and(|last| last.boot_id != beat.boot_id);
    if is_other_start && beat.was_wiped {
        device.wiped_at = Some(now);
    }
    device.seen_at = Some(now);
    device.status = status.to_json();
    Ok(Some(device))
}

/// Updates the states of commands, and picks the first live command for the answer.
fn plan_commands(
    tx: &mut Tx<'_>,
    beat: &Heartbeat,
    now: BoothTime,
    plan: &mut HeartbeatPlan,
) -> Result<(), StoreError> {
    let of_headset = "WHERE headset = ?1 ORDER BY command";
    for mut command in tx.find::<Command>(of_headset, &[&beat.headset])? {
        let before = command.state;
        command.state = state_after(&command, beat, now);
        let lives = matches!(command.state, CommandState::Waiting | CommandState::Sent);
        if lives && plan.command.is_none() {
            plan.command = ride(&command, now);
            command.state = CommandState::Sent;
        }
        if command.state != before {
            plan.commands.push(command);
        }
    }
    Ok(())
}

fn state_after(command: &Command, beat: &Heartbeat, now: BoothTime) -> CommandState {
    let is_open =
        matches!(command.state, CommandState::Waiting | CommandState::Sent | CommandState::Expired);
    match beat.last_command {
        // Only the program start that received the command can report its outcome.
        Some(report) if report.id == command.command && beat.boot_id == command.boot && is_open => {
            match report.outcome {
                CommandOutcome::Done => CommandState::Done,
                CommandOutcome::Expired => CommandState::Expired,
                CommandOutcome::Refused => CommandState::Refused,
            }
        }
        _ if !is_open => command.state,
        _ if is_over(command, beat, now) => CommandState::Expired,
        _ => command.state,
    }
}

/// Returns `true` if the lifetime, the program start or the visit of a command is over.
fn is_over(command: &Command, beat: &Heartbeat, now: BoothTime) -> bool {
    let is_for_visit = kind_of(command).is_none_or(CommandKind::is_for_visit);
    now < command.asked_at
        || now.since(command.asked_at) >= COMMAND_LIFE
        || command.boot != beat.boot_id
        || is_for_visit && command.session != beat.status.session_id
}

fn kind_of(command: &Command) -> Option<CommandKind> {
    CommandKind::ALL.get(usize::from(command.kind)).copied()
}

fn ride(command: &Command, now: BoothTime) -> Option<BoothCommand> {
    let left = COMMAND_LIFE.saturating_sub(now.since(command.asked_at)).as_millis();
    Some(BoothCommand {
        id: command.command,
        boot_id: command.boot,
        session_id: command.session,
        kind: kind_of(command)?,
        lives_ms: u16::try_from(left).ok()?.max(1),
    })
}

/// Acknowledges announcements. Only new or changed announcements of missing sculptures need a write.
fn plan_announcements(
    tx: &mut Tx<'_>,
    beat: &Heartbeat,
    now: BoothTime,
    plan: &mut HeartbeatPlan,
) -> Result<(), StoreError> {
    let mut count = None;
    for announced in &beat.announcements {
        let id = announced.id.0;
        let known: Option<Announcement> = tx.get(&[&beat.headset, &id])?;
        let is_sent = announced.status == UploadStatus::Sent;
        // A sculpture on the list of missing ones hasn't arrived.
        let is_looked_up = known.is_none() || is_sent;
        let is_kept = is_looked_up && tx.get::<Sculpture>(&[&id])?.is_some();
        let is_deleted = is_looked_up && !is_kept && tx.get::<Tombstone>(&[&id])?.is_some();
        // Lost in a restore, or deleted. The next upload is stored, or answered "deleted".
        let status = if is_sent && !is_kept { UploadStatus::Kept } else { announced.status };
        let badge = announced.badge.map(BadgeNumber::get);
        let note = Announcement {
            headset: beat.headset,
            sculpture: id,
            badge: badge.or_else(|| known.as_ref().and_then(|known| known.badge)),
            heard_at: known.as_ref().map_or(now, |known| known.heard_at),
            status: status as u8,
        };
        if !is_kept && !is_deleted && known.as_ref() != Some(&note) {
            if known.is_none() {
                let of_headset = "WHERE headset = ?1";
                let count = match &mut count {
                    Some(count) => count,
                    none => none.insert(tx.count::<Announcement>(of_headset, &[&beat.headset])?),
                };
                if *count >= MAX_ANNOUNCED {
                    continue;
                }
                *count += 1;
            }
            plan.announcements.push(note);
        }
        plan.noted.push(paros_protocol::Announcement { status, ..*announced });
    }
    Ok(())
}
