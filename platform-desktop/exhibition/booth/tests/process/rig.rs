//! A booth process, and headsets that connect to it by HTTPS.

use std::fs::{self, File};
use std::io::{self, BufRead as _, BufReader};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::Duration;

use paros_protocol::ContentHash;
use paros_protocol::*;
use tokio_rustls::rustls::client::Resumption;
use tokio_rustls::rustls::crypto::ring::default_provider;
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName, pem::PemObject as _};
use tokio_rustls::rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

pub(crate) use crate::parcels::{Parcel, deflate, figure, heartbeat};

/// A booth's folder for a test.
pub(crate) struct BoothFolder {
    folder: PathBuf,
    /// The connections to shared services: command-line arguments and environment variables.
    shared: (Vec<String>, Vec<(String, String)>),
}

/// Returns the arguments of a booth that sends its mails to a server without TLS.
pub(crate) const fn mail_arguments(server: &str) -> [&str; 6] {
    ["--smtp", server, "--smtp-tls", "none", "--mail-from", "booth@example.org"]
}

impl BoothFolder {
    /// Makes an empty folder.
    pub(crate) fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("room on the disk");
        BoothFolder { folder, shared: Default::default() }
    }

    /// Adds arguments and environment variables, for a booth that shares its database and files with others.
    pub(crate) fn sharing(mut self, arguments: &[&str], settings: Vec<(String, String)>) -> Self {
        self.shared = (arguments.iter().map(|&text| text.to_owned()).collect(), settings);
        self
    }

    /// Makes a command of the program with this folder.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_paros-booth"));
        command.args(arguments).arg("--folder").arg(self.path());
        // Tests count hours in UTC.
        command.env("TZ", "UTC");
        command.args(&self.shared.0).envs(self.shared.1.iter().cloned());
        command
    }

    pub(crate) fn path(&self) -> PathBuf {
        self.folder.join("data")
    }

    /// Starts a booth in the folder, and waits until it accepts connections.
    pub(crate) fn start(&self) -> BoothProcess {
        self.start_with(&[])
    }

    pub(crate) fn start_with(&self, arguments: &[&str]) -> BoothProcess {
        let log = File::options().append(true).create(true).open(self.folder.join("log")).unwrap();
        let mut process = self
            .command(&["--listen", "127.0.0.1:0"])
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .expect("the program");
        let mut lines = BufReader::new(process.stdout.take().expect("a pipe")).lines();
        let mut line = || lines.next().expect("a line").expect("text");
        let address = line();
        let address = address.strip_prefix("https://").expect("an address").parse().unwrap();
        let fingerprint = line().rsplit(' ').next().expect("a word").to_owned();
        let ca = fs::read(self.path().join("keys/ca.pem")).expect("it was made");
        let ca = CertificateDer::from_pem_slice(&ca).expect("PEM");
        assert_eq!(fingerprint, ContentHash::of(&ca).to_string());
        // Without an account, the booth prints another line.
        let database = self.path().join("booth.sqlite");
        let accounts: u32 = if database.exists() {
            let database = rusqlite::Connection::open(database).unwrap();
            database.query_row("SELECT count(*) FROM accounts", [], |row| row.get(0)).unwrap()
        } else {
            0
        };
        let first = (accounts == 0).then(line);
        let first_code = first.and_then(|line| Some(line.rsplit(' ').next()?.to_owned()));
        BoothProcess { process, first_code, client: Client::new(address, ca) }
    }

    /// Runs one of the program's commands.
    pub(crate) fn run(&self, arguments: &[&str]) -> Result<String, String> {
        let done = self.command(arguments).output().expect("the program");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
        if done.status.success() { Ok(text(done.stdout)) } else { Err(text(done.stderr)) }
    }

    /// Makes an enrolment token.
    pub(crate) fn fleet_token(&self) -> EnrolmentToken {
        let file = self
            .run(&["fleet-file", "--address", "https://booth.test:8443", "--uses", "300"])
            .expect("made");
        let line = file.lines().find_map(|line| line.strip_prefix("enrolment_token = \""));
        EnrolmentToken::parse_hex(line.expect("a token").trim_end_matches('"')).expect("a token")
    }

    pub(crate) fn log(&self) -> String {
        fs::read_to_string(self.folder.join("log")).expect("a log")
    }

    /// Lists the names of the files in a subfolder.
    pub(crate) fn files(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path().join(folder)).expect("a folder");
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }
}

