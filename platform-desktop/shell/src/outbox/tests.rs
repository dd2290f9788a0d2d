//! The driver over a real folder, and a booth that answers as it is told.

mod starts;

use std::collections::VecDeque;
use std::fs;
use std::path::PathBuf;

use paros_core::badge::LeaseReport;
use paros_core::outbox::messages::{
    AgeGroup, FinishCause, HeatLevel, Receipt, ReceiptOutcome, SculptureId, SiteId, UploadFacts,
};
use paros_core::outbox::{EntryState, HeadsetStatus, OutboxOwner, OutboxSettings};
use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;

use super::{
    BoothLink, BoothRequest, DiskFolder, HttpAnswer, LinkAnswer, LinkFault, OutboxDriver,
    OutboxError, OutboxEvent, OutboxHost, Parcel, ParcelFault, SentRequest,
};

const OWNER: OutboxOwner = OutboxOwner { site: SiteId([7; 16]), headset: 17 };
const SETTINGS: OutboxSettings = OutboxSettings { grace_seconds: 60, max_bytes: 1 << 20 };

#[derive(Default)]
struct Link {
    sent: Vec<BoothRequest>,
    answers: VecDeque<LinkAnswer>,
}

impl BoothLink for Link {
    fn send(&mut self, request: BoothRequest) {
        self.sent.push(request);
    }

    fn poll(&mut self) -> Option<LinkAnswer> {
        self.answers.pop_front()
    }
}

#[derive(Default)]
struct Host {
    now_ms: u64,
    events: Vec<OutboxEvent>,
}

impl OutboxHost for Host {
    fn now_ms(&mut self) -> u64 {
        self.now_ms
    }

    fn random(&mut self) -> u32 {
        0
    }

    fn status(&mut self) -> HeadsetStatus {
        HeadsetStatus {
            session_id: 5,
            is_charging: false,
            is_worn: true,
            is_glowing: false,
            battery_percent: None,
            heat: HeatLevel::Normal,
            phase: VisitPhase::Sculpting,
            worn_seconds: 1,
            app_version: [0, 1, 0],
        }
    }

    fn lease_report(&mut self) -> Option<LeaseReport> {
        None
    }

    fn on_event(&mut self, event: OutboxEvent) {
        self.events.push(event);
    }
}

/// A folder of a test's own, which goes with it.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("paros-outbox-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        Folder(path)
    }

    fn open(&self) -> OutboxDriver<DiskFolder, Link> {
        self.open_as(OWNER)
    }

    fn open_as(&self, owner: OutboxOwner) -> OutboxDriver<DiskFolder, Link> {
        let folder = DiskFolder::open(&self.0).expect("a folder that nobody has open");
        OutboxDriver::open(folder, Link::default(), owner, SETTINGS, 1).expect("a folder")
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).expect("a folder");
        let name = |entry: fs::DirEntry| entry.file_name().into_string().expect("text");
        let mut names: Vec<_> = entries.map(|entry| name(entry.expect("a file"))).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn parcel(number: u8) -> Parcel {
    let facts = UploadFacts {
        id: SculptureId([number; 16]),
        headset: OWNER.headset,
        badge: None,
        core_version: 1,
        side: 128,
        cause: FinishCause::Finished,
        language: *b"en",
        mode: SessionMode::FreeForm,
        age_group: AgeGroup::Unknown,
        sculpting_seconds: 1,
        finished_at: 1,
        height_mm_tenths: 1200,
        volume_bytes: 0,
        volume_raw_bytes: 0,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    };
    Parcel::pack(&facts, &[number; 5000], Some(&[1, 2, 3])).expect("a parcel")
}

fn receipt_of(parcel: &Parcel) -> Vec<u8> {
    let OutboxOwner { site, headset } = OWNER;
    let (id, badge, outcome) = (parcel.facts().id, parcel.facts().badge, ReceiptOutcome::Kept);
    Receipt { site, headset, id, hash: parcel.hash(), badge, outcome }.to_bytes().to_vec()
}

