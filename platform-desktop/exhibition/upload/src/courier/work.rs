//! The work of the courier's thread.

use std::mem;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use paros_protocol::{ContentHash, HeadsetStatus, Parcel, SculptureId, UploadFacts, UploadStatus};

use super::board::Board;
use super::mark;
use super::orders::{CourierOrder, FinishedSculpture, ParcelDraft};
use super::{CourierLink, CourierPlan};
use crate::events::{OutboxEvent, OutboxHost};
use crate::folder::DiskFolder;
use crate::sender::Sender;
use crate::spool::SpoolError;

/// Interval between two steps of the outbox.
const STEP: Duration = Duration::from_millis(100);

/// Retry interval of parcels that couldn't be stored: a full disk stays full for a while.
const KEEP_RETRY: Duration = Duration::from_secs(5);

/// Largest number of parcels that wait for room. Beyond it, the oldest is given up. A parcel takes some
/// megabytes of memory.
const MAX_WAITING: usize = 8;

/// The outbox and the state of its thread.
pub(super) struct Work {
    sender: Sender<DiskFolder, CourierLink>,
    host: CourierHost,
    mark_path: PathBuf,
    last_finished: Option<FinishedSculpture>,
    /// Parcels that couldn't be stored yet.
    waiting: Vec<Parcel>,
    tried: Instant,
}

/// The outbox's interface to the courier: clock, random bits, status and events.
struct CourierHost {
    board: Arc<Mutex<Board>>,
    clock: fn() -> u64,
}

impl CourierHost {
    fn board(&self) -> MutexGuard<'_, Board> {
        super::lock(&self.board)
    }
}

impl OutboxHost for CourierHost {
    fn now_ms(&mut self) -> u64 {
        (self.clock)()
    }

    fn random(&mut self) -> u32 {
        // Without random bits, retries have no jitter.
        getrandom::u32().unwrap_or_default()
    }

    fn status(&mut self) -> HeadsetStatus {
        self.board().status
    }

    fn on_event(&mut self, event: OutboxEvent) {
        let note = match event {
            OutboxEvent::Command { command, ends_ms } => {
                return self.board().commands.push_back((command, ends_ms));
            }
            OutboxEvent::KeptAtBooth(id) => return self.board().note_sent(id),
            OutboxEvent::DeletedAtBooth(id) => format!("sculpture {id} was deleted at the booth"),
            OutboxEvent::RefusedByBooth(id) => {
                format!("the booth can't take sculpture {id}: it stays here")
            }
            OutboxEvent::Lost(id) => format!("sculpture {id} can't be sent: its parcel is lost"),
        };
        self.board().add_note(note);
    }
}

impl Work {
    pub(super) fn open(
        plan: &CourierPlan,
        folder: DiskFolder,
        link: CourierLink,
    ) -> Result<Self, SpoolError> {
        let owner = plan.enrolment.owner;
        let boot_id = getrandom::u64().unwrap_or_default() | 1;
        let sender = Sender::open(folder, link, owner, plan.settings, boot_id)?;
        let host = CourierHost { board: Arc::new(Mutex::new(Board::new())), clock: plan.clock };
        let mark_path = mark::path_in(&plan.folder);
        let last_finished = mark::read(&mark_path);
        let waiting = Vec::new();
        let work = Work { sender, host, mark_path, last_finished, waiting, tried: Instant::now() };
        work.show();
        Ok(work)
    }

    pub(super) fn board(&self) -> Arc<Mutex<Board>> {
        self.host.board.clone()
    }

    pub(super) fn list_found(&self) -> Vec<(SculptureId, UploadStatus)> {
        self.sender.spool().entries().iter().map(|entry| (entry.id, entry.status)).collect()
    }

    pub(super) const fn last_finished(&self) -> Option<FinishedSculpture> {
        self.last_finished
    }

