//! Whatever happens in any order, the outbox stands as its model does.

use paros_core::badge::BadgeNumber;
use paros_core::limits::{MAX_ANNOUNCEMENTS, REFUSED_RETRY_MS, UPLOAD_TIMEOUT_MS};
use paros_core::outbox::messages::{
    AnnouncementState, HeartbeatAnswer, Receipt, ReceiptOutcome, SculptureId,
};
use paros_core::outbox::{Outbox, OutboxOwner, OutboxSettings, UploadAnswer, UploadRequest};
use paros_models::outbox::OutboxModel;
use paros_models::random_visitor::RandomSource;

use super::journal::save;
use super::{OWNER, SETTINGS, STATUS, hash_of};

struct Exhibition {
    outbox: Box<Outbox>,
    settings: OutboxSettings,
    model: OutboxModel,
    dice: RandomSource,
    clock_ms: u64,
    boot_id: u64,
    /// The request under way, and when it was sent.
    sent: Option<(UploadRequest, u64)>,
    /// Of those sent before, to which answers come late.
    late: Vec<UploadRequest>,
    receipts: Vec<Receipt>,
}

impl Exhibition {
    fn new(seed: u64) -> Self {
        // In a third of them a few parcels fill it.
        let max_bytes = if seed.is_multiple_of(3) { 60_000 } else { SETTINGS.max_bytes };
        let settings = OutboxSettings { max_bytes, ..SETTINGS };
        let mut outbox = Box::new(Outbox::new(OWNER, settings, super::BOOT));
        outbox.pass_time(0);
        Exhibition {
            outbox,
            settings,
            model: OutboxModel::new(OWNER, settings),
            dice: RandomSource::new(seed),
            clock_ms: 0,
            boot_id: super::BOOT,
            sent: None,
            late: Vec::new(),
            receipts: Vec::new(),
        }
    }

    /// Few ids, so that they meet again; now and then a new one.
    fn any_id(&mut self) -> SculptureId {
        let most = if self.dice.one_in(3) { 200 } else { 6 };
        let number = self.dice.below(most);
        SculptureId([number as u8 + 1; 16])
    }

    fn any_badge(&mut self) -> Option<BadgeNumber> {
        BadgeNumber::new(self.dice.below(2) as u32).filter(|badge| badge.get() > 0)
    }

    fn any_receipt(&mut self) -> Receipt {
        let id = self.any_id();
        let badge = self.model.sculptures.iter().find(|other| other.id == id);
        let badge = badge.and_then(|sculpture| sculpture.badge);
        let outcome = ReceiptOutcome::ALL[usize::from(self.dice.one_in(4))];
        let OutboxOwner { site, headset } = OWNER;
        let hash = hash_of(if self.dice.one_in(9) { self.any_id() } else { id });
        Receipt { site, headset, id, hash, badge, outcome }
    }

    fn act(&mut self) {
        match self.dice.below(12) {
            0 => {
                let (id, badge) = (self.any_id(), self.any_badge());
                let is_done = self.model.announce(id, badge);
                assert_eq!(self.outbox.announce(id, badge).is_ok(), is_done);
            }
            1 | 2 => {
                let (id, badge, bytes) = (self.any_id(), self.any_badge(), self.any_bytes());
                let is_done = self.model.keep(id, badge, hash_of(id), bytes);
                assert_eq!(self.outbox.keep(id, badge, hash_of(id), bytes).is_ok(), is_done);
            }
            3 if self.dice.one_in(3) => {
                let id = self.any_id();
                let is_done = self.model.lose(id);
                assert_eq!(self.outbox.note_parcel_missing(id).is_ok(), is_done);
            }
            3 => self.renew(),
            4 => {
                let receipt = self.any_receipt();
                let is_done = self.model.sign(&receipt);
                assert_eq!(self.outbox.take_receipt(&receipt).is_ok(), is_done);
                self.receipts.push(receipt);
            }
            5 | 6 => self.send(),
            7 | 8 => self.answer(),
            9 => self.pass_time(),
            10 if self.dice.one_in(2) => self.delete(),
            10 => self.beat(),
            _ => self.write_journal(),
        }
    }

    fn any_bytes(&mut self) -> u32 {
        110 + self.dice.below(700_000) as u32
    }

