//! The random actions of visitors, staff, thieves and faults in a simulated exhibition.

use std::time::Duration;

use paros_protocol::{CommandKind, Parcel, SculptureId, UploadFacts};
use paros_upload::{BoothRequest, OutboxHost as _, RequestKind};

use crate::exhibition::{Exhibition, THIEF};
use crate::network::Weather;
use crate::truth::{Asked, Made, facts_of, number_of_facts};

impl Exhibition {
    /// Performs one random action.
    pub(crate) fn act(&mut self) {
        let h = self.any_headset();
        match self.dice.below(30) {
            0..6 => self.finish_sculpture(h),
            6..11 => self.keep_sculpture(h),
            11 => self.abandon_sculpture(h),
            12..15 => {
                let calls = self.dice.below(12) as u32;
                self.note(&format!("headset {h} loses its power in {calls} calls"));
                self.headsets[h].disk.borrow_mut().set_fuse(calls);
            }
            15 => {
                self.note(&format!("headset {h} is killed"));
                self.headsets[h].kill();
            }
            16 if self.dice.one_in(3) => self.wipe(h),
            17 if self.dice.one_in(3) => self.rot(h),
            18 => {
                let is_full = self.dice.one_in(2);
                self.headsets[h].disk.borrow_mut().is_full = is_full;
            }
            19 => self.weather = Weather::draw(&mut self.dice),
            20 | 21 => {
                let fails_of = [0, 0, 30, 4][self.dice.below(4) as usize];
                self.booth.set_failures(fails_of);
            }
            22 | 23 => self.ask_command(h),
            24 => self.delete_at_booth(),
            25 => self.steal(),
            26 => self.jump_clock(h),
            27 => self.headsets[h].host.session_id = self.dice.next_bits() * self.dice.below(2),
            28 => _ = self.booth.booth.sweep(self.booth_time(), Duration::MAX),
            29 => self.back_up_or_restore(),
            _ => {}
        }
        self.headsets[h].see_whether_it_is_dead();
    }

    fn any_id(&mut self) -> SculptureId {
        let mut id = [1; 16];
        id[..8].copy_from_slice(&self.dice.next_bits().to_le_bytes());
        SculptureId(id)
    }

    fn finish_sculpture(&mut self, h: usize) {
        let id = self.any_id();
        let headset = &mut self.headsets[h];
        let Some(sender) = &mut headset.sender else { return };
        let badge = sender.take_badge(headset.host.random());
        let (serial, badge) = (sender.badge_serial(badge), Some(badge));
        let is_taken = sender.announce(id, badge).is_ok();
        if headset.see_whether_it_is_dead() || !is_taken {
            return;
        }
        let number = self.truth.made.len();
        headset.pending.push(number);
        let is_poison = self.dice.one_in(20);
        self.truth.made.push(Made { serial, is_poison, ..Made::new(h, id, badge) });
        self.note(&format!("headset {h} finishes {number} as {id}"));
    }

    fn any_volume(&mut self, number: usize) -> Vec<u8> {
        let len = if self.dice.one_in(60) { 600_000 } else { 1 + self.dice.below(1500) };
        let mut bytes: Vec<u8> = (0..len).map(|_| self.dice.next_bits() as u8).collect();
        bytes[0] = number as u8;
        bytes
    }

    fn keep_sculpture(&mut self, h: usize) {
        let Some(number) = self.headsets[h].pending.pop() else { return };
        let volume = self.any_volume(number);
        let headset = &mut self.headsets[h];
        let facts = facts_of(number, &self.truth.made[number]);
        let parcel = Parcel::pack(&facts, &volume, None).expect("a parcel of its size");
        let Some(sender) = &mut headset.sender else { return };
        let kept = sender.keep(&parcel);
        let is_dead = headset.see_whether_it_is_dead();
        if kept.is_ok() && !is_dead {
            self.truth.made[number].was_kept_here = true;
        } else if !is_dead && self.dice.one_in(2) {
            self.headsets[h].pending.push(number);
        }
        self.note(&format!("headset {h} keeps {number}: {kept:?}"));
    }

