//! What a headset tells the booth every two seconds, and what it takes of the answers.

use crate::badge::LeaseReport;
use crate::codec::trace::CORE_VERSION;
use crate::limits::{HEARTBEAT_MS, HEARTBEAT_TIMEOUT_MS, MAX_ANNOUNCEMENTS, MAX_HEARTBEAT_WAIT_MS};
use crate::outbox::entry::EntryEvent;
use crate::outbox::machine::Outbox;
use crate::outbox::messages::{
    Announcement, AnnouncementState, Announcements, BoothCommand, CommandKind, CommandOutcome,
    CommandReport, Heartbeat, HeartbeatAnswer, HeatLevel,
};
use crate::outbox::uploads::jittered_wait_ms;
use crate::visit::VisitPhase;

/// What a headset is about, beside its outbox.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HeadsetStatus {
    /// Random bits of the visit under way; 0 for none.
    pub session_id: u64,
    /// Whether the battery is being charged.
    pub is_charging: bool,
    /// Whether the headset is on a head.
    pub is_worn: bool,
    /// Whether it glows and beeps, so that it is found.
    pub is_glowing: bool,
    /// The battery's charge in percent, where it is known: 0 to 100.
    pub battery_percent: Option<u8>,
    /// How hot it is.
    pub heat: HeatLevel,
    /// Where the visit stands.
    pub phase: VisitPhase,
    /// Seconds since this visitor put it on; 0 where nobody wears it.
    pub worn_seconds: u32,
    /// The program's version: major, minor, patch.
    pub app_version: [u16; 3],
}

/// A command to carry out now. What comes of it is told by [`Outbox::note_command_done`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DueCommand {
    /// Of the booth's command.
    pub id: u64,
    /// What is asked.
    pub kind: CommandKind,
}

/// The heartbeat under way, when the next one is due, and the last command.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct HeartbeatClock {
    heartbeats: u32,
    /// Of the heartbeat under way.
    sent_ms: Option<u64>,
    due_ms: u64,
    /// Heartbeats in a row that weren't answered.
    failures: u8,
    /// The place in the table from which on entries are announced.
    cursor: usize,
    /// The last command that was taken; 0 for none.
    last_command: u64,
    /// What came of it, once that is known.
    report: Option<CommandReport>,
}

impl HeartbeatClock {
    pub(super) const fn new() -> Self {
        HeartbeatClock {
            heartbeats: 0,
            sent_ms: None,
            due_ms: 0,
            failures: 0,
            cursor: 0,
            last_command: 0,
            report: None,
        }
    }

    pub(super) fn forget_sent(&mut self) {
        if self.sent_ms.take().is_some() {
            self.failures = self.failures.saturating_add(1);
        }
    }
}

impl Outbox {
    /// Whether a heartbeat is to be sent now. One that was sent ten seconds ago has failed.
    #[must_use]
    pub fn is_heartbeat_due(&self) -> bool {
        let clock = &self.heartbeats;
        let is_late =
            |sent_ms: u64| self.elapsed_ms.saturating_sub(sent_ms) >= HEARTBEAT_TIMEOUT_MS;
        self.elapsed_ms >= clock.due_ms && clock.sent_ms.is_none_or(is_late)
    }

    /// Makes a heartbeat, to be sent now; `lease` where a report of it is due. `random` bits spread the next one where
    /// the last ones weren't answered.
    #[must_use]
    pub fn begin_heartbeat(
        &mut self,
        status: &HeadsetStatus,
        lease: Option<LeaseReport>,
        random: u32,
    ) -> Heartbeat {
        self.heartbeats.forget_sent();
        let announcements = self.list_announcements();
        let now_ms = self.elapsed_ms;
        let clock = &mut self.heartbeats;
        clock.heartbeats = clock.heartbeats.checked_add(1).unwrap_or(1);
        clock.sent_ms = Some(now_ms);
        let wait_ms = match clock.failures {
            0 => HEARTBEAT_MS,
            failures => {
                let spread =
                    jittered_wait_ms(2 * HEARTBEAT_MS, MAX_HEARTBEAT_WAIT_MS, failures, random);
                spread.max(HEARTBEAT_MS)
            }
        };
        clock.due_ms = now_ms.saturating_add(wait_ms);
        let (number, last_command) = (clock.heartbeats, clock.report);
        let HeadsetStatus { session_id, is_charging, is_worn, is_glowing, .. } = *status;
        Heartbeat {
            headset: self.owner.headset,
            boot_id: self.boot_id,
            number,
            session_id,
            is_charging,
            is_worn,
            is_glowing,
            was_wiped: self.was_wiped,
            battery_percent: status.battery_percent.map(|percent| percent.min(100)),
            heat: status.heat,
            phase: status.phase,
            worn_seconds: status.worn_seconds,
            outbox_depth: u16::try_from(self.depth()).unwrap_or(u16::MAX),
            outbox_full_percent: self.full_percent(),
            app_version: status.app_version,
            core_version: CORE_VERSION,
            lease: lease.filter(|report| report.headset == self.owner.headset),
            last_command,
            announcements,
        }
    }

