//! Tests of hostile requests.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use paros_protocol::limits::MAX_PARCEL_VOLUME_BYTES;
use paros_protocol::*;

use crate::rig::{
    BoothFolder, Headset, Parcel, deflate, heartbeat, path_of, read_answer, write_request,
};
use crate::staff::Browser;

#[test]
fn who_has_no_token_or_anothers_gets_nothing() {
    let folder = BoothFolder::new("tokens");
    let booth = folder.start();
    let client = &booth.client;
    let fleet = folder.fleet_token();
    let (mine, thief) = (Headset::enrol(client, fleet, 1), Headset::enrol(client, fleet, 2));
    let parcel = Parcel::volume(1);
    let unknown = Headset { token: DeviceToken([9; 32]), ..mine.clone() };
    let answer = unknown.upload(client, &parcel).unwrap().expect_err("no token");
    assert_eq!((answer.status, answer.text()), (401, "no such token, or not any more\n"));
    assert_eq!(client.ask("POST", "/v1/heartbeat", &[], &[]).unwrap().status, 401);
    let basic = ("Authorization", "Basic eDp5".to_owned());
    assert_eq!(client.ask("POST", "/v1/heartbeat", &[basic], &[]).unwrap().status, 401);
    // Another parcel under an existing id.
    mine.upload(client, &parcel).unwrap().expect("it is taken");
    let facts = UploadFacts { sculpting_seconds: 1, ..parcel.facts };
    let other = parcel.with_facts(facts);
    assert_eq!(thief.upload(client, &other).unwrap().expect_err("not its own").status, 409);
    let asked = FleetEnrolment {
        enrolment_token: EnrolmentToken([5; 32]),
        token_hash: ContentHash([5; 32]),
        hint: DeviceHint([5; 16]),
        name: DeviceName::new("").expect("a name"),
    };
    assert_eq!(client.post("/v1/enrol/fleet", &asked.to_json()).status, 401);
    // Guessing of tokens is rate-limited.
    let guesses = (0..400).map(|_| client.post("/v1/enrol/fleet", &asked.to_json()).status);
    assert!(guesses.filter(|status| *status == 429).count() > 50);
    mine.upload(client, &parcel).unwrap().expect("who has a token isn't held up");
}

#[test]
fn what_is_too_large_or_no_sculpture_is_refused() {
    let folder = BoothFolder::new("sizes");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(1);
    // A request that is too large is refused by its `Content-Length`.
    let parcel_path = path_of(&parcel);
    for (method, path, most) in
        [("PUT", &*parcel_path, (32u64 << 20) + 32), ("POST", "/v1/heartbeat", 256 << 10)]
    {
        for length in [most + 1, 10 << 30] {
            let headers = [headset.bearer(), ("Content-Length", length.to_string())];
            let mut stream = client.connect().unwrap();
            write_request(&mut stream, method, path, &headers, b"xxxx").unwrap();
            let answer = read_answer(&mut stream).unwrap();
            assert_eq!(
                (answer.status, answer.text()),
                (413, &*format!("bytes of a request: at most {most} are taken\n"))
            );
        }
    }

    let refused = |parcel: &Parcel| {
        let answer = headset.upload(client, parcel).unwrap().expect_err("no sculpture");
        assert_eq!(answer.status, 422, "{answer:?}");
        answer.text().to_owned()
    };
    let garbage =
        Parcel::of_packed(parcel.facts, &vec![0xa7; parcel.facts.volume_bytes as usize], &[]);
    assert!(refused(&garbage).contains("not packed by deflate"));
    // A decompression bomb: 64 MiB of zeros in 64 KiB.
    let bomb = deflate(&vec![0; 64 << 20]);
    for raw in [parcel.facts.volume_raw_bytes, MAX_PARCEL_VOLUME_BYTES] {
        let facts =
            UploadFacts { volume_bytes: bomb.len() as u32, volume_raw_bytes: raw, ..parcel.facts };
        let before = booth.peak_memory();
        assert!(refused(&Parcel::of_packed(facts, &bomb, &[])).contains("unpacked"));
        assert!(booth.peak_memory() < before + (16 << 20));
    }
    let zeros = Parcel::pack(parcel.facts, &vec![0; parcel.facts.volume_raw_bytes as usize], &[]);
    assert!(refused(&zeros).contains("RMAP"));
    let other_side = UploadFacts { side: 256, ..parcel.facts };
    let other_side = parcel.with_facts(other_side);
    assert!(refused(&other_side).contains("side"));
    let traced = UploadFacts { trace_bytes: 3, trace_raw_bytes: 9, ..parcel.facts };
    let traced = Parcel::of_packed(traced, parcel.packed(), &[1, 2, 3]);
    assert!(refused(&traced).contains("trace"));
    assert_eq!(client.metric("paros_booth_sculptures"), 0);
    headset.upload(client, &parcel).unwrap().expect("it is taken");
}

