//! Tests of a site's keys, and of a missing database.

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
    // Without its keys a booth doesn't start: new keys would make it another site.
    fs::remove_file(keys.join("site.key")).unwrap();
    let error = folder.run(&["fleet-file", "--address", "https://b:1"]).expect_err("no keys");
    assert!(error.contains("site.key: its keys are missing"), "{error}");
}

/// A command with a mistyped folder reports an error and creates nothing: a second booth would hand out the
/// same badges.
#[test]
fn only_the_servers_first_start_makes_a_booth() {
    let folder = BoothFolder::new("no-booth");
    let outbox = folder.path().with_file_name("outbox");
    fs::create_dir(&outbox).unwrap();
    let import = ["import-spool", outbox.to_str().unwrap(), "--headset", "1"];
    for command in [&["fleet-file", "--address", "https://b:1"][..], &import] {
        let error = folder.run(command).expect_err("there is none");
        assert!(error.contains("there is no booth"), "{error}");
        assert!(!folder.path().exists(), "{command:?}");
    }
}

/// The server refuses to start if its database is missing, empty or cut while keys or sculptures exist, and changes nothing:
/// with a new database the badges would start again.
#[test]
fn a_booth_without_its_records_does_not_start() {
    let folder = BoothFolder::new("no-records");
    drop(folder.start());
    let database = folder.path().join("booth.sqlite");
    let backup = folder.path().with_file_name("booth.zip");
    folder.run(&["backup", backup.to_str().unwrap()]).expect("a backup");
    let whole = fs::read(&database).unwrap();
    let refusal = || folder.run(&["--listen", "127.0.0.1:0"]).expect_err("its records are gone");
    for cut in [whole.len() / 2, 512, 100] {
        fs::write(&database, &whole[..cut]).unwrap();
        let error = refusal();
        assert!(
            error.contains("damaged") && error.contains("paros-booth restore"),
            "{cut}: {error}"
        );
        assert_eq!(fs::read(&database).unwrap(), whole[..cut]);
    }
    fs::write(&database, []).unwrap();
    assert!(refusal().contains("missing or empty"));
    fs::remove_file(&database).unwrap();
    assert!(refusal().contains("missing or empty"));
    // It also refuses without keys, while there are sculptures.
    fs::remove_dir_all(folder.path().join("keys")).unwrap();
    fs::write(folder.path().join("sculptures/one.sculpture"), b"a sculpture").unwrap();
    assert!(refusal().contains("missing or empty"));
    assert!(!database.exists() && !folder.path().join("keys").exists());
    // The restore that the error names works.
    let restored = folder.path().with_file_name("restored");
    let output = folder.command(&["restore", backup.to_str().unwrap()]).output().unwrap();
    assert!(!output.status.success(), "the folder isn't free");
    fs::rename(folder.path(), &restored).unwrap();
    folder.run(&["restore", backup.to_str().unwrap()]).expect("restored");
    drop(folder.start());
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
