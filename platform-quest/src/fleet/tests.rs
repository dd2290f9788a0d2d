//! Enrolment of a headset at scripted booths.

use std::fs;
use std::path::PathBuf;
use std::sync::Mutex;

use paros_protocol::{EnrolAnswer, SiteId};
use paros_upload::{HttpAnswer, HttpRequest, LinkError, LinkFault};

use super::*;

type Answer = Result<HttpAnswer, LinkFault>;

/// A scripted booth: returns these responses, then reports the booth as unreachable, and records the
/// requests.
#[derive(Clone)]
struct Booth(Arc<Mutex<Exchange>>);

type Exchange = (Vec<Answer>, Vec<Vec<u8>>);

impl BoothCaller for Booth {
    fn call(&mut self, request: &HttpRequest<'_>) -> Result<HttpAnswer, LinkError> {
        assert_eq!(request.path, "/v1/enrol/fleet");
        let (answers, asked) = &mut *self.0.lock().expect("nobody panicked");
        asked.push(request.body.to_vec());
        let next = if answers.is_empty() { Err(LinkFault::Unreachable) } else { answers.remove(0) };
        next.map_err(|fault| LinkError { fault, why: String::new() })
    }
}

fn answer(status: u16, body: &[u8]) -> Answer {
    Ok(HttpAnswer { status, retry_after: None, body: body.to_vec() })
}

fn accepted() -> Answer {
    answer(200, &EnrolAnswer { headset: 5, site: SiteId([7; 16]) }.to_json())
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("paros-fleet-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("room on the disk");
    folder
}

fn fleet_text(address: &str) -> String {
    let (site, token) = ("07".repeat(16), "09".repeat(32));
    format!(
        "address = \"{address}\"\nsite = \"{site}\"\n\
         enrolment_token = \"{token}\"\n\
         ca = \"\"\"\n-----BEGIN CERTIFICATE-----\nMIIB\n-----END CERTIFICATE-----\n\"\"\"\n"
    )
}

fn fleet(address: &str) -> FleetFile {
    FleetFile::parse("test", fleet_text(address).as_bytes()).expect("a fleet's file")
}

fn names() -> HeadsetNames {
    HeadsetNames { hint: Some(DeviceHint([3; 16])), name: DeviceName::new("Quest").expect("one") }
}

#[test]
fn what_a_console_set_counts_before_the_file_and_that_before_the_package() {
    let folder = folder("sources");
    let [managed, in_folder, baked] = ["https://m", "https://f", "https://b"].map(fleet_text);
    let mut told = Vec::new();
    let mut find = |managed: Option<&str>, baked: Option<&str>| {
        let log = |line: fmt::Arguments<'_>| told.push(line.to_string());
        let (managed, baked) = (managed.map(Into::into), baked.map(Into::into));
        let found = FleetSources { managed, folder: folder.clone(), baked }.find(log);
        found.map(|fleet| fleet.address)
    };
    assert_eq!(find(None, None), None);
    assert_eq!(find(None, Some(&baked)).as_deref(), Some("https://b"));
    fs::write(folder.join(FLEET_FILE_NAME), in_folder).expect("room on the disk");
    assert_eq!(find(None, Some(&baked)).as_deref(), Some("https://f"));
    assert_eq!(find(Some(&managed), Some(&baked)).as_deref(), Some("https://m"));
    // An empty field of the console's form.
    assert_eq!(find(Some(" \n"), None).as_deref(), Some("https://f"));
    // An invalid file is skipped, and the next source counts.
    assert_eq!(find(Some("no"), None).as_deref(), Some("https://f"));
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].starts_with("managed configuration: "), "{told:?}");
    fs::remove_dir_all(folder).expect("it is ours");
}

#[test]
fn a_headset_enrols_once_and_moves_with_its_booth() {
    let folder = folder("once");
    let file = folder.join("enrolment.toml");
    let first = fleet("https://a");
    let is_due = |fleet: &FleetFile| {
        follow_fleet_file(&file, fleet, |line| println!("{line}")).expect("room on the disk")
    };
    assert!(is_due(&first));
    let device = NewDevice::draw(names().hint, names().name).expect("random bits");
    let booth = Booth(Arc::new(Mutex::new((vec![accepted()], Vec::new()))));
    let way = (|| Some(first.clone()), |_: &FleetFile| booth.clone());
    assert!(enrol_with_patience(way, &device, &file, |_| false));
    let kept = Enrolment::read(&file).expect("whole").expect("it was kept");
    assert_eq!((kept.owner.headset, kept.token), (5, device.token));
    assert!(!is_due(&first));
    assert!(!is_due(&fleet("https://elsewhere")));
    let moved = Enrolment::read(&file).expect("whole").expect("it was kept");
    assert_eq!(moved, Enrolment { address: "https://elsewhere".into(), ..kept });
    // A fleet file of another site causes a new enrolment, and an unreadable enrolment is ignored.
    assert!(is_due(&FleetFile { site: SiteId([1; 16]), ..first.clone() }));
    fs::write(&file, "token = 1").expect("room on the disk");
    assert!(is_due(&first));
    fs::remove_dir_all(folder).expect("it is ours");
}

