//! What the booth promises, whatever is lost, doubled, late or deleted, by several headsets at once.

mod common;

use std::collections::BTreeMap;

use common::*;
use paros_booth_rules::records::{BadgeClaim, Device, Sculpture, Tombstone};
use paros_booth_rules::{BoothTime, KeptPart, ParcelProgress, Query, view};
use paros_core::outbox::messages::*;
use proptest::prelude::*;

/// What happens next, to one of the sculptures.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// Its headset announces it.
    Announce(u8),
    /// A piece of it arrives, from where the headset believes it to be.
    Piece(u8),
    /// The headset asks from the start again, having forgotten all.
    Restart(u8),
    /// It is finished, if it is whole.
    Finish(u8),
    /// The booth dies while it is finished: its files are kept, its record isn't.
    DieWhileFinishing(u8),
    /// Another headset sends it as its own.
    Steal(u8),
    Withdraw(u8),
    BringBack(u8),
    Delete(u8),
    /// So many days pass, and a sweep.
    Sweep(u8),
}

fn any_step() -> impl Strategy<Value = Step> {
    let sculpture = || 0..SCULPTURES;
    prop_oneof![
        3 => sculpture().prop_map(Step::Announce),
        8 => sculpture().prop_map(Step::Piece),
        1 => sculpture().prop_map(Step::Restart),
        6 => sculpture().prop_map(Step::Finish),
        2 => sculpture().prop_map(Step::DieWhileFinishing),
        2 => sculpture().prop_map(Step::Steal),
        1 => sculpture().prop_map(Step::Withdraw),
        1 => sculpture().prop_map(Step::BringBack),
        1 => sculpture().prop_map(Step::Delete),
        1 => (0..9u8).prop_map(Step::Sweep),
    ]
}

const SCULPTURES: u8 = 6;

/// Two headsets, three sculptures each; two of them have the same leased badge.
struct Play {
    rig: Rig,
    devices: [Device; 2],
    parcels: Vec<Parcel>,
    /// Where each headset believes its parcel to be.
    offsets: [u64; SCULPTURES as usize],
    announced: Vec<u8>,
    signed: BTreeMap<u8, Receipt>,
    now: BoothTime,
}

impl Play {
    fn new() -> Self {
        let rig = Rig::new();
        let devices = [rig.enrol(1), rig.enrol(2)];
        // The second one claims what the first one was handed.
        let numbers = rig.lease(&devices[0], 1);
        let parcels = (0..SCULPTURES)
            .map(|k| {
                let headset = devices[usize::from(k % 2)].headset;
                Parcel::new(headset, k + 1, numbers[usize::from(k) / 3 * 7])
            })
            .collect();
        let (announced, signed) = (Vec::new(), BTreeMap::new());
        Play { rig, devices, parcels, offsets: [0; 6], announced, signed, now: START }
    }

    fn run(&mut self, step: Step) {
        self.now = BoothTime(self.now.0 + 1000);
        let booth = &self.rig.booth;
        match step {
            Step::Announce(k) => {
                let device = &self.devices[usize::from(k % 2)];
                let announced = self.parcels[usize::from(k)].announcement(AnnouncementState::Kept);
                let beat = announcing(&heartbeat(device.headset), &[announced]);
                assert_eq!(self.rig.beat(device, &beat, self.now).noted.len(), 1);
                self.announced.push(k);
            }
            Step::Piece(k) => self.send_piece(k),
            Step::Restart(k) => self.offsets[usize::from(k)] = 0,
            Step::Finish(k) => self.finish(k),
            Step::DieWhileFinishing(k) => {
                let parcel = &self.parcels[usize::from(k)];
                let name = paros_booth_rules::KeptName {
                    id: parcel.id,
                    hash: parcel.hash,
                    part: KeptPart::Sculpture,
                };
                use paros_booth_rules::ParcelFiles as _;
                let is_deleted = self.count::<Tombstone>(k) > 0;
                if !is_deleted {
                    self.rig.files.keep(&name, &parcel.bytes).unwrap();
                }
            }
            Step::Steal(k) => {
                let thief = &self.devices[usize::from(1 - k % 2)];
                self.rig.upload(thief, &self.parcels[usize::from(k)], self.now).unwrap_err();
            }
            Step::Withdraw(k) => {
                _ = booth.withdraw(&self.parcels[usize::from(k)].id, "a", self.now);
            }
            Step::BringBack(k) => {
                _ = booth.bring_back(&self.parcels[usize::from(k)].id, "a", self.now);
            }
            Step::Delete(k) => _ = booth.delete(&self.parcels[usize::from(k)].id, "a", self.now),
            Step::Sweep(days) => {
                self.now = BoothTime(self.now.0 + u64::from(days) * 86_400_000);
                booth.sweep(self.now).unwrap();
            }
        }
    }