    /// First all whose state the booth hasn't noted, then the others that it hasn't signed for, each in turn; then those
    /// of which it is to be heard whether the booth still has them.
    fn list_announcements(&mut self) -> Announcements {
        let mut list = Announcements::new();
        let (count, start) = (self.entries.len(), self.heartbeats.cursor);
        for wants_news in [true, false] {
            for step in 0..count {
                let at = (start + step) % count;
                let entry = &self.entries[at];
                if entry.has_news() != wants_news || list.is_full() {
                    continue;
                }
                if let Some(announcement) = entry.announcement() {
                    // There is room: it was asked.
                    let _ = list.push(announcement);
                    if list.len() == MAX_ANNOUNCEMENTS {
                        self.heartbeats.cursor = at + 1;
                    }
                }
            }
        }
        let now_ms = self.elapsed_ms;
        for entry in &mut self.entries {
            let question = entry.question(now_ms).filter(|_| !list.is_full());
            entry.is_asked_for = question.is_some();
            list.extend(question);
        }
        list
    }

    /// Takes the answer to the heartbeat under way: what the booth has noted, and a command for a visit, whose random
    /// bits are `session_id`, 0 for none. `None` where it answers another heartbeat, or another booth does: nothing
    /// of it counts, the lease's answer neither.
    #[must_use]
    pub fn take_heartbeat_answer(
        &mut self,
        answer: &HeartbeatAnswer,
        session_id: u64,
    ) -> Option<Option<DueCommand>> {
        let is_own = (answer.site, answer.headset) == (self.owner.site, self.owner.headset);
        let is_last = (answer.boot_id, answer.number) == (self.boot_id, self.heartbeats.heartbeats);
        let sent_ms = self.heartbeats.sent_ms.filter(|_| is_own && is_last)?;
        self.heartbeats.sent_ms = None;
        self.heartbeats.failures = 0;
        self.is_journal_due |= self.was_wiped;
        self.was_wiped = false;
        if answer.lease.as_ref().is_some_and(|lease| lease.is_void) {
            // A booth that came back from a copy knows no leases: it may know of fewer sculptures too.
            self.entries.iter_mut().for_each(|entry| entry.confirmed_ms = None);
        }
        answer.noted.iter().for_each(|announcement| self.note_announced(announcement));
        let waited_ms = self.elapsed_ms.saturating_sub(sent_ms);
        Some(answer.command.and_then(|command| self.take_command(&command, session_id, waited_ms)))
    }

    /// Nothing was heard of a heartbeat, or nothing that is an answer.
    pub fn note_heartbeat_failed(&mut self, number: u32) {
        if number == self.heartbeats.heartbeats {
            self.heartbeats.forget_sent();
        }
    }

    /// Whether the booth answers.
    #[must_use]
    pub const fn hears_booth(&self) -> bool {
        self.heartbeats.failures == 0 && self.heartbeats.heartbeats > 0
    }

    fn note_announced(&mut self, noted: &Announcement) {
        let now_ms = self.elapsed_ms;
        let Ok(entry) = self.find_mut(noted.id) else { return };
        if entry.is_asked_for {
            entry.is_asked_for = false;
            match noted.state {
                AnnouncementState::SignedFor => entry.confirmed_ms = Some(now_ms),
                // It is missed there. What is deletable meanwhile stays so.
                _ => _ = self.apply(noted.id, EntryEvent::Forgotten),
            }
            return;
        }
        if entry.announcement() != Some(*noted) {
            return;
        }
        entry.noted = Some(*noted);
        if noted.state == AnnouncementState::Lost {
            // That it is lost was looked at just now.
            let _ = self.apply(noted.id, EntryEvent::LossNoted);
        }
    }

    /// At most once: ids grow, and each start takes its own commands alone.
    fn take_command(
        &mut self,
        command: &BoothCommand,
        session_id: u64,
        waited_ms: u64,
    ) -> Option<DueCommand> {
        let clock = &mut self.heartbeats;
        if command.id <= clock.last_command {
            return None;
        }
        clock.last_command = command.id;
        clock.report = None;
        let is_alive = waited_ms < u64::from(command.lives_ms);
        let is_for_this = !command.kind.is_for_visit()
            || command.session_id != 0 && command.session_id == session_id;
        if command.boot_id == self.boot_id && is_alive && is_for_this {
            return Some(DueCommand { id: command.id, kind: command.kind });
        }
        clock.report = Some(CommandReport { id: command.id, outcome: CommandOutcome::Expired });
        None
    }

    /// What came of a command, which the next heartbeats tell. Of an older one than the last nothing is told.
    pub fn note_command_done(&mut self, id: u64, outcome: CommandOutcome) {
        let clock = &mut self.heartbeats;
        if clock.last_command == id && clock.report.is_none() {
            clock.report = Some(CommandReport { id, outcome });
        }
    }
}
