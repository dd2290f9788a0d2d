//! The link against a server of TLS that answers as it is told.

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use paros_core::outbox::messages::{ContentHash, DeviceToken, Heartbeat, SculptureId};
use paros_outbox_link::{BoothAddress, HttpsLink, LinkTimes};
use paros_shell::outbox::{
    BoothLink, BoothRequest, HttpAnswer, LinkAnswer, LinkFault, SentRequest,
};
use rcgen::{BasicConstraints, CertificateParams, IsCa, Issuer, KeyPair};
use rustls::crypto::ring::default_provider;
use rustls::pki_types::PrivateKeyDer;
use rustls::{ServerConfig, ServerConnection, StreamOwned};

const TIMES: LinkTimes =
    LinkTimes { put: Duration::from_secs(20), heartbeat: Duration::from_millis(1500) };

/// A server's address, its authority's certificate, and the requests that it has read.
struct Server {
    address: SocketAddr,
    ca: Vec<u8>,
    requests: Receiver<String>,
}

impl Server {
    /// One that answers every request so; `None` never.
    fn start(answer: Option<&'static [u8]>) -> Self {
        let ca_key = KeyPair::generate().expect("a key");
        let mut params = CertificateParams::default();
        params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
        let ca = params.self_signed(&ca_key).expect("a certificate");
        let leaf_key = KeyPair::generate().expect("a key");
        let leaf = CertificateParams::new(["127.0.0.1".to_owned()]).expect("an address");
        let leaf = leaf.signed_by(&leaf_key, &Issuer::new(params, &ca_key)).expect("a leaf");
        let key = PrivateKeyDer::try_from(leaf_key.serialize_der()).expect("a key");
        let config = ServerConfig::builder_with_provider(default_provider().into())
            .with_safe_default_protocol_versions()
            .expect("TLS 1.3")
            .with_no_client_auth()
            .with_single_cert(vec![leaf.der().clone()], key)
            .expect("a leaf and its key");
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
        let address = listener.local_addr().expect("it is bound");
        let (tell, requests) = channel();
        let config = Arc::new(config);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (config, tell) = (config.clone(), tell.clone());
                // One that ends early is what some tests are about.
                thread::spawn(move || serve(stream, config, answer, |head| _ = tell.send(head)));
            }
        });
        Server { address, ca: ca.der().to_vec(), requests }
    }

    fn link(&self) -> HttpsLink {
        self.link_by(&self.ca)
    }

    fn link_by(&self, ca: &[u8]) -> HttpsLink {
        let url = format!("https://{}", self.address);
        let token = DeviceToken([0xab; 32]);
        HttpsLink::open(&BoothAddress { url, ca: ca.to_vec(), token }, TIMES)
    }
}

fn serve(
    stream: TcpStream,
    config: Arc<ServerConfig>,
    answer: Option<&'static [u8]>,
    tell: impl Fn(String),
) -> io::Result<()> {
    let connection = ServerConnection::new(config).map_err(io::Error::other)?;
    let mut stream = StreamOwned::new(connection, stream);
    loop {
        let mut bytes = Vec::new();
        while !bytes.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte)?;
            bytes.push(byte[0]);
        }
        let head = String::from_utf8_lossy(&bytes).to_lowercase();
        let length = head.lines().find_map(|line| line.strip_prefix("content-length: "));
        let mut body = vec![0; length.map_or(0, |length| length.parse().expect("a number"))];
        stream.read_exact(&mut body)?;
        tell(format!("{head}{}", String::from_utf8_lossy(&body)));
        match answer {
            Some(answer) => stream.write_all(answer).and_then(|()| stream.flush())?,
            None => thread::sleep(Duration::from_secs(60)),
        }
    }
}

fn put() -> BoothRequest {
    BoothRequest::Put {
        number: 7,
        id: SculptureId([0x1f; 16]),
        hash: ContentHash([0x2e; 32]),
        parcel_bytes: 99,
        offset: 40,
        part: b"a part".to_vec(),
    }
}

fn heartbeat() -> BoothRequest {
    BoothRequest::Heartbeat { number: 8, body: Box::new([b'h'; Heartbeat::BYTES]) }
}