    fn renew(&mut self) {
        let (old, new) = (self.any_id(), self.any_id());
        let is_done = self.model.renew(old, new, hash_of(new));
        assert_eq!(self.outbox.renew(old, new, hash_of(new)).is_ok(), is_done, "{old} as {new}");
    }

    fn send(&mut self) {
        let now_ms = self.model.now_ms;
        let request = self.outbox.begin_upload(self.dice.next_bits() as u32);
        if let Some((late, sent_ms)) = self.sent {
            assert_eq!(request, None, "one at a time, and a wait after one that failed");
            if now_ms - sent_ms >= UPLOAD_TIMEOUT_MS {
                self.model.note_answer(late.id, |sculpture| sculpture.failures += 1);
                self.late.push(late);
                self.sent = None;
            }
            return;
        }
        let Some(request) = request else { return };
        // Between half of its wait and all of it a refused one may be tried.
        let expected = self.model.next_upload(|sculpture| {
            let waited = sculpture.refused_ms.map_or(REFUSED_RETRY_MS, |since| now_ms - since);
            let may_be = sculpture.id == request.id && waited >= REFUSED_RETRY_MS / 2;
            may_be || waited >= REFUSED_RETRY_MS
        });
        assert_eq!(Some((request.id, request.offset, request.len)), expected);
        assert_eq!(request.hash, hash_of(request.id));
        self.model.note_sent(request.id);
        self.sent = Some((request, now_ms));
    }

    fn answer(&mut self) {
        let random = self.dice.next_bits() as u32;
        if self.dice.one_in(4) && !self.late.is_empty() {
            let at = self.dice.below(self.late.len() as u64) as usize;
            let number = self.late.swap_remove(at).number;
            let answers = [UploadAnswer::Refused, UploadAnswer::Held { bytes: 1 }];
            let answer = answers[self.dice.below(2) as usize];
            assert_eq!(self.outbox.take_upload_answer(number, answer, random), Ok(()));
            return;
        }
        let Some((request, _)) = self.sent.take() else { return };
        let now_ms = self.model.now_ms;
        let answer = match self.dice.below(5) {
            0 => UploadAnswer::Failed,
            1 => UploadAnswer::Busy { retry_after_seconds: self.dice.below(100) as u32 },
            2 => UploadAnswer::Refused,
            3 => UploadAnswer::Receipt(self.any_receipt()),
            _ => UploadAnswer::Held { bytes: self.dice.below(u64::from(request.parcel_bytes) + 9) },
        };
        let taken = self.outbox.take_upload_answer(request.number, answer, random);
        if let UploadAnswer::Receipt(receipt) = answer {
            let is_done = self.model.sign(&receipt);
            assert_eq!(taken.is_ok(), is_done);
            let is_late = taken == Err(paros_core::outbox::OutboxRefusal::WrongState);
            if is_done || is_late {
                return;
            }
        }
        if matches!(answer, UploadAnswer::Busy { retry_after_seconds: 1.. }) {
            return;
        }
        self.model.note_answer(request.id, |sculpture| {
            let held = match answer {
                UploadAnswer::Held { bytes } => u32::try_from(bytes).ok(),
                _ => None,
            };
            let held = held.filter(|&held| held <= request.parcel_bytes);
            let is_on_way = sculpture.waits() && sculpture.held.is_some();
            if answer == UploadAnswer::Refused {
                if is_on_way && !sculpture.is_refused {
                    sculpture.is_refused = true;
                    (sculpture.refused_ms, sculpture.held) = (Some(now_ms), None);
                }
                return;
            }
            if is_on_way && !sculpture.is_refused {
                sculpture.held = held.or(sculpture.held);
            }
            let is_progress = held.is_some_and(|held| held > request.offset);
            sculpture.failures = if is_progress { 0 } else { sculpture.failures + 1 };
        });
    }

    fn pass_time(&mut self) {
        let longest = [900, 8_000, 40_000_000][self.dice.below(3) as usize];
        let passed = self.dice.below(longest);
        self.clock_ms += passed;
        self.model.pass_time(passed);
        self.outbox.pass_time(self.clock_ms);
    }

