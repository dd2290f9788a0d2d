//! A fake booth behind a courier's link, for tests.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};
use std::sync::{Arc, LazyLock};
use std::thread;
use std::time::{Duration, Instant};

use paros_protocol::*;

use super::{Courier, CourierLink, CourierPlan};
use crate::enrolment::{Enrolment, NewDevice};
use crate::{
    BoothLink, BoothRequest, HttpAnswer, LinkAnswer, LinkFault, OutboxOwner, OutboxSettings,
    RequestKind,
};

pub(crate) const OWNER: OutboxOwner = OutboxOwner { site: SiteId([7; 16]), headset: 17 };

pub(crate) fn clock() -> u64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    START.elapsed().as_millis() as u64
}

/// A booth that accepts every request, unless it is down or has another status.
struct Booth {
    headset: u32,
    status: Arc<AtomicU16>,
    is_down: Arc<AtomicBool>,
    answers: VecDeque<LinkAnswer>,
    command: Option<BoothCommand>,
}

impl Booth {
    fn answer_heartbeat(&mut self, beat: &Heartbeat) -> Vec<u8> {
        let first = HeldBlock { block: 7, serial: BlockSerial([7; 8]), next: 0 };
        let badges = beat.badges.blocks.clone();
        let badges = if badges.is_empty() { vec![first] } else { badges };
        let command = self.command.filter(|_| beat.last_command.is_none());
        let answer = HeartbeatAnswer {
            site: OWNER.site,
            headset: self.headset,
            boot_id: beat.boot_id,
            number: beat.number,
            booth_time: 0,
            store_epoch: 0,
            badges,
            command: command.map(|command| BoothCommand { boot_id: beat.boot_id, ..command }),
            noted: beat.announcements.clone(),
        };
        answer.to_json()
    }
}

impl BoothLink for Booth {
    fn send(&mut self, request: BoothRequest) {
        let ok = |body| Ok(HttpAnswer { status: 200, retry_after: None, body });
        let is_down = self.is_down.load(Ordering::Relaxed);
        let BoothRequest { kind, number, body } = request;
        let result = match kind {
            RequestKind::Put(_) => ok(ParcelOutcome::Kept.body().into()),
            RequestKind::Heartbeat => {
                let beat = Heartbeat::from_json(&body[..]).expect("a heartbeat");
                ok(self.answer_heartbeat(&beat))
            }
        };
        let result = match (is_down, self.status.load(Ordering::Relaxed)) {
            (true, _) => Err(LinkFault::Unreachable),
            (false, 200) => result,
            (false, status) => Ok(HttpAnswer { status, retry_after: None, body: Vec::new() }),
        };
        self.answers.push_back(LinkAnswer { kind, number, result });
    }

    fn poll(&mut self) -> Option<LinkAnswer> {
        self.answers.pop_front()
    }
}

/// A courier's folder, and the state of its booth.
pub(crate) struct Rig {
    pub(crate) folder: PathBuf,
    pub(crate) is_down: Arc<AtomicBool>,
    /// The HTTP status of the booth's answers, 200 for success.
    pub(crate) status: Arc<AtomicU16>,
    pub(crate) grace_seconds: u32,
}

impl Rig {
    pub(crate) fn new(test: &str) -> Self {
        let folder =
            std::env::temp_dir().join(format!("paros-courier-{test}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        let status = Arc::new(AtomicU16::new(200));
        Rig { folder, is_down: Arc::default(), status, grace_seconds: 3600 }
    }

    pub(crate) fn start(&self, command: Option<BoothCommand>) -> Courier {
        self.start_as(OWNER.headset, command)
    }

    /// Starts a courier of the headset `headset`.
    pub(crate) fn start_as(&self, headset: u32, command: Option<BoothCommand>) -> Courier {
        let device = NewDevice::draw(None, DeviceName::new("t").expect("a name"));
        let enrolment = Enrolment {
            address: "https://b:1".into(),
            ca: vec![1],
            token: device.expect("random bits").token,
            owner: OutboxOwner { headset, ..OWNER },
        };
        let settings = OutboxSettings { grace_seconds: self.grace_seconds, max_bytes: 1 << 20 };
        let plan = CourierPlan { folder: self.folder.clone(), enrolment, settings, clock };
        Courier::spawn(&plan, self.link(headset, command)).expect("a folder")
    }

    /// Returns the paths of all parcel files, sent or not.
    pub(crate) fn parcel_files(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(&self.folder).expect("a folder");
        let paths = entries.map(|entry| entry.expect("a file").path());
        let is_parcel = |path: &PathBuf| {
            let end = path.extension().and_then(|end| end.to_str());
            matches!(end, Some("parcel" | "sent"))
        };
        paths.filter(is_parcel).collect()
    }

    /// Makes a link to the booth.
    pub(crate) fn link(&self, headset: u32, command: Option<BoothCommand>) -> CourierLink {
        Box::new(Booth {
            headset,
            status: self.status.clone(),
            is_down: self.is_down.clone(),
            answers: VecDeque::new(),
            command,
        })
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Polls until something is found.
pub(crate) fn wait<T>(what: &str, mut poll: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = poll() {
            return found;
        }
        assert!(begun.elapsed() < Duration::from_secs(30), "waited for {what}");
        thread::sleep(Duration::from_millis(5));
    }
}
