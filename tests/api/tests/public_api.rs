//! Compares the public API of `paros-core`, item by item, with `tests/goldens/core-api.txt`, so that a change
//! shows in the golden file's diff. `PAROS_GOLDEN=write cargo test -p paros-tests-api` updates the file.

use std::path::{Path, PathBuf};
use std::process::Command;

use paros_shell::require::require_or_skip;
use public_api::Builder;

const AGAIN: &str =
    "if it was meant to, write it: PAROS_GOLDEN=write cargo test -p paros-tests-api";

/// Returns the items of rustdoc's JSON, one a line. The JSON format is unstable; a version that can't be
/// parsed is an error.
fn list_public_api() -> Result<String, String> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    // Uses a separate target folder, because the tests' own build may hold the lock of the default one.
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("api");
    let built = Command::new(env!("CARGO"))
        .args(["rustdoc", "--quiet", "--package", "paros-core", "--lib", "--target-dir"])
        .arg(&target)
        .args(["--", "-Zunstable-options", "--output-format=json"])
        .env("RUSTC_BOOTSTRAP", "1")
        .current_dir(workspace)
        .output()
        .map_err(|error| format!("cargo can't be started: {error}"))?;
    if !built.status.success() {
        return Err(format!("no rustdoc JSON: {}", String::from_utf8_lossy(&built.stderr)));
    }
    let api = Builder::from_rustdoc_json(target.join("doc/paros_core.json"))
        .omit_auto_derived_impls(true)
        .omit_auto_trait_impls(true)
        .omit_blanket_impls(true)
        .build()
        .map_err(|error| format!("rustdoc's JSON is of another version: {error}"))?;
    Ok(api.to_string())
}

/// Returns the first line that only one of the listings contains, with that listing's name.
fn find_difference<'a>(kept: &'a str, now: &'a str) -> Option<(&'static str, &'a str)> {
    let lacks = |text: &str, line: &&str| !text.lines().any(|other| other == *line);
    let added = now.lines().find(|line| lacks(kept, line)).map(|line| ("added", line));
    added.or_else(|| kept.lines().find(|line| lacks(now, line)).map(|line| ("removed", line)))
}

#[test]
fn the_listing_of_the_public_api_is_up_to_date() {
    let Some(now) = require_or_skip(list_public_api()).expect("rustdoc's JSON") else { return };
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../goldens/core-api.txt");
    if std::env::var("PAROS_GOLDEN").as_deref() == Ok("write") {
        std::fs::write(&path, now).expect("the golden file");
        return;
    }
    let kept = std::fs::read_to_string(&path).expect("the golden file");
    if let Some((what, line)) = find_difference(&kept, &now) {
        panic!("the core's public API has changed, {what}: {line}\n{AGAIN}");
    }
}

#[test]
fn a_difference_names_its_line() {
    let kept = "pub fn a()\npub fn b()\n";
    assert_eq!(find_difference(kept, kept), None);
    assert_eq!(find_difference(kept, "pub fn a()\n"), Some(("removed", "pub fn b()")));
    assert_eq!(
        find_difference(kept, "pub fn a(u8)\npub fn b()\n"),
        Some(("added", "pub fn a(u8)"))
    );
}
