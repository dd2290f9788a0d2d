//! Sculptures go in, and their receipts come out.

use std::time::{Duration, Instant};

use paros_core::outbox::messages::*;

use crate::rig::{BoothFolder, Client, Headset, PIECE, Parcel, heartbeat};

/// Waits until no mesh is left to be compared.
fn wait_for_exports(client: &Client) {
    let start = Instant::now();
    while client.metric("paros_booth_exports_queued") > 0 {
        assert!(start.elapsed() < Duration::from_secs(120), "the exporter stands still");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn volumes_meshes_and_traces_are_kept_and_their_meshes_compared() {
    let folder = BoothFolder::new("uploads");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let volume = Parcel::new(headset.number, 1, ParcelKind::Volume);
    let mesh = Parcel::new(headset.number, 2, ParcelKind::Mesh);
    let traced = Parcel::with_trace(headset.number, 3);
    // One whose headset says it exported something else, as another version may.
    let facts = UploadFacts { stl_hash: ContentHash([1; 32]), ..volume.facts };
    let facts = UploadFacts { id: SculptureId([4; 16]), ..facts };
    let other = Parcel::of_packed(facts, &volume.bytes[UploadFacts::BYTES..], &[]);
    for parcel in [&volume, &mesh, &traced, &other] {
        let receipt = headset.upload(client, parcel).unwrap().expect("a receipt").receipt;
        assert_eq!(receipt.outcome, ReceiptOutcome::Kept);
    }
    assert_eq!(client.metric("paros_booth_sculptures"), 4);
    wait_for_exports(client);
    let log = folder.log();
    let count = |state: &str| log.matches(&format!("state={state}")).count();
    assert_eq!((count("Equal"), count("Different"), count("Failed")), (3, 1, 0), "{log}");
    let files = folder.files("sculptures");
    let of_kind = |end: &str| files.iter().filter(|name| name.ends_with(end)).count();
    assert_eq!((of_kind(".sculpture"), of_kind(".trace"), of_kind(".png")), (4, 1, 3), "{files:?}");
    assert_eq!(folder.files(&format!("parcels/{}", headset.number)), [""; 0]);
}

#[test]
fn an_upload_goes_on_where_it_was_cut_and_gives_the_same_receipt_after_a_restart() {
    let folder = BoothFolder::new("cut");
    let mut booth = folder.start();
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    let parcel = Parcel::new(headset.number, 1, ParcelKind::Mesh);
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
    let parcel = Parcel::new(headset.number, 1, ParcelKind::Volume);
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

#[test]
fn many_headsets_at_once_lose_nothing_and_take_little_memory() {
    const HEADSETS: u8 = 40;
    const EACH: u32 = 3;
    let folder = BoothFolder::new("many");
    let booth = folder.start();
    let client = &booth.client;
    let fleet = folder.fleet_token();
    let headsets: Vec<Headset> =
        (1..=HEADSETS).map(|byte| Headset::enrol(client, fleet, byte)).collect();
    // What each thread and buffer takes once is taken: one of each kind.
    for (id, kind) in [(1, ParcelKind::Volume), (2, ParcelKind::Mesh)] {
        let parcel = Parcel::new(headsets[0].number, id, kind);
        headsets[0].upload(client, &parcel).unwrap().expect("a receipt");
    }
    wait_for_exports(client);
    let before = booth.peak_memory();
    std::thread::scope(|scope| {
        for headset in &headsets {
            scope.spawn(move || {
                for k in 0..EACH {
                    let kind = if k == 1 { ParcelKind::Mesh } else { ParcelKind::Volume };
                    let parcel = Parcel::new(headset.number, headset.number * 100 + k, kind);
                    headset.upload(client, &parcel).unwrap().expect("a receipt");
                }
            });
        }
    });
    let all = u64::from(HEADSETS) * u64::from(EACH) + 2;
    assert_eq!(client.metric("paros_booth_sculptures"), all);
    let files = folder.files("sculptures");
    assert_eq!(files.iter().filter(|name| name.ends_with(".sculpture")).count() as u64, all);
    println!("{} bytes of STL", crate::rig::figure().stl.len());
    let grown = booth.peak_memory().saturating_sub(before);
    assert!(grown < 64 << 20, "it grew by {grown} bytes");
    println!("grown by {grown} bytes");
}
