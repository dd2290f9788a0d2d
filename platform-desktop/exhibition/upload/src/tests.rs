//! The sender on a real folder, with a booth whose answers are scripted.

mod heartbeats;
mod starts;

use std::collections::VecDeque;
use std::fs;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use paros_core::session::SessionMode;
use paros_protocol::{
    AgeGroup, Announcement, FinishCause, HeadsetStatus, Heartbeat, HeartbeatAnswer, Parcel,
    ParcelOutcome, ProtocolError, SculptureId, SiteId, UploadFacts, UploadStatus,
};

use super::{
    BoothContact, BoothLink, BoothRequest, DiskFolder, HttpAnswer, LinkAnswer, LinkFault,
    MAX_SPOOL_ENTRIES, OutboxEvent, OutboxHost, OutboxOwner, OutboxSettings, RequestKind, Sender,
    SpoolError,
};

const KEPT: &[u8] = ParcelOutcome::Kept.body();
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
        HeadsetStatus { session_id: 5, ..HeadsetStatus::default() }
    }

    fn on_event(&mut self, event: OutboxEvent) {
        self.events.push(event);
    }
}

/// A temporary folder of a test, removed on drop.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("paros-outbox-{test}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        Folder(path)
    }

    fn open(&self) -> Sender<DiskFolder, Link> {
        self.open_with(SETTINGS)
    }

    fn open_with(&self, settings: OutboxSettings) -> Sender<DiskFolder, Link> {
        let folder = DiskFolder::open(&self.0).expect("a folder that nobody has open");
        Sender::open(folder, Link::default(), OWNER, settings, 1).expect("a folder")
    }

    /// Changes a byte of a file.
    fn spoil(&self, name: &str) {
        let path = self.0.join(name);
        let mut bytes = fs::read(&path).expect("a file");
        bytes[70] ^= 1;
        fs::write(&path, &bytes).expect("room on the disk");
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

/// The facts of a sculpture without a badge.
pub(crate) fn facts_of(id: SculptureId) -> UploadFacts {
    UploadFacts {
        id,
        badge: None,
        badge_serial: None,
        core_version: 1,
        side: 128,
        cause: FinishCause::Finished,
        language: *b"en",
        mode: SessionMode::FreeForm,
        age_group: AgeGroup::Unknown,
        sculpting_seconds: 60,
        finished_at: 1,
        height_mm_tenths: 1200,
        volume_bytes: 0,
        volume_raw_bytes: 0,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    }
}

fn parcel(number: u8) -> Parcel {
    let finished_at = number.into();
    let facts = UploadFacts { sculpting_seconds: 1, finished_at, ..facts_of(id_of(number)) };
    Parcel::pack(&facts, &[number; 5000], Some(&[1, 2, 3])).expect("a parcel")
}

fn id_of(number: u8) -> SculptureId {
    SculptureId([number; 16])
}

/// Returns the file name of a sculpture.
fn name_of(number: u8, end: &str) -> String {
    format!("{}.{end}", id_of(number))
}

/// Steps until a parcel is sent, answers it, and returns its id.
fn answer(
    sender: &mut Sender<DiskFolder, Link>,
    host: &mut Host,
    status: u16,
    body: &[u8],
) -> SculptureId {
    for _ in 0..200 {
        host.now_ms += 1000;
        sender.step(host);
        let link = sender.link();
        let is_put = |request: &BoothRequest| matches!(request.kind, RequestKind::Put(_));
        let put = link.sent.drain(..).find(is_put);
        if let Some(BoothRequest { kind: kind @ RequestKind::Put(id), number, body: file }) = put {
            assert_eq!(file, parcel(id.0[0]).into_file(), "the file as it is");
            let result = Ok(HttpAnswer { status, retry_after: None, body: body.into() });
            link.answers.push_back(LinkAnswer { kind, number, result });
            sender.step(host);
            return id;
        }
    }
    panic!("nothing is sent");
}

fn status(sender: &Sender<DiskFolder, Link>, number: u8) -> Option<UploadStatus> {
    sender.spool().find(id_of(number)).map(|entry| entry.status)
}

/// Opens an outbox with these parcels, all of which the booth has.
fn send_all(folder: &Folder, host: &mut Host, numbers: &[u8]) -> Sender<DiskFolder, Link> {
    let mut sender = folder.open();
    for number in numbers {
        sender.keep(&parcel(*number)).expect("room");
        answer(&mut sender, host, 200, KEPT);
    }
    sender
}

#[test]
fn a_parcel_outlives_starts_until_its_grace_is_over() {
    let folder = Folder::new("life");
    let mut sender = folder.open();
    sender.announce(id_of(1), None).expect("room");
    assert_eq!(status(&sender, 1), Some(UploadStatus::Making));
    assert!(matches!(sender.announce(id_of(1), None), Err(SpoolError::KnownId)));
    sender.keep(&parcel(1)).expect("room");
    sender.keep(&parcel(1)).expect("it is kept");
    drop(sender);
    let mut sender = folder.open();
    let mut host = Host::default();
    assert_eq!(status(&sender, 1), Some(UploadStatus::Kept));
    answer(&mut sender, &mut host, 200, KEPT);
    assert!(host.events.contains(&OutboxEvent::KeptAtBooth(id_of(1))));
    drop(sender);
    let mut sender = folder.open();
    assert_eq!(status(&sender, 1), Some(UploadStatus::Sent));
    assert_eq!(folder.names(), [name_of(1, "sent")]);
    sender.step(&mut host);
    host.now_ms += 100_000;
    sender.step(&mut host);
    assert_eq!(status(&sender, 1), Some(UploadStatus::Sent), "the booth is asked before");
    heartbeats::confirm(&mut sender, &mut host);
    host.now_ms += 1_000;
    sender.step(&mut host);
    assert_eq!((status(&sender, 1), folder.names().len()), (None, 0));
}

/// The grace period also runs while the program doesn't.
#[test]
fn a_parcel_that_was_sent_long_ago_is_deleted_once_the_booth_has_it_still() {
    let folder = Folder::new("age");
    let mut host = Host::default();
    drop(send_all(&folder, &mut host, &[1, 2]));
    let path = folder.0.join(name_of(1, "sent"));
    let file = fs::File::options().write(true).open(path).expect("a file");
    file.set_modified(SystemTime::now() - Duration::from_secs(100)).expect("a time");
    let mut sender = folder.open();
    heartbeats::confirm(&mut sender, &mut host);
    host.now_ms += 1_000;
    sender.step(&mut host);
    assert_eq!([1, 2].map(|number| status(&sender, number)), [None, Some(UploadStatus::Sent)]);
}

#[test]
fn a_parcel_that_cant_be_removed_holds_up_no_other() {
    let folder = Folder::new("stuck");
    let mut host = Host::default();
    let mut sender = send_all(&folder, &mut host, &[1, 2]);
    let stuck = folder.0.join(name_of(1, "sent"));
    // Removing a file doesn't remove a folder.
    fs::remove_file(&stuck).expect("it is kept");
    fs::create_dir(&stuck).expect("room on the disk");
    host.now_ms += 200_000;
    sender.step(&mut host);
    assert_eq!([1, 2].map(|number| status(&sender, number)), [Some(UploadStatus::Sent), None]);
    fs::remove_dir(&stuck).expect("it is empty");
    heartbeats::confirm(&mut sender, &mut host);
    host.now_ms += 2_000;
    sender.step(&mut host);
    assert_eq!(status(&sender, 1), None);
}

#[test]
fn each_answer_has_its_file() {
    let folder = Folder::new("answers");
    let mut sender = folder.open();
    let mut host = Host::default();
    sender.keep(&parcel(1)).expect("room");
    // A captive portal's page, and answers that no booth gives.
    for (code, body) in [(200, &b"<html>Please log in</html>"[..]), (200, b""), (204, KEPT)] {
        answer(&mut sender, &mut host, code, body);
    }
    for code in [202, 301, 400, 404, 408, 500, 503] {
        answer(&mut sender, &mut host, code, KEPT);
        assert_eq!(status(&sender, 1), Some(UploadStatus::Kept), "{code}");
    }
    for (code, contact) in [(401, BoothContact::Forgotten), (403, BoothContact::ShutOut)] {
        answer(&mut sender, &mut host, code, b"");
        assert_eq!(sender.contact(), contact);
    }
    let refused = OutboxEvent::RefusedByBooth(id_of(1));
    for (times, code) in [409, 413, 422].into_iter().enumerate() {
        answer(&mut sender, &mut host, code, b"no sculpture");
        assert_eq!(status(&sender, 1), Some(UploadStatus::Refused));
        assert_eq!(folder.names(), [name_of(1, "refused")]);
        assert_eq!(host.events.iter().filter(|event| **event == refused).count(), times + 1);
        // A refused parcel is retried after six hours at most, and in each start.
        sender.link().sent.clear();
        host.now_ms += 3 * 3600 * 1000 - 100;
        sender.step(&mut host);
        let is_put = |request: &BoothRequest| matches!(request.kind, RequestKind::Put(_));
        assert!(!sender.link().sent.iter().any(is_put), "too early");
        if times == 0 {
            drop(sender);
            sender = folder.open();
        } else {
            host.now_ms += 3 * 3600 * 1000;
        }
    }
    for body in [&b""[..], KEPT] {
        answer(&mut sender, &mut host, 410, body);
        assert_eq!(status(&sender, 1), Some(UploadStatus::Refused), "a proxy's");
    }
    answer(&mut sender, &mut host, 410, ParcelOutcome::Deleted.body());
    assert!(host.events.contains(&OutboxEvent::DeletedAtBooth(id_of(1))));
    assert_eq!((status(&sender, 1), folder.names().len()), (None, 0));
}

/// If the disk can't rename the file, the outcome isn't stored, and the parcel is sent again.
#[test]
fn an_answer_that_cant_be_noted_comes_again() {
    let folder = Folder::new("unnoted");
    let mut sender = folder.open();
    let mut host = Host::default();
    sender.keep(&parcel(1)).expect("room");
    // A file can't replace a folder.
    let place = folder.0.join(name_of(1, "sent"));
    fs::create_dir(&place).expect("room on the disk");
    answer(&mut sender, &mut host, 200, KEPT);
    assert_eq!((status(&sender, 1), host.events.len()), (Some(UploadStatus::Kept), 0));
    fs::remove_dir(&place).expect("it is empty");
    answer(&mut sender, &mut host, 200, KEPT);
    assert_eq!(status(&sender, 1), Some(UploadStatus::Sent));
}

#[test]
fn the_newest_goes_first_and_one_that_fails_last() {
    let folder = Folder::new("order");
    let mut sender = folder.open();
    let mut host = Host::default();
    for number in [2, 3, 1] {
        sender.keep(&parcel(number)).expect("room");
    }
    drop(sender);
    // Parcels are ordered by the times at which their sculptures were finished.
    let mut sender = folder.open();
    assert_eq!(answer(&mut sender, &mut host, 500, b""), id_of(3));
    assert_eq!(answer(&mut sender, &mut host, 200, KEPT), id_of(2));
    assert_eq!(answer(&mut sender, &mut host, 200, KEPT), id_of(1));
    assert_eq!(answer(&mut sender, &mut host, 200, KEPT), id_of(3));
}

#[test]
fn failures_are_followed_by_longer_and_longer_waits_up_to_a_minute() {
    let folder = Folder::new("backoff");
    let mut sender = folder.open();
    let mut host = Host::default();
    sender.keep(&parcel(1)).expect("room");
    let mut waits = Vec::new();
    for _ in 0..9 {
        let begun = host.now_ms;
        answer(&mut sender, &mut host, 500, b"");
        waits.push((host.now_ms - begun) / 1000);
    }
    // Without random bits a wait is half of the full wait.
    assert_eq!(waits, [1, 1, 2, 4, 8, 16, 30, 30, 30]);
    // A booth that sends `Retry-After` is asked then, and this counts as no failure.
    host.now_ms += 30_000;
    sender.step(&mut host);
    let is_put = |request: &BoothRequest| matches!(request.kind, RequestKind::Put(_));
    let put = sender.link().sent.drain(..).find(is_put).expect("it is time");
    let result = Ok(HttpAnswer { status: 503, retry_after: Some(10), body: Vec::new() });
    sender.link().answers.push_back(LinkAnswer { kind: put.kind, number: put.number, result });
    sender.step(&mut host);
    let begun = host.now_ms;
    answer(&mut sender, &mut host, 200, KEPT);
    assert_eq!((host.now_ms - begun) / 1000, 11);
}

/// Sent parcels are deleted to make room, the oldest first; unsent ones never are.
#[test]
fn a_new_parcel_takes_the_place_of_the_oldest_sent_one() {
    let folder = Folder::new("room");
    let length = parcel(1).file_bytes().len() as u64;
    let settings = OutboxSettings { max_bytes: 3 * length, ..SETTINGS };
    let mut host = Host::default();
    drop(send_all(&folder, &mut host, &[1, 2]));
    let mut sender = folder.open_with(settings);
    assert_eq!(sender.spool().full_percent(), 0);
    sender.keep(&parcel(3)).expect("room");
    assert_eq!((sender.spool().is_nearly_full(), sender.spool().full_percent()), (false, 33));
    sender.keep(&parcel(4)).expect("the oldest goes");
    assert_eq!([1, 2].map(|number| status(&sender, number)), [None, Some(UploadStatus::Sent)]);
    sender.keep(&parcel(5)).expect("the next goes");
    assert_eq!((sender.spool().is_nearly_full(), sender.spool().depth()), (true, 3));
    assert!(matches!(sender.keep(&parcel(6)), Err(SpoolError::Full)));
    assert_eq!(folder.names(), [3, 4, 5].map(|number| name_of(number, "parcel")));
}

#[test]
fn so_many_are_announced_and_no_more() {
    let folder = Folder::new("table");
    let mut host = Host::default();
    let mut sender = send_all(&folder, &mut host, &[1]);
    let id = |number: usize| {
        let mut id = [7; 16];
        id[..8].copy_from_slice(&number.to_le_bytes());
        SculptureId(id)
    };
    (0..MAX_SPOOL_ENTRIES).for_each(|number| sender.announce(id(number), None).expect("room"));
    assert_eq!(status(&sender, 1), None, "it made room");
    assert_eq!(sender.spool().full_percent(), 100);
    assert!(matches!(sender.announce(id(999), None), Err(SpoolError::Full)));
    sender.abandon(id(3)).expect("it was announced");
    assert!(matches!(sender.abandon(id(3)), Err(SpoolError::UnknownId)));
}

#[test]
fn no_parcel_is_larger_than_a_booth_takes() {
    let mut noise = vec![0; 2 << 20];
    let mut bits = 1u32;
    noise.fill_with(|| {
        bits ^= bits << 13;
        bits ^= bits >> 17;
        bits ^= bits << 5;
        bits as u8
    });
    let folder = Folder::new("large");
    let large = Parcel::pack(parcel(1).facts(), &noise, None).expect("a parcel of its size");
    assert!(matches!(folder.open().keep(&large), Err(SpoolError::Full)), "the outbox has 1 MiB");
    noise.push(0);
    let is_refused =
        |packed| matches!(packed, Err(ProtocolError::Value { field: "volume_bytes", .. }));
    assert!(is_refused(Parcel::pack(parcel(1).facts(), &noise, None)), "no volume is so large");
    assert!(is_refused(Parcel::pack(parcel(1).facts(), &[], None)));
}