/// A running booth. It is killed on drop.
pub(crate) struct BoothProcess {
    process: Child,
    first_code: Option<String>,
    pub(crate) client: Client,
}

impl BoothProcess {
    pub(crate) fn id(&self) -> u32 {
        self.process.id()
    }

    /// Waits for the process' end, after it was killed.
    pub(crate) fn wait(&mut self) {
        self.process.wait().expect("it ends");
    }

    /// Sends SIGTERM, waits for the end, and returns the exit code.
    pub(crate) fn terminate(&mut self) -> Option<i32> {
        let told = Command::new("kill").args(["-TERM", &self.process.id().to_string()]).status();
        assert!(told.expect("kill").success());
        self.process.wait().expect("it ends").code()
    }

    /// Returns the code for the first account, if the booth printed one.
    pub(crate) fn first_code(&self) -> Option<String> {
        self.first_code.clone()
    }

    /// Returns the process' peak memory in bytes.
    pub(crate) fn peak_memory(&self) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.process.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("a line");
        1024 * line.trim().trim_end_matches(" kB").parse::<u64>().expect("a number")
    }
}

impl Drop for BoothProcess {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A client of the booth.
#[derive(Clone)]
pub(crate) struct Client {
    pub(crate) address: SocketAddr,
    config: Arc<ClientConfig>,
    /// The address from which the client connects; any address if it is unspecified.
    source: Ipv4Addr,
}

/// A response of the booth.
#[derive(Debug)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) head: String,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    pub(crate) fn text(&self) -> &str {
        str::from_utf8(&self.body).expect("text")
    }
}

impl Client {
    pub(crate) fn new(address: SocketAddr, ca: CertificateDer<'static>) -> Self {
        let mut roots = RootCertStore::empty();
        roots.add(ca).expect("a certificate");
        let mut config = ClientConfig::builder_with_provider(default_provider().into())
            .with_safe_default_protocol_versions()
            .expect("TLS 1.3")
            .with_root_certificates(roots)
            .with_no_client_auth();
        // A resumed session doesn't contain the current certificate.
        config.resumption = Resumption::disabled();
        Client { address, config: Arc::new(config), source: Ipv4Addr::UNSPECIFIED }
    }

    /// Makes the same client at a local address, such as 127.0.0.2.
    pub(crate) fn at_address(&self, source: Ipv4Addr) -> Self {
        Client { source, ..self.clone() }
    }

    /// Opens a connection without TLS.
    pub(crate) fn connect_plain(&self) -> io::Result<TcpStream> {
        if self.source.is_unspecified() {
            return TcpStream::connect(self.address);
        }
        let runtime = tokio::runtime::Builder::new_current_thread().enable_io().build()?;
        let socket = tokio::net::TcpSocket::new_v4()?;
        socket.bind((self.source, 0).into())?;
        let stream = runtime.block_on(socket.connect(self.address))?.into_std()?;
        stream.set_nonblocking(false)?;
        Ok(stream)
    }

    /// Opens a TLS connection that trusts only the booth's authority.
    pub(crate) fn connect(&self) -> io::Result<StreamOwned<ClientConnection, TcpStream>> {
        self.connect_as(ServerName::IpAddress(self.address.ip().into()))
    }

    /// Opens a TLS connection by a server name.
    pub(crate) fn connect_as(
        &self,
        name: ServerName<'static>,
    ) -> io::Result<StreamOwned<ClientConnection, TcpStream>> {
        let stream = self.connect_plain()?;
        stream.set_read_timeout(Some(Duration::from_secs(40)))?;
        stream.set_nodelay(true)?;
        let connection =
            ClientConnection::new(self.config.clone(), name).map_err(io::Error::other)?;
        Ok(StreamOwned::new(connection, stream))
    }

    /// Sends one request on its own connection.
    pub(crate) fn ask(
        &self,
        method: &str,
        path: &str,
        headers: &[(&str, String)],
        body: &[u8],
    ) -> io::Result<Answer> {
        let mut stream = self.connect()?;
        write_request(&mut stream, method, path, headers, body)?;
        read_answer(&mut stream)
    }

