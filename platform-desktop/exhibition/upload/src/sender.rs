//! The sender: decides when to send which parcel, and renames its file according to the answer.

use std::mem;
use std::time::Duration;

use paros_core::badge::BadgeNumber;
use paros_protocol::{
    BlockSerial, CommandOutcome, LinkTimes, Parcel, ParcelOutcome, SculptureId, UploadStatus,
};

use super::badge_lease::BadgeLease;
use super::events::{BoothContact, OutboxEvent, OutboxHost, OutboxOwner};
use super::folder::OutboxFolder;
use super::heartbeats::HeartbeatClock;
use super::link::{BoothLink, BoothRequest, HttpAnswer, LinkAnswer, LinkFault, RequestKind};
use super::spool::{OutboxSettings, Spool, SpoolEntry, SpoolError};

/// Wait after the first failed request in milliseconds. It doubles with each further failure.
const UPLOAD_WAIT_MS: u64 = 2_000;

/// Longest wait between failing requests in milliseconds: a visitor's wait after the booth is back.
const MAX_UPLOAD_WAIT_MS: u64 = 60_000;

/// Longest `Retry-After` that is respected, in seconds.
const MAX_RETRY_AFTER_SECONDS: u32 = 600;

/// Retry interval of a refused parcel in milliseconds: six hours. Somebody may have repaired the booth.
const REFUSED_RETRY_MS: u64 = 6 * 3600 * 1000;

/// Largest jitter that shortens this interval, in milliseconds, so that headsets don't all retry at once.
const REFUSED_SPREAD_MS: u64 = 600_000;

/// Milliseconds between two sweeps of the spool.
const SWEEP_MS: u64 = 1_000;

/// An outbox: its spool and its link to the booth.
#[derive(Debug)]
pub struct Sender<F, L> {
    pub(super) spool: Spool<F>,
    link: L,
    pub(super) owner: OutboxOwner,
    /// Random bits of this start, not 0.
    pub(super) boot_id: u64,
    /// `true` if the folder was empty at the start, until the booth has answered a heartbeat that reports it.
    pub(super) was_wiped: bool,
    /// The last reading of the host's clock, in milliseconds.
    host_ms: Option<u64>,
    /// Milliseconds since this start.
    pub(super) elapsed_ms: u64,
    uploads: UploadClock,
    pub(super) badges: BadgeLease,
    pub(super) heartbeats: HeartbeatClock,
    /// The booth's last response to this device.
    pub(super) contact: BoothContact,
    next_sweep_ms: u64,
    events: Vec<OutboxEvent>,
}

/// The upload under way, and the earliest time of the next one.
#[derive(Debug, Default)]
struct UploadClock {
    requests: u32,
    in_flight: Option<InFlight>,
    /// Number of consecutive failed requests.
    failures: u8,
    wait_until_ms: u64,
}

#[derive(Clone, Copy, Debug)]
struct InFlight {
    number: u32,
    id: SculptureId,
    late_ms: u64,
}

/// Returns the wait of an exponential backoff with jitter, between half and all of the full wait. Jitter
/// keeps headsets that lost the booth at the same time from returning at once.
pub(super) fn jittered_wait_ms(first_ms: u64, longest_ms: u64, failures: u8, random: u32) -> u64 {
    let doublings = u32::from(failures.saturating_sub(1)).min(20);
    let full = (first_ms << doublings).min(longest_ms);
    full / 2 + u64::from(random) % (full / 2 + 1)
}

