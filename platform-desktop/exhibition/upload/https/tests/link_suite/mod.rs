//! Requirements of every link, checked against a scripted TLS server. Each link's tests include this file.

mod server;

use std::io::Read as _;
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener};
use std::thread;
use std::time::{Duration, Instant};

use paros_protocol::{DeviceToken, LinkTimes, SculptureId};
use paros_upload::{
    BoothAddress, BoothLink, BoothRequest, HttpAnswer, LinkAnswer, LinkFault, RequestKind,
};

pub(crate) use server::{Answer, Server};

const TIMES: LinkTimes =
    LinkTimes { put: Duration::from_secs(20), small: Duration::from_millis(1500) };

/// A function that opens a link.
pub(crate) trait Opener<L>: Fn(&BoothAddress, LinkTimes) -> L {}

impl<L, F: Fn(&BoothAddress, LinkTimes) -> L> Opener<L> for F {}

const PUT: RequestKind = RequestKind::Put(SculptureId([0x1f; 16]));

pub(crate) fn put() -> BoothRequest {
    BoothRequest { kind: PUT, number: 7, body: b"a parcel".to_vec() }
}

pub(crate) fn heartbeat() -> BoothRequest {
    BoothRequest { kind: RequestKind::Heartbeat, number: 8, body: b"a heartbeat".to_vec() }
}

pub(crate) fn ask(link: &mut impl BoothLink, request: BoothRequest) -> LinkAnswer {
    let began = Instant::now();
    link.send(request);
    loop {
        if let Some(answer) = link.poll() {
            return answer;
        }
        assert!(began.elapsed() < Duration::from_secs(40), "no answer, and no fault");
        thread::sleep(Duration::from_millis(5));
    }
}

fn open_at<L>(open: &impl Opener<L>, address: SocketAddr, ca: &[u8]) -> L {
    let url = format!("https://{address}");
    let token = DeviceToken([0xab; 32]);
    open(&BoothAddress { url, ca: ca.to_vec(), token }, TIMES)
}

fn open_to<L>(open: &impl Opener<L>, server: &Server) -> L {
    open_at(open, server.address, &server.ca)
}

pub(crate) fn check_requests_and_answers<L: BoothLink>(open: impl Opener<L>) {
    let busy = b"HTTP/1.1 429 x\r\nRetry-After: 17\r\nContent-Length: 4\r\n\r\nbusy";
    let server = Server::start(Answer::Bytes(busy));
    let mut link = open_to(&open, &server);
    let answer = ask(&mut link, put());
    let expected = HttpAnswer { status: 429, retry_after: Some(17), body: b"busy".to_vec() };
    assert_eq!(answer, LinkAnswer { kind: PUT, number: 7, result: Ok(expected) });
    let sent = server.requests.recv().expect("a request");
    let path = format!("put /v1/sculptures/{} http/1.1\r\n", "1f".repeat(16));
    assert!(sent.starts_with(&path), "{sent}");
    let headers = [
        format!("authorization: bearer {}", "ab".repeat(32)),
        "content-type: application/octet-stream".into(),
        "content-length: 8".into(),
    ];
    for header in headers {
        assert!(sent.contains(&format!("\r\n{header}\r\n")), "{header}: {sent}");
    }
    assert!(sent.ends_with("\r\n\r\na parcel"), "{sent}");
    let answer = ask(&mut link, heartbeat());
    assert_eq!((answer.kind, answer.number), (RequestKind::Heartbeat, 8));
    let sent = server.requests.recv().expect("a request");
    assert!(sent.starts_with("post /v1/heartbeat http/1.1\r\n"), "{sent}");
    assert!(sent.ends_with("\r\n\r\na heartbeat"), "{sent}");
}

