//! A mail server that stores the mails it receives. It supports a subset of SMTP (RFC 5321), its logins (RFC
//! 4954) and STARTTLS (RFC 3207).

use std::io::{self, BufRead as _, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use rcgen::{BasicConstraints, CertificateParams, IsCa, Issuer, KeyPair};
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::PrivateKeyDer;
use tokio_rustls::rustls::{ServerConfig, ServerConnection, StreamOwned};

/// A received mail.
#[derive(Clone, Debug)]
pub(crate) struct Mail {
    pub(crate) from: String,
    pub(crate) to: Vec<String>,
    /// The head and the body, with `\n` between lines.
    pub(crate) text: String,
}

/// The encryption of a server.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum SinkTls {
    /// No encryption.
    None,
    /// STARTTLS.
    Starttls,
    /// TLS from the first byte.
    Implicit,
}

/// The accepted login: user name, password, and the SASL mechanism.
pub(crate) type SinkLogin = (&'static str, &'static str, &'static str);

/// A server on its own port. A recipient that begins with `later` gets 451, one with `nobody` 550.
pub(crate) struct SmtpSink {
    pub(crate) address: SocketAddr,
    /// The authority that verifies the server's certificate.
    pub(crate) ca_pem: String,
    heard: Arc<Mutex<Heard>>,
}

/// Everything that a server received.
#[derive(Clone, Default)]
pub(crate) struct Heard {
    pub(crate) mails: Vec<Mail>,
    /// Recipients that were refused.
    pub(crate) refused: Vec<String>,
    /// Lines that were received without TLS.
    pub(crate) in_clear: Vec<String>,
    /// User names and passwords that were received, right or wrong.
    pub(crate) logins: Vec<String>,
}

trait Duplex: Read + Write + Send {}

impl<T: Read + Write + Send> Duplex for T {}

type Stream = BufReader<Box<dyn Duplex>>;

/// The configuration of a server.
struct Plan {
    tls: SinkTls,
    login: Option<SinkLogin>,
    config: Arc<ServerConfig>,
    heard: Arc<Mutex<Heard>>,
}

impl SmtpSink {
    pub(crate) fn start() -> Self {
        Self::start_with(SinkTls::None, None)
    }

    pub(crate) fn start_with(tls: SinkTls, login: Option<SinkLogin>) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let (config, ca_pem) = make_certificate();
        let heard: Arc<Mutex<Heard>> = Arc::default();
        let sink = SmtpSink {
            address: listener.local_addr().expect("a port"),
            ca_pem,
            heard: heard.clone(),
        };
        let plan = Arc::new(Plan { tls, login, config, heard });
        // The thread ends with the tests.
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let plan = plan.clone();
                // An error means that the client hung up.
                thread::spawn(move || plan.serve(stream));
            }
        });
        sink
    }

    /// Waits for `count` mails. Returns all mails.
    pub(crate) fn wait_for(&self, count: usize) -> Vec<Mail> {
        wait_until(|| Some(self.mails()).filter(|mails| mails.len() >= count))
    }

    pub(crate) fn mails(&self) -> Vec<Mail> {
        self.heard().mails
    }

    /// Returns the recipients that were refused.
    pub(crate) fn refused(&self) -> Vec<String> {
        self.heard().refused
    }

    /// Returns everything that was received.
    pub(crate) fn heard(&self) -> Heard {
        self.heard.lock().unwrap().clone()
    }
}

/// Polls until `look` returns something.
pub(crate) fn wait_until<T>(mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < Duration::from_secs(300), "it doesn't come");
        thread::sleep(Duration::from_millis(50));
    }
}

/// Makes a TLS configuration with a new authority. Returns it with the authority's certificate.
fn make_certificate() -> (Arc<ServerConfig>, String) {
    let mut params = CertificateParams::new(Vec::new()).expect("no name");
    params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
    let ca_key = KeyPair::generate().expect("a key");
    let ca_pem = params.self_signed(&ca_key).expect("a certificate").pem();
    let issuer = Issuer::new(params, ca_key);
    let key = KeyPair::generate().expect("a key");
    let params = CertificateParams::new(["127.0.0.1".to_owned()]).expect("a name");
    let leaf = params.signed_by(&key, &issuer).expect("a certificate");
    let key = PrivateKeyDer::try_from(key.serialize_der()).expect("a key");
    let config = ServerConfig::builder_with_provider(default_provider().into())
        .with_safe_default_protocol_versions()
        .expect("versions")
        .with_no_client_auth()
        .with_single_cert(vec![leaf.der().clone()], key)
        .expect("a certificate and its key");
    (Arc::new(config), ca_pem)
}

