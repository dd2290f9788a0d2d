//! The client side of heartbeats: sends one every two seconds, and applies the answers.

use paros_protocol::limits::MAX_ANNOUNCEMENTS;
use paros_protocol::{
    Announcement, BoothCommand, CommandOutcome, CommandReport, HEARTBEAT_TIMEOUT_MS, HeadsetStatus,
    Heartbeat, HeartbeatAnswer, UploadStatus,
};

use super::events::{BoothContact, OutboxEvent, RemoteCommand};
use super::folder::OutboxFolder;
use super::link::{BoothLink, HttpAnswer, LinkFault};
use super::sender::{Sender, jittered_wait_ms};
use super::spool::SpoolEntry;

/// Milliseconds between heartbeats: the longest delay of a button on the staff's page.
const HEARTBEAT_MS: u64 = 2_000;

/// Longest wait between unanswered heartbeats in milliseconds: the lifetime of a command.
const MAX_HEARTBEAT_WAIT_MS: u64 = HEARTBEAT_TIMEOUT_MS;

/// Poll interval in milliseconds, at which a headset asks if the booth still has a sent parcel. Bounds how
/// soon sculptures lost in a restore are sent again.
pub const CONFIRM_MS: u64 = 60_000;

/// The state of heartbeats: the one under way, the time of the next one, and the last command.
#[derive(Debug, Default)]
pub(super) struct HeartbeatClock {
    heartbeats: u32,
    /// The time when the heartbeat under way was sent, in milliseconds of the sender and of the host.
    sent_ms: Option<(u64, u64)>,
    due_ms: u64,
    /// Number of consecutive unanswered heartbeats.
    failures: u8,
    /// The index of the entry with which the next list of announcements starts.
    cursor: usize,
    /// The store epoch of the booth's last answer.
    store_epoch: Option<u64>,
    /// The id of the last command that was received; 0 for none.
    last_command: u64,
    /// The report of the last command's outcome, once it is known.
    report: Option<CommandReport>,
}

impl HeartbeatClock {
    pub(super) fn forget_sent(&mut self) {
        if self.sent_ms.take().is_some() {
            self.failures = self.failures.saturating_add(1);
        }
    }

    /// Records the outcome of a command for the next heartbeats. Ignores all but the last command.
    pub(super) fn note_command_done(&mut self, id: u64, outcome: CommandOutcome) {
        if self.last_command == id && self.report.is_none() {
            self.report = Some(CommandReport { id, outcome });
        }
    }
}

impl SpoolEntry {
    /// `true` if the booth hasn't acknowledged the current status.
    fn has_news(&self) -> bool {
        self.announcement().is_some_and(|announcement| self.noted != Some(announcement))
    }

    /// Returns the question if the booth still has a sent parcel; `None` if it was confirmed recently.
    fn question(&self, now_ms: u64) -> Option<Announcement> {
        let is_due = |confirmed_ms: u64| now_ms.saturating_sub(confirmed_ms) >= CONFIRM_MS;
        let is_asked = self.status == UploadStatus::Sent && self.confirmed_ms.is_none_or(is_due);
        let SpoolEntry { id, badge, status, .. } = *self;
        is_asked.then_some(Announcement { id, badge, status })
    }
}

impl<F: OutboxFolder, L: BoothLink> Sender<F, L> {
    /// `true` if a heartbeat is to be sent now. A heartbeat times out after ten seconds.
    pub(super) fn is_heartbeat_due(&self) -> bool {
        let clock = &self.heartbeats;
        let is_late = |(sent_ms, _): (u64, u64)| {
            self.elapsed_ms.saturating_sub(sent_ms) >= HEARTBEAT_TIMEOUT_MS
        };
        self.elapsed_ms >= clock.due_ms && clock.sent_ms.is_none_or(is_late)
    }

    /// Returns the booth's response to this device.
    #[must_use]
    pub const fn contact(&self) -> BoothContact {
        match self.contact {
            BoothContact::Open if self.heartbeats.failures > 0 => BoothContact::Silent,
            contact => contact,
        }
    }

    /// Makes the heartbeat to send now. `random` bits add jitter to the backoff after unanswered heartbeats.
    pub(super) fn begin_heartbeat(&mut self, status: HeadsetStatus, random: u32) -> Heartbeat {
        self.heartbeats.forget_sent();
        let announcements = self.list_announcements();
        let (now_ms, host_ms) = (self.elapsed_ms, self.host_ms());
        let clock = &mut self.heartbeats;
        clock.heartbeats = clock.heartbeats.checked_add(1).unwrap_or(1);
        clock.sent_ms = Some((now_ms, host_ms));
        let backoff_ms =
            jittered_wait_ms(2 * HEARTBEAT_MS, MAX_HEARTBEAT_WAIT_MS, clock.failures, random);
        let wait_ms = if clock.failures == 0 { 0 } else { backoff_ms };
        clock.due_ms = now_ms.saturating_add(wait_ms.max(HEARTBEAT_MS));
        Heartbeat {
            number: clock.heartbeats,
            status: HeadsetStatus {
                battery_percent: status.battery_percent.map(|percent| percent.min(100)),
                ..status
            },
            was_wiped: self.was_wiped,
            outbox_depth: u16::try_from(self.spool.depth()).unwrap_or(u16::MAX),
            outbox_full_percent: self.spool.full_percent(),
            last_command: clock.report,
            announcements,
            ..Heartbeat::first(self.owner.headset, self.boot_id, self.badges.report().clone())
        }
    }