fn ask(link: &mut HttpsLink, request: BoothRequest) -> LinkAnswer {
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

#[test]
fn requests_and_answers_are_as_the_booth_has_them() {
    let server =
        Server::start(Some(b"HTTP/1.1 429 x\r\nRetry-After: 17\r\nContent-Length: 4\r\n\r\nbusy"));
    let mut link = server.link();
    let answer = ask(&mut link, put());
    let expected = HttpAnswer { status: 429, retry_after: Some(17), body: b"busy".to_vec() };
    let request = SentRequest::Put { number: 7 };
    assert_eq!(answer, LinkAnswer { request, result: Ok(expected) });
    let sent = server.requests.recv().expect("a request");
    let path = format!("put /v1/sculptures/{}?offset=40 http/1.1\r\n", "1f".repeat(16));
    assert!(sent.starts_with(&path), "{sent}");
    let headers = [
        format!("authorization: bearer {}", "ab".repeat(32)),
        format!("x-parcel-hash: {}", "2e".repeat(32)),
        "x-parcel-bytes: 99".into(),
        "content-type: application/octet-stream".into(),
        "content-length: 6".into(),
    ];
    for header in headers {
        assert!(sent.contains(&format!("\r\n{header}\r\n")), "{header}: {sent}");
    }
    assert!(sent.ends_with("\r\n\r\na part"), "{sent}");
    assert_eq!(ask(&mut link, heartbeat()).request, SentRequest::Heartbeat { number: 8 });
    let sent = server.requests.recv().expect("a request");
    assert!(sent.starts_with("post /v1/heartbeat http/1.1\r\n"), "{sent}");
    assert!(sent.ends_with(&"h".repeat(Heartbeat::BYTES)), "{sent}");
}

#[test]
fn who_has_another_authority_is_not_the_booth() {
    let server = Server::start(Some(b"HTTP/1.1 200 x\r\nContent-Length: 0\r\n\r\n"));
    let other = Server::start(None);
    assert_eq!(ask(&mut server.link_by(&other.ca), put()).result, Err(LinkFault::Untrusted));
    assert!(ask(&mut server.link(), put()).result.is_ok());
    let mut nothing = server.link_by(b"no certificate");
    assert_eq!(ask(&mut nothing, put()).result, Err(LinkFault::Untrusted));
    // The token went to the right one alone.
    assert_eq!(server.requests.try_iter().count(), 1);
}

#[test]
fn nobody_and_silence_are_faults_and_a_part_holds_up_no_heartbeat() {
    let silent = Server::start(None);
    let mut link = silent.link();
    link.send(put());
    assert_eq!(ask(&mut link, heartbeat()).result, Err(LinkFault::TimedOut));
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let address = listener.local_addr().expect("it is bound");
    drop(listener);
    let nobody = Server { address, ..silent };
    assert_eq!(ask(&mut nobody.link(), put()).result, Err(LinkFault::Unreachable));
    // What isn't encrypted isn't asked.
    let plain = BoothAddress {
        url: format!("http://{address}"),
        ca: nobody.ca.clone(),
        token: DeviceToken([1; 32]),
    };
    assert!(ask(&mut HttpsLink::open(&plain, TIMES), put()).result.is_err());
}

#[test]
fn redirects_are_not_followed_and_long_bodies_not_read() {
    let away = b"HTTP/1.1 307 x\r\nLocation: https://127.0.0.1:9/\r\nContent-Length: 0\r\n\r\n";
    let server = Server::start(Some(away));
    let answer = ask(&mut server.link(), put());
    // Either way the token stays here.
    assert!(answer.result.is_err() || answer.result.is_ok_and(|answer| answer.status == 307));
    let long = b"HTTP/1.1 200 x\r\nContent-Length: 100000000\r\n\r\n";
    let answer = [&long[..], &[b'x'; 20_000]].concat().leak();
    let server = Server::start(Some(answer));
    assert_eq!(ask(&mut server.link(), put()).result, Err(LinkFault::Unreachable));
}
