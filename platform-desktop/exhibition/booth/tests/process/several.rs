//! Tests of two booths that share a PostgreSQL database and a bucket, with headsets that use both.

use paros_protocol::ParcelOutcome;
use std::collections::BTreeMap;
use std::process::Stdio;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::postgres_server::PostgresServer;
use crate::prints::{send_form, stand_in, with_sculpture};
use crate::rig::{BoothFolder, Client, Headset, Parcel};
use crate::s3_server::S3Server;
use crate::smtp_sink::wait_until;
use crate::staff::Browser;

const HEADSETS: u8 = 50;
const PARCELS_EACH: u32 = 2;

/// The number of parcels after which one of the two booths is killed.
const PARCELS_BEFORE_KILL: usize = 30;

/// The servers that booths share.
struct Shared {
    database: PostgresServer,
    bucket: S3Server,
    address: String,
}

impl Shared {
    fn start(name: &str) -> Option<Self> {
        let database = PostgresServer::start(&format!("{name}-postgres"))?;
        let address = database.new_schema();
        Some(Shared { database, bucket: S3Server::start(&format!("{name}-s3")), address })
    }

    /// Makes a booth's folder, without keys.
    fn folder(&self, name: &str, files: &str) -> BoothFolder {
        let shared = ["--database", &self.address, "--files", files];
        BoothFolder::new(name).sharing(&shared, self.bucket.settings())
    }
}

/// Copies a booth's keys to another booth.
fn copy_keys(from: &BoothFolder, to: &BoothFolder) {
    let keys = to.path().join("keys");
    let _ = std::fs::remove_dir_all(&keys);
    std::fs::create_dir_all(&keys).expect("room on the disk");
    for name in ["site.key", "ca.key", "ca.pem"] {
        std::fs::copy(from.path().join("keys").join(name), keys.join(name))
            .expect("they were made");
    }
}

fn kill(id: u32) {
    let killed = std::process::Command::new("kill").args(["-KILL", &id.to_string()]).status();
    assert!(killed.expect("kill").success());
}

/// The acknowledged parcels, by the sculpture's number.
type Signed = Mutex<BTreeMap<u32, Parcel>>;

/// Sends a parcel, trying the booths in turn like a load balancer, and skips a dead one.
fn send(clients: &[Client; 2], headset: &Headset, parcel: &Parcel) {
    for tries in 0..200 {
        let client = &clients[(headset.number as usize + tries) % 2];
        let Ok(answer) = headset.upload(client, parcel) else { continue };
        match answer {
            Ok(outcome) => return assert_eq!(outcome, ParcelOutcome::Kept),
            // Retry: a killed booth may have left its work half done, or too many requests wait.
            Err(answer) if matches!(answer.status, 429 | 503) => {
                std::thread::sleep(Duration::from_millis(200));
            }
            Err(answer) => panic!("{answer:?}"),
        }
    }
    panic!("it never comes");
}

/// Lists the sculptures whose meshes a booth made, from its log.
fn made_meshes(folder: &BoothFolder) -> Vec<String> {
    let log = folder.log();
    let lines = log.lines().filter(|line| line.contains("mesh made"));
    lines.filter_map(|line| Some(line.split("id=").nth(1)?.split(' ').next()?.to_owned())).collect()
}

