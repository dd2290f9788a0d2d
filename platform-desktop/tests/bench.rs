//! `paros bench` as a script meets it: rows with all their keys, and bad input refused.

use std::cell::RefCell;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use paros_bench::{Benchmark, Plan};
use paros_core::limits::INTERVALS;
use paros_core::volume::Grid;
use paros_core::{RangeMaps, TickInput};
use paros_shell::figures::Figure;
use paros_shell::require::require_or_skip;
use paros_shell::rmap;
use paros_shell::statics::{Resident, ResidentBitGrid};
use paros_shell::tick_runner;
use serde_json::Value;

fn bench(args: &[&str]) -> Output {
    let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
    paros.arg("bench").args(args).stdin(Stdio::null()).env_remove("PAROS_REQUIRE").output().unwrap()
}

fn rows(args: &[&str]) -> Vec<Value> {
    let output = bench(args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let rows: Vec<Value> = serde_json::from_slice(&output.stdout).unwrap();
    assert!(!rows.is_empty());
    for row in &rows {
        for key in ["bench", "volume", "size", "ours_ms", "against", "against_ms", "ratio"] {
            assert!(row.get(key).is_some(), "no {key} in {row}");
        }
    }
    rows
}

#[test]
fn rows_have_all_keys_and_the_ratio_is_theirs_over_ours() {
    let rows = rows(&["islands", "--volume", "toy", "--runs", "1", "--json"]);
    for size in [128, 256] {
        assert_eq!(rows.iter().filter(|row| row["size"] == size).count(), 4);
    }
    for row in &rows {
        assert_eq!((&row["bench"], &row["volume"]), (&"islands".into(), &"toy".into()));
        let [ours, theirs, ratio] =
            ["ours_ms", "against_ms", "ratio"].map(|key| row[key].as_f64().unwrap());
        assert!(ours > 0.0 && theirs > 0.0);
        assert!((ratio * ours / theirs - 1.0).abs() < 1e-9, "{row}");
    }
}

#[test]
fn a_missing_rival_leaves_its_half_empty_and_says_so() {
    let args = ["mesh", "--volume", "toy", "--runs", "1", "--json", "--python", "no-such-python"];
    for row in rows(&args) {
        assert!(row["ours_ms"].as_f64().unwrap() > 0.0);
        assert!(row["against_ms"].is_null() && row["ratio"].is_null(), "{row}");
    }
    let errors = String::from_utf8(bench(&args).stderr).unwrap();
    assert!(errors.contains("skipped: ") && errors.contains("no-such-python"), "{errors}");
    let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
    let required = paros.arg("bench").args(args).env("PAROS_REQUIRE", "all").output().unwrap();
    assert_eq!(required.status.code(), Some(1));
    let errors = String::from_utf8(required.stderr).unwrap();
    assert!(
        errors.contains("no-such-python") && errors.contains("PAROS_REQUIRE is all"),
        "{errors}"
    );
    assert!(required.stdout.is_empty());
}

/// The aims of two intervals: holes 0.5 %, undercuts 5 % and 10 % at worst, slots 1 %.
#[test]
fn two_intervals_keep_cuts_that_one_refuses() {
    let rows = rows(&["layers", "--runs", "1", "--json"]);
    let cuts: Vec<_> = rows.iter().filter(|row| row.get("refusal").is_some()).collect();
    assert_eq!(cuts.len(), 5);
    for (row, aim, worst_aim) in [
        (cuts[0], 0.5, 0.5),
        (cuts[1], 5.0, 10.0),
        (cuts[2], 1.0, 1.0),
        (cuts[3], 1.0, 1.0),
        (cuts[4], 1.0, 1.0),
    ] {
        let [one, two, worst] = ["one_percent", "two_percent", "worst_two_percent"]
            .map(|key| row["refusal"][key].as_f64().unwrap());
        assert!(two < aim && worst < worst_aim, "{row}");
        assert!(one > 9.0, "{row}");
    }
}

/// Instructions of a debug build say nothing: that they are there is enough.
#[test]
fn the_worst_frame_of_each_change_is_told() {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-field-toy.rmap");
    let maps: &mut RangeMaps<128, INTERVALS> = &mut Grid::<128>::lock_range_maps();
    let plane = &mut *Grid::<128>::lock_bit_grid();
    Figure::Toy.rasterize_into(maps, plane);
    rmap::write(&file, maps).unwrap();
    let valgrind = Command::new("valgrind").arg("--version").output();
    let counts =
        require_or_skip(valgrind.map_err(|error| format!("no valgrind: {error}"))).unwrap();
    let rows = rows(&["field", file.to_str().unwrap(), "--json"]);
    for what in ["a stroke of radius 6", "taken back", "a load", "the upper half falls"] {
        let row = rows.iter().find(|row| row["against"].as_str().unwrap().contains(what));
        let row = row.unwrap_or_else(|| panic!("no {what}"));
        assert!((1000..256 * 1024).contains(&row["bytes"].as_u64().unwrap()), "{row}");
        assert_eq!(row.get("instructions").is_some(), counts.is_some(), "{row}");
    }
    let two = rows.iter().filter(|row| row["against"].as_str().unwrap().contains("two intervals"));
    assert_eq!((rows.len(), two.count()), (8, 4));
}

#[test]
fn bad_input_is_refused() {
    for (args, word) in [
        (["islands", "--volume", "no-such.rmap"], "no-such.rmap"),
        (["edit", "--volume", "no-such.obj"], "no-such.obj"),
        (["bake", "--volume", "no-such-figure"], "no-such-figure: nothing to measure on"),
        (["islands", "--volume", "x.txt"], "(lump, owl, cat, amphora, dolphin, toy)"),
        (["islands", "--volume", "x.txt"], "or a name in .rmap, .obj, .stl"),
        (["all", "--runs", "0"], "--runs"),
    ] {
        let output = bench(&args);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains(word), "{args:?} should say {word:?}: {errors}");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn the_help_names_every_figure() {
    let help = String::from_utf8(bench(&["--help"]).stdout).unwrap();
    for figure in Figure::ALL {
        assert!(help.contains(figure.name()), "no {} in {help}", figure.name());
    }
    assert!(help.contains("takes minutes"), "{help}");
}

/// The part that takes minutes says how far it is.
#[test]
fn a_counted_replay_tells_its_progress() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-progress");
    fs::create_dir_all(&folder).unwrap();
    let trace = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        (0..1200).for_each(|_| runner.run_tick(&TickInput::default()));
        runner.end_recording_to_bytes().unwrap()
    });
    fs::write(folder.join("session.trace"), &trace).unwrap();
    fs::write(folder.join("ticks"), "7\n").unwrap();
    for figure in Figure::ALL {
        let maps: &mut RangeMaps<128, INTERVALS> = &mut Grid::<128>::lock_range_maps();
        let plane = &mut *Grid::<128>::lock_bit_grid();
        figure.rasterize_into(maps, plane);
        rmap::write(&folder.join(figure.name()).with_extension("rmap"), maps).unwrap();
    }
    let output = bench(&["--replay", folder.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout).unwrap();
    let parts: Vec<f64> = said.lines().map(|line| line.parse().unwrap()).collect();
    assert_eq!(parts.len(), 400);
    assert!(parts.is_sorted() && parts[0] == 0.0 && parts[399] > 0.99, "{parts:?}");
}