    pub(crate) fn get(&self, path: &str) -> Answer {
        self.ask("GET", path, &[], &[]).expect("an answer")
    }

    pub(crate) fn post(&self, path: &str, body: &[u8]) -> Answer {
        self.ask("POST", path, &[], body).expect("an answer")
    }

    /// Reads a metric of the booth.
    pub(crate) fn metric(&self, name: &str) -> u64 {
        let text = self.get("/metrics");
        let value = text.text().lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        value.expect("it is measured").parse().expect("a number")
    }
}

pub(crate) fn write_request(
    stream: &mut impl io::Write,
    method: &str,
    path: &str,
    headers: &[(&str, String)],
    body: &[u8],
) -> io::Result<()> {
    let mut head = format!("{method} {path} HTTP/1.1\r\nHost: booth\r\n");
    for (name, value) in headers {
        head += &format!("{name}: {value}\r\n");
    }
    if !headers.iter().any(|(name, _)| *name == "Content-Length") {
        head += &format!("Content-Length: {}\r\n", body.len());
    }
    let mut request = (head + "\r\n").into_bytes();
    request.extend(body);
    stream.write_all(&request)?;
    stream.flush()
}

pub(crate) fn read_answer(stream: &mut impl io::Read) -> io::Result<Answer> {
    let head = read_head(stream)?;
    read_body(head, stream)
}

/// Reads the head of a response, in lower case.
pub(crate) fn read_head(stream: &mut impl io::Read) -> io::Result<String> {
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte)?;
        head.extend(byte);
    }
    Ok(String::from_utf8(head).map_err(io::Error::other)?.to_lowercase())
}

/// Reads the rest of a response whose head was read.
pub(crate) fn read_body(head: String, stream: &mut impl io::Read) -> io::Result<Answer> {
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok());
    let length = head.split("content-length: ").nth(1).and_then(|rest| rest.lines().next());
    let length = length.map_or(0, |length| length.parse().expect("a length"));
    let mut body = vec![0; length];
    stream.read_exact(&mut body)?;
    if head.contains("transfer-encoding: chunked") {
        // The chunk lengths stay in the body. Tests that search for words ignore them.
        while !body.ends_with(b"\r\n0\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte)?;
            body.extend(byte);
        }
    }
    Ok(Answer { status: status.expect("a status"), head, body })
}

/// An enrolled headset.
#[derive(Clone)]
pub(crate) struct Headset {
    pub(crate) token: DeviceToken,
    pub(crate) number: u32,
}

impl Headset {
    /// Enrols by an enrolment token.
    pub(crate) fn enrol(client: &Client, fleet: EnrolmentToken, byte: u8) -> Self {
        let token = DeviceToken([byte; 32]);
        let asked = FleetEnrolment {
            enrolment_token: fleet,
            token_hash: ContentHash::of(&token.0),
            hint: DeviceHint([byte; 16]),
            name: DeviceName::new("Quest").expect("a name"),
        };
        let answer = client.post("/v1/enrol/fleet", &asked.to_json());
        assert_eq!(answer.status, 200, "{answer:?}");
        let EnrolAnswer { headset, .. } = EnrolAnswer::from_json(&answer.body).expect("a message");
        Headset { token, number: headset }
    }

    pub(crate) fn bearer(&self) -> (&'static str, String) {
        ("Authorization", format!("Bearer {}", self.token.reveal()))
    }

    /// Sends a parcel. Returns its outcome, or the response that refuses it.
    pub(crate) fn upload(
        &self,
        client: &Client,
        parcel: &Parcel,
    ) -> io::Result<Result<ParcelOutcome, Answer>> {
        let answer = client.ask("PUT", &path_of(parcel), &[self.bearer()], &parcel.file())?;
        Ok(ParcelOutcome::of_answer(answer.status, &answer.body).ok_or(answer))
    }
}

/// Returns the path to which a parcel is sent.
pub(crate) fn path_of(parcel: &Parcel) -> String {
    format!("{PARCEL_PATH}{}", parcel.facts.id)
}