/// Steps until a part is sent, and answers it so.
fn answer(
    driver: &mut OutboxDriver<DiskFolder, Link>,
    host: &mut Host,
    status: u16,
    body: Vec<u8>,
) -> BoothRequest {
    for _ in 0..200 {
        host.now_ms += 1000;
        driver.step(host);
        let link = driver.link();
        let is_put = |request: &BoothRequest| matches!(request, BoothRequest::Put { .. });
        let put = link.sent.drain(..).find(is_put);
        if let Some(BoothRequest::Put { number, .. }) = put {
            let result = Ok(HttpAnswer { status, retry_after: None, body });
            let request = SentRequest::Put { number };
            link.answers.push_back(LinkAnswer { request, result });
            driver.step(host);
            return put.expect("it was found");
        }
    }
    panic!("nothing is sent");
}

fn state(driver: &OutboxDriver<DiskFolder, Link>, parcel: &Parcel) -> Option<EntryState> {
    driver.outbox().find(parcel.facts().id).map(|entry| entry.state)
}

#[test]
fn a_parcel_outlives_starts_until_its_receipt_and_grace_are_over() {
    let (folder, parcel) = (Folder::new("life"), parcel(1));
    let name = "01010101010101010101010101010101.parcel";
    let mut driver = folder.open();
    driver.announce(parcel.facts().id, None).expect("room");
    drop(driver);
    let mut driver = folder.open();
    assert_eq!(state(&driver, &parcel), Some(EntryState::Announced));
    driver.keep(&parcel).expect("room");
    driver.keep(&parcel).expect("it is kept");
    drop(driver);
    let mut driver = folder.open();
    let mut host = Host::default();
    let sent = answer(&mut driver, &mut host, 200, receipt_of(&parcel));
    let BoothRequest::Put { part, offset: 0, hash, .. } = sent else { panic!("{sent:?}") };
    assert_eq!((&part[..], hash), (parcel.bytes(), parcel.hash()));
    assert!(host.events.contains(&OutboxEvent::KeptAtBooth(parcel.facts().id)));
    driver.step(&mut host);
    drop(driver);
    let mut driver = folder.open();
    assert_eq!(state(&driver, &parcel), Some(EntryState::Receipted { seconds: 0 }));
    assert_eq!(folder.names(), [name, "outbox.journal"]);
    host.now_ms = 0;
    driver.step(&mut host);
    host.now_ms = 61_000;
    (0..3).for_each(|_| driver.step(&mut host));
    assert_eq!(
        (state(&driver, &parcel), &folder.names()[..]),
        (None, &["outbox.journal".into()][..])
    );
}

/// Keeps parcels, and has the booth sign for each.
fn sign_all(
    folder: &Folder,
    host: &mut Host,
    parcels: &[Parcel],
) -> OutboxDriver<DiskFolder, Link> {
    let mut driver = folder.open();
    for parcel in parcels {
        driver.keep(parcel).expect("room");
        answer(&mut driver, host, 200, receipt_of(parcel));
    }
    driver
}

#[test]
fn a_parcel_that_cant_be_removed_holds_up_no_other() {
    let (folder, parcels) = (Folder::new("stuck"), [parcel(1), parcel(2), parcel(3)]);
    let mut host = Host::default();
    let mut driver = sign_all(&folder, &mut host, &parcels);
    let stuck = [1, 2].map(|number| format!("{}.parcel", SculptureId([number; 16])));
    for name in &stuck {
        // No file's removal takes a folder away.
        fs::remove_file(folder.0.join(name)).expect("it is kept");
        fs::create_dir(folder.0.join(name)).expect("room on the disk");
    }
    host.now_ms += 200_000;
    (0..6).for_each(|_| driver.step(&mut host));
    let states = parcels.each_ref().map(|parcel| state(&driver, parcel));
    assert_eq!(states, [Some(EntryState::Deletable), Some(EntryState::Deletable), None]);
    fs::remove_dir(folder.0.join(&stuck[1])).expect("it is empty");
    (0..4).for_each(|_| driver.step(&mut host));
    assert_eq!(state(&driver, &parcels[1]), None);
    assert_eq!(folder.names(), [&stuck[0], "outbox.journal"]);
}