#[test]
fn a_booth_that_is_off_is_asked_again_and_again_for_the_same() {
    let folder = folder("patience");
    let (file, fleet) = (folder.join("enrolment.toml"), fleet("https://a"));
    let device = NewDevice::draw(None, names().name).expect("random bits");
    let away = || Err(LinkFault::Unreachable);
    let answers = vec![
        away(),
        Err(LinkFault::TimedOut),
        answer(503, b"busy"),
        answer(401, b"no such token"),
        answer(429, b"too many"),
        away(),
        away(),
        accepted(),
    ];
    let count = answers.len();
    let booth = Booth(Arc::new(Mutex::new((answers, Vec::new()))));
    let way = (|| Some(fleet.clone()), |_: &FleetFile| booth.clone());
    let mut pauses = Vec::new();
    let pause = |pause: Duration| {
        pauses.push(pause.as_secs());
        true
    };
    assert!(enrol_with_patience(way, &device, &file, pause));
    // After a refusal the pause is ten minutes, with a check for another file each minute.
    assert_eq!(pauses[..3], [2, 4, 8]);
    assert_eq!((&pauses[3..13], &pauses[13..]), (&[60; 10][..], &[32, 60, 60][..]));
    let (_, asked) = &*booth.0.lock().expect("nobody panicked");
    assert_eq!(asked.len(), count);
    // The booth may have accepted a request whose response was lost: another token would enrol another
    // headset.
    assert!(asked.iter().all(|body| *body == asked[0]));
    fs::remove_dir_all(folder).expect("it is ours");
}

/// A restore revokes all enrolment tokens: staff provide a file with another token, and perhaps another
/// address.
#[test]
fn a_file_that_is_put_there_meanwhile_is_what_it_asks_by() {
    let folder = folder("meanwhile");
    let file = folder.join("enrolment.toml");
    let device = NewDevice::draw(None, names().name).expect("random bits");
    let booth = Booth(Arc::new(Mutex::new((Vec::new(), Vec::new()))));
    let answers = |address: &str| match address {
        "https://old" => answer(401, b"no such token"),
        _ => accepted(),
    };
    let connected = Mutex::new(Vec::new());
    let connect = |fleet: &FleetFile| {
        connected.lock().expect("nobody panicked").push(fleet.address.clone());
        booth.0.lock().expect("nobody panicked").0.push(answers(&fleet.address));
        booth.clone()
    };
    let sources = FleetSources { folder: folder.clone(), ..FleetSources::default() };
    let mut pauses = 0;
    let pause = |_| {
        pauses += 1;
        // At first there is no file.
        let address = match pauses {
            3 => "https://old",
            7 => "https://new",
            _ => return pauses < 50,
        };
        fs::write(folder.join(FLEET_FILE_NAME), fleet_text(address)).expect("room on the disk");
        true
    };
    assert!(enrol_with_patience((|| sources.find(|_| ()), connect), &device, &file, pause));
    assert_eq!(*connected.lock().expect("nobody panicked"), ["https://old", "https://new"]);
    assert_eq!(pauses, 7, "it is asked as soon as it is found");
    let kept = Enrolment::read(&file).expect("whole").expect("it was kept");
    assert_eq!((kept.address.as_str(), kept.token), ("https://new", device.token));
    fs::remove_dir_all(folder).expect("it is ours");
}

#[test]
fn the_thread_tells_once_and_is_not_waited_for() {
    let folder = folder("thread");
    let file = folder.join("enrolment.toml");
    fs::write(folder.join(FLEET_FILE_NAME), fleet_text("https://a")).expect("room on the disk");
    let sources = FleetSources { folder: folder.clone(), ..FleetSources::default() };
    let spawn = |booth: Booth| {
        let connect = move |_: &FleetFile| booth.clone();
        Enroller::spawn(sources.clone(), connect, names(), file.clone()).expect("random bits")
    };
    let mut enroller = spawn(Booth(Arc::new(Mutex::new((vec![accepted()], Vec::new())))));
    let begun = Instant::now();
    while !enroller.poll_enrolled() {
        assert!(begun.elapsed() < Duration::from_secs(60), "it never enrols");
        thread::sleep(Duration::from_millis(5));
    }
    assert!(!enroller.poll_enrolled());
    assert!(Enrolment::read(&file).expect("whole").is_some());
    // A headset whose booth is gone.
    let gone = Booth(Arc::new(Mutex::new((Vec::new(), Vec::new()))));
    let asked = Arc::clone(&gone.0);
    let enroller = spawn(gone);
    while asked.lock().expect("nobody panicked").1.is_empty() {
        thread::sleep(Duration::from_millis(5));
    }
    drop(enroller);
    let begun = Instant::now();
    // The thread has ended once it has released the booth, long before its pause is over.
    while Arc::strong_count(&asked) > 1 {
        assert!(begun.elapsed() < Duration::from_millis(1500), "it goes on");
        thread::sleep(Duration::from_millis(5));
    }
    fs::remove_dir_all(folder).expect("it is ours");
}

#[test]
fn a_headset_that_is_forgotten_again_and_again_asks_once_an_hour() {
    let (mut clock, start) = (AgainClock::new(), Instant::now());
    assert!(clock.take(start));
    // The clock is queried in each frame.
    assert!(!(0..36_000).any(|tenths| clock.take(start + Duration::from_millis(100 * tenths))));
    assert!(clock.take(start + PAUSE_BEFORE_AGAIN));
    assert!(!clock.take(start + PAUSE_BEFORE_AGAIN));
}
