//! What the driver makes of the booth's answers.

use paros_core::outbox::messages::{
    ContentHash, HeartbeatAnswer, Receipt, ReceiptOutcome, SculptureId,
};
use paros_core::outbox::{EntryState, UploadAnswer};

use super::driver::{OutboxDriver, parcel_name};
use super::events::{OutboxEvent, OutboxHost};
use super::folder::OutboxFolder;
use super::link::{
    BoothLink, HttpAnswer, LinkAnswer, LinkFault, PutAnswer, SentRequest, read_put_answer,
};

impl<F: OutboxFolder, L: BoothLink> OutboxDriver<F, L> {
    pub(super) fn take_answer(&mut self, answer: &LinkAnswer, host: &mut impl OutboxHost) {
        match answer.request {
            SentRequest::Put { number } => {
                self.take_put_answer(number, &answer.result, host.random());
            }
            SentRequest::Heartbeat { number } => {
                let session_id = host.status().session_id;
                self.take_heartbeat_answer(number, &answer.result, session_id);
            }
        }
    }

    fn take_put_answer(
        &mut self,
        number: u32,
        result: &Result<HttpAnswer, LinkFault>,
        random: u32,
    ) {
        let sent = self.sent.filter(|request| request.number == number);
        if sent.is_some() {
            self.sent = None;
        }
        let upload = match (read_put_answer(result), sent) {
            (PutAnswer::Upload(upload), _) => upload,
            // What is late says nothing of the request under way.
            (_, None) => return,
            (PutAnswer::Conflict, Some(request)) => {
                self.renew(request.id, request.hash);
                UploadAnswer::Failed
            }
            (PutAnswer::UnknownToken, _) => {
                self.events.push(OutboxEvent::UnknownToken);
                UploadAnswer::Failed
            }
            (PutAnswer::ShutOut, _) => {
                self.events.push(OutboxEvent::ShutOut);
                UploadAnswer::Failed
            }
        };
        let taken = self.outbox.take_upload_answer(number, upload, random);
        match (upload, sent, taken) {
            (UploadAnswer::Receipt(receipt), _, Ok(())) => {
                self.events.push(event_of_receipt(&receipt));
            }
            (UploadAnswer::Refused, Some(request), _) => {
                let entry = self.outbox.find(request.id);
                // A late answer changes nothing.
                if entry.is_some_and(|entry| entry.state == EntryState::Refused) {
                    self.events.push(OutboxEvent::RefusedByBooth(request.id));
                }
            }
            _ => {}
        }
    }

    /// The sculpture goes on under another id, as one of this headset. Where that can't be written now, it is tried again.
    pub(super) fn renew(&mut self, old: SculptureId, hash: ContentHash) {
        let parcel = self.read_parcel(old);
        let Some(parcel) = parcel.filter(|parcel| parcel.hash() == hash) else { return };
        let Ok(renewed) = parcel.renew(self.outbox.owner().headset) else { return };
        let new = renewed.facts().id;
        let successor = self.outbox.find(new).or(self.outbox.successor_of(new));
        let is_here = successor.is_some_and(|entry| entry.state.has_parcel());
        if !is_here && self.folder.write(&parcel_name(new), &renewed.to_file()).is_err() {
            return;
        }
        if self.outbox.renew(old, new, renewed.hash()).is_ok() {
            self.given_up.push(old);
            self.events.push(OutboxEvent::Renewed { old, new });
        }
    }

    fn take_heartbeat_answer(
        &mut self,
        number: u32,
        result: &Result<HttpAnswer, LinkFault>,
        session_id: u64,
    ) {
        let answer = match result {
            Ok(HttpAnswer { status: 200, body, .. }) => HeartbeatAnswer::from_bytes(body).ok(),
            Ok(HttpAnswer { status: 401, .. }) => {
                self.events.push(OutboxEvent::UnknownToken);
                None
            }
            Ok(HttpAnswer { status: 403, .. }) => {
                self.events.push(OutboxEvent::ShutOut);
                None
            }
            _ => None,
        };
        let taken = answer.as_ref().map(|answer| {
            let lives_ms = answer.command.map_or(0, |command| u64::from(command.lives_ms));
            let lease = answer.lease.clone();
            (self.outbox.take_heartbeat_answer(answer, session_id), lease, lives_ms)
        });
        match taken {
            Some((Some(command), lease, lives_ms)) => {
                self.events.extend(lease.map(OutboxEvent::Lease));
                let ends_ms = self.heartbeat_ms.saturating_add(lives_ms);
                let due = |command| OutboxEvent::Command { command, session_id, ends_ms };
                self.events.extend(command.map(due));
            }
            _ => self.outbox.note_heartbeat_failed(number),
        }
    }
}

const fn event_of_receipt(receipt: &Receipt) -> OutboxEvent {
    match receipt.outcome {
        ReceiptOutcome::Kept => OutboxEvent::KeptAtBooth(receipt.id),
        ReceiptOutcome::Deleted => OutboxEvent::DeletedAtBooth(receipt.id),
    }
}
