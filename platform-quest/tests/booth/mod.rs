//! The link to a booth through Java's HTTPS, on the host's JDK, whose VM checks every call.

#[path = "../../../platform-desktop/exhibition/upload/https/tests/link_suite/mod.rs"]
mod link_suite;
mod rig;

use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;
use std::time::{Duration, Instant};
use std::{fs, thread};

use jni::{InitArgsBuilder, JavaVM};
use paros_booth_process::{BoothProcess, find_booth};
use paros_protocol::{DeviceName, DeviceToken, LinkTimes, SculptureId, UploadStatus};
use paros_quest::device::HttpsCaller;
use paros_quest::fleet::{Enroller, FleetSources, HeadsetNames, follow_fleet_file};
use paros_shell::settings::{BoothSettings, LoadedSettings};
use paros_upload::courier::{Courier, read_clock_ms};
use paros_upload::enrolment::{
    EnrolError, Enrolment, FLEET_FILE_NAME, FleetFile, NewDevice, enrol_by_fleet, enrolment_file,
    hint_of_device,
};
use paros_upload::{
    BoothAddress, BoothCaller, BoothContact, HttpAnswer, HttpRequest, LinkFault, ThreadedLink,
};

use crate::java::{run_in_checked_vm, start_checked_vm};
use link_suite::{Answer, Server, ask, put};
use rig::{is_kept, make_draft};

/// The Java VM, without any class of Android's: a process can start only one.
static VM: LazyLock<JavaVM> = LazyLock::new(|| start_checked_vm(InitArgsBuilder::new()));

fn open_link(address: &BoothAddress, times: LinkTimes) -> ThreadedLink {
    let [of_puts, of_heartbeats] =
        [(); 2].map(|()| HttpsCaller::new(VM.clone(), &address.url, &address.ca));
    ThreadedLink::start(address.token, times, of_puts, of_heartbeats)
}

#[test]
fn requests_and_answers_are_as_the_booth_has_them() {
    run_in_checked_vm("booth::requests_and_answers_are_as_the_booth_has_them", || {
        link_suite::check_requests_and_answers(open_link);
    });
}

#[test]
fn who_has_another_authority_or_address_is_not_the_booth() {
    run_in_checked_vm("booth::who_has_another_authority_or_address_is_not_the_booth", || {
        link_suite::check_trust(open_link);
    });
}

#[test]
fn nobody_and_silence_are_faults_and_a_part_holds_up_no_heartbeat() {
    run_in_checked_vm(
        "booth::nobody_and_silence_are_faults_and_a_part_holds_up_no_heartbeat",
        || {
            link_suite::check_silence(open_link);
            link_suite::check_cut_handshakes(open_link);
            link_suite::check_no_plain_http(open_link);
        },
    );
}

#[test]
fn redirects_are_not_followed_and_long_bodies_not_read() {
    run_in_checked_vm("booth::redirects_are_not_followed_and_long_bodies_not_read", || {
        link_suite::check_redirects_and_long_bodies(open_link);
    });
}

/// Tests the whole way, from the pushed fleet file to the booth's receipt, against the real booth program.
#[test]
fn a_headset_enrols_at_the_booth_and_its_sculpture_gets_there() {
    run_in_checked_vm("booth::a_headset_enrols_at_the_booth_and_its_sculpture_gets_there", || {
        let Some(program) = find_booth() else { return };
        let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("quest-booth");
        let _ = fs::remove_dir_all(&place);
        let folder = place.join("headset");
        fs::create_dir_all(&folder).expect("room on the disk");
        let booth = BoothProcess::start(&program, &place, None);
        refuse_another_authority(&booth);
        push_fleet_file(&booth, &folder);
        let sources = sources(&folder);
        let fleet = sources.find(|line| panic!("{line}")).expect("it was pushed");
        let file = enrolment_file(&folder);
        let is_due = || follow_fleet_file(&file, &fleet, |line| panic!("{line}")).expect("a disk");
        assert!(is_due());
        let mut enroller = start_enroller(&folder);
        wait_until("it enrols", || enroller.poll_enrolled());
        assert!(!is_due());
        let courier = open_courier(&folder);
        send_sculpture(&courier, &booth, 0x5c);
    });
}