#[test]
fn two_share_the_load_and_one_that_is_killed_loses_nothing() {
    let Some(shared) = Shared::start("several") else { return };
    let folders = ["several-1", "several-2"].map(|name| shared.folder(name, "s3://booth/site"));
    let one = folders[0].start();
    copy_keys(&folders[0], &folders[1]);
    let mut two = folders[1].start();
    let clients = [one.client.clone(), two.client.clone()];
    let fleet = folders[1].fleet_token();
    let headsets: Vec<Headset> = (1..=HEADSETS)
        .map(|byte| Headset::enrol(&clients[usize::from(byte) % 2], fleet, byte))
        .collect();
    let (signed, kept, start) = (Signed::default(), AtomicUsize::new(0), Instant::now());
    std::thread::scope(|scope| {
        for headset in &headsets {
            let (clients, signed, kept) = (&clients, &signed, &kept);
            scope.spawn(move || {
                for k in 0..PARCELS_EACH {
                    let number = headset.number * PARCELS_EACH + k;
                    let make =
                        if number.is_multiple_of(10) { Parcel::large } else { Parcel::volume };
                    let parcel = make(number);
                    send(clients, headset, &parcel);
                    signed.lock().unwrap().insert(number, parcel);
                    kept.fetch_add(1, Ordering::Relaxed);
                }
            });
        }
        while kept.load(Ordering::Relaxed) < PARCELS_BEFORE_KILL {
            assert!(start.elapsed() < Duration::from_secs(120), "nothing goes on");
            std::thread::sleep(Duration::from_millis(5));
        }
        kill(two.id());
        two.wait();
    });
    let seconds = start.elapsed().as_secs_f64();
    let signed = signed.into_inner().unwrap();
    assert_eq!(signed.len(), usize::from(HEADSETS) * PARCELS_EACH as usize);
    assert_eq!(
        one.client.metric("paros_booth_sculptures"),
        signed.len() as u64,
        "one is there twice"
    );
    // Another booth, without data of its own, knows all parcels.
    let three = folders[1].start();
    for parcel in signed.values() {
        let again = headsets[0].upload(&three.client, parcel).unwrap();
        assert_eq!(again.expect("it is known"), ParcelOutcome::Kept);
        let kept = shared.bucket.folder("site/sculptures");
        assert!(parcel.is_kept_in(&kept), "{}", parcel.facts.id);
    }
    check_exports(&folders);
    println!("{} parcels in {seconds:.1} s", signed.len());
}

/// Checks that both booths make meshes, and each mesh is made once.
fn check_exports(folders: &[BoothFolder; 2]) {
    let (start, before) = (Instant::now(), made_meshes(&folders[1]).len());
    let mut all = loop {
        let [one, two] = [made_meshes(&folders[0]), made_meshes(&folders[1])];
        // The booth that was started last has made some too.
        if one.len() >= 8 && two.len() >= before + 4 {
            break [one, two].concat();
        }
        assert!(start.elapsed() < Duration::from_secs(120), "the exporters stand still");
        std::thread::sleep(Duration::from_millis(100));
    };
    all.sort();
    let count = all.len();
    all.dedup();
    assert_eq!(all.len(), count, "one was made twice");
}

/// Slicing takes minutes of a processor, so a booth must not slice a print that the other is slicing.
#[test]
fn two_slice_each_print_once() {
    const PRINTS: usize = 6;
    let Some(shared) = Shared::start("several-slices") else { return };
    let folders = ["slices-1", "slices-2"]
        .map(|name| shared.folder(&format!("several-{name}"), "s3://booth/site"));
    let sliced = folders[0].path().with_file_name("sliced");
    let script = format!(
        "echo x >>{}; sleep 0.5; printf '; total filament used [g] = 2\\n; estimated printing time (normal mode) = 2m\\n' >print.gcode",
        sliced.display()
    );
    let slicer = stand_in(&folders[0], &script);
    let arguments = ["--slicer", slicer.to_str().expect("text")];
    let one = folders[0].start_with(&arguments);
    copy_keys(&folders[0], &folders[1]);
    let two = folders[1].start_with(&arguments);
    let at = with_sculpture(&one.client, &folders[1], 77);
    let browser = Browser::first(&one.client, &one.first_code().expect("a code"));
    let of_two = Browser { client: &two.client, cookie: browser.cookie.clone() };
    for k in 0..PRINTS {
        // Orders go to the booths in turn, and both look for work.
        let browser = if k % 2 == 0 { &browser } else { &of_two };
        assert_eq!(send_form(browser, &at, &format!("{at}/print"), "height=60").status, 303);
    }
    wait_until(|| {
        let ready = browser.get("/staff/prints").text().matches("ready to print").count();
        (ready == PRINTS).then_some(())
    });
    let count = std::fs::read_to_string(&sliced).expect("it was asked").lines().count();
    assert_eq!(count, PRINTS, "one was sliced twice");
    let by_each = folders.map(|folder| folder.log().matches("print sliced").count());
    assert!(by_each.iter().all(|count| *count > 0), "{by_each:?}");
}

