//! A booth in memory, and headsets that talk to it.
#![allow(dead_code)] // each test uses its part of it

mod memory_files;

use std::sync::Arc;
use std::time::Duration;

use paros_booth_rules::records::{Device, Sculpture};
use paros_booth_rules::{
    Booth, BoothPlan, BoothTime, ListFilter, PageStart, Refusal, SiteKeys, Store, SweepReport,
};
use paros_booth_sqlite::SqliteStore;
pub(crate) use paros_core::badge::BadgeNumber;
pub(crate) use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
pub(crate) use paros_protocol::*;

pub(crate) use self::memory_files::MemoryFiles;

pub(crate) const SITE: SiteId = SiteId([5; 16]);
pub(crate) const FLEET: EnrolmentToken = EnrolmentToken([77; 32]);

/// Ten in the morning of a day.
pub(crate) const START: BoothTime = BoothTime(20_000 * 86_400_000 + 36_000_000);

pub(crate) fn seconds(count: u64) -> BoothTime {
    BoothTime(START.0 + 1000 * count)
}

pub(crate) fn days(count: u64) -> BoothTime {
    seconds(86_400 * count)
}

/// Copies a store into memory.
pub(crate) fn copy_of(store: &dyn Store) -> SqliteStore {
    SqliteStore::copy_in_memory(store).expect("memory")
}

pub(crate) struct Rig {
    pub(crate) booth: Booth,
    pub(crate) store: Arc<dyn Store>,
    pub(crate) files: Arc<MemoryFiles>,
}

impl Rig {
    /// Makes a booth without headsets, and with a token for 250 of them.
    pub(crate) fn new() -> Self {
        Rig::with_plan(BoothPlan { retention_days: 30, ..BoothPlan::default() })
    }

    pub(crate) fn with_plan(plan: BoothPlan) -> Self {
        let (store, files) = (crate::new_store(), Arc::new(MemoryFiles::new()));
        let keys = SiteKeys::new(SITE, ContentHash([6; 32]), [8; 32]);
        let booth = Booth::new(store.clone(), files.clone(), keys, plan);
        booth.add_enrol_token(&FLEET, (250, days(1000)), "all", None, START).expect("room");
        Rig { booth, store, files }
    }

    /// Sweeps at any time: no gap counts as a clock jump.
    pub(crate) fn sweep(&self, now: BoothTime) -> SweepReport {
        self.booth.sweep(now, Duration::MAX).unwrap()
    }

    /// Enrols a headset whose token consists of this byte.
    pub(crate) fn enrol(&self, byte: u8) -> Device {
        self.booth.enrol_fleet(&fleet_enrolment(byte), START).expect("a valid token");
        self.booth.authenticate(&DeviceToken([byte; 32])).expect("it was enrolled")
    }

    /// Sends a parcel.
    pub(crate) fn upload(
        &self,
        device: &Device,
        parcel: &Parcel,
        now: BoothTime,
    ) -> Result<ParcelOutcome, Refusal> {
        self.booth.take_parcel(device.headset, parcel.id, &parcel.file(), &decode, now)
    }

    /// Returns the first page of the sculptures that are withdrawn, or that aren't.
    pub(crate) fn list(&self, is_withdrawn: bool) -> Vec<Sculpture> {
        let filter = ListFilter { is_withdrawn, ..ListFilter::default() };
        self.booth.list_page(&filter, PageStart::Newest, 60).expect("a list").sculptures
    }

    /// Returns the blocks that a headset leases in an epoch in which it holds none.
    pub(crate) fn lease(&self, device: &Device, epoch: u64, now: BoothTime) -> Vec<HeldBlock> {
        self.report(device, &BadgeReport { epoch, blocks: Vec::new() }, now)
    }

    /// Sends a headset's report of blocks. Returns the blocks that it holds from then on.
    pub(crate) fn report(
        &self,
        device: &Device,
        badges: &BadgeReport,
        now: BoothTime,
    ) -> Vec<HeldBlock> {
        let beat = Heartbeat { badges: badges.clone(), ..heartbeat(device.headset) };
        self.beat(device, &beat, now).badges
    }

    pub(crate) fn beat(
        &self,
        device: &Device,
        beat: &Heartbeat,
        now: BoothTime,
    ) -> HeartbeatAnswer {
        self.booth.take_heartbeat(device, beat, now).expect("a heartbeat of its own")
    }
}