impl<F: OutboxFolder, L: BoothLink> Sender<F, L> {
    /// Opens the outbox in a folder. `boot_id` is random bits that identify this start, not 0.
    ///
    /// # Errors
    /// Returns `Disk` if the folder can't be listed.
    pub fn open(
        folder: F,
        link: L,
        owner: OutboxOwner,
        settings: OutboxSettings,
        boot_id: u64,
    ) -> Result<Self, SpoolError> {
        let spool = Spool::open(folder, settings)?;
        let lost = spool.entries().iter().filter(|entry| entry.status == UploadStatus::Lost);
        let events = lost.map(|entry| OutboxEvent::Lost(entry.id)).collect();
        Ok(Sender {
            was_wiped: spool.is_new(),
            badges: BadgeLease::open(spool.folder(), boot_id),
            spool,
            link,
            owner,
            boot_id,
            host_ms: None,
            elapsed_ms: 0,
            uploads: UploadClock::default(),
            heartbeats: HeartbeatClock::default(),
            contact: BoothContact::Silent,
            next_sweep_ms: 0,
            events,
        })
    }

    /// Returns the spool of the outbox.
    #[must_use]
    pub const fn spool(&self) -> &Spool<F> {
        &self.spool
    }

    /// Returns the seconds since the booth accepted a parcel that is still here.
    #[must_use]
    pub fn sent_seconds(&self, id: SculptureId) -> Option<u64> {
        let sent = self.spool.find(id).filter(|entry| entry.status == UploadStatus::Sent)?;
        Some(sent.sent_seconds(self.elapsed_ms))
    }

    /// `true` if the outbox was empty at the start, and the booth hasn't acknowledged this yet.
    #[must_use]
    pub const fn was_wiped(&self) -> bool {
        self.was_wiped
    }

    /// Returns the link.
    pub const fn link(&mut self) -> &mut L {
        &mut self.link
    }

    /// Adds a finished sculpture, which the next heartbeats announce.
    ///
    /// # Errors
    /// Returns the errors of [`Spool::announce`].
    pub fn announce(
        &mut self,
        id: SculptureId,
        badge: Option<BadgeNumber>,
    ) -> Result<(), SpoolError> {
        self.spool.announce(id, badge)
    }

    /// Sets the badge of a sculpture whose parcel isn't made yet.
    ///
    /// # Errors
    /// Returns the errors of [`Spool::note_badge`].
    pub fn note_badge(&mut self, id: SculptureId, badge: BadgeNumber) -> Result<(), SpoolError> {
        self.spool.note_badge(id, badge)
    }

    /// Takes the number of the next badge. A leased number is saved as used. A provisional number consists of
    /// these `random` bits.
    pub fn take_badge(&mut self, random: u32) -> BadgeNumber {
        self.badges.take_number(self.spool.folder_mut(), random)
    }

    /// Returns the serial that proves that a badge was leased to this device.
    #[must_use]
    pub fn badge_serial(&self, badge: BadgeNumber) -> Option<BlockSerial> {
        self.badges.serial_of(badge)
    }

    /// Writes a parcel to the disk: *kept here*.
    ///
    /// # Errors
    /// Returns the errors of [`Spool::keep`].
    pub fn keep(&mut self, parcel: &Parcel) -> Result<(), SpoolError> {
        self.spool.keep(parcel)
    }

    /// Gives up a sculpture whose parcel won't be made.
    ///
    /// # Errors
    /// Returns the errors of [`Spool::abandon`].
    pub fn abandon(&mut self, id: SculptureId) -> Result<(), SpoolError> {
        self.spool.abandon(id)?;
        self.events.push(OutboxEvent::Lost(id));
        Ok(())
    }

    /// Records the outcome of a command.
    pub fn note_command_done(&mut self, id: u64, outcome: CommandOutcome) {
        self.heartbeats.note_command_done(id, outcome);
    }

    /// Handles answers, deletes expired parcels, and sends a parcel and a heartbeat if they are due. Call
    /// this about ten times a second.
    pub fn step(&mut self, host: &mut impl OutboxHost) {
        self.pass_time(host.now_ms());
        while let Some(answer) = self.link.poll() {
            self.take_answer(&answer, host);
        }
        if self.elapsed_ms >= self.next_sweep_ms {
            self.next_sweep_ms = self.elapsed_ms + SWEEP_MS;
            self.spool.sweep(self.elapsed_ms);
        }
        self.send_parcel(host.random());
        if self.is_heartbeat_due() {
            self.send_heartbeat(host);
        }
        for event in mem::take(&mut self.events) {
            host.on_event(event);
        }
    }

