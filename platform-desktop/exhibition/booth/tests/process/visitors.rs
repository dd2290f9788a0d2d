//! Tests of the visitor's page, opened by the QR code of a slip.

use std::fs;
use std::io;
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use paros_core::badge::{BadgeNumber, Language, write_words};
use paros_protocol::*;

use crate::prints::send_form;
use crate::rig::{
    Answer, BoothFolder, BoothProcess, Client, Headset, Parcel, figure, read_answer, write_request,
};
use crate::smtp_sink::wait_until;
use crate::staff::Browser;

/// Starts a booth with pages for visitors. Returns it with their address.
pub(crate) fn start(folder: &BoothFolder, more: &[&str]) -> (BoothProcess, SocketAddr) {
    let arguments = ["--public-listen", "127.0.0.1:0", "--public-url", "https://paros.example"];
    let booth = folder.start_with(&[&arguments, more].concat());
    (booth, public_address(folder))
}

/// Returns the address at which the newest booth listens for visitors, from its log.
fn public_address(folder: &BoothFolder) -> SocketAddr {
    let log = folder.log();
    let line = log.lines().rev().find(|line| line.contains("listening for visitors"));
    let address = line.and_then(|line| line.split("address=").nth(1)).expect("it is told");
    address.split_whitespace().next().and_then(|word| word.parse().ok()).expect("an address")
}

/// Sends the sculpture of a Greek-speaking visitor, and waits for its picture. Returns the address of its
/// page for staff.
pub(crate) fn with_sculpture(client: &Client, folder: &BoothFolder) -> String {
    let headset = Headset::enrol(client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(77);
    let facts = UploadFacts { language: *b"el", ..parcel.facts };
    let parcel = parcel.with_facts(facts);
    headset.upload(client, &parcel).unwrap().expect("it is taken");
    wait_until(|| (client.metric("paros_booth_exports_queued") == 0).then_some(()));
    format!("/staff/sculptures/{}", parcel.facts.id)
}

/// Decodes the QR code of a slip as a telephone does. Returns the path of its link; `None` without a code.
pub(crate) fn scan(slip: &Answer) -> Option<String> {
    let svg = slip.text().split("class=\"qr\"").nth(1)?;
    let side: usize = svg.split("viewBox=\"0 0 ").nth(1)?.split(' ').next()?.parse().ok()?;
    let path = svg.split(" d=\"").nth(1)?.split('"').next()?;
    let mut dark = vec![false; side * side];
    for module in path.split('M').skip(1) {
        let (x, rest) = module.split_once(' ')?;
        let (x, y): (usize, usize) = (x.parse().ok()?, rest.split('h').next()?.parse().ok()?);
        dark[y * side + x] = true;
    }
    const PIXELS: usize = 5;
    let mut picture =
        rqrr::PreparedImage::prepare_from_greyscale(side * PIXELS, side * PIXELS, |x, y| {
            if dark[y / PIXELS * side + x / PIXELS] { 0 } else { 255 }
        });
    let grids = picture.detect_grids();
    let (_, text) = grids.first().expect("a code that is found").decode().expect("a code");
    Some(text.strip_prefix("https://paros.example").expect("the address that was set").to_owned())
}

/// Sends one request over plain HTTP.
fn ask(
    at: SocketAddr,
    method: &str,
    path: &str,
    headers: &[(&str, String)],
    body: &[u8],
) -> io::Result<Answer> {
    let mut stream = TcpStream::connect(at)?;
    stream.set_read_timeout(Some(Duration::from_secs(60)))?;
    write_request(&mut stream, method, path, headers, body)?;
    read_answer(&mut stream)
}

fn get(at: SocketAddr, path: &str) -> Answer {
    ask(at, "GET", path, &[], &[]).expect("an answer")
}

fn post(at: SocketAddr, path: &str, form: &str) -> Answer {
    let kind = ("Content-Type", "application/x-www-form-urlencoded".to_owned());
    ask(at, "POST", path, &[kind], form.as_bytes()).expect("an answer")
}

fn staff(booth: &BoothProcess) -> Browser<'_> {
    Browser::first(&booth.client, &booth.first_code().expect("a code"))
}