pub(crate) fn fleet_enrolment(byte: u8) -> FleetEnrolment {
    FleetEnrolment {
        enrolment_token: FLEET,
        token_hash: ContentHash::of(&[byte; 32]),
        hint: DeviceHint([byte; 16]),
        name: DeviceName::new("Quest").expect("a name"),
    }
}

/// Decodes only test parcels: their volume repeats the first byte of their id.
pub(crate) fn decode(facts: &UploadFacts, volume: &[u8], trace: &[u8]) -> Result<(), String> {
    let is_volume = volume.iter().all(|byte| *byte == facts.id.0[0]);
    let is_trace = trace.len() == facts.trace_bytes as usize;
    if is_volume && is_trace { Ok(()) } else { Err("other bytes".into()) }
}

pub(crate) struct Parcel {
    pub(crate) id: SculptureId,
    pub(crate) facts: UploadFacts,
    pub(crate) hash: ContentHash,
    pub(crate) bytes: Vec<u8>,
}

impl Parcel {
    /// Makes a parcel with a made-up serial, the same in all such parcels.
    pub(crate) fn new(id: u8, badge: Option<BadgeNumber>) -> Self {
        Parcel::with_serial(id, badge, BlockSerial([9; 8]))
    }

    /// Makes a parcel with the number at a place of a block.
    pub(crate) fn of_block(id: u8, held: &HeldBlock, place: u8) -> Self {
        Parcel::with_serial(id, BadgeNumber::of_block(held.block, place), held.serial)
    }

    pub(crate) fn with_serial(id: u8, badge: Option<BadgeNumber>, serial: BlockSerial) -> Self {
        let is_leased = badge.is_some_and(|badge| !badge.is_provisional());
        Parcel::of_facts(UploadFacts {
            id: SculptureId([id; 16]),
            badge,
            badge_serial: Some(serial).filter(|_| is_leased),
            core_version: 1,
            side: 128,
            cause: FinishCause::Finished,
            language: *b"el",
            mode: SessionMode::Creative,
            age_group: AgeGroup::Unknown,
            sculpting_seconds: 300,
            finished_at: 1,
            height_mm_tenths: 1200,
            volume_bytes: 5000,
            volume_raw_bytes: 5000,
            trace_bytes: 0,
            trace_raw_bytes: 0,
        })
    }

    pub(crate) fn with_trace(id: u8) -> Self {
        let facts = Parcel::new(id, None).facts;
        Parcel::of_facts(UploadFacts { trace_bytes: 700, trace_raw_bytes: 9000, ..facts })
    }

    pub(crate) fn of_facts(facts: UploadFacts) -> Self {
        let mut bytes = facts.to_head();
        bytes.extend(vec![facts.id.0[0]; facts.volume_bytes as usize]);
        bytes.extend(vec![9; facts.trace_bytes as usize]);
        Parcel { id: facts.id, facts, hash: ContentHash::of(&bytes), bytes }
    }

    /// Returns the parcel with its hash, as it is sent.
    pub(crate) fn file(&self) -> Vec<u8> {
        [&self.bytes[..], &self.hash.0].concat()
    }

    pub(crate) fn announcement(&self, status: UploadStatus) -> Announcement {
        Announcement { id: self.id, badge: self.facts.badge, status }
    }
}

pub(crate) fn heartbeat(headset: u32) -> Heartbeat {
    let status = HeadsetStatus {
        session_id: 21,
        is_worn: true,
        battery_percent: Some(80),
        phase: VisitPhase::Sculpting,
        worn_seconds: 60,
        ..HeadsetStatus::default()
    };
    let badges = BadgeReport { epoch: 1, blocks: Vec::new() };
    Heartbeat { status, ..Heartbeat::first(headset, 11, badges) }
}

pub(crate) fn announcing(beat: &Heartbeat, announcements: &[Announcement]) -> Heartbeat {
    Heartbeat { announcements: announcements.to_vec(), ..beat.clone() }
}

pub(crate) fn leased(number: u32) -> Option<BadgeNumber> {
    BadgeNumber::new(number).filter(|number| !number.is_provisional())
}

/// Returns the HTTP status of a refusal.
pub(crate) fn status<T: std::fmt::Debug>(done: Result<T, Refusal>) -> u16 {
    done.expect_err("a refusal").status()
}
