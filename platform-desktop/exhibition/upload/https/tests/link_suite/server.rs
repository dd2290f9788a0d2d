//! A TLS server that answers every request in the same way.

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

use rcgen::{BasicConstraints, CertificateParams, IsCa, Issuer, KeyPair};
use rustls::crypto::ring::default_provider;
use rustls::pki_types::PrivateKeyDer;
use rustls::{ServerConfig, ServerConnection, StreamOwned};

/// The answer to a request.
#[derive(Clone, Copy)]
pub(crate) enum Answer {
    /// These bytes.
    Bytes(&'static [u8]),
    /// A body of this many bytes.
    Long(usize),
    /// No answer.
    Never,
    /// An endless head, one byte every tenth of a second.
    Drip,
}

/// A server: its address, its authority's certificate, the requests that it has read, and the number of bytes
/// of long answers that clients took.
pub(crate) struct Server {
    pub(crate) address: SocketAddr,
    pub(crate) ca: Vec<u8>,
    pub(crate) requests: Receiver<String>,
    pub(crate) sent: Receiver<usize>,
}

type Stream = StreamOwned<ServerConnection, TcpStream>;

impl Server {
    /// Starts a server whose certificate matches its address.
    pub(crate) fn start(answer: Answer) -> Self {
        Server::start_as("127.0.0.1", answer)
    }

    /// Starts a server whose certificate is for this address.
    pub(crate) fn start_as(name: &str, answer: Answer) -> Self {
        let ca_key = KeyPair::generate().expect("a key");
        let mut params = CertificateParams::default();
        params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
        let ca = params.self_signed(&ca_key).expect("a certificate");
        let leaf_key = KeyPair::generate().expect("a key");
        let leaf = CertificateParams::new([name.to_owned()]).expect("an address");
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
        let (tell_sent, sent) = channel();
        let config = Arc::new(config);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let (config, tell, tell_sent) = (config.clone(), tell.clone(), tell_sent.clone());
                // Some tests end the connection early.
                thread::spawn(move || serve(stream, config, answer, &tell, &tell_sent));
            }
        });
        Server { address, ca: ca.der().to_vec(), requests, sent }
    }
}

fn serve(
    stream: TcpStream,
    config: Arc<ServerConfig>,
    answer: Answer,
    tell: &Sender<String>,
    tell_sent: &Sender<usize>,
) -> io::Result<()> {
    let connection = ServerConnection::new(config).map_err(io::Error::other)?;
    let mut stream = StreamOwned::new(connection, stream);
    loop {
        // The test may not read the requests.
        let _ = tell.send(read_request(&mut stream)?);
        match answer {
            Answer::Bytes(bytes) => stream.write_all(bytes).and_then(|()| stream.flush())?,
            Answer::Long(bytes) => {
                let _ = tell_sent.send(write_long(&mut stream, bytes));
            }
            Answer::Never => thread::sleep(Duration::from_secs(60)),
            Answer::Drip => drip(&mut stream)?,
        }
    }
}

/// Reads a request: its head in lower case, and its body.
fn read_request(stream: &mut Stream) -> io::Result<String> {
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
    Ok(format!("{head}{}", String::from_utf8_lossy(&body)))
}

/// Writes a long answer until the client takes no more. Returns the number of bytes written. Pauses now and
/// then, as a client that closes a connection may first take the data that has arrived.
fn write_long(stream: &mut Stream, bytes: usize) -> usize {
    let head = format!("HTTP/1.1 200 x\r\nContent-Length: {bytes}\r\n\r\n");
    let mut sent = 0;
    let mut written = stream.write_all(head.as_bytes());
    while written.is_ok() && sent < bytes {
        let piece = [b'x'; 16 << 10];
        written = stream.write_all(&piece).and_then(|()| stream.flush());
        sent += piece.len();
        if sent.is_multiple_of(256 << 10) {
            thread::sleep(Duration::from_millis(10));
        }
    }
    sent
}

fn drip(stream: &mut Stream) -> io::Result<()> {
    stream.write_all(b"HTTP/1.1 200 x\r\nX-Never-Ends: ")?;
    loop {
        stream.write_all(b"x")?;
        stream.flush()?;
        thread::sleep(Duration::from_millis(100));
    }
}