/// What was signed for before the disk was full is what makes room on it.
#[test]
fn where_no_journal_can_be_written_what_it_calls_signed_for_goes_all_the_same() {
    let (folder, parcels) = (Folder::new("full"), [parcel(1), parcel(2)]);
    let mut host = Host::default();
    let mut driver = sign_all(&folder, &mut host, &parcels[..1]);
    driver.step(&mut host);
    // No file takes the place of a folder.
    let journal = folder.0.join("outbox.journal");
    fs::remove_file(&journal).expect("it was written");
    fs::create_dir(&journal).expect("room on the disk");
    driver.keep(&parcels[1]).expect("room");
    answer(&mut driver, &mut host, 200, receipt_of(&parcels[1]));
    host.now_ms += 200_000;
    (0..3).for_each(|_| driver.step(&mut host));
    assert!(host.events.iter().any(|event| matches!(event, OutboxEvent::JournalUnwritten(_))));
    let states = parcels.each_ref().map(|parcel| state(&driver, parcel));
    assert_eq!(states, [None, Some(EntryState::Deletable)], "the second one's receipt isn't saved");
    fs::remove_dir(&journal).expect("it is empty");
    host.now_ms += 2000;
    (0..3).for_each(|_| driver.step(&mut host));
    assert_eq!((state(&driver, &parcels[1]), folder.names().len()), (None, 1));
}

#[test]
fn nothing_but_its_own_receipt_is_one() {
    let (folder, parcel) = (Folder::new("receipts"), parcel(1));
    let mut driver = folder.open();
    let mut host = Host::default();
    driver.keep(&parcel).expect("room");
    let mut of_another_site = receipt_of(&parcel);
    of_another_site[1] ^= 1;
    let torn = receipt_of(&parcel)[1..].to_vec();
    let of_another = receipt_of(&self::parcel(2));
    let portal = b"<html>Please log in</html>".to_vec();
    for body in [torn, of_another_site, of_another, portal, Vec::new()] {
        answer(&mut driver, &mut host, 200, body);
        assert_eq!(state(&driver, &parcel), Some(EntryState::Sending { held: 0 }));
    }
    for status in [202, 204, 301, 404, 500] {
        answer(&mut driver, &mut host, status, b"what".to_vec());
        assert_eq!(state(&driver, &parcel), Some(EntryState::Sending { held: 0 }), "{status}");
    }
    answer(&mut driver, &mut host, 202, 70u64.to_le_bytes().to_vec());
    assert_eq!(state(&driver, &parcel), Some(EntryState::Sending { held: 70 }));
    for (status, event) in [(401, OutboxEvent::UnknownToken), (403, OutboxEvent::ShutOut)] {
        answer(&mut driver, &mut host, status, Vec::new());
        assert!(host.events.contains(&event), "{status}");
    }
    answer(&mut driver, &mut host, 422, b"no sculpture".to_vec());
    assert_eq!(state(&driver, &parcel), Some(EntryState::Refused));
    let refused = OutboxEvent::RefusedByBooth(parcel.facts().id);
    assert_eq!(host.events.iter().filter(|event| **event == refused).count(), 1);
    assert_eq!(folder.names().len(), 2, "it is kept here");
}

#[test]
fn what_has_no_room_is_refused_and_nothing_is_written() {
    let folder = Folder::new("room");
    let mut driver = folder.open();
    let mut noise = vec![0; 2 << 20];
    let mut bits = 1u32;
    noise.fill_with(|| {
        bits ^= bits << 13;
        bits ^= bits >> 17;
        bits ^= bits << 5;
        bits as u8
    });
    let large = Parcel::pack(parcel(1).facts(), &noise, None).expect("a parcel of its size");
    assert!(matches!(driver.keep(&large), Err(OutboxError::Refused(_))));
    assert_eq!(folder.names(), ["outbox.journal"]);
    noise.push(0);
    let fault = Parcel::pack(parcel(1).facts(), &noise, None);
    assert!(matches!(fault, Err(ParcelFault::Head(_))), "no volume is so large: {fault:?}");
    assert!(matches!(Parcel::pack(parcel(1).facts(), &[], None), Err(ParcelFault::Head(_))));
}

#[test]
fn an_unheard_heartbeat_is_followed_by_others() {
    let folder = Folder::new("heartbeats");
    let mut driver = folder.open();
    let mut host = Host::default();
    let mut numbers = Vec::new();
    for _ in 0..30 {
        host.now_ms += 1000;
        driver.step(&mut host);
        let link = driver.link();
        for request in std::mem::take(&mut link.sent) {
            if let BoothRequest::Heartbeat { number, .. } = request {
                numbers.push(number);
                let request = SentRequest::Heartbeat { number };
                let result = Err(LinkFault::Unreachable);
                link.answers.push_back(LinkAnswer { request, result });
            }
        }
    }
    assert!(numbers.len() >= 4 && numbers.is_sorted(), "{numbers:?}");
}
