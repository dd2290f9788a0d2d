//! Sculptures go in, and their receipts come out.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use paros_booth_rules::limits::MAX_CHUNK_BYTES;
use paros_core::outbox::messages::*;

use crate::rig::{
    BoothFolder, Client, Headset, PIECE, Parcel, heartbeat, read_answer, write_request,
};

/// Waits until no mesh is left to be made.
fn wait_for_exports(client: &Client) {
    let start = Instant::now();
    while client.metric("paros_booth_exports_queued") > 0 {
        assert!(start.elapsed() < Duration::from_secs(120), "the exporter stands still");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn volumes_and_traces_are_kept_and_their_meshes_made() {
    let folder = BoothFolder::new("uploads");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let volume = Parcel::volume(headset.number, 1);
    let large = Parcel::large(headset.number, 2);
    let traced = Parcel::with_trace(headset.number, 3);
    for parcel in [&volume, &large, &traced] {
        let receipt = headset.upload(client, parcel).unwrap().expect("a receipt");
        assert_eq!(receipt.outcome, ReceiptOutcome::Kept);
    }
    assert_eq!(client.metric("paros_booth_sculptures"), 3);
    wait_for_exports(client);
    let log = folder.log();
    let count = |state: &str| log.matches(&format!("state={state}")).count();
    assert_eq!((count("Made"), count("Failed")), (3, 0), "{log}");
    let files = folder.files("sculptures");
    let of_kind = |end: &str| files.iter().filter(|name| name.ends_with(end)).count();
    assert_eq!((of_kind(".sculpture"), of_kind(".trace"), of_kind(".png")), (3, 2, 3), "{files:?}");
    assert_eq!(folder.files(&format!("parcels/{}", headset.number)), [""; 0]);
}

#[test]
fn an_upload_goes_on_where_it_was_cut_and_gives_the_same_receipt_after_a_restart() {
    let folder = BoothFolder::new("cut");
    let mut booth = folder.start();
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    let parcel = Parcel::large(headset.number, 1);
    assert!(parcel.bytes.len() > 4 * PIECE);
    for k in 0..3 {
        let piece = &parcel.bytes[k * PIECE..][..PIECE];
        let answer = headset.put(&booth.client, &parcel, (k * PIECE) as u64, piece).unwrap();
        assert_eq!(answer.status, 202);
        assert_eq!(answer.body, (((k + 1) * PIECE) as u64).to_le_bytes());
    }
    // A connection that breaks in the middle of a piece: nothing of it counts.
    let mut stream = booth.client.connect().unwrap();
    let mut headers = headset.headers(&parcel);
    headers.push(("Content-Length", PIECE.to_string()));
    let path = format!("/v1/sculptures/{}?offset={}", parcel.facts.id, 3 * PIECE);
    crate::rig::write_request(&mut stream, "PUT", &path, &headers, &parcel.bytes[..999]).unwrap();
    drop(stream);
    assert_eq!(booth.terminate(), Some(0));
    let booth = folder.start();
    let answer = headset.put(&booth.client, &parcel, 0, &parcel.bytes[..PIECE]).unwrap();
    assert_eq!((answer.status, answer.body), (202, ((3 * PIECE) as u64).to_le_bytes().into()));
    let receipt = headset.upload(&booth.client, &parcel).unwrap().expect("a receipt");
    drop(booth);
    let booth = folder.start();
    assert_eq!(headset.upload(&booth.client, &parcel).unwrap().expect("again"), receipt);
    assert_eq!(booth.client.metric("paros_booth_sculptures"), 1);
}

#[test]
fn another_hash_is_a_conflict_and_the_messages_say_what_is_wrong() {
    let folder = BoothFolder::new("conflict");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(headset.number, 1);
    headset.upload(client, &parcel).unwrap().expect("a receipt");
    let facts = UploadFacts { sculpting_seconds: 1, ..parcel.facts };
    let other = Parcel::of_packed(facts, &parcel.bytes[UploadFacts::BYTES..], &[]);
    let answer = headset.upload(client, &other).unwrap().expect_err("a conflict");
    assert_eq!(answer.status, 409);
    assert_eq!(answer.text(), "another parcel of this sculpture was taken before\n");
}

#[test]
fn heartbeats_are_answered_and_counted() {
    let folder = BoothFolder::new("heartbeats");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let id = SculptureId([9; 16]);
    let announced = Announcement { id, badge: None, state: AnnouncementState::Kept };
    let mut lease = paros_core::badge::BadgeLease::new(headset.number, 4);
    let beat = Heartbeat {
        lease: Some(lease.make_report()),
        announcements: std::iter::once(announced).collect(),
        ..heartbeat(headset.number)
    };
    let answer =
        client.ask("POST", "/v1/heartbeat", &[headset.bearer()], &beat.to_bytes()).unwrap();
    assert_eq!(answer.status, 200, "{answer:?}");
    let answer = HeartbeatAnswer::from_bytes(&answer.body).expect("a message");
    assert_eq!(answer.noted.as_slice(), [announced]);
    let taken = lease.take_answer(&answer.lease.expect("it was reported"));
    assert_eq!(taken, paros_core::badge::AnswerOutcome::Taken);
    assert_eq!(client.metric("paros_booth_heartbeats_total"), 1);
    let bad = client.ask("POST", "/v1/heartbeat", &[headset.bearer()], b"x").unwrap();
    assert_eq!(
        (bad.status, bad.text()),
        (400, "byte 0: expected version 1 of the booth's messages\n")
    );
}

/// What is measured while headsets send at once.
#[derive(Default)]
struct Load {
    /// How long heartbeats took.
    beats: Mutex<Vec<Duration>>,
    /// Bytes of parcels that were kept.
    bytes: AtomicU64,
    /// Headsets that are done.
    done: AtomicU64,
    /// Answers that asked one to wait.
    asked_to_wait: AtomicU64,
}

/// Sends a headset's parcels: volumes, and a mesh.
fn send_parcels(client: &Client, headset: &Headset, load: &Load) {
    let mut stream = client.connect().expect("a connection");
    for k in 0..PARCELS_EACH {
        let parcel = parcel_of(headset, k);
        let mut offset = 0;
        loop {
            let rest = &parcel.bytes[offset..];
            let piece = &rest[..rest.len().min(MAX_CHUNK_BYTES)];
            let path = format!("/v1/sculptures/{}?offset={offset}", parcel.facts.id);
            write_request(&mut stream, "PUT", &path, &headset.headers(&parcel), piece).unwrap();
            let answer = read_answer(&mut stream).expect("an answer");
            match answer.status {
                200 => {
                    headset.check_receipt(&parcel, &answer.body);
                    break;
                }
                202 => offset = u64::from_le_bytes(answer.body[..].try_into().unwrap()) as usize,
                // It is asked to wait, as an outbox is.
                429 | 503 => {
                    let seconds = answer.head.split("retry-after: ").nth(1).expect("when");
                    let seconds = seconds.lines().next().and_then(|line| line.parse().ok());
                    load.asked_to_wait.fetch_add(1, Ordering::Relaxed);
                    std::thread::sleep(Duration::from_secs(seconds.expect("a number")));
                }
                _ => panic!("{answer:?}"),
            }
        }
        load.bytes.fetch_add(parcel.bytes.len() as u64, Ordering::Relaxed);
    }
    load.done.fetch_add(1, Ordering::Relaxed);
}

/// Beats every tenth of a second on one connection, as long as others send.
fn beat_meanwhile(client: &Client, headset: &Headset, headsets: u64, load: &Load) {
    let mut stream = client.connect().expect("a connection");
    let beat = heartbeat(headset.number).to_bytes();
    while load.done.load(Ordering::Relaxed) < headsets {
        let start = Instant::now();
        write_request(&mut stream, "POST", "/v1/heartbeat", &[headset.bearer()], &beat).unwrap();
        assert_eq!(read_answer(&mut stream).expect("an answer").status, 200);
        load.beats.lock().unwrap().push(start.elapsed());
        std::thread::sleep(Duration::from_millis(100));
    }
}

const PARCELS_EACH: u32 = 3;

/// How long it all may take, on a machine that is busy with other things.
const MOST_SECONDS: f64 = 300.0;

/// How long the same parcels take as files that are synced, one after the other, by one who has nothing else to do.
fn time_writes(folder: &Path, headsets: &[Headset]) -> Duration {
    let parcels: Vec<Parcel> = headsets
        .iter()
        .flat_map(|headset| (0..PARCELS_EACH).map(|k| parcel_of(headset, k)))
        .collect();
    std::fs::create_dir_all(folder).expect("room on the disk");
    let start = Instant::now();
    for (k, parcel) in parcels.iter().enumerate() {
        let mut file = File::create(folder.join(k.to_string())).expect("room on the disk");
        file.write_all(&parcel.bytes).expect("room on the disk");
        file.sync_all().expect("a disk");
    }
    let time = start.elapsed();
    std::fs::remove_dir_all(folder).expect("it is there");
    time
}

/// A headset's parcels: one has a long trace.
fn parcel_of(headset: &Headset, k: u32) -> Parcel {
    let make = if k == 1 { Parcel::large } else { Parcel::volume };
    make(headset.number, headset.number * 100 + k)
}

/// `PAROS_BOOTH_HEADSETS` says how many.
#[test]
fn many_headsets_at_once_lose_nothing_and_take_little_memory() {
    let count = std::env::var("PAROS_BOOTH_HEADSETS").ok().and_then(|count| count.parse().ok());
    let count: u8 = count.unwrap_or(200);
    let folder = BoothFolder::new("many");
    let booth = folder.start();
    let client = &booth.client;
    let fleet = folder.fleet_token();
    let headsets: Vec<Headset> =
        (1..=count).map(|byte| Headset::enrol(client, fleet, byte)).collect();
    // What each thread and buffer takes once is taken: one of each kind.
    let number = headsets[0].number;
    for parcel in [Parcel::volume(number, 1), Parcel::large(number, 2)] {
        headsets[0].upload(client, &parcel).unwrap().expect("a receipt");
    }
    wait_for_exports(client);
    let before = booth.peak_memory();
    let (load, start) = (Load::default(), Instant::now());
    std::thread::scope(|scope| {
        let load = &load;
        scope.spawn(|| beat_meanwhile(client, &headsets[0], count.into(), load));
        for headset in &headsets {
            scope.spawn(move || send_parcels(client, headset, load));
        }
    });
    let seconds = start.elapsed().as_secs_f64();
    let all = u64::from(count) * u64::from(PARCELS_EACH) + 2;
    assert_eq!(client.metric("paros_booth_sculptures"), all);
    let files = folder.files("sculptures");
    assert_eq!(files.iter().filter(|name| name.ends_with(".sculpture")).count() as u64, all);
    let grown = booth.peak_memory().saturating_sub(before);
    assert!(grown < 64 << 20, "it grew by {grown} bytes");
    let mut beats = load.beats.into_inner().unwrap();
    beats.sort_unstable();
    let p99 = beats[beats.len() * 99 / 100];
    let megabytes = load.bytes.into_inner() as f64 / 1e6;
    let writing = time_writes(&folder.path().with_file_name("written"), &headsets).as_secs_f64();
    let part = writing / seconds;
    println!(
        "{count} headsets: {all} parcels, {seconds:.1} s, {:.1} MB/s, {part:.2} of writing and syncing ({:.1} MB/s), \
         {} heartbeats, p99 {p99:?}, {} times asked to wait, grown by {grown} bytes",
        megabytes / seconds,
        megabytes / writing,
        beats.len(),
        load.asked_to_wait.into_inner()
    );
    assert!(seconds < MOST_SECONDS, "{seconds}");
    assert!(p99 < Duration::from_secs(1), "{p99:?}");
}