    /// Steps the outbox and carries out orders, until the courier's handle is dropped. Returns the parcels
    /// that found no room.
    pub(super) fn run(mut self, orders: &Receiver<CourierOrder>) -> Vec<Parcel> {
        let mut next_step = Instant::now();
        loop {
            let wait = next_step.saturating_duration_since(Instant::now());
            match orders.recv_timeout(wait) {
                Ok(order) => self.carry_out(order),
                Err(RecvTimeoutError::Timeout) => {
                    self.retry_waiting();
                    self.sender.step(&mut self.host);
                    next_step = Instant::now() + STEP;
                }
                Err(RecvTimeoutError::Disconnected) => {
                    self.tried = Instant::now().checked_sub(KEEP_RETRY).unwrap_or(self.tried);
                    self.retry_waiting();
                    return self.waiting;
                }
            }
            self.show();
        }
    }

    fn carry_out(&mut self, order: CourierOrder) {
        match order {
            CourierOrder::Announce { id, volume } => self.announce(id, &volume),
            CourierOrder::TakeBadge { id } => {
                let random = self.host.random();
                let badge = self.sender.take_badge(random);
                self.host.board().add_badge(id, badge);
            }
            CourierOrder::NoteBadge { id, badge } => {
                // An error is ignored, as the parcel carries the badge too.
                let _ = self.sender.note_badge(id, badge);
            }
            CourierOrder::Keep(draft) => self.pack_and_keep(*draft),
            CourierOrder::KeepParcel(parcel) => self.keep(*parcel),
            // The parcel was made, and waits for room.
            CourierOrder::Abandon { id } if self.is_waiting(id) => {}
            CourierOrder::Abandon { id } => {
                // A sculpture that is stored or unknown needs no abandoning, so errors are ignored.
                let _ = self.sender.abandon(id);
                self.host.board().note_under_way(id, None);
            }
            CourierOrder::CommandDone { id, outcome } => self.sender.note_command_done(id, outcome),
        }
    }

    fn announce(&mut self, id: SculptureId, volume: &[u8]) {
        match self.sender.announce(id, None) {
            // The previous start already stored its parcel.
            Ok(()) | Err(SpoolError::KnownId) => {}
            Err(error) => self.host.board().add_note(format!("not announced: {error}")),
        }
        let volume_hash = ContentHash::of(volume);
        self.mark_finished(FinishedSculpture { id, volume_hash, is_kept: false });
    }

    fn mark_finished(&mut self, finished: FinishedSculpture) {
        self.last_finished = Some(finished);
        if let Err(error) = mark::write(&self.mark_path, &finished) {
            self.host.board().add_note(error.to_string());
        }
    }

    fn pack_and_keep(&mut self, draft: ParcelDraft) {
        let ParcelDraft { facts, volume, trace } = draft;
        let badge_serial = facts.badge.and_then(|badge| self.sender.badge_serial(badge));
        let facts = UploadFacts { badge_serial, ..facts };
        match Parcel::pack(&facts, &volume, trace.as_deref()) {
            Ok(parcel) => self.keep(parcel),
            Err(fault) => {
                self.host.board().add_note(format!("sculpture {}: {fault}", facts.id));
                self.carry_out(CourierOrder::Abandon { id: facts.id });
            }
        }
    }

    fn keep(&mut self, parcel: Parcel) {
        let id = parcel.facts().id;
        let kept = self.sender.keep(&parcel);
        let is_last = |finished: &FinishedSculpture| finished.id == id;
        if let Some(finished) = self.last_finished.filter(is_last)
            && kept.is_ok()
        {
            self.mark_finished(FinishedSculpture { is_kept: true, ..finished });
        }
        if let Err(error) = &kept {
            self.host.board().add_note(format!("sculpture {id} isn't kept yet: {error}"));
            self.waiting.push(parcel);
        }
        let status = kept.is_err().then_some(UploadStatus::Waiting);
        self.host.board().note_under_way(id, status);
        if self.waiting.len() > MAX_WAITING {
            let id = self.waiting.remove(0).facts().id;
            self.carry_out(CourierOrder::Abandon { id });
        }
    }

    fn retry_waiting(&mut self) {
        if self.waiting.is_empty() || self.tried.elapsed() < KEEP_RETRY {
            return;
        }
        self.tried = Instant::now();
        mem::take(&mut self.waiting).into_iter().for_each(|parcel| self.keep(parcel));
    }

    fn is_waiting(&self, id: SculptureId) -> bool {
        self.waiting.iter().any(|parcel| parcel.facts().id == id)
    }

    fn show(&self) {
        self.host.board().show(&self.sender);
    }
}
