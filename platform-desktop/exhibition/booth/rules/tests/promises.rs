//! The booth's guarantees, whatever is lost, duplicated, late or deleted, with several headsets.

use std::collections::BTreeMap;

use super::common::*;
use paros_booth_rules::records::{Device, Sculpture, Tombstone};
use paros_booth_rules::{BoothTime, KeptPart, view};
use proptest::prelude::*;

/// The next event of one of the sculptures.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// The headset announces it.
    Announce(u8),
    /// The headset sends it.
    Send(u8),
    /// The booth dies while it stores it: the files are stored, but not the record.
    DieWhileKeeping(u8),
    /// The device sends it as another headset, after it enrolled again.
    SendAsOther(u8),
    /// Another headset sends another parcel under its id.
    Steal(u8),
    Withdraw(u8),
    BringBack(u8),
    Delete(u8),
    /// This many days pass, followed by a sweep.
    Sweep(u8),
}

fn any_step() -> impl Strategy<Value = Step> {
    let sculpture = || 0..SCULPTURES;
    prop_oneof![
        3 => sculpture().prop_map(Step::Announce),
        6 => sculpture().prop_map(Step::Send),
        2 => sculpture().prop_map(Step::DieWhileKeeping),
        1 => sculpture().prop_map(Step::SendAsOther),
        1 => sculpture().prop_map(Step::Steal),
        1 => sculpture().prop_map(Step::Withdraw),
        1 => sculpture().prop_map(Step::BringBack),
        1 => sculpture().prop_map(Step::Delete),
        1 => (0..9u8).prop_map(Step::Sweep),
    ]
}

const SCULPTURES: u8 = 6;

/// A play with two headsets and three sculptures each. Two sculptures have the same leased badge.
struct Play {
    rig: Rig,
    devices: [Device; 2],
    parcels: Vec<Parcel>,
    announced: Vec<u8>,
    /// The last outcome that the headset received for each sculpture.
    taken: BTreeMap<u8, ParcelOutcome>,
    now: BoothTime,
}

impl Play {
    fn new() -> Self {
        let rig = Rig::new();
        let devices = [rig.enrol(1), rig.enrol(2)];
        // The second headset claims what was leased to the first.
        let held = rig.lease(&devices[0], 1, START)[0];
        let parcel = |k| Parcel::of_block(k + 1, &held, k / 3 * 7);
        let parcels = (0..SCULPTURES).map(parcel).collect();
        let (announced, taken) = (Vec::new(), BTreeMap::new());
        Play { rig, devices, parcels, announced, taken, now: START }
    }

    fn run(&mut self, step: Step) {
        self.now = BoothTime(self.now.0 + 1000);
        let booth = &self.rig.booth;
        match step {
            Step::Announce(k) => {
                let device = &self.devices[usize::from(k % 2)];
                let announced = self.parcels[usize::from(k)].announcement(UploadStatus::Kept);
                let beat = announcing(&heartbeat(device.headset), &[announced]);
                assert_eq!(self.rig.beat(device, &beat, self.now).noted.len(), 1);
                self.announced.push(k);
            }
            Step::Send(k) => self.send(k, usize::from(k % 2)),
            Step::SendAsOther(k) => self.send(k, usize::from(1 - k % 2)),
            Step::DieWhileKeeping(k) => {
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
                // The thief doesn't know an id that wasn't sent yet.
                if self.taken.contains_key(&k) {
                    let thief = &self.devices[usize::from(1 - k % 2)];
                    let facts = self.parcels[usize::from(k)].facts;
                    let other = Parcel::of_facts(UploadFacts { finished_at: 77, ..facts });
                    self.rig.upload(thief, &other, self.now).unwrap_err();
                }
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
                self.rig.sweep(self.now);
            }
        }
    }

    /// Sends a sculpture. Checks that a deleted sculpture stays deleted.
    fn send(&mut self, k: u8, device: usize) {
        let (parcel, device) = (&self.parcels[usize::from(k)], &self.devices[device]);
        let outcome = self.rig.upload(device, parcel, self.now).expect("a sculpture");
        let before = self.taken.insert(k, outcome);
        assert!(before != Some(ParcelOutcome::Deleted) || outcome == ParcelOutcome::Deleted);
    }

    fn count<R: paros_booth_rules::Record>(&self, k: u8) -> u64 {
        let id = self.parcels[usize::from(k)].id.0;
        view(self.rig.store.as_ref(), |tx| tx.count::<R>("WHERE id = ?1", &[&id])).unwrap()
    }

    fn check(&self) {
        let kept: Vec<Sculpture> =
            view(self.rig.store.as_ref(), |tx| tx.find("ORDER BY id", &[])).unwrap();
        for sculpture in &kept {
            assert_eq!(
                self.rig.booth.read_kept(sculpture).expect("a record's file is there"),
                self.parcels[usize::from(sculpture.id[0] - 1)].bytes
            );
        }
        for (&k, taken) in &self.taken {
            assert!(self.count::<Sculpture>(k) + self.count::<Tombstone>(k) == 1, "{taken:?}");
        }
        let missing = self.rig.booth.list_missing(99).unwrap();
        for &k in &self.announced {
            let id = self.parcels[usize::from(k)].id.0;
            let listed = missing.iter().filter(|missing| missing.announcement.sculpture == id);
            let places =
                listed.count() as u64 + self.count::<Sculpture>(k) + self.count::<Tombstone>(k);
            assert_eq!(places, 1, "sculpture {k} is nowhere, or twice");
        }
        let mut badges: Vec<_> = kept.iter().filter_map(|kept| kept.claimed_badge).collect();
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