/// Within a piece, too: without a count, as here, from run to run.
#[test]
fn progress_is_told_within_a_piece() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-pieces");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join("short.trace");
    let trace = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        runner.run_tick(&TickInput::default());
        runner.end_recording_to_bytes().unwrap()
    });
    fs::write(&path, trace).unwrap();
    let plan = Plan {
        benches: vec![Benchmark::Step],
        subjects: vec![],
        traces: vec![path],
        runs: 1,
        frame_runs: 1,
        canvas: [1, 1],
        device: None,
        python: "python3".into(),
    };
    assert_eq!(plan.piece_count(), 2);
    let heard = RefCell::new(vec![]);
    plan.run(|done| heard.borrow_mut().push(done)).unwrap();
    let heard = heard.into_inner();
    assert!(heard.is_sorted() && heard[..2] == [0.0, 1.0], "{heard:?}");
    assert!(heard[2..].len() > 3 && heard[2..].iter().all(|&done| 1.0 < done && done < 2.0));
}

/// What a trace must be, before anything is counted.
#[test]
fn a_trace_that_differs_is_refused_at_its_tick() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-step");
    fs::create_dir_all(&folder).unwrap();
    let mut trace = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut runner| {
        runner.start_recording();
        (0..30).for_each(|_| runner.run_tick(&TickInput::default()));
        runner.end_recording_to_bytes().unwrap()
    });
    let (good, bad) = (folder.join("good.trace"), folder.join("bad.trace"));
    fs::write(&good, &trace).unwrap();
    *trace.last_mut().unwrap() ^= 1;
    fs::write(&bad, &trace).unwrap();
    let refused = bench(&["step", bad.to_str().unwrap()]);
    let errors = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    assert!(errors.contains("bad.trace: ") && errors.contains("tick 29"), "{errors}");

    let valgrind = Command::new("valgrind").arg("--version").output();
    if require_or_skip(valgrind.map_err(|error| format!("no valgrind: {error}"))).unwrap().is_some()
    {
        let rows = rows(&["step", good.to_str().unwrap(), "--json"]);
        let worst = rows.iter().find(|row| row["against"].as_str().unwrap().contains("worst"));
        let worst = worst.unwrap_or_else(|| panic!("no worst tick in {rows:?}"));
        assert!(worst["instructions"].as_u64().unwrap() > 100, "{worst}");
        assert_eq!((&worst["volume"], &worst["size"]), (&"good".into(), &128.into()));
    }
}
