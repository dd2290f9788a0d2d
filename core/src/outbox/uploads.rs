//! What is sent next, and when again.

use crate::limits::{
    MAX_CHUNK_BYTES, MAX_RETRY_AFTER_SECONDS, MAX_UPLOAD_WAIT_MS, REFUSED_RETRY_MS,
    UPLOAD_TIMEOUT_MS, UPLOAD_WAIT_MS,
};
use crate::outbox::entry::{EntryEvent, EntryState, OutboxEntry};
use crate::outbox::machine::{Outbox, OutboxRefusal};
use crate::outbox::messages::{ContentHash, Receipt, SculptureId};

/// A part of a parcel to be sent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct UploadRequest {
    /// The request's own number within the start.
    pub number: u32,
    /// The sculpture's.
    pub id: SculptureId,
    /// Of its whole parcel.
    pub hash: ContentHash,
    /// Length of its whole parcel in bytes.
    pub parcel_bytes: u32,
    /// Where the part begins.
    pub offset: u32,
    /// Length of the part in bytes, at most [`MAX_CHUNK_BYTES`]; 0 where the booth holds all and only its receipt is
    /// missing.
    pub len: u32,
}

/// What came of a request.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UploadAnswer {
    /// The booth holds so many bytes of the parcel.
    Held {
        /// From the parcel's start.
        bytes: u64,
    },
    /// The booth has the parcel, or deleted it.
    Receipt(Receipt),
    /// The booth can't take this parcel: it is too large, or not to be read.
    Refused,
    /// The booth has too much to do. It answers, so that this is a wait and no failure.
    Busy {
        /// Seconds after which it may be asked again; 0 where it doesn't say, which is a failure.
        retry_after_seconds: u32,
    },
    /// Nothing was heard, or nothing that is an answer; or the booth knew the id as another's, and the sculpture was
    /// [renewed](Outbox::renew).
    Failed,
}

/// The request under way, and when the next one may be made.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct UploadClock {
    requests: u32,
    in_flight: Option<InFlight>,
    /// Requests in a row that came to nothing.
    failures: u8,
    wait_until_ms: u64,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct InFlight {
    number: u32,
    id: SculptureId,
    offset: u32,
    parcel_bytes: u32,
    sent_ms: u64,
}

impl UploadClock {
    pub(super) const fn new() -> Self {
        UploadClock { requests: 0, in_flight: None, failures: 0, wait_until_ms: 0 }
    }
}

/// Exponential backoff with jitter: between half of it and all of it, so that headsets that lost the booth at one
/// moment don't come back at one.
pub(super) fn jittered_wait_ms(first_ms: u64, longest_ms: u64, failures: u8, random: u32) -> u64 {
    let doublings = u32::from(failures.saturating_sub(1)).min(20);
    let full = (first_ms << doublings).min(longest_ms);
    full / 2 + u64::from(random) % (full / 2 + 1)
}

impl Outbox {
    /// The part to send next, if it is time and none is under way. `random` bits spread what is sent again.
    ///
    /// The newest sculpture goes first: its visitor is on the way to the booth. One whose requests came to nothing
    /// goes after all others, so that none holds up the rest; one that the booth refused is tried again every six
    /// hours, and once in each start.
    #[must_use]
    pub fn begin_upload(&mut self, random: u32) -> Option<UploadRequest> {
        self.give_up_late_upload(random);
        if self.uploads.in_flight.is_some() || self.elapsed_ms < self.uploads.wait_until_ms {
            return None;
        }
        let now_ms = self.elapsed_ms;
        let waiting = self.entries.iter().rev().filter(|entry| entry.is_to_be_sent(now_ms));
        let entry = *waiting.min_by_key(|entry| entry.failures)?;
        let (hash, parcel_bytes) = (entry.hash?, entry.parcel_bytes);
        self.apply(entry.id, EntryEvent::PartSent).ok()?;
        let offset = match entry.state {
            EntryState::Sending { held } => held.min(parcel_bytes),
            _ => 0,
        };
        let len = (parcel_bytes - offset).min(MAX_CHUNK_BYTES);
        self.uploads.requests = self.uploads.requests.wrapping_add(1);
        let (number, id) = (self.uploads.requests, entry.id);
        let sent_ms = self.elapsed_ms;
        self.uploads.in_flight = Some(InFlight { number, id, offset, parcel_bytes, sent_ms });
        Some(UploadRequest { number, id, hash, parcel_bytes, offset, len })
    }