    fn beat(&mut self) {
        if !self.outbox.is_heartbeat_due() {
            return;
        }
        let heartbeat = self.outbox.begin_heartbeat(&STATUS, None, 0);
        let owed = || {
            self.model.sculptures.iter().filter_map(|sculpture| {
                sculpture.announcement().map(|announcement| (announcement, sculpture.noted))
            })
        };
        let all = owed().count();
        let news = owed().filter(|(announcement, noted)| *noted != Some(*announcement));
        let list = &heartbeat.announcements;
        assert_eq!(usize::from(heartbeat.outbox_depth), all);
        let (told_of, questions) = list.split_at(all.min(MAX_ANNOUNCEMENTS));
        let expected = self.model.questions().take(MAX_ANNOUNCEMENTS - told_of.len());
        assert_eq!(questions, expected.collect::<Vec<_>>());
        let questions: Vec<_> = questions.iter().map(|question| question.id).collect();
        let told = news.clone().filter(|(announcement, _)| list.contains(announcement));
        assert_eq!(told.count(), news.count().min(MAX_ANNOUNCEMENTS), "news go first");
        for sculpture in &mut self.model.sculptures {
            sculpture.is_asked = questions.contains(&sculpture.id);
        }
        let mut noted = list.clone();
        noted.retain(|_| !self.dice.one_in(3));
        if let Some(first) = noted.first_mut().filter(|_| self.dice.one_in(5)) {
            first.state = AnnouncementState::Lost;
        }
        for announcement in &mut noted {
            if questions.contains(&announcement.id) {
                if self.dice.one_in(3) {
                    announcement.state = AnnouncementState::Kept;
                }
                let has_it = announcement.state == AnnouncementState::SignedFor;
                self.model.note_question(announcement.id, has_it);
            } else {
                self.model.note(announcement);
            }
        }
        let answer = HeartbeatAnswer {
            site: OWNER.site,
            headset: OWNER.headset,
            boot_id: self.boot_id,
            number: heartbeat.number,
            booth_time: 0,
            lease: None,
            command: None,
            noted,
        };
        assert_eq!(self.outbox.take_heartbeat_answer(&answer, 5), Some(None));
    }

    /// Writes the journal; then something is deleted, or the program starts again.
    fn write_journal(&mut self) {
        let bytes = save(&self.outbox);
        self.outbox.note_journal_written();
        self.model.note_journal_written();
        if self.dice.one_in(2) {
            self.delete();
        } else if self.dice.one_in(3) {
            let loaded = Outbox::load(&bytes, OWNER, self.settings, super::BOOT + 1);
            *self.outbox = loaded.expect("its journal");
            (self.boot_id, self.clock_ms) = (super::BOOT + 1, 0);
            self.outbox.pass_time(0);
            self.model.restart();
            self.model.pass_time(0);
            self.sent = None;
            self.late.clear();
        }
    }

    /// Deletes one of what may be, whether or not the journal is behind.
    fn delete(&mut self) {
        let to_delete: Vec<_> = self.outbox.parcels_to_delete().collect();
        assert_eq!(to_delete, self.model.list_parcels_to_delete());
        if !to_delete.is_empty() {
            let id = to_delete[self.dice.below(to_delete.len() as u64) as usize];
            self.model.delete(id);
            assert_eq!(self.outbox.note_deleted(id), Ok(()));
        }
    }

    fn check(&self) {
        let model = &self.model;
        let (now_ms, grace) = (model.now_ms, model.grace_seconds);
        assert_eq!(self.outbox.entries().len(), model.sculptures.len());
        let mut bytes = 0;
        for (entry, sculpture) in self.outbox.entries().iter().zip(&model.sculptures) {
            let is = (entry.id, entry.badge, entry.state, entry.replaced);
            let state = sculpture.state(now_ms, grace);
            assert_eq!(is, (sculpture.id, sculpture.badge, state, sculpture.replaced));
            let parcel = entry.hash.map(|hash| (hash, entry.parcel_bytes));
            assert_eq!(parcel, sculpture.parcel);
            bytes += parcel
                .filter(|_| sculpture.is_parcel_here)
                .map_or(0, |(_, bytes)| u64::from(bytes));
        }
        assert_eq!(self.outbox.bytes_here(), bytes);
        assert!(!model.sculptures.iter().any(|sculpture| sculpture.failures > 200));
    }
}

#[test]
fn whatever_happens_it_stands_as_its_model_does() {
    let mut sent = 0;
    for seed in 0..400 {
        let mut exhibition = Exhibition::new(seed);
        for _ in 0..400 {
            exhibition.act();
            exhibition.check();
        }
        sent += exhibition.receipts.len();
    }
    assert!(sent > 5_000, "{sent} receipts");
}
