//! The link to a booth by Java's HTTPS, on the host's JDK, whose VM checks every call.

#[path = "../java/mod.rs"]
mod java;
#[path = "../../../platform-desktop/outbox-link/tests/link_suite/mod.rs"]
mod link_suite;

use std::process::Command;
use std::sync::LazyLock;
use std::time::Duration;

use jni::{InitArgsBuilder, JNIVersion, JavaVM};
use paros_core::outbox::messages::DeviceToken;
use paros_quest::device::HttpsCaller;
use paros_shell::outbox::{
    BoothAddress, BoothCaller, HttpAnswer, HttpRequest, LinkFault, LinkTimes, ThreadedLink,
};

use java::run_in_checked_vm;
use link_suite::{Answer, Server, ask, put};

/// The Java VM: a process can start only one. Nothing of Android's is in it.
static VM: LazyLock<JavaVM> = LazyLock::new(|| {
    let arguments = InitArgsBuilder::new().version(JNIVersion::V1_8).option("-Xcheck:jni");
    JavaVM::new(arguments.build().expect("arguments")).expect("a JDK's machine")
});

fn open_link(address: &BoothAddress, times: LinkTimes) -> ThreadedLink {
    let [of_puts, of_heartbeats] = [times.put, times.heartbeat]
        .map(|timeout| HttpsCaller::new(VM.clone(), &address.url, &address.ca, timeout));
    ThreadedLink::start(address.token, of_puts, of_heartbeats)
}

#[test]
fn requests_and_answers_are_as_the_booth_has_them() {
    run_in_checked_vm("requests_and_answers_are_as_the_booth_has_them", || {
        link_suite::check_requests_and_answers(open_link);
    });
}

#[test]
fn who_has_another_authority_or_address_is_not_the_booth() {
    run_in_checked_vm("who_has_another_authority_or_address_is_not_the_booth", || {
        link_suite::check_trust(open_link);
    });
}

#[test]
fn nobody_and_silence_are_faults_and_a_part_holds_up_no_heartbeat() {
    run_in_checked_vm("nobody_and_silence_are_faults_and_a_part_holds_up_no_heartbeat", || {
        link_suite::check_silence(open_link);
        link_suite::check_no_plain_http(open_link);
    });
}

#[test]
fn redirects_are_not_followed_and_long_bodies_not_read() {
    run_in_checked_vm("redirects_are_not_followed_and_long_bodies_not_read", || {
        link_suite::check_redirects_and_long_bodies(open_link);
    });
}

/// What Java threw is in the error: its class, and what it says.
#[test]
fn an_exception_is_told() {
    run_in_checked_vm("an_exception_is_told", || {
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
        assert!(told.contains("javax.net.ssl.SSLHandshakeException: PKIX path"), "{told}");
    });
}

/// A day's requests leave nothing behind: the VM would warn of local references beyond a frame's, and a global one
/// would keep its connection.
#[test]
fn a_thousand_requests_leave_no_reference_behind() {
    run_in_checked_vm("a_thousand_requests_leave_no_reference_behind", || {
        let fine = b"HTTP/1.1 202 x\r\nContent-Length: 8\r\n\r\n12345678";
        let server = Server::start(Answer::Bytes(fine));
        let url = format!("https://{}", server.address);
        let long = Duration::from_secs(30);
        let mut to_booth = HttpsCaller::new(VM.clone(), &url, &server.ca, long);
        let mut to_nobody = HttpsCaller::new(VM.clone(), "https://127.0.0.1:1", &server.ca, long);
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

/// Objects of a class in this process's VM, after its garbage was collected.
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