pub(crate) fn check_trust<L: BoothLink>(open: impl Opener<L>) {
    let fine = Answer::Bytes(b"HTTP/1.1 200 x\r\nContent-Length: 0\r\n\r\n");
    let server = Server::start(fine);
    let other = Server::start(Answer::Never);
    let mut of_other = open_at(&open, server.address, &other.ca);
    assert_eq!(ask(&mut of_other, put()).result, Err(LinkFault::Untrusted));
    assert!(ask(&mut open_to(&open, &server), put()).result.is_ok());
    let mut nothing = open_at(&open, server.address, b"no certificate");
    assert_eq!(ask(&mut nothing, put()).result, Err(LinkFault::Untrusted));
    // Only the right server received the token.
    assert_eq!(server.requests.try_iter().count(), 1);
    // A certificate of the right authority, for another address.
    let elsewhere = Server::start_as("192.0.2.7", fine);
    assert_eq!(ask(&mut open_to(&open, &elsewhere), put()).result, Err(LinkFault::Untrusted));
    assert_eq!(elsewhere.requests.try_iter().count(), 0);
}

pub(crate) fn check_silence<L: BoothLink>(open: impl Opener<L>) {
    let silent = Server::start(Answer::Never);
    let mut link = open_to(&open, &silent);
    link.send(put());
    let began = Instant::now();
    assert_eq!(ask(&mut link, heartbeat()).result, Err(LinkFault::TimedOut));
    assert!(began.elapsed() < TIMES.small * 4, "the parcel held it up: {:?}", began.elapsed());
    // This server never ends its answer, and is never silent for long.
    let slow = Server::start(Answer::Drip);
    let began = Instant::now();
    assert_eq!(ask(&mut open_to(&open, &slow), heartbeat()).result, Err(LinkFault::TimedOut));
    assert!(began.elapsed() < TIMES.small * 4, "{:?}", began.elapsed());
    // No process listens at this port.
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, 1));
    let mut to_nobody = open_at(&open, address, &silent.ca);
    assert_eq!(ask(&mut to_nobody, put()).result, Err(LinkFault::Unreachable));
}

/// A peer that hangs up in the middle of a handshake may still be the booth.
pub(crate) fn check_cut_handshakes<L: BoothLink>(open: impl Opener<L>) {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let address = listener.local_addr().expect("it is bound");
    thread::spawn(move || {
        for mut stream in listener.incoming().flatten() {
            let mut hello = [0; 64];
            // Hang up whatever was received.
            let _ = stream.read(&mut hello);
            let _ = stream.shutdown(Shutdown::Both);
        }
    });
    let ca = Server::start(Answer::Never).ca;
    let mut link = open_at(&open, address, &ca);
    assert_eq!(ask(&mut link, put()).result, Err(LinkFault::Unreachable));
}

/// A link sends nothing without encryption.
pub(crate) fn check_no_plain_http<L: BoothLink>(open: impl Opener<L>) {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let address = listener.local_addr().expect("it is bound");
    let ca = Server::start(Answer::Never).ca;
    let plain = BoothAddress { url: format!("http://{address}"), ca, token: DeviceToken([1; 32]) };
    assert!(ask(&mut open(&plain, TIMES), put()).result.is_err());
    listener.set_nonblocking(true).expect("a socket");
    assert!(listener.accept().is_err(), "it was called");
}

pub(crate) fn check_redirects_and_long_bodies<L: BoothLink>(open: impl Opener<L>) {
    let away = b"HTTP/1.1 307 x\r\nLocation: /elsewhere\r\nContent-Length: 0\r\n\r\n";
    let server = Server::start(Answer::Bytes(away));
    let answer = ask(&mut open_to(&open, &server), put());
    // In either case the token wasn't sent to the redirect's target.
    assert!(answer.result.is_err() || answer.result.is_ok_and(|answer| answer.status == 307));
    assert_eq!(server.requests.try_iter().count(), 1);
    let long = Server::start(Answer::Long(100_000_000));
    assert_eq!(ask(&mut open_to(&open, &long), put()).result, Err(LinkFault::Unreachable));
    let sent = long.sent.recv_timeout(Duration::from_secs(40)).expect("it was cut off");
    assert!(sent < 20_000_000, "{sent} bytes were taken");
}