    /// Lists the announcements of a heartbeat: first the sculptures whose status the booth hasn't
    /// acknowledged, then sent ones to confirm, then the others that the booth doesn't have, as a round
    /// robin.
    fn list_announcements(&mut self) -> Vec<Announcement> {
        let now_ms = self.elapsed_ms;
        let entries = self.spool.entries_mut();
        let count = entries.len();
        let start = self.heartbeats.cursor;
        let in_turn = (0..count).map(|step| (start + step) % count);
        let is_owed = |at: &usize| entries[*at].status != UploadStatus::Sent;
        let (news, others): (Vec<usize>, Vec<usize>) =
            in_turn.filter(is_owed).partition(|&at| entries[at].has_news());
        let mut list = Vec::with_capacity(MAX_ANNOUNCEMENTS);
        list.extend(news.iter().filter_map(|&at| entries[at].announcement()));
        list.truncate(MAX_ANNOUNCEMENTS);
        for entry in entries.iter_mut() {
            let question = entry.question(now_ms).filter(|_| list.len() < MAX_ANNOUNCEMENTS);
            entry.is_asked_for = question.is_some();
            list.extend(question);
        }
        let room = MAX_ANNOUNCEMENTS - list.len();
        list.extend(others.iter().take(room).filter_map(|&at| entries[at].announcement()));
        // The next heartbeat continues after the last listed entry.
        let last = others.get(room.wrapping_sub(1)).or(news.get(MAX_ANNOUNCEMENTS - 1));
        if let Some(at) = last {
            self.heartbeats.cursor = at + 1;
        }
        list
    }

    /// Handles the result of a heartbeat. `session_id` is that of the visit under way.
    pub(super) fn take_heartbeat_result(
        &mut self,
        number: u32,
        result: &Result<HttpAnswer, LinkFault>,
        session_id: u64,
    ) {
        let answer = match result {
            Ok(HttpAnswer { status: 200, body, .. }) => HeartbeatAnswer::from_json(body).ok(),
            Ok(HttpAnswer { status: status @ (401 | 403), .. }) => {
                self.note_stranger(*status);
                None
            }
            _ => None,
        };
        let is_taken = answer.is_some_and(|answer| self.take_heartbeat_answer(&answer, session_id));
        if !is_taken && number == self.heartbeats.heartbeats {
            self.heartbeats.forget_sent();
        }
    }

    /// Applies an answer to the heartbeat under way. Returns `false`, and changes nothing, if the answer is
    /// to another heartbeat or of another booth.
    fn take_heartbeat_answer(&mut self, answer: &HeartbeatAnswer, session_id: u64) -> bool {
        let is_own = (answer.site, answer.headset) == (self.owner.site, self.owner.headset);
        let is_last = (answer.boot_id, answer.number) == (self.boot_id, self.heartbeats.heartbeats);
        let under_way = self.heartbeats.sent_ms.filter(|_| is_own && is_last);
        let Some((sent_ms, host_sent_ms)) = under_way else { return false };
        self.heartbeats.sent_ms = None;
        self.heartbeats.failures = 0;
        self.contact = BoothContact::Open;
        self.was_wiped = false;
        if self.heartbeats.store_epoch.replace(answer.store_epoch) != Some(answer.store_epoch) {
            // A restored booth may lack sculptures: confirm all of them again.
            self.spool.entries_mut().iter_mut().for_each(|entry| entry.confirmed_ms = None);
        }
        self.badges.take_answer(self.spool.folder_mut(), &answer.badges);
        answer.noted.iter().for_each(|announcement| self.note_announced(announcement));
        if let Some(asked) = answer.command
            && let Some(command) = self.take_command(&asked, session_id, sent_ms)
        {
            let ends_ms = host_sent_ms.saturating_add(u64::from(asked.lives_ms));
            self.push_event(OutboxEvent::Command { command, ends_ms });
        }
        true
    }

    fn note_announced(&mut self, noted: &Announcement) {
        let now_ms = self.elapsed_ms;
        let Some(entry) = self.spool.find_mut(noted.id) else { return };
        if entry.is_asked_for {
            entry.is_asked_for = false;
            match noted.status {
                UploadStatus::Sent => entry.confirmed_ms = Some(now_ms),
                // A restore lost it, or it was deleted there: the answer to another upload says which. Where the disk refuses
                // the new name, the booth is asked again.
                _ => _ = self.spool.rename(noted.id, UploadStatus::Kept, now_ms),
            }
        } else if entry.announcement() == Some(*noted) {
            entry.noted = Some(*noted);
            if noted.status == UploadStatus::Lost {
                self.spool.forget(noted.id);
            }
        }
    }

    /// Accepts a command at most once: ids increase, and each program start accepts only its own commands.
    fn take_command(
        &mut self,
        command: &BoothCommand,
        session_id: u64,
        sent_ms: u64,
    ) -> Option<RemoteCommand> {
        let waited_ms = self.elapsed_ms.saturating_sub(sent_ms);
        let clock = &mut self.heartbeats;
        if command.id <= clock.last_command {
            return None;
        }
        (clock.last_command, clock.report) = (command.id, None);
        let is_alive = waited_ms < u64::from(command.lives_ms);
        let is_for_this = !command.kind.is_for_visit()
            || command.session_id != 0 && command.session_id == session_id;
        if command.boot_id == self.boot_id && is_alive && is_for_this {
            return Some(RemoteCommand { id: command.id, kind: command.kind, session_id });
        }
        clock.report = Some(CommandReport { id: command.id, outcome: CommandOutcome::Expired });
        None
    }
}