    fn send_piece(&mut self, k: u8) {
        let (parcel, offset) = (&self.parcels[usize::from(k)], self.offsets[usize::from(k)]);
        let rest = &parcel.bytes[offset as usize..];
        let chunk = parcel.chunk(offset, &rest[..rest.len().min(2000)]);
        let device = &self.devices[usize::from(k % 2)];
        match self.rig.booth.take_chunk(device, &chunk).expect("its own") {
            ParcelProgress::Held(held) => self.offsets[usize::from(k)] = held,
            ParcelProgress::Whole => {}
            ParcelProgress::Done(receipt) => self.take_receipt(k, receipt),
        }
    }

    fn finish(&mut self, k: u8) {
        let parcel = &self.parcels[usize::from(k)];
        let question = parcel.chunk(0, &[]);
        let device = &self.devices[usize::from(k % 2)];
        if self.rig.booth.take_chunk(device, &question).expect("its own") == ParcelProgress::Whole {
            let whole = (parcel.id, parcel.hash);
            let done = self.rig.booth.finish_parcel(device, whole, &decode, self.now);
            match done.expect("a sculpture") {
                ParcelProgress::Done(receipt) => self.take_receipt(k, receipt),
                other => panic!("{other:?}"),
            }
        }
    }

    /// What was signed once is signed the same, or was deleted.
    fn take_receipt(&mut self, k: u8, receipt: Receipt) {
        if let Some(before) = self.signed.insert(k, receipt) {
            let is_deleted = receipt.outcome == ReceiptOutcome::Deleted;
            assert!(before == receipt || is_deleted, "{before:?} {receipt:?}");
        }
    }

    fn count<R: paros_booth_rules::Record>(&self, k: u8) -> u64 {
        let query = Query::all::<R>().equal("id", &self.parcels[usize::from(k)].id.0);
        view(self.rig.store.as_ref(), |tx| tx.count_rows(&query)).unwrap()
    }

    fn check(&self) {
        let kept: Vec<Sculpture> =
            view(self.rig.store.as_ref(), |tx| tx.find(&Query::all::<Sculpture>())).unwrap();
        for sculpture in &kept {
            assert_eq!(
                self.rig.booth.read_kept(sculpture).expect("a record's file is there"),
                self.parcels[usize::from(sculpture.id[0] - 1)].bytes
            );
        }
        for (&k, signed) in &self.signed {
            assert!(self.count::<Sculpture>(k) + self.count::<Tombstone>(k) == 1, "{signed:?}");
        }
        let missing = self.rig.booth.list_missing(99).unwrap();
        for &k in &self.announced {
            let id = self.parcels[usize::from(k)].id.0;
            let listed = missing.iter().filter(|missing| missing.announcement.sculpture == id);
            let places =
                listed.count() as u64 + self.count::<Sculpture>(k) + self.count::<Tombstone>(k);
            assert_eq!(places, 1, "sculpture {k} is nowhere, or twice");
        }
        let sole = kept.iter().filter(|kept| kept.claim == BadgeClaim::Sole);
        let mut badges: Vec<_> = sole.map(|kept| kept.badge).collect();
        badges.sort_unstable();
        let count = badges.len();
        badges.dedup();
        assert_eq!(badges.len(), count, "a badge names two");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(crate::PLAYS))]

    #[test]
    fn nothing_is_lost_and_nothing_is_there_twice(
        steps in proptest::collection::vec(any_step(), 1..80)
    ) {
        let mut play = Play::new();
        for step in steps {
            play.run(step);
            play.check();
        }
    }
}

/// After all that may have happened, what was never deleted can still be brought in and found.
#[test]
fn a_headset_that_asks_often_enough_gets_its_receipt() {
    let mut play = Play::new();
    for k in 0..SCULPTURES {
        for _ in 0..4 {
            play.run(Step::Piece(k));
            play.run(Step::Restart(k));
            play.run(Step::Piece(k));
        }
        play.run(Step::Finish(k));
        play.check();
    }
    assert_eq!(play.signed.len(), usize::from(SCULPTURES));
}
