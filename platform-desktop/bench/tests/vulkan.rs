//! Rows of the benchmarks that need a Vulkan device, and the reports without one.

use std::process::{Command, Output};

use paros_shell::require::require_or_skip;
use serde_json::Value;

use crate::bench_command;

/// Returns the name of the best device, if there is one.
fn device() -> Option<String> {
    require_or_skip(paros_headless::open_gpu(None)).unwrap().map(|gpu| gpu.name.clone())
}

fn succeeds(args: &[&str]) -> Output {
    let output = bench_command(args).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?}: {errors}");
    output
}

/// Checks that the command fails because of a missing dependency, with one line that contains `word`.
fn fails(mut command: Command, word: &str) {
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{command:?}: {errors}");
    assert!(errors.contains(word), "{command:?} should say {word:?}: {errors}");
    assert_eq!(errors.lines().count(), 1, "{errors}");
    assert!(output.stdout.is_empty());
}

fn rows(output: &Output) -> Vec<Value> {
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn bench_render_has_a_row_for_each_comparison() {
    let Some(device) = device() else { return };
    let size = ["--size", "96x96", "--runs", "1", "--json"];
    let rows = rows(&succeeds(&[&["render", "toy", "lump"], &size[..]].concat()));
    for kind in ["mono, 1 sample", "mono, 4 samples", "stereo, 1 sample", "stereo, 4 samples"] {
        for (what, sizes) in [
            ("the paper's path", &[128, 256][..]),
            ("the paper's path with a full march, ours without", &[128, 256]),
            ("the paper's path at 128", &[256]),
            ("the paper's path at 256, ours the same at 128", &[128]),
            ("whole frame, ours with the upload of a stroke of radius 6", &[128, 256]),
        ] {
            let against = format!("{what}; {kind}");
            let found: Vec<_> = rows.iter().filter(|row| row["against"] == against).collect();
            for volume in ["toy", "lump", "geometric mean of 2"] {
                let found = found.iter().filter(|row| row["volume"] == volume);
                let found: Vec<_> = found.map(|row| row["size"].as_u64().unwrap()).collect();
                assert_eq!(found, sizes, "{volume}: {against}");
            }
            for row in found {
                assert!(row["ratio"].as_f64().unwrap() > 0.0, "{row}");
                assert_eq!(row["device"], device.as_str());
                if let Some(filled) = row.get("filled") {
                    assert!((filled.as_f64().unwrap() - 0.25).abs() < 0.01, "{row}");
                }
            }
        }
    }
    for kind in ["mono, 1 sample", "stereo, 4 samples"] {
        for other in ["first", "last"] {
            let against = format!("the sculpture {other}, ours tools, sculpture, room; {kind}");
            let found = rows.iter().filter(|row| row["against"] == against && row["size"] == 128);
            assert_eq!(found.count(), 3, "{against}");
        }
    }
    let bytes = |row: &Value| row.get("bytes").and_then(Value::as_u64);
    let bytes: Vec<_> = rows.iter().filter_map(bytes).collect();
    assert_eq!(bytes.len(), 8);
    assert!(bytes.iter().all(|bytes| (500..=32 * 1024).contains(bytes)), "{bytes:?}");
}

#[test]
fn bench_layers_has_rows_of_the_papers_path() {
    let Some(device) = device() else { return };
    let size = ["--size", "64x64", "--runs", "1", "--json", "--device", &device];
    let rows = rows(&succeeds(&[&["layers", "toy"], &size[..]].concat()));
    for kind in ["mono, 1 sample", "stereo, 4 samples"] {
        let against = format!("the paper's path with one interval a column; {kind}");
        let found: Vec<_> = rows.iter().filter(|row| row["against"] == against).collect();
        assert_eq!(found.iter().map(|row| &row["size"]).collect::<Vec<_>>(), [128, 256]);
        for row in found {
            assert!(row["ratio"].as_f64().unwrap() > 0.0, "{row}");
            assert_eq!(row["device"], device.as_str());
        }
    }
}

#[test]
fn bench_paper_sets_ratios_beside_the_published_ones() {
    let Some(device) = device() else { return };
    let size = ["--size", "64x64", "--runs", "1", "--json", "--device", &device];
    let rows = rows(&succeeds(&[&["paper", "toy"], &size[..]].concat()));
    let row = |against: &str| {
        let row = rows.iter().find(|row| row["against"] == against);
        row.unwrap_or_else(|| panic!("no {against}"))
    };
    let figure = |against: &str, key: &str| row(against)[key].as_f64().unwrap();
    let is_near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
    let whole = figure("whole frame", "ours_ms");
    for what in [
        "whole frame",
        "SDF off (published: at most)",
        "shading off (published: at most)",
        "full march",
        "whole frame at 256",
        "our fast path",
        "our fast path at 256",
    ] {
        assert_eq!(row(what)["device"], device.as_str());
        assert!(is_near(figure(what, "share"), figure(what, "ours_ms") / whole), "{what}");
    }
    for way in ["the paper's queue", "our rows"] {
        for what in [
            "clean-up every frame",
            "clean-up at once, worst tick",
            "clean-up at once each second, mean tick",
            "amortised clean-up, worst tick",
            "amortised clean-up, mean tick",
        ] {
            let what = format!("{what}: {way}");
            assert!(is_near(figure(&what, "share"), figure(&what, "ours_ms") * 0.072), "{what}");
        }
    }
    assert!(is_near(figure("clean-up every frame: the paper's queue", "published"), 5.472));
    assert!(is_near(figure("full march", "published"), 50.0 / 3.0 / 14.7));
    let published = rows.iter().filter(|row| row.get("published").is_some()).count();
    assert_eq!(published, 6);
}

#[test]
fn a_device_that_is_not_there_is_named() {
    let Some(device) = device() else { return };
    let args = ["render", "toy", "--device", "no such device"];
    fails(bench_command(&args), &format!("{device} is not the one asked for"));
}

#[test]
fn without_vulkan_a_line_says_so() {
    let without = |args: &[&str]| {
        let mut bench = bench_command(args);
        // Older loaders use the older name.
        bench.env("VK_DRIVER_FILES", "/nonexistent").env("VK_ICD_FILENAMES", "/nonexistent");
        bench
    };
    fails(without(&["render", "toy"]), "Vulkan");

    let args = ["paper", "toy", "--runs", "1", "--json"];
    let output = without(&args).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && errors.starts_with("skipped: frames: "), "{errors}");
    let (skipped, timed): (Vec<_>, Vec<_>) =
        rows(&output).into_iter().partition(|row| row.get("skipped").is_some());
    assert_eq!((skipped.len(), timed.len()), (7, 10));
    assert!(skipped.iter().all(|row| row["ours_ms"].is_null()));
    assert!(timed.iter().all(|row| row["share"].as_f64().unwrap() > 0.0));
    let table = without(&["paper", "toy", "--runs", "1"]).output().unwrap();
    assert!(String::from_utf8_lossy(&table.stdout).contains("full march; skipped: "));
    let required = without(&args).env("PAROS_REQUIRE", "all").output().unwrap();
    assert_eq!(required.status.code(), Some(1));
}
