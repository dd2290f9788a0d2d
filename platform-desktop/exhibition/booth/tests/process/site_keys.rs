//! A site's keys, and what watches the booth.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;

use crate::rig::BoothFolder;

#[test]
fn a_second_start_is_the_same_site_and_keys_are_their_owners() {
    let folder = BoothFolder::new("keys");
    drop(folder.start());
    let keys = folder.path().join("keys");
    let read = |name| fs::read(keys.join(name)).expect("it was made");
    let before = ["site.key", "ca.key", "ca.pem"].map(read);
    drop(folder.start());
    assert_eq!(["site.key", "ca.key", "ca.pem"].map(read), before);
    assert_eq!(fs::metadata(&keys).unwrap().permissions().mode() & 0o777, 0o700);
    for name in ["site.key", "ca.key"] {
        assert_eq!(fs::metadata(keys.join(name)).unwrap().permissions().mode() & 0o777, 0o600);
    }
    // Without its keys a booth would sign in another's name: it doesn't start.
    fs::remove_file(keys.join("site.key")).unwrap();
    let error = folder.run(&["fleet-file", "--address", "https://b:1"]).expect_err("no keys");
    assert!(error.contains("site.key: its keys are missing"), "{error}");
}

#[test]
fn health_metrics_logs_and_the_end() {
    let folder = BoothFolder::new("health");
    let mut booth = folder.start_with(&["--json"]);
    assert_eq!(booth.client.get("/healthz").text(), "ok\n");
    assert_eq!(booth.client.metric("paros_booth_headsets"), 0);
    assert_eq!(booth.client.get("/nothing").status, 404);
    assert_eq!(booth.terminate(), Some(0), "told to end it ends well");
    let log = folder.log();
    assert!(log.lines().all(|line| line.starts_with('{') && line.ends_with('}')), "{log}");
    assert!(log.contains("\"message\":\"ended\""), "{log}");
}
