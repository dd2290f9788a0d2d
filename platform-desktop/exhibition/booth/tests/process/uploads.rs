//! Tests of uploads: sculptures are sent, kept and exported as meshes.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use paros_protocol::*;

use crate::rig::{
    BoothFolder, Client, Headset, Parcel, heartbeat, path_of, read_answer, write_request,
};

/// Waits until no mesh is queued.
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
    let volume = Parcel::volume(1);
    let large = Parcel::large(2);
    let traced = Parcel::with_trace(3);
    for parcel in [&volume, &large, &traced] {
        let outcome = headset.upload(client, parcel).unwrap().expect("kept");
        assert_eq!(outcome, ParcelOutcome::Kept);
    }
    assert_eq!(client.metric("paros_booth_sculptures"), 3);
    wait_for_exports(client);
    let log = folder.log();
    let count = |state: &str| log.matches(&format!("state={state}")).count();
    assert_eq!((count("Made"), count("Failed")), (3, 0), "{log}");
    let files = folder.files("sculptures");
    let of_kind = |end: &str| files.iter().filter(|name| name.ends_with(end)).count();
    assert_eq!((of_kind(".sculpture"), of_kind(".trace"), of_kind(".png")), (3, 2, 3), "{files:?}");
}

#[test]
fn a_parcel_that_is_cut_leaves_nothing_and_comes_again_after_a_restart() {
    let folder = BoothFolder::new("cut");
    let mut booth = folder.start();
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    let parcel = Parcel::large(1);
    // A connection that breaks in the middle of an upload.
    let mut stream = booth.client.connect().unwrap();
    let file = parcel.file();
    let headers = [headset.bearer(), ("Content-Length", file.len().to_string())];
    let half = &file[..file.len() / 2];
    write_request(&mut stream, "PUT", &path_of(&parcel), &headers, half).unwrap();
    drop(stream);
    assert_eq!(booth.terminate(), Some(0));
    assert_eq!(folder.files("sculptures"), [""; 0]);
    let booth = folder.start();
    headset.upload(&booth.client, &parcel).unwrap().expect("kept");
    drop(booth);
    let booth = folder.start();
    let again = headset.upload(&booth.client, &parcel).unwrap();
    assert_eq!(again.expect("it is known"), ParcelOutcome::Kept);
    assert_eq!(booth.client.metric("paros_booth_sculptures"), 1);
}

#[test]
fn another_hash_is_a_conflict_and_the_messages_say_what_is_wrong() {
    let folder = BoothFolder::new("conflict");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(1);
    headset.upload(client, &parcel).unwrap().expect("kept");
    let facts = UploadFacts { sculpting_seconds: 1, ..parcel.facts };
    let other = parcel.with_facts(facts);
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
    let announced = Announcement { id, badge: None, status: UploadStatus::Kept };
    let beat = Heartbeat {
        announcements: std::iter::once(announced).collect(),
        ..heartbeat(headset.number)
    };
    let answer = client.ask("POST", "/v1/heartbeat", &[headset.bearer()], &beat.to_json()).unwrap();
    assert_eq!(answer.status, 200, "{answer:?}");
    let answer = HeartbeatAnswer::from_json(&answer.body).expect("a message");
    assert_eq!(answer.noted.as_slice(), [announced]);
    assert_eq!(answer.badges.len(), 2, "it leases numbers of badges");
    assert_eq!(client.metric("paros_booth_heartbeats_total"), 1);
    let bad = client.ask("POST", "/v1/heartbeat", &[headset.bearer()], b"x").unwrap();
    assert_eq!((bad.status, bad.text()), (400, "no message: expected value at line 1 column 1\n"));
}

/// Measurements while many headsets send at once.
#[derive(Default)]
struct Load {
    /// The times of heartbeats.
    beats: Mutex<Vec<Duration>>,
    /// The bytes of kept parcels.
    bytes: AtomicU64,
    /// The number of headsets that are done.
    done: AtomicU64,
    /// The number of responses that asked to retry later.
    asked_to_wait: AtomicU64,
}

/// Sends a headset's parcels: volumes, and one with a long trace.
fn send_parcels(client: &Client, headset: &Headset, load: &Load) {
    let mut stream = client.connect().expect("a connection");
    for k in 0..PARCELS_EACH {
        let parcel = parcel_of(headset, k);
        let (path, file) = (path_of(&parcel), parcel.file());
        loop {
            let written = write_request(&mut stream, "PUT", &path, &[headset.bearer()], &file);
            let answer = written.and_then(|()| read_answer(&mut stream));
            // A client that is still sending a long body may miss the refusal, as the booth doesn't read the
            // rest.
            let status = answer.map_or(503, |answer| answer.status);
            if status == 200 {
                break;
            }
            assert!(matches!(status, 429 | 503), "{status}");
            load.asked_to_wait.fetch_add(1, Ordering::Relaxed);
            std::thread::sleep(Duration::from_secs(3));
            stream = client.connect().expect("a connection");
        }
        load.bytes.fetch_add(parcel.bytes.len() as u64, Ordering::Relaxed);
    }
    load.done.fetch_add(1, Ordering::Relaxed);
}

/// Sends a heartbeat every tenth of a second on one connection, until the headsets are done.
fn beat_meanwhile(client: &Client, headset: &Headset, headsets: u64, load: &Load) {
    let mut stream = client.connect().expect("a connection");
    let beat = heartbeat(headset.number).to_json();
    while load.done.load(Ordering::Relaxed) < headsets {
        let start = Instant::now();
        write_request(&mut stream, "POST", "/v1/heartbeat", &[headset.bearer()], &beat).unwrap();
        assert_eq!(read_answer(&mut stream).expect("an answer").status, 200);
        load.beats.lock().unwrap().push(start.elapsed());
        std::thread::sleep(Duration::from_millis(100));
    }
}

const PARCELS_EACH: u32 = 3;

/// The longest time of the whole test, on a busy machine.
const MOST_SECONDS: f64 = 300.0;

/// Measures how long it takes to write the same parcels as synced files, one after the other.
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

/// Makes a headset's parcel number `k`. One has a long trace.
fn parcel_of(headset: &Headset, k: u32) -> Parcel {
    let make = if k == 1 { Parcel::large } else { Parcel::volume };
    make(headset.number * 100 + k)
}

/// The number of headsets is 200, unless `PAROS_BOOTH_HEADSETS` sets it.
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
    // Sends one parcel of each kind first, so that memory for threads and buffers is allocated before the
    // measurement.
    for parcel in [Parcel::volume(1), Parcel::large(2)] {
        headsets[0].upload(client, &parcel).unwrap().expect("kept");
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