    /// Advances the sender's time. If the host's clock is set back, time stands still; if it is set forward,
    /// waits get shorter.
    fn pass_time(&mut self, now_ms: u64) {
        let before = self.host_ms.replace(now_ms).unwrap_or(now_ms);
        if now_ms < before {
            // The age of the heartbeat under way is unknown now.
            self.heartbeats.forget_sent();
        }
        self.elapsed_ms = self.elapsed_ms.saturating_add(now_ms.saturating_sub(before));
    }

    fn take_answer(&mut self, answer: &LinkAnswer, host: &mut impl OutboxHost) {
        let LinkAnswer { kind, number, ref result } = *answer;
        match kind {
            RequestKind::Put(_) => self.take_put_answer(number, result, host.random()),
            RequestKind::Heartbeat => {
                let session_id = host.status().session_id;
                self.take_heartbeat_result(number, result, session_id);
            }
        }
    }

    /// Sends the next parcel, if it is due and no other is under way.
    ///
    /// The newest sculpture goes first, as its visitor is on the way to the booth. A parcel whose requests
    /// failed goes after all others, so that it doesn't block them. A refused parcel is retried every six
    /// hours and once in each start.
    fn send_parcel(&mut self, random: u32) {
        let now_ms = self.elapsed_ms;
        if let Some(late) = self.uploads.in_flight.take_if(|request| now_ms >= request.late_ms) {
            self.note_failed(late.id, random);
        }
        if self.uploads.in_flight.is_some() || now_ms < self.uploads.wait_until_ms {
            return;
        }
        let is_due = |entry: &&SpoolEntry| match entry.status {
            UploadStatus::Kept => true,
            UploadStatus::Refused => now_ms >= entry.retry_ms,
            _ => false,
        };
        let due = self.spool.entries().iter().rev().filter(is_due);
        let Some(id) = due.min_by_key(|entry| entry.failures).map(|entry| entry.id) else { return };
        let Some(parcel) = self.spool.read(id) else {
            if self.spool.find(id).is_some_and(|entry| entry.status == UploadStatus::Lost) {
                self.events.push(OutboxEvent::Lost(id));
            }
            return self.note_failed(id, random);
        };
        self.uploads.requests = self.uploads.requests.wrapping_add(1);
        let (number, body) = (self.uploads.requests, parcel.into_file());
        // Slightly longer than the link's timeout, so that no request queues behind one that has timed out.
        let timeout = LinkTimes::default().of_parcel(body.len()) + Duration::from_secs(5);
        let late_ms = now_ms + u64::try_from(timeout.as_millis()).unwrap_or(u64::MAX);
        self.uploads.in_flight = Some(InFlight { number, id, late_ms });
        self.link.send(BoothRequest { kind: RequestKind::Put(id), number, body });
    }

    /// Handles the answer to a parcel. An answer that isn't the booth's, such as a captive portal's page,
    /// counts as a failure.
    fn take_put_answer(
        &mut self,
        number: u32,
        result: &Result<HttpAnswer, LinkFault>,
        random: u32,
    ) {
        // A late answer is ignored. Its parcel is sent again, which is idempotent.
        let in_flight = self.uploads.in_flight.take_if(|request| request.number == number);
        let Some(InFlight { id, .. }) = in_flight else { return };
        let answer = result.as_ref().ok();
        let outcome =
            answer.and_then(|answer| ParcelOutcome::of_answer(answer.status, &answer.body));
        let status = answer.map_or(0, |answer| answer.status);
        let retry_after = answer.and_then(|answer| answer.retry_after).unwrap_or(0);
        let is_done = match (outcome, status) {
            (Some(ParcelOutcome::Kept), _) => {
                let is_noted = self.spool.rename(id, UploadStatus::Sent, self.elapsed_ms);
                self.report_noted(is_noted, OutboxEvent::KeptAtBooth(id))
            }
            (Some(ParcelOutcome::Deleted), _) => {
                let is_noted = self.spool.delete(id);
                self.report_noted(is_noted, OutboxEvent::DeletedAtBooth(id))
            }
            (None, 409 | 413 | 422) => self.take_refused(id, random),
            (None, 429 | 503) if retry_after > 0 => {
                return self.wait_for_booth(id, retry_after, random);
            }
            (None, 401 | 403) => {
                self.note_stranger(status);
                false
            }
            _ => false,
        };
        match is_done {
            true => self.uploads.failures = 0,
            false => self.note_failed(id, random),
        }
    }