#[test]
fn a_visitor_sees_downloads_and_deletes_by_the_code_of_the_slip() {
    let folder = BoothFolder::new("visitors");
    let (booth, at) = start(&folder, &["--opening-hours", "10:00–18:00"]);
    let page = with_sculpture(&booth.client, &folder);
    let browser = staff(&booth);
    let slip = browser.get(&format!("{page}/slip"));
    assert!(slip.text().contains("10:00–18:00"), "{}", slip.text());
    let path = scan(&slip).expect("a code");
    let seen = get(at, &path);
    assert_eq!(seen.status, 200);
    let mut words = String::new();
    let badge = BadgeNumber::new(77).expect("a number").badge();
    write_words(&mut words, &badge, Language::Greek).expect("text");
    for text in [
        words.as_str(),
        "<html lang=\"el\">",
        "Το γλυπτό σας",
        "10:00–18:00",
        "model.stl",
        "model.3mf",
        "model.glb",
    ] {
        assert!(seen.text().contains(text), "{text}: {}", seen.text());
    }
    for header in [
        "cache-control: no-store",
        "referrer-policy: no-referrer",
        "content-security-policy: default-src 'none';",
        "x-content-type-options: nosniff",
        "x-robots-tag: noindex",
    ] {
        assert!(seen.head.contains(header), "{header}: {}", seen.head);
    }
    assert!(!seen.text().contains("http:") && !seen.text().contains("https:"), "a foreign host");
    assert!(get(at, &format!("{path}?language=en")).text().contains("Your sculpture"));
    assert_eq!(&get(at, &format!("{path}/picture.png")).body[..8], b"\x89PNG\r\n\x1a\n");
    assert!(get(at, &format!("{path}/model.stl")).body == figure().stl);
    let mf = get(at, &format!("{path}/model.3mf"));
    assert!(
        mf.body == browser.get(&format!("{page}/model.3mf")).body && mf.head.contains("no-store")
    );
    let glb = get(at, &format!("{path}/model.glb")).body;
    let model = gltf::Gltf::from_slice(&glb).expect("valid by the specification");
    let primitive =
        model.meshes().next().and_then(|mesh| mesh.primitives().next()).expect("a mesh");
    let triangles = (figure().stl.len() - 84) / 50;
    assert!(primitive.indices().expect("numbers").count() > 3 * triangles * 9 / 10);

    let asked = get(at, &format!("{path}/delete"));
    assert!(asked.text().contains("method=\"post\"") && asked.status == 200);
    assert_eq!(post(at, &format!("{path}/delete"), "").status, 400);
    assert_eq!(get(at, &path).status, 200, "it wasn't confirmed");
    assert_eq!(post(at, &format!("{path}/delete"), "confirm=delete").status, 200);
    assert_eq!((get(at, &path).status, browser.get(&page).status), (404, 404));
    assert_eq!(folder.files("sculptures"), [""; 0]);
    let token = path.rsplit('/').next().expect("a token");
    assert!(!folder.log().contains(token) && !folder.log().contains("/s/"), "{}", folder.log());
}

#[test]
fn nothing_else_is_served_there_and_pages_of_visitors_nowhere_else() {
    let folder = BoothFolder::new("visitors-alone");
    let (booth, at) = start(&folder, &[]);
    let page = with_sculpture(&booth.client, &folder);
    let browser = staff(&booth);
    let path = scan(&browser.get(&format!("{page}/slip"))).expect("a code");
    for other in [
        "/",
        "/staff",
        "/staff/login",
        "/healthz",
        "/metrics",
        "/v1/heartbeat",
        &page,
        "/s",
        "/s/1/2",
        "/s/../staff",
    ] {
        let answer = get(at, other);
        assert_eq!(answer.status, 404, "{other}");
        assert!(answer.head.contains("no-store"), "{other}");
    }
    assert_eq!(browser.get(&path).status, 404);
    // Without an address for visitors, the slip has no code and doesn't mention it.
    let cookie = browser.cookie.clone();
    drop(booth);
    let booth = folder.start();
    let browser = Browser { client: &booth.client, cookie };
    let slip = browser.get(&format!("{page}/slip"));
    assert_eq!((slip.status, scan(&slip)), (200, None));
    assert!(!browser.get(&page).text().contains("revoke-link"));
    for wrong in [
        &["--public-listen", "127.0.0.1:0"][..],
        &["--public-url", "https://paros.example"],
        &["--public-listen", "127.0.0.1:0", "--public-url", "paros.example"],
        &[
            "--public-listen",
            "127.0.0.1:0",
            "--public-url",
            "https://a",
            "--public-cert",
            "/nowhere",
            "--public-key",
            "/nowhere",
        ],
    ] {
        let told = BoothFolder::new("visitors-wrong").run(wrong).expect_err("it doesn't start");
        assert!(told.contains("--public") || told.contains("/nowhere"), "{told}");
    }
}