    fn abandon_sculpture(&mut self, h: usize) {
        let Some(number) = self.headsets[h].pending.pop() else { return };
        let id = self.truth.made[number].id;
        if let Some(sender) = &mut self.headsets[h].sender {
            // The parcel may be stored even so, if the write failed only at its end.
            let _ = sender.abandon(id);
        }
        self.note(&format!("headset {h} abandons {number}"));
    }

    fn wipe(&mut self, h: usize) {
        self.note(&format!("headset {h} is wiped"));
        self.headsets[h].kill();
        self.headsets[h].disk.borrow_mut().wipe();
        let of_it = self.truth.made.iter_mut().filter(|made| made.headset == h);
        of_it.for_each(|made| made.is_excused = true);
    }

    fn rot(&mut self, h: usize) {
        let names = self.headsets[h].list_files();
        if names.is_empty() {
            return;
        }
        let name = &names[self.dice.below(names.len() as u64) as usize];
        let number = self.headsets[h].number_in_file(name);
        self.headsets[h].disk.borrow_mut().rot(name);
        if let Some(number) = number {
            self.truth.made[number].is_excused = true;
        }
        self.note(&format!("headset {h}: {name} rots"));
    }

    fn jump_clock(&mut self, h: usize) {
        let host = &mut self.headsets[h].host;
        host.clock_ms = if self.dice.one_in(2) {
            host.clock_ms + self.dice.below(1 << 40)
        } else {
            host.clock_ms.saturating_sub(600_000 + self.dice.below(1 << 41))
        };
    }

    fn ask_command(&mut self, h: usize) {
        let kind = CommandKind::ALL[self.dice.below(5) as usize];
        let (number, now) = (self.headsets[h].number, self.booth_time());
        let Ok(id) = self.booth.booth.ask_command(number, kind, "staff", now) else { return };
        let asked = self.booth.find_command(number, id);
        let (session_id, boot_id) = (asked.session, asked.boot);
        let asked = Asked { asked_ms: self.now_ms, kind, session_id, boot_id, done: 0 };
        self.truth.commands.insert((h, id), asked);
    }

    fn delete_at_booth(&mut self) {
        let (sculptures, _) = self.booth.list_all();
        if sculptures.is_empty() {
            return;
        }
        let at = self.dice.below(sculptures.len() as u64) as usize;
        let id = SculptureId(sculptures[at].id);
        let now = self.booth_time();
        // The call may fail after the sculpture has been deleted, if the booth's disk fails.
        let _ = self.booth.booth.delete(&id, "staff", now);
        let (_, tombstones) = self.booth.list_all();
        if tombstones.iter().any(|tombstone| tombstone.id == id.0) {
            let facts = UploadFacts::from_json(&sculptures[at].facts).expect("checked facts");
            self.truth.made[number_of_facts(&facts)].was_deleted = true;
        }
        self.note(&format!("the staff deletes {id}"));
    }

    /// Sends a thief's own sculpture under another headset's id.
    fn steal(&mut self) {
        if self.truth.made.is_empty() || self.truth.restores > 0 {
            return;
        }
        let at = self.dice.below(self.truth.made.len() as u64) as usize;
        let victim = self.truth.made[at].clone();
        let number = self.truth.made.len();
        let theirs = Made { is_poison: false, ..victim };
        let parcel = Parcel::pack(&facts_of(number, &theirs), &[1, 2, 3], None);
        let parcel = parcel.expect("a parcel of its size");
        let kind = RequestKind::Put(victim.id);
        let request = BoothRequest { kind, number: 1, body: parcel.into_file() };
        let answer = self.booth.serve(THIEF, &request, self.booth_time());
        if answer.status == 200 {
            // Records the thief's sculpture as a separate sculpture that may be lost.
            self.truth.stolen += 1;
            self.truth.made[at].is_stolen = true;
            let id = SculptureId([255; 16]);
            self.truth.made.push(Made { id, is_excused: true, was_kept_here: false, ..theirs });
        }
        self.note(&format!("a thief sends {}: {}", victim.id, answer.status));
    }
}