    /// Reports the outcome of a parcel if the disk has stored it. Returns `is_noted`.
    fn report_noted(&mut self, is_noted: bool, outcome: OutboxEvent) -> bool {
        self.events.extend(is_noted.then_some(outcome));
        is_noted
    }

    /// Marks a parcel that the booth refused. Returns `false` if the disk couldn't store it.
    fn take_refused(&mut self, id: SculptureId, random: u32) -> bool {
        let is_noted = self.spool.rename(id, UploadStatus::Refused, self.elapsed_ms);
        let wait_ms = REFUSED_RETRY_MS - u64::from(random) % REFUSED_SPREAD_MS;
        let retry_ms = self.elapsed_ms.saturating_add(wait_ms);
        if let Some(entry) = self.spool.find_mut(id).filter(|_| is_noted) {
            entry.retry_ms = retry_ms;
        }
        self.report_noted(is_noted, OutboxEvent::RefusedByBooth(id))
    }

    /// Records by the HTTP status why the booth rejects this headset.
    pub(super) const fn note_stranger(&mut self, status: u16) {
        self.contact = match status {
            401 => BoothContact::Forgotten,
            _ => BoothContact::ShutOut,
        };
    }

    /// Waits as the booth asks, which isn't a failure of the link. The parcel goes after all others, as the
    /// booth may have no room for this one only.
    fn wait_for_booth(&mut self, id: SculptureId, retry_after_seconds: u32, random: u32) {
        self.put_last(id);
        let asked_ms = u64::from(retry_after_seconds.min(MAX_RETRY_AFTER_SECONDS)) * 1000;
        let spread_ms = jittered_wait_ms(UPLOAD_WAIT_MS, UPLOAD_WAIT_MS, 1, random);
        self.uploads.failures = 0;
        self.uploads.wait_until_ms = self.elapsed_ms.saturating_add(asked_ms + spread_ms);
    }

    fn note_failed(&mut self, id: SculptureId, random: u32) {
        let failures = self.uploads.failures.saturating_add(1);
        let wait_ms = jittered_wait_ms(UPLOAD_WAIT_MS, MAX_UPLOAD_WAIT_MS, failures, random);
        self.uploads.failures = failures;
        self.uploads.wait_until_ms = self.elapsed_ms.saturating_add(wait_ms);
        self.put_last(id);
    }

    /// Increments the failures of a parcel, so that it is sent after those with fewer failures.
    fn put_last(&mut self, id: SculptureId) {
        if let Some(entry) = self.spool.find_mut(id) {
            entry.failures = entry.failures.saturating_add(1);
        }
    }

    fn send_heartbeat(&mut self, host: &mut impl OutboxHost) {
        let (status, random) = (host.status(), host.random());
        let heartbeat = self.begin_heartbeat(status, random);
        let (number, body) = (heartbeat.number, heartbeat.to_json());
        self.link.send(BoothRequest { kind: RequestKind::Heartbeat, number, body });
    }

    pub(super) fn push_event(&mut self, event: OutboxEvent) {
        self.events.push(event);
    }

    /// Returns the last reading of the host's clock in milliseconds.
    pub(super) fn host_ms(&self) -> u64 {
        self.host_ms.unwrap_or_default()
    }
}