#[test]
fn names_lead_nowhere_but_to_sculptures() {
    let folder = BoothFolder::new("names");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(1);
    let before = folder.files("");
    for name in [
        "..%2f..%2fbooth.sqlite",
        "../../keys/site.key",
        "%00",
        "zz",
        "0123456789abcdef0123456789abcde%2f",
        "0123456789abcdef0123456789abcdef0",
        "'; DROP TABLE sculptures; --",
    ] {
        let path = format!("/v1/sculptures/{}", name.replace(' ', "%20"));
        let answer = client.ask("PUT", &path, &[headset.bearer()], b"x").unwrap();
        assert!(matches!(answer.status, 400 | 404), "{name}: {answer:?}");
    }
    let answer = client.ask("PUT", &path_of(&parcel), &[headset.bearer()], b"x").unwrap();
    assert_eq!(answer.status, 400, "{answer:?}");
    assert_eq!(folder.files(""), before);
}

/// Connections that stay idle or send byte by byte are closed, while other clients are served.
#[test]
fn slow_ones_are_cut_off() {
    let folder = BoothFolder::new("slow");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let start = Instant::now();
    let silent: Vec<TcpStream> =
        (0..100).map(|_| TcpStream::connect(client.address).expect("a connection")).collect();
    let mut dripping: Vec<_> = (0..50)
        .map(|_| {
            let mut stream = client.connect().expect("a connection");
            stream.write_all(b"PUT /v1/sculptures/").expect("it is open");
            stream
        })
        .collect();
    // A body that never arrives.
    let parcel = Parcel::volume(1);
    let headers = [headset.bearer(), ("Content-Length", "1000".to_owned())];
    let mut stuck = client.connect().expect("a connection");
    write_request(&mut stuck, "POST", "/v1/heartbeat", &headers, b"x").expect("it is open");
    headset.upload(client, &parcel).unwrap().expect("others are served");
    assert!(start.elapsed() < Duration::from_secs(9), "{:?}", start.elapsed());
    // A byte now and then doesn't extend the timeout.
    std::thread::sleep(Duration::from_secs(9));
    for stream in &mut dripping {
        let _ = stream.write_all(b"a").and_then(|()| stream.flush());
    }
    std::thread::sleep(Duration::from_secs(8));
    for mut stream in silent {
        stream.set_read_timeout(Some(Duration::from_secs(1))).unwrap();
        assert!(stream.read(&mut [0; 1]).is_ok_and(|count| count == 0), "it is open still");
    }
    for mut stream in dripping {
        stream.sock.set_read_timeout(Some(Duration::from_secs(1))).unwrap();
        // The booth may send a response before it closes the connection.
        let mut rest = Vec::new();
        let ended = stream.read_to_end(&mut rest);
        assert!(
            ended.is_ok()
                || ended.is_err_and(|error| {
                    !matches!(
                        error.kind(),
                        std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut
                    )
                }),
            "it is open still"
        );
    }
    assert_eq!(read_answer(&mut stuck).expect("an answer").status, 408);
}

/// Opens more connections than the booth's limit of 640.
#[test]
fn who_holds_all_connections_keeps_nobody_out() {
    let folder = BoothFolder::new("idle");
    let booth = folder.start();
    let client = &booth.client;
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let browser = Browser::first(client, &booth.first_code().expect("a code"));
    let beat = heartbeat(headset.number).to_json();
    let mut of_staff = client.connect().expect("a connection");
    let mut of_headset = client.connect().expect("a connection");
    let ask_as_staff = |stream: &mut _| {
        write_request(stream, "GET", "/staff", &[("Cookie", browser.cookie.clone())], &[])?;
        read_answer(stream).map(|answer| answer.status)
    };
    let ask_as_headset = |stream: &mut _| {
        write_request(stream, "POST", "/v1/heartbeat", &[headset.bearer()], &beat)?;
        read_answer(stream).map(|answer| answer.status)
    };
    assert_eq!(ask_as_staff(&mut of_staff).expect("an answer"), 200);
    assert_eq!(ask_as_headset(&mut of_headset).expect("an answer"), 200);
    // Opens more connections than the limit from the same address, new ones in each round.
    for round in 0..2 {
        let idle: Vec<TcpStream> =
            (0..700).map(|_| client.connect_plain().expect("a connection")).collect();
        let start = Instant::now();
        assert_eq!(client.get("/healthz").status, 200, "{round}: a stranger");
        assert_eq!(ask_as_staff(&mut of_staff).expect("it is kept"), 200, "{round}");
        assert_eq!(ask_as_headset(&mut of_headset).expect("it is kept"), 200, "{round}");
        assert_eq!(browser.get("/staff/headsets").status, 200, "{round}: a new one");
        assert!(
            start.elapsed() < Duration::from_secs(8),
            "not when the idle ones end by themselves"
        );
        // The oldest connections were closed, the newest are open.
        let mut ended = idle.iter().map(|mut stream| {
            stream.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
            stream.read(&mut [0]).is_ok_and(|count| count == 0)
        });
        assert!(ended.next().expect("the first"), "{round}: it made room");
        assert!(!ended.next_back().expect("the last one"), "{round}");
    }
    assert!(client.metric("paros_booth_closed_early_total") >= 120);
    assert_eq!(client.metric("paros_booth_turned_away_total"), 0);
    // The many connections of another address are closed before the few of this one.
    let mut few = client.connect().expect("a connection");
    let other = client.at_address([127, 0, 0, 2].into());
    let _many: Vec<TcpStream> =
        (0..700).map(|_| other.connect_plain().expect("a connection")).collect();
    write_request(&mut few, "GET", "/healthz", &[], &[]).expect("it is open");
    assert_eq!(read_answer(&mut few).expect("it stays").status, 200);
}