    /// Takes what came of a request. A receipt counts whenever it comes, anything else only for the request under
    /// way.
    ///
    /// # Errors
    /// Those of [`Outbox::take_receipt`]; the request has failed then, unless the receipt was taken before.
    pub fn take_upload_answer(
        &mut self,
        number: u32,
        answer: UploadAnswer,
        random: u32,
    ) -> Result<(), OutboxRefusal> {
        let taken = match answer {
            UploadAnswer::Receipt(receipt) => self.take_receipt(&receipt),
            _ => Ok(()),
        };
        let in_flight = self.uploads.in_flight.filter(|request| request.number == number);
        let Some(request) = in_flight else { return taken };
        self.uploads.in_flight = None;
        match answer {
            UploadAnswer::Receipt(_) => match taken {
                Ok(()) | Err(OutboxRefusal::WrongState) => self.uploads.failures = 0,
                Err(_) => self.note_upload_failed(request.id, random),
            },
            UploadAnswer::Held { bytes } => self.note_held(&request, bytes, random),
            UploadAnswer::Refused => self.note_refused(request.id, random),
            UploadAnswer::Busy { retry_after_seconds: 0 } | UploadAnswer::Failed => {
                self.note_upload_failed(request.id, random);
            }
            UploadAnswer::Busy { retry_after_seconds } => {
                self.wait_for_busy_booth(retry_after_seconds, random);
            }
        }
        taken
    }

    /// Whether requests come to nothing: sculptures that wait are *kept here* for now.
    #[must_use]
    pub const fn is_waiting_for_booth(&self) -> bool {
        self.uploads.failures > 0
    }

    fn note_held(&mut self, request: &InFlight, bytes: u64, random: u32) {
        let held = u32::try_from(bytes).ok().filter(|&held| held <= request.parcel_bytes);
        let Some(held) = held else { return self.note_upload_failed(request.id, random) };
        // It may have been signed for by a late receipt.
        let _ = self.apply(request.id, EntryEvent::PartHeld { held });
        if held <= request.offset {
            return self.note_upload_failed(request.id, random);
        }
        self.uploads.failures = 0;
        if let Ok(entry) = self.find_mut(request.id) {
            entry.failures = 0;
        }
    }

    fn note_refused(&mut self, id: SculptureId, random: u32) {
        self.uploads.failures = 0;
        let retry_ms = self.elapsed_ms.saturating_add(jittered_wait_ms(
            REFUSED_RETRY_MS,
            REFUSED_RETRY_MS,
            1,
            random,
        ));
        if self.apply(id, EntryEvent::RefusedByBooth).is_ok()
            && let Ok(entry) = self.find_mut(id)
        {
            entry.retry_ms = retry_ms;
        }
    }

    /// The booth is there: nothing has failed, and nothing is sent until it said so. What waits is spread, as others were
    /// told the same.
    fn wait_for_busy_booth(&mut self, retry_after_seconds: u32, random: u32) {
        let asked_ms = u64::from(retry_after_seconds.min(MAX_RETRY_AFTER_SECONDS)) * 1000;
        let spread_ms = jittered_wait_ms(UPLOAD_WAIT_MS, UPLOAD_WAIT_MS, 1, random);
        self.uploads.failures = 0;
        self.uploads.wait_until_ms = self.elapsed_ms.saturating_add(asked_ms + spread_ms);
    }

    fn note_upload_failed(&mut self, id: SculptureId, random: u32) {
        let failures = self.uploads.failures.saturating_add(1);
        let wait_ms = jittered_wait_ms(UPLOAD_WAIT_MS, MAX_UPLOAD_WAIT_MS, failures, random);
        self.uploads.failures = failures;
        self.uploads.wait_until_ms = self.elapsed_ms.saturating_add(wait_ms);
        if let Ok(entry) = self.find_mut(id) {
            entry.failures = entry.failures.saturating_add(1);
        }
    }

    fn give_up_late_upload(&mut self, random: u32) {
        let is_late = |request: &InFlight| {
            self.elapsed_ms.saturating_sub(request.sent_ms) >= UPLOAD_TIMEOUT_MS
        };
        if let Some(request) = self.uploads.in_flight.filter(is_late) {
            self.uploads.in_flight = None;
            self.note_upload_failed(request.id, random);
        }
    }
}

impl OutboxEntry {
    fn is_to_be_sent(&self, now_ms: u64) -> bool {
        match self.state {
            EntryState::Kept | EntryState::Sending { .. } => true,
            EntryState::Refused => now_ms >= self.retry_ms,
            _ => false,
        }
    }
}
