//! Tests of signals, and of other processes, while the booth serves.

use std::net::TcpListener;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use tokio_rustls::rustls::pki_types::CertificateDer;

use crate::rig::{BoothFolder, BoothProcess, Client, read_answer, write_request};

/// Tries to serve a folder that is being served.
fn start_second(folder: &BoothFolder) -> Output {
    let mut second = Command::new(env!("CARGO_BIN_EXE_paros-booth"));
    second.args(["--listen", "127.0.0.1:0", "--folder"]).arg(folder.path());
    second.output().expect("the program")
}

#[test]
fn a_second_one_in_a_folder_is_refused_until_the_first_has_ended() {
    let folder = BoothFolder::new("second");
    let mut booth = folder.start();
    let second = start_second(&folder);
    let told = String::from_utf8(second.stderr).expect("text");
    assert_eq!(second.status.code(), Some(2), "{told}");
    assert!(second.stdout.is_empty());
    let path = folder.path();
    let expected = format!("paros-booth: {}: another booth runs in this folder", path.display());
    assert!(told.starts_with(&expected), "{told}");
    assert_eq!(booth.client.get("/healthz").status, 200);
    folder.fleet_token();
    // The lock is released even if the process is killed.
    let killed = Command::new("kill").args(["-KILL", &booth.id().to_string()]).status();
    assert!(killed.expect("kill").success());
    booth.wait();
    let booth = folder.start();
    assert_eq!(booth.client.get("/healthz").status, 200);
}

#[test]
fn a_port_that_is_in_use_leaves_nothing_behind() {
    let folder = BoothFolder::new("port-in-use");
    let taken = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("an address").to_string();
    for arguments in [
        &["--listen", &address] as &[&str],
        &["--listen", "127.0.0.1:0", "--public-listen", &address, "--public-url", "http://x"],
        &["--demo", "--listen", &address],
    ] {
        let mut booth = Command::new(env!("CARGO_BIN_EXE_paros-booth"));
        booth.args(arguments).env("TMPDIR", folder.path().parent().expect("a folder"));
        if !arguments.contains(&"--demo") {
            booth.arg("--folder").arg(folder.path());
        }
        let told = booth.output().expect("the program");
        let errors = String::from_utf8(told.stderr).expect("text");
        assert_eq!(told.status.code(), Some(1), "{errors}");
        assert!(errors.contains(&format!("listen {address}: ")), "{errors}");
        assert!(told.stdout.is_empty(), "no address is told");
        let left = std::fs::read_dir(folder.path().parent().expect("a folder")).unwrap();
        assert_eq!(left.count(), 0, "{arguments:?}");
    }
}

/// Sends SIGHUP, so that the booth loads its certificates again.
fn hang_up(booth: &BoothProcess) {
    let told = Command::new("kill").args(["-HUP", &booth.id().to_string()]).status();
    assert!(told.expect("kill").success());
}

/// Returns the certificate of a new connection.
fn leaf(client: &Client) -> CertificateDer<'static> {
    let mut stream = client.connect().expect("a connection");
    write_request(&mut stream, "GET", "/healthz", &[], &[]).expect("it is open");
    assert_eq!(read_answer(&mut stream).expect("an answer").status, 200);
    stream.conn.peer_certificates().expect("TLS")[0].clone().into_owned()
}

#[test]
fn a_new_certificate_is_shown_without_a_restart() {
    let folder = BoothFolder::new("leaf");
    let booth = folder.start();
    let client = &booth.client;
    let mut stays = client.connect().expect("a connection");
    write_request(&mut stays, "GET", "/healthz", &[], &[]).expect("it is open");
    read_answer(&mut stays).expect("an answer");
    let first = leaf(client);
    assert_eq!(leaf(client), first, "one for all");
    hang_up(&booth);
    let start = Instant::now();
    while leaf(client) == first {
        assert!(start.elapsed() < Duration::from_secs(30), "the old one is shown still");
        std::thread::sleep(Duration::from_millis(20));
    }
    write_request(&mut stays, "GET", "/healthz", &[], &[]).expect("it is open still");
    assert_eq!(read_answer(&mut stays).expect("an answer").status, 200);
}

/// Browsers that connect by its name get the staff's certificate. Headsets, which trust only the booth's
/// authority, connect by the address.
#[test]
fn a_certificate_of_staff_is_for_its_name_alone() {
    let folder = BoothFolder::new("staff-cert");
    let key = rcgen::KeyPair::generate().expect("a key");
    let params = rcgen::CertificateParams::new(vec!["booth.example".to_owned()]).expect("a name");
    let certificate = params.self_signed(&key).expect("a certificate");
    let at = |name: &str| folder.path().with_file_name(name).display().to_string();
    let (cert_at, key_at, other_at) = (at("cert.pem"), at("key.pem"), at("other.pem"));
    std::fs::write(&cert_at, certificate.pem()).unwrap();
    std::fs::write(&key_at, key.serialize_pem()).unwrap();
    std::fs::write(&other_at, rcgen::KeyPair::generate().expect("a key").serialize_pem()).unwrap();
    let booth = folder.start_with(&["--staff-cert", &cert_at, "--staff-key", &key_at]);
    assert_eq!(booth.client.get("/healthz").status, 200);
    let browser = Client::new(booth.client.address, certificate.der().clone());
    let health = |client: &Client, name: &str| {
        let name = name.to_owned().try_into().expect("a name");
        let mut stream = client.connect_as(name)?;
        write_request(&mut stream, "GET", "/healthz", &[], &[])?;
        read_answer(&mut stream).map(|answer| answer.status)
    };
    assert_eq!(health(&browser, "booth.example").expect("an answer"), 200);
    assert!(health(&browser, "localhost").is_err(), "another name has the booth's own");
    assert_eq!(health(&booth.client, "localhost").expect("an answer"), 200);
    let next_key = rcgen::KeyPair::generate().expect("a key");
    let next = params.self_signed(&next_key).expect("a certificate");
    std::fs::write(&cert_at, next.pem()).unwrap();
    std::fs::write(&key_at, next_key.serialize_pem()).unwrap();
    hang_up(&booth);
    let browser = Client::new(booth.client.address, next.der().clone());
    let start = Instant::now();
    while health(&browser, "booth.example").is_err() {
        assert!(start.elapsed() < Duration::from_secs(30), "the old one is shown still");
        std::thread::sleep(Duration::from_millis(20));
    }
    drop(booth);
    for (cert, key, told) in [
        (&key_at, &key_at, "expected certificates in PEM"),
        (&cert_at, &cert_at, "expected a private key in PEM"),
        (&cert_at, &other_at, "expected the certificate's key"),
    ] {
        let why =
            folder.run(&["--listen", "127.0.0.1:0", "--staff-cert", cert, "--staff-key", key]);
        let why = why.expect_err("it doesn't start");
        assert!(why.contains(told), "{why}");
    }
}