impl Plan {
    fn heard(&self) -> MutexGuard<'_, Heard> {
        self.heard.lock().unwrap()
    }

    fn wrap(&self, stream: Box<dyn Duplex>) -> Box<dyn Duplex> {
        let connection = ServerConnection::new(self.config.clone()).expect("a server");
        Box::new(StreamOwned::new(connection, stream))
    }

    fn serve(&self, stream: TcpStream) -> io::Result<()> {
        let mut is_secure = self.tls == SinkTls::Implicit;
        let stream: Box<dyn Duplex> = Box::new(stream);
        let mut stream = BufReader::new(if is_secure { self.wrap(stream) } else { stream });
        let mut mail = Mail { from: String::new(), to: Vec::new(), text: String::new() };
        let mut is_known = self.login.is_none();
        say(&mut stream, "220 sink")?;
        while let Some(line) = read_line(&mut stream)? {
            if !is_secure {
                self.heard().in_clear.push(line.clone());
            }
            let (word, rest) = line.split_at(line.len().min(4));
            match word.to_ascii_uppercase().as_str() {
                "EHLO" => {
                    if self.tls == SinkTls::Starttls && !is_secure {
                        say(&mut stream, "250-sink\r\n250-STARTTLS")?;
                    } else {
                        say(&mut stream, "250-sink")?;
                    }
                    if let Some((_, _, how)) = self.login {
                        // Also without TLS, to test that the booth doesn't log in then.
                        say(&mut stream, &format!("250-AUTH {how}"))?;
                    }
                    say(&mut stream, "250 8BITMIME")?;
                }
                "STAR" => {
                    say(&mut stream, "220 go on")?;
                    assert!(stream.buffer().is_empty(), "words before TLS");
                    stream = BufReader::new(self.wrap(stream.into_inner()));
                    is_secure = true;
                }
                "AUTH" => {
                    is_known = self.log_in(&mut stream, rest.trim())?;
                    let said = if is_known { "235 yes" } else { "535 no" };
                    say(&mut stream, said)?;
                }
                "QUIT" => return say(&mut stream, "221 bye"),
                "MAIL" | "RCPT" | "DATA" if !is_known => say(&mut stream, "530 who?")?,
                _ => self.take_mail(&mut stream, &mut mail, (word, rest))?,
            }
        }
        Ok(())
    }

    /// Returns `true` if the login is right. Supports two mechanisms, PLAIN and LOGIN.
    fn log_in(&self, stream: &mut Stream, words: &str) -> io::Result<bool> {
        let Some((name, password, how)) = self.login else { return Ok(false) };
        let (way, first) = words.split_once(' ').unwrap_or((words, ""));
        let mut ask = |prompt: &str| {
            say(stream, &format!("334 {}", BASE64.encode(prompt)))?;
            Ok::<_, io::Error>(decode(&read_line(stream)?.unwrap_or_default()))
        };
        let said = match way {
            "PLAIN" => decode(first),
            "LOGIN" => format!("\0{}\0{}", ask("Username:")?, ask("Password:")?),
            _ => return Ok(false),
        };
        self.heard().logins.push(said.clone());
        Ok(way == how && said == format!("\0{name}\0{password}"))
    }

    fn take_mail(
        &self,
        stream: &mut Stream,
        mail: &mut Mail,
        (word, rest): (&str, &str),
    ) -> io::Result<()> {
        match word.to_ascii_uppercase().as_str() {
            "MAIL" => rest.clone_into(&mut mail.from),
            "RCPT" if rest.contains("<later") || rest.contains("<nobody") => {
                self.heard().refused.push(rest.to_owned());
                let code = if rest.contains("<later") { 451 } else { 550 };
                // Real servers repeat the recipient in the refusal.
                return say(stream, &format!("{code} no{rest}"));
            }
            "RCPT" => mail.to.push(rest.to_owned()),
            "DATA" => {
                say(stream, "354 go on")?;
                while let Some(line) = read_line(stream)?.filter(|line| line != ".") {
                    mail.text.push_str(line.strip_prefix('.').unwrap_or(&line));
                    mail.text.push('\n');
                }
                let empty = Mail { from: String::new(), to: Vec::new(), text: String::new() };
                self.heard().mails.push(std::mem::replace(mail, empty));
            }
            _ => {}
        }
        say(stream, "250 yes")
    }
}

fn say(stream: &mut Stream, line: &str) -> io::Result<()> {
    let stream = stream.get_mut();
    stream.write_all(format!("{line}\r\n").as_bytes())?;
    stream.flush()
}

/// Reads a line without its end; `None` at the end of the stream.
fn read_line(stream: &mut Stream) -> io::Result<Option<String>> {
    let mut line = String::new();
    let count = stream.read_line(&mut line)?;
    Ok((count > 0).then(|| line.trim_end_matches(['\r', '\n']).to_owned()))
}

fn decode(letters: &str) -> String {
    String::from_utf8_lossy(&BASE64.decode(letters).unwrap_or_default()).into_owned()
}