#[test]
fn who_guesses_learns_nothing_and_keeps_nobody_out() {
    let folder = BoothFolder::new("visitors-guess");
    let (booth, at) = start(&folder, &[]);
    let page = with_sculpture(&booth.client, &folder);
    let browser = staff(&booth);
    let path = scan(&browser.get(&format!("{page}/slip"))).expect("a code");
    let (id, token) = path.strip_prefix("/s/").and_then(|path| path.split_once('/')).expect("both");
    let wrong_token = get(at, &format!("/s/{id}/{}", "0".repeat(32)));
    let wrong_id = get(at, &format!("/s/{}/{token}", "0".repeat(32)));
    let no_link = get(at, "/s/x/y");
    assert_eq!((wrong_token.status, wrong_id.status, no_link.status), (404, 404, 404));
    assert!(wrong_token.body == wrong_id.body && wrong_id.body == no_link.body);
    for k in 0..100 {
        assert_eq!(get(at, &format!("/s/{id}/{k:032x}/model.stl")).status, 404, "{k}");
    }
    assert_eq!(get(at, &path).status, 200, "a right one of the same address");
    let mut downloads = (0..40).map(|_| get(at, &format!("{path}/model.glb")).status);
    assert_eq!(downloads.next(), Some(200));
    assert!(downloads.any(|status| status == 503), "twelve, and one in 20 s");
    assert_eq!(get(at, &path).status, 200);
    assert!(!folder.log().contains(token), "{}", folder.log());
}

#[test]
fn a_link_is_taken_back_and_made_anew() {
    let folder = BoothFolder::new("visitors-revoke");
    let (booth, at) = start(&folder, &[]);
    let page = with_sculpture(&booth.client, &folder);
    let browser = staff(&booth);
    let slip = || scan(&browser.get(&format!("{page}/slip")));
    let first = slip().expect("a code");
    assert_eq!(slip().as_ref(), Some(&first), "it is printed again");
    assert_eq!(send_form(&browser, &page, &format!("{page}/revoke-link"), "").status, 303);
    assert_eq!((get(at, &first).status, slip()), (404, None));
    assert_eq!(send_form(&browser, &page, &format!("{page}/renew-link"), "").status, 303);
    let second = slip().expect("a code");
    assert_eq!((get(at, &first).status, get(at, &second).status), (404, 200));
    assert_eq!(send_form(&browser, &page, &format!("{page}/withdraw"), "").status, 303);
    assert_eq!((get(at, &second).status, slip()), (404, None));
    assert_eq!(send_form(&browser, &page, &format!("{page}/bring-back"), "").status, 303);
    assert_eq!(get(at, &second).status, 200);
}

#[test]
fn it_speaks_tls_by_a_certificate_of_its_own() {
    let folder = BoothFolder::new("visitors-tls");
    let key = rcgen::KeyPair::generate().expect("a key");
    let params = rcgen::CertificateParams::new(vec!["127.0.0.1".to_owned()]).expect("a name");
    let certificate = params.self_signed(&key).expect("a certificate");
    let (cert_at, key_at) =
        (folder.path().with_file_name("cert.pem"), folder.path().with_file_name("key.pem"));
    fs::write(&cert_at, certificate.pem()).unwrap();
    fs::write(&key_at, key.serialize_pem()).unwrap();
    let (_booth, at) = start(
        &folder,
        &["--public-cert", cert_at.to_str().unwrap(), "--public-key", key_at.to_str().unwrap()],
    );
    let client = Client::new(at, certificate.der().clone());
    assert_eq!(client.get("/s/1/2").status, 404);
    assert!(ask(at, "GET", "/s/1/2", &[], &[]).is_err(), "not without TLS");
}