/// A booth with its own database may keep its files in a bucket. Its folder is still locked.
#[test]
fn a_booth_alone_may_keep_its_files_in_a_bucket() {
    let bucket = S3Server::start("bucket-alone-s3");
    let folder = BoothFolder::new("bucket-alone");
    let folder = folder.sharing(&["--files", "s3://booth/site"], bucket.settings());
    let booth = folder.start();
    let headset = Headset::enrol(&booth.client, folder.fleet_token(), 1);
    let parcel = Parcel::volume(1);
    let first = headset.upload(&booth.client, &parcel).unwrap().expect("it is taken");
    let name = format!("site/sculptures/{}-{}.sculpture", parcel.facts.id, parcel.hash);
    assert!(std::fs::read(bucket.folder(&name)).expect("it is kept") == parcel.bytes);
    assert!(!folder.path().join("sculptures").exists());
    let (code, told) = refused(&folder);
    assert_eq!(code, Some(2), "{told}");
    assert!(told.contains("another booth runs in this folder"), "{told}");
    drop(booth);
    let booth = folder.start();
    assert_eq!(headset.upload(&booth.client, &parcel).unwrap().expect("the same"), first);
}

/// Returns the exit code and the error of a booth that doesn't start.
fn refused(folder: &BoothFolder) -> (Option<i32>, String) {
    let mut process = folder.command(&["--listen", "127.0.0.1:0"]);
    let process = process.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut process = process.expect("the program");
    let start = Instant::now();
    while process.try_wait().expect("it is there").is_none() {
        if start.elapsed() > Duration::from_secs(60) {
            process.kill().expect("it is there");
            panic!("it serves");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let done = process.wait_with_output().expect("it has ended");
    assert!(done.stdout.is_empty());
    (done.status.code(), String::from_utf8(done.stderr).expect("text"))
}

#[test]
fn a_booth_that_does_not_belong_to_the_others_does_not_start() {
    let Some(shared) = Shared::start("strangers") else { return };
    let first = shared.folder("strangers-1", "s3://booth/site");
    drop(first.start());
    let other = shared.folder("strangers-2", "s3://booth/site");
    let (code, told) = refused(&other);
    assert_eq!(code, Some(2), "{told}");
    assert!(told.contains("its keys are missing"), "{told}");
    let alone = BoothFolder::new("strangers-alone");
    drop(alone.start());
    copy_keys(&alone, &other);
    let (code, told) = refused(&other);
    assert_eq!(code, Some(2), "{told}");
    assert!(told.contains("of another site"), "{told}");
    let elsewhere = shared.folder("strangers-3", "s3://booth/elsewhere");
    copy_keys(&first, &elsewhere);
    let (code, told) = refused(&elsewhere);
    assert_eq!(code, Some(2), "{told}");
    assert!(
        told.contains("whose files are in s3://booth/site, not in s3://booth/elsewhere"),
        "{told}"
    );
    // With the same keys it starts, also twice in the same folder.
    copy_keys(&first, &other);
    let (one, two) = (other.start(), other.start());
    assert_eq!((one.client.get("/healthz").status, two.client.get("/healthz").status), (200, 200));
    assert!(shared.database.connect().is_ok());
}

/// A database's address, which may contain a password, is in no message.
#[test]
fn a_password_is_never_told() {
    let bucket = S3Server::start("password-s3");
    let settings = bucket.settings();
    let bad =
        ["postgres://ana:hunter2@127.0.0.1:1/booth", "postgres://ana:hunter2@[/booth", "hunter2"];
    for address in bad {
        let arguments = ["--database", address, "--files", "s3://booth/site"];
        let folder = BoothFolder::new("password").sharing(&arguments, settings.clone());
        let (code, told) = refused(&folder);
        assert!(matches!(code, Some(1 | 2)), "{told}");
        assert!(told.contains("--database") && !told.contains("hunter2"), "{told}");
    }
    let folder = BoothFolder::new("password").sharing(&["--database", bad[0]], settings);
    let (code, told) = refused(&folder);
    assert_eq!(code, Some(2), "{told}");
    assert!(told.contains("--files") && !told.contains("hunter2"), "{told}");
}