/// The booth is restored from a backup made before the headset enrolled. Staff push a file with a new token,
/// as a restore revokes the others. The headset's parcels reach the booth even under another number.
#[test]
fn a_headset_that_a_restored_booth_has_forgotten_enrols_anew_and_loses_nothing() {
    run_in_checked_vm(
        "booth::a_headset_that_a_restored_booth_has_forgotten_enrols_anew_and_loses_nothing",
        || {
            let Some(program) = find_booth() else { return };
            let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("quest-restored");
            let _ = fs::remove_dir_all(&place);
            let [folder, first, second] =
                ["headset", "first", "second"].map(|name| place.join(name));
            for folder in [&folder, &first, &second] {
                fs::create_dir_all(folder).expect("room on the disk");
            }
            let booth = BoothProcess::start(&program, &first, None);
            let backup = place.join("booth.backup");
            let backup = backup.to_str().expect("text");
            push_fleet_file(&booth, &folder);
            let _ = booth.run(&["backup", backup]);
            let mut enroller = start_enroller(&folder);
            wait_until("it enrols", || enroller.poll_enrolled());
            let courier = open_courier(&folder);
            send_sculpture(&courier, &booth, 1);
            drop(booth);
            let booth = restore(&program, &second, backup);
            // The token of the stored file is still valid, but the booth's address is another one.
            drop(courier);
            let fleet = sources(&folder).find(|line| panic!("{line}")).expect("it is there");
            let file = enrolment_file(&folder);
            move_to(&booth, &file);
            let courier = open_courier(&folder);
            courier.announce(make_draft(2).facts.id, b"its volume".to_vec());
            courier.keep(make_draft(2));
            wait_until("it is forgotten", || courier.is_forgotten());
            drop(courier);
            enrol_another(&booth, &fleet);
            push_fleet_file(&booth, &folder);
            let mut enroller = start_enroller(&folder);
            wait_until("it enrols anew", || enroller.poll_enrolled());
            let courier = open_courier(&folder);
            let kept = Enrolment::read(&file).expect("whole").expect("it is enrolled");
            assert_eq!(kept.owner.headset, 2, "the first one is another device now");
            wait_until("both are kept", || count_made(&booth) == 2);
            for number in [1, 2] {
                let id = SculptureId([number; 16]);
                wait_until("it is sent", || courier.upload_status(id) == Some(UploadStatus::Sent));
                assert!(is_kept(&booth, id));
            }
        },
    );
}

/// Restores a backup as a booth with a folder and an address of its own.
fn restore(program: &Path, folder: &Path, backup: &str) -> BoothProcess {
    let mut command = Command::new(program);
    command.args(["restore", backup, "--folder"]).arg(folder.join("booth"));
    let output = command.output().expect("the program");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    BoothProcess::start(program, folder, None)
}

/// Writes the booth's new address into the enrolment, as if the booth ran on another machine.
fn move_to(booth: &BoothProcess, file: &Path) {
    let kept = Enrolment::read(file).expect("whole").expect("it is enrolled");
    let moved = Enrolment { address: booth.address().into(), ..kept };
    moved.write(file).expect("room on the disk");
}

/// Enrols another device first after the restore, which gets the number that this one had.
fn enrol_another(booth: &BoothProcess, fleet: &FleetFile) {
    let hint = Some(hint_of_device("another"));
    let device = NewDevice::draw(hint, DeviceName::new("").expect("a name")).expect("random bits");
    let mut caller = HttpsCaller::new(VM.clone(), booth.address(), &fleet.ca);
    let enrolled = enrol_by_fleet(&mut caller, fleet, &device).expect("a good token");
    assert_eq!(enrolled.owner.headset, 1);
}

/// Returns the number of stored sculptures whose meshes the booth has made.
fn count_made(booth: &BoothProcess) -> usize {
    let log = booth.read_log();
    log.lines().filter(|line| line.contains("mesh made") && line.contains("Made")).count()
}

fn push_fleet_file(booth: &BoothProcess, folder: &Path) {
    fs::write(folder.join(FLEET_FILE_NAME), booth.make_fleet_file()).expect("room on the disk");
}

fn sources(folder: &Path) -> FleetSources {
    FleetSources { folder: folder.to_owned(), ..FleetSources::default() }
}

fn refuse_another_authority(booth: &BoothProcess) {
    let other = Server::start(Answer::Never);
    let fleet = FleetFile::parse("fleet", booth.make_fleet_file().as_bytes()).expect("its own");
    let device = NewDevice::draw(None, DeviceName::new("").expect("a name")).expect("random bits");
    let mut caller = HttpsCaller::new(VM.clone(), booth.address(), &other.ca);
    let refused = enrol_by_fleet(&mut caller, &fleet, &device);
    assert!(matches!(refused, Err(EnrolError::Link(LinkFault::Untrusted))), "{refused:?}");
}

