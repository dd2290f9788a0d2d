//! A PostgreSQL server for one test: on a Unix socket in a test folder, and on a port with TLS and a
//! password.
#![allow(dead_code)] // each test uses its part of it

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicU16, AtomicU32, Ordering};
use std::sync::mpsc::sync_channel;
use std::time::{Duration, Instant};

use paros_shell::require::require_or_skip;

pub(crate) const PASSWORD: &str = "correct horse";

/// A running server. It is stopped on drop, or when the test's process ends.
pub(crate) struct PostgresServer {
    process: Child,
    folder: PathBuf,
    port: u16,
    schemas: AtomicU32,
}

/// Finds a free port below the system's ephemeral range, so that no other process is assigned it meanwhile.
fn find_port() -> u16 {
    static NEXT: AtomicU16 = AtomicU16::new(0);
    let first = 10_000 + (std::process::id() % 400) as u16 * 20;
    let next = || first + NEXT.fetch_add(1, Ordering::Relaxed);
    let is_free = |port: &u16| TcpListener::bind(("127.0.0.1", *port)).is_ok();
    std::iter::repeat_with(next).find(is_free).expect("a free port")
}

impl PostgresServer {
    /// Starts a server in a new folder. Returns `None` if PostgreSQL isn't installed.
    pub(crate) fn start(name: &str) -> Option<Self> {
        let programs = require_or_skip(find_programs()).expect("PostgreSQL")?;
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("room on the disk");
        fs::write(folder.join("password"), PASSWORD).expect("room on the disk");
        write_certificate(&folder);
        if rustix::process::getuid().is_root() {
            let owned = Command::new("chown").args(["-R", "postgres:"]).arg(&folder).status();
            assert!(owned.expect("chown").success());
        }
        let mut initdb = as_unprivileged(&programs.join("initdb"));
        initdb.args(["--auth-local=trust", "--auth-host=scram-sha-256", "--username=booth"]);
        initdb.args([
            "--no-sync",
            "--no-instructions",
            "--encoding=UTF8",
            "--locale=C",
            "--pgdata",
        ]);
        initdb.arg(folder.join("data")).arg("--pwfile").arg(folder.join("password"));
        let made = initdb.current_dir(&folder).output().expect("initdb");
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let port = find_port();
        let process = spawn_server(&programs, &folder, port);
        let server = PostgresServer { process, folder, port, schemas: AtomicU32::new(0) };
        let start = Instant::now();
        while server.connect().is_err() {
            assert!(start.elapsed() < Duration::from_secs(60), "{}", server.log());
            std::thread::sleep(Duration::from_millis(50));
        }
        Some(server)
    }

    /// Makes a schema without tables, and returns its address.
    pub(crate) fn new_schema(&self) -> String {
        let schema = format!("test_{}", self.schemas.fetch_add(1, Ordering::Relaxed));
        let mut client = self.connect().expect("a connection");
        client.batch_execute(&format!("CREATE SCHEMA {schema}")).expect("a new name");
        self.address_of(&schema)
    }

    /// Returns the address of a schema, over the socket.
    pub(crate) fn address_of(&self, schema: &str) -> String {
        let (folder, port) = (self.folder.display(), self.port);
        format!(
            "postgres://booth@/postgres?host={folder}&port={port}&options=-csearch_path%3D{schema}"
        )
    }

    /// Returns the address over the network with TLS, without a password.
    pub(crate) fn address_by_tls(&self) -> String {
        format!("postgres://booth@localhost:{}/postgres?sslmode=require", self.port)
    }

    /// Returns the certificate file of the authority that signed the server's certificate.
    pub(crate) fn ca_file(&self) -> PathBuf {
        self.folder.join("server.crt")
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    pub(crate) fn connect(&self) -> Result<postgres::Client, postgres::Error> {
        postgres::Client::connect(&self.address_of("public"), postgres::NoTls)
    }

    fn log(&self) -> String {
        fs::read_to_string(self.folder.join("log")).unwrap_or_default()
    }
}

impl Drop for PostgresServer {
    fn drop(&mut self) {
        let _ = Command::new("kill").args(["-INT", &self.process.id().to_string()]).status();
        let _ = self.process.wait();
    }
}

/// Finds the folder of `initdb` and `postgres`. Debian keeps one for each version, outside `PATH`.
fn find_programs() -> Result<PathBuf, String> {
    let versions = fs::read_dir("/usr/lib/postgresql").into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = versions.map(|version| version.path().join("bin")).collect();
    // The newest version first.
    folders.sort();
    folders.reverse();
    let path = std::env::var_os("PATH").unwrap_or_default();
    folders.extend(std::env::split_paths(&path));
    let found = folders.into_iter().find(|folder| folder.join("initdb").exists());
    found.ok_or_else(|| "PostgreSQL's server isn't installed".to_owned())
}

/// Runs a program as an unprivileged user, as PostgreSQL refuses to run as root.
fn as_unprivileged(program: &Path) -> Command {
    let mut command = Command::new("setpriv");
    if rustix::process::getuid().is_root() {
        command.args(["--reuid=postgres", "--regid=postgres", "--clear-groups"]);
    }
    command.args(["--pdeathsig=INT", "--"]).arg(program);
    command
}

/// Starts the server. It ends with the thread that called this, so that thread must last as long as the
/// process.
fn spawn_server(programs: &Path, folder: &Path, port: u16) -> Child {
    let mut server = as_unprivileged(&programs.join("postgres"));
    server.arg("-D").arg(folder.join("data")).arg("-k").arg(folder);
    server.args(["-p", &port.to_string(), "-h", "127.0.0.1"]);
    for (name, value) in [
        ("ssl", "on".to_owned()),
        ("ssl_cert_file", folder.join("server.crt").display().to_string()),
        ("ssl_key_file", folder.join("server.key").display().to_string()),
        // These tests don't cover power cuts.
        ("fsync", "off".to_owned()),
    ] {
        server.args(["-c", &format!("{name}={value}")]);
    }
    let log = fs::File::create(folder.join("log")).expect("room on the disk");
    server.current_dir(folder).stdout(Stdio::null()).stderr(log);
    let (send, spawned) = sync_channel(1);
    std::thread::spawn(move || {
        send.send(server.spawn().expect("postgres")).expect("it is waited for");
        loop {
            std::thread::park();
        }
    });
    spawned.recv().expect("it was started")
}

fn write_certificate(folder: &Path) {
    let made = rcgen::generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
    fs::write(folder.join("server.crt"), made.cert.pem()).expect("room on the disk");
    let key = folder.join("server.key");
    fs::write(&key, made.signing_key.serialize_pem()).expect("room on the disk");
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o600);
    fs::set_permissions(key, mode).expect("its own");
}
