//! Runs each target on as many inputs as take a second or two; `.ci/nightly` gives each target a minute.
//!
//! `a_fault_is_found_shrunk_and_kept` has a faulty target, and tests that the fuzzer finds the fault.

use std::fs;
use std::panic;
use std::path::Path;

use paros_tests_fuzz::engine::{FuzzTarget, fuzz};
use paros_tests_fuzz::{fuzz_tests, targets};

fuzz_tests! {
    targets::ALL =>
    obj stl ply gltf rmap trace input settings manifest save message parcel enrolment last_use step
    words
}

/// A target that fails on numbers above 200 after a certain word.
const FAULTY: FuzzTarget = FuzzTarget {
    name: "faulty",
    seeds: || vec![b"a fine input".to_vec()],
    words: &[b"depth"],
    longest: 64,
    runs: 100_000,
    run: |bytes| {
        let found = bytes.windows(6).find(|window| window.starts_with(b"depth"));
        assert!(found.is_none_or(|window| window[5] <= 200), "deeper than 200");
        if found.is_some() { "deep".into() } else { "fine".into() }
    },
};

#[test]
fn a_fault_is_found_shrunk_and_kept() {
    if std::env::vars().any(|(name, _)| name.starts_with("PAROS_FUZZ_")) {
        return;
    }
    let own = Path::new(env!("CARGO_TARGET_TMPDIR")).join("engine");
    let _ = fs::remove_dir_all(&own);
    let fault = panic::catch_unwind(|| fuzz(&FAULTY, &own)).expect_err("the fault isn't found");
    let said = fault.downcast_ref::<String>().expect("a message");
    assert!(said.starts_with("faulty fails on 6 bytes"), "{said}");
    let files = fs::read_dir(own.join("fuzz/faulty")).expect("its folder").flatten();
    let files: Vec<_> = files.map(|file| file.path()).collect();
    assert_eq!(files.len(), 1);
    let input = fs::read(&files[0]).expect("the input");
    assert!(input.starts_with(b"depth") && input[5] > 200, "{input:?}");
    assert!(said.ends_with(&format!("PAROS_FUZZ_INPUT={}", files[0].display())), "{said}");
}