fn start_enroller(folder: &Path) -> Enroller {
    let names = HeadsetNames {
        hint: Some(hint_of_device("9774d56d682e549c")),
        name: DeviceName::new("Oculus Quest 3").expect("a name"),
    };
    let connect = |fleet: &FleetFile| HttpsCaller::new(VM.clone(), &fleet.address, &fleet.ca);
    let file = enrolment_file(folder);
    Enroller::spawn(sources(folder), connect, names, file).expect("random bits")
}

fn open_courier(folder: &Path) -> Courier {
    let connect = |enrolment: &Enrolment| {
        let link: Box<ThreadedLink> =
            Box::new(open_link(&enrolment.booth_address(), LinkTimes::default()));
        Ok(link as _)
    };
    let settings: BoothSettings = LoadedSettings::merge(&[]).settings.booth;
    let courier = Courier::open_enrolled(&settings, folder, read_clock_ms, connect);
    courier.expect("an outbox").expect("it is enrolled")
}

/// Sends a sculpture, and waits until the booth has stored it.
fn send_sculpture(courier: &Courier, booth: &BoothProcess, number: u8) {
    wait_until("the booth answers a heartbeat", || courier.summary().contact == BoothContact::Open);
    let draft = make_draft(number);
    let id = draft.facts.id;
    courier.announce(id, b"its volume".to_vec());
    courier.keep(draft);
    wait_until("it is sent", || courier.upload_status(id) == Some(UploadStatus::Sent));
    wait_until("it is kept", || is_kept(booth, id));
    assert_eq!(courier.take_notes(), [""; 0]);
}

fn wait_until(what: &str, mut is_there: impl FnMut() -> bool) {
    let begun = Instant::now();
    while !is_there() {
        assert!(begun.elapsed() < Duration::from_secs(90), "never: {what}");
        thread::sleep(Duration::from_millis(20));
    }
}

/// An error contains the class and the message of the Java exception.
#[test]
fn an_exception_is_told() {
    run_in_checked_vm("booth::an_exception_is_told", || {
        let [server, other] = [Answer::Never; 2].map(Server::start);
        let address = BoothAddress {
            url: format!("https://{}", server.address),
            ca: other.ca,
            token: DeviceToken([1; 32]),
        };
        let mut link = open_link(&address, LinkTimes::default());
        assert_eq!(ask(&mut link, put()).result, Err(LinkFault::Untrusted));
        let told = link.last_error().expect("it failed").to_string();
        assert!(told.starts_with("who answers isn't the booth: "), "{told}");
        // Newer VMs put the alert's name between them.
        let (_, said) = told.split_once("javax.net.ssl.SSLHandshakeException: ").expect(&told);
        assert!(said.contains("PKIX path"), "{told}");
    });
}

/// A day's requests leak nothing: the VM would warn of local references beyond a frame's, and a leaked global
/// one would keep its connection.
#[test]
fn a_thousand_requests_leave_no_reference_behind() {
    run_in_checked_vm("booth::a_thousand_requests_leave_no_reference_behind", || {
        let fine = b"HTTP/1.1 202 x\r\nContent-Length: 8\r\n\r\n12345678";
        let server = Server::start(Answer::Bytes(fine));
        let url = format!("https://{}", server.address);
        let mut to_booth = HttpsCaller::new(VM.clone(), &url, &server.ca);
        let mut to_nobody = HttpsCaller::new(VM.clone(), "https://127.0.0.1:1", &server.ca);
        let request = HttpRequest::post("/v1/heartbeat", b"still here");
        let expected = HttpAnswer { status: 202, retry_after: None, body: b"12345678".to_vec() };
        for i in 0..1000 {
            if i % 5 == 0 {
                let error = to_nobody.call(&request).expect_err("nobody is there");
                assert_eq!(error.fault, LinkFault::Unreachable, "{error}");
            } else {
                assert_eq!(to_booth.call(&request), Ok(expected.clone()));
            }
        }
        let kept = count_instances("sun.net.www.protocol.https.HttpsURLConnectionImpl");
        assert!(kept < 20, "{kept} connections are kept");
    });
}

/// Returns the number of a class's objects in this process's VM, after a garbage collection.
fn count_instances(class: &str) -> u32 {
    let mut jcmd = Command::new("jcmd");
    jcmd.args([&std::process::id().to_string(), "GC.class_histogram"]);
    let output = jcmd.output().expect("a JDK has it");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success() && text.contains("java.lang.String"), "{text}");
    // `NUMBER: INSTANCES BYTES CLASS`
    let line = text.lines().find(|line| line.split_whitespace().nth(3) == Some(class));
    line.map_or(0, |line| line.split_whitespace().nth(1).expect("a number").parse().expect("one"))
}
